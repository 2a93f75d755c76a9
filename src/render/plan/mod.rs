//! What a frame needs, and why: decides, and touches no pixel.
//!
//! A [`FramePlan`] holds a snapshot of everything that drawing reads, already in the observer's
//! terms. What the scene does not call for is not in it; [`FramePlan::explained`] says what that is,
//! and why. What only a part of the picture does without is decided when its depths are known, tile by
//! tile (`TilePlan`).

mod bounded;
mod count;
mod draw;
mod features;
mod lamps;
mod observer;
mod planner;
mod range;
pub mod rules;
mod surfaces;
mod tile;
mod turning;
mod uses;
mod without;

use std::collections::HashMap;
use std::sync::Arc;

use glam::DMat4;

pub(super) use self::draw::{Back, Draw, Lines, Pipeline, Shaded, Stage};
use self::lamps::lamps;
pub(super) use self::observer::ObserverSpace;
use self::planner::Planner;
use self::rules::Rules;
pub(super) use self::tile::{TileLight, TilePlan};
pub use self::turning::Turning;
use self::uses::Notes;
pub use self::uses::{Class, Effect, EffectUse, State, Thing};
use super::effects::Lamp;
use super::ways::Ways;
use crate::base::color::Color;
use crate::base::image::Size;
use crate::scene::{
    Arithmetic, Filter, LeaveOut, LightAt, LightId, Projection, Samples, Scene, Settings, View,
};

/// Everything that a frame needs.
#[derive(Clone, Debug, PartialEq)]
pub struct FramePlan {
    /// Pixels.
    pub(in crate::render) size: Size,
    /// What is seen where nothing is.
    pub(in crate::render) background: Color,
    /// Where V goes.
    pub(in crate::render) eye: Eye,
    /// The numbers that light is computed in.
    pub(in crate::render) arithmetic: Arithmetic,
    /// Where light is evaluated.
    pub(in crate::render) light_at: LightAt,
    /// In how many places of a pixel it is asked what is seen.
    pub(in crate::render) samples: Samples,
    /// Whether each of them is lit, as if it were the middle of a pixel: then `light_at` says pixels.
    pub(in crate::render) lit_by_sample: bool,
    /// How far from the middles of pixels it is looked, in parts of a pixel: where there is a picture for
    /// each sample, in the plan of one of those.
    pub(in crate::render) shift: [i32; 2],
    /// What textures give between their texels.
    pub(in crate::render) filter: Filter,
    /// Which ways are not those that every picture is drawn by.
    pub(in crate::render) ways: Ways,
    /// Where the observer is and which way they look.
    pub(in crate::render) view_from_world: DMat4,
    /// `clip_from_view`.
    pub(in crate::render) clip_from_view: DMat4,
    /// Width of lines in pixels: 1 or 2.
    pub(in crate::render) line_width: i32,
    /// The lights that shine, the oldest first.
    pub(in crate::render) lamps: Vec<Lamp>,
    /// Whose they are.
    pub(in crate::render) lights: Vec<LightId>,
    /// What is drawn, in the order that decides between equal depths.
    pub(in crate::render) draws: Vec<Draw>,
    /// The different ways in which surfaces are drawn.
    pub(in crate::render) pipelines: Vec<Pipeline>,
    /// What may be left out of a tile.
    pub(in crate::render) leave_out: LeaveOut,
    /// By what rules.
    pub(in crate::render) rules: Arc<Rules>,
}

/// Where directions to the observer go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::render) enum Eye {
    /// To the origin of view space: perspective.
    Point,
    /// Along +Z: parallel projection.
    Parallel,
}

/// A plan while it is made.
#[derive(Debug)]
struct Planning {
    plan: FramePlan,
    notes: Notes,
    /// The places of the plan's pipelines by their fingerprints.
    places: HashMap<u64, Vec<u32>>,
}

impl FramePlan {
    /// Plans the picture of a scene: `size` in pixels, at least 1 x 1.
    #[must_use]
    pub fn new(scene: &Scene, view: &View, settings: &Settings, size: Size) -> Self {
        Self::by(Rules::sound(), scene, view, settings, size)
    }

    /// The same by rules of one's own.
    #[must_use]
    pub fn by(
        rules: Arc<Rules>,
        scene: &Scene,
        view: &View,
        settings: &Settings,
        size: Size,
    ) -> Self {
        Self::planned(rules, Notes::default, scene, view, settings, size).plan
    }

    /// The same plan as [`Self::new`], with every effect that it has and does without.
    #[must_use]
    pub fn explained(
        scene: &Scene,
        view: &View,
        settings: &Settings,
        size: Size,
    ) -> (Self, Vec<EffectUse>) {
        let Planning { plan, notes, .. } =
            Self::planned(Rules::sound(), Notes::wanted, scene, view, settings, size);
        (plan, notes.into_uses())
    }

    /// Plans in the numbers that are asked for, or in 64 bits where 32 have no room.
    fn planned(
        rules: Arc<Rules>,
        notes: fn() -> Notes,
        scene: &Scene,
        view: &View,
        settings: &Settings,
        size: Size,
    ) -> Planning {
        let as_asked = Self::planned_in(rules.clone(), notes(), scene, view, settings, size);
        if settings.arithmetic == Arithmetic::F64 || as_asked.plan.has_room() {
            return as_asked;
        }
        let settings = Settings { arithmetic: Arithmetic::F64, ..*settings };
        Self::planned_in(rules, notes(), scene, view, &settings, size)
    }

    fn planned_in(
        rules: Arc<Rules>,
        notes: Notes,
        scene: &Scene,
        view: &View,
        settings: &Settings,
        size: Size,
    ) -> Planning {
        let observer = ObserverSpace::new(scene, view, size);
        let by_sample = settings.light == LightAt::Sample;
        let light = if by_sample { LightAt::Pixel } else { settings.light };
        let settings = &Settings { light, ..*settings };
        let plan = Self {
            size,
            background: scene.background,
            eye: match view.projection {
                Projection::Perspective => Eye::Point,
                Projection::Orthographic => Eye::Parallel,
            },
            arithmetic: settings.arithmetic,
            light_at: settings.light,
            samples: settings.samples,
            lit_by_sample: by_sample && settings.samples != Samples::One,
            shift: [0; 2],
            filter: settings.filter,
            ways: Ways::of(settings),
            view_from_world: observer.view_from_world,
            clip_from_view: observer.clip_from_view,
            line_width: if view.wide_lines { 2 } else { 1 },
            lamps: Vec::new(),
            lights: Vec::new(),
            draws: Vec::new(),
            pipelines: Vec::new(),
            leave_out: settings.leave_out,
            rules,
        };
        let mut into = Planning { plan, notes, places: HashMap::new() };
        let shining = lamps(&mut into, scene, view, &observer);
        let planner = Planner { scene, view, settings, observer, shining };
        planner.add_objects(&mut into);
        if view.marks {
            planner.add_marks(&mut into);
        } else {
            into.notes.add(|| EffectUse {
                effect: Effect::Marks,
                name: Effect::Marks.label().to_owned(),
                on: None,
                state: State::exact("switched off"),
                pixels: None,
            });
        }
        into
    }

    /// The plan of the picture that is seen where samples lie that are shifted by so many parts of a pixel
    /// from the middles of their pixels.
    pub(super) fn seen_from(&self, shift: [i32; 2]) -> Self {
        Self { shift, ..self.clone() }
    }

    /// Computes everything of the meshes that drawing reads. Threads that draw compute nothing of it
    /// themselves: see [`together`](crate::render::shares::together).
    pub(in crate::render) fn prepare(&self) {
        self.draws.iter().for_each(|draw| draw.prepare(self));
    }

    /// Pixels.
    #[must_use]
    pub const fn size(&self) -> Size {
        self.size
    }

    /// The names of the effects that each way of drawing a surface is made of, in order: two frames
    /// with the same keys do the same work for each pixel.
    #[must_use]
    pub fn keys(&self) -> Vec<String> {
        self.pipelines.iter().map(Pipeline::key).collect()
    }
}

impl Planning {
    /// The place of a pipeline among those of the frame.
    fn pipeline(&mut self, pipeline: Pipeline) -> u32 {
        let pipelines = &mut self.plan.pipelines;
        let alike = self.places.entry(pipeline.fingerprint()).or_default();
        let same = alike.iter().find(|at| pipelines[**at as usize] == pipeline);
        same.copied().unwrap_or_else(|| {
            let at = u32::try_from(pipelines.len()).expect("fewer than 2^32 pipelines");
            pipelines.push(pipeline);
            alike.push(at);
            at
        })
    }
}

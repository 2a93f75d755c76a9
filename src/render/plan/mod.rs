//! What a frame needs, and why: decides, and touches no pixel.
//!
//! A [`FramePlan`] holds a snapshot of everything that drawing reads, already in the observer's
//! terms. What the scene does not call for is not in it; [`FramePlan::explained`] says what that is,
//! and why. What only a part of the picture does without is decided when its depths are known, tile by
//! tile (`TilePlan`).

mod bounded;
pub(crate) mod features;
mod helpers;
mod lamps;
mod observer;
mod planner;
mod planning;
mod range;
mod rules;
mod surfaces;
pub(crate) mod tile;
mod turning;
pub(crate) mod uses;
mod without;

use self::lamps::lamps;
use self::observer::ObserverSpace;
use self::planning::{Planner, Planning};
use self::uses::Notes;
pub use self::uses::{Class, Effect, EffectUse, State, Thing};
use crate::accuracy::{Arithmetic, LightAt, Samples, Settings};
use crate::base::image::Size;
use crate::render::frame::variants::Variants;
use crate::render::frame::{Eye, FramePlan, Rules};
use crate::scene::{Projection, Scene, View};

impl FramePlan {
    /// Plans the picture of a scene: `size` in pixels, at least 1 x 1.
    #[must_use]
    pub fn new(scene: &Scene, view: &View, settings: &Settings, size: Size) -> Self {
        Self::planned(Rules::Applied, Notes::default, scene, view, settings, size).plan
    }

    /// Plans the same picture with everything that the scene names, needed or not: slower, and what
    /// [`Self::new`] is tested against.
    #[must_use]
    pub fn of_everything(scene: &Scene, view: &View, settings: &Settings, size: Size) -> Self {
        Self::planned(Rules::Ignored, Notes::default, scene, view, settings, size).plan
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
            Self::planned(Rules::Applied, Notes::wanted, scene, view, settings, size);
        (plan, notes.into_uses())
    }

    /// Plans in the numbers that are asked for, or in 64 bits where 32 have no room.
    fn planned(
        rules: Rules,
        notes: fn() -> Notes,
        scene: &Scene,
        view: &View,
        settings: &Settings,
        size: Size,
    ) -> Planning {
        let as_asked = Self::planned_in(rules, notes(), scene, view, settings, size);
        if settings.arithmetic == Arithmetic::F64 || as_asked.plan.has_room() {
            return as_asked;
        }
        let settings = Settings { arithmetic: Arithmetic::F64, ..*settings };
        Self::planned_in(rules, notes(), scene, view, &settings, size)
    }

    fn planned_in(
        rules: Rules,
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
            variants: Variants::of(settings),
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
        let mut into = Planning::new(plan, notes);
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
}

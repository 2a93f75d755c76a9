//! What a frame needs, and why: decides, and touches no pixel.
//!
//! A [`FramePlan`] holds a snapshot of everything that drawing reads, already in the observer's
//! terms. What the scene does not call for is not in it, and [`FramePlan::skipped`] says why.

mod draw;
mod lamps;
mod observer;
mod planner;

use glam::DMat4;

pub(super) use self::draw::{Back, Draw, Lines, Pipeline, Shaded, Stage};
use self::lamps::lamps;
pub(super) use self::observer::ObserverSpace;
use self::planner::Planner;
use super::effects::Lamp;
use crate::base::color::Color;
use crate::base::image::Size;
use crate::scene::{Arithmetic, Filter, LightAt, Projection, Scene, Settings, View};

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
    /// What textures give between their texels.
    pub(in crate::render) filter: Filter,
    /// Where the observer is and which way they look.
    pub(in crate::render) view_from_world: DMat4,
    /// `clip_from_view`.
    pub(in crate::render) clip_from_view: DMat4,
    /// Width of lines in pixels: 1 or 2.
    pub(in crate::render) line_width: i32,
    /// The lights that shine, in the order of the scene.
    pub(in crate::render) lamps: Vec<Lamp>,
    /// What is drawn, in the order that decides between equal depths.
    pub(in crate::render) draws: Vec<Draw>,
    /// The different ways in which surfaces are drawn.
    pub(in crate::render) pipelines: Vec<Pipeline>,
    pub(in crate::render) skipped: Vec<Skipped>,
}

/// Where directions to the observer go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::render) enum Eye {
    /// To the origin of view space: perspective.
    Point,
    /// Along +Z: parallel projection.
    Parallel,
}

/// An effect that a frame does without, and why.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Skipped {
    /// What is left out: a light, an object, a texture.
    pub effect: String,
    /// Why nothing of the picture changes by it.
    pub reason: String,
}

impl FramePlan {
    /// Plans the picture of a scene: `size` in pixels, at least 1 x 1.
    #[must_use]
    pub fn new(scene: &Scene, view: &View, settings: &Settings, size: Size) -> Self {
        let observer = ObserverSpace::new(scene, view, size);
        let mut plan = Self {
            size,
            background: scene.background,
            eye: match view.projection {
                Projection::Perspective => Eye::Point,
                Projection::Orthographic => Eye::Parallel,
            },
            arithmetic: settings.arithmetic,
            light_at: settings.light,
            filter: settings.filter,
            view_from_world: observer.view_from_world,
            clip_from_view: observer.clip_from_view,
            line_width: if view.wide_lines { 2 } else { 1 },
            lamps: Vec::new(),
            draws: Vec::new(),
            pipelines: Vec::new(),
            skipped: Vec::new(),
        };
        let shining = lamps(&mut plan, scene, view, &observer);
        let planner = Planner { scene, view, settings, observer, shining };
        planner.add_objects(&mut plan);
        if view.marks {
            planner.add_marks(&mut plan);
        }
        plan.skipped.dedup();
        plan
    }

    /// What the frame does without.
    #[must_use]
    pub fn skipped(&self) -> &[Skipped] {
        &self.skipped
    }

    /// Pixels.
    #[must_use]
    pub const fn size(&self) -> Size {
        self.size
    }

    fn skip(&mut self, effect: impl Into<String>, reason: impl Into<String>) {
        let skipped = Skipped { effect: effect.into(), reason: reason.into() };
        if !self.skipped.contains(&skipped) {
            self.skipped.push(skipped);
        }
    }

    /// The place of a pipeline among those of the frame.
    fn pipeline(&mut self, pipeline: Pipeline) -> u32 {
        let at = self.pipelines.iter().position(|other| *other == pipeline).unwrap_or_else(|| {
            self.pipelines.push(pipeline);
            self.pipelines.len() - 1
        });
        u32::try_from(at).expect("fewer than 2^32 pipelines")
    }
}

//! What a frame draws, as plain data. Nothing here decides, and nothing here touches a pixel.

pub(crate) mod draw;
pub(crate) mod variants;

use glam::DMat4;

use self::draw::{Draw, Pipeline};
use self::variants::Variants;
use super::lights::ViewLight;
use crate::accuracy::{Arithmetic, Filter, LeaveOut, LightAt, Samples};
use crate::base::color::Color;
use crate::base::image::Size;
use crate::scene::LightId;

/// Everything that a frame needs.
#[derive(Clone, Debug, PartialEq)]
pub struct FramePlan {
    /// Pixels.
    pub(crate) size: Size,
    /// What is seen where nothing is.
    pub(crate) background: Color,
    /// Where V goes.
    pub(crate) eye: Eye,
    /// The numbers that light is computed in.
    pub(crate) arithmetic: Arithmetic,
    /// Where light is evaluated.
    pub(crate) light_at: LightAt,
    /// In how many places of a pixel it is asked what is seen.
    pub(crate) samples: Samples,
    /// Whether each of them is lit, as if it were the middle of a pixel: then `light_at` says pixels.
    pub(crate) lit_by_sample: bool,
    /// How far from the middles of pixels it is looked, in parts of a pixel: where there is a picture for
    /// each sample, in the plan of one of those.
    pub(crate) shift: [i32; 2],
    /// What textures give between their texels.
    pub(crate) filter: Filter,
    /// The variants of stages that the settings name.
    pub(crate) variants: Variants,
    /// Where the observer is and which way they look.
    pub(crate) view_from_world: DMat4,
    /// `clip_from_view`.
    pub(crate) clip_from_view: DMat4,
    /// Width of lines in pixels: 1 or 2.
    pub(crate) line_width: i32,
    /// The lights that shine, the oldest first.
    pub(crate) lamps: Vec<ViewLight>,
    /// Whose they are.
    pub(crate) lights: Vec<LightId>,
    /// What is drawn, in the order that decides between equal depths.
    pub(crate) draws: Vec<Draw>,
    /// The different ways in which surfaces are drawn.
    pub(crate) pipelines: Vec<Pipeline>,
    /// What may be left out of a tile.
    pub(crate) leave_out: LeaveOut,
    /// Whether rules leave out what no pixel shows.
    pub(crate) rules: Rules,
}

/// Where directions to the observer go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Eye {
    /// To the origin of view space: perspective.
    Point,
    /// Along +Z: parallel projection.
    Parallel,
}

/// Whether a frame leaves out what changes no bit of its picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Rules {
    /// It does.
    Applied,
    /// Everything that the scene names is computed: what the rules are tested against.
    Ignored,
}

impl FramePlan {
    /// The plan of the picture that is seen where samples lie that are shifted by so many parts of a pixel
    /// from the middles of their pixels.
    pub(super) fn seen_from(&self, shift: [i32; 2]) -> Self {
        Self { shift, ..self.clone() }
    }

    /// Computes everything of the meshes that drawing reads. Threads that draw compute nothing of it
    /// themselves: see [`together`](crate::base::work_stealing::together).
    pub(crate) fn prepare(&self) {
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

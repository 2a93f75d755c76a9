//! How pixels get their colours: every choice of shading, as data.
//!
//! `plan::compile` makes the choices; shading carries them out, and reads no setting.
//!
//! There are five paths to a colour, and all of them give the same bytes. Each is the fastest for
//! the surfaces that it is meant for, and slots can do everything.

use serde::{Deserialize, Serialize};

use super::draw::Draw;
use super::shading_mode::ShadingMode;

/// How the pixels of a draw with one pipeline are coloured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Program {
    /// The path of blocks of 8 x 8 pixels that one triangle covers fully.
    pub(crate) whole: WholePath,
    /// The path of all other blocks.
    pub(crate) others: OtherPath,
    /// Whether blocks of the same surface share a list.
    pub(crate) joins: bool,
    pub(crate) light: LightOp,
    /// Whether pixels need their places in their triangles.
    pub(crate) is_located: bool,
    /// Whether colours are computed for triangles, and handed out to their pixels.
    pub(crate) is_by_triangle: bool,
}

/// How blocks that one triangle covers fully are coloured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum WholePath {
    /// One colour fills them.
    Fill,
    /// Each block is coloured in one pass, without a list of pixels.
    One,
    /// As other blocks, from slots.
    Slots,
}

/// How other blocks are coloured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum OtherPath {
    /// The colours of faces are looked up.
    Faces,
    /// Pixels are listed, and gather from the slots of their triangles.
    Slots,
    /// As `Slots`; blocks in which nearly each pixel shows another triangle have the triangle of a
    /// pixel in its lane, and no slots.
    Each,
}

/// Where light is evaluated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum LightOp {
    /// The surface is not lit.
    None,
    /// At the point of each pixel (Phong shading).
    Points,
    /// At vertices, and interpolated (Gouraud shading).
    Vertices(VertexLight),
    /// At the centre of each polygon (flat shading).
    Faces,
}

/// The values at vertices, which are interpolated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum VertexLight {
    /// Colours, which are rounded to bytes at once.
    Bytes,
    /// Colours, to which something is added or which are encoded.
    Colors,
    /// Diffuse and specular light, because the surface colour differs from pixel to pixel.
    Light,
}

impl VertexLight {
    /// Returns whether vertices hold colours instead of light.
    pub(crate) fn is_colored(self) -> bool {
        self != Self::Light
    }
}

impl Program {
    /// The program of a surface of one colour without light.
    pub(crate) const FLAT: Self = Self {
        whole: WholePath::Fill,
        others: OtherPath::Slots,
        joins: false,
        light: LightOp::None,
        is_located: false,
        is_by_triangle: true,
    };
}

/// The number of pixels that each path has coloured, in whole blocks except for lists.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PathPixels {
    /// Filled blocks.
    pub fill: u64,
    /// Blocks that look up the colours of faces.
    pub faces: u64,
    /// Blocks of one triangle, coloured in one pass.
    pub one: u64,
    /// Pixels of lists with slots.
    pub slots: u64,
    /// Pixels of lists with a triangle in each lane.
    pub each: u64,
}

impl PathPixels {
    /// Returns the name of each path, its use, and its number of pixels.
    #[must_use]
    pub const fn rows(&self) -> [(&'static str, &'static str, u64); 5] {
        let Self { fill, faces, one, slots, each } = *self;
        [
            ("Fill", "blocks of one colour", fill),
            ("Faces", "colours of faces, looked up", faces),
            ("One triangle", "blocks that one triangle covers", one),
            ("Slots", "all else: pixels gather from their triangles", slots),
            ("Triangle per lane", "triangles as small as pixels", each),
        ]
    }
}

impl std::ops::AddAssign for PathPixels {
    fn add_assign(&mut self, other: Self) {
        let Self { fill, faces, one, slots, each } = other;
        self.fill += fill;
        self.faces += faces;
        self.one += one;
        self.slots += slots;
        self.each += each;
    }
}

/// The programs of all draws of a frame. The memory is kept from frame to frame.
#[derive(Debug, Default)]
pub(crate) struct Programs {
    /// For each draw the index of its first entry, and the end of the last.
    starts: Vec<u32>,
    /// The programs of a draw by pipeline.
    entries: Vec<(u32, Program)>,
    pub(crate) mode: ShadingMode,
    /// Whether colours of faces are looked up in a table of the frame.
    pub(crate) looks_up_faces: bool,
    /// Whether little is computed for a pixel, so that copying a tile would take much of its time.
    pub(crate) are_quick: bool,
}

impl Programs {
    /// Begins a frame.
    pub(crate) fn begin(&mut self, mode: ShadingMode) {
        self.mode = mode;
        self.starts.clear();
        self.entries.clear();
        // The first draw starts at 0; each later call of `add` pushes an end.
        self.starts.push(0);
    }

    /// Adds the programs of the next draw, one for each of its pipelines.
    pub(crate) fn add(&mut self, draw: &Draw, program: impl Fn(u32) -> Program) {
        let first = self.entries.len();
        for pipeline in draw.part_pipelines.iter().flatten().copied() {
            // Parts that share a pipeline share its program.
            if !self.entries[first..].iter().any(|(other, _)| *other == pipeline) {
                self.entries.push((pipeline, program(pipeline)));
            }
        }
        self.starts.push(u32::try_from(self.entries.len()).expect("fewer than 2^32 parts"));
    }

    /// Returns the program of a draw with one of its pipelines.
    #[inline]
    pub(crate) fn of(&self, draw: u32, pipeline: u32) -> &Program {
        let [first, end] = [draw, draw + 1].map(|at| self.starts[at as usize] as usize);
        match &self.entries[first..end] {
            // Most draws have a single pipeline, which needs no search.
            [(_, only)] => only,
            several => {
                let found = several.iter().find(|(other, _)| *other == pipeline);
                found.map_or(&Program::FLAT, |(_, program)| program)
            }
        }
    }
}

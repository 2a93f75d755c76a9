//! Where the numbers of each draw begin among those of all.

use crate::screen::clip::ScreenVertex;

/// Where the numbers of a draw begin.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Start {
    pub(crate) vertex: usize,
    pub(crate) vertex_end: usize,
    /// The number of its first triangle.
    pub(crate) number: u32,
    /// The number after that of its last.
    pub(crate) end: u32,
    pub(crate) outline: usize,
    /// The number of its first edge among the lines.
    pub(crate) line: u32,
    /// The number of its first normal among the lines.
    pub(crate) normal: u32,
    /// The number after that of its last line.
    pub(crate) line_end: u32,
    /// Where its normals begin among those of all draws.
    pub(crate) normal_place: usize,
}

/// The corners of the triangles of all draws.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DrawCorners<'a> {
    pub(super) corners: &'a [ScreenVertex],
    pub(super) starts: &'a [Start],
}

impl<'a> DrawCorners<'a> {
    /// The draw that a triangle belongs to, and where its numbers begin.
    #[inline(always)]
    pub(crate) fn draw_of(&self, triangle: u32) -> (u32, Start) {
        let draw = self.starts.partition_point(|start| start.end <= triangle);
        (number(draw), self.starts[draw])
    }

    /// Those of one draw.
    pub(crate) fn of(&self, draw: usize) -> &'a [ScreenVertex] {
        let Start { vertex, vertex_end, .. } = self.starts[draw];
        &self.corners[vertex..vertex_end]
    }
}

/// A number of the frame, or of a draw.
pub(crate) fn number(i: usize) -> u32 {
    u32::try_from(i).expect("fewer than 2^32 primitives")
}

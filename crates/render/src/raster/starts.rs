//! The first numbers of each draw, among the numbers of the frame.

use crate::screen::clip::ScreenVertex;

/// The first numbers of one draw.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Start {
    pub(crate) vertex: usize,
    pub(crate) vertex_end: usize,
    /// The number of the first triangle.
    pub(crate) number: u32,
    /// The number after the last triangle's.
    pub(crate) end: u32,
    pub(crate) outline: usize,
    /// The number of the first edge among the lines.
    pub(crate) line: u32,
    /// The number of the first normal among the lines.
    pub(crate) normal: u32,
    /// The number after the last line's.
    pub(crate) line_end: u32,
    /// The index of the first normal among the normals of all draws.
    pub(crate) normal_place: usize,
}

/// The corners of the triangles of all draws.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DrawCorners<'a> {
    pub(super) corners: &'a [ScreenVertex],
    pub(super) starts: &'a [Start],
}

impl<'a> DrawCorners<'a> {
    /// Returns the draw of a triangle, and the draw's first numbers.
    #[inline(always)]
    pub(crate) fn draw_of(&self, triangle: u32) -> (u32, Start) {
        let draw = self.starts.partition_point(|start| start.end <= triangle);
        (number(draw), self.starts[draw])
    }

    /// Returns the corners of one draw.
    pub(crate) fn of(&self, draw: usize) -> &'a [ScreenVertex] {
        let Start { vertex, vertex_end, .. } = self.starts[draw];
        &self.corners[vertex..vertex_end]
    }
}

/// Converts an index to a 32-bit number of the frame or of a draw.
pub(crate) fn number(i: usize) -> u32 {
    u32::try_from(i).expect("fewer than 2^32 primitives")
}

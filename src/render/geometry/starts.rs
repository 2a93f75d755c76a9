//! Where the numbers of each draw begin among those of all.

/// Where the numbers of a draw begin.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::render) struct Start {
    pub(super) vertex: usize,
    pub(super) vertex_end: usize,
    /// The number of its first triangle.
    pub(in crate::render) number: u32,
    /// The number after that of its last.
    pub(in crate::render) end: u32,
    pub(super) outline: usize,
    /// The number of its first edge among the lines.
    pub(super) line: u32,
    /// The number of its first normal among the lines.
    pub(super) normal: u32,
    /// The number after that of its last line.
    pub(super) line_end: u32,
    /// Where its normals begin among those of all draws.
    pub(super) normal_place: usize,
}

/// A number of the frame, or of a draw.
pub(super) fn number(i: usize) -> u32 {
    u32::try_from(i).expect("fewer than 2^32 primitives")
}

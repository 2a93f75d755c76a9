//! Lists of the pixels that sixteen small triangles cover.

use super::hits::PACK;

/// The most pixels that sixteen triangles cover.
pub(super) const MOST: usize = PACK * 16 * 16;

/// Pixels that sixteen triangles cover: in bits, from the lowest, 4 for the lane, 4 for the column
/// and 4 for the row in the box of the triangle. There is room for sixteen more.
#[derive(Debug)]
pub(crate) struct Covered {
    pub(super) pixels: [i32; MOST + PACK],
    pub(super) count: usize,
}

impl Default for Covered {
    fn default() -> Self {
        Self { pixels: [0; MOST + PACK], count: 0 }
    }
}

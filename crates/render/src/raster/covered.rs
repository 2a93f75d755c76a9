//! The list of pixels covered by sixteen small triangles.

use super::hits::PACK;

/// The largest number of pixels covered by sixteen triangles.
pub(super) const MOST: usize = PACK * 16 * 16;

/// The pixels covered by sixteen triangles. From the lowest bit, an entry has 4 bits for the lane,
/// 4 for the column and 4 for the row in the triangle's box. There is room for sixteen more.
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

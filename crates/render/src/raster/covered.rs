//! Lists of the pixels that sixteen small triangles cover.

use super::hits::PACK;

/// The most pixels that sixteen triangles cover.
pub(super) const MOST: usize = PACK * 16 * 16;

/// The number of bits in a listed pixel that are below those of samples.
pub(super) const SAMPLES: u32 = 12;

/// Pixels that sixteen triangles cover: in bits, from the lowest, 4 for the lane, 4 for the column
/// and 4 for the row in the box of the triangle, and one for each of several samples that it
/// covers. There is room for sixteen more.
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

impl Covered {
    /// The lanes of the triangles that cover any, a bit for each.
    #[inline(always)]
    pub(super) fn lanes(&self) -> u64 {
        let mut lanes = 0_u32;
        for pixel in &self.pixels[..self.count] {
            lanes |= 1 << (pixel & 15);
        }
        u64::from(lanes)
    }
}

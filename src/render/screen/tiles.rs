//! How a picture is cut into tiles and these into blocks, and where the words of a pixel stand.
//!
//! A tile has 64 x 64 pixels, a block 8 x 8. Words stand block by block, in each block sample by
//! sample, and these row by row.

use fearless_simd::{Simd, i32x16};

use crate::base::image::Size;

/// Pixels to a side of a tile.
pub(crate) const TILE_SIDE: usize = 64;
/// The same, as coordinates are kept.
pub(crate) const TILE: i32 = 64;
/// Pixels to a side of a block.
pub(crate) const BLOCK: i32 = 8;
/// Pixels of a block.
pub(crate) const BLOCK_PIXELS: usize = 64;
/// Blocks in a row of a tile.
pub(crate) const BLOCKS: i32 = TILE / BLOCK;
/// Pixels of a tile.
pub(crate) const PIXELS: usize = TILE_SIDE * TILE_SIDE;

/// How many tiles there are in a row, and how many rows of them.
pub(crate) fn tiles_of(size: Size) -> [i32; 2] {
    [size.width, size.height].map(|pixels| {
        i32::try_from(pixels.div_ceil(TILE_SIDE)).expect("pictures have 32-bit sizes")
    })
}

/// The block of a pixel, by column and row of the tile.
#[inline(always)]
pub(crate) const fn block_at(x: i32, y: i32) -> usize {
    (y / BLOCK * BLOCKS + x / BLOCK) as usize
}

/// The column and row of the tile, and the sample, whose word stands at a place where pixels have
/// so many samples.
#[expect(clippy::cast_possible_truncation, reason = "small numbers")]
pub(crate) const fn pixel_at(place: usize, samples: usize) -> ([i32; 2], usize) {
    let (plane, pixel) = (place / BLOCK_PIXELS, (place % BLOCK_PIXELS) as i32);
    let (block, sample) = ((plane / samples) as i32, plane % samples);
    let at = [block % BLOCKS * BLOCK + pixel % BLOCK, block / BLOCKS * BLOCK + pixel / BLOCK];
    (at, sample)
}

/// Where a pixel stands in its block.
#[inline(always)]
pub(crate) const fn within(x: i32, y: i32) -> usize {
    (y % BLOCK * BLOCK + x % BLOCK) as usize
}

/// Where the words of sixteen pixels stand in the tile, for one of `N` samples.
#[inline(always)]
#[expect(clippy::cast_possible_truncation, reason = "small numbers")]
pub(crate) fn lanes_place<S: Simd, const N: usize>(
    x: i32x16<S>,
    y: i32x16<S>,
    sample: usize,
) -> i32x16<S> {
    let block = ((y >> 3) << 3) + (x >> 3);
    let first = (block * (N * BLOCK_PIXELS) as i32) + (sample * BLOCK_PIXELS) as i32;
    first + ((y & 7) << 3) + (x & 7)
}

//! The layout of tiles, blocks and the visibility buffer.
//!
//! A tile has 64 x 64 pixels, a block 8 x 8. The visibility buffer of a tile is stored block by
//! block, each block row by row, and each pixel sample by sample.

use fearless_simd::{Simd, i32x16};

use marraztu_core::base::image::Size;

/// The pixels along a side of a tile.
pub(crate) const TILE_SIDE: usize = 64;
/// The tile side in the type of coordinates.
pub(crate) const TILE: i32 = 64;
/// The pixels along a side of a block.
pub(crate) const BLOCK: i32 = 8;
/// The pixels in a block.
pub(crate) const BLOCK_PIXELS: usize = 64;
/// The blocks in a row of a tile.
pub(crate) const BLOCKS: i32 = TILE / BLOCK;
/// The pixels in a tile.
pub(crate) const PIXELS: usize = TILE_SIDE * TILE_SIDE;

/// Returns the number of columns and rows of tiles.
pub(crate) fn tiles_of(size: Size) -> [i32; 2] {
    [size.width, size.height].map(|pixels| {
        i32::try_from(pixels.div_ceil(TILE_SIDE)).expect("pictures have 32-bit sizes")
    })
}

/// Returns the block of a pixel, given by its column and row in the tile.
#[inline(always)]
pub(crate) const fn block_at(x: i32, y: i32) -> usize {
    (y / BLOCK * BLOCKS + x / BLOCK) as usize
}

/// Returns the index of a pixel in its block.
#[inline(always)]
pub(crate) const fn within(x: i32, y: i32) -> usize {
    (y % BLOCK * BLOCK + x % BLOCK) as usize
}

/// Returns the column and row of a pixel, given its index in the block with this upper left pixel.
#[inline(always)]
#[expect(clippy::cast_possible_truncation, clippy::cast_possible_wrap, reason = "small numbers")]
pub(crate) const fn pixel_of([left, top]: [i32; 2], place: usize) -> [i32; 2] {
    let place = place as i32;
    [left + place % BLOCK, top + place / BLOCK]
}

/// Computes the indices of sixteen pixels in a tile's visibility buffer, for one of `samples`
/// samples.
#[inline(always)]
#[expect(clippy::cast_possible_truncation, reason = "small numbers")]
pub(crate) fn lanes_place<S: Simd>(
    x: i32x16<S>,
    y: i32x16<S>,
    (sample, samples): (usize, usize),
) -> i32x16<S> {
    // Shifts and masks divide by 8: the block, and the place in it.
    let block = ((y >> 3) << 3) + (x >> 3);
    let pixel = (block * BLOCK_PIXELS as i32) + ((y & 7) << 3) + (x & 7);
    pixel * samples as i32 + sample as i32
}

//! Draws the small triangles that wait for a tile, with four samples per pixel.
//!
//! The entries of a pixel's samples are stored side by side, so all samples of a covered pixel are
//! compared at once. They are moved to the planes of the samples after all triangles are drawn.

use fearless_simd::{
    Select as _, Simd, SimdBase as _, SimdMask as _, f64x4, f64x8, mask32x16, u32x16,
};

use super::Visibility;
use crate::raster::bins::Bins;
use crate::raster::covered::Covered;
use crate::raster::depth_format::{Format, with_format};
use crate::raster::entries::put_samples;
use crate::raster::hits::PACK;
use crate::raster::queue::{Pack, Queue, SMALL};
use crate::raster::rule::{Rule, Usual};
use crate::raster::small::{self, CoveredPixels};
use crate::raster::small_edges::Edges;
use crate::raster::tile_queues::{FIRST_SIZE, SIZES};
use crate::raster::visibility_buffer::BACKGROUND;
use crate::screen::coverage::PixelBox;
use crate::screen::sample_positions::{FOUR, SamplePositions};
use crate::screen::tiles::{BLOCK_PIXELS, PIXELS, TILE, lanes_place};
use crate::simd::Bits;

/// The nearest small triangles of a tile.
#[derive(Debug, Default)]
pub(super) struct SmallTriangles {
    bounds: PixelBox,
    sample_positions: SamplePositions,
    /// The entries, block by block.
    blocks: Vec<BlockEntries>,
    /// The blocks that any triangle reaches, a bit for each. Entries of other blocks are
    /// meaningless.
    reached: u64,
    covered: Covered,
    /// The triangles left over from packs of fewer than sixteen.
    rest: Queue,
}

/// The entries of a block's pixels, with the entries of a pixel's samples side by side.
#[derive(Clone, Debug)]
#[repr(align(64))]
struct BlockEntries([[u64; FOUR]; BLOCK_PIXELS]);

/// The entries of sixteen pixels.
#[repr(align(64))]
struct Entries([u64; FOUR * PACK]);

/// The edge functions of all sizes but the last, and of the last size.
type Most<S> = <Usual as Rule>::Edges<S>;
type Last<S> = <Usual as Rule>::LastEdges<S>;

impl Visibility {
    /// Draws the small triangles that wait for a tile, from the bins of all threads.
    pub(super) fn draw_small<S: Simd>(&mut self, simd: S, bins: &[Bins], tile: usize) {
        if bins.iter().all(|bins| bins.tile_queues.is_empty(tile)) {
            return;
        }
        let mut small = self.small.take().unwrap_or_default();
        small.begin(self.bounds, self.sample_positions);
        simd.vectorize(
            #[inline(always)]
            || {
                with_format!(self.depth_format, D => {
                    small.draw(simd, D::of(self.depth_format), (bins, tile));
                });
                // Only the blocks that were reached are moved to the planes.
                for block in Bits(small.reached) {
                    self.put_pixels(simd, block, &small.blocks[block].0);
                }
            },
        );
        self.small = Some(small);
    }

    /// Moves the entries of a block's pixels to the planes of their samples, with a depth test.
    #[inline(always)]
    fn put_pixels<S: Simd>(&mut self, simd: S, block: usize, pixels: &[[u64; FOUR]; BLOCK_PIXELS]) {
        self.write::<FOUR>(simd.level(), block);
        let planes: &mut [f64] = bytemuck::cast_slice_mut(
            &mut self.buffer.0[FOUR * BLOCK_PIXELS * block..][..FOUR * BLOCK_PIXELS],
        );
        let pixels: &[f64] = bytemuck::cast_slice(pixels.as_flattened());
        for (at, eight) in (0..).step_by(8).zip(pixels.as_chunks::<32>().0) {
            // A 4 x 8 transpose in registers: from samples side by side to one row per sample.
            let (a, b) =
                (f64x8::from_slice(simd, &eight[..8]), f64x8::from_slice(simd, &eight[8..16]));
            let (c, d) =
                (f64x8::from_slice(simd, &eight[16..24]), f64x8::from_slice(simd, &eight[24..]));
            let ((even_low, odd_low), (even_high, odd_high)) =
                (a.deinterleave(b), c.deinterleave(d));
            let (first, third) = even_low.deinterleave(even_high);
            let (second, fourth) = odd_low.deinterleave(odd_high);
            for (sample, new) in [first, second, third, fourth].into_iter().enumerate() {
                let row = &mut planes[sample * BLOCK_PIXELS + at..][..8];
                new.max(f64x8::from_slice(simd, row)).store_slice(row);
            }
        }
    }
}

impl SmallTriangles {
    /// Begins a tile.
    fn begin(&mut self, bounds: PixelBox, sample_positions: SamplePositions) {
        (self.bounds, self.sample_positions, self.reached) = (bounds, sample_positions, 0);
        self.blocks.resize(BLOCK_PIXELS, BlockEntries([[0; FOUR]; BLOCK_PIXELS]));
        // A cancelled frame leaves triangles in the queue.
        self.rest.clear();
    }

    /// Draws all triangles that wait for a tile.
    #[inline(always)]
    fn draw<S: Simd, D: Format>(&mut self, simd: S, format: D, of: (&[Bins], usize)) {
        for size in 0..SIZES {
            if size + FIRST_SIZE + 1 < SMALL.len() {
                self.draw_size::<S, D, Most<S>>(simd, format, of, size);
            } else {
                self.draw_size::<S, D, Last<S>>(simd, format, of, size);
            }
        }
    }

    #[inline(always)]
    fn draw_size<S: Simd, D: Format, E: Edges<S>>(
        &mut self,
        simd: S,
        format: D,
        (bins, tile): (&[Bins], usize),
        size: usize,
    ) {
        for bins in bins {
            bins.tile_queues.each(
                simd,
                tile,
                size,
                #[inline(always)]
                |pack, count| {
                    // Full packs are drawn directly. Incomplete ones are collected, to keep all
                    // lanes busy.
                    if count == PACK {
                        return self.draw_pack::<S, D, E>(format, pack);
                    }
                    let some = mask32x16::from_bitmask(simd, (1 << count) - 1);
                    if self.rest.add((pack, None), some, count) {
                        self.draw_rest::<S, D, E>(simd, format);
                    }
                },
            );
        }
        self.draw_rest::<S, D, E>(simd, format);
    }

    /// Draws the left-over triangles.
    #[inline(always)]
    fn draw_rest<S: Simd, D: Format, E: Edges<S>>(&mut self, simd: S, format: D) {
        for at in (0..self.rest.waiting()).step_by(PACK) {
            let pack = self.rest.pack(simd, at);
            self.draw_pack::<S, D, E>(format, &pack);
        }
        self.rest.forget();
    }

    /// Draws sixteen triangles.
    ///
    /// Compiled as a separate function because it is called from several places.
    #[inline(always)]
    fn draw_pack<S: Simd, D: Format, E: Edges<S>>(&mut self, format: D, pack: &Pack<S>) {
        pack[0].simd.vectorize(
            #[inline(always)]
            || self.draw_pack_in::<S, D, E>(format, pack),
        );
    }

    #[inline(always)]
    fn draw_pack_in<S: Simd, D: Format, E: Edges<S>>(&mut self, format: D, pack: &Pack<S>) {
        let simd = pack[0].simd;
        let Self { bounds, sample_positions, blocks, reached, covered, .. } = self;
        small::each_in::<S, E, FOUR>(
            (pack, *bounds),
            sample_positions,
            covered,
            #[inline(always)]
            |pixels: &CoveredPixels<S, FOUR>, count| {
                let CoveredPixels { x, y, number, depth, .. } = *pixels;
                let place = lanes_place::<S, 1>(x & (TILE - 1), y & (TILE - 1), 0);
                // A sample that is not covered gets the background's entry, which never wins the
                // depth test.
                let (nothing, background) =
                    (u32x16::splat(simd, 0), u32x16::splat(simd, BACKGROUND));
                let (mut keys, mut numbers) = ([nothing; FOUR], [background; FOUR]);
                for sample in 0..FOUR {
                    let some = pixels.covered(sample, count);
                    keys[sample] = some.select(format.keys(depth[sample]), nothing);
                    numbers[sample] = some.select(number, background);
                }
                let mut entries = Entries([0; FOUR * PACK]);
                put_samples(keys, numbers, &mut entries.0);
                let places = <[i32; PACK]>::from(place).into_iter();
                for (place, new) in places.zip(entries.0.as_chunks::<FOUR>().0).take(count) {
                    // Entries are compared as f64: see `put_rows`.
                    let new = f64x4::from_slice(simd, bytemuck::cast_slice(new));
                    let old = bytemuck::cast_slice_mut(pixel(blocks, reached, place));
                    new.max(f64x4::from_slice(simd, old)).store_slice(old);
                }
            },
        );
    }
}

/// Returns the entries of a pixel of the tile.
#[inline(always)]
fn pixel<'a>(blocks: &'a mut [BlockEntries], reached: &mut u64, place: i32) -> &'a mut [u64; FOUR] {
    let place = place.cast_unsigned() as usize % PIXELS;
    let block = place / BLOCK_PIXELS;
    if *reached >> block & 1 == 0 {
        *reached |= 1 << block;
        blocks[block].0.as_flattened_mut().fill(0);
    }
    &mut blocks[block].0[place % BLOCK_PIXELS]
}

//! Draws the small triangles that wait for a tile, with several samples per pixel.
//!
//! The entries of four samples of a pixel are stored side by side and compared at once. They are
//! moved to the planes of the samples after all triangles are drawn.

use fearless_simd::{
    Select as _, Simd, SimdBase as _, SimdMask as _, f64x4, f64x8, mask32x16, u32x16,
};

use super::Visibility;
use crate::raster::bins::Bins;
use crate::raster::covered::Covered;
use crate::raster::depth_format::{Format, with_format};
use crate::raster::entries::{FOUR, put_samples};
use crate::raster::hits::PACK;
use crate::raster::queue::{Pack, Queue};
use crate::raster::rule::{Rule, Usual};
use crate::raster::small::SampledLanes;
use crate::raster::small_edges::Edges;
use crate::raster::tile_queues::SIZES;
use crate::raster::visibility_buffer::BACKGROUND;
use crate::screen::coverage::PixelBox;
use crate::screen::sample_positions::{MANY, SamplePositions};
use crate::screen::tiles::{BLOCK_PIXELS, PIXELS, TILE, lanes_place};
use crate::simd::Bits;

/// The nearest small triangles of a tile.
#[derive(Debug, Default)]
pub(super) struct SmallTriangles {
    bounds: PixelBox,
    sample_positions: SamplePositions,
    /// The number of groups of four samples.
    groups: usize,
    /// The entries, block by block, each group by group.
    entries: Vec<GroupEntries>,
    /// The blocks that any triangle reaches, a bit for each. Entries of other blocks are
    /// meaningless.
    reached: u64,
    covered: Covered,
    /// The triangles left over from packs of fewer than sixteen.
    rest: Queue,
}

/// The entries of a block's pixels in four samples, with the entries of a pixel side by side.
#[derive(Clone, Debug)]
#[repr(align(64))]
struct GroupEntries([[u64; FOUR]; BLOCK_PIXELS]);

/// The entries of sixteen pixels in four samples.
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
                    self.write::<MANY>(simd.level(), block);
                    for group in 0..small.groups {
                        let entries = &small.entries[block * small.groups + group];
                        self.put_pixels(simd, (block, group), &entries.0);
                    }
                }
            },
        );
        self.small = Some(small);
    }

    /// Moves the entries of a block's pixels in a group of samples to the planes of these samples,
    /// with a depth test.
    #[inline(always)]
    fn put_pixels<S: Simd>(
        &mut self,
        simd: S,
        (block, group): (usize, usize),
        pixels: &[[u64; FOUR]; BLOCK_PIXELS],
    ) {
        let first = (block * self.sample_positions.count() + group * FOUR) * BLOCK_PIXELS;
        let planes: &mut [f64] =
            bytemuck::cast_slice_mut(&mut self.buffer.0[first..][..FOUR * BLOCK_PIXELS]);
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
        self.groups = sample_positions.count() / FOUR;
        self.entries.resize(self.groups * BLOCK_PIXELS, GroupEntries([[0; FOUR]; BLOCK_PIXELS]));
        // A cancelled frame leaves triangles in the queue.
        self.rest.clear();
    }

    /// Draws all triangles that wait for a tile.
    #[inline(always)]
    fn draw<S: Simd, D: Format>(&mut self, simd: S, format: D, of: (&[Bins], usize)) {
        for size in 0..SIZES {
            if size + 1 < SIZES {
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
        let Self { bounds, sample_positions, groups, entries, reached, covered, .. } = self;
        let lanes = SampledLanes::<S, E>::new(pack, sample_positions);
        let groups = *groups;
        lanes.each_in(
            *bounds,
            covered,
            #[inline(always)]
            |pixels, count| {
                let place = lanes_place(pixels.x & (TILE - 1), pixels.y & (TILE - 1), (0, 1));
                let places = <[i32; PACK]>::from(place).map(|place| {
                    let place = place.cast_unsigned() as usize % PIXELS;
                    (place / BLOCK_PIXELS, place % BLOCK_PIXELS)
                });
                let places = &places[..count.min(PACK)];
                // The entries of a block are cleared when it is first reached.
                for (block, _) in places {
                    if *reached >> block & 1 == 0 {
                        *reached |= 1 << block;
                        let own = &mut entries[block * groups..][..groups];
                        own.iter_mut().for_each(|group| group.0.as_flattened_mut().fill(0));
                    }
                }
                // A sample that is not covered gets the background's entry, which never wins the
                // depth test.
                let (nothing, background) =
                    (u32x16::splat(simd, 0), u32x16::splat(simd, BACKGROUND));
                for group in 0..groups {
                    let (mut keys, mut numbers) = ([nothing; FOUR], [background; FOUR]);
                    for i in 0..FOUR {
                        let sample = group * FOUR + i;
                        let some = pixels.covered(sample, count);
                        keys[i] = some.select(format.keys(lanes.depths(pixels, sample)), nothing);
                        numbers[i] = some.select(pixels.number, background);
                    }
                    let mut new = Entries([0; FOUR * PACK]);
                    put_samples(keys, numbers, &mut new.0);
                    for ((block, pixel), new) in places.iter().zip(new.0.as_chunks::<FOUR>().0) {
                        // Entries are compared as f64: see `put_rows`.
                        let new = f64x4::from_slice(simd, bytemuck::cast_slice(new));
                        let old = &mut entries[block * groups + group].0[*pixel];
                        let old = bytemuck::cast_slice_mut(old);
                        new.max(f64x4::from_slice(simd, old)).store_slice(old);
                    }
                }
            },
        );
    }
}

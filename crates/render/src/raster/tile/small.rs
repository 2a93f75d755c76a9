//! Draws the small triangles that wait for a tile, with several samples per pixel.
//!
//! The entries of four samples of a pixel are compared at once.

use fearless_simd::{Select as _, Simd, SimdBase as _, SimdMask as _, f64x4, mask32x16, u32x16};

use super::Visibility;
use super::scratch::SmallTriangles;
use crate::raster::bins::Bins;
use crate::raster::depth_format::Format;
use crate::raster::entries::{FOUR, put_samples};
use crate::raster::hits::PACK;
use crate::raster::queue::Pack;
use crate::raster::rule::{Rule, Usual};
use crate::raster::small::SampledLanes;
use crate::raster::small_edges::Edges;
use crate::raster::tile_queues::SIZES;
use crate::raster::visibility_buffer::BACKGROUND;
use crate::screen::sample_positions::MANY;
use crate::screen::tiles::{BLOCK_PIXELS, PIXELS, TILE, lanes_place};

/// The entries of sixteen pixels in four samples.
#[repr(align(64))]
struct Entries([u64; FOUR * PACK]);

/// The edge functions of all sizes but the last, and of the last size.
type Most<S> = <Usual as Rule>::Edges<S>;
type Last<S> = <Usual as Rule>::LastEdges<S>;

impl Visibility {
    /// Draws the small triangles that wait for a tile, from the bins of all threads, with `N`
    /// samples per pixel.
    pub(super) fn draw_small<S: Simd, const N: usize>(
        &mut self,
        simd: S,
        bins: &[Bins],
        tile: usize,
    ) {
        if bins.iter().all(|bins| bins.tile_queues.is_empty(tile)) {
            return;
        }
        let mut small = self.small.take().unwrap_or_default();
        // A cancelled frame leaves triangles in the queue.
        small.rest.clear();
        simd.vectorize(
            #[inline(always)]
            || {
                small.draw::<S, N>(simd, Format(self.depth_format), (bins, tile), self);
            },
        );
        self.small = Some(small);
    }
}

impl SmallTriangles {
    /// Draws all triangles that wait for a tile.
    #[inline(always)]
    fn draw<S: Simd, const N: usize>(
        &mut self,
        simd: S,
        format: Format,
        of: (&[Bins], usize),
        into: &mut Visibility,
    ) {
        for size in 0..SIZES {
            if size + 1 < SIZES {
                self.draw_size::<S, Most<S>, N>(simd, format, (of, size), into);
            } else {
                self.draw_size::<S, Last<S>, N>(simd, format, (of, size), into);
            }
        }
    }

    #[inline(always)]
    fn draw_size<S: Simd, E: Edges<S>, const N: usize>(
        &mut self,
        simd: S,
        format: Format,
        ((bins, tile), size): ((&[Bins], usize), usize),
        into: &mut Visibility,
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
                        return self.draw_pack::<S, E, N>(format, pack, into);
                    }
                    let some = mask32x16::from_bitmask(simd, (1 << count) - 1);
                    if self.rest.add(pack, some, count) {
                        self.draw_rest::<S, E, N>(simd, format, into);
                    }
                },
            );
        }
        self.draw_rest::<S, E, N>(simd, format, into);
    }

    /// Draws the left-over triangles.
    #[inline(always)]
    fn draw_rest<S: Simd, E: Edges<S>, const N: usize>(
        &mut self,
        simd: S,
        format: Format,
        into: &mut Visibility,
    ) {
        for at in (0..self.rest.waiting()).step_by(PACK) {
            let pack = self.rest.pack(simd, at);
            self.draw_pack::<S, E, N>(format, &pack, into);
        }
        self.rest.forget();
    }

    /// Draws sixteen triangles.
    ///
    /// Compiled as a separate function because it is called from several places.
    #[inline(always)]
    fn draw_pack<S: Simd, E: Edges<S>, const N: usize>(
        &mut self,
        format: Format,
        pack: &Pack<S>,
        into: &mut Visibility,
    ) {
        pack[0].simd.vectorize(
            #[inline(always)]
            || self.draw_pack_in::<S, E, N>(format, pack, into),
        );
    }

    #[inline(always)]
    fn draw_pack_in<S: Simd, E: Edges<S>, const N: usize>(
        &mut self,
        format: Format,
        pack: &Pack<S>,
        into: &mut Visibility,
    ) {
        let simd = pack[0].simd;
        let lanes = SampledLanes::<S, E, N>::new(pack, &into.sample_positions);
        lanes.each_in(
            into.bounds,
            &mut self.covered,
            #[inline(always)]
            |pixels, count| {
                let place = lanes_place(pixels.x & (TILE - 1), pixels.y & (TILE - 1), (0, 1));
                let places =
                    <[i32; PACK]>::from(place).map(|place| place.cast_unsigned() as usize % PIXELS);
                let places = &places[..count.min(PACK)];
                for place in places {
                    let block = place / BLOCK_PIXELS;
                    if into.written >> block & 1 == 0 {
                        into.write::<MANY>(simd.level(), block);
                    }
                }
                // A sample that is not covered gets the background's entry, which never wins the
                // depth test.
                let (nothing, background) =
                    (u32x16::splat(simd, 0), u32x16::splat(simd, BACKGROUND));
                for first in (0..N).step_by(FOUR) {
                    let (mut keys, mut numbers) = ([nothing; FOUR], [background; FOUR]);
                    for i in 0..FOUR {
                        let some = pixels.covered(first + i, count);
                        let depth = lanes.depths(pixels, first + i);
                        keys[i] = some.select(format.keys(depth), nothing);
                        numbers[i] = some.select(pixels.number, background);
                    }
                    let mut new = Entries([0; FOUR * PACK]);
                    put_samples(keys, numbers, &mut new.0);
                    for (place, new) in places.iter().zip(new.0.as_chunks::<FOUR>().0) {
                        // Entries are compared as f64: see `put_rows`.
                        let new = f64x4::from_slice(simd, bytemuck::cast_slice(new));
                        let old = &mut into.buffer.0[place * N + first..][..FOUR];
                        let old = bytemuck::cast_slice_mut(old);
                        new.max(f64x4::from_slice(simd, old)).store_slice(old);
                    }
                }
            },
        );
    }
}

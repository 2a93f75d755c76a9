//! Draws the small triangles that wait for a tile, with several samples per pixel.
//!
//! The entries of sixteen samples are compared at once: those of a pixel, or of four neighbours.

use fearless_simd::{Simd, SimdMask as _, mask32x16};

use super::Visibility;
use super::scratch::SmallTriangles;
use crate::raster::bins::Bins;
use crate::raster::depth_format::Format;
use crate::raster::hits::PACK;
use crate::raster::queue::Pack;
use crate::raster::rule::{Rule, Usual};
use crate::raster::small::Lanes;
use crate::raster::small_edges::SampledEdges;
use crate::raster::tile_queues::SIZES;
use crate::raster::visibility_buffer::put_rows;
use crate::screen::sample_positions::MANY;
use crate::screen::tiles::BLOCK_PIXELS;

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
    fn draw_size<S: Simd, E: SampledEdges<S>, const N: usize>(
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
    fn draw_rest<S: Simd, E: SampledEdges<S>, const N: usize>(
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
    fn draw_pack<S: Simd, E: SampledEdges<S>, const N: usize>(
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
    #[expect(clippy::cast_possible_truncation, reason = "up to sixteen")]
    fn draw_pack_in<S: Simd, E: SampledEdges<S>, const N: usize>(
        &mut self,
        format: Format,
        pack: &Pack<S>,
        into: &mut Visibility,
    ) {
        let simd = pack[0].simd;
        let positions = into.sample_positions;
        let across = (MANY / N) as i32;
        Lanes::<S, E>::new(pack, (positions.reach::<N>(), across)).each_entries(
            &positions,
            into.bounds,
            &mut self.covered,
            #[inline(always)]
            |pixel, number, covered, depth| {
                let block = pixel / BLOCK_PIXELS;
                if into.written >> block & 1 == 0 {
                    into.write::<MANY>(simd.level(), block);
                }
                let entries = &mut into.buffer.0.as_chunks_mut().0[pixel * N / MANY];
                put_rows(format, simd, covered, depth, number, entries);
            },
        );
    }
}

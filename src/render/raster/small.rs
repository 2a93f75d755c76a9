//! Rasterizes small triangles, sixteen at a time, one in each lane.
//!
//! Triangles whose bounding box has at most 16 x 16 pixels wait in queues by the size of their
//! boxes. When there are sixteen, their edge functions are stepped together over the pixels of the
//! boxes, and the pixels that they cover are listed: few lanes of a step cover theirs. Then each
//! lane takes a pixel of the list, computes its depth and adds it to the hits of the bins: set-up
//! of triangles of 5 pixels takes 0.55 of what it takes if each step computes depths (AVX-512).
//! How edge functions are computed depends on the rule of coverage: see `small_edges`.

use fearless_simd::{
    Bytes as _, Select as _, Simd, SimdBase as _, SimdInt as _, SimdMask as _, f32x16, i32x16,
    mask32x16, u32x16,
};

use super::bins::Bins;
use super::covered::{Covered, MOST};
use super::hit_colors::{Brush, Triangles};
use super::hits::{PACK, Pixels};
use super::queue::{Pack, SMALL, WAITING};
use super::rule::Rule;
use super::small_edges::Edges;
use crate::render::screen::coverage::PixelBox;
use crate::render::simd::gather::permute;
use crate::render::simd::{Real, UP_TO_SIXTEEN};

/// Draws the triangles that wait in a queue, in packs of sixteen, with `N` samples per pixel.
///
/// Compiled as a function of its own, since what calls it does so at several places.
#[inline(always)]
pub(crate) fn draw_queue<S: Simd, R: Rule, const N: usize>(
    simd: S,
    queue: usize,
    bins: &mut Bins,
    brush: &mut Brush<'_>,
) {
    if N == 1 && bins.hits.are_colored() {
        simd.vectorize(
            #[inline(always)]
            || draw_packs::<S, R, 1, true>(simd, queue, bins, brush),
        );
    } else {
        simd.vectorize(
            #[inline(always)]
            || draw_packs::<S, R, N, false>(simd, queue, bins, brush),
        );
    }
}

#[inline(always)]
fn draw_packs<S: Simd, R: Rule, const N: usize, const COLORED: bool>(
    simd: S,
    queue: usize,
    bins: &mut Bins,
    brush: &mut Brush<'_>,
) {
    let count = bins.queues[queue].count.min(WAITING);
    for at in (0..count).step_by(PACK) {
        let mut pack = bins.queues[queue].pack(simd, at);
        if count - at < PACK {
            let there = mask32x16::from_bitmask(simd, (1 << (count - at)) - 1);
            // An empty box holds no pixels.
            let nothing = i32x16::splat(simd, 0);
            for row in &mut pack {
                *row = there.select(*row, nothing);
            }
        }
        draw_pack::<S, R, N, COLORED>((queue, at), &pack, bins, brush);
    }
    bins.queues[queue].forget();
}

/// Draws sixteen triangles of a queue, from `at` on.
#[inline(always)]
pub(super) fn draw_pack<S: Simd, R: Rule, const N: usize, const COLORED: bool>(
    (queue, at): (usize, usize),
    pack: &Pack<S>,
    bins: &mut Bins,
    brush: &mut Brush<'_>,
) {
    if queue + 1 == SMALL.len() {
        draw::<S, R::LastEdges<S>, N, COLORED>((queue, at), pack, bins, brush);
    } else {
        draw::<S, R::Edges<S>, N, COLORED>((queue, at), pack, bins, brush);
    }
}

#[inline(always)]
fn draw<S: Simd, E: Edges<S>, const N: usize, const COLORED: bool>(
    (queue, at): (usize, usize),
    pack: &Pack<S>,
    bins: &mut Bins,
    brush: &mut Brush<'_>,
) {
    let simd = pack[0].simd;
    let sample_positions = bins.sample_positions;
    let lanes = Lanes::<S, E>::new(simd, pack, sample_positions.reach::<N>());
    let reach = bins.hits.reach(lanes.bounds());
    let Bins { hits, covered, queues, .. } = bins;
    let shifts = lanes.edges.shifts::<N>(&sample_positions);
    for (sample, shift) in shifts.iter().enumerate() {
        lanes.scan::<N>(shift, covered);
        let mut mix = None;
        if COLORED && covered.count > 0 {
            let (per_area, clockwise) = areas(pack);
            let triangles = Triangles {
                numbers: &lanes.number.into(),
                vertices: &queues[queue].vertices(at),
                some: covered.lanes(),
                clockwise,
            };
            mix = brush.mix(per_area, &triangles);
        }
        lanes.each_pixel::<N>(
            shift,
            covered,
            #[inline(always)]
            |own, by, pixel| match (&mix, lanes.edges.functions(own, by)) {
                _ if !COLORED => None,
                (Some(mix), Some(functions)) => Some(mix.colors(own, functions, pixel)),
                _ => Some(u32x16::splat(simd, 0)),
            },
            #[inline(always)]
            |pixels, count| hits.add_first::<S, N>(&reach, (pixels, sample), count),
        );
    }
}

/// 1 / the doubled areas of sixteen triangles, and which of them run clockwise on the screen.
#[inline(always)]
fn areas<S: Simd>([x0, y0, x1, y1, x2, y2, ..]: &Pack<S>) -> (f32x16<S>, u64) {
    let area = (*x1 - *x0) * (*y2 - *y0) - (*y1 - *y0) * (*x2 - *x0);
    let doubled: f32x16<S> = area.max(i32x16::splat(x0.simd, 0) - area).to_float();
    (f32x16::splat(x0.simd, 1.0) / doubled, area.simd_gt(0).to_bitmask())
}

/// Sixteen small triangles, set up for rasterization.
struct Lanes<S: Simd, E> {
    /// The bounding boxes.
    left: i32x16<S>,
    top: i32x16<S>,
    right: i32x16<S>,
    bottom: i32x16<S>,
    number: u32x16<S>,
    edges: E,
    low: f32x16<S>,
    high: f32x16<S>,
}

impl<S: Simd, E: Edges<S>> Lanes<S, E> {
    #[inline(always)]
    fn new(simd: S, pack: &Pack<S>, reach: [[i32; 2]; 2]) -> Self {
        let [x0, y0, x1, y1, x2, y2, d0, d1, d2, number] = *pack;
        let corners = [[x0, y0], [x1, y1], [x2, y2]];
        let [left, top, right, bottom] = E::bounds(corners, reach);
        let (d0, d1, d2) =
            (d0.bitcast::<f32x16<S>>(), d1.bitcast::<f32x16<S>>(), d2.bitcast::<f32x16<S>>());
        Self {
            left,
            top,
            right,
            bottom,
            number: number.bitcast(),
            edges: E::new(simd, corners, [left, top, right, bottom], [d0, d1, d2]),
            low: Real::min(Real::min(d0, d1), d2),
            high: Real::max(Real::max(d0, d1), d2),
        }
    }

    /// The bounding box of all boxes.
    #[inline(always)]
    fn bounds(&self) -> PixelBox {
        PixelBox {
            left: self.left.reduce_min(),
            top: self.top.reduce_min(),
            right: self.right.reduce_max(),
            bottom: self.bottom.reduce_max(),
        }
    }

    /// Lists the pixels that the triangles cover in the sample with an offset.
    #[inline(always)]
    fn scan<const N: usize>(&self, shift: &E::Shift, covered: &mut Covered) {
        let columns = (self.right - self.left).reduce_max();
        let rows = (self.bottom - self.top).reduce_max();
        let mut row = self.edges.first();
        if N > 1 {
            row = self.edges.moved(row, *shift);
        }
        let mut count = 0;
        let mut row_pixels = i32x16::from_slice(self.left.simd, &UP_TO_SIXTEEN);
        for _ in 0..rows {
            let (mut at, mut pixels) = (row, row_pixels);
            for _ in 0..columns {
                let some = self.edges.covered(at);
                let to = count % MOST;
                pixels.compress(some).store_slice(&mut covered.pixels[to..to + PACK]);
                count = to + some.to_bitmask().count_ones() as usize;
                at = self.edges.right(at);
                pixels += 1 << 4;
            }
            row = self.edges.below(row);
            row_pixels += 1 << 8;
        }
        covered.count = count;
    }

    /// Calls `take` with the pixels of a list, sixteen at a time, and their number. `color` gives
    /// their colours by the lanes of their triangles, their distances from the first pixels of the
    /// boxes, and their columns and rows.
    #[inline(always)]
    fn each_pixel<const N: usize>(
        &self,
        shift: &E::Shift,
        covered: &Covered,
        color: impl Fn(i32x16<S>, [i32x16<S>; 2], [i32x16<S>; 2]) -> Option<u32x16<S>>,
        mut take: impl FnMut(&Pixels<S>, usize),
    ) {
        let shift = (N > 1).then_some(shift);
        for at in (0..covered.count).step_by(PACK) {
            let pixels = i32x16::from_slice(self.left.simd, &covered.pixels[at..at + PACK]);
            let by = [(pixels >> 4) & 15, pixels >> 8];
            let lanes = pixels & 15;
            let depth = self.edges.depths(lanes, by, shift);
            let low = permute(self.low.bitcast(), lanes).bitcast::<f32x16<S>>();
            let high = permute(self.high.bitcast(), lanes).bitcast::<f32x16<S>>();
            // Clamped to the depths of the corners.
            let depth = depth.simd_gt(low).select(depth, low);
            let depth = depth.simd_lt(high).select(depth, high);
            let x = permute(self.left, lanes) + by[0];
            let y = permute(self.top, lanes) + by[1];
            let pixels = Pixels {
                x,
                y,
                depth: depth.bitcast(),
                number: permute(self.number.bitcast(), lanes).bitcast(),
                color: color(lanes, by, [x, y]),
            };
            take(&pixels, (covered.count - at).min(PACK));
        }
    }
}

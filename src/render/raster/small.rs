//! Rasterizes small triangles, sixteen at a time, one in each lane.
//!
//! Triangles whose bounding box has at most 8 x 8 pixels wait in queues by the size of their boxes.
//! When there are sixteen, their edge functions are stepped together over the pixels of the boxes,
//! and the pixels that they cover become hits in the bins. How edge functions are computed depends
//! on the rule of coverage: see `small_edges`.

use fearless_simd::{
    Bytes as _, Select as _, Simd, SimdBase as _, SimdMask as _, f32x16, i32x16, mask32x16, u32x16,
};

use super::bins::Bins;
use super::hits::{PACK, Pixels};
use super::queue::{Pack, WAITING};
use super::rule::Rule;
use super::small_edges::Edges;
use crate::render::screen::coverage::PixelBox;
use crate::render::screen::sample_positions::SamplePositions;
use crate::render::simd::Real;

/// Draws the triangles that wait in a queue, in packs of sixteen, with `N` samples per pixel.
///
/// Compiled as a function of its own, since what calls it does so at several places.
#[inline(always)]
pub(crate) fn draw_queue<S: Simd, R: Rule, const N: usize>(simd: S, queue: usize, bins: &mut Bins) {
    simd.vectorize(
        #[inline(always)]
        || {
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
                draw::<S, R, N>(simd, &pack, bins);
            }
            bins.queues[queue].forget();
        },
    );
}

/// Draws sixteen triangles whose boxes have at most 8 x 8 pixels.
#[inline(always)]
pub(crate) fn draw<S: Simd, R: Rule, const N: usize>(simd: S, pack: &Pack<S>, bins: &mut Bins) {
    let sample_positions = bins.sample_positions;
    let lanes = Lanes::<S, R::Edges<S>>::new(simd, pack, sample_positions.reach::<N>());
    let reach = bins.hits.reach(lanes.bounds());
    lanes.each_sample::<N>(
        &sample_positions,
        #[inline(always)]
        |[x, y], sample, covered, depth| {
            let pixels = Pixels { x, y, depth: depth.bitcast(), number: lanes.number };
            bins.hits.add::<S, N>(&reach, (&pixels, sample), covered);
        },
    );
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

    /// Calls `take` with the pixels of the boxes, step by step, and each of their `N` samples, if
    /// any triangle covers its own; with the coverage and the depths.
    #[inline(always)]
    fn each_sample<const N: usize>(
        &self,
        sample_positions: &SamplePositions,
        mut take: impl FnMut([i32x16<S>; 2], usize, mask32x16<S>, f32x16<S>),
    ) {
        let shifts = self.edges.shifts::<N>(sample_positions);
        let columns = (self.right - self.left).reduce_max();
        let rows = (self.bottom - self.top).reduce_max();
        let mut row = self.edges.first();
        for dy in 0..rows {
            let mut at = row;
            for dx in 0..columns {
                for (sample, shift) in shifts.iter().enumerate() {
                    let edges = if N == 1 { at } else { self.edges.moved(at, *shift) };
                    let covered = self.edges.covered(edges);
                    if covered.any_true() {
                        let pixel = [self.left + dx, self.top + dy];
                        take(pixel, sample, covered, self.depth_at(edges));
                    }
                }
                at = self.edges.right(at);
            }
            row = self.edges.below(row);
        }
    }

    /// The depths at a pixel, clamped to the depths of the corners.
    #[inline(always)]
    fn depth_at(&self, at: E::At) -> f32x16<S> {
        let depth = self.edges.depth(at);
        let depth = depth.simd_gt(self.low).select(depth, self.low);
        depth.simd_lt(self.high).select(depth, self.high)
    }
}

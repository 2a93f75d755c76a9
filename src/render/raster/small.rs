//! Rasterizes small triangles, sixteen at a time, one in each lane.
//!
//! Triangles whose bounding box has at most 8 x 8 pixels wait in queues by the size of their boxes.
//! When there are sixteen, their edge functions are stepped together over the pixels of the boxes,
//! and the pixels that they cover become hits in the bins. The arithmetic is f32, in which integers
//! below 2^24 are exact: no edge function in such a box is larger.

use fearless_simd::{
    Bytes as _, Select as _, Simd, SimdBase as _, SimdInt as _, SimdMask as _, f32x16, i32x16,
    mask32x16, u32x16,
};

use super::bins::Bins;
use super::hits::{PACK, Pixels};
use super::queue::{Pack, WAITING};
use crate::base::math::each;
use crate::render::screen::coverage::{PixelBox, SUBPIXELS};
use crate::render::screen::sample_positions::SamplePositions;
use crate::render::simd::Real;

/// Draws the triangles of a full queue, in packs of sixteen, with `N` samples per pixel.
#[inline(always)]
pub(crate) fn draw_full<S: Simd, const N: usize>(simd: S, queue: usize, bins: &mut Bins) {
    for at in (0..WAITING).step_by(PACK) {
        let pack = bins.queues[queue].pack(simd, at);
        draw::<S, N>(simd, &pack, bins);
    }
    bins.queues[queue].forget();
}

/// Draws the triangles that are left in a queue.
#[inline(always)]
pub(crate) fn draw_rest<S: Simd, const N: usize>(simd: S, queue: usize, bins: &mut Bins) {
    let count = std::mem::take(&mut bins.queues[queue].count);
    for at in (0..count).step_by(PACK) {
        let mut pack = bins.queues[queue].pack(simd, at);
        let there = mask32x16::from_bitmask(simd, (1 << (count - at).min(PACK)) - 1);
        // An empty box holds no pixels.
        let nothing = i32x16::splat(simd, 0);
        for row in &mut pack {
            *row = there.select(*row, nothing);
        }
        draw::<S, N>(simd, &pack, bins);
    }
}

/// Draws sixteen triangles whose boxes have at most 8 x 8 pixels.
#[inline(always)]
pub(crate) fn draw<S: Simd, const N: usize>(simd: S, pack: &Pack<S>, bins: &mut Bins) {
    let sample_positions = bins.sample_positions;
    let lanes = Lanes::new(simd, pack, sample_positions.reach::<N>());
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
struct Lanes<S: Simd> {
    /// The bounding boxes.
    left: i32x16<S>,
    top: i32x16<S>,
    right: i32x16<S>,
    bottom: i32x16<S>,
    number: u32x16<S>,
    /// The edge functions at the first pixel of the box; positive inside, whatever the winding.
    first: [f32x16<S>; 3],
    /// The least values that count as covered: 0, or 1 if the top-left rule excludes centres on the
    /// edge.
    least: [f32x16<S>; 3],
    /// The steps of an edge function by a pixel to the right, and by one down.
    a: [f32x16<S>; 3],
    b: [f32x16<S>; 3],
    depth: f32x16<S>,
    to_second: f32x16<S>,
    to_third: f32x16<S>,
    low: f32x16<S>,
    high: f32x16<S>,
}

impl<S: Simd> Lanes<S> {
    #[inline(always)]
    fn new(simd: S, pack: &Pack<S>, [least, most]: [[i32; 2]; 2]) -> Self {
        let [x0, y0, x1, y1, x2, y2, d0, d1, d2, number] = *pack;
        let half = SUBPIXELS / 2;
        let left = (x0.min(x1).min(x2) + (half - 1 - most[0])) >> 8;
        let top = (y0.min(y1).min(y2) + (half - 1 - most[1])) >> 8;
        let right = ((x0.max(x1).max(x2) - (half + least[0])) >> 8) + 1;
        let bottom = ((y0.max(y1).max(y2) - (half + least[1])) >> 8) + 1;
        // Coordinates relative to the centre of the first pixel.
        let (cx, cy) = ((left << 8) + half, (top << 8) + half);
        let [x0, x1, x2] = each([x0, x1, x2], |x| (x - cx).to_float::<f32x16<S>>());
        let [y0, y1, y2] = each([y0, y1, y2], |y| (y - cy).to_float::<f32x16<S>>());
        let [d0, d1, d2] = each([d0, d1, d2], |d| d.bitcast::<f32x16<S>>());

        let area = (x1 - x0) * (y2 - y0) - (y1 - y0) * (x2 - x0);
        let one = f32x16::splat(simd, 1.0);
        let sign = area.simd_lt(0.0).select(f32x16::splat(simd, -1.0), one);
        let e0 = edge([x1, y1], [x2, y2], sign);
        let e1 = edge([x2, y2], [x0, y0], sign);
        let e2 = edge([x0, y0], [x1, y1], sign);
        // Triangles without area cover nothing; 1 keeps quotients finite.
        let area = area * sign;
        let per_area = one / area.simd_gt(0.0).select(area, one);
        Self {
            left,
            top,
            right,
            bottom,
            number: number.bitcast(),
            first: [e0.value, e1.value, e2.value],
            least: [e0.least, e1.least, e2.least],
            a: [e0.a, e1.a, e2.a],
            b: [e0.b, e1.b, e2.b],
            depth: d0,
            to_second: (d1 - d0) * per_area,
            to_third: (d2 - d0) * per_area,
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
        let shifts = self.shifts::<N>(sample_positions);
        let columns = (self.right - self.left).reduce_max();
        let rows = (self.bottom - self.top).reduce_max();
        let mut row = self.first;
        for dy in 0..rows {
            let mut edges = row;
            for dx in 0..columns {
                for (sample, shift) in shifts.iter().enumerate() {
                    let edges = if N == 1 { edges } else { step(edges, *shift) };
                    let covered = edges[0].simd_ge(self.least[0])
                        & edges[1].simd_ge(self.least[1])
                        & edges[2].simd_ge(self.least[2]);
                    if covered.any_true() {
                        let pixel = [self.left + dx, self.top + dy];
                        take(pixel, sample, covered, self.depth_at(edges));
                    }
                }
                edges = step(edges, self.a);
            }
            row = step(row, self.b);
        }
    }

    /// The offsets of the edge functions from the centre of a pixel to its samples.
    #[inline(always)]
    fn shifts<const N: usize>(&self, sample_positions: &SamplePositions) -> [[f32x16<S>; 3]; N] {
        let mut shifts = [[f32x16::splat(self.depth.simd, 0.0); 3]; N];
        for (sample, shift) in shifts.iter_mut().enumerate() {
            let [x, y] = sample_positions.shift::<N>(sample).map(|by| by as f32 / SUBPIXELS as f32);
            *shift = [
                self.a[0] * x + self.b[0] * y,
                self.a[1] * x + self.b[1] * y,
                self.a[2] * x + self.b[2] * y,
            ];
        }
        shifts
    }

    /// The depths at a pixel, linear on the screen and clamped to the depths of the corners.
    #[inline(always)]
    fn depth_at(&self, edges: [f32x16<S>; 3]) -> f32x16<S> {
        let depth = self.depth + edges[1] * self.to_second + edges[2] * self.to_third;
        let depth = depth.simd_gt(self.low).select(depth, self.low);
        depth.simd_lt(self.high).select(depth, self.high)
    }
}

#[inline(always)]
fn step<S: Simd>([x, y, z]: [f32x16<S>; 3], by: [f32x16<S>; 3]) -> [f32x16<S>; 3] {
    [x + by[0], y + by[1], z + by[2]]
}

/// An edge function of sixteen triangles.
struct LanesEdge<S: Simd> {
    value: f32x16<S>,
    least: f32x16<S>,
    a: f32x16<S>,
    b: f32x16<S>,
}

/// As in `coverage`: a = p.y - q.y, b = q.x - p.x, e = a (x - p.x) + b (y - p.y) at x = y = 0;
/// multiplied by the sign of the area, with its steps by whole pixels.
#[inline(always)]
fn edge<S: Simd>(
    [px, py]: [f32x16<S>; 2],
    [qx, qy]: [f32x16<S>; 2],
    sign: f32x16<S>,
) -> LanesEdge<S> {
    let (a, b) = ((py - qy) * sign, (qx - px) * sign);
    let on_edge = a.simd_gt(0.0) | (a.simd_eq(0.0) & b.simd_gt(0.0));
    let simd = px.simd;
    let (zero, one) = (f32x16::splat(simd, 0.0), f32x16::splat(simd, 1.0));
    LanesEdge {
        value: zero - (a * px + b * py),
        least: on_edge.select(zero, one),
        a: a * (SUBPIXELS as f32),
        b: b * (SUBPIXELS as f32),
    }
}

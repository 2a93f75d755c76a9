//! Edge functions on the usual grid, in 32-bit integers, for boxes of up to 16 x 16 pixels. Depths
//! have the same bits as in `medium`.

use fearless_simd::{
    Bytes as _, Select as _, Simd, SimdBase as _, SimdInt as _, SimdNarrow as _, SimdWiden as _,
    f32x16, f64x8, i32x16, mask32x16, u32x16,
};

use super::{Boxes, Corners, Edges, of_lanes, snapped_bounds, whole_edge};
use crate::screen::coverage::{Grid, SUBPIXELS};
use crate::screen::sample_positions::SamplePositions;
use crate::simd::gather::permute;
use crate::simd::in_f64;
use marraztu_core::base::math::each;

/// Integer edge functions on the usual grid.
#[derive(Clone, Copy)]
pub(crate) struct WholeEdges<S: Simd> {
    /// The edge functions at the first pixel, minus their smallest covered values.
    first: [i32x16<S>; 3],
    /// The steps of the edge functions for one pixel to the right and one pixel down.
    a: [i32x16<S>; 3],
    b: [i32x16<S>; 3],
    /// The smallest covered values of the second and third edge function, needed for depth.
    least: [i32x16<S>; 2],
    depth: f32x16<S>,
    to_second: Doubles<S>,
    to_third: Doubles<S>,
}

/// Sixteen f64 numbers, as the lower and upper halves of their bits.
type Doubles<S> = [i32x16<S>; 2];

impl<S: Simd> WholeEdges<S> {
    /// Computes an edge function of the triangles in these lanes, at this distance from their first
    /// pixels.
    #[inline(always)]
    fn edge(&self, i: usize, lanes: i32x16<S>, [dx, dy]: [i32x16<S>; 2]) -> i32x16<S> {
        let first = permute(self.first[i] + self.least[i - 1], lanes);
        first + permute(self.a[i], lanes) * dx + permute(self.b[i], lanes) * dy
    }

    /// Computes the same in f64, in the sample with this offset.
    #[inline(always)]
    fn edge_in_f64(
        &self,
        i: usize,
        lanes: i32x16<S>,
        by: [i32x16<S>; 2],
        shift: Option<&[i32x16<S>; 3]>,
    ) -> [f64x8<S>; 2] {
        let at = self.edge(i, lanes, by);
        in_f64(match shift {
            Some(shift) => at + permute(shift[i], lanes),
            None => at,
        })
    }
}

impl<S: Simd> Edges<S> for WholeEdges<S> {
    type At = [i32x16<S>; 3];
    type Shift = [i32x16<S>; 3];

    #[inline(always)]
    fn bounds(corners: Corners<S>, reach: [[i32; 2]; 2]) -> Boxes<S> {
        snapped_bounds(Grid::Usual, corners, reach)
    }

    #[inline(always)]
    fn new(
        simd: S,
        [p, q, r]: Corners<S>,
        [left, top, ..]: Boxes<S>,
        [d0, d1, d2]: [f32x16<S>; 3],
    ) -> Self {
        // Corners relative to the centre of the box's first pixel.
        let half = SUBPIXELS / 2;
        let (cx, cy) = ((left << 8) + half, (top << 8) + half);
        let [x0, x1, x2] = each([p[0], q[0], r[0]], |x| x - cx);
        let [y0, y1, y2] = each([p[1], q[1], r[1]], |y| y - cy);
        let area = (x1 - x0) * (y2 - y0) - (y1 - y0) * (x2 - x0);
        let (zero, one) = (i32x16::splat(simd, 0), i32x16::splat(simd, 1));
        let sign = area.simd_lt(0).select(zero - one, one);
        let [first, second, third] = [
            whole_edge([x1, y1], [x2, y2], sign),
            whole_edge([x2, y2], [x0, y0], sign),
            whole_edge([x0, y0], [x1, y1], sign),
        ];
        // The reciprocal of the area is shared by both depth gradients. 1 keeps it finite.
        let area = in_f64((area * sign).max(1));
        let [d1, d2] = [per_area(d0, d1, area), per_area(d0, d2, area)];
        Self {
            first: [first.value, second.value, third.value],
            a: [first.a * SUBPIXELS, second.a * SUBPIXELS, third.a * SUBPIXELS],
            b: [first.b * SUBPIXELS, second.b * SUBPIXELS, third.b * SUBPIXELS],
            least: [second.least, third.least],
            depth: d0,
            to_second: d1,
            to_third: d2,
        }
    }

    #[inline(always)]
    fn first(&self) -> Self::At {
        self.first
    }

    #[inline(always)]
    fn right(&self, [a, b, c]: Self::At) -> Self::At {
        [a + self.a[0], b + self.a[1], c + self.a[2]]
    }

    #[inline(always)]
    fn below(&self, [a, b, c]: Self::At) -> Self::At {
        [a + self.b[0], b + self.b[1], c + self.b[2]]
    }

    #[inline(always)]
    fn shifts<const N: usize>(&self, sample_positions: &SamplePositions) -> [Self::Shift; N] {
        let mut shifts = [self.first; N];
        for (sample, shift) in shifts.iter_mut().enumerate() {
            let [x, y] = sample_positions.shift::<N>(sample);
            for (i, shift) in shift.iter_mut().enumerate() {
                *shift = (self.a[i] >> 8) * x + (self.b[i] >> 8) * y;
            }
        }
        shifts
    }

    #[inline(always)]
    fn moved(&self, [a, b, c]: Self::At, shift: Self::Shift) -> Self::At {
        [a + shift[0], b + shift[1], c + shift[2]]
    }

    #[inline(always)]
    fn covered(&self, [a, b, c]: Self::At) -> mask32x16<S> {
        (a | b | c).simd_ge(0)
    }

    #[inline(always)]
    fn functions(&self, lanes: i32x16<S>, by: [i32x16<S>; 2]) -> Option<[f32x16<S>; 2]> {
        Some([self.edge(1, lanes, by).to_float(), self.edge(2, lanes, by).to_float()])
    }

    #[inline(always)]
    fn depths(
        &self,
        lanes: i32x16<S>,
        by: [i32x16<S>; 2],
        shift: Option<&Self::Shift>,
    ) -> f32x16<S> {
        let second = self.edge_in_f64(1, lanes, by, shift);
        let third = self.edge_in_f64(2, lanes, by, shift);
        let (low, high) = of_lanes(self.depth, lanes).widen();
        let to_second = doubles(self.to_second, lanes);
        let to_third = doubles(self.to_third, lanes);
        let low = second[0] * to_second[0] + low + third[0] * to_third[0];
        let high = second[1] * to_second[1] + high + third[1] * to_third[1];
        low.narrow(high)
    }
}

/// Divides depth differences by areas.
#[inline(always)]
fn per_area<S: Simd>(from: f32x16<S>, to: f32x16<S>, area: [f64x8<S>; 2]) -> Doubles<S> {
    let one = f64x8::splat(from.simd, 1.0);
    let ((from_low, from_high), (to_low, to_high)) = (from.widen(), to.widen());
    let low = (to_low - from_low) * (one / area[0]);
    let high = (to_high - from_high) * (one / area[1]);
    // Stored as halves because lanes are permuted in 32-bit units.
    let (low, high) = low.bitcast::<u32x16<S>>().deinterleave(high.bitcast::<u32x16<S>>());
    [low.bitcast(), high.bitcast()]
}

/// Picks the numbers of some lanes.
#[inline(always)]
fn doubles<S: Simd>([low, high]: Doubles<S>, lanes: i32x16<S>) -> [f64x8<S>; 2] {
    let (first, second) = permute(low, lanes).interleave(permute(high, lanes));
    [first.bitcast(), second.bitcast()]
}

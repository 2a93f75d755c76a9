//! Edge functions on the usual grid, in f32: integers below 2^24 are exact, and no edge function in
//! a box of 8 x 8 pixels is larger.

use fearless_simd::{Select as _, Simd, SimdBase as _, SimdInt as _, f32x16, i32x16, mask32x16};

use super::edges::{Boxes, Corners, Edge, Edges, LinearDepths, Places, SampledEdges};
use crate::screen::coverage::SUBPIXELS;
use crate::simd::gather::of_lanes;
use marraztu_core::base::math::each;

/// Edge functions on the usual grid.
#[derive(Clone, Copy)]
pub(crate) struct UsualEdges<S: Simd> {
    first: [f32x16<S>; 3],
    /// The smallest covered values.
    least: [f32x16<S>; 3],
    /// The steps of the edge functions for one pixel to the right and one pixel down.
    steps: [[f32x16<S>; 3]; 2],
    gradients: [f32x16<S>; 3],
}

impl<S: Simd> Edges<S> for UsualEdges<S> {
    type At = [f32x16<S>; 3];
    type Shift = [f32x16<S>; 3];
    type Pixels = LinearDepths<S>;

    #[inline(always)]
    fn new(
        simd: S,
        [p, q, r]: Corners<S>,
        [left, top, ..]: Boxes<S>,
        [d0, d1, d2]: [f32x16<S>; 3],
    ) -> Self {
        // Coordinates relative to the centre of the first pixel.
        let half = SUBPIXELS / 2;
        let (cx, cy) = ((left << 8) + half, (top << 8) + half);
        let [x0, x1, x2] = each([p[0], q[0], r[0]], |x| (x - cx).to_float::<f32x16<S>>());
        let [y0, y1, y2] = each([p[1], q[1], r[1]], |y| (y - cy).to_float::<f32x16<S>>());
        let area = (x1 - x0) * (y2 - y0) - (y1 - y0) * (x2 - x0);
        let one = f32x16::splat(simd, 1.0);
        // The sign makes edge functions positive inside for either winding.
        let sign = area.simd_lt(0.0).select(f32x16::splat(simd, -1.0), one);
        let edges = [
            edge([x1, y1], [x2, y2], sign),
            edge([x2, y2], [x0, y0], sign),
            edge([x0, y0], [x1, y1], sign),
        ];
        // Triangles without area cover no pixel; 1 keeps the quotients finite.
        let area = area * sign;
        let per_area = one / area.simd_gt(0.0).select(area, one);
        Self {
            first: each(edges, |edge| edge.value),
            least: each(edges, |edge| edge.least),
            steps: [each(edges, |edge| edge.a), each(edges, |edge| edge.b)],
            gradients: [d0, (d1 - d0) * per_area, (d2 - d0) * per_area],
        }
    }

    #[inline(always)]
    fn first(&self) -> Self::At {
        self.first
    }

    #[inline(always)]
    fn step(&self, at: Self::At, axis: usize) -> Self::At {
        self.moved(at, self.steps[axis])
    }

    #[inline(always)]
    fn shift(&self, by: [i32; 2]) -> Self::Shift {
        // Steps are multiples of 256 and offsets are in 1/256 pixel, so the products are exact.
        let ([a, b], [x, y]) = (self.steps, by.map(|by| by as f32 / SUBPIXELS as f32));
        [a[0] * x + b[0] * y, a[1] * x + b[1] * y, a[2] * x + b[2] * y]
    }

    #[inline(always)]
    fn moved(&self, [x, y, z]: Self::At, by: Self::Shift) -> Self::At {
        [x + by[0], y + by[1], z + by[2]]
    }

    #[inline(always)]
    fn covered(&self, at: Self::At) -> mask32x16<S> {
        at[0].simd_ge(self.least[0]) & at[1].simd_ge(self.least[1]) & at[2].simd_ge(self.least[2])
    }

    /// The result is exact, like stepping.
    #[inline(always)]
    fn function(
        &self,
        i: usize,
        (lanes, [dx, dy], shift): Places<'_, S, Self::Shift>,
    ) -> f32x16<S> {
        let (dx, dy) = (dx.to_float::<f32x16<S>>(), dy.to_float::<f32x16<S>>());
        let [a, b] = [of_lanes(self.steps[0][i], lanes), of_lanes(self.steps[1][i], lanes)];
        let at = of_lanes(self.first[i], lanes) + a * dx + b * dy;
        match shift {
            Some(shift) => at + of_lanes(shift[i], lanes),
            None => at,
        }
    }

    #[inline(always)]
    fn pixels(&self, lanes: i32x16<S>, by: [i32x16<S>; 2]) -> Self::Pixels {
        LinearDepths::new(self, self.gradients, (lanes, by, None))
    }

    #[inline(always)]
    fn depths(
        &self,
        pixels: &Self::Pixels,
        (lanes, shift): (i32x16<S>, Option<&Self::Shift>),
    ) -> f32x16<S> {
        // Edge functions are whole numbers, so sums of them are exact.
        match shift {
            Some(shift) => {
                pixels.moved([of_lanes(shift[1], lanes), of_lanes(shift[2], lanes)]).at_pixels()
            }
            None => pixels.at_pixels(),
        }
    }
}

/// Sixteen triangles, to be drawn one after the other.
pub(crate) struct EachUsual<S: Simd> {
    /// The changes of the edge functions in sixteen entries.
    gains: [[f32x16<S>; 3]; 16],
    least: [[f32; 16]; 3],
    gradients: [[f32; 16]; 3],
}

impl<S: Simd> SampledEdges<S> for UsualEdges<S> {
    type Value = f32;
    type Each = EachUsual<S>;

    #[inline(always)]
    fn most(&self, offsets: [[i32; 2]; 2]) -> Self::Shift {
        let [a, b] = self.steps;
        let [from, to] = offsets.map(|offset| offset.map(|by| by as f32 / SUBPIXELS as f32));
        each(
            [[a[0], b[0]], [a[1], b[1]], [a[2], b[2]]],
            #[inline(always)]
            |[a, b]| (a * from[0]).max(a * to[0]) + (b * from[1]).max(b * to[1]),
        )
    }

    #[inline(always)]
    fn each(&self, [x, y]: [i32x16<S>; 2]) -> Self::Each {
        let subpixel = 1.0 / SUBPIXELS as f32;
        let (x, y) = (x.to_float::<f32x16<S>>() * subpixel, y.to_float::<f32x16<S>>() * subpixel);
        let [a, b] = &self.steps;
        let (a, b) = (each(*a, <[f32; 16]>::from), each(*b, <[f32; 16]>::from));
        let mut all = EachUsual {
            gains: [[x; 3]; 16],
            least: each(self.least, <[f32; 16]>::from),
            gradients: each(self.gradients, <[f32; 16]>::from),
        };
        for (lane, gains) in all.gains.iter_mut().enumerate() {
            *gains = [
                x * a[0][lane] + y * b[0][lane],
                x * a[1][lane] + y * b[1][lane],
                x * a[2][lane] + y * b[2][lane],
            ];
        }
        all
    }

    #[inline(always)]
    fn values(&self, i: usize, (lanes, by): (i32x16<S>, [i32x16<S>; 2])) -> [f32; 16] {
        self.function(i, (lanes, by, None)).into()
    }

    #[inline(always)]
    fn in_entries(of: &Self::Each, lane: usize, at: [f32; 3]) -> (mask32x16<S>, f32x16<S>) {
        let EachUsual { gains, least, gradients } = of;
        let lane = lane % 16;
        let [first, second, third] = gains[lane];
        let [first, second, third] = [first + at[0], second + at[1], third + at[2]];
        let covered = first.simd_ge(least[0][lane])
            & second.simd_ge(least[1][lane])
            & third.simd_ge(least[2][lane]);
        // As in `LinearDepths`: the sums of edge functions are exact.
        let [depth, to_second, to_third] = [0, 1, 2].map(|i| gradients[i][lane]);
        (covered, second * to_second + depth + third * to_third)
    }
}

/// Computes an edge function as in `coverage`, multiplied by the sign of the area, with steps by
/// whole pixels: a = p.y - q.y, b = q.x - p.x, e = a (x - p.x) + b (y - p.y) at x = y = 0.
#[inline(always)]
fn edge<S: Simd>(
    [px, py]: [f32x16<S>; 2],
    [qx, qy]: [f32x16<S>; 2],
    sign: f32x16<S>,
) -> Edge<f32x16<S>> {
    let (a, b) = ((py - qy) * sign, (qx - px) * sign);
    // The top-left rule: centres on a left or top edge are covered.
    let on_edge = a.simd_gt(0.0) | (a.simd_eq(0.0) & b.simd_gt(0.0));
    let (zero, one) = (f32x16::splat(px.simd, 0.0), f32x16::splat(px.simd, 1.0));
    Edge {
        value: zero - (a * px + b * py),
        least: on_edge.select(zero, one),
        a: a * (SUBPIXELS as f32),
        b: b * (SUBPIXELS as f32),
    }
}

//! Edge functions on the usual grid, in f32: integers below 2^24 are exact, and no edge function in
//! a box of 8 x 8 pixels is larger.

use fearless_simd::{Select as _, Simd, SimdBase as _, SimdInt as _, f32x16, i32x16, mask32x16};

use super::{Boxes, Corners, Edges, of_lanes, snapped_bounds};
use crate::screen::coverage::{Grid, SUBPIXELS};
use crate::screen::sample_positions::SamplePositions;
use marraztu_core::base::math::each;

/// Edge functions on the usual grid.
#[derive(Clone, Copy)]
pub(crate) struct UsualEdges<S: Simd> {
    first: [f32x16<S>; 3],
    /// The smallest covered values: 0, or 1 if the top-left rule excludes centres on the edge.
    least: [f32x16<S>; 3],
    /// The steps of the edge functions for one pixel to the right and one pixel down.
    a: [f32x16<S>; 3],
    b: [f32x16<S>; 3],
    depth: f32x16<S>,
    to_second: f32x16<S>,
    to_third: f32x16<S>,
}

impl<S: Simd> UsualEdges<S> {
    /// Computes an edge function of the triangles in these lanes, at this distance from their first
    /// pixels. The result is exact, like stepping.
    #[inline(always)]
    fn edge(
        &self,
        i: usize,
        lanes: i32x16<S>,
        [dx, dy]: [f32x16<S>; 2],
        shift: Option<&[f32x16<S>; 3]>,
    ) -> f32x16<S> {
        let first = of_lanes(self.first[i], lanes);
        let at = first + of_lanes(self.a[i], lanes) * dx + of_lanes(self.b[i], lanes) * dy;
        match shift {
            Some(shift) => at + of_lanes(shift[i], lanes),
            None => at,
        }
    }
}

impl<S: Simd> Edges<S> for UsualEdges<S> {
    type At = [f32x16<S>; 3];
    type Shift = [f32x16<S>; 3];

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
        // Coordinates relative to the centre of the first pixel.
        let half = SUBPIXELS / 2;
        let (cx, cy) = ((left << 8) + half, (top << 8) + half);
        let [x0, x1, x2] = each([p[0], q[0], r[0]], |x| (x - cx).to_float::<f32x16<S>>());
        let [y0, y1, y2] = each([p[1], q[1], r[1]], |y| (y - cy).to_float::<f32x16<S>>());
        let area = (x1 - x0) * (y2 - y0) - (y1 - y0) * (x2 - x0);
        let one = f32x16::splat(simd, 1.0);
        let sign = area.simd_lt(0.0).select(f32x16::splat(simd, -1.0), one);
        let e0 = edge([x1, y1], [x2, y2], sign);
        let e1 = edge([x2, y2], [x0, y0], sign);
        let e2 = edge([x0, y0], [x1, y1], sign);
        // Triangles without area cover no pixel; 1 keeps the quotients finite.
        let area = area * sign;
        let per_area = one / area.simd_gt(0.0).select(area, one);
        Self {
            first: [e0.value, e1.value, e2.value],
            least: [e0.least, e1.least, e2.least],
            a: [e0.a, e1.a, e2.a],
            b: [e0.b, e1.b, e2.b],
            depth: d0,
            to_second: (d1 - d0) * per_area,
            to_third: (d2 - d0) * per_area,
        }
    }

    #[inline(always)]
    fn first(&self) -> Self::At {
        self.first
    }

    #[inline(always)]
    fn right(&self, at: Self::At) -> Self::At {
        step(at, self.a)
    }

    #[inline(always)]
    fn below(&self, at: Self::At) -> Self::At {
        step(at, self.b)
    }

    #[inline(always)]
    fn shifts<const N: usize>(&self, sample_positions: &SamplePositions) -> [Self::Shift; N] {
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

    #[inline(always)]
    fn moved(&self, at: Self::At, shift: Self::Shift) -> Self::At {
        step(at, shift)
    }

    #[inline(always)]
    fn covered(&self, at: Self::At) -> mask32x16<S> {
        at[0].simd_ge(self.least[0]) & at[1].simd_ge(self.least[1]) & at[2].simd_ge(self.least[2])
    }

    #[inline(always)]
    fn functions(&self, lanes: i32x16<S>, by: [i32x16<S>; 2]) -> Option<[f32x16<S>; 2]> {
        let by = [by[0].to_float(), by[1].to_float()];
        Some([self.edge(1, lanes, by, None), self.edge(2, lanes, by, None)])
    }

    #[inline(always)]
    fn depths(
        &self,
        lanes: i32x16<S>,
        by: [i32x16<S>; 2],
        shift: Option<&Self::Shift>,
    ) -> f32x16<S> {
        let by = [by[0].to_float(), by[1].to_float()];
        let second = self.edge(1, lanes, by, shift);
        let third = self.edge(2, lanes, by, shift);
        let [depth, to_second, to_third] = [
            of_lanes(self.depth, lanes),
            of_lanes(self.to_second, lanes),
            of_lanes(self.to_third, lanes),
        ];
        depth + second * to_second + third * to_third
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

/// Computes an edge function as in `coverage`, multiplied by the sign of the area, with steps by
/// whole pixels: a = p.y - q.y, b = q.x - p.x, e = a (x - p.x) + b (y - p.y) at x = y = 0.
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

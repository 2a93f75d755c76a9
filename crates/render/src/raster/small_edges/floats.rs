//! Edge functions in f32 from unsnapped corners: evaluated at each pixel by the formula itself, not
//! stepped.

use fearless_simd::{
    Bytes as _, Select as _, Simd, SimdBase as _, SimdFloat as _, SimdInt as _, f32x16, i32x16,
    mask32x16,
};

use super::{Boxes, Corners, Edges, of_lanes, snapped_bounds};
use crate::raster::beyond::{beyond, reach};
use crate::screen::coverage::{Grid, SUBPIXELS};
use crate::screen::sample_positions::SamplePositions;
use marraztu_core::accuracy::Coverage;
use marraztu_core::base::math::each;

/// Edge functions in f32: e = a x + b y + c at the position of a sample, in pixels.
#[derive(Clone, Copy)]
pub(crate) struct FloatEdges<S: Simd> {
    lines: [[f32x16<S>; 3]; 3],
    start: [f32x16<S>; 2],
    /// The right and bottom ends of the boxes.
    end: [f32x16<S>; 2],
    area: f32x16<S>,
    depth: f32x16<S>,
    second: f32x16<S>,
    third: f32x16<S>,
}

impl<S: Simd> FloatEdges<S> {
    #[inline(always)]
    fn edge(&self, i: usize, [x, y]: [f32x16<S>; 2]) -> f32x16<S> {
        let [a, b, c] = self.lines[i];
        a * x + b * y + c
    }
}

impl<S: Simd> FloatEdges<S> {
    /// Computes an edge function of the triangles in these lanes.
    #[inline(always)]
    fn edge_of(&self, i: usize, lanes: i32x16<S>, [x, y]: [f32x16<S>; 2]) -> f32x16<S> {
        let [a, b, c] = self.lines[i];
        of_lanes(a, lanes) * x + of_lanes(b, lanes) * y + of_lanes(c, lanes)
    }
}

impl<S: Simd> Edges<S> for FloatEdges<S> {
    /// The position of the sample, and the centre of its pixel.
    type At = ([f32x16<S>; 2], [f32x16<S>; 2]);
    type Shift = [f32; 2];

    #[inline(always)]
    fn bounds(corners: Corners<S>, samples: [[i32; 2]; 2]) -> Boxes<S> {
        let [p, q, r] = corners;
        let corners = [
            [snapped(p[0]), snapped(p[1])],
            [snapped(q[0]), snapped(q[1])],
            [snapped(r[0]), snapped(r[1])],
        ];
        snapped_bounds(Grid::Usual, corners, reach(samples, beyond(Coverage::F32Edges)))
    }

    #[inline(always)]
    fn new(
        simd: S,
        corners: Corners<S>,
        [left, top, right, bottom]: Boxes<S>,
        [d0, d1, d2]: [f32x16<S>; 3],
    ) -> Self {
        let [p, q, r] = each(corners, |[x, y]| [x.bitcast::<f32x16<S>>(), y.bitcast()]);
        let area = (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
        let one = f32x16::splat(simd, 1.0);
        let sign = area.simd_lt(0.0).select(f32x16::splat(simd, -1.0), one);
        Self {
            lines: [line(q, r, sign), line(r, p, sign), line(p, q, sign)],
            start: [left.to_float::<f32x16<S>>() + 0.5, top.to_float::<f32x16<S>>() + 0.5],
            end: [right.to_float(), bottom.to_float()],
            area: area * sign,
            depth: d0,
            second: d1 - d0,
            third: d2 - d0,
        }
    }

    #[inline(always)]
    fn first(&self) -> Self::At {
        (self.start, self.start)
    }

    #[inline(always)]
    fn right(&self, ([x, y], _): Self::At) -> Self::At {
        let at = [x + 1.0, y];
        (at, at)
    }

    #[inline(always)]
    fn below(&self, ([x, y], _): Self::At) -> Self::At {
        let at = [x, y + 1.0];
        (at, at)
    }

    #[inline(always)]
    fn shifts<const N: usize>(&self, sample_positions: &SamplePositions) -> [Self::Shift; N] {
        let mut shifts = [[0.0; 2]; N];
        for (sample, shift) in shifts.iter_mut().enumerate() {
            *shift = sample_positions.shift::<N>(sample).map(|by| by as f32 / SUBPIXELS as f32);
        }
        shifts
    }

    #[inline(always)]
    fn moved(&self, (_, centre): Self::At, [dx, dy]: Self::Shift) -> Self::At {
        ([centre[0] + dx, centre[1] + dy], centre)
    }

    #[inline(always)]
    fn covered(&self, (at, centre): Self::At) -> mask32x16<S> {
        // All lanes step over the largest box. Outside its own box, rounding must not cover pixels.
        let inside = centre[0].simd_lt(self.end[0]) & centre[1].simd_lt(self.end[1]);
        inside
            & self.edge(0, at).simd_ge(0.0)
            & self.edge(1, at).simd_ge(0.0)
            & self.edge(2, at).simd_ge(0.0)
    }

    #[inline(always)]
    fn depths(
        &self,
        lanes: i32x16<S>,
        [dx, dy]: [i32x16<S>; 2],
        shift: Option<&Self::Shift>,
    ) -> f32x16<S> {
        let [x, y] = self.start;
        let [more_x, more_y] = shift.copied().unwrap_or_default();
        let x = of_lanes(x, lanes) + dx.to_float::<f32x16<S>>() + more_x;
        let y = of_lanes(y, lanes) + dy.to_float::<f32x16<S>>() + more_y;
        let area = of_lanes(self.area, lanes);
        let weights =
            [self.edge_of(1, lanes, [x, y]) / area, self.edge_of(2, lanes, [x, y]) / area];
        let [depth, second, third] = [
            of_lanes(self.depth, lanes),
            of_lanes(self.second, lanes),
            of_lanes(self.third, lanes),
        ];
        depth + weights[0] * second + weights[1] * third
    }
}

/// Converts a coordinate in pixels to subpixels.
#[inline(always)]
fn snapped<S: Simd>(x: i32x16<S>) -> i32x16<S> {
    (x.bitcast::<f32x16<S>>() * SUBPIXELS as f32).to_int()
}

/// Computes the line through two corners, as a, b and c.
#[inline(always)]
fn line<S: Simd>(p: [f32x16<S>; 2], q: [f32x16<S>; 2], sign: f32x16<S>) -> [f32x16<S>; 3] {
    [(p[1] - q[1]) * sign, (q[0] - p[0]) * sign, (p[0] * q[1] - p[1] * q[0]) * sign]
}

//! Edge functions in f32 from unsnapped corners: evaluated at each pixel by the formula itself, not
//! stepped.

use fearless_simd::{
    Bytes as _, Select as _, Simd, SimdBase as _, SimdFloat as _, SimdInt as _, f32x16, i32x16,
    mask32x16,
};

use super::edges::{Boxes, Corners, Edges, LinearDepths, Places};
use super::usual::UsualEdges;
use crate::raster::beyond::reach;
use crate::screen::coverage::SUBPIXELS;
use crate::simd::gather::of_lanes;
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
    gradients: [f32x16<S>; 3],
}

impl<S: Simd> FloatEdges<S> {
    #[inline(always)]
    fn edge(&self, i: usize, [x, y]: [f32x16<S>; 2]) -> f32x16<S> {
        let [a, b, c] = self.lines[i];
        a * x + b * y + c
    }
}

impl<S: Simd> Edges<S> for FloatEdges<S> {
    /// The position of the sample.
    type At = [f32x16<S>; 2];
    type Shift = [f32; 2];
    type Pixels = [i32x16<S>; 2];

    #[inline(always)]
    fn bounds(corners: Corners<S>, samples: [[i32; 2]; 2]) -> Boxes<S> {
        // A box in subpixels, enlarged by the distance at which rounding may cover centres.
        let corners = each(corners, |[x, y]| [snapped(x), snapped(y)]);
        UsualEdges::bounds(corners, reach(Coverage::F32Edges, samples))
    }

    #[inline(always)]
    fn new(
        simd: S,
        corners: Corners<S>,
        [left, top, right, bottom]: Boxes<S>,
        [d0, d1, d2]: [f32x16<S>; 3],
    ) -> Self {
        // Queues hold integers, so corners arrive as the bits of f32.
        let [p, q, r] = each(corners, |[x, y]| [x.bitcast::<f32x16<S>>(), y.bitcast()]);
        let area = (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
        let one = f32x16::splat(simd, 1.0);
        let sign = area.simd_lt(0.0).select(f32x16::splat(simd, -1.0), one);
        Self {
            lines: [line(q, r, sign), line(r, p, sign), line(p, q, sign)],
            start: [left.to_float::<f32x16<S>>() + 0.5, top.to_float::<f32x16<S>>() + 0.5],
            end: [right.to_float(), bottom.to_float()],
            area: area * sign,
            gradients: [d0, d1 - d0, d2 - d0],
        }
    }

    #[inline(always)]
    fn first(&self) -> Self::At {
        self.start
    }

    #[inline(always)]
    fn step(&self, mut at: Self::At, axis: usize) -> Self::At {
        at[axis] += 1.0;
        at
    }

    #[inline(always)]
    fn shift(&self, by: [i32; 2]) -> Self::Shift {
        by.map(|by| by as f32 / SUBPIXELS as f32)
    }

    #[inline(always)]
    fn moved(&self, [x, y]: Self::At, [dx, dy]: Self::Shift) -> Self::At {
        [x + dx, y + dy]
    }

    #[inline(always)]
    fn covered(&self, at: Self::At) -> mask32x16<S> {
        // All lanes step over the largest box. Outside its own box, rounding must not cover pixels.
        let inside = at[0].simd_lt(self.end[0]) & at[1].simd_lt(self.end[1]);
        inside
            & self.edge(0, at).simd_ge(0.0)
            & self.edge(1, at).simd_ge(0.0)
            & self.edge(2, at).simd_ge(0.0)
    }

    /// Returns the edge function divided by the area.
    #[inline(always)]
    fn function(
        &self,
        i: usize,
        (lanes, [dx, dy], shift): Places<'_, S, Self::Shift>,
    ) -> f32x16<S> {
        let [more_x, more_y] = shift.copied().unwrap_or_default();
        // The formula of `edge`, at positions that may differ from lane to lane.
        let x = of_lanes(self.start[0], lanes) + dx.to_float::<f32x16<S>>() + more_x;
        let y = of_lanes(self.start[1], lanes) + dy.to_float::<f32x16<S>>() + more_y;
        let [a, b, c] = self.lines[i];
        let edge = of_lanes(a, lanes) * x + of_lanes(b, lanes) * y + of_lanes(c, lanes);
        edge / of_lanes(self.area, lanes)
    }

    #[inline(always)]
    fn pixels(&self, _: i32x16<S>, by: [i32x16<S>; 2]) -> Self::Pixels {
        by
    }

    #[inline(always)]
    fn depths(
        &self,
        by: &Self::Pixels,
        (lanes, shift): (i32x16<S>, Option<&Self::Shift>),
    ) -> f32x16<S> {
        LinearDepths::new(self, self.gradients, (lanes, *by, shift)).at_pixels()
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

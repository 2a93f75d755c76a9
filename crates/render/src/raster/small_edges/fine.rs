//! Edge functions on the fine grid, in 32-bit integers. A step by one pixel adds a multiple of 4096
//! to an edge function, so its integer quotient by 4096 is enough to decide the sign.

use fearless_simd::{Select as _, Simd, SimdBase as _, SimdInt as _, f32x16, i32x16, mask32x16};

use super::{Boxes, Corners, Edges, of_lanes, snapped_bounds, whole_edge};
use crate::screen::coverage::Grid;
use crate::screen::sample_positions::SamplePositions;
use crate::simd::gather::permute;
use marraztu_core::base::math::each;

/// Edge functions on the fine grid: the quotients by 4096 of each edge function minus its smallest
/// covered value, and the second and third edge function in f32.
#[derive(Clone, Copy)]
pub(crate) struct FineEdges<S: Simd> {
    /// The edge functions at the first pixel, minus their smallest covered values.
    first: [i32x16<S>; 3],
    /// The steps of the quotients.
    a: [i32x16<S>; 3],
    b: [i32x16<S>; 3],
    depth: f32x16<S>,
    to_second: f32x16<S>,
    to_third: f32x16<S>,
}

/// log2 of the grid steps per pixel on the fine grid.
const FINE: u32 = Grid::Fine.parts().trailing_zeros();

/// The change by the offset of a sample: of the quotients, and of the second and third edge
/// function.
type Shift<S> = ([i32x16<S>; 3], [f32x16<S>; 2]);

impl<S: Simd> FineEdges<S> {
    /// Computes an edge function of the triangles in these lanes, at this distance from their first
    /// pixels.
    #[inline(always)]
    fn edge(
        &self,
        i: usize,
        lanes: i32x16<S>,
        [dx, dy]: [i32x16<S>; 2],
        shift: Option<&Shift<S>>,
    ) -> f32x16<S> {
        let steps = permute(self.a[i], lanes) * dx + permute(self.b[i], lanes) * dy;
        let at = (permute(self.first[i], lanes) + (steps << FINE)).to_float::<f32x16<S>>();
        match shift {
            Some((_, gain)) => at + of_lanes(gain[i - 1], lanes),
            None => at,
        }
    }
}

impl<S: Simd> Edges<S> for FineEdges<S> {
    /// The quotients.
    type At = [i32x16<S>; 3];
    type Shift = Shift<S>;

    #[inline(always)]
    fn bounds(corners: Corners<S>, reach: [[i32; 2]; 2]) -> Boxes<S> {
        snapped_bounds(Grid::Fine, corners, reach)
    }

    #[inline(always)]
    fn new(
        simd: S,
        [p, q, r]: Corners<S>,
        [left, top, ..]: Boxes<S>,
        [d0, d1, d2]: [f32x16<S>; 3],
    ) -> Self {
        // Corners relative to the centre of the box's first pixel.
        let half = Grid::Fine.parts() / 2;
        let (cx, cy) = ((left << FINE) + half, (top << FINE) + half);
        let [x0, x1, x2] = each([p[0], q[0], r[0]], |x| x - cx);
        let [y0, y1, y2] = each([p[1], q[1], r[1]], |y| y - cy);
        let area = (x1 - x0) * (y2 - y0) - (y1 - y0) * (x2 - x0);
        let (zero, one) = (i32x16::splat(simd, 0), i32x16::splat(simd, 1));
        let sign = area.simd_lt(0).select(zero - one, one);
        let edges = [
            whole_edge([x1, y1], [x2, y2], sign),
            whole_edge([x2, y2], [x0, y0], sign),
            whole_edge([x0, y0], [x1, y1], sign),
        ];
        let area = (area * sign).max(1).to_float::<f32x16<S>>();
        Self {
            first: each(edges, |edge| edge.value),
            a: each(edges, |edge| edge.a),
            b: each(edges, |edge| edge.b),
            depth: d0,
            to_second: (d1 - d0) / area,
            to_third: (d2 - d0) / area,
        }
    }

    #[inline(always)]
    fn first(&self) -> Self::At {
        let [a, b, c] = self.first;
        [a >> FINE, b >> FINE, c >> FINE]
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
        let simd = self.depth.simd;
        let (none, zero) = (i32x16::splat(simd, 0), f32x16::splat(simd, 0.0));
        let mut shifts = [([none; 3], [zero; 2]); N];
        for (sample, (quotients, edges)) in shifts.iter_mut().enumerate() {
            let [x, y] = Grid::Fine.offset(sample_positions.shift::<N>(sample));
            for i in 0..3 {
                // The quotient of the sum can differ by one from the sum of the quotients, so it is
                // computed here.
                let gain = self.a[i] * x + self.b[i] * y;
                quotients[i] = ((self.first[i] + gain) >> FINE) - (self.first[i] >> FINE);
                if i > 0 {
                    edges[i - 1] = gain.to_float();
                }
            }
        }
        shifts
    }

    #[inline(always)]
    fn moved(&self, [a, b, c]: Self::At, (more, _): Self::Shift) -> Self::At {
        [a + more[0], b + more[1], c + more[2]]
    }

    #[inline(always)]
    fn covered(&self, [a, b, c]: Self::At) -> mask32x16<S> {
        (a | b | c).simd_ge(0)
    }

    #[inline(always)]
    fn functions(&self, lanes: i32x16<S>, by: [i32x16<S>; 2]) -> Option<[f32x16<S>; 2]> {
        Some([self.edge(1, lanes, by, None), self.edge(2, lanes, by, None)])
    }

    #[inline(always)]
    fn depths(
        &self,
        lanes: i32x16<S>,
        by: [i32x16<S>; 2],
        shift: Option<&Self::Shift>,
    ) -> f32x16<S> {
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

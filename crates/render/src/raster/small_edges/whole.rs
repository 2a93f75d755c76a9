//! Edge functions in 32-bit integers: on the usual grid for boxes of up to 16 x 16 pixels, and on
//! the fine grid.

use fearless_simd::{
    Bytes as _, Select as _, Simd, SimdBase as _, SimdInt as _, SimdNarrow as _, SimdWiden as _,
    f32x16, f64x8, i32x16, mask32x16, u32x16,
};

use super::edges::{Boxes, Corners, Edge, Edges, LinearDepths, Places, SampledEdges};
use crate::screen::coverage::{Grid, SUBPIXELS};
use crate::simd::gather::{of_lanes, permute};
use crate::simd::in_f64;
use marraztu_core::base::math::each;

/// Integer edge functions on the usual grid. Depths have the same bits as in `medium`.
#[derive(Clone, Copy)]
pub(crate) struct WholeEdges<S: Simd> {
    /// The edge functions at the first pixel, minus their smallest covered values.
    first: [i32x16<S>; 3],
    /// The steps of the edge functions for one pixel to the right and one pixel down.
    steps: [[i32x16<S>; 3]; 2],
    /// The smallest covered values, needed for depth.
    least: [i32x16<S>; 3],
    depth: f32x16<S>,
    to_second: Doubles<S>,
    to_third: Doubles<S>,
}

/// Sixteen f64 numbers, as the lower and upper halves of their bits.
type Doubles<S> = [i32x16<S>; 2];

impl<S: Simd> WholeEdges<S> {
    /// Computes an edge function as in [`Edges::function`].
    #[inline(always)]
    fn edge(&self, i: usize, (lanes, [dx, dy], shift): Places<'_, S, [i32x16<S>; 3]>) -> i32x16<S> {
        // Depth needs the edge function itself, without the bias of the top-left rule.
        let first = permute(self.first[i] + self.least[i], lanes);
        let [a, b] = [permute(self.steps[0][i], lanes), permute(self.steps[1][i], lanes)];
        let at = first + a * dx + b * dy;
        match shift {
            Some(shift) => at + permute(shift[i], lanes),
            None => at,
        }
    }
}

impl<S: Simd> Edges<S> for WholeEdges<S> {
    type At = [i32x16<S>; 3];
    type Shift = [i32x16<S>; 3];
    type Pixels = WholeDepths<S>;

    #[inline(always)]
    fn new(_: S, corners: Corners<S>, boxes: Boxes<S>, [d0, d1, d2]: [f32x16<S>; 3]) -> Self {
        let (edges, area) = whole_edges(Self::GRID, corners, boxes);
        // The reciprocal of the area is shared by both depth gradients.
        let area = in_f64(area);
        Self {
            first: each(edges, |edge| edge.value),
            steps: [each(edges, |edge| edge.a * SUBPIXELS), each(edges, |edge| edge.b * SUBPIXELS)],
            least: each(edges, |edge| edge.least),
            depth: d0,
            to_second: per_area(d0, d1, area),
            to_third: per_area(d0, d2, area),
        }
    }

    #[inline(always)]
    fn first(&self) -> Self::At {
        self.first
    }

    #[inline(always)]
    fn step(&self, at: Self::At, axis: usize) -> Self::At {
        sum(at, self.steps[axis])
    }

    #[inline(always)]
    fn shift(&self, [x, y]: [i32; 2]) -> Self::Shift {
        let [a, b] = self.steps;
        // Steps are multiples of 256, so the steps by one subpixel are exact.
        each(
            [[a[0], b[0]], [a[1], b[1]], [a[2], b[2]]],
            #[inline(always)]
            |[a, b]| (a >> 8) * x + (b >> 8) * y,
        )
    }

    #[inline(always)]
    fn moved(&self, at: Self::At, shift: Self::Shift) -> Self::At {
        sum(at, shift)
    }

    #[inline(always)]
    fn covered(&self, [a, b, c]: Self::At) -> mask32x16<S> {
        // The union is negative if any edge function is, so one comparison is enough.
        (a | b | c).simd_ge(0)
    }

    #[inline(always)]
    fn function(&self, i: usize, at: Places<'_, S, Self::Shift>) -> f32x16<S> {
        self.edge(i, at).to_float()
    }

    #[inline(always)]
    fn pixels(&self, lanes: i32x16<S>, by: [i32x16<S>; 2]) -> Self::Pixels {
        let (low, high) = of_lanes(self.depth, lanes).widen();
        WholeDepths {
            edges: [self.edge(1, (lanes, by, None)), self.edge(2, (lanes, by, None))],
            depth: [low, high],
            to_second: doubles(self.to_second, lanes),
            to_third: doubles(self.to_third, lanes),
        }
    }

    #[inline(always)]
    fn depths(
        &self,
        pixels: &Self::Pixels,
        (lanes, shift): (i32x16<S>, Option<&Self::Shift>),
    ) -> f32x16<S> {
        let WholeDepths { edges: [mut second, mut third], depth, to_second, to_third } = *pixels;
        if let Some(shift) = shift {
            (second, third) = (second + permute(shift[1], lanes), third + permute(shift[2], lanes));
        }
        let (second, third) = (in_f64(second), in_f64(third));
        // The same operations in the same order as in `medium`, for the same bits.
        let low = second[0] * to_second[0] + depth[0] + third[0] * to_third[0];
        let high = second[1] * to_second[1] + depth[1] + third[1] * to_third[1];
        low.narrow(high)
    }
}

/// Sixteen triangles, to be drawn one after the other.
pub(crate) struct EachWhole<S: Simd> {
    /// The changes of the edge functions in sixteen entries.
    gains: [[i32x16<S>; 3]; 16],
    least: [[i32; 16]; 3],
    depth: [f32; 16],
    to_second: [f64; 16],
    to_third: [f64; 16],
}

impl<S: Simd> SampledEdges<S> for WholeEdges<S> {
    type Value = i32;
    type Each = EachWhole<S>;

    #[inline(always)]
    fn most(&self, [from, to]: [[i32; 2]; 2]) -> Self::Shift {
        let [a, b] = self.steps;
        each(
            [[a[0] >> 8, b[0] >> 8], [a[1] >> 8, b[1] >> 8], [a[2] >> 8, b[2] >> 8]],
            #[inline(always)]
            |[a, b]| (a * from[0]).max(a * to[0]) + (b * from[1]).max(b * to[1]),
        )
    }

    #[inline(always)]
    fn each(&self, [x, y]: [i32x16<S>; 2]) -> Self::Each {
        let [a, b] = self.steps;
        let (a, b) = (each(a, <[i32; 16]>::from), each(b, <[i32; 16]>::from));
        let mut all = EachWhole {
            gains: [[x; 3]; 16],
            least: each(self.least, <[i32; 16]>::from),
            depth: self.depth.into(),
            to_second: in_order(self.to_second),
            to_third: in_order(self.to_third),
        };
        for (lane, gains) in all.gains.iter_mut().enumerate() {
            *gains = [
                x * (a[0][lane] >> 8) + y * (b[0][lane] >> 8),
                x * (a[1][lane] >> 8) + y * (b[1][lane] >> 8),
                x * (a[2][lane] >> 8) + y * (b[2][lane] >> 8),
            ];
        }
        all
    }

    #[inline(always)]
    fn values(&self, i: usize, (lanes, by): (i32x16<S>, [i32x16<S>; 2])) -> [i32; 16] {
        self.edge(i, (lanes, by, None)).into()
    }

    #[inline(always)]
    fn in_entries(of: &Self::Each, lane: usize, at: [i32; 3]) -> (mask32x16<S>, f32x16<S>) {
        let EachWhole { gains, least, depth, to_second, to_third } = of;
        let lane = lane % 16;
        let [first, second, third] = gains[lane];
        let [first, second, third] = [first + at[0], second + at[1], third + at[2]];
        let covered = first.simd_ge(least[0][lane])
            & second.simd_ge(least[1][lane])
            & third.simd_ge(least[2][lane]);
        let (second, third) = (in_f64(second), in_f64(third));
        let (depth, to_second, to_third) =
            (f64::from(depth[lane]), to_second[lane], to_third[lane]);
        // The same operations in the same order as in `medium`, for the same bits.
        let low = second[0] * to_second + depth + third[0] * to_third;
        let high = second[1] * to_second + depth + third[1] * to_third;
        (covered, low.narrow(high))
    }
}

/// Depths at some pixels: their second and third edge functions, the depth of the first corner, and
/// its growth with these functions.
#[derive(Clone, Copy)]
pub(crate) struct WholeDepths<S: Simd> {
    edges: [i32x16<S>; 2],
    depth: [f64x8<S>; 2],
    to_second: [f64x8<S>; 2],
    to_third: [f64x8<S>; 2],
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

/// Returns all numbers, lane by lane.
#[inline(always)]
fn in_order<S: Simd>([low, high]: Doubles<S>) -> [f64; 16] {
    let (first, second) = low.interleave(high);
    let mut all = [0.0; 16];
    first.bitcast::<f64x8<S>>().store_slice(&mut all[..8]);
    second.bitcast::<f64x8<S>>().store_slice(&mut all[8..]);
    all
}

/// Integer edge functions on the fine grid. A step by one pixel adds a multiple of 4096 to an edge
/// function, so its integer quotient by 4096 is enough to decide the sign.
#[derive(Clone, Copy)]
pub(crate) struct FineEdges<S: Simd> {
    /// The edge functions at the first pixel, minus their smallest covered values.
    first: [i32x16<S>; 3],
    /// The steps of the quotients for one pixel to the right and one pixel down.
    steps: [[i32x16<S>; 3]; 2],
    /// The smallest covered values, needed for depth and colours.
    least: [i32x16<S>; 3],
    gradients: [f32x16<S>; 3],
}

/// log2 of the grid steps per pixel on the fine grid.
const FINE: u32 = Grid::Fine.parts().trailing_zeros();

impl<S: Simd> Edges<S> for FineEdges<S> {
    /// The quotients.
    type At = [i32x16<S>; 3];
    /// The changes of the quotients and of the edge functions.
    type Shift = ([i32x16<S>; 3], [f32x16<S>; 3]);
    type Pixels = [i32x16<S>; 2];
    const GRID: Grid = Grid::Fine;

    #[inline(always)]
    fn new(_: S, corners: Corners<S>, boxes: Boxes<S>, [d0, d1, d2]: [f32x16<S>; 3]) -> Self {
        let (edges, area) = whole_edges(Self::GRID, corners, boxes);
        let area = area.to_float::<f32x16<S>>();
        Self {
            first: each(edges, |edge| edge.value),
            steps: [each(edges, |edge| edge.a), each(edges, |edge| edge.b)],
            least: each(edges, |edge| edge.least),
            gradients: [d0, (d1 - d0) / area, (d2 - d0) / area],
        }
    }

    #[inline(always)]
    fn first(&self) -> Self::At {
        // The shift rounds down, which keeps the sign.
        each(self.first, |edge| edge >> FINE)
    }

    #[inline(always)]
    fn step(&self, at: Self::At, axis: usize) -> Self::At {
        sum(at, self.steps[axis])
    }

    #[inline(always)]
    fn shift(&self, by: [i32; 2]) -> Self::Shift {
        let ([a, b], [x, y]) = (self.steps, Grid::Fine.offset(by));
        let gains = [a[0] * x + b[0] * y, a[1] * x + b[1] * y, a[2] * x + b[2] * y];
        // The quotient of the sum can differ by one from the sum of the quotients, so it is
        // computed here.
        let quotients = each(
            [[self.first[0], gains[0]], [self.first[1], gains[1]], [self.first[2], gains[2]]],
            #[inline(always)]
            |[first, gain]| ((first + gain) >> FINE) - (first >> FINE),
        );
        (quotients, [gains[0].to_float(), gains[1].to_float(), gains[2].to_float()])
    }

    #[inline(always)]
    fn moved(&self, at: Self::At, (more, _): Self::Shift) -> Self::At {
        sum(at, more)
    }

    #[inline(always)]
    fn covered(&self, [a, b, c]: Self::At) -> mask32x16<S> {
        (a | b | c).simd_ge(0)
    }

    #[inline(always)]
    fn function(
        &self,
        i: usize,
        (lanes, [dx, dy], shift): Places<'_, S, Self::Shift>,
    ) -> f32x16<S> {
        let [a, b] = [permute(self.steps[0][i], lanes), permute(self.steps[1][i], lanes)];
        // The steps belong to the quotients, so the shift undoes the division.
        let first = permute(self.first[i] + self.least[i], lanes);
        let at = first + ((a * dx + b * dy) << FINE);
        let at = at.to_float::<f32x16<S>>();
        match shift {
            Some((_, gain)) => at + of_lanes(gain[i], lanes),
            None => at,
        }
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

#[inline(always)]
fn sum<S: Simd>([a, b, c]: [i32x16<S>; 3], by: [i32x16<S>; 3]) -> [i32x16<S>; 3] {
    [a + by[0], b + by[1], c + by[2]]
}

/// Sets up the edge functions of triangles, relative to the centres of the first pixels of their
/// boxes, and their areas. An area of 0 counts as 1, which keeps quotients finite.
#[inline(always)]
fn whole_edges<S: Simd>(
    grid: Grid,
    [p, q, r]: Corners<S>,
    [left, top, ..]: Boxes<S>,
) -> ([Edge<i32x16<S>>; 3], i32x16<S>) {
    let (half, log2) = (grid.parts() / 2, grid.parts().trailing_zeros());
    // Positions relative to the box keep all products within 32 bits.
    let (cx, cy) = ((left << log2) + half, (top << log2) + half);
    let [p, q, r] = each([p, q, r], |[x, y]| [x - cx, y - cy]);
    let area = (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
    let (zero, one) = (i32x16::splat(left.simd, 0), i32x16::splat(left.simd, 1));
    let sign = area.simd_lt(0).select(zero - one, one);
    let edges = [whole_edge(q, r, sign), whole_edge(r, p, sign), whole_edge(p, q, sign)];
    (edges, (area * sign).max(1))
}

/// Computes an edge function as in `coverage`, minus its smallest covered value and multiplied by
/// the sign of the area, with steps by one grid step: a = p.y - q.y, b = q.x - p.x, e = a (x - p.x)
/// + b (y - p.y) at x = y = 0.
#[inline(always)]
fn whole_edge<S: Simd>(
    [px, py]: [i32x16<S>; 2],
    [qx, qy]: [i32x16<S>; 2],
    sign: i32x16<S>,
) -> Edge<i32x16<S>> {
    let (a, b) = ((py - qy) * sign, (qx - px) * sign);
    // The top-left rule: centres on a left or top edge are covered.
    let on_edge = a.simd_gt(0) | (a.simd_eq(0) & b.simd_gt(0));
    let (zero, one) = (i32x16::splat(px.simd, 0), i32x16::splat(px.simd, 1));
    let least = on_edge.select(zero, one);
    Edge { value: zero - (a * px + b * py) - least, least, a, b }
}

#[cfg(test)]
#[expect(clippy::cast_precision_loss, reason = "the nearest f32 is meant")]
mod tests {
    use super::*;
    use crate::simd::{UP_TO_SIXTEEN, dispatch};
    use fearless_simd::Level;
    use marraztu_core::base::rng::Rng;
    use std::array::from_fn;

    /// Compares edge functions of sixteen triangles of up to 4 x 4 pixels with their definition.
    #[inline(always)]
    fn compare<S: Simd, E: Edges<S>>(simd: S, rng: &mut Rng) {
        let parts = E::GRID.parts();
        let triangles: [[[i32; 2]; 3]; 16] =
            from_fn(|_| from_fn(|_| from_fn(|_| rng.between(0, 4 * parts - 1))));
        let corners: Corners<S> = from_fn(|corner| {
            from_fn(|axis| i32x16::from_slice(simd, &triangles.map(|it| it[corner][axis])))
        });
        let boxes = E::bounds(corners, [[0; 2]; 2]);
        let edges = E::new(simd, corners, boxes, [f32x16::splat(simd, 0.5); 3]);
        let (lanes, one) = (i32x16::from_slice(simd, &UP_TO_SIXTEEN), i32x16::splat(simd, 1));
        for i in 0..3 {
            let found = edges.function(i, (lanes, [one, one], None));
            for (lane, corners) in triangles.iter().enumerate() {
                let [x, y] =
                    [boxes[0][lane], boxes[1][lane]].map(|first| (first + 1) * parts + parts / 2);
                let [[px, py], [qx, qy], [rx, ry]] = from_fn(|j| corners[(i + 1 + j) % 3]);
                let area = (qx - px) * (ry - py) - (qy - py) * (rx - px);
                let value = (py - qy) * (x - px) + (qx - px) * (y - py);
                let expected = if area < 0 { -value } else { value } as f32;
                assert_eq!(found[lane], expected, "edge {i} of {corners:?}");
            }
        }
    }

    #[test]
    fn depths_and_colours_take_edge_functions_without_the_bias_of_the_top_left_rule() {
        let mut rng = Rng::new(7);
        for _ in 0..100 {
            dispatch!(Level::new(), simd => {
                compare::<_, WholeEdges<_>>(simd, &mut rng);
                compare::<_, FineEdges<_>>(simd, &mut rng);
            });
        }
    }
}

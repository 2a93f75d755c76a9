//! Edge functions of sixteen small triangles, one in each lane, by each rule of coverage.
//!
//! * On the usual grid they are computed in f32, in which integers below 2^24 are exact: no edge
//!   function in a box of 8 x 8 pixels is larger.
//! * On the fine grid they are larger. A step by a pixel adds a multiple of 4096 to them, so that
//!   whole quotients by 4096 tell whether they are negative.
//! * In f32 they are computed at each pixel by the formula itself, not stepped.

use fearless_simd::{
    Bytes as _, Select as _, Simd, SimdBase as _, SimdFloat as _, SimdInt as _, f32x16, i32x16,
    mask32x16,
};

use super::beyond::{beyond, reach};
use crate::accuracy::Coverage;
use crate::base::math::each;
use crate::render::screen::coverage::{Grid, SUBPIXELS};
use crate::render::screen::sample_positions::SamplePositions;
use crate::render::simd::gather::permute;

pub(crate) mod whole;

/// The bounding boxes of sixteen triangles: left, top, right and bottom.
type Boxes<S> = [i32x16<S>; 4];

/// Their corners: snapped, or the bits of positions in pixels.
type Corners<S> = [[i32x16<S>; 2]; 3];

/// The edge functions of sixteen triangles, positive inside whatever the winding.
pub(crate) trait Edges<S: Simd>: Copy {
    /// Their values at a pixel.
    type At: Copy;
    /// What the offset of a sample changes of them.
    type Shift: Copy;
    /// The pixels that triangles may cover in samples that lie this far from centres.
    fn bounds(corners: Corners<S>, reach: [[i32; 2]; 2]) -> Boxes<S>;
    /// Sets triangles up, with the depths of their corners.
    fn new(simd: S, corners: Corners<S>, boxes: Boxes<S>, depths: [f32x16<S>; 3]) -> Self;
    /// At the first pixel of the boxes.
    fn first(&self) -> Self::At;
    /// One pixel to the right.
    fn right(&self, at: Self::At) -> Self::At;
    /// One pixel down.
    fn below(&self, at: Self::At) -> Self::At;
    /// What the offsets of samples change.
    fn shifts<const N: usize>(&self, sample_positions: &SamplePositions) -> [Self::Shift; N];
    /// At a sample.
    fn moved(&self, at: Self::At, shift: Self::Shift) -> Self::At;
    /// Which triangles cover it.
    fn covered(&self, at: Self::At) -> mask32x16<S>;
    /// The depths, linear on the screen, of the triangles in some lanes at pixels this far from the
    /// first of their boxes, in the sample with an offset, if there are several.
    fn depths(&self, lanes: i32x16<S>, by: [i32x16<S>; 2], shift: Option<&Self::Shift>)
    -> f32x16<S>;
}

/// On the usual grid.
#[derive(Clone, Copy)]
pub(crate) struct UsualEdges<S: Simd> {
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
}

impl<S: Simd> UsualEdges<S> {
    /// An edge function of the triangles in some lanes, this far from their first pixels: exact, as
    /// steps are.
    #[inline(always)]
    fn edge(
        &self,
        i: usize,
        lanes: i32x16<S>,
        [dx, dy]: [f32x16<S>; 2],
        shift: Option<&[f32x16<S>; 3]>,
    ) -> f32x16<S> {
        let first = own(self.first[i], lanes);
        let at = first + own(self.a[i], lanes) * dx + own(self.b[i], lanes) * dy;
        match shift {
            Some(shift) => at + own(shift[i], lanes),
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
        // Triangles without area cover nothing; 1 keeps quotients finite.
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
    fn depths(
        &self,
        lanes: i32x16<S>,
        by: [i32x16<S>; 2],
        shift: Option<&Self::Shift>,
    ) -> f32x16<S> {
        let by = [by[0].to_float(), by[1].to_float()];
        let second = self.edge(1, lanes, by, shift);
        let third = self.edge(2, lanes, by, shift);
        let [depth, to_second, to_third] =
            [own(self.depth, lanes), own(self.to_second, lanes), own(self.to_third, lanes)];
        depth + second * to_second + third * to_third
    }
}

/// On the fine grid: the quotients of edge functions, less their least values, by 4096, and the
/// second and third themselves in f32.
#[derive(Clone, Copy)]
pub(crate) struct FineEdges<S: Simd> {
    /// Edge functions at the first pixel, less their least values.
    first: [i32x16<S>; 3],
    /// The steps of quotients.
    a: [i32x16<S>; 3],
    b: [i32x16<S>; 3],
    depth: f32x16<S>,
    to_second: f32x16<S>,
    to_third: f32x16<S>,
}

/// log2 of the parts of a pixel on the fine grid.
const FINE: u32 = Grid::Fine.parts().trailing_zeros();

impl<S: Simd> FineEdges<S> {
    /// An edge function of the triangles in some lanes, this far from their first pixels.
    #[inline(always)]
    fn edge(
        &self,
        i: usize,
        lanes: i32x16<S>,
        [dx, dy]: [i32x16<S>; 2],
        shift: Option<&([i32x16<S>; 3], [f32x16<S>; 2])>,
    ) -> f32x16<S> {
        let steps = permute(self.a[i], lanes) * dx + permute(self.b[i], lanes) * dy;
        let at = (permute(self.first[i], lanes) + (steps << FINE)).to_float::<f32x16<S>>();
        match shift {
            Some((_, gain)) => at + own(gain[i - 1], lanes),
            None => at,
        }
    }
}

impl<S: Simd> Edges<S> for FineEdges<S> {
    /// Quotients.
    type At = [i32x16<S>; 3];
    /// What the quotients gain, and the second and third edge function.
    type Shift = ([i32x16<S>; 3], [f32x16<S>; 2]);

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
    fn depths(
        &self,
        lanes: i32x16<S>,
        by: [i32x16<S>; 2],
        shift: Option<&Self::Shift>,
    ) -> f32x16<S> {
        let second = self.edge(1, lanes, by, shift);
        let third = self.edge(2, lanes, by, shift);
        let [depth, to_second, to_third] =
            [own(self.depth, lanes), own(self.to_second, lanes), own(self.to_third, lanes)];
        depth + second * to_second + third * to_third
    }
}

/// In f32: e = a x + b y + c at the position of a sample, in pixels.
#[derive(Clone, Copy)]
pub(crate) struct FloatEdges<S: Simd> {
    lines: [[f32x16<S>; 3]; 3],
    start: [f32x16<S>; 2],
    /// The ends of the boxes.
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
    /// An edge function of the triangles in some lanes.
    #[inline(always)]
    fn edge_of(&self, i: usize, lanes: i32x16<S>, [x, y]: [f32x16<S>; 2]) -> f32x16<S> {
        let [a, b, c] = self.lines[i];
        own(a, lanes) * x + own(b, lanes) * y + own(c, lanes)
    }
}

impl<S: Simd> Edges<S> for FloatEdges<S> {
    /// The position of the sample, and the centre of its pixel.
    type At = ([f32x16<S>; 2], [f32x16<S>; 2]);
    type Shift = [f32; 2];

    #[inline(always)]
    fn bounds(corners: Corners<S>, samples: [[i32; 2]; 2]) -> Boxes<S> {
        let snap =
            |x: i32x16<S>| -> i32x16<S> { (x.bitcast::<f32x16<S>>() * SUBPIXELS as f32).to_int() };
        let snapped = each(corners, |[x, y]| [snap(x), snap(y)]);
        snapped_bounds(Grid::Usual, snapped, reach(samples, beyond(Coverage::F32Edges)))
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
        let float = |x: i32x16<S>| x.to_float::<f32x16<S>>();
        Self {
            lines: [line(q, r, sign), line(r, p, sign), line(p, q, sign)],
            start: [float(left) + 0.5, float(top) + 0.5],
            end: [float(right), float(bottom)],
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
        let x = own(x, lanes) + dx.to_float::<f32x16<S>>() + more_x;
        let y = own(y, lanes) + dy.to_float::<f32x16<S>>() + more_y;
        let area = own(self.area, lanes);
        let weights = [self.edge_of(1, lanes, [x, y]) / area, self.edge_of(2, lanes, [x, y]) / area];
        let [depth, second, third] =
            [own(self.depth, lanes), own(self.second, lanes), own(self.third, lanes)];
        depth + weights[0] * second + weights[1] * third
    }
}

/// The numbers of some lanes.
#[inline(always)]
fn own<S: Simd>(of: f32x16<S>, lanes: i32x16<S>) -> f32x16<S> {
    permute(of.bitcast(), lanes).bitcast()
}

/// The pixels that snapped triangles may cover.
#[inline(always)]
fn snapped_bounds<S: Simd>(
    grid: Grid,
    [p, q, r]: Corners<S>,
    [least, most]: [[i32; 2]; 2],
) -> Boxes<S> {
    let (half, log2) = (grid.parts() / 2, grid.parts().trailing_zeros());
    let (least, most) = (grid.offset(least), grid.offset(most));
    [
        (p[0].min(q[0]).min(r[0]) + (half - 1 - most[0])) >> log2,
        (p[1].min(q[1]).min(r[1]) + (half - 1 - most[1])) >> log2,
        ((p[0].max(q[0]).max(r[0]) - (half + least[0])) >> log2) + 1,
        ((p[1].max(q[1]).max(r[1]) - (half + least[1])) >> log2) + 1,
    ]
}

#[inline(always)]
fn step<S: Simd>([x, y, z]: [f32x16<S>; 3], by: [f32x16<S>; 3]) -> [f32x16<S>; 3] {
    [x + by[0], y + by[1], z + by[2]]
}

/// The line through two corners, as a, b and c.
#[inline(always)]
fn line<S: Simd>(p: [f32x16<S>; 2], q: [f32x16<S>; 2], sign: f32x16<S>) -> [f32x16<S>; 3] {
    [(p[1] - q[1]) * sign, (q[0] - p[0]) * sign, (p[0] * q[1] - p[1] * q[0]) * sign]
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

/// An edge function of sixteen triangles in whole numbers.
#[derive(Clone, Copy)]
struct WholeEdge<S: Simd> {
    /// Less the least value that counts as covered.
    value: i32x16<S>,
    least: i32x16<S>,
    /// The steps by a part of a pixel to the right, and by one down.
    a: i32x16<S>,
    b: i32x16<S>,
}

/// The same in whole numbers.
#[inline(always)]
fn whole_edge<S: Simd>(
    [px, py]: [i32x16<S>; 2],
    [qx, qy]: [i32x16<S>; 2],
    sign: i32x16<S>,
) -> WholeEdge<S> {
    let (a, b) = ((py - qy) * sign, (qx - px) * sign);
    let on_edge = a.simd_gt(0) | (a.simd_eq(0) & b.simd_gt(0));
    let (zero, one) = (i32x16::splat(px.simd, 0), i32x16::splat(px.simd, 1));
    let least = on_edge.select(zero, one);
    WholeEdge { value: zero - (a * px + b * py) - least, least, a, b }
}

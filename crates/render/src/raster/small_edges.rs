//! Edge functions of sixteen small triangles, one per lane, for each rule of coverage.

use fearless_simd::{Bytes as _, Select as _, Simd, SimdBase as _, f32x16, i32x16, mask32x16};

use crate::screen::coverage::Grid;
use crate::screen::sample_positions::SamplePositions;
use crate::simd::gather::permute;

pub(crate) use self::fine::FineEdges;
pub(crate) use self::floats::FloatEdges;
pub(crate) use self::usual::UsualEdges;
pub(crate) use self::whole::WholeEdges;

mod fine;
mod floats;
mod usual;
mod whole;

/// The bounding boxes of sixteen triangles: left, top, right and bottom.
type Boxes<S> = [i32x16<S>; 4];

/// The corners of sixteen triangles: snapped, or the bits of positions in pixels.
type Corners<S> = [[i32x16<S>; 2]; 3];

/// The edge functions of sixteen triangles, positive inside for either winding.
pub(crate) trait Edges<S: Simd>: Copy {
    /// The values of the edge functions at a pixel.
    type At: Copy;
    /// The change of the values by the offset of a sample.
    type Shift: Copy;
    /// Returns boxes of the pixels that triangles may cover in samples at these offsets from
    /// centres.
    fn bounds(corners: Corners<S>, reach: [[i32; 2]; 2]) -> Boxes<S>;
    /// Sets triangles up, with the depths of their corners.
    fn new(simd: S, corners: Corners<S>, boxes: Boxes<S>, depths: [f32x16<S>; 3]) -> Self;
    /// Returns the values at the first pixel of the boxes.
    fn first(&self) -> Self::At;
    /// Steps one pixel to the right.
    fn right(&self, at: Self::At) -> Self::At;
    /// Steps one pixel down.
    fn below(&self, at: Self::At) -> Self::At;
    /// Returns the changes by the offsets of samples.
    fn shifts<const N: usize>(&self, sample_positions: &SamplePositions) -> [Self::Shift; N];
    /// Moves the values to a sample.
    fn moved(&self, at: Self::At, shift: Self::Shift) -> Self::At;
    /// Returns which triangles cover the point with these values.
    fn covered(&self, at: Self::At) -> mask32x16<S>;
    /// Returns the edge functions of the second and third corner of the triangles in these lanes,
    /// at pixels at this distance from the first of their boxes. `None` if hits have no colours by
    /// this rule.
    #[inline(always)]
    fn functions(&self, _: i32x16<S>, _: [i32x16<S>; 2]) -> Option<[f32x16<S>; 2]> {
        None
    }
    /// Returns the depths, linear on the screen, of the triangles in these lanes at pixels at this
    /// distance from the first of their boxes. With several samples, `shift` is the sample's
    /// offset.
    fn depths(
        &self,
        lanes: i32x16<S>,
        by: [i32x16<S>; 2],
        shift: Option<&Self::Shift>,
    ) -> f32x16<S>;
}

/// Picks the numbers of some lanes.
#[inline(always)]
fn of_lanes<S: Simd>(of: f32x16<S>, lanes: i32x16<S>) -> f32x16<S> {
    permute(of.bitcast(), lanes).bitcast()
}

/// Returns boxes of the pixels that snapped triangles may cover.
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

/// An integer edge function of sixteen triangles.
#[derive(Clone, Copy)]
struct WholeEdge<S: Simd> {
    /// The value minus the smallest covered value.
    value: i32x16<S>,
    least: i32x16<S>,
    /// The steps for one grid step to the right and one down.
    a: i32x16<S>,
    b: i32x16<S>,
}

/// Computes an edge function as in `coverage`, multiplied by the sign of the area: a = p.y - q.y,
/// b = q.x - p.x, e = a (x - p.x) + b (y - p.y) at x = y = 0.
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

//! What the edge functions of every rule of coverage have in common.

use fearless_simd::{Simd, SimdBase as _, f32x16, i32x16, mask32x16};

use crate::screen::coverage::Grid;
use crate::simd::gather::of_lanes;

/// The bounding boxes of sixteen triangles: left, top, right and bottom.
pub(super) type Boxes<S> = [i32x16<S>; 4];

/// The corners of sixteen triangles: snapped, or the bits of positions in pixels.
pub(super) type Corners<S> = [[i32x16<S>; 2]; 3];

/// Sixteen pixels: the lanes of their triangles, their distances from the first pixels of the
/// boxes and, with several samples, the offset of the sample.
pub(crate) type Places<'a, S, T> = (i32x16<S>, [i32x16<S>; 2], Option<&'a T>);

/// An edge function of sixteen triangles at the first pixels of their boxes.
#[derive(Clone, Copy)]
pub(super) struct Edge<V> {
    pub(super) value: V,
    /// The smallest covered value: 0, or 1 if the top-left rule excludes centres on the edge.
    pub(super) least: V,
    /// The steps to the right and down.
    pub(super) a: V,
    pub(super) b: V,
}

/// The edge functions of sixteen triangles, positive inside for either winding.
pub(crate) trait Edges<S: Simd>: Copy {
    /// The values of the edge functions at a pixel.
    type At: Copy;
    /// The change of the values by the offset of a sample.
    type Shift: Copy;
    /// What the depths of pixels are computed from.
    type Pixels;
    /// The grid of corners.
    const GRID: Grid = Grid::Usual;

    /// Returns boxes of the pixels that triangles may cover in samples at these offsets from
    /// centres.
    #[inline(always)]
    fn bounds([p, q, r]: Corners<S>, [least, most]: [[i32; 2]; 2]) -> Boxes<S> {
        // As in `PixelBox::reached_on`: the arithmetic shifts round down.
        let (half, log2) = (Self::GRID.parts() / 2, Self::GRID.parts().trailing_zeros());
        let (least, most) = (Self::GRID.offset(least), Self::GRID.offset(most));
        [
            (p[0].min(q[0]).min(r[0]) + (half - 1 - most[0])) >> log2,
            (p[1].min(q[1]).min(r[1]) + (half - 1 - most[1])) >> log2,
            ((p[0].max(q[0]).max(r[0]) - (half + least[0])) >> log2) + 1,
            ((p[1].max(q[1]).max(r[1]) - (half + least[1])) >> log2) + 1,
        ]
    }

    /// Sets triangles up, with the depths of their corners.
    fn new(simd: S, corners: Corners<S>, boxes: Boxes<S>, depths: [f32x16<S>; 3]) -> Self;
    /// Returns the values at the first pixel of the boxes.
    fn first(&self) -> Self::At;
    /// Steps one pixel to the right along axis 0, or down along axis 1.
    fn step(&self, at: Self::At, axis: usize) -> Self::At;
    /// Returns the change of the values by the offset of a sample, in subpixels.
    fn shift(&self, by: [i32; 2]) -> Self::Shift;
    /// Moves the values to a sample.
    fn moved(&self, at: Self::At, shift: Self::Shift) -> Self::At;
    /// Returns which triangles cover the point with these values.
    fn covered(&self, at: Self::At) -> mask32x16<S>;
    /// Returns the edge function of corner `i` at some pixels.
    fn function(&self, i: usize, at: Places<'_, S, Self::Shift>) -> f32x16<S>;
    /// Prepares depths at some pixels: the lanes of their triangles, and their distances from the
    /// first pixels of the boxes.
    fn pixels(&self, lanes: i32x16<S>, by: [i32x16<S>; 2]) -> Self::Pixels;
    /// Returns the depths at pixels, linear on the screen, or at samples of theirs. Takes the lanes
    /// of their triangles again.
    fn depths(&self, pixels: &Self::Pixels, at: (i32x16<S>, Option<&Self::Shift>)) -> f32x16<S>;
}

/// Edge functions that are also evaluated for one triangle at a time: in sixteen entries of the
/// visibility buffer, which are the samples of neighbouring pixels of a row.
pub(crate) trait SampledEdges<S: Simd>: Edges<S> {
    /// An edge function of one triangle at one pixel.
    type Value: Copy;
    /// Sixteen triangles, one after the other.
    type Each;

    /// Returns the largest change of each edge function by an offset between these two.
    fn most(&self, offsets: [[i32; 2]; 2]) -> Self::Shift;
    /// Prepares the triangles for entries with these offsets, along x and along y.
    fn each(&self, entries: [i32x16<S>; 2]) -> Self::Each;
    /// Returns the edge function of corner `i` at some pixels: the lanes of their triangles, and
    /// their distances from the first pixels of the boxes.
    fn values(&self, i: usize, at: (i32x16<S>, [i32x16<S>; 2])) -> [Self::Value; 16];
    /// Returns which entries a triangle covers, and its depths there, if these are the values of
    /// its edge functions at the first pixel.
    fn in_entries(of: &Self::Each, lane: usize, at: [Self::Value; 3]) -> (mask32x16<S>, f32x16<S>);
}

/// Depths in f32 at some pixels: their second and third edge functions, the depth of the first
/// corner, and its growth with these functions.
#[derive(Clone, Copy)]
pub(crate) struct LinearDepths<S: Simd> {
    edges: [f32x16<S>; 2],
    depth: f32x16<S>,
    growth: [f32x16<S>; 2],
}

impl<S: Simd> LinearDepths<S> {
    #[inline(always)]
    pub(super) fn new<E: Edges<S>>(
        edges: &E,
        [depth, second, third]: [f32x16<S>; 3],
        at: Places<'_, S, E::Shift>,
    ) -> Self {
        let (lanes, ..) = at;
        Self {
            edges: [edges.function(1, at), edges.function(2, at)],
            depth: of_lanes(depth, lanes),
            growth: [of_lanes(second, lanes), of_lanes(third, lanes)],
        }
    }

    #[inline(always)]
    pub(super) fn at_pixels(&self) -> f32x16<S> {
        let ([second, third], [to_second, to_third]) = (self.edges, self.growth);
        self.depth + second * to_second + third * to_third
    }

    /// Moves the pixels to samples that change the edge functions by this.
    #[inline(always)]
    pub(super) fn moved(&self, [second, third]: [f32x16<S>; 2]) -> Self {
        Self { edges: [self.edges[0] + second, self.edges[1] + third], ..*self }
    }
}

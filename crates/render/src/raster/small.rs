//! Rasterises small triangles, sixteen at a time, one per lane.
//!
//! Triangles with a bounding box of at most 16 x 16 pixels wait in queues by the size of their
//! boxes. Sixteen triangles are then stepped together over the pixels of their boxes, and the
//! covered pixels are listed, because in each step only few lanes cover a pixel. Afterwards each
//! lane takes a pixel of the list, computes its depth and adds it to the hits of the bins. Setup of
//! triangles of 5 pixels takes 0.55 of the time compared with computing depths in each step
//! (AVX-512). With several samples per pixel, triangles of more than a few pixels wait for their
//! tile instead (`tile_queues`). The pixels that they may cover in any sample are listed, and lanes
//! are then the samples of one pixel.
//!
//! The edge functions depend on the rule of coverage: see `small_edges`.

use fearless_simd::{
    Bytes as _, Simd, SimdBase as _, SimdMask as _, f32x16, i32x16, mask32x16, u32x16,
};

use super::bins::Bins;
use super::covered::{Covered, MOST};
use super::hits::{PACK, Pixels};
use super::queue::{Pack, SMALL};
use super::rule::Rule;
use super::small_edges::{Edges, SampledEdges};
use crate::screen::coverage::{PixelBox, SUBPIXELS};
use crate::screen::sample_positions::{MANY, SamplePositions};
use crate::screen::tiles::{PIXELS, TILE, lanes_place};
use crate::simd::gather::permute;
use crate::simd::{Real, UP_TO_SIXTEEN};

/// Draws the triangles of a queue in packs of sixteen, with `N` samples per pixel.
///
/// Compiled as a separate function because it is called from several places.
#[inline(always)]
pub(crate) fn draw_queue<S: Simd, R: Rule, const N: usize>(simd: S, queue: usize, bins: &mut Bins) {
    simd.vectorize(
        #[inline(always)]
        || {
            for at in (0..bins.queues[queue].waiting()).step_by(PACK) {
                let pack = bins.queues[queue].pack(simd, at);
                draw_pack::<S, R, N>(queue, &pack, bins);
            }
            bins.queues[queue].forget();
        },
    );
}

/// Draws sixteen triangles of a queue.
#[inline(always)]
pub(super) fn draw_pack<S: Simd, R: Rule, const N: usize>(
    queue: usize,
    pack: &Pack<S>,
    bins: &mut Bins,
) {
    if queue + 1 == SMALL.len() {
        draw::<S, R::LastEdges<S>, N>(pack, bins);
    } else {
        draw::<S, R::Edges<S>, N>(pack, bins);
    }
}

#[inline(always)]
fn draw<S: Simd, E: Edges<S>, const N: usize>(pack: &Pack<S>, bins: &mut Bins) {
    let sample_positions = bins.sample_positions;
    let lanes = Lanes::<S, E>::new(pack, (sample_positions.reach::<N>(), 1));
    // The tiles are found once for all sixteen triangles.
    let reach = bins.hits.reach(lanes.bounds());
    let Bins { hits, covered, .. } = bins;
    let samples = sample_positions.count_in::<N>();
    // One sample after the other: list the covered pixels, then compute depths.
    for sample in 0..samples {
        // A single sample lies at the centre, which saves adding its offset.
        let shift = match N {
            1 => None,
            _ => Some(lanes.edges.shift(sample_positions.shift::<N>(sample))),
        };
        lanes.scan(shift, covered);
        lanes.each_pixel(
            covered,
            #[inline(always)]
            |own, count| {
                let CoveredPixels { x, y, number, .. } = *own;
                let depth = lanes.depths(own, shift.as_ref());
                let pixels = Pixels { x, y, depth: depth.bitcast(), number };
                hits.add_first(&reach, (&pixels, (sample, samples)), count);
            },
        );
    }
}

/// Sixteen small triangles, set up for rasterisation.
pub(super) struct Lanes<S: Simd, E> {
    /// The bounding boxes.
    left: i32x16<S>,
    top: i32x16<S>,
    right: i32x16<S>,
    bottom: i32x16<S>,
    number: u32x16<S>,
    edges: E,
    low: f32x16<S>,
    high: f32x16<S>,
    /// The number of neighbouring pixels of a row that are listed together.
    across: i32,
}

impl<S: Simd, E: Edges<S>> Lanes<S, E> {
    /// Sets triangles up. Their boxes start at multiples of `across`.
    #[inline(always)]
    pub(super) fn new(pack: &Pack<S>, (reach, across): ([[i32; 2]; 2], i32)) -> Self {
        let [x0, y0, x1, y1, x2, y2, d0, d1, d2, number] = *pack;
        let corners = [[x0, y0], [x1, y1], [x2, y2]];
        let [left, top, right, bottom] = E::bounds(corners, reach);
        let left = left & -across;
        let (d0, d1, d2) =
            (d0.bitcast::<f32x16<S>>(), d1.bitcast::<f32x16<S>>(), d2.bitcast::<f32x16<S>>());
        Self {
            left,
            top,
            right,
            bottom,
            number: number.bitcast(),
            edges: E::new(left.simd, corners, [left, top, right, bottom], [d0, d1, d2]),
            low: Real::min(Real::min(d0, d1), d2),
            high: Real::max(Real::max(d0, d1), d2),
            across,
        }
    }

    /// Returns the bounding box of all boxes.
    #[inline(always)]
    fn bounds(&self) -> PixelBox {
        PixelBox {
            left: self.left.reduce_min(),
            top: self.top.reduce_min(),
            right: self.right.reduce_max(),
            bottom: self.bottom.reduce_max(),
        }
    }

    /// Lists the pixels with centres that the triangles cover, after a shift of the edge functions.
    #[inline(always)]
    fn scan(&self, shift: Option<E::Shift>, covered: &mut Covered) {
        let (widths, heights) = (self.right - self.left, self.bottom - self.top);
        let mut row = self.edges.first();
        if let Some(shift) = shift {
            row = self.edges.moved(row, shift);
        }
        let mut count = 0;
        let mut row_pixels = i32x16::from_slice(self.left.simd, &UP_TO_SIXTEEN);
        // All lanes step over the largest box.
        for y in 0..heights.reduce_max() {
            let (mut at, mut pixels) = (row, row_pixels);
            let in_rows = heights.simd_gt(y);
            for x in (0..widths.reduce_max()).step_by(self.across as usize) {
                let mut some = self.edges.covered(at);
                // Outside its own box, a lane covers no pixel, but sums of bounds may.
                if shift.is_some() {
                    some = some & in_rows & widths.simd_gt(x);
                }
                // The list has room for every pixel; the remainder only saves a bounds check.
                let to = count % MOST;
                // A compressing store appends only the lanes that cover the pixel.
                pixels.compress(some).store_slice(&mut covered.pixels[to..to + PACK]);
                count = to + some.to_bitmask().count_ones() as usize;
                for _ in 0..self.across {
                    at = self.edges.step(at, 0);
                }
                pixels += 1 << 4;
            }
            row = self.edges.step(row, 1);
            row_pixels += 1 << 8;
        }
        covered.count = count;
    }

    /// Removes the listed pixels outside a box.
    #[inline(always)]
    fn keep(&self, within: PixelBox, covered: &mut Covered) {
        // The list is compacted in place: writing never overtakes reading.
        let mut kept = 0;
        for at in (0..covered.count).step_by(PACK) {
            let pixels = i32x16::from_slice(self.left.simd, &covered.pixels[at..at + PACK]);
            let [x, y] = self.place(pixels);
            let inside = x.simd_ge(within.left)
                & x.simd_lt(within.right)
                & y.simd_ge(within.top)
                & y.simd_lt(within.bottom)
                & first(self.left.simd, covered.count - at);
            pixels.compress(inside).store_slice(&mut covered.pixels[kept..kept + PACK]);
            kept += inside.to_bitmask().count_ones() as usize;
        }
        covered.count = kept;
    }

    /// Returns the lanes of listed pixels, and their distances from the first pixels of the boxes.
    #[inline(always)]
    fn in_boxes(&self, pixels: i32x16<S>) -> (i32x16<S>, [i32x16<S>; 2]) {
        (pixels & 15, [((pixels >> 4) & 15) * self.across, pixels >> 8])
    }

    /// Returns the columns and rows of listed pixels.
    #[inline(always)]
    fn place(&self, pixels: i32x16<S>) -> [i32x16<S>; 2] {
        let (lanes, by) = self.in_boxes(pixels);
        [permute(self.left, lanes) + by[0], permute(self.top, lanes) + by[1]]
    }

    /// Calls `take` with the pixels of a list, sixteen at a time, and their number.
    #[inline(always)]
    fn each_pixel(&self, covered: &Covered, mut take: impl FnMut(&CoveredPixels<S, E>, usize)) {
        for at in (0..covered.count).step_by(PACK) {
            let pixels = i32x16::from_slice(self.left.simd, &covered.pixels[at..at + PACK]);
            // A lane is now a pixel of the list; the numbers of its triangle are permuted into it.
            let (lanes, by) = self.in_boxes(pixels);
            let low = permute(self.low.bitcast(), lanes).bitcast::<f32x16<S>>();
            let high = permute(self.high.bitcast(), lanes).bitcast::<f32x16<S>>();
            let [x, y] = self.place(pixels);
            let number = permute(self.number.bitcast(), lanes).bitcast();
            let edges = self.edges.pixels(lanes, by);
            let own = CoveredPixels { lanes, x, y, number, edges, low, high };
            take(&own, (covered.count - at).min(PACK));
        }
    }

    /// Returns the depths of pixels at a sample with this offset, or at their centres.
    #[inline(always)]
    fn depths(&self, of: &CoveredPixels<S, E>, shift: Option<&E::Shift>) -> f32x16<S> {
        clamped(self.edges.depths(&of.edges, (of.lanes, shift)), [of.low, of.high])
    }
}

impl<S: Simd, E: SampledEdges<S>> Lanes<S, E> {
    /// Calls `take` with sixteen entries of a tile at a time, which some triangle may cover: the
    /// index of their first pixel, the triangle, the covered entries and the depths.
    #[inline(always)]
    pub(super) fn each_entries(
        &self,
        positions: &SamplePositions,
        within: PixelBox,
        covered: &mut Covered,
        mut take: impl FnMut(usize, u32, mask32x16<S>, f32x16<S>),
    ) {
        // One test decides for all entries together: each edge function where it is largest.
        let [least, [x, y]] = positions.reach::<MANY>();
        let most = [x + (self.across - 1) * SUBPIXELS, y];
        self.scan(Some(self.edges.most([least, most])), covered);
        // Triangles in several tiles have pixels outside this one.
        if self.bounds().intersection(within) != self.bounds() {
            self.keep(within, covered);
        }
        let simd = self.left.simd;
        let triangles = self.edges.each(positions.of_entries(simd));
        let numbers = <[u32; PACK]>::from(self.number);
        let (low, high) = (<[f32; PACK]>::from(self.low), <[f32; PACK]>::from(self.high));
        for at in (0..covered.count).step_by(PACK) {
            let pixels = i32x16::from_slice(simd, &covered.pixels[at..at + PACK]);
            let [x, y] = self.place(pixels);
            let pixels_of_tile =
                <[i32; PACK]>::from(lanes_place(x & (TILE - 1), y & (TILE - 1), (0, 1)));
            let place = self.in_boxes(pixels);
            let edges = [
                self.edges.values(0, place),
                self.edges.values(1, place),
                self.edges.values(2, place),
            ];
            let lanes = <[i32; PACK]>::from(place.0);
            // Lanes are now the entries of one triangle.
            for i in 0..(covered.count - at).min(PACK) {
                let lane = lanes[i].cast_unsigned() as usize % PACK;
                let at = [edges[0][i], edges[1][i], edges[2][i]];
                let (some, depth) = E::in_entries(&triangles, lane, at);
                let bounds = [f32x16::splat(simd, low[lane]), f32x16::splat(simd, high[lane])];
                let pixel = pixels_of_tile[i].cast_unsigned() as usize % PIXELS;
                take(pixel, numbers[lane], some, clamped(depth, bounds));
            }
        }
    }
}

/// Clamps depths to the depths of the corners.
#[inline(always)]
fn clamped<S: Simd>(depth: f32x16<S>, [low, high]: [f32x16<S>; 2]) -> f32x16<S> {
    Real::min(Real::max(depth, low), high)
}

/// Sixteen pixels covered by some of sixteen triangles.
struct CoveredPixels<S: Simd, E: Edges<S>> {
    /// The lanes of the pixels' triangles.
    lanes: i32x16<S>,
    x: i32x16<S>,
    y: i32x16<S>,
    /// The numbers of the triangles.
    number: u32x16<S>,
    /// What depths are computed from.
    edges: E::Pixels,
    /// The smallest and largest depths of the corners.
    low: f32x16<S>,
    high: f32x16<S>,
}

/// Returns a mask of the first lanes, up to sixteen.
#[inline(always)]
fn first<S: Simd>(simd: S, count: usize) -> mask32x16<S> {
    mask32x16::from_bitmask(simd, (1 << count.min(PACK)) - 1)
}

//! Rasterises small triangles, sixteen at a time, one per lane.
//!
//! Triangles with a bounding box of at most 16 x 16 pixels wait in queues by the size of their
//! boxes. Sixteen triangles are then stepped together over the pixels of their boxes, and the
//! covered pixels are listed, because in each step only few lanes cover a pixel. Afterwards each
//! lane takes a pixel of the list, computes its depth and adds it to the hits of the bins. Setup of
//! triangles of 5 pixels takes 0.55 of the time compared with computing depths in each step
//! (AVX-512). With several samples per pixel, triangles of more than a few pixels wait for their
//! tile instead (`tile_queues`), and their pixels are listed once for all samples.
//!
//! The edge functions depend on the rule of coverage: see `small_edges`.

use fearless_simd::{
    Bytes as _, Select as _, Simd, SimdBase as _, SimdMask as _, f32x16, i32x16, mask32x16, u32x16,
};

use super::bins::Bins;
use super::covered::{Covered, MOST, SAMPLES};
use super::hits::{PACK, Pixels};
use super::queue::{Pack, SMALL};
use super::rule::Rule;
use super::small_edges::Edges;
use crate::screen::coverage::PixelBox;
use crate::screen::sample_positions::SamplePositions;
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
    let simd = pack[0].simd;
    let sample_positions = bins.sample_positions;
    let lanes = Lanes::<S, E>::new(simd, pack, sample_positions.reach::<N>());
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
        lanes.scan(shift.as_slice(), covered);
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

/// Sixteen small triangles with `N` samples per pixel, set up for rasterisation.
pub(super) struct SampledLanes<S: Simd, E: Edges<S>, const N: usize> {
    lanes: Lanes<S, E>,
    shifts: [E::Shift; N],
}

impl<S: Simd, E: Edges<S>, const N: usize> SampledLanes<S, E, N> {
    #[inline(always)]
    pub(super) fn new(pack: &Pack<S>, sample_positions: &SamplePositions) -> Self {
        let lanes = Lanes::<S, E>::new(pack[0].simd, pack, sample_positions.reach::<N>());
        let mut shifts = [lanes.edges.shift(sample_positions.shift::<N>(0)); N];
        for (sample, shift) in shifts.iter_mut().enumerate().skip(1) {
            *shift = lanes.edges.shift(sample_positions.shift::<N>(sample));
        }
        Self { lanes, shifts }
    }

    /// Calls `take` with the pixels of a box covered in any sample, sixteen at a time, and their
    /// number.
    #[inline(always)]
    pub(super) fn each_in(
        &self,
        within: PixelBox,
        covered: &mut Covered,
        take: impl FnMut(&CoveredPixels<S, E>, usize),
    ) {
        let Self { lanes, shifts } = self;
        lanes.scan(shifts, covered);
        // Triangles in several tiles have pixels outside this one.
        if lanes.bounds().intersection(within) != lanes.bounds() {
            lanes.keep(within, covered);
        }
        lanes.each_pixel(covered, take);
    }

    /// Returns the depths of pixels in one of their samples.
    #[inline(always)]
    pub(super) fn depths(&self, of: &CoveredPixels<S, E>, sample: usize) -> f32x16<S> {
        self.lanes.depths(of, Some(&self.shifts[sample % N]))
    }
}

/// Sixteen small triangles, set up for rasterisation.
struct Lanes<S: Simd, E> {
    /// The bounding boxes.
    left: i32x16<S>,
    top: i32x16<S>,
    right: i32x16<S>,
    bottom: i32x16<S>,
    number: u32x16<S>,
    edges: E,
    low: f32x16<S>,
    high: f32x16<S>,
}

impl<S: Simd, E: Edges<S>> Lanes<S, E> {
    #[inline(always)]
    fn new(simd: S, pack: &Pack<S>, reach: [[i32; 2]; 2]) -> Self {
        let [x0, y0, x1, y1, x2, y2, d0, d1, d2, number] = *pack;
        let corners = [[x0, y0], [x1, y1], [x2, y2]];
        let [left, top, right, bottom] = E::bounds(corners, reach);
        let (d0, d1, d2) =
            (d0.bitcast::<f32x16<S>>(), d1.bitcast::<f32x16<S>>(), d2.bitcast::<f32x16<S>>());
        Self {
            left,
            top,
            right,
            bottom,
            number: number.bitcast(),
            edges: E::new(simd, corners, [left, top, right, bottom], [d0, d1, d2]),
            low: Real::min(Real::min(d0, d1), d2),
            high: Real::max(Real::max(d0, d1), d2),
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

    /// Lists the pixels that the triangles cover in any of the samples with these offsets, or at
    /// their centres without offsets.
    #[inline(always)]
    fn scan(&self, shifts: &[E::Shift], covered: &mut Covered) {
        let columns = (self.right - self.left).reduce_max();
        let rows = (self.bottom - self.top).reduce_max();
        let mut row = self.edges.first();
        if let [shift] = shifts {
            row = self.edges.moved(row, *shift);
        }
        let mut count = 0;
        let mut row_pixels = i32x16::from_slice(self.left.simd, &UP_TO_SIXTEEN);
        // All lanes step over the largest box. Outside its own box, a lane covers no pixel.
        for _ in 0..rows {
            let (mut at, mut pixels) = (row, row_pixels);
            for _ in 0..columns {
                let (some, listed) = match shifts {
                    [] | [_] => (self.edges.covered(at), pixels),
                    _ => self.covered_samples(shifts, at, pixels),
                };
                // The list has room for every pixel; the remainder only saves a bounds check.
                let to = count % MOST;
                // A compressing store appends only the lanes that cover the pixel.
                listed.compress(some).store_slice(&mut covered.pixels[to..to + PACK]);
                count = to + some.to_bitmask().count_ones() as usize;
                at = self.edges.step(at, 0);
                pixels += 1 << 4;
            }
            row = self.edges.step(row, 1);
            row_pixels += 1 << 8;
        }
        covered.count = count;
    }

    /// Returns the triangles that cover any sample of a pixel, and the pixel's list entry with a
    /// bit for each covered sample.
    #[inline(always)]
    fn covered_samples(
        &self,
        shifts: &[E::Shift],
        at: E::At,
        pixels: i32x16<S>,
    ) -> (mask32x16<S>, i32x16<S>) {
        let nothing = i32x16::splat(pixels.simd, 0);
        let mut samples = nothing;
        let mut bit = i32x16::splat(pixels.simd, 1 << SAMPLES);
        for shift in shifts {
            let some = self.edges.covered(self.edges.moved(at, *shift));
            samples |= some.select(bit, nothing);
            bit += bit;
        }
        (samples.simd_gt(nothing), samples | pixels)
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

    /// Returns the columns and rows of listed pixels.
    #[inline(always)]
    fn place(&self, pixels: i32x16<S>) -> [i32x16<S>; 2] {
        let lanes = pixels & 15;
        let by = [(pixels >> 4) & 15, (pixels >> 8) & 15];
        [permute(self.left, lanes) + by[0], permute(self.top, lanes) + by[1]]
    }

    /// Calls `take` with the pixels of a list, sixteen at a time, and their number.
    #[inline(always)]
    fn each_pixel(&self, covered: &Covered, mut take: impl FnMut(&CoveredPixels<S, E>, usize)) {
        for at in (0..covered.count).step_by(PACK) {
            let pixels = i32x16::from_slice(self.left.simd, &covered.pixels[at..at + PACK]);
            // A lane is now a pixel of the list; the numbers of its triangle are permuted into it.
            let by = [(pixels >> 4) & 15, (pixels >> 8) & 15];
            let lanes = pixels & 15;
            let low = permute(self.low.bitcast(), lanes).bitcast::<f32x16<S>>();
            let high = permute(self.high.bitcast(), lanes).bitcast::<f32x16<S>>();
            let [x, y] = self.place(pixels);
            let number = permute(self.number.bitcast(), lanes).bitcast();
            let samples = pixels >> SAMPLES;
            let edges = self.edges.pixels(lanes, by);
            let own = CoveredPixels { lanes, x, y, number, edges, low, high, samples };
            take(&own, (covered.count - at).min(PACK));
        }
    }

    /// Returns the depths of pixels at a sample with this offset, or at their centres.
    #[inline(always)]
    fn depths(&self, of: &CoveredPixels<S, E>, shift: Option<&E::Shift>) -> f32x16<S> {
        let linear = self.edges.depths(&of.edges, (of.lanes, shift));
        // Clamped to the depths of the corners.
        let linear = linear.simd_gt(of.low).select(linear, of.low);
        linear.simd_lt(of.high).select(linear, of.high)
    }
}

/// Sixteen pixels covered by some of sixteen triangles in any sample.
pub(super) struct CoveredPixels<S: Simd, E: Edges<S>> {
    /// The lanes of the pixels' triangles.
    lanes: i32x16<S>,
    pub(super) x: i32x16<S>,
    pub(super) y: i32x16<S>,
    /// The numbers of the triangles.
    pub(super) number: u32x16<S>,
    /// What depths are computed from.
    edges: E::Pixels,
    /// The smallest and largest depths of the corners.
    low: f32x16<S>,
    high: f32x16<S>,
    /// The covered samples, a bit for each of several.
    samples: i32x16<S>,
}

impl<S: Simd, E: Edges<S>> CoveredPixels<S, E> {
    /// Returns which of the first `count` pixels are covered in one of several samples.
    #[inline(always)]
    pub(super) fn covered(&self, sample: usize, count: usize) -> mask32x16<S> {
        let bit = 1 << sample;
        (self.samples & bit).simd_eq(bit) & first(self.x.simd, count)
    }
}

/// Returns a mask of the first lanes, up to sixteen.
#[inline(always)]
fn first<S: Simd>(simd: S, count: usize) -> mask32x16<S> {
    mask32x16::from_bitmask(simd, (1 << count.min(PACK)) - 1)
}

//! Rasterises a large triangle in one tile.
//!
//! The edge functions are 64-bit integers. First, all blocks of the tile are classified at once as
//! untouched, touched or fully covered. Then only the touched blocks are rasterised, a row of eight
//! pixels at a time. The cost of a large triangle is therefore per block, not per pixel, until its
//! depths are needed.

use fearless_simd::{
    Simd, SimdBase as _, SimdFloat as _, SimdInt as _, SimdMask as _, SimdNarrow as _, f32x16,
    f64x8, i64x8, mask32x16,
};

use super::bins::LargeTriangle;
use super::depth_format::Format;
use super::visibility_buffer::{in_front, put_rows};
use crate::screen::coverage::{PixelBox, Triangle};
use crate::screen::sample_positions::SamplePositions;
use crate::screen::tiles::{BLOCK, BLOCK_PIXELS};
use crate::simd::Real;
use marraztu_core::base::math::each;

/// The bound of rounding for depths in a block, beyond the depths at its corners: a few steps of
/// 2^-53, because all terms are at most 1 inside the triangle.
const ROUNDING: f64 = 1e-14;

/// A triangle relative to a tile.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Large {
    /// The edge functions at the first pixel of the tile.
    edges: [i64; 3],
    /// The steps of the edge functions for one pixel to the right and one pixel down.
    right: [i64; 3],
    down: [i64; 3],
    /// The smallest values of the edge functions at covered centres.
    least: [i64; 3],
    depth: f64,
    to_second: f64,
    to_third: f64,
    low: f32,
    /// The largest depth of the corners.
    pub(crate) high: f32,
    /// The triangle's number in the frame.
    pub(crate) number: u32,
}

/// The treatment of pixels that pass the depth test: holes let the surface behind show through.
pub(crate) trait InFront<S: Simd> {
    /// Whether the treatment does anything.
    const MATTERS: bool = true;
    /// Treats the pixels of two rows of a block that pass the depth test, and returns a bit mask of
    /// the opaque ones. The arguments are the mask of pixels, the edge functions of the second and
    /// third corner in each row, and the depths.
    fn opaque(
        &mut self,
        simd: S,
        pair: usize,
        pixels: u64,
        edges: [[f64x8<S>; 2]; 2],
        depth: f32x16<S>,
    ) -> u64;
}

/// A triangle without holes: no treatment.
pub(crate) struct Solid;

impl<S: Simd> InFront<S> for Solid {
    const MATTERS: bool = false;

    #[inline(always)]
    fn opaque(&mut self, _: S, _: usize, pixels: u64, _: [[f64x8<S>; 2]; 2], _: f32x16<S>) -> u64 {
        pixels
    }
}

/// Blocks of a tile, a bit for each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Touched {
    /// The blocks with possibly covered pixels.
    pub(crate) some: u64,
    /// The blocks that are fully covered.
    pub(crate) whole: u64,
}

impl Large {
    /// Sets up the triangle for the tile with this first pixel.
    #[expect(clippy::cast_precision_loss, reason = "the nearest number is meant")]
    pub(crate) fn new(large: &LargeTriangle, triangle: &Triangle, [x, y]: [i32; 2]) -> Self {
        let [a, b, c] = each(large.corners, |corner| corner.depth);
        let per_area = 1.0 / triangle.doubled_area() as f64;
        let [right, down] = triangle.steps();
        Self {
            edges: triangle.edges_at(x, y),
            right,
            down,
            least: triangle.least(),
            depth: f64::from(a),
            to_second: (f64::from(b) - f64::from(a)) * per_area,
            to_third: (f64::from(c) - f64::from(a)) * per_area,
            low: a.min(b).min(c),
            high: a.max(b).max(c),
            number: large.number,
        }
    }

    /// Returns the change of the edge functions for an offset in subpixels.
    #[inline(always)]
    pub(crate) fn gain(&self, [x, y]: [i32; 2]) -> [i64; 3] {
        let (x, y) = (i64::from(x), i64::from(y));
        // Exact: a pixel has 256 or 4096 grid steps, so 256 divides the steps per pixel.
        let gain = |i: usize| (self.right[i] >> 8) * x + (self.down[i] >> 8) * y;
        [gain(0), gain(1), gain(2)]
    }

    /// Finds the blocks of the tile that the triangle touches in any of the `N` samples of their
    /// pixels, restricted to blocks that `area` reaches into. `area` must not be empty; it is in
    /// pixels relative to the tile's first.
    #[inline(always)]
    pub(crate) fn blocks<S: Simd, const N: usize>(
        &self,
        simd: S,
        area: PixelBox,
        sample_positions: &SamplePositions,
    ) -> Touched {
        let mut touched = Touched::default();
        let columns = eight_bits(area.left / BLOCK, (area.right - 1) / BLOCK);
        let across = f64x8::from_slice(simd, &UP_TO_EIGHT).to_int::<i64x8<S>>();
        let side = i64::from(BLOCK);
        // Bounds of the change of the edge functions from the centre to a sample.
        let (mut most, mut least) = ([0; 3], [0; 3]);
        if N > 1 {
            (most, least) = ([i64::MIN; 3], [i64::MAX; 3]);
            let [from, to] = sample_positions.reach::<N>();
            for corner in [from, to, [from[0], to[1]], [to[0], from[1]]] {
                let gain = self.gain(corner);
                most = [0, 1, 2].map(|i: usize| most[i].max(gain[i]));
                least = [0, 1, 2].map(|i: usize| least[i].min(gain[i]));
            }
        }
        for row in area.top / BLOCK..(area.bottom - 1) / BLOCK + 1 {
            let (mut some, mut whole) = (columns, columns);
            for i in 0..3 {
                // Tests a row of eight blocks at the corner with the largest, and with the
                // smallest, value.
                let first = self.edges[i] + i64::from(row) * side * self.down[i] - self.least[i];
                let (x, y) = (7 * self.right[i], 7 * self.down[i]);
                let first = across * (side * self.right[i]) + first;
                some &= (first + (x.max(0) + y.max(0) + most[i])).simd_ge(0).to_bitmask();
                whole &= (first + (x.min(0) + y.min(0) + least[i])).simd_ge(0).to_bitmask();
            }
            touched.some |= some << (8 * row);
            touched.whole |= (some & whole) << (8 * row);
        }
        touched
    }

    /// Evaluates the edge functions at the first pixel of a block.
    #[inline(always)]
    fn edges_at(&self, block: usize) -> [i64; 3] {
        let (x, y) = ((block % 8 * 8) as i64, (block / 8 * 8) as i64);
        let at = |i: usize| self.edges[i] + x * self.right[i] + y * self.down[i];
        [at(0), at(1), at(2)]
    }

    /// Bounds the triangle's depth in the `N` samples of a fully covered block: smallest and
    /// largest.
    #[inline(always)]
    #[expect(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        reason = "the rounding is allowed for"
    )]
    pub(crate) fn depths<const N: usize>(&self, block: usize) -> [f32; 2] {
        let [_, second, third] = self.edges_at(block);
        let first = self.depth + second as f64 * self.to_second + third as f64 * self.to_third;
        let gain = |steps: &[i64; 3]| {
            7.0 * (steps[1] as f64 * self.to_second + steps[2] as f64 * self.to_third)
        };
        // Depth is linear, so its extremes in the block are at corners.
        let (mut x, mut y) = (gain(&self.right), gain(&self.down));
        let mut first = first;
        if N > 1 {
            // From half a pixel before the first centre to half a pixel after the last.
            first -= (x + y) / 14.0;
            (x, y) = (x * (8.0 / 7.0), y * (8.0 / 7.0));
        }
        let low = (first + x.min(0.0) + y.min(0.0) - ROUNDING) as f32;
        let high = (first + x.max(0.0) + y.max(0.0) + ROUNDING) as f32;
        [low.max(self.low), high.min(self.high)]
    }

    /// Draws the triangle into a block of the visibility buffer, for the sample with this offset.
    /// `whole` tells that it covers the block fully.
    #[inline(always)]
    pub(crate) fn draw<S: Simd, I: InFront<S>>(
        &self,
        format: Format,
        simd: S,
        (block, shift): (usize, [i32; 2]),
        whole: bool,
        in_front_of: &mut I,
        visibility: &mut [u64; BLOCK_PIXELS],
    ) {
        let across = f64x8::from_slice(simd, &UP_TO_EIGHT).to_int::<i64x8<S>>();
        let (first, gain) = (self.edges_at(block), self.gain(shift));
        let first = [first[0] + gain[0], first[1] + gain[1], first[2] + gain[2]];
        let [a, b, c] = self.right;
        // Edge functions are stepped from row to row, two rows per iteration.
        let mut edges = [across * a + first[0], across * b + first[1], across * c + first[2]];
        let (two, _) = visibility.as_chunks_mut::<16>();
        for (pair, visibility) in two.iter_mut().enumerate() {
            let upper = edges;
            let lower = self.below(upper);
            edges = self.below(lower);
            let covered =
                if whole { [u64::MAX; 2] } else { [self.inside(upper), self.inside(lower)] };
            if covered == [0; 2] {
                continue;
            }
            let depth = self.clamped(self.depth_at(upper).narrow(self.depth_at(lower)));
            let covered = (covered[0] & 0xff) | (covered[1] & 0xff) << 8;
            let mut covered = mask32x16::from_bitmask(simd, covered);
            // Holes only matter in pixels that pass the depth test.
            if I::MATTERS {
                let front = in_front(format, simd, covered, depth, self.number, visibility);
                if front == 0 {
                    continue;
                }
                let float = |edges: i64x8<S>| edges.to_float::<f64x8<S>>();
                let rows = [[float(upper[1]), float(upper[2])], [float(lower[1]), float(lower[2])]];
                let opaque = in_front_of.opaque(simd, pair, front, rows, depth);
                if opaque == 0 {
                    continue;
                }
                covered = mask32x16::from_bitmask(simd, opaque);
            }
            put_rows(format, simd, covered, depth, self.number, visibility);
        }
    }

    /// Draws the triangle into a block of the visibility buffer with several samples per pixel.
    /// `whole` tells that it covers the block fully.
    #[inline(always)]
    pub(crate) fn draw_samples<S: Simd>(
        &self,
        format: Format,
        simd: S,
        block: usize,
        whole: bool,
        (positions, entries): (&SamplePositions, &mut [u64]),
    ) {
        let first = self.edges_at(block);
        // Sixteen entries are some samples of neighbouring pixels of a row.
        let gains: [[i64; 3]; 16] = std::array::from_fn(|lane| self.gain(positions.of_entry(lane)));
        let row = |i: usize| gains.map(|gain| gain[i]);
        let rows = [row(0), row(1), row(2)];
        let upper = each(
            rows,
            #[inline(always)]
            |row| i64x8::from_slice(simd, &row[..8]),
        );
        let lower = each(
            rows,
            #[inline(always)]
            |row| i64x8::from_slice(simd, &row[8..]),
        );
        for (group, entries) in entries.as_chunks_mut::<16>().0.iter_mut().enumerate() {
            let [x, y] = positions.pixel_of(group).map(i64::from);
            let at = |i: usize| first[i] + x * self.right[i] + y * self.down[i];
            let [a, b, c] = [at(0), at(1), at(2)];
            let upper = [upper[0] + a, upper[1] + b, upper[2] + c];
            let lower = [lower[0] + a, lower[1] + b, lower[2] + c];
            let covered = match whole {
                true => 0xffff,
                false => (self.inside(upper) & 0xff) | (self.inside(lower) & 0xff) << 8,
            };
            if covered == 0 {
                continue;
            }
            let depth = self.clamped(self.depth_at(upper).narrow(self.depth_at(lower)));
            let covered = mask32x16::from_bitmask(simd, covered);
            put_rows(format, simd, covered, depth, self.number, entries);
        }
    }

    /// Clamps depths to those of the corners, because rounding must not move them beyond.
    #[inline(always)]
    fn clamped<S: Simd>(&self, depth: f32x16<S>) -> f32x16<S> {
        let (low, high) =
            (f32x16::splat(depth.simd, self.low), f32x16::splat(depth.simd, self.high));
        Real::min(Real::max(depth, low), high)
    }

    #[inline(always)]
    fn below<S: Simd>(&self, [a, b, c]: [i64x8<S>; 3]) -> [i64x8<S>; 3] {
        [a + self.down[0], b + self.down[1], c + self.down[2]]
    }

    #[inline(always)]
    fn inside<S: Simd>(&self, [a, b, c]: [i64x8<S>; 3]) -> u64 {
        let [x, y, z] = self.least;
        (a.simd_ge(x) & b.simd_ge(y) & c.simd_ge(z)).to_bitmask()
    }

    /// Computes the depths at points with these edge functions, before clamping to the corners'
    /// depths.
    #[inline(always)]
    fn depth_at<S: Simd>(&self, [_, second, third]: [i64x8<S>; 3]) -> f64x8<S> {
        let (second, third) = (second.to_float::<f64x8<S>>(), third.to_float::<f64x8<S>>());
        second * self.to_second + self.depth + third * self.to_third
    }

    /// Computes the depth at a point with these edge functions.
    #[cfg(test)]
    #[expect(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        reason = "the nearest number is meant"
    )]
    pub(crate) fn depth(&self, [_, second, third]: [i64; 3]) -> f32 {
        let depth = self.depth + second as f64 * self.to_second + third as f64 * self.to_third;
        let depth = depth as f32;
        let depth = if depth > self.low { depth } else { self.low };
        if depth < self.high { depth } else { self.high }
    }
}

/// The column numbers of eight pixels.
const UP_TO_EIGHT: [f64; 8] = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];

/// Returns the bits from `first` to `last`.
#[inline(always)]
const fn eight_bits(first: i32, last: i32) -> u64 {
    (0xff << first) & (0xff >> (7 - last))
}

//! Rasterises a triangle with a bounding box of at most 64 x 64 pixels, in one tile.
//!
//! The result has the same bits as [`large`](super::large). Edge functions relative to the tile fit
//! 32 bits, so sixteen pixels or blocks are tested at once. Depths are computed from edge functions
//! in f64, which holds these integers exactly.

use fearless_simd::{Simd, SimdBase as _, SimdMask as _, SimdNarrow as _, f32x16, f64x8, i32x16};

use super::bins::LargeTriangle;
use super::depth_format::Format;
use super::large::Touched;
use super::visibility_buffer::put_rows;
use crate::screen::coverage::{PixelBox, SUBPIXELS};
use crate::screen::sample_positions::{MANY, SamplePositions};
use crate::screen::tiles::{BLOCK, BLOCK_PIXELS, TILE};
use crate::simd::{Bits, Real, in_f64};
use marraztu_core::base::math::each;

/// The largest side of the bounding box, in pixels.
pub(crate) const LONGEST: i32 = TILE;

/// The columns and rows of the pixels in two rows of a block, or of the blocks in two rows of a
/// tile.
const ACROSS: [i32; 16] = [0, 1, 2, 3, 4, 5, 6, 7, 0, 1, 2, 3, 4, 5, 6, 7];
const DOWN: [i32; 16] = [0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1];

/// The pairs of rows in a block.
const PAIRS: i32 = BLOCK / 2;

/// A triangle relative to a tile.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Medium<S: Simd> {
    /// The edge functions at the first pixel of the tile, minus their smallest covered values.
    edges: [i32; 3],
    /// The smallest covered values of the second and third edge function, needed for depth.
    least: [i32; 2],
    /// The steps of the edge functions for one subpixel to the right and one down.
    right: [i32; 3],
    down: [i32; 3],
    /// The offsets of the edge functions within two rows of a block.
    gains: [i32x16<S>; 3],
    depth: f64,
    to_second: f64,
    to_third: f64,
    low: f32,
    /// The largest depth of the corners.
    pub(crate) high: f32,
    number: u32,
}

/// The edge functions of a triangle at the pixels of a block.
#[derive(Debug)]
struct EdgeRows {
    whole: [[i32; BLOCK_PIXELS]; 3],
    /// The second and third of them.
    in_f64: [[f64; BLOCK_PIXELS]; 2],
}

impl Default for EdgeRows {
    fn default() -> Self {
        Self { whole: [[0; BLOCK_PIXELS]; 3], in_f64: [[0.0; BLOCK_PIXELS]; 2] }
    }
}

impl<S: Simd> Medium<S> {
    /// Sets up a triangle for the tile with this first pixel. `None` if it has no area. Its
    /// bounding box must reach into the tile.
    #[inline(always)]
    pub(crate) fn new(simd: S, large: &LargeTriangle, [left, top]: [i32; 2]) -> Option<Self> {
        // Relative to the centre of the first pixel: e(0, 0) is then the constant term.
        let half = SUBPIXELS / 2;
        let (cx, cy) = (left * SUBPIXELS + half, top * SUBPIXELS + half);
        let [p, q, r] = each(large.corners, |corner| {
            let at = corner.at();
            [at.x - cx, at.y - cy]
        });
        let area = (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
        if area == 0 {
            return None;
        }
        // Reversed edges make edge functions positive inside for the other winding.
        let lines = if area > 0 { [[q, r], [r, p], [p, q]] } else { [[r, q], [p, r], [q, p]] };
        let right = each(lines, |[p, q]| p[1] - q[1]);
        let down = each(lines, |[p, q]| q[0] - p[0]);
        let at = |i: usize| -(right[i] * lines[i][0][0] + down[i] * lines[i][0][1]);
        // The top-left rule, as in `coverage`.
        let least = |i: usize| i32::from(right[i] < 0 || (right[i] == 0 && down[i] <= 0));
        let (across, below) = (i32x16::from_slice(simd, &ACROSS), i32x16::from_slice(simd, &DOWN));
        let [by_x, by_y] = [each(right, |by| by * SUBPIXELS), each(down, |by| by * SUBPIXELS)];
        let [a, b, c] = each(large.corners, |corner| corner.depth);
        let per_area = 1.0 / f64::from(area.abs());
        Some(Self {
            // With the bias included, a centre is covered if no value is negative.
            edges: [at(0) - least(0), at(1) - least(1), at(2) - least(2)],
            least: [least(1), least(2)],
            right,
            down,
            gains: [
                across * by_x[0] + below * by_y[0],
                across * by_x[1] + below * by_y[1],
                across * by_x[2] + below * by_y[2],
            ],
            depth: f64::from(a),
            to_second: (f64::from(b) - f64::from(a)) * per_area,
            to_third: (f64::from(c) - f64::from(a)) * per_area,
            low: a.min(b).min(c),
            high: a.max(b).max(c),
            number: large.number,
        })
    }

    /// Returns the change of an edge function for an offset in subpixels.
    #[inline(always)]
    fn gain(&self, i: usize, [x, y]: [i32; 2]) -> i32 {
        self.right[i] * x + self.down[i] * y
    }

    /// Returns the smallest and largest change of an edge function between two offsets.
    #[inline(always)]
    fn gains_between(&self, i: usize, [from, to]: [[i32; 2]; 2]) -> [i32; 2] {
        let (right, down) = (self.right[i], self.down[i]);
        let ([a, b], [c, d]) = ([right * from[0], right * to[0]], [down * from[1], down * to[1]]);
        [a.min(b) + c.min(d), a.max(b) + c.max(d)]
    }

    /// Finds the blocks of the tile that the triangle touches in any of the `N` samples of their
    /// pixels, restricted to blocks that `area` reaches into. `area` must not be empty; it is in
    /// pixels relative to the tile's first.
    #[inline(always)]
    pub(crate) fn blocks<const N: usize>(
        &self,
        simd: S,
        area: PixelBox,
        sample_positions: &SamplePositions,
    ) -> Touched {
        let side = BLOCK * SUBPIXELS;
        let (first, last) = (area.left / BLOCK, (area.right - 1) / BLOCK);
        // The columns of the area, for both rows of blocks that one register holds.
        let columns = 0x0101 * ((0xff_u64 << first) & (0xff >> (7 - last)));
        let (across, below) = (i32x16::from_slice(simd, &ACROSS), i32x16::from_slice(simd, &DOWN));
        let mut gains = [i32x16::splat(simd, 0); 3];
        let (mut most, mut least) = ([0; 3], [0; 3]);
        // Bounds of the change of each edge function within a block, over all samples.
        for i in 0..3 {
            if N > 1 {
                [least[i], most[i]] = self.gains_between(i, sample_positions.reach::<N>());
            }
            let (x, y) = (7 * SUBPIXELS * self.right[i], 7 * SUBPIXELS * self.down[i]);
            most[i] += x.max(0) + y.max(0);
            least[i] += x.min(0) + y.min(0);
            gains[i] = across * (side * self.right[i]) + below * (side * self.down[i]);
        }
        let mut touched = Touched::default();
        let (first, last) = (area.top / BLOCK, (area.bottom - 1) / BLOCK);
        for row in (first..=last).step_by(2) {
            let at = |i: usize| gains[i] + (self.edges[i] + row * side * self.down[i]);
            let [a, b, c] = [at(0), at(1), at(2)];
            // Only the sign bits matter: an edge function is negative outside.
            let some = (a + most[0]) | (b + most[1]) | (c + most[2]);
            let whole = (a + least[0]) | (b + least[1]) | (c + least[2]);
            let rows = if row == last { 0xff } else { 0xffff };
            let some = some.simd_ge(0).to_bitmask() & columns & rows;
            let whole = whole.simd_ge(0).to_bitmask() & some;
            touched.some |= some << (8 * row);
            touched.whole |= whole << (8 * row);
        }
        touched
    }

    /// Draws the triangle into the rows of a block that `area` reaches into. `area` is in pixels
    /// relative to the tile's first.
    #[inline(always)]
    pub(crate) fn draw(
        &self,
        format: Format,
        simd: S,
        block: usize,
        area: PixelBox,
        visibility: &mut [u64; BLOCK_PIXELS],
    ) {
        let block = i32::try_from(block % BLOCK_PIXELS).unwrap_or(0);
        let (column, row) = (block % BLOCK * BLOCK, block / BLOCK * BLOCK);
        let place = [column * SUBPIXELS, row * SUBPIXELS];
        let gain = [self.gain(0, place), self.gain(1, place), self.gain(2, place)];
        let (pairs, _) = visibility.as_chunks_mut::<16>();
        // Rows above and below the area are skipped, which matters for small triangles.
        let first = (area.top - row).max(0) / 2;
        let end = ((area.bottom - row + 1) / 2).min(PAIRS);
        let above = 2 * first * SUBPIXELS;
        let at = |i: usize| self.gains[i] + (self.edges[i] + gain[i] + above * self.down[i]);
        let two_down = |i: usize| 2 * SUBPIXELS * self.down[i];
        let [mut a, mut b, mut c] = [at(0), at(1), at(2)];
        for pair in first..end {
            let covered = (a | b | c).simd_ge(0);
            if covered.any_true() {
                let (second, third) = (b + self.least[0], c + self.least[1]);
                let depth = self.depths(in_f64(second), in_f64(third));
                let entries = &mut pairs[pair as usize % 4];
                put_rows(format, simd, covered, depth, self.number, entries);
            }
            (a, b, c) = (a + two_down(0), b + two_down(1), c + two_down(2));
        }
    }

    /// Finds the pixels of a block, given by its first column and row, that `area` reaches into and
    /// that the triangle may cover in any of several samples. Returns them as bits, and sets the
    /// edge functions of their rows.
    #[inline(always)]
    fn pixels(
        &self,
        [column, row]: [i32; 2],
        area: PixelBox,
        positions: &SamplePositions,
        rows: &mut EdgeRows,
    ) -> u64 {
        // A pixel counts if each edge function is not negative where it is largest.
        let most = |i: usize| self.gains_between(i, positions.reach::<MANY>())[1];
        let most = [most(0), most(1), most(2)];
        let mut some = 0;
        for pair in (area.top - row).max(0) / 2..((area.bottom - row + 1) / 2).min(PAIRS) {
            let place = [column * SUBPIXELS, (row + 2 * pair) * SUBPIXELS];
            let at = |i: usize| self.gains[i] + (self.edges[i] + self.gain(i, place));
            let [a, b, c] = [at(0), at(1), at(2)];
            let signs = (a + most[0]) | (b + most[1]) | (c + most[2]);
            some |= signs.simd_ge(0).to_bitmask() << (16 * pair);
            let to = 16 * pair as usize % BLOCK_PIXELS;
            for (row, values) in rows.whole.iter_mut().zip([a, b, c]) {
                values.store_slice(&mut row[to..to + 16]);
            }
            for (row, values) in rows.in_f64.iter_mut().zip([b, c]) {
                let [upper, lower] = in_f64(values);
                upper.store_slice(&mut row[to..to + 8]);
                lower.store_slice(&mut row[to + 8..to + 16]);
            }
        }
        let (first, end) = ((area.left - column).max(0), (area.right - column).min(BLOCK));
        let columns = (0xff << first) & (0xff >> (BLOCK - end));
        some & (0x0101_0101_0101_0101 * columns)
    }

    /// Draws the triangle into the pixels of a block that `area` reaches into, with several samples
    /// per pixel. `area` is in pixels relative to the tile's first.
    #[inline(always)]
    pub(crate) fn draw_samples(
        &self,
        format: Format,
        simd: S,
        block: usize,
        area: PixelBox,
        (positions, entries): (&SamplePositions, &mut [u64]),
    ) {
        let block = i32::try_from(block % BLOCK_PIXELS).unwrap_or(0);
        let corner = [block % BLOCK * BLOCK, block / BLOCK * BLOCK];
        let mut rows = EdgeRows::default();
        let mut some = self.pixels(corner, area, positions, &mut rows);
        // Lanes are now sixteen entries: the samples of neighbouring pixels of a row.
        let across = positions.pixels_across();
        if across > 1 {
            let pairs = some | some >> 1;
            some = (pairs | pairs >> 2) & 0x1111_1111_1111_1111;
        }
        let [x, y] = positions.of_entries(simd);
        let gain = |i: usize| x * self.right[i] + y * self.down[i];
        let gains = [gain(0), gain(1), gain(2)];
        // Depth needs the second and third edge function in f64, which adds integers exactly.
        let seconds = in_f64(gains[1] + self.least[0]);
        let thirds = in_f64(gains[2] + self.least[1]);
        let entries = entries.as_chunks_mut().0;
        for pixel in Bits(some) {
            let pixel = pixel % BLOCK_PIXELS;
            let at = |i: usize| gains[i] + rows.whole[i][pixel];
            let covered = (at(0) | at(1) | at(2)).simd_ge(0);
            let [second, third] = [rows.in_f64[0][pixel], rows.in_f64[1][pixel]];
            let depth = self.depths(
                [seconds[0] + second, seconds[1] + second],
                [thirds[0] + third, thirds[1] + third],
            );
            let entries = &mut entries[pixel / across as usize];
            put_rows(format, simd, covered, depth, self.number, entries);
        }
    }

    /// Computes the depths of two rows of a block from their edge functions.
    #[inline(always)]
    fn depths(&self, second: [f64x8<S>; 2], third: [f64x8<S>; 2]) -> f32x16<S> {
        let simd = second[0].simd;
        let upper = self.depth_at(second[0], third[0]);
        let depth = upper.narrow(self.depth_at(second[1], third[1]));
        // Rounding must not move a depth beyond the depths of the corners.
        let (low, high) = (f32x16::splat(simd, self.low), f32x16::splat(simd, self.high));
        Real::min(Real::max(depth, low), high)
    }

    /// Computes the depths of a row, before clamping to the corners' depths.
    #[inline(always)]
    fn depth_at(&self, second: f64x8<S>, third: f64x8<S>) -> f64x8<S> {
        second * self.to_second + self.depth + third * self.to_third
    }
}

//! Rasterises a triangle in one tile by f32 edge functions of unsnapped corners.
//!
//! A centre on an edge is covered by both sides. A centre near an edge may be covered by both sides
//! or by neither because of rounding: that is the error of such edge functions. Blocks are
//! classified as touched or fully covered only if rounding cannot change the result at any of their
//! pixels.

use fearless_simd::{Select as _, Simd, SimdBase as _, SimdMask as _, f32x16, mask32x16};

use super::alpha_test::BlockHoles;
use super::depth_format::Format;
use super::large::Touched;
use super::visibility_buffer::{in_front, put_rows};
use crate::screen::coverage::{PixelBox, SUBPIXELS};
use crate::screen::sample_positions::SamplePositions;
use crate::screen::tiles::{BLOCK, BLOCK_PIXELS};

/// The error of an edge function relative to the sum of the magnitudes of its terms: more than
/// three roundings of products and sums.
const ERROR: f32 = 1.0 / 2_097_152.0;

/// The columns and rows of the pixels in two rows of a block, or of the blocks in two rows of a
/// tile.
pub(super) const ACROSS: [f32; 16] =
    [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];
const DOWN: [f32; 16] =
    [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0];

/// A triangle, relative to the first pixel of the picture.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FloatTriangle {
    /// The coefficients a, b and c of e = a x + b y + c, 0 or positive inside.
    lines: [[f32; 3]; 3],
    area: f32,
    depth: f32,
    second: f32,
    third: f32,
    low: f32,
    /// The largest depth of the corners.
    pub(crate) high: f32,
    /// The triangle's number in the frame.
    pub(crate) number: u32,
    /// The first pixel of the tile.
    first: [f32; 2],
}

impl FloatTriangle {
    /// Sets up a triangle with these corners in pixels and these depths, for the tile with this
    /// first pixel.
    #[expect(clippy::cast_precision_loss, reason = "columns and rows are small")]
    pub(crate) fn new(
        [p, q, r]: [[f32; 2]; 3],
        [a, b, c]: [f32; 3],
        number: u32,
        first: [i32; 2],
    ) -> Self {
        // The sign makes edge functions positive inside for either winding.
        let area = (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
        let sign = area.signum();
        let line = |p: [f32; 2], q: [f32; 2]| {
            [(p[1] - q[1]) * sign, (q[0] - p[0]) * sign, (p[0] * q[1] - p[1] * q[0]) * sign]
        };
        Self {
            lines: [line(q, r), line(r, p), line(p, q)],
            area: area.abs(),
            depth: a,
            second: b - a,
            third: c - a,
            low: a.min(b).min(c),
            high: a.max(b).max(c),
            number,
            // Edge functions are evaluated at centres.
            first: first.map(|i| i as f32 + 0.5),
        }
    }

    /// Finds the blocks of the tile that the triangle may touch in any of the `N` samples of their
    /// pixels, restricted to blocks that `area` reaches into. `area` must not be empty; it is in
    /// pixels relative to the tile's first.
    #[inline(always)]
    pub(crate) fn blocks<S: Simd, const N: usize>(
        &self,
        simd: S,
        area: PixelBox,
        sample_positions: &SamplePositions,
    ) -> Touched {
        let [from, to] = sample_positions.reach::<N>();
        let reach = [in_pixels(from), in_pixels(to)];
        let (across, below) = (f32x16::from_slice(simd, &ACROSS), f32x16::from_slice(simd, &DOWN));
        let (first, last) = (area.left / BLOCK, (area.right - 1) / BLOCK);
        // The columns of the area, for both rows of blocks that one register holds.
        let columns = 0x0101 * ((0xff_u64 << first) & (0xff >> (7 - last)));
        let mut touched = Touched::default();
        let (first, last) = (area.top / BLOCK, (area.bottom - 1) / BLOCK);
        for row in (first..=last).step_by(2) {
            let x = across * 8.0 + self.first[0];
            let y = below * 8.0 + (self.first[1] + (BLOCK * row) as f32);
            let mut some = mask32x16::from_bitmask(simd, u64::MAX);
            let mut whole = some;
            for [a, b, c] in self.lines {
                let error = self.error([a, b, c]);
                // The block's corner with the largest, or smallest, value of this edge function.
                let end = |step: f32, axis: usize, most: bool| match (step > 0.0) == most {
                    true => 7.0 + reach[1][axis],
                    false => reach[0][axis],
                };
                let value = x * a + y * b + c;
                let most = end(a, 0, true) * a + end(b, 1, true) * b + error;
                let least = end(a, 0, false) * a + end(b, 1, false) * b - error;
                some &= (value + most).simd_ge(0.0);
                whole &= (value + least).simd_ge(0.0);
            }
            // If one row of blocks is left, the second half of the register lies outside the area.
            let rows = if row == last { 0xff } else { 0xffff };
            let some = some.to_bitmask() & columns & rows;
            touched.some |= some << (8 * row);
            touched.whole |= (whole.to_bitmask() & some) << (8 * row);
        }
        touched
    }

    /// Returns the rounding error bound of an edge function in the tile.
    #[inline(always)]
    fn error(&self, [a, b, c]: [f32; 3]) -> f32 {
        // No sample of the tile is farther than 66 pixels from its first centre.
        let [x, y] = self.first;
        ((a * (x.abs() + 66.0)).abs() + (b * (y.abs() + 66.0)).abs() + c.abs()) * ERROR
    }

    /// Bounds the triangle's depth in the `N` samples of a block: smallest and largest.
    #[inline(always)]
    pub(crate) fn depths<const N: usize>(&self, block: usize) -> [f32; 2] {
        let at = |x: f32, y: f32| {
            let [x, y] = self.place(block, [x, y]);
            let [_, second, third] = self.lines;
            let edge = |[a, b, c]: [f32; 3]| (a * x + b * y + c) / self.area;
            self.depth + edge(second) * self.second + edge(third) * self.third
        };
        // From half a pixel before the first centre to half a pixel after the last.
        let (from, to) = if N == 1 { (0.0, 7.0) } else { (-0.5, 7.5) };
        let [a, b, c, d] = [at(from, from), at(from, to), at(to, from), at(to, to)];
        let [_, second, third] = self.lines;
        // The errors of both edge functions, as depth, and the roundings of the sum.
        let wrong = (self.error(second) * self.second.abs() + self.error(third) * self.third.abs())
            / self.area
            + 4.0 * f32::EPSILON;
        let low = a.min(b).min(c).min(d) - wrong;
        let high = a.max(b).max(c).max(d) + wrong;
        [low.max(self.low).min(self.high), high.min(self.high).max(self.low)]
    }

    /// Returns the position of a pixel's centre, by column and row in a block.
    #[inline(always)]
    fn place(&self, block: usize, [x, y]: [f32; 2]) -> [f32; 2] {
        let (column, row) = ((block % 8 * 8) as f32, (block / 8 % 8 * 8) as f32);
        [self.first[0] + column + x, self.first[1] + row + y]
    }

    /// Computes an edge function from its part along x.
    #[inline(always)]
    fn edge<S: Simd>(&self, i: usize, along: f32x16<S>, y: f32x16<S>) -> f32x16<S> {
        along + y * self.lines[i][1] + self.lines[i][2]
    }

    /// Draws the triangle into a block of the visibility buffer, for the sample with this offset.
    /// `whole` tells that it covers the block fully.
    #[inline(always)]
    pub(crate) fn draw<S: Simd>(
        &self,
        format: Format,
        simd: S,
        (block, shift): (usize, [i32; 2]),
        whole: bool,
        holes: Option<&BlockHoles<'_, '_, '_>>,
        visibility: &mut [u64; BLOCK_PIXELS],
    ) {
        let [left, top] = self.place(block, in_pixels(shift));
        let x = f32x16::from_slice(simd, &ACROSS) + left;
        let mut y = f32x16::from_slice(simd, &DOWN) + top;
        let [along, along_second, along_third] =
            [x * self.lines[0][0], x * self.lines[1][0], x * self.lines[2][0]];
        let (pairs, _) = visibility.as_chunks_mut::<16>();
        for (pair, visibility) in pairs.iter_mut().enumerate() {
            let (second, third) = (self.edge(1, along_second, y), self.edge(2, along_third, y));
            let mut covered = match whole {
                true => mask32x16::from_bitmask(simd, u64::MAX),
                false => {
                    self.edge(0, along, y).simd_ge(0.0) & second.simd_ge(0.0) & third.simd_ge(0.0)
                }
            };
            y += 2.0;
            if !covered.any_true() {
                continue;
            }
            let depth =
                second / self.area * self.second + self.depth + third / self.area * self.third;
            // Rounding must not move a depth beyond the depths of the corners.
            let (low, high) = (f32x16::splat(simd, self.low), f32x16::splat(simd, self.high));
            let depth = depth.simd_gt(low).select(depth, low);
            let depth: f32x16<S> = depth.simd_lt(high).select(depth, high);
            // The alpha test only runs for pixels that pass the depth test.
            if let Some(holes) = holes {
                let front = in_front(format, simd, covered, depth, self.number, visibility);
                if front == 0 {
                    continue;
                }
                covered = mask32x16::from_bitmask(simd, holes.opaque_pixels(pair, front));
            }
            put_rows(format, simd, covered, depth, self.number, visibility);
        }
    }
}

/// Converts an offset to pixels.
#[inline(always)]
#[expect(clippy::cast_precision_loss, reason = "below 256")]
pub(crate) fn in_pixels([x, y]: [i32; 2]) -> [f32; 2] {
    [x as f32 / SUBPIXELS as f32, y as f32 / SUBPIXELS as f32]
}

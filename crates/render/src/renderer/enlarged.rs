//! Enlarges a picture that was drawn at half resolution, with bilinear interpolation.
//!
//! A pixel of the finished picture lies a quarter of a drawn pixel from the nearest centre on each
//! axis, so the weights are 3/4 and 1/4, and the mean of four pixels is exact in integers. Beyond
//! the border, the last pixel is repeated.

use fearless_simd::Level;
use rayon::prelude::*;

use crate::simd::dispatch;
use marraztu_core::base::image::{Picture, Size};

/// Enlarges `drawn` to `size`, which is twice its size or one less on an axis.
pub(super) fn enlarge(level: Level, drawn: &Picture, size: Size, into: &mut Picture) {
    into.resize(size);
    let Size { width, height } = drawn.size();
    let row = |y: usize| &drawn.pixels()[y * width..][..width];
    let rows = into.pixels_mut().par_chunks_mut(size.width).enumerate();
    rows.for_each_init(
        || Means::new(width),
        |means, (y, out)| {
            let nearest = y / 2;
            // The upper one of a pair of rows lies between its drawn row and the drawn row above.
            let is_upper = y.is_multiple_of(2);
            let other = if is_upper { nearest.saturating_sub(1) } else { nearest + 1 };
            let (nearest, other) = (row(nearest), row(other.min(height - 1)));
            // Rows of one colour, as of the background, are their own means.
            if nearest[1..] == nearest[..width - 1] && nearest == other {
                return out.fill(nearest[0]);
            }
            dispatch!(level, _ => means.enlarge_row(nearest, other, out));
        },
    );
}

/// The intermediate numbers of a row. Each loop over them reads and writes neighbours in order, so
/// that the compiler uses SIMD instructions.
struct Means {
    /// The sums of two drawn rows by channel, with a pixel repeated before and after them.
    sums: Vec<u16>,
    /// The left and the right one of the two pixels over each drawn pixel.
    pairs: [Vec<[u8; 4]>; 2],
}

impl Means {
    fn new(width: usize) -> Self {
        let pairs = [vec![[0; 4]; width], vec![[0; 4]; width]];
        Self { sums: vec![0; 4 * (width + 2)], pairs }
    }

    /// Computes a row between its nearest drawn row and another.
    #[inline(always)]
    fn enlarge_row(&mut self, nearest: &[[u8; 4]], other: &[[u8; 4]], out: &mut [[u8; 4]]) {
        let Self { sums, pairs: [left, right] } = self;
        let count = 4 * nearest.len();
        // Vertical weights first, as 3 and 1: a sum is at most 1020.
        let rows = nearest.as_flattened().iter().zip(other.as_flattened());
        for (sum, (a, b)) in sums[4..].iter_mut().zip(rows) {
            *sum = 3 * u16::from(*a) + u16::from(*b);
        }
        // The border pixels are repeated, so every sum has two neighbours.
        sums.copy_within(4..8, 0);
        sums.copy_within(count..count + 4, count + 4);
        let (before, near, after) = (&sums[..count], &sums[4..][..count], &sums[8..][..count]);
        let means = left.as_flattened_mut().iter_mut().zip(right.as_flattened_mut());
        for ((means, near), (before, after)) in means.zip(near).zip(before.iter().zip(after)) {
            // Horizontal weights, 3 and 1 again: sixteenths in all, and 8 rounds to the nearest.
            let near = 3 * near + 8;
            *means.0 = ((near + before) >> 4).to_le_bytes()[0];
            *means.1 = ((near + after) >> 4).to_le_bytes()[0];
        }
        // Left and right means were stored apart for SIMD; here they alternate.
        let mut pairs = out.chunks_exact_mut(2);
        for (pair, (left, right)) in (&mut pairs).zip(left.iter().zip(&*right)) {
            pair.copy_from_slice(&[*left, *right]);
        }
        // With an odd width, the last pixel has no partner.
        if let ([pixel], Some(left)) = (pairs.into_remainder(), left.last()) {
            *pixel = *left;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each pixel by the definition: weights 9, 3, 3 and 1 sixteenths, rounded to nearest.
    #[test]
    fn an_enlarged_pixel_is_the_weighted_mean_of_the_four_around_it() {
        for [width, height] in [[1, 1], [2, 1], [3, 2], [5, 7], [8, 3]] {
            let pixel = |i: usize| [i * 37 % 256, i * 91 % 256, i * 13 % 256, 255];
            let pixels = (0..width * height).map(|i| pixel(i).map(|x| x.to_le_bytes()[0]));
            let mut pixels: Vec<[u8; 4]> = pixels.collect();
            // The last rows have one colour.
            let plain = pixels.len() / width / 2 * width;
            let first = pixels[0];
            let from = pixels.len() - plain;
            pixels[from..].fill(first);
            let drawn = Picture::from_pixels(Size::new(width, height), pixels).unwrap();
            for size in [
                Size::new(2 * width, 2 * height),
                Size::new(2 * width - 1, 2 * height),
                Size::new(2 * width, 2 * height - 1),
            ] {
                let mut picture = Picture::default();
                enlarge(Level::new(), &drawn, size, &mut picture);
                for (y, x) in (0..size.height).flat_map(|y| (0..size.width).map(move |x| (y, x))) {
                    let near = |at: usize, most: usize| {
                        let other =
                            if at.is_multiple_of(2) { (at / 2).max(1) - 1 } else { at / 2 + 1 };
                        [(at / 2, 3), (other.min(most - 1), 1)]
                    };
                    let mut sums = [8; 4];
                    for (row, down) in near(y, height) {
                        for (column, right) in near(x, width) {
                            let from = drawn.pixel(column, row);
                            for (sum, byte) in sums.iter_mut().zip(from) {
                                *sum += down * right * u32::from(byte);
                            }
                        }
                    }
                    let want = sums.map(|sum: u32| (sum / 16).to_le_bytes()[0]);
                    assert_eq!(picture.pixel(x, y), want, "{x}, {y} of {size:?}");
                }
            }
        }
    }
}

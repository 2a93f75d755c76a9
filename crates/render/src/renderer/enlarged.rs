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
        || Rows::new(width),
        |rows, (y, out)| {
            let nearest = y / 2;
            let is_upper = y.is_multiple_of(2);
            let other = if is_upper { nearest.saturating_sub(1) } else { nearest + 1 };
            let other = other.min(height - 1);
            dispatch!(level, _ => rows.enlarge(row(nearest), row(other), out));
        },
    );
}

/// Rows of bytes that the compiler computes in lanes, one after the other.
struct Rows {
    /// Three times the nearest row and the other, with the first and the last pixel repeated.
    sums: Vec<u16>,
    /// The left half of each drawn pixel, and the right half.
    left: Vec<u8>,
    right: Vec<u8>,
}

impl Rows {
    fn new(width: usize) -> Self {
        let bytes = 4 * width;
        Self { sums: vec![0; bytes + 8], left: vec![0; bytes], right: vec![0; bytes] }
    }

    /// Computes a row between its nearest drawn row and another.
    #[inline(always)]
    fn enlarge(&mut self, nearest: &[[u8; 4]], other: &[[u8; 4]], out: &mut [[u8; 4]]) {
        let Self { sums, left, right } = self;
        let (nearest, other) = (nearest.as_flattened(), other.as_flattened());
        for ((sum, near), far) in sums[4..].iter_mut().zip(nearest).zip(other) {
            *sum = 3 * u16::from(*near) + u16::from(*far);
        }
        let bytes = nearest.len();
        sums.copy_within(4..8, 0);
        sums.copy_within(bytes..bytes + 4, bytes + 4);
        let mean = |near: u16, far: u16| ((3 * near + far + 8) >> 4).to_le_bytes()[0];
        for ((left, near), before) in left.iter_mut().zip(&sums[4..]).zip(&sums[..]) {
            *left = mean(*near, *before);
        }
        for ((right, near), after) in right.iter_mut().zip(&sums[4..]).zip(&sums[8..]) {
            *right = mean(*near, *after);
        }
        let (left, right) = (left.as_chunks::<4>().0, right.as_chunks::<4>().0);
        let (pairs, rest) = out.as_chunks_mut::<2>();
        for ((pair, left), right) in pairs.iter_mut().zip(left).zip(right) {
            *pair = [*left, *right];
        }
        // With an odd width, the last pixel has no partner.
        if let ([pixel], Some(left)) = (rest, left.last()) {
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
            let drawn = Picture::from_pixels(Size::new(width, height), pixels.collect()).unwrap();
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

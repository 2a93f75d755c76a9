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
        || vec![[0; 4]; width],
        |sums, (y, out)| {
            let nearest = y / 2;
            let is_upper = y.is_multiple_of(2);
            let other = if is_upper { nearest.saturating_sub(1) } else { nearest + 1 };
            let other = other.min(height - 1);
            dispatch!(level, _ => enlarge_row(row(nearest), row(other), sums, out));
        },
    );
}

/// Computes a row between its nearest drawn row and another.
#[inline(always)]
fn enlarge_row(nearest: &[[u8; 4]], other: &[[u8; 4]], sums: &mut [[u16; 4]], out: &mut [[u8; 4]]) {
    for ((sum, a), b) in sums.iter_mut().zip(nearest).zip(other) {
        *sum = [0, 1, 2, 3].map(|i| 3 * u16::from(a[i]) + u16::from(b[i]));
    }
    let mean = |near: [u16; 4], far: [u16; 4]| {
        [0, 1, 2, 3].map(|i| ((3 * near[i] + far[i] + 8) >> 4).to_le_bytes()[0])
    };
    let last = sums.len() - 1;
    let (mut before, mut pairs) = (sums[0], out.chunks_exact_mut(2));
    for ((pair, sum), i) in (&mut pairs).zip(sums.iter()).zip(0..) {
        let after = sums[last.min(i + 1)];
        pair.copy_from_slice(&[mean(*sum, before), mean(*sum, after)]);
        before = *sum;
    }
    // With an odd width, the last pixel has no partner.
    if let [pixel] = pairs.into_remainder() {
        *pixel = mean(sums[last], sums[last.saturating_sub(1)]);
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

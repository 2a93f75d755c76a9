//! Refines a picture to more samples per pixel while the user does nothing.
//!
//! The settings of the scene do not change: only the window shows more samples than they specify. A
//! refined picture has the same bytes that `render --samples` writes. The ancestors' fill
//! algorithms are not refined, since they had one sample per pixel.

use super::reduction::Shrink;
use super::snapshot::Snapshot;
use marraztu_core::accuracy::Samples;
use marraztu_core::base::image::Picture;

/// Returns the next number of samples per pixel, if the picture is refined to `refined`.
pub(crate) fn next_samples(wanted: &Snapshot, refined: Option<Samples>) -> Option<Samples> {
    let most = wanted.options.refined?.count();
    let now = refined.unwrap_or(wanted.shot.settings.samples).count();
    Samples::ALL.into_iter().find(|next| next.count() > now && next.count() <= most)
}

/// Computes the root mean square difference, in steps of a byte, between a picture and a smaller
/// one with each pixel enlarged to a square.
#[expect(clippy::cast_precision_loss, reason = "pictures have fewer than 2^53 bytes")]
pub(crate) fn difference(whole: &Picture, small: &Picture, shrink: Shrink) -> f64 {
    let by = shrink.factor();
    let width = whole.size().width.max(1);
    let mut sum: u64 = 0;
    for (y, row) in whole.pixels().chunks(width).enumerate() {
        let start = y / by * small.size().width;
        let below = &small.pixels()[start..start + small.size().width];
        for (pixels, other) in row.chunks(by).zip(below) {
            for [r, g, b, _] in pixels {
                let square = |a: u8, b: u8| u64::from(a.abs_diff(b)).pow(2);
                sum += square(*r, other[0]) + square(*g, other[1]) + square(*b, other[2]);
            }
        }
    }
    let count = 3 * whole.pixels().len().max(1);
    libm::sqrt(sum as f64 / count as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use marraztu_core::base::image::Size;

    #[test]
    fn the_difference_of_a_small_picture_is_that_of_its_squares() {
        let whole = Picture::filled(Size::new(5, 3), [10, 20, 30, 255]);
        let same = Picture::filled(Size::new(3, 2), [10, 20, 30, 255]);
        assert_eq!(difference(&whole, &same, Shrink::Half), 0.0);
        let mut other = same.clone();
        // The last square is clipped to one pixel, the one in the corner.
        other.pixels_mut()[5] = [10, 20, 75, 255];
        let expected = (45.0_f64 * 45.0 / 45.0).sqrt();
        assert!((difference(&whole, &other, Shrink::Half) - expected).abs() < 1e-12);
    }
}

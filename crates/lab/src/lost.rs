//! Finds surfaces that a picture lacks.
//!
//! A picture without the surfaces that take time is quick, so its time must not be compared with
//! times of whole pictures. Pixels are compared by blocks of 8 x 8: an edge that is a pixel off, or
//! a hole here and there, loses nothing. An object is lost in a block if the picture shows it in
//! less than a quarter of the pixels that the reference does. A pixel that shows another object as
//! near is not lost: coarse depths mix up surfaces, but draw all of them. Nor is an object lost
//! that is as large as in the reference, but elsewhere: coarse positions move it.

use std::collections::BTreeMap;

/// What a pixel shows: the number of an object, 0 for the background, and the depth: 1 at the near
/// plane, 0 at the far plane.
pub type PixelSurface = (u32, f32);

/// The side of a block in pixels.
const SIDE: usize = 8;

/// Objects in fewer pixels of a block are ignored: sampling decides whether they are seen.
const LEAST: u32 = 8;

/// An object with this part of its pixels in the picture is not lost.
const WHOLE: f64 = 0.95;

/// The largest relative and absolute differences of equal depths; depths in 16 bits have steps of
/// 1.5e-5.
const NEAR: [f32; 2] = [0.01, 3e-5];

/// Returns the surfaces at pixels that show these primitives, 0 for the background, as one object.
pub(crate) fn flat_surface(primitives: &[u32]) -> Vec<PixelSurface> {
    primitives.iter().map(|primitive| (u32::from(*primitive != 0), 0.5)).collect()
}

/// Returns the part of the reference's surfaces that the picture lacks, from 0 to 1. Pixels are in
/// rows of `width`.
pub(crate) fn lost(shown: &[PixelSurface], reference: &[PixelSurface], width: usize) -> f64 {
    let height = reference.len() / width.max(1);
    // For each object, its pixels in the reference, in the picture, and in blocks that lack it.
    let mut objects: BTreeMap<u32, [u64; 3]> = BTreeMap::new();
    for top in (0..height).step_by(SIDE) {
        for left in (0..width).step_by(SIDE) {
            let rows = (top..height.min(top + SIDE)).map(|y| y * width);
            let pixels = rows.flat_map(|row| row + left..row + width.min(left + SIDE));
            for (object, [expected, seen]) in counts(shown, reference, pixels) {
                let [all, drawn, lost] = objects.entry(object).or_default();
                *drawn += u64::from(seen);
                if expected >= LEAST {
                    *all += u64::from(expected);
                    *lost += if 4 * seen < expected { u64::from(expected) } else { 0 };
                }
            }
        }
    }
    let all: u64 = objects.values().map(|[all, ..]| all).sum();
    #[expect(clippy::cast_precision_loss, reason = "pictures have fewer than 2^52 pixels")]
    let is_whole = |[all, drawn, _]: &[u64; 3]| *drawn as f64 >= WHOLE * *all as f64;
    let lost: u64 = objects.values().filter(|of| !is_whole(of)).map(|[.., lost]| lost).sum();
    #[expect(clippy::cast_precision_loss, reason = "pictures have fewer than 2^52 pixels")]
    let part = if all == 0 { 0.0 } else { lost as f64 / all as f64 };
    part
}

/// Counts the pixels of each object in the reference, and the pixels in which the picture shows it
/// or another object as near.
fn counts(
    shown: &[PixelSurface],
    reference: &[PixelSurface],
    pixels: impl Iterator<Item = usize>,
) -> BTreeMap<u32, [u32; 2]> {
    let [relative, absolute] = NEAR;
    let mut counts: BTreeMap<u32, [u32; 2]> = BTreeMap::new();
    for at in pixels {
        let ((object, depth), (expected, near)) = (shown[at], reference[at]);
        counts.entry(expected).or_default()[0] += 1;
        counts.entry(object).or_default()[1] += 1;
        let is_as_near = depth >= near * (1.0 - relative) - absolute;
        if object != expected && object != 0 && is_as_near {
            counts.entry(expected).or_default()[1] += 1;
        }
    }
    counts.remove(&0);
    counts
}

#[cfg(test)]
mod tests {
    use super::*;

    const WIDTH: usize = 32;

    /// A picture of 32 x 16 pixels: a floor (1) in the lower half, a column (2) on it, and farther
    /// away whatever is behind.
    fn picture(behind: u32) -> Vec<PixelSurface> {
        let pixel = |i: usize| match (i % WIDTH, i / WIDTH) {
            (4..12, _) => (2, 0.2),
            (_, 8..) => (1, 0.1),
            _ => (behind, 0.01),
        };
        (0..16 * WIDTH).map(pixel).collect()
    }

    #[test]
    fn a_floor_that_vanishes_is_lost_whether_the_background_or_a_wall_is_behind_it() {
        // The floor is 24 columns of 8 rows; 320 or all 512 pixels show a surface.
        for (behind, part) in [(0, 192.0 / 320.0), (3, 192.0 / 512.0)] {
            let whole = picture(behind);
            let without = |of: &PixelSurface| if of.0 == 1 { (behind, 0.01) } else { *of };
            let shown: Vec<PixelSurface> = whole.iter().map(without).collect();
            assert_eq!(lost(&shown, &whole, WIDTH), part);
            assert_eq!(lost(&vec![(0, 0.0); whole.len()], &whole, WIDTH), 1.0);
        }
    }

    #[test]
    fn a_surface_behind_another_one_at_the_same_depth_is_not_lost() {
        let whole = picture(3);
        let swapped = |depth: f32| -> Vec<PixelSurface> {
            whole.iter().map(|of| if of.0 == 1 { (4, depth) } else { *of }).collect()
        };
        assert_eq!(lost(&swapped(0.0995), &whole, WIDTH), 0.0);
        assert!(lost(&swapped(0.09), &whole, WIDTH) > 0.3);
    }

    #[test]
    fn a_shift_by_a_pixel_and_holes_in_every_second_pixel_lose_nothing() {
        let whole = picture(3);
        let shifted: Vec<PixelSurface> =
            (0..whole.len()).map(|i| whole[i.saturating_sub(1)]).collect();
        let holes = |(i, of): (usize, &PixelSurface)| if i % 2 == 0 { *of } else { (0, 0.0) };
        let holes: Vec<PixelSurface> = whole.iter().enumerate().map(holes).collect();
        for shown in [&whole, &shifted, &holes] {
            assert_eq!(lost(shown, &whole, WIDTH), 0.0);
        }
    }

    #[test]
    fn a_surface_that_is_whole_but_elsewhere_is_not_lost() {
        let column = |from: usize| -> Vec<PixelSurface> {
            let inside = |i: usize| (from..from + 8).contains(&(i % WIDTH));
            (0..16 * WIDTH).map(|i| if inside(i) { (1, 0.1) } else { (0, 0.0) }).collect()
        };
        assert_eq!(lost(&column(16), &column(8), WIDTH), 0.0);
        // Half of it has left the picture.
        assert_eq!(lost(&column(28), &column(8), WIDTH), 1.0);
    }

    #[test]
    fn points_farther_apart_than_pixels_are_a_lost_surface() {
        let whole = picture(3);
        let few = |(i, of): (usize, &PixelSurface)| if i % 11 == 0 { *of } else { (0, 0.0) };
        let few: Vec<PixelSurface> = whole.iter().enumerate().map(few).collect();
        assert_eq!(lost(&few, &whole, WIDTH), 1.0);
    }

    #[test]
    fn a_picture_without_surfaces_lacks_none() {
        assert_eq!(lost(&[(0, 0.0); 64], &[(0, 0.0); 64], 8), 0.0);
        assert_eq!(lost(&[], &[], 0), 0.0);
    }
}

//! Finds surfaces that a picture lacks.
//!
//! A picture without the surfaces that take time is quick, so its time must not be compared with
//! times of whole pictures. Pixels are compared by blocks of 8 x 8: an edge that is a pixel off, or
//! a hole here and there, loses nothing. An object is lost in a block if the picture shows it in
//! less than a quarter of the pixels that the reference does.

use std::collections::BTreeMap;

/// The side of a block in pixels.
const SIDE: usize = 8;

/// Objects in fewer pixels of a block are ignored: sampling decides whether they are seen.
const LEAST: u32 = 8;

/// Returns the part of the reference's surfaces that the picture lacks, from 0 to 1. Both are given
/// by the object at each pixel, 0 for the background, in rows of `width` pixels.
pub(crate) fn lost(shown: &[u32], reference: &[u32], width: usize) -> f64 {
    let height = reference.len() / width.max(1);
    let (mut all, mut lost) = (0_u64, 0_u64);
    for top in (0..height).step_by(SIDE) {
        for left in (0..width).step_by(SIDE) {
            // The pixels of each object in the reference and in the picture.
            let mut counts: BTreeMap<u32, [u32; 2]> = BTreeMap::new();
            let rows = (top..height.min(top + SIDE)).map(|y| y * width);
            let pixels = rows.flat_map(|row| row + left..row + width.min(left + SIDE));
            for at in pixels {
                counts.entry(reference[at]).or_default()[0] += 1;
                counts.entry(shown[at]).or_default()[1] += 1;
            }
            for (_, [expected, seen]) in counts.range(1..).filter(|(_, of)| of[0] >= LEAST) {
                all += u64::from(*expected);
                lost += if 4 * seen < *expected { u64::from(*expected) } else { 0 };
            }
        }
    }
    #[expect(clippy::cast_precision_loss, reason = "pictures have fewer than 2^52 pixels")]
    let part = if all == 0 { 0.0 } else { lost as f64 / all as f64 };
    part
}

#[cfg(test)]
mod tests {
    use super::*;

    const WIDTH: usize = 32;

    /// A picture of 32 x 16 pixels: a floor (1) in the lower half, a column (2) on it, and whatever
    /// is behind.
    fn picture(behind: u32) -> Vec<u32> {
        let pixel = |i: usize| match (i % WIDTH, i / WIDTH) {
            (4..12, _) => 2,
            (_, 8..) => 1,
            _ => behind,
        };
        (0..16 * WIDTH).map(pixel).collect()
    }

    #[test]
    fn a_floor_that_vanishes_is_lost_whether_the_background_or_a_wall_is_behind_it() {
        // The floor is 24 columns of 8 rows; 320 or all 512 pixels show a surface.
        for (behind, part) in [(0, 192.0 / 320.0), (3, 192.0 / 512.0)] {
            let whole = picture(behind);
            let shown: Vec<u32> = whole.iter().map(|i| if *i == 1 { behind } else { *i }).collect();
            assert_eq!(lost(&shown, &whole, WIDTH), part);
            assert_eq!(lost(&vec![0; whole.len()], &whole, WIDTH), 1.0);
        }
    }

    #[test]
    fn a_shift_by_a_pixel_and_holes_in_every_second_pixel_lose_nothing() {
        let whole = picture(3);
        let shifted: Vec<u32> = (0..whole.len()).map(|i| whole[i.saturating_sub(1)]).collect();
        let holes = |(i, of): (usize, &u32)| if i % 2 == 0 { *of } else { 0 };
        let holes: Vec<u32> = whole.iter().enumerate().map(holes).collect();
        for shown in [&whole, &shifted, &holes] {
            assert_eq!(lost(shown, &whole, WIDTH), 0.0);
        }
    }

    #[test]
    fn points_farther_apart_than_pixels_are_a_lost_surface() {
        let whole = picture(3);
        let few = |(i, of): (usize, &u32)| if i % 11 == 0 { *of } else { 0 };
        let few: Vec<u32> = whole.iter().enumerate().map(few).collect();
        assert_eq!(lost(&few, &whole, WIDTH), 1.0);
    }

    #[test]
    fn a_picture_without_surfaces_lacks_none() {
        assert_eq!(lost(&[0; 64], &[0; 64], 8), 0.0);
        assert_eq!(lost(&[], &[], 0), 0.0);
    }
}

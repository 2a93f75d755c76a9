//! Measures the differences of two pictures.

use std::path::Path;

use marraztu_core::base::image::Picture;
use marraztu_io::{Numbers, PictureContent, short_number};
use marraztu_lab::flip;
use serde::Serialize;

/// The unit of the differences of two pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub(super) enum Unit {
    /// Steps of 8 bits.
    #[serde(rename = "1/255")]
    Byte,
    /// Steps of 16 bits.
    #[serde(rename = "1/65535")]
    Deep,
    /// The numbers of the file.
    #[serde(rename = "1")]
    Number,
}

/// The differences of two pictures of one size, at the pixels that count.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(super) struct Difference {
    pub(super) unit: Unit,
    /// The largest difference of a channel.
    pub(super) largest: f64,
    /// The number of pixels that count.
    pub(super) pixels: usize,
    /// The number of pixels that differ.
    pub(super) differing: usize,
    /// The number of pixels that differ by more than the limit.
    pub(super) beyond: usize,
    /// The root of the mean square error of the channels.
    pub(super) rmse: f64,
    /// The perceived difference, if the pictures have colours.
    pub(super) flip: Option<f64>,
}

/// The largest differences that count as the same.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(super) struct Limits {
    /// The difference of a channel.
    pub(super) max: f64,
    /// The share of pixels that differ by more.
    pub(super) pixels: Option<f64>,
    pub(super) rmse: Option<f64>,
    pub(super) flip: Option<f64>,
}

impl Limits {
    /// Returns the options whose limits are exceeded.
    pub(super) fn exceeded(&self, difference: &Difference) -> Vec<&'static str> {
        let is_above = |value: f64, limit: Option<f64>| limit.is_some_and(|limit| value > limit);
        let share = share(difference.beyond, difference.pixels);
        [
            ("max", self.pixels.is_none() && difference.beyond > 0),
            ("pixels", is_above(share, self.pixels)),
            ("rmse", is_above(difference.rmse, self.rmse)),
            ("flip", is_above(difference.flip.unwrap_or(0.0), self.flip)),
        ]
        .into_iter()
        .filter_map(|(name, is_exceeded)| is_exceeded.then_some(name))
        .collect()
    }
}

impl Difference {
    /// Returns the measures with their names.
    pub(super) fn rows(&self, limits: &Limits) -> Vec<[String; 2]> {
        let Self { largest, pixels, differing, beyond, rmse, flip, .. } = *self;
        let mut rows = vec![
            ("largest difference", short_number(largest)),
            ("differing pixels", format!("{differing} of {pixels}")),
        ];
        if limits.pixels.is_some() {
            let per_cent = 100.0 * share(beyond, pixels);
            rows.push(("beyond --max", format!("{beyond} ({per_cent:.4}%)")));
        }
        let rmse =
            if self.unit == Unit::Number { short_number(rmse) } else { format!("{rmse:.4}") };
        rows.push(("RMSE", rmse));
        rows.extend(flip.map(|flip| ("FLIP", format!("{flip:.4}"))));
        rows.into_iter().map(|(name, value)| [name.to_owned(), value]).collect()
    }
}

#[expect(clippy::cast_precision_loss, reason = "pictures have fewer than 2^52 pixels")]
fn share(pixels: usize, of: usize) -> f64 {
    pixels as f64 / of.max(1) as f64
}

/// The sums over the pixels that count.
struct Tally {
    /// The difference of a channel beyond which pixels are counted.
    max: f64,
    largest: f64,
    pixels: usize,
    differing: usize,
    beyond: usize,
    squares: f64,
}

impl Tally {
    const fn new(max: f64) -> Self {
        Self { max, largest: 0.0, pixels: 0, differing: 0, beyond: 0, squares: 0.0 }
    }

    /// Adds a pixel by the differences of its channels.
    fn add(&mut self, channels: impl Iterator<Item = f64>) {
        let mut largest: f64 = 0.0;
        for difference in channels {
            largest = largest.max(difference);
            self.squares += difference * difference;
        }
        self.largest = self.largest.max(largest);
        self.pixels += 1;
        self.differing += usize::from(largest > 0.0);
        self.beyond += usize::from(largest > self.max);
    }

    #[expect(clippy::cast_precision_loss, reason = "pictures have fewer than 2^52 numbers")]
    fn finish(self, unit: Unit, channels: usize, flip: Option<f64>) -> Difference {
        let Self { largest, pixels, differing, beyond, squares, .. } = self;
        let rmse = libm::sqrt(squares / (channels * pixels.max(1)) as f64);
        Difference { unit, largest, pixels, differing, beyond, rmse, flip }
    }
}

/// Measures the differences of two pictures at the pixels of a mask, with the limit of `--max`.
/// Fails if they have different sizes or channels; `names` are the files for this message.
pub(super) fn measure(
    names: [&Path; 2],
    [a, b]: [&PictureContent; 2],
    mask: Option<&[bool]>,
    max: f64,
) -> Result<Difference, String> {
    let [first, second] = names.map(|name| name.display().to_string());
    let sizes = [a, b].map(|content| content.size());
    if sizes[0] != sizes[1] {
        let [a, b] = sizes.map(|size| format!("{}x{}", size.width, size.height));
        return Err(format!("{first} has {a} pixels, but {second} has {b}"));
    }
    match (a, b) {
        (PictureContent::Numbers(a), PictureContent::Numbers(b)) => {
            let names = |numbers: &Numbers| {
                let names: Vec<&str> = numbers.channels.keys().map(String::as_str).collect();
                names.join(", ")
            };
            if names(a) != names(b) {
                let (a, b) = (names(a), names(b));
                return Err(format!("{first} has the channels {a}, but {second} has {b}"));
            }
            Ok(of_numbers(a, b, mask, max))
        }
        (PictureContent::Numbers(_), _) => {
            Err(format!("{first} has numbers, but {second} has colours"))
        }
        (_, PictureContent::Numbers(_)) => {
            Err(format!("{first} has colours, but {second} has numbers"))
        }
        (PictureContent::Colors(a), PictureContent::Colors(b)) => Ok(of_pictures(a, b, mask, max)),
        _ => {
            let [wide_a, wide_b] = [a, b].map(widened);
            let measured = of_pixels(&wide_a, &wide_b, (u16::MAX, Unit::Deep), mask, max);
            let flip = match (colors(a), colors(b)) {
                (Some(a), Some(b)) => Some(perceived(a, b, mask)),
                _ => None,
            };
            Ok(Difference { flip, ..measured })
        }
    }
}

/// Returns the colours of a picture in 8 bits, if it has colours.
pub(super) const fn colors(content: &PictureContent) -> Option<&Picture> {
    match content {
        PictureContent::Colors(picture) | PictureContent::DeepColors(picture, _) => Some(picture),
        PictureContent::Numbers(_) => None,
    }
}

/// Returns the pixels of a picture that a mask selects: those that are not black, transparent or 0.
pub(super) fn selected(mask: &PictureContent) -> Vec<bool> {
    let selects = |pixel: &[u8; 4]| pixel[..3] != [0; 3] && pixel[3] != 0;
    match mask {
        PictureContent::Colors(picture) => picture.pixels().iter().map(selects).collect(),
        PictureContent::DeepColors(_, pixels) => {
            pixels.iter().map(|pixel| pixel[..3] != [0; 3] && pixel[3] != 0).collect()
        }
        PictureContent::Numbers(numbers) => {
            let selects = |i: usize| numbers.channels.values().any(|values| values[i] != 0.0);
            (0..numbers.size.area()).map(selects).collect()
        }
    }
}

fn of_numbers(a: &Numbers, b: &Numbers, mask: Option<&[bool]>, max: f64) -> Difference {
    let mut tally = Tally::new(max);
    let channels: Vec<_> = a.channels.values().zip(b.channels.values()).collect();
    for i in (0..a.size.area()).filter(|i| mask.is_none_or(|mask| mask[*i])) {
        tally.add(channels.iter().map(|(a, b)| distance(a[i], b[i])));
    }
    tally.finish(Unit::Number, channels.len(), None)
}

/// Returns the difference of two numbers: infinite if only one of them is infinite or NaN.
fn distance(a: f64, b: f64) -> f64 {
    if a == b || (a.is_nan() && b.is_nan()) {
        return 0.0;
    }
    let distance = (a - b).abs();
    if distance.is_nan() { f64::INFINITY } else { distance }
}

fn of_pictures(a: &Picture, b: &Picture, mask: Option<&[bool]>, max: f64) -> Difference {
    let measured = of_pixels(a.pixels(), b.pixels(), (u8::MAX, Unit::Byte), mask, max);
    let flip = if measured.largest > 0.0 { perceived(a, b, mask) } else { 0.0 };
    Difference { flip: Some(flip), ..measured }
}

/// Measures everything but FLIP.
fn of_pixels<T: Copy + Ord + Into<u16>>(
    a: &[[T; 4]],
    b: &[[T; 4]],
    (opaque, unit): (T, Unit),
    mask: Option<&[bool]>,
    max: f64,
) -> Difference {
    let (mut tally, mut has_alpha) = (Tally::new(max), false);
    let pairs = a.iter().zip(b).enumerate();
    for (_, (a, b)) in pairs.filter(|(i, _)| mask.is_none_or(|mask| mask[*i])) {
        has_alpha |= a[3].min(b[3]) < opaque;
        let steps = a.iter().zip(b).map(|(a, b)| (*a).into().abs_diff((*b).into()));
        tally.add(steps.map(f64::from));
    }
    // Alpha counts only if a picture has it.
    tally.finish(unit, if has_alpha { 4 } else { 3 }, None)
}

/// Returns FLIP. Outside the mask, the second picture is replaced by the first one, since the
/// filters of the eye would spread its differences.
fn perceived(a: &Picture, b: &Picture, mask: Option<&[bool]>) -> f64 {
    let Some(mask) = mask else { return flip::difference(a, b) };
    let pixels = a.pixels().iter().zip(b.pixels()).zip(mask);
    let pixels = pixels.map(|((a, b), counts)| if *counts { *b } else { *a }).collect();
    let b = Picture::from_pixels(a.size(), pixels).expect("pictures of one size");
    flip::difference_within(a, &b, Some(mask))
}

/// Returns the pixels with 16 bits per channel.
fn widened(content: &PictureContent) -> Vec<[u16; 4]> {
    match content {
        PictureContent::DeepColors(_, pixels) => pixels.clone(),
        PictureContent::Colors(picture) => {
            picture.pixels().iter().map(|pixel| pixel.map(|byte| u16::from(byte) * 257)).collect()
        }
        PictureContent::Numbers(_) => unreachable!("numbers are measured as they are"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use marraztu_core::base::image::Size;

    const NAMES: [&str; 2] = ["a", "b"];

    fn measured(a: &PictureContent, b: &PictureContent, mask: Option<&[bool]>) -> Difference {
        measure(NAMES.map(Path::new), [a, b], mask, 0.0).unwrap()
    }

    fn picture(pixels: [[u8; 4]; 2]) -> PictureContent {
        let picture = Picture::from_pixels(Size::new(2, 1), pixels.to_vec());
        PictureContent::Colors(picture.unwrap())
    }

    fn numbers(channels: &[(&str, [f64; 2])]) -> PictureContent {
        let channel = |(name, values): &(&str, [f64; 2])| ((*name).to_owned(), values.to_vec());
        let channels = channels.iter().map(channel).collect();
        PictureContent::Numbers(Numbers { size: Size::new(2, 1), channels })
    }

    #[test]
    fn differences_are_counted_by_hand() {
        let a = picture([[10, 20, 30, 255], [0, 0, 0, 255]]);
        let same = measured(&a, &a, None);
        assert_eq!((same.largest, same.differing, same.pixels, same.rmse), (0.0, 0, 2, 0.0));
        assert_eq!(same.flip, Some(0.0));
        let opaque = measured(&a, &picture([[13, 20, 26, 255], [0, 0, 0, 255]]), None);
        assert_eq!((opaque.largest, opaque.differing), (4.0, 1));
        assert!((opaque.rmse - libm::sqrt(25.0 / 6.0)).abs() < 1e-12 && opaque.flip > Some(0.0));
        let clear = measured(&a, &picture([[10, 20, 30, 255], [0, 0, 0, 253]]), None);
        assert_eq!((clear.largest, clear.differing), (2.0, 1));
        assert!((clear.rmse - libm::sqrt(4.0 / 8.0)).abs() < 1e-12);
    }

    #[test]
    fn pixels_outside_the_mask_do_not_count_anywhere() {
        let (a, b) = ([[9, 9, 9, 255], [0, 0, 0, 255]], [[9, 9, 9, 255], [250, 0, 0, 9]]);
        let [a, b] = [a, b].map(picture);
        let first = measured(&a, &b, Some(&[true, false]));
        assert_eq!((first.largest, first.differing, first.pixels), (0.0, 0, 1));
        assert_eq!((first.rmse, first.flip), (0.0, Some(0.0)));
        let second = measured(&a, &b, Some(&[false, true]));
        assert_eq!((second.largest, second.differing, second.pixels), (250.0, 1, 1));
        assert!(second.flip > measured(&a, &b, None).flip);
        // A large difference outside does not spread into the mask.
        let [near, both] = [0, 250].map(|outside| picture([[12, 9, 9, 255], [outside, 0, 0, 255]]));
        let flip = |b| measured(&a, b, Some(&[true, false])).flip;
        assert!(flip(&near) > Some(0.0) && flip(&near) == flip(&both));
    }

    #[test]
    fn numbers_differ_in_their_unit_and_infinitely_if_one_is_not_finite() {
        const NAN: f64 = f64::NAN;
        const FAR: f64 = f64::INFINITY;
        let a = numbers(&[("Z", [1.5, FAR]), ("id", [3.0, NAN])]);
        assert_eq!(measured(&a, &a, None).largest, 0.0);
        let near = measured(&a, &numbers(&[("Z", [1.25, FAR]), ("id", [3.0, NAN])]), None);
        assert_eq!((near.largest, near.differing, near.flip), (0.25, 1, None));
        assert_eq!(near.rmse, libm::sqrt(0.0625 / 4.0));
        for (z, id) in [(7.0, NAN), (-FAR, NAN), (FAR, 0.0)] {
            let b = numbers(&[("Z", [1.5, z]), ("id", [3.0, id])]);
            assert_eq!(measured(&a, &b, None).largest, FAR, "{z} {id}");
        }
    }

    #[test]
    fn pictures_of_other_sizes_channels_or_kinds_cannot_be_compared() {
        let z = numbers(&[("Z", [0.0; 2])]);
        let tall = Picture::filled(Size::new(1, 2), [0; 4]);
        let color = picture([[0; 4]; 2]);
        for (a, b, reason) in [
            (&color, &PictureContent::Colors(tall), "a has 2x1 pixels, but b has 1x2"),
            (&z, &numbers(&[("id", [0.0; 2])]), "a has the channels Z, but b has id"),
            (&z, &color, "a has numbers, but b has colours"),
            (&color, &z, "a has colours, but b has numbers"),
        ] {
            assert_eq!(measure(NAMES.map(Path::new), [a, b], None, 0.0).unwrap_err(), reason);
        }
    }

    #[test]
    fn a_share_of_pixels_may_differ_by_more_than_the_maximum() {
        let difference = Difference {
            unit: Unit::Byte,
            largest: 9.0,
            pixels: 200,
            differing: 5,
            beyond: 1,
            rmse: 0.5,
            flip: Some(0.25),
        };
        let limits = Limits { max: 2.0, pixels: None, rmse: None, flip: None };
        assert_eq!(limits.exceeded(&difference), ["max"]);
        assert!(limits.exceeded(&Difference { beyond: 0, ..difference }).is_empty());
        let share = |pixels| Limits { pixels: Some(pixels), ..limits };
        assert!(share(0.005).exceeded(&difference).is_empty());
        assert_eq!(share(0.004).exceeded(&difference), ["pixels"]);
        let all = Limits { rmse: Some(0.4), flip: Some(0.2), ..share(0.0) };
        assert_eq!(all.exceeded(&difference), ["pixels", "rmse", "flip"]);
        let equal = Limits { rmse: Some(0.5), flip: Some(0.25), ..share(1.0) };
        assert!(equal.exceeded(&difference).is_empty());
    }

    #[test]
    fn a_mask_selects_all_but_black_transparent_and_zero() {
        let mask = picture([[0, 0, 1, 255], [255, 255, 255, 0]]);
        assert_eq!(selected(&mask), [true, false]);
        assert_eq!(selected(&numbers(&[("0", [0.0, -1.0])])), [false, true]);
    }
}

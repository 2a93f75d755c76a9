//! `marraztu compare`: compares two pictures.

use std::path::{Path, PathBuf};

use clap::Args;
use marraztu::plots::{self, PagePicture};
use marraztu_core::base::image::Picture;
use marraztu_io::{self as io, PICTURE_FORMATS, Sources};
use marraztu_lab::error::amplified;
use marraztu_lab::flip;

use super::failure::Failure;
use super::page::{check_page, write_page};
use super::say;
use super::talk::print;
use super::values::picture_file;

/// The exit status if the pictures cannot be compared.
const INCOMPARABLE: u8 = 2;

/// The factor of differences in the picture of differences.
const AMPLIFIED: u16 = 16;

/// The pictures to compare.
#[derive(Debug, Args)]
#[command(after_help = "\
Prints the largest difference of a channel in steps of 1/255 (with alpha), the number of pixels that
differ, the root of the mean square error in steps, and FLIP: the difference that a viewer sees when
flipping between the pictures, from 0 to 1 (Andersson and others, 2020). If a picture has 16 bits
per channel, as depths and ids have, steps are 1/65535. FLIP and the picture of differences are of
the colours in 8 bits, without alpha.

Examples:
  marraztu compare a.png b.png                  equal pixels
  marraztu compare a.png b.png --max 2          no channel differs by more than 2 steps
  marraztu compare a.png b.png --max 255 --flip 0.05
  marraztu compare a.png b.png --out diff.png   write the difference, times 16
  marraztu compare a.png b.png --html page.html

Exit status: 0 if the difference is within the limits, 1 if it is not, 2 if the pictures cannot be
compared.")]
pub(crate) struct Compare {
    /// The first picture
    a: PathBuf,
    /// The second picture
    b: PathBuf,
    /// The largest difference of a channel that counts as the same, in steps
    #[arg(long, value_name = "STEPS", default_value_t = 0)]
    max: u16,
    /// The largest FLIP that counts as the same, from 0 to 1
    #[arg(long, value_name = "LIMIT", value_parser = flip)]
    flip: Option<f64>,
    /// The picture of differences to write, amplified 16 times
    #[arg(short, long, value_name = "FILE", value_parser = picture_file())]
    out: Option<PathBuf>,
    /// A page to write, with the measures, a slider between the pictures, and their difference
    #[arg(long, value_name = "FILE")]
    html: Option<PathBuf>,
}

/// The differences of two pictures of one size.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Difference {
    largest: u16,
    pixels: usize,
    rmse: f64,
    flip: f64,
}

/// Compares two pictures.
pub(super) fn compare(arguments: &Compare) -> Result<(), Failure> {
    let Compare { a, b, max, flip, out, html } = arguments;
    let sources = Sources::default().with([a, b]);
    if let Some(out) = out {
        let checked = sources.spare(out).and_then(|()| io::check_picture_target(out));
        checked.map_err(|error| incomparable(&error.to_string()))?;
    }
    if let Some(html) = html {
        check_page(html, &sources).map_err(|failure| incomparable(&failure.to_string()))?;
    }
    let [first, second] = match [load(a), load(b)] {
        [Ok(first), Ok(second)] => [first, second],
        [Err(failure), _] | [_, Err(failure)] => return Err(incomparable(&failure)),
    };
    let sizes = [first.size(), second.size()];
    if sizes[0] != sizes[1] {
        let [a_size, b_size] = sizes.map(|size| format!("{}x{}", size.width, size.height));
        let (a, b) = (a.display(), b.display());
        return Err(incomparable(&format!("{a} has {a_size} pixels, but {b} has {b_size}")));
    }
    let deep = [a, b].map(|path| io::load_deep_pixels(path).ok().flatten());
    let difference = match deep {
        [None, None] => difference(&first, &second),
        [a, b] => {
            let [a, b] = [(a, &first), (b, &second)]
                .map(|(deep, picture)| deep.unwrap_or_else(|| widened(picture)));
            let perceived = difference(&first, &second);
            Difference { flip: perceived.flip, ..differences(&a, &b, u16::MAX) }
        }
    };
    let rows = difference.rows(sizes[0].area());
    let text: String = rows.iter().map(|[name, value]| format!("{name:<20}{value}\n")).collect();
    print(&text)?;
    let amplified =
        (out.is_some() || html.is_some()).then(|| amplified(&first, &second, AMPLIFIED));
    if let (Some(out), Some(amplified)) = (out, &amplified) {
        io::save_picture(out, amplified).map_err(|error| incomparable(&error.to_string()))?;
    }
    if let (Some(html), Some(amplified)) = (html, &amplified) {
        let part = |name: &str, picture: &Picture| -> Result<PagePicture, Failure> {
            let png = PICTURE_FORMATS[0].encode(picture).map_err(Failure::Absent)?;
            let size = format!("{} x {}", sizes[0].width, sizes[0].height);
            Ok(PagePicture { name: name.to_owned(), figures: size, png })
        };
        let names = [a, b].map(|path| path.display().to_string());
        let pictures = [part(&names[0], &first)?, part(&names[1], &second)?];
        let amplified = part(&format!("Difference, times {AMPLIFIED}"), amplified)?;
        let title = format!("{} and {}", names[0], names[1]);
        write_page(html, &plots::compare_page(&title, &rows, &pictures, &amplified))
            .map_err(|error| incomparable(&error.to_string()))?;
    }
    let is_same = difference.largest <= *max && flip.is_none_or(|flip| difference.flip <= flip);
    if is_same { Ok(()) } else { Err(Failure::Told) }
}

impl Difference {
    /// Returns the measures with their names. `all` is the number of pixels.
    fn rows(&self, all: usize) -> [[String; 2]; 4] {
        let Self { largest, pixels, rmse, flip } = self;
        [
            ("largest difference", largest.to_string()),
            ("differing pixels", format!("{pixels} of {all}")),
            ("RMSE", format!("{rmse:.4}")),
            ("FLIP", format!("{flip:.4}")),
        ]
        .map(|(name, value)| [name.to_owned(), value])
    }
}

fn load(path: &Path) -> Result<Picture, String> {
    io::load_picture(path).map_err(|error| error.to_string())
}

fn incomparable(reason: &str) -> Failure {
    say("error", &reason);
    Failure::Status(INCOMPARABLE)
}

/// Measures the differences of two pictures of one size.
fn difference(a: &Picture, b: &Picture) -> Difference {
    let measured = differences(a.pixels(), b.pixels(), 255);
    if measured.largest == 0 {
        return measured;
    }
    Difference { flip: flip::difference(a, b), ..measured }
}

/// Measures the differences of pixels, except for the perceived one. `opaque` is the largest alpha.
#[expect(clippy::cast_precision_loss, reason = "pictures have fewer than 2^52 bytes")]
fn differences<T: Copy + Into<u16>>(a: &[[T; 4]], b: &[[T; 4]], opaque: u16) -> Difference {
    let (mut largest, mut pixels, mut squares, mut has_alpha) = (0, 0, 0_u64, false);
    for (a, b) in a.iter().zip(b) {
        let [a, b] = [a, b].map(|pixel| pixel.map(Into::<u16>::into));
        let steps: [u16; 4] = std::array::from_fn(|i| a[i].abs_diff(b[i]));
        pixels += usize::from(steps != [0; 4]);
        has_alpha |= a[3].min(b[3]) < opaque;
        for step in steps {
            largest = largest.max(step);
            squares += u64::from(step) * u64::from(step);
        }
    }
    // Alpha counts only if a picture has it.
    let channels = if has_alpha { 4 } else { 3 } * a.len().max(1);
    let rmse = libm::sqrt(squares as f64 / channels as f64);
    Difference { largest, pixels, rmse, flip: 0.0 }
}

/// Returns the pixels with 16 bits per channel.
fn widened(picture: &Picture) -> Vec<[u16; 4]> {
    picture.pixels().iter().map(|pixel| pixel.map(|byte| u16::from(byte) * 257)).collect()
}

fn flip(text: &str) -> Result<f64, String> {
    let limit = text.parse().ok().filter(|limit| (0.0..=1.0).contains(limit));
    limit.ok_or_else(|| "write a number from 0 to 1".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use marraztu_core::base::image::Size;

    #[test]
    fn differences_are_counted_by_hand() {
        let picture =
            |pixels: [[u8; 4]; 2]| Picture::from_pixels(Size::new(2, 1), pixels.to_vec()).unwrap();
        let a = picture([[10, 20, 30, 255], [0, 0, 0, 255]]);
        let none = Difference { largest: 0, pixels: 0, rmse: 0.0, flip: 0.0 };
        assert_eq!(difference(&a, &a), none);
        let opaque = difference(&a, &picture([[13, 20, 26, 255], [0, 0, 0, 255]]));
        assert_eq!((opaque.largest, opaque.pixels), (4, 1));
        assert!((opaque.rmse - libm::sqrt(25.0 / 6.0)).abs() < 1e-12 && opaque.flip > 0.0);
        let clear = difference(&a, &picture([[10, 20, 30, 255], [0, 0, 0, 253]]));
        assert_eq!((clear.largest, clear.pixels), (2, 1));
        assert!((clear.rmse - libm::sqrt(4.0 / 8.0)).abs() < 1e-12);
    }
}

//! Parses option values.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use clap::builder::{PathBufValueParser, TypedValueParser};
use marraztu_core::base::color::Color;
use marraztu_core::base::image::Size;
use marraztu_io::PictureFormat;

/// The longest side of a picture.
const LONGEST_SIDE: usize = 16_384;

/// Returns whether a file name refers to standard input or output.
pub(crate) fn is_standard(file: &Path) -> bool {
    file == Path::new("-")
}

/// Returns whether a file name refers to the terminal.
pub(crate) fn is_terminal(file: &Path) -> bool {
    file == Path::new("terminal")
}

/// Returns the name of a file without its extension; `.obj.gz` is one extension.
pub(super) fn stem(file: &Path) -> OsString {
    let name = Path::new(file.file_name().unwrap_or_default());
    let inner = match name.extension() {
        Some(ending) if ending.eq_ignore_ascii_case("gz") => name.with_extension(""),
        _ => name.to_owned(),
    };
    inner.file_stem().unwrap_or_default().to_owned()
}

/// Returns a parser of the names of pictures, which checks their extensions.
pub(super) fn picture_file() -> impl TypedValueParser<Value = PathBuf> {
    PathBufValueParser::new().try_map(|path| PictureFormat::of(&path).map(|_| path))
}

/// Parses a picture size: "800x600", or "800" for a square.
pub(super) fn size(text: &str) -> Result<Size, String> {
    let side = |text: &str| text.parse().ok().filter(|side| (1..=LONGEST_SIDE).contains(side));
    let sides = text.split_once(['x', 'X']).unwrap_or((text, text));
    match (side(sides.0), side(sides.1)) {
        (Some(width), Some(height)) => Ok(Size::new(width, height)),
        _ => Err(format!(
            "write width x height, each from 1 to {LONGEST_SIDE}, as 800x600; or 800 for a square"
        )),
    }
}

/// Parses a colour: "255,128,0", "#ff8000", "#f80", or a name.
pub(super) fn color(text: &str) -> Result<Color, String> {
    let text = text.trim();
    let color = match text.strip_prefix('#') {
        Some(digits) => hexadecimal(digits).map(Color),
        None => Color::named(text).or_else(|| decimal(text).map(Color)),
    };
    color.ok_or_else(|| {
        "write red,green,blue, each from 0 to 255; or #rrggbb, #rgb, black, white, gray, red, \
         green, blue, yellow, cyan or magenta"
            .to_owned()
    })
}

fn decimal(text: &str) -> Option<[u8; 3]> {
    let channels: Option<Vec<u8>> =
        text.split(',').map(|part| part.trim().parse::<u8>().ok()).collect();
    channels?.try_into().ok()
}

/// Parses six hexadecimal digits, two per channel, or three, one per channel, which are doubled.
fn hexadecimal(digits: &str) -> Option<[u8; 3]> {
    let digits: Option<Vec<u8>> =
        digits.chars().map(|digit| u8::try_from(digit.to_digit(16)?).ok()).collect();
    match digits?[..] {
        [r, g, b] => Some([r, g, b].map(|digit| 17 * digit)),
        [r, s, g, h, b, c] => Some([16 * r + s, 16 * g + h, 16 * b + c]),
        _ => None,
    }
}

/// Parses a number of threads.
pub(super) fn threads(text: &str) -> Result<usize, String> {
    let count = text.parse().ok().filter(|count| (1..=1024).contains(count));
    count.ok_or_else(|| "write a whole number from 1 to 1024".to_owned())
}

/// A pixel as column and row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Pixel(pub(super) [usize; 2]);

/// Parses a column and a row, such as `120,80`.
pub(super) fn pixel(text: &str) -> Result<Pixel, String> {
    let parts = text.split_once(',').map(|(x, y)| (x.trim().parse(), y.trim().parse()));
    match parts {
        Some((Ok(x), Ok(y))) => Ok(Pixel([x, y])),
        _ => Err("write column,row, counted from the upper left from 0, as 120,80".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_rectangles_or_squares() {
        assert_eq!(size("640x480"), Ok(Size::new(640, 480)));
        assert_eq!(size("640"), Ok(Size::new(640, 640)));
        for wrong in ["0", "0x10", "10x0", "16385x1", "-1x5", "axb", "1x2x3", "x", "640x", ""] {
            assert!(size(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn colours_are_numbers_hexadecimal_digits_or_names() {
        for (text, color) in [
            ("1, 2,255", [1, 2, 255]),
            ("#fff", [255; 3]),
            ("#1a2", [17, 170, 34]),
            ("#0a10FF", [10, 16, 255]),
            ("white", [255; 3]),
            ("Gray", [128; 3]),
        ] {
            assert_eq!(super::color(text), Ok(Color(color)), "{text}");
        }
        for wrong in ["1,2", "1,2,3,4", "1,2,256", "reddish", "", "#", "#ffff", "#ggg", "#+1+1+1"] {
            assert!(color(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn threads_are_one_or_more() {
        assert_eq!(threads("3"), Ok(3));
        assert!(["0", "-1", "many", "1025"].iter().all(|wrong| threads(wrong).is_err()));
    }
}

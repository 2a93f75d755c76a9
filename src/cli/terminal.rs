//! Pictures in a terminal: `--out terminal`.
//!
//! * kitty: exact colours; kitty, Ghostty, WezTerm, Konsole.
//! * sixel: 252 colours, or the picture's own if it has at most 256; foot, mlterm, iTerm2, Windows
//!   Terminal, mintty.
//! * blocks: exact colours, with two pixels in a character; all terminals with 24-bit colours.
//!
//! The form follows from environment variables, because asking the terminal fails in pipes and is
//! slow over ssh. `TERM` alone survives ssh. In tmux and screen, half blocks are used.
//!
//! <https://sw.kovidgoyal.net/kitty/graphics-protocol/>; sixels: DEC, "VT330/VT340 Programmer
//! Reference Manual", volume 2, chapter 14.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use marraztu_core::base::image::{Picture, Size};
use marraztu_io::PICTURE_FORMATS;

/// The form of a picture in a terminal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum TerminalForm {
    Kitty,
    Sixel,
    Blocks,
}

impl TerminalForm {
    /// The forms by name.
    pub(crate) const ALL: [(&'static str, Self); 3] =
        [("kitty", Self::Kitty), ("sixel", Self::Sixel), ("blocks", Self::Blocks)];

    /// Returns the form for a terminal with these environment variables.
    pub(crate) fn of(variable: &dyn Fn(&str) -> Option<String>) -> Self {
        let is_set = |name: &str| variable(name).is_some_and(|value| !value.is_empty());
        let has = |name: &str, words: &[&str]| {
            let value = variable(name).unwrap_or_default().to_ascii_lowercase();
            words.iter().any(|word| value.contains(word))
        };
        // Multiplexers do not pass pictures on.
        if is_set("TMUX") || is_set("STY") || has("TERM", &["tmux", "screen"]) {
            return Self::Blocks;
        }
        let is_kitty = is_set("KITTY_WINDOW_ID")
            || is_set("KONSOLE_VERSION")
            || has("TERM", &["kitty", "ghostty"])
            || has("TERM_PROGRAM", &["ghostty", "wezterm"]);
        let is_sixel = is_set("WT_SESSION")
            || has("TERM", &["foot", "mlterm", "sixel", "contour"])
            || has("TERM_PROGRAM", &["iterm", "mintty"]);
        match (is_kitty, is_sixel) {
            (true, _) => Self::Kitty,
            (false, true) => Self::Sixel,
            (false, false) => Self::Blocks,
        }
    }

    /// Returns the size of the picture: a picture of blocks fits into a terminal of these columns
    /// and rows.
    pub(crate) fn size(self, size: Size, [columns, rows]: [usize; 2]) -> Size {
        if self != Self::Blocks {
            return size;
        }
        // The last row is left to the prompt.
        let most = [columns.max(1), (2 * rows.saturating_sub(1)).max(2)];
        let Size { width, height } = size;
        if width <= most[0] && height <= most[1] {
            return size;
        }
        // The sides shrink by the same factor.
        match most[0] * height <= most[1] * width {
            true => Size::new(most[0], (most[0] * height / width).max(1)),
            false => Size::new((most[1] * width / height).max(1), most[1]),
        }
    }

    /// Encodes a picture. Fails with the reason if it cannot be encoded.
    pub(crate) fn encode(self, picture: &Picture) -> Result<String, String> {
        match self {
            Self::Kitty => kitty(picture),
            Self::Sixel => Ok(sixel(picture)),
            Self::Blocks => Ok(blocks(picture)),
        }
    }
}

/// Returns the columns and rows of the terminal.
pub(crate) fn cells() -> [usize; 2] {
    terminal_size::terminal_size()
        .map_or([80, 24], |(columns, rows)| [columns.0.into(), rows.0.into()])
}

/// The longest piece of an escape sequence of kitty.
const PIECE: usize = 4096;

fn kitty(picture: &Picture) -> Result<String, String> {
    let text = STANDARD.encode(PICTURE_FORMATS[0].encode(picture)?);
    let mut pieces = text.as_bytes().chunks(PIECE).peekable();
    // A PNG, shown at the cursor, without an answer.
    let mut keys = "a=T,f=100,q=2,";
    let mut out = String::new();
    while let Some(piece) = pieces.next() {
        let more = u8::from(pieces.peek().is_some());
        let piece = String::from_utf8_lossy(piece);
        // Writing to a string cannot fail.
        let _ = write!(out, "\x1b_G{keys}m={more};{piece}\x1b\\");
        keys = "";
    }
    out.push('\n');
    Ok(out)
}

/// The levels of red, green and blue in a picture with many colours.
const LEVELS: [u32; 3] = [6, 7, 6];

/// The thresholds of a 4 x 4 Bayer matrix: "An optimum method for two-level rendition of
/// continuous-tone pictures", ICC 1973.
const BAYER: [[u32; 4]; 4] = [[0, 8, 2, 10], [12, 4, 14, 6], [3, 11, 1, 9], [15, 7, 13, 5]];

/// Returns the colours of pixels, at most 256.
fn few_colors(picture: &Picture) -> Vec<[u8; 3]> {
    let opaque = |[r, g, b, _]: &[u8; 4]| [*r, *g, *b];
    let mut colors = std::collections::BTreeSet::new();
    if picture.pixels().iter().all(|pixel| {
        colors.insert(opaque(pixel));
        colors.len() <= 256
    }) {
        return picture.pixels().iter().map(opaque).collect();
    }
    let width = picture.size().width;
    let dithered = |(i, pixel): (usize, &[u8; 4])| {
        let threshold = BAYER[i / width % 4][i % width % 4];
        std::array::from_fn(|channel| {
            let steps = LEVELS[channel] - 1;
            let level =
                (u32::from(pixel[channel]) * steps * 16 + 255 * threshold + 127) / (255 * 16);
            u8::try_from(level.min(steps) * 255 / steps).unwrap_or(u8::MAX)
        })
    };
    picture.pixels().iter().enumerate().map(dithered).collect()
}

fn sixel(picture: &Picture) -> String {
    let Size { width, height } = picture.size();
    let pixels = few_colors(picture);
    let mut numbers: BTreeMap<[u8; 3], usize> = BTreeMap::new();
    for pixel in &pixels {
        numbers.entry(*pixel).or_default();
    }
    let mut out = format!("\x1bPq\"1;1;{width};{height}");
    for ((color, number), i) in numbers.iter_mut().zip(0..) {
        *number = i;
        // Colours are percentages.
        let [r, g, b] = color.map(|byte| (u32::from(byte) * 100 + 127) / 255);
        let _ = write!(out, "#{i};2;{r};{g};{b}");
    }
    // Each band has six rows, and a pass for each of its colours.
    for top in (0..height).step_by(6) {
        let mut bands: BTreeMap<usize, Vec<u8>> = BTreeMap::new();
        for y in top..height.min(top + 6) {
            for x in 0..width {
                let number = numbers.get(&pixels[y * width + x]).copied().unwrap_or(0);
                bands.entry(number).or_insert_with(|| vec![0; width])[x] |= 1 << (y - top);
            }
        }
        for (number, band) in bands {
            let _ = write!(out, "#{number}");
            for run in band.chunk_by(|a, b| a == b) {
                let sign = char::from(b'?' + run[0]);
                let _ = match run.len() {
                    1..4 => write!(out, "{}", sign.to_string().repeat(run.len())),
                    length => write!(out, "!{length}{sign}"),
                };
            }
            out.push('$');
        }
        out.push('-');
    }
    out + "\x1b\\\n"
}

fn blocks(picture: &Picture) -> String {
    let Size { width, height } = picture.size();
    let mut out = String::new();
    for y in (0..height).step_by(2) {
        let mut last = None;
        for x in 0..width {
            let [r, g, b, _] = picture.pixel(x, y);
            let lower = (y + 1 < height).then(|| picture.pixel(x, y + 1));
            // Colours stay until they are changed.
            if last != Some((picture.pixel(x, y), lower)) {
                let _ = write!(out, "\x1b[38;2;{r};{g};{b}m");
                let _ = match lower {
                    Some([r, g, b, _]) => write!(out, "\x1b[48;2;{r};{g};{b}m"),
                    None => write!(out, "\x1b[49m"),
                };
                last = Some((picture.pixel(x, y), lower));
            }
            out.push('\u{2580}');
        }
        out += "\x1b[0m\n";
    }
    out
}

#[cfg(test)]
#[expect(clippy::cast_possible_truncation, clippy::cast_precision_loss, reason = "small numbers")]
mod tests {
    use super::*;

    fn form(variables: &[(&str, &str)]) -> TerminalForm {
        TerminalForm::of(&|name| {
            variables.iter().find(|(other, _)| *other == name).map(|(_, value)| (*value).to_owned())
        })
    }

    fn picture(width: usize, height: usize, color: impl Fn(usize) -> [u8; 4]) -> Picture {
        let size = Size::new(width, height);
        Picture::from_pixels(size, (0..size.area()).map(color).collect()).unwrap()
    }

    #[test]
    fn the_form_follows_from_the_environment() {
        for (variables, expected) in [
            (&[("TERM", "xterm-kitty")][..], TerminalForm::Kitty),
            (&[("TERM", "xterm-256color"), ("TERM_PROGRAM", "WezTerm")], TerminalForm::Kitty),
            (&[("TERM", "foot")], TerminalForm::Sixel),
            (&[("TERM", "xterm-256color"), ("WT_SESSION", "1")], TerminalForm::Sixel),
            (&[("TERM", "xterm-256color")], TerminalForm::Blocks),
            (&[("TERM", "xterm-kitty"), ("TMUX", "/tmp/x")], TerminalForm::Blocks),
            (&[("TERM", "screen.xterm-kitty")], TerminalForm::Blocks),
            (&[], TerminalForm::Blocks),
        ] {
            assert_eq!(form(variables), expected, "{variables:?}");
        }
    }

    #[test]
    fn blocks_fit_into_the_terminal_and_keep_their_shape() {
        let fit = |size, cells| TerminalForm::Blocks.size(size, cells);
        assert_eq!(fit(Size::new(800, 800), [80, 24]), Size::new(46, 46));
        assert_eq!(fit(Size::new(800, 400), [80, 50]), Size::new(80, 40));
        assert_eq!(fit(Size::new(40, 40), [80, 24]), Size::new(40, 40));
        assert_eq!(fit(Size::new(10_000, 1), [80, 24]), Size::new(80, 1));
        assert_eq!(TerminalForm::Kitty.size(Size::new(800, 800), [80, 24]), Size::new(800, 800));
    }

    #[test]
    fn kitty_gets_a_png_in_pieces() {
        let noise = |i: usize| {
            let bits = marraztu_core::base::rng::Rng::new(i as u64).bits().to_le_bytes();
            [bits[0], bits[1], bits[2], 255]
        };
        let picture = picture(60, 50, noise);
        let text = kitty(&picture).unwrap();
        let pieces: Vec<&str> =
            text.trim_end().split("\x1b\\").filter(|it| !it.is_empty()).collect();
        assert!(pieces.len() > 2);
        let mut encoded = String::new();
        for (i, piece) in pieces.iter().enumerate() {
            let (keys, data) = piece.strip_prefix("\x1b_G").unwrap().split_once(';').unwrap();
            let first = if i == 0 { "a=T,f=100,q=2," } else { "" };
            let more = u8::from(i + 1 < pieces.len());
            assert_eq!(keys, format!("{first}m={more}"));
            assert!(data.len() <= PIECE);
            encoded += data;
        }
        let png = STANDARD.decode(encoded).unwrap();
        assert_eq!(png, PICTURE_FORMATS[0].encode(&picture).unwrap());
    }

    /// Reads the numbers of a command.
    fn numbers(signs: &mut std::iter::Peekable<std::str::Chars<'_>>) -> Vec<u32> {
        let mut text = String::new();
        while let Some(sign) = signs.next_if(|sign| sign.is_ascii_digit() || *sign == ';') {
            text.push(sign);
        }
        text.split(';').filter_map(|n| n.parse().ok()).collect()
    }

    /// Decodes sixels to colours in percent.
    fn decoded(text: &str, size: Size) -> Vec<[u32; 3]> {
        let body = text.strip_prefix("\x1bPq").unwrap().trim_end().strip_suffix("\x1b\\").unwrap();
        let (mut palette, mut pixels) = (BTreeMap::new(), vec![[0; 3]; size.area()]);
        let (mut color, mut x, mut top, mut signs) = (0, 0, 0, body.chars().peekable());
        while let Some(sign) = signs.next() {
            let mut times = 1;
            let sign = match sign {
                '"' => {
                    assert_eq!(numbers(&mut signs)[2..], [size.width as u32, size.height as u32]);
                    continue;
                }
                '#' => {
                    match numbers(&mut signs)[..] {
                        [number, 2, r, g, b] => _ = palette.insert(number, [r, g, b]),
                        [number] => color = number,
                        _ => panic!("{body}"),
                    }
                    continue;
                }
                '$' => {
                    x = 0;
                    continue;
                }
                '-' => {
                    (x, top) = (0, top + 6);
                    continue;
                }
                '!' => {
                    times = numbers(&mut signs)[0];
                    signs.next().unwrap()
                }
                sign => sign,
            };
            let bits = u32::from(sign) - u32::from('?');
            for _ in 0..times {
                for row in (0..6).filter(|row| bits >> row & 1 == 1) {
                    pixels[(top + row) * size.width + x] = palette[&color];
                }
                x += 1;
            }
        }
        pixels
    }

    #[test]
    fn sixels_show_every_pixel() {
        // Few colours stay as they are.
        let colors = [[0, 0, 0, 255], [255, 0, 128, 255], [10, 200, 30, 255]];
        let few = picture(13, 11, |i| colors[i * i % 3]);
        let percent = |byte: u8| (u32::from(byte) * 100 + 127) / 255;
        let found = decoded(&sixel(&few), few.size());
        for (pixel, found) in few.pixels().iter().zip(found) {
            assert_eq!([0, 1, 2].map(|i| percent(pixel[i])), found);
        }
        // Many colours are dithered: the mean of a flat part stays.
        let many = picture(64, 64, |i| {
            if i < 512 { [(i % 256) as u8, (i / 256) as u8, 7, 255] } else { [100, 150, 200, 255] }
        });
        let found = decoded(&sixel(&many), many.size());
        let flat = &found[1024..];
        for (i, byte) in [100.0, 150.0, 200.0].into_iter().enumerate() {
            let mean =
                flat.iter().map(|pixel| f64::from(pixel[i])).sum::<f64>() / flat.len() as f64;
            assert!((mean - byte / 2.55).abs() < 1.5, "{i}: {mean}");
        }
    }

    #[test]
    fn blocks_have_the_colours_of_two_rows() {
        let colors = [[1, 2, 3, 255], [4, 5, 6, 255], [7, 8, 9, 255]];
        let text = blocks(&picture(2, 3, |i| colors[i / 2]));
        let upper = "\x1b[38;2;1;2;3m\x1b[48;2;4;5;6m\u{2580}\u{2580}\x1b[0m\n";
        let last = "\x1b[38;2;7;8;9m\x1b[49m\u{2580}\u{2580}\x1b[0m\n";
        assert_eq!(text, [upper, last].concat());
    }
}

//! Parses plain lines on a fast path, which takes nearly all lines of a file.
//!
//! A line is scanned once, from its keyword to its end. Faces are parsed if the whole line is
//! plain; rows of numbers are passed to tobj. All other lines are left to the tolerant path, which
//! handles comments, continued lines, odd numbers and all faults.

use super::lines::Lines;
use super::piece::{Counts, Piece, Trust};
use marraztu_core::scene::{NONE, SourceCorner};

impl Piece {
    /// Parses the next line if it is plain; returns its length in bytes, including the line end.
    #[inline]
    pub(super) fn quick(&mut self, lines: &Lines<'_>) -> Option<usize> {
        match lines.rest() {
            text @ [b'f', b' ', rest @ ..] => {
                let rest = self.quick_face(rest, lines.number().saturating_add(1))?;
                Some(text.len() - rest.len())
            }
            text @ [b'v', ..] if self.trust == Trust::Plain => {
                self.quick_row(text, lines.position())
            }
            _ => None,
        }
    }

    /// Passes `v x y z`, `v x y z r g b`, `vt u v`, `vt u v w` and `vn x y z` to tobj unchanged.
    #[inline]
    fn quick_row(&mut self, text: &[u8], begin: usize) -> Option<usize> {
        let keyword = match text {
            [_, b' ', ..] => 1,
            [_, b'n' | b't', b' ', ..] => 2,
            _ => return None,
        };
        let (words, length, ending) = plain(&text[keyword..])?;
        let (length, end) = (keyword + length, begin + keyword + length);
        match (&text[..keyword], words) {
            (b"v", 3 | 6) => self.vertices.add_line(begin, end, words == 6),
            (b"vn", 3) => self.normals.add_line(begin, end, false),
            (b"vt", 2) => self.uvs.add_line(begin, end, false),
            // tobj ignores the third number, so it is checked here.
            (b"vt", 3) if is_number(&text[..length]) => self.uvs.add_line(begin, end, false),
            _ => return None,
        }
        Some(length + ending)
    }

    /// Parses three corners or more.
    #[inline]
    fn quick_face<'a>(&mut self, mut rest: &'a [u8], line: u32) -> Option<&'a [u8]> {
        let counts = self.counts();
        let begin = self.faces.corners();
        // Corners are pushed at once, and removed if the line turns out not to be plain.
        let after = loop {
            if let Some(after) = line_end(rest) {
                break Some(after);
            }
            let Some((corner, after)) = corner(blanks(rest), counts) else { break None };
            self.faces.push(corner);
            rest = after;
        };
        let corners = self.faces.corners() - begin;
        if after.is_none() || corners < 3 {
            self.faces.truncate(begin);
            return None;
        }
        self.end_face(corners, line);
        after
    }
}

/// Counts the words of a line, their bytes and the bytes of the line end; `None` if the line has
/// characters that are neither blanks nor part of numbers. It begins with a blank.
#[inline]
fn plain(text: &[u8]) -> Option<(u32, usize, usize)> {
    let (mut words, mut after_blank, mut length) = (0, false, 0);
    while let Some(byte) = text.get(length) {
        // Branch-free: numbers have varying lengths, so a branch per blank would be mispredicted.
        let is_blank = matches!(byte, b' ' | b'\t');
        let is_number = matches!(byte, b'0'..=b'9' | b'.' | b'-' | b'+' | b'e' | b'E');
        if !(is_blank | is_number) {
            break;
        }
        words += u32::from(after_blank & is_number);
        after_blank = is_blank;
        length += 1;
    }
    match text[length..] {
        [b'\r', b'\n', ..] => Some((words, length, 2)),
        [b'\n' | b'\r', ..] => Some((words, length, 1)),
        [] => Some((words, length, 0)),
        _ => None,
    }
}

/// Returns whether the last word of a line is a number.
fn is_number(line: &[u8]) -> bool {
    let mut words = line.trim_ascii_end().rsplit(|b| matches!(b, b' ' | b'\t'));
    let word = std::str::from_utf8(words.next().unwrap_or_default());
    word.is_ok_and(|word| word.parse::<f32>().is_ok())
}

/// Parses a corner `v`, `v/vt`, `v//vn` or `v/vt/vn`.
#[inline]
fn corner(text: &[u8], counts: Option<Counts>) -> Option<(SourceCorner, &[u8])> {
    let count = |i: usize| counts.map(|counts| counts[i]);
    let (position, mut text) = index(text, count(0))?;
    let [mut uv, mut normal] = [NONE; 2];
    if let [b'/', rest @ ..] = text {
        text = rest;
        if !matches!(text, [b'/', ..]) {
            (uv, text) = index(text, count(1))?;
        }
        if let [b'/', rest @ ..] = text {
            (normal, text) = index(rest, count(2))?;
        }
    }
    ends_word(text)?;
    Some((SourceCorner { position, uv, normal }, text))
}

/// Parses an index of up to nine digits to count from 0. A negative one needs a known `count`.
#[inline]
fn index(text: &[u8], count: Option<u32>) -> Option<(u32, &[u8])> {
    let (back, digits) = match text {
        [b'-', rest @ ..] => (true, rest),
        _ => (false, text),
    };
    // Eight digits at once; the loop handles a ninth, and the end of the text.
    let (mut value, first) = digits.first_chunk().map_or((0, 0), |eight| leading_digits(*eight));
    let mut rest = &digits[first..];
    if first == 8 || digits.len() < 8 {
        while let [digit @ b'0'..=b'9', after @ ..] = rest {
            value = value.wrapping_mul(10).wrapping_add(u32::from(digit - b'0'));
            rest = after;
        }
    }
    if value == 0 || digits.len() - rest.len() > 9 {
        return None;
    }
    let place = if back { count?.checked_sub(value)? } else { value - 1 };
    Some((place, rest))
}

/// Skips leading blanks.
#[inline]
fn blanks(mut text: &[u8]) -> &[u8] {
    while let [b' ' | b'\t', rest @ ..] = text {
        text = rest;
    }
    text
}

/// Returns whether a word ends at the beginning of this text.
#[inline]
fn ends_word(text: &[u8]) -> Option<()> {
    matches!(text, [] | [b' ' | b'\t' | b'\n' | b'\r', ..]).then_some(())
}

/// Returns the text after the line end, if only blanks precede it.
#[inline]
fn line_end(text: &[u8]) -> Option<&[u8]> {
    match blanks(text) {
        [b'\r', b'\n', rest @ ..] | [b'\n' | b'\r', rest @ ..] | rest @ [] => Some(rest),
        _ => None,
    }
}

/// Parses the leading digits of eight bytes; returns the number and the digit count.
#[inline]
fn leading_digits(text: [u8; 8]) -> (u32, usize) {
    // XOR turns digits into their values, and other bytes into more than 9.
    let values = u64::from_le_bytes(text) ^ 0x3030_3030_3030_3030;
    let beyond = values | values.wrapping_add(0x0606_0606_0606_0606);
    // A carry only affects bytes after the first non-digit.
    let count = (beyond & 0xf0f0_f0f0_f0f0_f0f0).trailing_zeros() / 8;
    if count == 0 {
        return (0, 0);
    }
    // Shift the digits to the end, behind zeros. Then join neighbours: pairs, fours, eights.
    let values = values << (64 - 8 * count);
    let pairs = values.wrapping_mul(10).wrapping_add(values >> 8);
    let even = (pairs & 0x0000_00ff_0000_00ff).wrapping_mul(0x000f_4240_0000_0064);
    let odd = ((pairs >> 16) & 0x0000_00ff_0000_00ff).wrapping_mul(0x0000_2710_0000_0001);
    let value = (even.wrapping_add(odd) >> 32) as u32;
    (value, count as usize)
}

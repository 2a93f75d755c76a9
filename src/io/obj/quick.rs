//! The quick way through lines as nearly all of them are written.
//!
//! It goes over a line once, from its keyword to its ending, and takes what it says only where the
//! whole line is of the plain form; else it leaves the line as if it had not looked, to the way
//! that knows comments, continued lines, odd numbers and every fault.

use super::decimal::{decimal, leading_digits};
use super::scan::{Counts, Piece};
use crate::scene::{NONE, SourceCorner};

impl Piece {
    /// Reads the line with which a text begins; says how many bytes it has, its ending among them,
    /// or `None` where it is not of the plain form.
    #[inline]
    pub(super) fn quick(&mut self, text: &[u8], line: u32) -> Option<usize> {
        let rest = match text {
            [b'v', b' ', rest @ ..] => self.quick_vertex(rest),
            [b'f', b' ', rest @ ..] => self.quick_face(rest, line),
            [b'v', b'n', b' ', rest @ ..] => {
                let (normal, rest) = numbers(rest)?;
                let rest = line_end(rest)?;
                self.normals.add(normal);
                Some(rest)
            }
            [b'v', b't', b' ', rest @ ..] => self.quick_uv(rest),
            _ => None,
        }?;
        Some(text.len() - rest.len())
    }

    /// `x y z` and `x y z r g b`.
    #[inline]
    fn quick_vertex<'a>(&mut self, rest: &'a [u8]) -> Option<&'a [u8]> {
        let (position, rest) = numbers(rest)?;
        let (color, rest) = match line_end(rest) {
            Some(rest) => (None, rest),
            None => {
                let (color, rest) = numbers(rest)?;
                (Some(color), line_end(rest)?)
            }
        };
        self.vertices.add(position);
        self.color(color);
        Some(rest)
    }

    /// `u v` and `u v w`.
    #[inline]
    fn quick_uv<'a>(&mut self, rest: &'a [u8]) -> Option<&'a [u8]> {
        let (uv, rest) = numbers(rest)?;
        let rest = match line_end(rest) {
            Some(rest) => rest,
            None => line_end(numbers::<1>(rest)?.1)?,
        };
        self.uvs.add(uv);
        Some(rest)
    }

    /// Three corners or more.
    #[inline]
    fn quick_face<'a>(&mut self, mut rest: &'a [u8], line: u32) -> Option<&'a [u8]> {
        let counts = self.counts();
        let begin = self.faces.corners();
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

/// `N` numbers with blanks before each.
#[inline]
fn numbers<const N: usize>(mut text: &[u8]) -> Option<([f32; N], &[u8])> {
    let mut numbers = [0.0; N];
    for number in &mut numbers {
        (*number, text) = decimal(blanks(text))?;
        ends_word(text)?;
    }
    Some((numbers, text))
}

/// A corner `v`, `v/vt`, `v//vn` or `v/vt/vn`.
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

/// An index of up to nine digits, counted from 0; one that counts back has to count from somewhere.
#[inline]
fn index(text: &[u8], count: Option<u32>) -> Option<(u32, &[u8])> {
    let (back, digits) = match text {
        [b'-', rest @ ..] => (true, rest),
        _ => (false, text),
    };
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

/// A text without the blanks that it begins with.
#[inline]
fn blanks(mut text: &[u8]) -> &[u8] {
    while let [b' ' | b'\t', rest @ ..] = text {
        text = rest;
    }
    text
}

/// Whether a word ends where this text begins.
#[inline]
fn ends_word(text: &[u8]) -> Option<()> {
    matches!(text, [] | [b' ' | b'\t' | b'\n' | b'\r', ..]).then_some(())
}

/// What follows the line's ending, where nothing but blanks is before it.
#[inline]
fn line_end(text: &[u8]) -> Option<&[u8]> {
    match blanks(text) {
        [b'\r', b'\n', rest @ ..] | [b'\n' | b'\r', rest @ ..] | rest @ [] => Some(rest),
        _ => None,
    }
}

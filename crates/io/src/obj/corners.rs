//! Parses the faces that the fast path skips: `f 1/2/3 -1//2 4`.

use super::faces::WRONG;
use super::lines::{excerpt, words};
use super::piece::{Counts, Piece, Stop};
use crate::findings::FindingKind;
use marraztu_core::scene::{NONE, SourceCorner};

impl Piece {
    pub(super) fn face(&mut self, rest: &[u8], line: u32) -> Result<(), Stop> {
        // A minus sign in a comment stops the piece, too, which costs time but no data.
        if self.before.is_none() && rest.contains(&b'-') {
            return Err(Stop::CountsBack);
        }
        let counts = self.counts().unwrap_or_default();
        let begin = self.faces.corners();
        let mut fault = None;
        for word in words(rest) {
            // A comment may follow a number without a blank.
            let (word, comment) = match word.iter().position(|b| *b == b'#') {
                Some(end) => (&word[..end], true),
                None => (word, false),
            };
            match corner(word, counts) {
                Some(corner) if corner.position == WRONG => {
                    let reason = format!(
                        "a face refers to vertex {}, which the file does not have",
                        excerpt(word)
                    );
                    fault.get_or_insert((FindingKind::FaceRange, String::new(), reason));
                }
                Some(corner) => self.faces.push(corner),
                None => {
                    let text = excerpt(word);
                    let reason = format!("\"{text}\" is not a corner of a face");
                    fault.get_or_insert((FindingKind::FaceUnreadable, text, reason));
                }
            }
            if comment {
                break;
            }
        }
        // A fault drops the whole face: the corners pushed so far are removed.
        let corners = self.faces.corners() - begin;
        if fault.is_none() && corners < 3 {
            let reason = format!("a face needs at least three corners, but has {corners}");
            fault = Some((FindingKind::FaceShort, String::new(), reason));
        }
        match fault {
            None => self.end_face(corners, line),
            Some((kind, name, reason)) => {
                self.findings.add(kind, &name, Some(line));
                self.faces.refused.get_or_insert((line, reason));
                self.faces.truncate(begin);
            }
        }
        Ok(())
    }
}

/// Parses a corner `v`, `v/vt`, `v//vn` or `v/vt/vn`; `None` if it is invalid.
pub(super) fn corner(word: &[u8], counts: Counts) -> Option<SourceCorner> {
    let mut places = [NONE; 3];
    for (i, part) in word.split(|b| *b == b'/').enumerate() {
        if i == 3 {
            return None;
        }
        if !part.is_empty() {
            places[i] = index(part, counts[i])?;
        }
    }
    let [position, uv, normal] = places;
    (position != NONE).then_some(SourceCorner { position, uv, normal })
}

/// Converts an index to count from 0: positive ones count from 1, negative ones back from `count`.
fn index(digits: &[u8], count: u32) -> Option<u32> {
    let (back, digits) = match digits {
        [b'-', rest @ ..] => (true, rest),
        [b'+', rest @ ..] => (false, rest),
        _ => (false, digits),
    };
    if digits.is_empty() {
        return None;
    }
    let value = digits.iter().try_fold(0_u64, |value, digit| {
        let digit = digit.is_ascii_digit().then(|| digit - b'0')?;
        // An index beyond 32 bits is out of range like any other.
        Some((value * 10 + u64::from(digit)).min(u64::from(u32::MAX)))
    })?;
    let value = u32::try_from(value).unwrap_or(u32::MAX);
    let place =
        if back { count.checked_sub(value).filter(|_| value > 0) } else { value.checked_sub(1) };
    Some(place.map_or(WRONG, |place| place.min(WRONG)))
}

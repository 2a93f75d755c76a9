//! Faces as a chunk names them.
//!
//! Millions of faces stand line after line with equal numbers of corners: what they have in common
//! is kept once.

use super::lines::{excerpt, words};
use super::scan::{Counts, Piece, Stop};
use crate::io::findings::FindingKind;
use crate::scene::{CornerLists, NONE, SourceCorner};

/// An index that counts back past the beginning of the file, or is 0.
pub(super) const WRONG: u32 = NONE - 1;

/// Faces of three corners and more. Indices count from 0, or are [`NONE`] or [`WRONG`].
#[derive(Debug, Default)]
pub(super) struct Faces {
    pub(super) corners: CornerLists,
    pub(super) runs: Vec<Run>,
    /// The first face statement that cannot be used, with the reason.
    pub(super) refused: Option<(u32, String)>,
}

/// The smoothing group of faces before the first `s` of a chunk: that of the chunk before.
pub(super) const INHERITED: u32 = u32::MAX;

/// Faces of one part on lines that follow each other, with the same number of corners and the same
/// smoothing group.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Run {
    pub(super) faces: u32,
    pub(super) corners: u32,
    /// The line of the first one.
    pub(super) line: u32,
    pub(super) part: u32,
    /// 0 for none, or [`INHERITED`].
    pub(super) smoothing: u32,
}

impl Run {
    /// Takes up another face if it belongs to this run; says whether it does.
    #[inline]
    fn take(&mut self, face: Self) -> bool {
        let next = Self { faces: 1, line: self.line.wrapping_add(self.faces), ..*self };
        let belongs = next == face;
        self.faces += u32::from(belongs);
        belongs
    }
}

impl Faces {
    /// How many corners there are.
    #[inline]
    pub(super) fn corners(&self) -> usize {
        self.corners.positions.len()
    }

    #[inline]
    pub(super) fn push(&mut self, corner: SourceCorner) {
        let CornerLists { positions, uvs, normals } = &mut self.corners;
        let bare = corner.uv == NONE && corner.normal == NONE;
        if !(bare && uvs.is_empty() && normals.is_empty()) {
            for (list, index) in [(uvs, corner.uv), (normals, corner.normal)] {
                if index != NONE || !list.is_empty() {
                    // Up to here no corner had one.
                    list.resize(positions.len(), NONE);
                    list.push(index);
                }
            }
        }
        positions.push(corner.position);
    }

    /// Forgets the corners from `begin` on.
    pub(super) fn truncate(&mut self, begin: usize) {
        let CornerLists { positions, uvs, normals } = &mut self.corners;
        for list in [positions, uvs, normals] {
            list.truncate(begin);
        }
    }

    /// Takes up a face, as a run of its own, whose corners were pushed last.
    #[inline]
    pub(super) fn end_face(&mut self, face: Run) {
        if !self.runs.last_mut().is_some_and(|run| run.take(face)) {
            self.runs.push(face);
        }
    }
}

impl Piece {
    /// Takes up a face of `corners` corners, which were pushed last.
    #[inline]
    pub(super) fn end_face(&mut self, corners: usize, line: u32) {
        let corners = u32::try_from(corners).unwrap_or(NONE);
        let (part, smoothing) = (self.parts.place(), self.smoothing);
        self.faces.end_face(Run { faces: 1, corners, line, part, smoothing });
    }

    pub(super) fn face(&mut self, rest: &[u8], line: u32) -> Result<(), Stop> {
        // A minus in a comment stops the piece, too: nothing is lost but time.
        if self.before.is_none() && rest.contains(&b'-') {
            return Err(Stop::CountsBack);
        }
        let counts = self.counts().unwrap_or_default();
        let begin = self.faces.corners();
        let mut fault = None;
        for word in words(rest) {
            // A comment may follow a number at once.
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

/// A corner `v`, `v/vt`, `v//vn` or `v/vt/vn`; `None` if it is not one.
fn corner(word: &[u8], counts: Counts) -> Option<SourceCorner> {
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

/// An index counted from 0: positive ones count from 1, negative ones back from `count`.
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
        // An index beyond 32 bits is as wrong as any other that is out of range.
        Some((value * 10 + u64::from(digit)).min(u64::from(u32::MAX)))
    })?;
    let value = u32::try_from(value).unwrap_or(u32::MAX);
    let place =
        if back { count.checked_sub(value).filter(|_| value > 0) } else { value.checked_sub(1) };
    Some(place.map_or(WRONG, |place| place.min(WRONG)))
}

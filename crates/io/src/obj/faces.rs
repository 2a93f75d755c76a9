//! The faces of a chunk, compressed into runs.
//!
//! In most files, millions of faces with equal corner counts follow line after line, so their
//! common properties are stored once.

use marraztu_core::scene::{CornerLists, NONE, SourceCorner};

/// The value of an index that counts back past the beginning of the file, or is 0.
pub(super) const WRONG: u32 = NONE - 1;

/// Faces of at least three corners. Indices count from 0, or are [`NONE`] or [`WRONG`].
#[derive(Debug, Default)]
pub(super) struct Faces {
    pub(super) corners: CornerLists,
    pub(super) runs: Vec<Run>,
    /// The first unusable face statement, with the reason.
    pub(super) refused: Option<(u32, String)>,
}

/// The smoothing group before the first `s` of a chunk: the previous chunk's.
pub(super) const INHERITED: u32 = u32::MAX;

/// Consecutive lines of faces with the same part, corner count and smoothing group.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Run {
    pub(super) faces: u32,
    pub(super) corners: u32,
    /// The line of the first face.
    pub(super) line: u32,
    pub(super) part: u32,
    /// The smoothing group: 0 for none, or [`INHERITED`].
    pub(super) smoothing: u32,
}

impl Run {
    /// Extends the run by a face if it belongs to the run; returns whether it does.
    #[inline]
    fn take(&mut self, face: Self) -> bool {
        let next = Self { faces: 1, line: self.line.wrapping_add(self.faces), ..*self };
        let belongs = next == face;
        self.faces += u32::from(belongs);
        belongs
    }
}

impl Faces {
    /// Returns the number of corners.
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
                    // No corner before this one had such an index.
                    list.resize(positions.len(), NONE);
                    list.push(index);
                }
            }
        }
        positions.push(corner.position);
    }

    /// Discards the corners from `begin` on.
    pub(super) fn truncate(&mut self, begin: usize) {
        let CornerLists { positions, uvs, normals } = &mut self.corners;
        for list in [positions, uvs, normals] {
            list.truncate(begin);
        }
    }

    /// Adds a face, given as a run of one, after its corners were pushed.
    #[inline]
    pub(super) fn end_face(&mut self, face: Run) {
        if !self.runs.last_mut().is_some_and(|run| run.take(face)) {
            self.runs.push(face);
        }
    }
}

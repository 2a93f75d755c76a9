//! Faces as a chunk names them.
//!
//! Millions of faces stand line after line with equal numbers of corners: what they have in common
//! is kept once.

use marraztu_core::scene::{CornerLists, NONE, SourceCorner};

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

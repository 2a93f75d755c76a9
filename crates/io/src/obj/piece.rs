//! The parsed statements of a chunk of an OBJ file.

use super::faces::{Faces, INHERITED, Run};
use super::parts::Parts;
use super::rows::{RowKind, Rows};
use super::strokes::ReadStroke;
use crate::findings::Findings;
use marraztu_core::base::color::Color;
use marraztu_core::scene::NONE;

/// The numbers of vertices, texture coordinates and normals.
pub(super) type Counts = [u32; 3];

/// The parsed statements of a chunk.
#[derive(Debug)]
pub(super) struct Piece {
    /// The number of statements of each kind before the chunk, if known.
    pub(super) before: Option<Counts>,
    /// The lines of numbers that tobj gets unchanged.
    pub(super) trust: Trust,
    /// The number of lines parsed.
    pub(super) lines: u32,
    pub(super) vertices: Rows<3, f64>,
    pub(super) uvs: Rows<2, f32>,
    pub(super) normals: Rows<3, f32>,
    /// The first unreadable vertex, with the reason.
    pub(super) refused: Option<(u32, String)>,
    pub(super) faces: Faces,
    /// The lines and points.
    pub(super) strokes: Vec<ReadStroke>,
    pub(super) parts: Parts,
    /// The smoothing group of the next face: 0 for none, or [`INHERITED`].
    pub(super) smoothing: u32,
    /// The arguments of `mtllib`, with their lines.
    pub(super) libraries: Vec<(u32, String)>,
    pub(super) edge_color: Option<Color>,
    pub(super) findings: Findings,
    /// The reason why parsing stopped early.
    pub(super) stop: Option<Stop>,
    /// The text of the chunk, if it has to be parsed again.
    pub(super) text: Vec<u8>,
}

/// The lines of numbers that tobj gets unchanged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Trust {
    /// Lines that seem to contain only numbers.
    Plain,
    /// No lines, because tobj rejected one.
    Nothing,
}

/// The reason why parsing a chunk stopped early.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Stop {
    /// tobj rejects the numbers.
    Unread,
    /// A face has a negative index, and the preceding statements are not counted yet.
    CountsBack,
}

impl Piece {
    pub(super) fn new(before: Option<Counts>, trust: Trust) -> Self {
        Self {
            before,
            trust,
            lines: 0,
            vertices: Rows::new(RowKind::Vertex),
            uvs: Rows::new(RowKind::Uv),
            normals: Rows::new(RowKind::Normal),
            refused: None,
            faces: Faces::default(),
            strokes: Vec::new(),
            parts: Parts::default(),
            smoothing: INHERITED,
            libraries: Vec::new(),
            edge_color: None,
            findings: Findings::default(),
            stop: None,
            text: Vec::new(),
        }
    }

    /// Returns the number of statements of each kind before the next one, if known.
    pub(super) fn counts(&self) -> Option<Counts> {
        let own = [self.vertices.count, self.uvs.count, self.normals.count];
        self.before.map(|before| std::array::from_fn(|i| before[i].saturating_add(own[i])))
    }

    /// Adds a face with the `corners` corners that were pushed last.
    #[inline]
    pub(super) fn end_face(&mut self, corners: usize, line: u32) {
        let corners = u32::try_from(corners).unwrap_or(NONE);
        let (part, smoothing) = (self.parts.place(), self.smoothing);
        self.faces.end_face(Run { faces: 1, corners, line, part, smoothing });
    }
}

//! What the statements of a chunk of an OBJ file say.

use super::faces::{Faces, INHERITED, Run};
use super::parts::Parts;
use super::rows::{RowKind, Rows};
use crate::findings::Findings;
use marraztu_core::base::color::Color;
use marraztu_core::scene::NONE;

/// How many vertices, texture coordinates and normals there are.
pub(super) type Counts = [u32; 3];

/// Everything that the statements of a chunk say.
#[derive(Debug)]
pub(super) struct Piece {
    /// How many statements of each kind are before the chunk, if that is known.
    pub(super) before: Option<Counts>,
    /// Which lines of numbers go to tobj as they are.
    pub(super) trust: Trust,
    /// How many lines the chunk has, as far as it was read.
    pub(super) lines: u32,
    pub(super) vertices: Rows<3, f64>,
    pub(super) uvs: Rows<2, f32>,
    pub(super) normals: Rows<3, f32>,
    /// The first vertex that cannot be read, with the reason.
    pub(super) refused: Option<(u32, String)>,
    pub(super) faces: Faces,
    pub(super) parts: Parts,
    /// The smoothing group of the next face: 0 for none, or [`INHERITED`].
    pub(super) smoothing: u32,
    /// What follows `mtllib`, with its lines.
    pub(super) libraries: Vec<(u32, String)>,
    pub(super) edge_color: Option<Color>,
    pub(super) findings: Findings,
    /// Why the chunk was not read to its end.
    pub(super) stop: Option<Stop>,
    /// The chunk, if it has to be read again.
    pub(super) text: Vec<u8>,
}

/// Which lines of numbers go to tobj as they are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Trust {
    /// Those that look like nothing but numbers.
    Plain,
    /// None: tobj refused such a line.
    Nothing,
}

/// Why a chunk was not read to its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Stop {
    /// tobj refuses the numbers.
    Unread,
    /// A face counts back, and it is not known from where.
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
            parts: Parts::default(),
            smoothing: INHERITED,
            libraries: Vec::new(),
            edge_color: None,
            findings: Findings::default(),
            stop: None,
            text: Vec::new(),
        }
    }

    /// How many statements of each kind are before the next one.
    pub(super) fn counts(&self) -> Option<Counts> {
        let own = [self.vertices.count, self.uvs.count, self.normals.count];
        self.before.map(|before| std::array::from_fn(|i| before[i].saturating_add(own[i])))
    }

    /// Takes up a face of `corners` corners, which were pushed last.
    #[inline]
    pub(super) fn end_face(&mut self, corners: usize, line: u32) {
        let corners = u32::try_from(corners).unwrap_or(NONE);
        let (part, smoothing) = (self.parts.place(), self.smoothing);
        self.faces.end_face(Run { faces: 1, corners, line, part, smoothing });
    }
}

//! Parses lines and points: `l 1 2 3`, `l 1/1 2/2` and `p 1 2 3`.

use super::corners::corner;
use super::faces::WRONG;
use super::join::Content;
use super::lines::{excerpt, words};
use super::piece::{Piece, Stop};
use super::sound::{Before, Totals};
use crate::findings::{FindingKind, Findings};
use marraztu_core::scene::Stroke;

/// A stroke of a chunk. The indices of vertices count from 0, as the file counts them.
#[derive(Clone, Copy, Debug)]
pub(super) struct ReadStroke {
    stroke: Stroke,
    /// The line of its statement.
    line: u32,
}

/// The kinds of statements.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum StrokeKind {
    Line,
    Points,
}

impl Piece {
    pub(super) fn strokes(&mut self, kind: StrokeKind, rest: &[u8], line: u32) -> Result<(), Stop> {
        if self.before.is_none() && rest.contains(&b'-') {
            return Err(Stop::CountsBack);
        }
        let counts = self.counts().unwrap_or_default();
        let mut vertices = Vec::new();
        for word in words(rest) {
            let end = word.iter().position(|b| *b == b'#');
            let own = &word[..end.unwrap_or(word.len())];
            if !own.is_empty() {
                // Texture coordinates of lines are not drawn.
                match corner(own, counts).map(|corner| corner.position) {
                    Some(vertex) if vertex != WRONG => vertices.push(vertex),
                    _ => {
                        let name = excerpt(own);
                        self.findings.add(FindingKind::StrokeVertex, &name, Some(line));
                        return Ok(());
                    }
                }
            }
            if end.is_some() {
                break;
            }
        }
        let least = if kind == StrokeKind::Line { 2 } else { 1 };
        if vertices.len() < least {
            self.findings.note(FindingKind::StrokeShort, line);
            return Ok(());
        }
        let part = self.parts.place();
        let new = |ends| ReadStroke { stroke: Stroke { ends, part }, line };
        match kind {
            StrokeKind::Points => self.strokes.extend(vertices.iter().map(|own| new([*own; 2]))),
            StrokeKind::Line => {
                // A line from a vertex to itself would be a point.
                let pairs = vertices.windows(2).filter(|pair| pair[0] != pair[1]);
                self.strokes.extend(pairs.map(|pair| new([pair[0], pair[1]])));
            }
        }
        Ok(())
    }
}

/// Returns the strokes of all chunks with the indices of kept vertices. Strokes with missing
/// vertices are left out.
pub(super) fn sound(
    pieces: &mut [Piece],
    befores: &[Before],
    vertices: &Totals,
    findings: &mut Findings,
) -> Vec<Stroke> {
    let mut sound = Vec::new();
    for (piece, before) in pieces.iter_mut().zip(befores) {
        for ReadStroke { stroke, line } in std::mem::take(&mut piece.strokes) {
            let ends = stroke.ends.map(|end| vertices.place(end).ok_or(end));
            let part = before.parts[stroke.part as usize];
            match ends {
                [Ok(from), Ok(to)] => sound.push(Stroke { ends: [from, to], part }),
                [Err(end), _] | [_, Err(end)] => {
                    let name = end.saturating_add(1).to_string();
                    let line = line.saturating_add(before.lines);
                    findings.add(FindingKind::StrokeVertex, &name, Some(line));
                }
            }
        }
    }
    sound
}

impl Content {
    /// Makes a point of each vertex if the file has nothing but vertices, as scanners write them.
    pub(super) fn show_vertices(&mut self, findings: &mut Findings) {
        let is_empty = self.faces.runs.is_empty() && self.strokes.is_empty();
        if is_empty && !self.positions.is_empty() {
            findings.add(FindingKind::OnlyVertices, "", None);
            if self.parts.is_empty() {
                self.parts.push(super::parts::NamedPart::default());
            }
            let vertices = 0..u32::try_from(self.positions.len()).unwrap_or(u32::MAX);
            self.strokes = vertices.map(|own| Stroke { ends: [own; 2], part: 0 }).collect();
        }
    }
}

//! Selects the usable faces of a file, and notes their faults.

use super::faces::{Faces, INHERITED, Run, WRONG};
use crate::findings::{FindingKind, Findings};
use marraztu_core::base::lists::concatenated;
use marraztu_core::scene::{CornerLists, NONE, SourceCorner};

/// The number of statements of a kind in the file, and the indices of lost ones, ascending.
#[derive(Debug)]
pub(super) struct Totals {
    pub(super) count: u32,
    pub(super) lost: Vec<u32>,
}

impl Totals {
    /// Returns the index of statement `i` among the kept ones; `None` if it is lost.
    pub(super) fn place(&self, i: u32) -> Option<u32> {
        if i >= self.count {
            return None;
        }
        match self.lost.binary_search(&i) {
            Ok(_) => None,
            Err(before) => Some(i - u32::try_from(before).unwrap_or(i)),
        }
    }

    /// Returns whether every index of a list is in range, or [`NONE`] if that is allowed.
    fn holds(&self, list: &[u32], none: bool) -> bool {
        // Counting vectorises; an early exit would not.
        let wrong = |i: &&u32| **i >= self.count && !(none && **i == NONE);
        self.lost.is_empty() && list.iter().filter(wrong).count() == 0
    }
}

/// The state at the beginning of a chunk.
#[derive(Debug)]
pub(super) struct Before {
    /// The number of lines before it.
    pub(super) lines: u32,
    /// The indices of its parts in the file's list.
    pub(super) parts: Vec<u32>,
    /// The smoothing group at its beginning.
    pub(super) smoothing: u32,
}

/// The usable faces of one chunk.
#[derive(Debug, Default)]
pub(super) struct SoundPiece {
    faces: Faces,
    findings: Findings,
    /// Faces without texture coordinates, and faces without normals.
    without: [Without; 2],
}

/// Corners that lack an attribute, and the faces that have such corners.
#[derive(Clone, Copy, Debug, Default)]
struct Without {
    corners: usize,
    faces: usize,
    /// The line of the first such face.
    first: u32,
}

impl Without {
    fn note(&mut self, corners: usize, line: u32) {
        if corners > 0 {
            self.append(Self { corners, faces: 1, first: line });
        }
    }

    fn append(&mut self, following: Self) {
        if self.faces == 0 {
            self.first = following.first;
        }
        self.faces += following.faces;
        self.corners += following.corners;
    }
}

impl SoundPiece {
    /// Leaves out faces with missing vertices, and removes references to missing texture
    /// coordinates and normals.
    pub(super) fn of(mut faces: Faces, totals: &[Totals; 3], before: &Before) -> Self {
        let Before { lines, ref parts, smoothing } = *before;
        for run in &mut faces.runs {
            (run.line, run.part) = (run.line.saturating_add(lines), parts[run.part as usize]);
            if run.smoothing == INHERITED {
                run.smoothing = smoothing;
            }
        }
        if let Some((line, _)) = &mut faces.refused {
            *line = line.saturating_add(lines);
        }
        // The fast check covers nearly all files; only the rest is checked face by face.
        let lists = &faces.corners;
        let sound = totals[0].holds(&lists.positions, false)
            && totals[1].holds(&lists.uvs, true)
            && totals[2].holds(&lists.normals, true);
        if sound { Self::of_sound(faces) } else { Self::mended(&faces, totals) }
    }

    /// Notes the faults of faces that all have valid indices.
    fn of_sound(faces: Faces) -> Self {
        let mut piece = Self { faces, ..Self::default() };
        let lists = &piece.faces.corners;
        let mut begin = 0;
        for (corners, line) in faces_of(&piece.faces.runs) {
            let face = begin..begin + corners;
            begin = face.end;
            if repeats(&lists.positions[face.clone()]) {
                piece.findings.note(FindingKind::FaceRepeats, line);
            }
            for (without, list) in piece.without.iter_mut().zip([&lists.uvs, &lists.normals]) {
                if let Some(own) = list.get(face.clone()) {
                    without.note(own.iter().filter(|i| **i == NONE).count(), line);
                }
            }
        }
        // An empty list means that every corner lacks the attribute.
        let all = Without {
            corners: lists.positions.len(),
            faces: piece.faces.runs.iter().map(|run| run.faces as usize).sum(),
            first: piece.faces.runs.first().map_or(0, |run| run.line),
        };
        for (without, list) in piece.without.iter_mut().zip([&lists.uvs, &lists.normals]) {
            if list.is_empty() {
                *without = all;
            }
        }
        piece
    }

    /// Checks the faces one by one.
    fn mended(faces: &Faces, totals: &[Totals; 3]) -> Self {
        let refused = faces.refused.clone();
        let mut piece = Self { faces: Faces { refused, ..Faces::default() }, ..Self::default() };
        let mut begin = 0;
        for run in &faces.runs {
            for line in run.line..run.line.saturating_add(run.faces) {
                let face = begin..begin + run.corners as usize;
                begin = face.end;
                let vertices = &faces.corners.positions[face.clone()];
                match fault(vertices, &totals[0]) {
                    Some((kind, reason)) => piece.refuse(kind, line, reason),
                    None => piece.add(&faces.corners, face, Run { line, ..*run }, totals),
                }
            }
        }
        piece
    }

    fn refuse(&mut self, kind: FindingKind, line: u32, reason: String) {
        self.findings.note(kind, line);
        match &self.faces.refused {
            Some((earlier, _)) if *earlier <= line => {}
            _ => self.faces.refused = Some((line, reason)),
        }
    }

    /// Adds a face with its indices converted to the kept rows, and notes its faults.
    fn add(
        &mut self,
        lists: &CornerLists,
        face: std::ops::Range<usize>,
        of: Run,
        totals: &[Totals; 3],
    ) {
        let [vertices, uvs, normals] = totals;
        let [mut wrong_uv, mut wrong_normal] = [false; 2];
        let [mut no_uv, mut no_normal] = [0; 2];
        let begin = self.faces.corners();
        for i in face {
            let corner = SourceCorner {
                position: vertices.place(lists.positions[i]).unwrap_or(NONE),
                uv: settled(lists.uv(i), uvs, &mut wrong_uv),
                normal: settled(lists.normal(i), normals, &mut wrong_normal),
            };
            no_uv += usize::from(corner.uv == NONE);
            no_normal += usize::from(corner.normal == NONE);
            self.faces.push(corner);
        }
        self.faces.end_face(Run { faces: 1, ..of });
        self.without[0].note(no_uv, of.line);
        self.without[1].note(no_normal, of.line);
        // Faults of attributes are noted, but do not cost the face.
        let odd = [
            (wrong_uv, FindingKind::UvRange),
            (wrong_normal, FindingKind::NormalRange),
            (repeats(&self.faces.corners.positions[begin..]), FindingKind::FaceRepeats),
        ];
        for (_, kind) in odd.into_iter().filter(|(odd, _)| *odd) {
            self.findings.note(kind, of.line);
        }
    }

    /// Joins the faces of all chunks. Their indices are valid for the kept rows, or [`NONE`].
    pub(super) fn joined(pieces: Vec<Self>, findings: &mut Findings) -> Faces {
        let mut all = Faces::default();
        let mut without = [Without::default(); 2];
        let [mut positions, mut uvs, mut normals] = [const { Vec::new() }; 3];
        for piece in pieces {
            // The line numbers already count from the start of the file.
            findings.append(piece.findings, 0);
            for (all, more) in without.iter_mut().zip(piece.without) {
                all.append(more);
            }
            let Faces { corners, mut runs, refused } = piece.faces;
            all.refused = all.refused.or(refused);
            all.runs.append(&mut runs);
            positions.push(corners.positions);
            uvs.push(corners.uvs);
            normals.push(corners.normals);
        }
        let lengths: Vec<usize> = positions.iter().map(Vec::len).collect();
        all.corners = CornerLists {
            positions: concatenated(positions),
            uvs: optional(uvs, &lengths),
            normals: optional(normals, &lengths),
        };
        // An attribute that all faces lack is not a fault.
        let kinds = [FindingKind::UvMixed, FindingKind::NormalMixed];
        for (without, kind) in without.into_iter().zip(kinds) {
            if without.corners < all.corners.positions.len() {
                findings.note_all(kind, without.faces, Some(without.first));
            }
        }
        all
    }
}

/// The attributes of faces, without their corners.
#[derive(Debug)]
pub(super) struct FaceRuns {
    runs: Vec<Run>,
    /// The number of faces up to the end of each run.
    ends: Vec<u32>,
}

impl FaceRuns {
    pub(super) fn of(runs: Vec<Run>) -> Self {
        let ends = runs.iter().scan(0_u32, |end, run| {
            *end = end.saturating_add(run.faces);
            Some(*end)
        });
        Self { ends: ends.collect(), runs }
    }

    /// Returns the line of a face.
    pub(super) fn line(&self, face: u32) -> u32 {
        let place = self.ends.partition_point(|end| *end <= face);
        let (run, end) = (self.runs[place], self.ends[place]);
        run.line.saturating_add(run.faces - (end - face))
    }

    /// Returns the number of corners of each face, in order.
    pub(super) fn arities(&self) -> Vec<u32> {
        self.by_face(|run| run.corners)
    }

    /// Returns the part of each face, in order.
    pub(super) fn parts(&self) -> Vec<u32> {
        self.by_face(|run| run.part)
    }

    /// Returns the smoothing group of each face, in order.
    pub(super) fn smoothing(&self) -> Vec<u32> {
        self.by_face(|run| run.smoothing)
    }

    fn by_face(&self, number: impl Fn(&Run) -> u32) -> Vec<u32> {
        let faces = self.ends.last().copied().unwrap_or(0) as usize;
        let mut numbers = Vec::with_capacity(faces);
        for run in &self.runs {
            numbers.resize(numbers.len() + run.faces as usize, number(run));
        }
        numbers
    }
}

/// Iterates over the faces of runs as corner count and line.
fn faces_of(runs: &[Run]) -> impl Iterator<Item = (usize, u32)> {
    let faces = |run: &Run| {
        let corners = run.corners as usize;
        (run.line..run.line.saturating_add(run.faces)).map(move |line| (corners, line))
    };
    runs.iter().flat_map(faces)
}

/// Concatenates lists with the given lengths. An empty list counts as all [`NONE`].
fn optional(mut lists: Vec<Vec<u32>>, lengths: &[usize]) -> Vec<u32> {
    if lists.iter().all(Vec::is_empty) {
        return Vec::new();
    }
    for (list, length) in lists.iter_mut().zip(lengths) {
        list.resize(*length, NONE);
    }
    concatenated(lists)
}

fn fault(face: &[u32], vertices: &Totals) -> Option<(FindingKind, String)> {
    let count = vertices.count;
    if let Some(wrong) = face.iter().find(|vertex| **vertex >= count) {
        let named = u64::from(*wrong) + 1;
        let reason = format!("a face refers to vertex {named}, but the file has {count} vertices");
        return Some((FindingKind::FaceRange, reason));
    }
    let lost = |vertex: &u32| vertices.place(*vertex).is_none();
    (!vertices.lost.is_empty() && face.iter().any(lost)).then(|| {
        let reason = "a face refers to a vertex that is infinite or NaN".to_owned();
        (FindingKind::FaceOnLostVertex, reason)
    })
}

/// Converts an index to the kept rows, or to [`NONE`].
fn settled(index: u32, totals: &Totals, wrong: &mut bool) -> u32 {
    let names = index < totals.count && index != WRONG;
    *wrong |= !names && index != NONE;
    if names { totals.place(index).unwrap_or(NONE) } else { NONE }
}

/// Returns whether a face refers to a vertex twice.
fn repeats(vertices: &[u32]) -> bool {
    match vertices {
        [a, b, c] => a == b || b == c || c == a,
        few if few.len() <= 8 => (1..few.len()).any(|i| few[..i].contains(&few[i])),
        many => {
            let mut many = many.to_vec();
            many.sort_unstable();
            many.windows(2).any(|two| two[0] == two[1])
        }
    }
}

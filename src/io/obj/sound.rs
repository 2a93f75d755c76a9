//! Which faces of a scan can be used, and what is odd about them.

use super::scan::{Faces, RawCorner, Scan, WRONG};
use crate::io::findings::{FindingKind, Findings};
use crate::scene::{NONE, SourceCorner};

/// Faces whose every index is in range or [`NONE`], counted among what is kept of the file.
#[derive(Debug, Default)]
pub(super) struct SoundFaces {
    pub(super) corners: Vec<SourceCorner>,
    pub(super) arities: Vec<u32>,
    pub(super) lines: Vec<u32>,
    pub(super) parts: Vec<u32>,
    /// The first face that cannot be used, with the reason.
    pub(super) refused: Option<(u32, String)>,
}

/// Leaves out faces whose vertices are not there, and takes from corners what is not there.
pub(super) fn sound_faces(scan: &mut Scan, findings: &mut Findings) -> SoundFaces {
    let faces = std::mem::take(&mut scan.faces);
    let mut sound = SoundFaces { refused: faces.refused.clone(), ..SoundFaces::default() };
    sound.corners.reserve(faces.corners.len());
    let mut begin = 0;
    for (i, &arity) in faces.arities.iter().enumerate() {
        let corners = &faces.corners[begin..begin + arity as usize];
        begin += arity as usize;
        if let Some((kind, reason)) = fault(corners, scan) {
            findings.note(kind, faces.lines[i]);
            let refused = (faces.lines[i], reason);
            match &sound.refused {
                Some(earlier) if earlier.0 <= refused.0 => {}
                _ => sound.refused = Some(refused),
            }
            continue;
        }
        sound.add(corners, i, &faces, scan, findings);
    }
    note_mixed(&sound, findings);
    sound
}

fn fault(corners: &[RawCorner], scan: &Scan) -> Option<(FindingKind, String)> {
    let count = scan.vertices.count;
    if let Some(wrong) = corners.iter().find(|corner| corner.vertex >= count) {
        let named = u64::from(wrong.vertex) + 1;
        let reason = format!("a face names vertex {named}, the file has {count}");
        return Some((FindingKind::FaceRange, reason));
    }
    let lost = |corner: &RawCorner| scan.vertices.place(corner.vertex).is_none();
    (!scan.vertices.lost.is_empty() && corners.iter().any(lost)).then(|| {
        let reason = "a face names a vertex that is not finite".to_owned();
        (FindingKind::FaceOnLostVertex, reason)
    })
}

impl SoundFaces {
    fn add(
        &mut self,
        corners: &[RawCorner],
        face: usize,
        faces: &Faces,
        scan: &Scan,
        findings: &mut Findings,
    ) {
        let line = faces.lines[face];
        let begin = self.corners.len();
        let [mut wrong_uv, mut wrong_normal] = [false; 2];
        for corner in corners {
            let within = |i: u32, count: u32, wrong: &mut bool| {
                *wrong |= i == WRONG || (i != NONE && i >= count);
                i < count
            };
            let uv = within(corner.uv, scan.uvs.count, &mut wrong_uv).then_some(corner.uv);
            let normal = within(corner.normal, scan.normals.count, &mut wrong_normal);
            let normal = normal.then_some(corner.normal);
            self.corners.push(SourceCorner {
                position: scan.vertices.place(corner.vertex).unwrap_or(NONE),
                uv: uv.and_then(|i| scan.uvs.place(i)).unwrap_or(NONE),
                normal: normal.and_then(|i| scan.normals.place(i)).unwrap_or(NONE),
            });
        }
        for (wrong, kind) in
            [(wrong_uv, FindingKind::UvRange), (wrong_normal, FindingKind::NormalRange)]
        {
            if wrong {
                findings.note(kind, line);
            }
        }
        if repeats(&self.corners[begin..]) {
            findings.note(FindingKind::FaceRepeats, line);
        }
        self.arities.push(faces.arities[face]);
        self.lines.push(line);
        self.parts.push(faces.parts[face]);
    }
}

/// Whether a face names a vertex twice.
fn repeats(corners: &[SourceCorner]) -> bool {
    if corners.len() <= 8 {
        let same = |i: usize| corners[..i].iter().any(|c| c.position == corners[i].position);
        return (1..corners.len()).any(same);
    }
    let mut vertices: Vec<u32> = corners.iter().map(|corner| corner.position).collect();
    vertices.sort_unstable();
    vertices.windows(2).any(|two| two[0] == two[1])
}

/// Notes the faces without places on the texture, and without normals, where others have them.
fn note_mixed(faces: &SoundFaces, findings: &mut Findings) {
    note_without(faces, FindingKind::UvMixed, |corner| corner.uv, findings);
    note_without(faces, FindingKind::NormalMixed, |corner| corner.normal, findings);
}

fn note_without(
    faces: &SoundFaces,
    kind: FindingKind,
    index: impl Fn(&SourceCorner) -> u32,
    findings: &mut Findings,
) {
    if faces.corners.iter().all(|corner| index(corner) == NONE) {
        return;
    }
    let mut begin = 0;
    for (arity, line) in faces.arities.iter().zip(&faces.lines) {
        let corners = &faces.corners[begin..begin + *arity as usize];
        begin += *arity as usize;
        if corners.iter().any(|corner| index(corner) == NONE) {
            findings.note(kind, *line);
        }
    }
}

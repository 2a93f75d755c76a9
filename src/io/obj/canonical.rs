//! What `tobj` is given to read: the file's vertices, places on the texture and normals as it wrote
//! them, then its faces by positive indices, one a line.
//!
//! `tobj` numbers vertices by their first use and forgets those that no face uses. So a first face
//! names all of them in their order, and everything keeps its number; that face is dropped again.
//! It also wants every corner to have a place on the texture and a normal where one corner has: a
//! last row of zeros stands for "none".

use std::io::{BufRead, Cursor, Read};

use super::scan::{Rows, Scan};
use super::sound::SoundFaces;
use crate::io::progress::Progress;
use crate::scene::{NONE, SourceCorner};

/// Numbers as `tobj` has read them, rows one after the other.
#[derive(Debug, Default)]
pub(super) struct Numbers {
    pub(super) positions: Vec<f32>,
    pub(super) uvs: Vec<f32>,
    pub(super) normals: Vec<f32>,
}

/// Has `tobj` read what a scan has found.
///
/// # Errors
/// With the reason where it reads anything else than was written; `None` where the work should end.
pub(super) fn through_tobj(
    scan: Scan,
    faces: &SoundFaces,
    progress: &Progress,
) -> Result<Numbers, Option<String>> {
    let counts = [&scan.vertices, &scan.uvs, &scan.normals].map(Rows::kept);
    let [vertices, mut uvs, mut normals] = [scan.vertices.text, scan.uvs.text, scan.normals.text];
    // The rows for "none".
    if counts[1] > 0 {
        uvs.extend_from_slice(b"vt 0 0\n");
    }
    if counts[2] > 0 {
        normals.extend_from_slice(b"vn 0 0 0\n");
    }
    let text = FaceText { counts, faces, face: 0, corner: 0, chunk: Vec::new(), at: 0, progress };
    let rows = Cursor::new(vertices).chain(Cursor::new(uvs)).chain(Cursor::new(normals));
    let mut text = rows.chain(text);

    // What is written here is what `tobj` reads rightly; should it yet panic, no window closes.
    let read = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
        let options = tobj::LoadOptions::default();
        tobj::load_obj_buf(&mut text, &options, |_| Ok((Vec::new(), Default::default())))
    }));
    if progress.is_cancelled() {
        return Err(None);
    }
    let (models, _) = read
        .map_err(|_panic| Some("the reader of OBJ files broke down on it".to_owned()))?
        .map_err(|error| Some(format!("the reader of OBJ files says: {error}")))?;
    let mesh = models.into_iter().next().map(|model| model.mesh).unwrap_or_default();
    checked(mesh, counts, faces).ok_or_else(|| {
        Some("the reader of OBJ files has read something else than the file says".to_owned())
    })
}

/// How many corners the first face has: enough to name everything.
fn first_face([vertices, uvs, normals]: [u32; 3]) -> u32 {
    let with_none = |count: u32| if count > 0 { count + 1 } else { 0 };
    vertices.max(with_none(uvs)).max(with_none(normals))
}

/// What `tobj` has read, where that is what was written.
fn checked(mesh: tobj::Mesh, counts: [u32; 3], faces: &SoundFaces) -> Option<Numbers> {
    let [vertices, uvs, normals] = counts.map(|count| count as usize);
    let first = first_face(counts) as usize;
    let with_none = |count: usize| if count > 0 { count + 1 } else { 0 };
    let same = |ours: fn(&SourceCorner) -> u32, none: usize, theirs: &[u32]| {
        let ours =
            faces.corners.iter().map(ours).map(|i| if i == NONE { none } else { i as usize });
        none == 0 || theirs.iter().skip(first).map(|i| *i as usize).eq(ours)
    };
    let right = mesh.positions.len() == 3 * vertices
        && mesh.texcoords.len() == 2 * with_none(uvs)
        && mesh.normals.len() == 3 * with_none(normals)
        && same(|corner| corner.position, vertices, &mesh.indices)
        && same(|corner| corner.uv, uvs, &mesh.texcoord_indices)
        && same(|corner| corner.normal, normals, &mesh.normal_indices)
        && mesh.positions.iter().all(|x| x.is_finite());
    right.then_some(Numbers {
        positions: mesh.positions,
        uvs: mesh.texcoords,
        normals: mesh.normals,
    })
}

/// The text of the faces, made as it is read.
struct FaceText<'a> {
    /// Vertices, places on the texture and normals, without the rows for "none".
    counts: [u32; 3],
    faces: &'a SoundFaces,
    /// The next face; 0 is the one that names everything.
    face: usize,
    /// Where its corners begin, or the next corner of the first face.
    corner: usize,
    chunk: Vec<u8>,
    at: usize,
    progress: &'a Progress,
}

impl FaceText<'_> {
    /// A corner by positive indices, with the rows of zeros for what it has not.
    fn write(&mut self, corner: SourceCorner) {
        let [_, uvs, normals] = self.counts;
        self.chunk.push(b' ');
        push_number(&mut self.chunk, corner.position + 1);
        if uvs > 0 || normals > 0 {
            self.chunk.push(b'/');
        }
        if uvs > 0 {
            push_number(&mut self.chunk, if corner.uv == NONE { uvs } else { corner.uv } + 1);
        }
        if normals > 0 {
            self.chunk.push(b'/');
            let normal = if corner.normal == NONE { normals } else { corner.normal };
            push_number(&mut self.chunk, normal + 1);
        }
    }

    /// More of the face that names everything in its order; past the end of a list, its last.
    fn write_first(&mut self) {
        let [vertices, uvs, normals] = self.counts;
        let corners = first_face(self.counts);
        if self.corner == 0 {
            self.chunk.push(b'f');
        }
        let begin = u32::try_from(self.corner).unwrap_or(corners);
        let end = corners.min(begin.saturating_add(4096));
        for i in begin..end {
            self.write(SourceCorner {
                position: i.min(vertices.saturating_sub(1)),
                uv: i.min(uvs),
                normal: i.min(normals),
            });
        }
        self.corner = end as usize;
        if end == corners {
            self.chunk.push(b'\n');
            (self.face, self.corner) = (1, 0);
        }
    }

    fn write_more(&mut self) {
        let all = self.faces.arities.len();
        let end = (self.face + 1024).min(all + 1);
        while self.face < end {
            self.chunk.push(b'f');
            let next = self.corner + self.faces.arities[self.face - 1] as usize;
            for i in self.corner..next {
                self.write(self.faces.corners[i]);
            }
            self.chunk.push(b'\n');
            (self.face, self.corner) = (self.face + 1, next);
        }
    }
}

impl BufRead for FaceText<'_> {
    fn fill_buf(&mut self) -> std::io::Result<&[u8]> {
        if self.at == self.chunk.len() {
            self.chunk.clear();
            self.at = 0;
            let all = self.faces.arities.len();
            if self.progress.reached(self.face, all + 1).is_err() {
                return Err(std::io::Error::other("cancelled"));
            }
            if self.face == 0 {
                self.write_first();
            } else if self.face <= all {
                self.write_more();
            }
        }
        Ok(&self.chunk[self.at..])
    }

    fn consume(&mut self, amount: usize) {
        self.at += amount;
    }
}

impl Read for FaceText<'_> {
    fn read(&mut self, target: &mut [u8]) -> std::io::Result<usize> {
        let read = self.fill_buf()?.read(target)?;
        self.consume(read);
        Ok(read)
    }
}

fn push_number(text: &mut Vec<u8>, number: u32) {
    let mut digits = [0; 10];
    let (mut at, mut rest) = (digits.len(), number);
    loop {
        at -= 1;
        digits[at] = b'0' + (rest % 10).to_le_bytes()[0];
        rest /= 10;
        if rest == 0 {
            break;
        }
    }
    text.extend_from_slice(&digits[at..]);
}

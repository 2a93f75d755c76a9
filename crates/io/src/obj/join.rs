//! Parses the chunks of a file in parallel, and joins them as if they had been parsed in order.
//!
//! Findings, errors and numbers do not depend on the chunk boundaries. Most files use positive
//! indices, so a chunk is parsed before the preceding statements are counted. If one of its faces
//! counts back, the chunk is parsed again when all counts are known.

use std::io::Read;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use rayon::prelude::*;

use super::chunks::{Chunks, Sizes};
use super::faces::{Faces, INHERITED};
use super::foreign::{EMPTY, no_obj};
use super::lines::{Lines, unmarked};
use super::parts::{NamedPart, Parts};
use super::piece::{Counts, Piece, Stop};
use super::rows::{NO_COLOR, Rows};
use super::sound::{Before, SoundPiece, Totals};
use super::strokes;
use crate::error::LoadError;
use crate::findings::{BYTES_ABOVE, FindingKind, Findings};
use crate::progress::{Cancelled, Progress};
use crate::read::MOST_MODEL_BYTES;
use marraztu_core::base::color::Color;
use marraztu_core::base::lists::concatenated;
use marraztu_core::scene::Stroke;

/// The most bytes in a statement.
const MOST_STATEMENT: usize = 256 << 20;

/// The least and the most bytes in a chunk: chunks fit into a core's own cache.
const CHUNK: [usize; 2] = [1 << 15, 1 << 18];

/// The most vertices, and the most corners of faces, in a file: 5 GB of mesh.
const MOST: usize = 100_000_000;

/// The parsed content of a file.
#[derive(Debug)]
pub(super) struct Content {
    pub(super) positions: Vec<[f64; 3]>,
    pub(super) uvs: Vec<[f32; 2]>,
    pub(super) normals: Vec<[f32; 3]>,
    /// Red, green and blue of the vertices, 0 to 1; empty if no vertex has a colour.
    pub(super) colors: Vec<[f32; 3]>,
    /// The number of vertices in the file, usable or not.
    pub(super) vertices: u32,
    /// The first unreadable vertex, with the reason.
    pub(super) refused: Option<(u32, String)>,
    pub(super) faces: Faces,
    pub(super) strokes: Vec<Stroke>,
    pub(super) parts: Vec<NamedPart>,
    /// Whether any statement `s` sets a smoothing group.
    pub(super) has_smoothing: bool,
    /// The arguments of `mtllib`, with their lines.
    pub(super) libraries: Vec<(u32, String)>,
    pub(super) edge_color: Option<Color>,
}

/// Parses all statements of a text. `size` is its size in bytes, or an estimate. Fails if the text
/// cannot be read, is not an OBJ file or is too long, if a line is invalid, or if the work is
/// cancelled.
pub(super) fn content(
    text: impl Read + Send,
    size: usize,
    file: &str,
    findings: &mut Findings,
    progress: &Progress,
) -> Result<Content, LoadError> {
    // Several chunks per thread balance the load.
    let chunk = (size / (4 * rayon::current_num_threads())).clamp(CHUNK[0], CHUNK[1]);
    let sizes = Sizes { chunk, statement: MOST_STATEMENT, text: MOST_MODEL_BYTES };
    let reading = Reading {
        chunks: Mutex::new(Chunks::new(text, file, sizes)),
        file,
        done: AtomicUsize::new(0),
        size,
        progress: progress.part(0.0, 0.8),
    };
    let content = joined(reading.pieces()?, file, findings)?;
    progress.reached(1, 1)?;
    Ok(content)
}

/// A text that all threads parse together.
struct Reading<'a, R> {
    chunks: Mutex<Chunks<'a, R>>,
    file: &'a str,
    done: AtomicUsize,
    size: usize,
    progress: Progress,
}

impl<'a, R: Read + Send> Reading<'a, R> {
    /// Parses all chunks.
    fn pieces(self) -> Result<Vec<Piece>, LoadError> {
        let threads = (0..rayon::current_num_threads()).into_par_iter();
        let own = |_| self.own_pieces().inspect_err(|_| self.chunks().stop());
        // Threads take chunks in any order, so the pieces are sorted afterwards.
        let own: Vec<Vec<(usize, Piece)>> = threads.map(own).collect::<Result<_, LoadError>>()?;
        let mut pieces: Vec<(usize, Piece)> = own.into_iter().flatten().collect();
        pieces.sort_unstable_by_key(|(number, _)| *number);
        let mut pieces: Vec<Piece> = pieces.into_iter().map(|(_, piece)| piece).collect();
        if pieces.is_empty() {
            return Err(LoadError::file(self.file, EMPTY));
        }
        self.count_back(&mut pieces)?;
        Ok(pieces)
    }

    /// Parses the chunks that one thread takes, with their indices.
    fn own_pieces(&self) -> Result<Vec<(usize, Piece)>, LoadError> {
        let mut own = Vec::new();
        let mut text = Vec::new();
        loop {
            let (number, whole) = {
                let mut chunks = self.chunks();
                let Some(number) = chunks.take(&mut text)? else { return Ok(own) };
                (number, chunks.ended())
            };
            let piece = if number == 0 {
                if let Some(reason) = no_obj(&text, whole) {
                    return Err(LoadError::file(self.file, reason));
                }
                self.piece(unmarked(&text), Some([0; 3]))?
            } else {
                self.piece(&text, None)?
            };
            match piece.stop {
                // The file will be rejected, so the other threads can stop.
                Some(Stop::Unread) => self.chunks().stop(),
                Some(Stop::CountsBack) => {
                    own.push((number, Piece { text: std::mem::take(&mut text), ..piece }));
                    continue;
                }
                None => {}
            }
            own.push((number, piece));
        }
    }

    /// Parses one chunk. `before` counts the preceding statements, if known.
    fn piece(&self, text: &[u8], before: Option<Counts>) -> Result<Piece, Cancelled> {
        let mut told = 0;
        let mut reached = |now: usize| {
            // A chunk that is parsed twice counts once.
            let new = now.saturating_sub(told);
            let before = self.done.fetch_add(new, Ordering::Relaxed);
            self.progress.reached(before + new, self.size)?;
            told += new;
            Ok(())
        };
        reached(0)?;
        let piece = Piece::read(text, before, &mut reached)?;
        reached(text.len())?;
        Ok(piece)
    }

    /// Parses chunks with negative indices again, now that all statements are counted.
    fn count_back(&self, pieces: &mut [Piece]) -> Result<(), Cancelled> {
        let counts_back = |piece: &Piece| matches!(piece.stop, Some(Stop::CountsBack));
        if !pieces.iter().any(counts_back) {
            return Ok(());
        }
        let count = |piece: &Piece| match piece.stop {
            Some(Stop::CountsBack) => counted(&piece.text),
            _ => [piece.vertices.count, piece.uvs.count, piece.normals.count],
        };
        // A prefix sum gives the statements before each chunk.
        let counts: Vec<Counts> = pieces.par_iter().map(count).collect();
        let before = counts.iter().scan([0_u32; 3], |sum, counts| {
            let before = *sum;
            *sum = std::array::from_fn(|i| before[i].saturating_add(counts[i]));
            Some(before)
        });
        let before: Vec<Counts> = before.collect();
        pieces.par_iter_mut().zip(before).try_for_each(|(piece, before)| {
            if counts_back(piece) {
                *piece = self.piece(&std::mem::take(&mut piece.text), Some(before))?;
            }
            Ok(())
        })
    }

    fn chunks(&self) -> MutexGuard<'_, Chunks<'a, R>> {
        self.chunks.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Counts the statements of each kind in a chunk.
fn counted(chunk: &[u8]) -> Counts {
    let mut counts = [0; 3];
    for line in Lines::within(chunk) {
        match line.statement().0 {
            b"v" => counts[0] += 1,
            b"vt" => counts[1] += 1,
            b"vn" => counts[2] += 1,
            _ => {}
        }
    }
    counts
}

fn joined(
    mut pieces: Vec<Piece>,
    file: &str,
    findings: &mut Findings,
) -> Result<Content, LoadError> {
    let mut parts = Parts::default();
    let mut libraries = Vec::new();
    let mut edge_color = None;
    let has_smoothing = pieces.iter().any(|piece| piece.smoothing != INHERITED);
    let mut befores = Vec::new();
    let mut lines = 0_u32;
    let mut smoothing = 0;
    let mut refused = None;
    // Line numbers and smoothing groups continue from chunk to chunk.
    for piece in &mut pieces {
        if piece.stop == Some(Stop::Unread) {
            let reason = "the numbers from here on cannot be read";
            return Err(LoadError::line(file, lines.saturating_add(1), reason));
        }
        let at_line = |(line, reason)| (lines.saturating_add(line), reason);
        refused = refused.or(piece.refused.take().map(at_line));
        let named = std::mem::take(&mut piece.libraries).into_iter();
        libraries.extend(named.map(|(line, name)| (lines.saturating_add(line), name)));
        edge_color = edge_color.or(piece.edge_color);
        let places = parts.append(&piece.parts, lines);
        befores.push(Before { lines, parts: places, smoothing });
        if piece.smoothing != INHERITED {
            smoothing = piece.smoothing;
        }
        findings.append(std::mem::take(&mut piece.findings), lines);
        lines = lines.saturating_add(piece.lines);
    }
    // Check the totals before large lists are allocated.
    let count = |length: fn(&Piece) -> usize| pieces.iter().map(length).sum();
    let counts: [(&str, usize); 2] = [
        ("vertices", count(|piece| piece.vertices.kept.len())),
        ("corners of faces", count(|piece| piece.faces.corners())),
    ];
    if let Some(reason) = counts.into_iter().find_map(|(what, count)| too_many(what, count)) {
        return Err(LoadError::file(file, reason));
    }
    let colors = complete_colors(&mut pieces, findings);
    let (positions, vertices) = all_rows(&mut pieces, |piece| &mut piece.vertices);
    let (uvs, uv_totals) = all_rows(&mut pieces, |piece| &mut piece.uvs);
    let (normals, normal_totals) = all_rows(&mut pieces, |piece| &mut piece.normals);

    let count = vertices.count;
    let totals = [vertices, uv_totals, normal_totals];
    let strokes = strokes::sound(&mut pieces, &befores, &totals[0], findings);
    let sound = |(piece, before): (Piece, Before)| SoundPiece::of(piece.faces, &totals, &before);
    let sound: Vec<SoundPiece> = pieces.into_par_iter().zip(befores).map(sound).collect();
    let faces = SoundPiece::joined(sound, findings);
    let parts = parts.list;
    let vertices = count;
    Ok(Content {
        positions,
        uvs,
        normals,
        colors,
        vertices,
        refused,
        faces,
        strokes,
        parts,
        has_smoothing,
        libraries,
        edge_color,
    })
}

/// Returns the reason to reject a count: a corner takes about 50 bytes with all derived data.
fn too_many(what: &str, count: usize) -> Option<String> {
    (count > MOST).then(|| {
        let [count, most] = [count, MOST].map(|n| n / 1_000_000);
        format!("the file has {count} million {what}; the limit is {most} million")
    })
}

/// Joins the rows of all pieces; returns them with the total count and the lost rows.
fn all_rows<const N: usize, T: Copy + Send + Sync>(
    pieces: &mut [Piece],
    rows: impl Fn(&mut Piece) -> &mut Rows<N, T>,
) -> (Vec<[T; N]>, Totals) {
    let mut totals = Totals { count: 0, lost: Vec::new() };
    let mut kept = Vec::new();
    for piece in pieces {
        let rows = rows(piece);
        totals.lost.extend(rows.lost.iter().map(|i| i.saturating_add(totals.count)));
        totals.count = totals.count.saturating_add(rows.count);
        kept.push(std::mem::take(&mut rows.kept));
    }
    (concatenated(kept), totals)
}

/// Joins the colours of all vertices, from 0 to 1; a vertex without a colour is white.
fn complete_colors(pieces: &mut [Piece], findings: &mut Findings) -> Vec<[f32; 3]> {
    if pieces.iter().all(|piece| piece.vertices.colors.is_empty()) {
        return Vec::new();
    }
    let mut colors = Vec::new();
    for piece in pieces {
        // A piece has colours for all of its vertices, or for none.
        let all = colors.len() + piece.vertices.kept.len();
        colors.append(&mut piece.vertices.colors);
        colors.resize(all, NO_COLOR);
    }
    // Colours may be bytes or fractions; the file as a whole decides.
    let numbers = || colors.as_flattened().iter().filter(|x| x.is_finite());
    let are_bytes =
        numbers().any(|x| f64::from(*x) > BYTES_ABOVE) && numbers().all(|x| x.fract() == 0.0);
    // A rounding error above 1 is not worth reporting.
    let brighter = numbers().filter(|x| **x > 1.01).count();
    match (are_bytes, brighter) {
        (true, _) => findings.add(FindingKind::ColorBytes, "", None),
        (false, 0) => {}
        (false, _) => findings.add(FindingKind::ColorBright, "", None),
    }
    let unit = if are_bytes { 255.0 } else { 1.0 };
    for color in &mut colors {
        if color.iter().all(|x| x.is_finite()) {
            *color = color.map(|x| (x / unit).clamp(0.0, 1.0));
        } else {
            findings.add(FindingKind::ColorPartly, "", None);
            *color = [1.0; 3];
        }
    }
    colors
}

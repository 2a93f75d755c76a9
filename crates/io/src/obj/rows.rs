//! The numbers of `v`, `vt` and `vn`, parsed by tobj.
//!
//! tobj returns only rows that faces refer to, in the order of reference. The lines of one kind are
//! therefore passed to it with polygons in between, and each polygon refers to the lines since the
//! last one. All rows come back in file order, used or not. tobj reads its text line by line,
//! directly from the chunk.
//!
//! tobj parses numbers as f64. Positions stay in f64 until the offset of the mesh is known; texture
//! coordinates and normals are rounded to f32.

use std::fmt::Write;
use std::io::{BufRead, ErrorKind, Read};
use std::mem::take;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// The most rows per polygon. tobj looks up each row in a hash table; this number fills one with
/// 512 slots, at its maximum load of 7/8.
const POLYGON: usize = 448;

/// A statement with a row of numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum RowKind {
    Vertex,
    Uv,
    Normal,
}

/// A number in the precision of a row.
pub(super) trait Number: Copy + Send + Sync + Into<f64> {
    /// Rounds `x` to the nearest number.
    fn nearest(x: f64) -> Self;
}

impl Number for f32 {
    #[expect(clippy::cast_possible_truncation, reason = "the rounding that is meant")]
    fn nearest(x: f64) -> Self {
        x as Self
    }
}

impl Number for f64 {
    fn nearest(x: f64) -> Self {
        x
    }
}

/// The statements of one kind in a chunk, each with `N` numbers.
#[derive(Debug)]
pub(super) struct Rows<const N: usize, T> {
    kind: RowKind,
    /// The lines for tobj.
    lines: Vec<RowLine>,
    /// The text of lines that tobj does not get unchanged from the chunk.
    rewritten: String,
    /// The finite rows, after tobj has parsed them.
    pub(super) kept: Vec<[T; N]>,
    /// The vertex colours: NaN for a vertex without one, empty if no vertex has one.
    pub(super) colors: Vec<[f32; 3]>,
    /// The number of statements, finite or not.
    pub(super) count: u32,
    /// The statements that are not finite or not readable, ascending.
    pub(super) lost: Vec<u32>,
}

/// The range of a line in its text.
#[derive(Clone, Copy, Debug)]
struct RowLine {
    begin: u32,
    end: u32,
    is_rewritten: bool,
    is_colored: bool,
}

impl<const N: usize, T: Number> Rows<N, T> {
    pub(super) fn new(kind: RowKind) -> Self {
        Self {
            kind,
            lines: Vec::new(),
            rewritten: String::new(),
            kept: Vec::new(),
            colors: Vec::new(),
            count: 0,
            lost: Vec::new(),
        }
    }

    /// Adds a line, given by its range in the chunk. tobj must parse it just as the tolerant path
    /// would.
    #[inline]
    pub(super) fn add_line(&mut self, begin: usize, end: usize, is_colored: bool) {
        self.push(begin, end, false, is_colored);
    }

    /// Adds a parsed row if it is finite; returns whether it is.
    pub(super) fn add(&mut self, row: [f64; N], color: Option<[f64; 3]>) -> bool {
        if !row.iter().all(is_finite) {
            self.lose();
            return false;
        }
        let begin = self.rewritten.len();
        self.rewritten += match self.kind {
            RowKind::Vertex => "v",
            RowKind::Uv => "vt",
            RowKind::Normal => "vn",
        };
        for number in row.iter().chain(color.iter().flatten()) {
            // The shortest text of an f64 converts back to the same value.
            let _infallible = write!(self.rewritten, " {number:e}");
        }
        self.push(begin, self.rewritten.len(), true, color.is_some());
        true
    }

    /// Counts an unusable row.
    pub(super) fn lose(&mut self) {
        self.lost.push(self.count);
        self.count = self.count.saturating_add(1);
    }

    #[inline]
    fn push(&mut self, begin: usize, end: usize, is_rewritten: bool, is_colored: bool) {
        // Chunks are far smaller than 4 GB.
        let [begin, end] = [begin, end].map(|place| u32::try_from(place).unwrap_or(u32::MAX));
        self.lines.push(RowLine { begin, end, is_rewritten, is_colored });
        // A saturated count exceeds the limit of a mesh, which will report it.
        self.count = self.count.saturating_add(1);
    }

    /// Builds a polygon that refers to the last `count` rows.
    fn polygon(&self, count: usize) -> String {
        let mut polygon = "f".to_owned();
        for back in (1..=count).rev() {
            let _infallible = match self.kind {
                RowKind::Vertex => write!(polygon, " -{back}"),
                RowKind::Uv => write!(polygon, " 1/-{back}"),
                RowKind::Normal => write!(polygon, " 1//-{back}"),
            };
        }
        polygon
    }

    /// Lets tobj parse the lines; returns whether it succeeded.
    pub(super) fn read(&mut self, chunk: &[u8]) -> bool {
        // Taken out, so their memory is freed on return.
        let (lines, rewritten) = (take(&mut self.lines), take(&mut self.rewritten));
        if lines.is_empty() {
            return true;
        }
        let has_colors = lines.iter().any(|line| line.is_colored);
        let polygon = self.polygon(lines.len().min(POLYGON));
        // tobj needs a vertex in every face, even if only texture coordinates or normals count.
        let mut text = RowText {
            chunk,
            rewritten: rewritten.as_bytes(),
            lines: lines.iter(),
            needs_vertex: self.kind != RowKind::Vertex,
            has_colors,
            polygon: &polygon,
            unnamed: 0,
            ends_group: false,
        };
        let options = tobj::LoadOptions::default();
        let no_library = |_: &std::path::Path| Err(tobj::LoadError::OpenFileFailed);
        let read = || tobj::load_obj_buf(&mut text, &options, no_library);
        // tobj panics on some malformed numbers.
        let Ok(Ok((models, _))) = catch_unwind(AssertUnwindSafe(read)) else { return false };
        self.kept.reserve(lines.len());
        for tobj::Model { mesh, .. } in &models {
            let numbers = match self.kind {
                RowKind::Vertex => &mesh.positions,
                RowKind::Uv => &mesh.texcoords,
                RowKind::Normal => &mesh.normals,
            };
            append(&mut self.kept, numbers);
            append(&mut self.colors, &mesh.vertex_color);
        }
        let finite = self.kept.as_flattened().iter().all(|x| is_finite(&(*x).into()));
        // tobj silently skips colours that it cannot parse.
        let colors = if has_colors { lines.len() } else { 0 };
        finite && self.kept.len() == lines.len() && self.colors.len() == colors
    }
}

/// The lines of one kind with the polygons that refer to them, produced on demand.
struct RowText<'a> {
    chunk: &'a [u8],
    rewritten: &'a [u8],
    lines: std::slice::Iter<'a, RowLine>,
    /// Whether to emit a vertex first, which every face needs.
    needs_vertex: bool,
    has_colors: bool,
    /// The polygon that refers to the most rows.
    polygon: &'a str,
    /// The number of lines since the last polygon.
    unnamed: usize,
    ends_group: bool,
}

impl BufRead for RowText<'_> {
    fn read_line(&mut self, text: &mut String) -> std::io::Result<usize> {
        let before = text.len();
        if take(&mut self.needs_vertex) {
            text.push_str("v 0 0 0");
        } else if take(&mut self.ends_group) {
            // tobj starts a new mesh at each group, and clears its hash table.
            text.push('g');
        } else if self.unnamed < POLYGON
            && let Some(line) = self.lines.next()
        {
            let source = if line.is_rewritten { self.rewritten } else { self.chunk };
            let bytes = source.get(line.begin as usize..line.end as usize).unwrap_or_default();
            let no_text = |error| std::io::Error::new(ErrorKind::InvalidData, error);
            text.push_str(std::str::from_utf8(bytes).map_err(no_text)?);
            if self.has_colors && !line.is_colored {
                // tobj wants colours on all vertices or on none, so NaN marks missing ones.
                text.push_str(" NaN NaN NaN");
            }
            self.unnamed += 1;
        } else if self.unnamed > 0 {
            // The last corners of the polygon refer to the last rows.
            let mut corners = self.polygon.rmatch_indices(' ');
            let first = match self.unnamed {
                POLYGON => None,
                few => corners.nth(few - 1),
            };
            text.push('f');
            text.push_str(&self.polygon[first.map_or(1, |(place, _)| place)..]);
            self.unnamed = 0;
            self.ends_group = true;
        }
        Ok(text.len() - before)
    }

    fn fill_buf(&mut self) -> std::io::Result<&[u8]> {
        Err(ErrorKind::Unsupported.into())
    }

    fn consume(&mut self, _: usize) {}
}

impl Read for RowText<'_> {
    fn read(&mut self, _: &mut [u8]) -> std::io::Result<usize> {
        Err(ErrorKind::Unsupported.into())
    }
}

/// The colour of a vertex without one, if others have colours.
pub(super) const NO_COLOR: [f32; 3] = [f32::NAN; 3];

/// Returns whether a number is finite as f32, too: larger ones cannot be drawn.
fn is_finite(x: &f64) -> bool {
    f32::nearest(*x).is_finite()
}

fn append<const N: usize, T: Number>(rows: &mut Vec<[T; N]>, numbers: &[f64]) {
    let (numbers, _) = numbers.as_chunks::<N>();
    rows.extend(numbers.iter().map(|row| row.map(T::nearest)));
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Parses lines with tobj; `None` if its result is unreliable.
    fn read<const N: usize>(kind: RowKind, lines: &[String]) -> Option<Rows<N, f64>> {
        let mut rows = Rows::new(kind);
        let mut chunk = String::new();
        for line in lines {
            let begin = chunk.len();
            chunk += line;
            rows.add_line(begin, chunk.len(), line.split_whitespace().count() > 4);
        }
        rows.read(chunk.as_bytes()).then_some(rows)
    }

    #[test]
    fn rows_come_back_in_their_order_however_many_there_are() {
        for count in [0, 1, 2, 3, 4, POLYGON - 1, POLYGON, POLYGON + 1, 3 * POLYGON + 5] {
            let lines = |keyword| -> Vec<String> {
                (0..count).map(|i| format!("{keyword} {i} {} 0.5", i % 2)).collect()
            };
            let right = |i: usize| [i as f64, (i % 2) as f64, 0.5];
            let right: Vec<[f64; 3]> = (0..count).map(right).collect();
            assert_eq!(read(RowKind::Vertex, &lines("v")).unwrap().kept, right);
            assert_eq!(read(RowKind::Normal, &lines("vn")).unwrap().kept, right);
            let right: Vec<[f64; 2]> = right.iter().map(|[u, v, _]| [*u, *v]).collect();
            assert_eq!(read(RowKind::Uv, &lines("vt")).unwrap().kept, right);
        }
    }

    #[test]
    fn vertices_keep_their_own_colours_wherever_they_begin() {
        for begin in [0, 1, POLYGON - 1, POLYGON, 2 * POLYGON + 7] {
            let line = |i: usize| {
                if i < begin || i % 3 == 1 {
                    format!("v {i} 0 0")
                } else {
                    format!("v {i} 0 0 .5 0 {i}")
                }
            };
            let lines: Vec<String> = (0..begin + 100).map(line).collect();
            let rows = read::<3>(RowKind::Vertex, &lines).unwrap();
            for (i, (position, color)) in rows.kept.iter().zip(&rows.colors).enumerate() {
                assert_eq!(*position, [i as f64, 0.0, 0.0]);
                if i < begin || i % 3 == 1 {
                    assert!(color.iter().all(|x| x.is_nan()), "{i}");
                } else {
                    assert_eq!(*color, [0.5, 0.0, i as f32]);
                }
            }
            assert_eq!([rows.kept.len(), rows.colors.len()], [lines.len(); 2]);
        }
    }

    #[test]
    fn lines_that_tobj_refuses_or_that_are_not_finite_are_left_to_the_tolerant_way() {
        for bad in ["v 1 2 --3", "v 1 2 1e", "v 1 2 1e39", "v 1 2 3 .5 .5 1..", "v 1 2", "w 1 2 3"]
        {
            let lines = ["v 1 2 3 0 0 0".to_owned(), bad.to_owned()];
            assert!(read::<3>(RowKind::Vertex, &lines).is_none(), "{bad}");
        }
        assert!(read::<3>(RowKind::Vertex, &["v 1 2 3 . 0 0".to_owned()]).is_none());
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        #[test]
        fn every_number_is_the_nearest_one(
            text in "[-+]?[0-9]{1,12}(\\.[0-9]{0,12})?(e[-+]?[0-9]{1,2})?",
        ) {
            nearest(&text);
        }
    }

    /// Compares tobj's number with the standard library's.
    fn nearest(text: &str) {
        let right: f64 = text.parse().unwrap();
        match read::<3>(RowKind::Vertex, &[format!("v {text} 0 0")]) {
            Some(rows) => assert_eq!(rows.kept[0][0].to_bits(), right.to_bits(), "{text}"),
            None => assert!(!is_finite(&right), "{text}"),
        }
    }

    #[test]
    fn a_number_that_is_read_already_stays_itself() {
        for bits in [0, 1, 0x8000_0001, 0x007f_ffff, 0x3dcc_cccd, 0x7f7f_ffff, 0x8000_0000] {
            let mut rows = Rows::<3, f32>::new(RowKind::Vertex);
            assert!(rows.add([f64::from(f32::from_bits(bits)), 0.0, 1.0], None));
            assert!(rows.read(b""));
            assert_eq!(rows.kept[0][0].to_bits(), bits);
        }
    }
}

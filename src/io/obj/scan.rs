//! One pass over the bytes of an OBJ file: what its statements say.
//!
//! Numbers are checked here, and their text is kept as the file writes it, for `tobj` to read.
//! Indices are resolved here, for a negative one counts back from where it stands; whether a
//! positive one is in range is known only at the end.

use super::lines::{Line, Lines, decode, number, words};
use super::parts::Parts;
use crate::base::color::{Color, byte};
use crate::io::error::LoadError;
use crate::io::findings::{FindingKind, Findings};
use crate::io::progress::Progress;
use crate::scene::NONE;

/// An index that counts back past the beginning of the file, or is 0.
pub(super) const WRONG: u32 = NONE - 1;

/// Everything that the statements of a file say.
#[derive(Debug, Default)]
pub(super) struct Scan {
    pub(super) vertices: Rows,
    pub(super) uvs: Rows,
    pub(super) normals: Rows,
    /// Red, green and blue of the vertices that are kept, from the first one that has a colour;
    /// NaN where a vertex has none. Empty where none has one.
    pub(super) colors: Vec<[f32; 3]>,
    pub(super) faces: Faces,
    pub(super) parts: Parts,
    /// What follows `mtllib`, with its lines.
    pub(super) libraries: Vec<(u32, String)>,
    pub(super) edge_color: Option<Color>,
}

/// Statements of numbers, as text that `tobj` reads, one a line.
#[derive(Debug, Default)]
pub(super) struct Rows {
    pub(super) text: Vec<u8>,
    /// Statements, whether kept or not.
    pub(super) count: u32,
    /// Those that are not finite, and not in the text; ascending.
    pub(super) lost: Vec<u32>,
}

impl Rows {
    /// Statements that are kept.
    #[expect(clippy::cast_possible_truncation, reason = "no more are lost than there are")]
    pub(super) fn kept(&self) -> u32 {
        self.count - self.lost.len() as u32
    }

    /// Where statement `i` stands among those that are kept; `None` where it is lost.
    #[expect(clippy::cast_possible_truncation, reason = "no more are lost than there are")]
    pub(super) fn place(&self, i: u32) -> Option<u32> {
        match self.lost.binary_search(&i) {
            Ok(_) => None,
            Err(before) => Some(i - before as u32),
        }
    }
}

/// A corner as the file names it, counted from 0, or [`NONE`], or [`WRONG`].
#[derive(Clone, Copy, Debug)]
pub(super) struct RawCorner {
    pub(super) vertex: u32,
    pub(super) uv: u32,
    pub(super) normal: u32,
}

/// Faces of three corners and more.
#[derive(Debug, Default)]
pub(super) struct Faces {
    pub(super) corners: Vec<RawCorner>,
    pub(super) arities: Vec<u32>,
    pub(super) lines: Vec<u32>,
    pub(super) parts: Vec<u32>,
    /// The first face statement that cannot be used, with the reason.
    pub(super) refused: Option<(u32, String)>,
}

/// Reads all statements.
///
/// # Errors
/// Where a number cannot be read, or the work should end.
pub(super) fn scan(
    bytes: &[u8],
    file: &str,
    findings: &mut Findings,
    progress: &Progress,
) -> Result<Scan, LoadError> {
    let mut scan = Scan::default();
    let mut lines = Lines::new(bytes);
    let mut count = 0_u32;
    while let Some(line) = lines.next() {
        count = count.wrapping_add(1);
        if count.is_multiple_of(4096) {
            let (done, all) = lines.position();
            progress.reached(done, all)?;
        }
        scan.statement(&line, findings)
            .map_err(|reason| LoadError::line(file, line.number, reason))?;
    }
    scan.complete_colors(findings);
    Ok(scan)
}

impl Scan {
    fn statement(&mut self, line: &Line<'_>, findings: &mut Findings) -> Result<(), String> {
        let (keyword, rest) = line.statement();
        match keyword {
            b"v" => return self.vertex(rest, line.number, findings),
            b"vt" => return self.uv(rest, line.number, findings),
            b"vn" => return self.normal(rest, line.number, findings),
            b"f" | b"fo" => self.face(rest, line.number, findings),
            b"o" => self.parts.rename(|now| {
                (now.object, now.group) = (Some(line.name()), None);
            }),
            b"g" => self.parts.rename(|now| now.group = Some(line.name())),
            b"usemtl" => self.parts.rename(|now| {
                (now.material, now.line) = (Some(line.name()), line.number);
            }),
            b"mtllib" => self.libraries.push((line.number, line.name())),
            b"c" if self.edge_color(rest) => {}
            b"l" | b"p" => {
                findings.add(FindingKind::LineOrPoint, &decode(keyword), Some(line.number));
            }
            b"s" | b"mg" | b"bevel" | b"c_interp" | b"d_interp" | b"lod" | b"usemap"
            | b"maplib" | b"shadow_obj" | b"trace_obj" | b"t" => {}
            b"vp" | b"cstype" | b"deg" | b"bmat" | b"step" | b"curv" | b"curv2" | b"surf"
            | b"parm" | b"trim" | b"hole" | b"scrv" | b"sp" | b"end" | b"con" | b"ctech"
            | b"stech" => {
                findings.note(FindingKind::FreeForm, line.number);
            }
            _ if keyword.starts_with(b"#") => self.comment(keyword, rest),
            _ => {
                let name: String = decode(keyword).chars().take(24).collect();
                findings.add(FindingKind::Unknown, &name, Some(line.number));
            }
        }
        Ok(())
    }

    /// `v x y z`, `v x y z w`, `v x y z r g b` and `v x y z r g b a`.
    fn vertex(&mut self, rest: &[u8], line: u32, findings: &mut Findings) -> Result<(), String> {
        let row = row::<7>(rest)?;
        if row.count < 3 {
            return Err(format!("a vertex needs three numbers, here are {}", row.count));
        }
        match row.count {
            4 if row.values[3] != 1.0 => findings.note(FindingKind::Weight, line),
            5 | 8.. => findings.note(FindingKind::ExtraNumbers, line),
            _ => {}
        }
        let color =
            matches!(row.count, 6 | 7).then(|| [row.values[3], row.values[4], row.values[5]]);
        let vertices = &mut self.vertices;
        if vertices.add(b"v", &row, 3)? {
            let kept = vertices.kept() as usize;
            if color.is_some() || !self.colors.is_empty() {
                self.colors.resize(kept - 1, [f32::NAN; 3]);
                self.colors.push(color.unwrap_or([f32::NAN; 3]));
            }
        } else {
            findings.note(FindingKind::VertexNotFinite, line);
        }
        Ok(())
    }

    /// `vt u`, `vt u v` and `vt u v w`.
    fn uv(&mut self, rest: &[u8], line: u32, findings: &mut Findings) -> Result<(), String> {
        let mut row = row::<3>(rest)?;
        match row.count {
            0 => return Err("a place on the texture needs two numbers, here is none".to_owned()),
            1 => {
                findings.note(FindingKind::UvSingle, line);
                (row.texts[1], row.values[1]) = (b"0", 0.0);
            }
            _ => {}
        }
        if !self.uvs.add(b"vt", &row, 2)? {
            findings.note(FindingKind::UvNotFinite, line);
        }
        Ok(())
    }

    /// `vn x y z`.
    fn normal(&mut self, rest: &[u8], line: u32, findings: &mut Findings) -> Result<(), String> {
        let row = row::<3>(rest)?;
        if row.count < 3 {
            return Err(format!("a normal needs three numbers, here are {}", row.count));
        }
        if !self.normals.add(b"vn", &row, 3)? {
            findings.note(FindingKind::NormalNotFinite, line);
        }
        Ok(())
    }

    fn face(&mut self, rest: &[u8], line: u32, findings: &mut Findings) {
        let faces = &mut self.faces;
        let begin = faces.corners.len();
        let counts = [self.vertices.count, self.uvs.count, self.normals.count];
        let mut fault = None;
        for word in words(rest) {
            // A comment may follow a number at once.
            let (word, comment) = match word.iter().position(|b| *b == b'#') {
                Some(end) => (&word[..end], true),
                None => (word, false),
            };
            match corner(word, counts) {
                Some(corner) if corner.vertex == WRONG => {
                    let reason = format!("a face names vertex {}", decode(word));
                    fault.get_or_insert((FindingKind::FaceRange, String::new(), reason));
                }
                Some(corner) => faces.corners.push(corner),
                None => {
                    let text = decode(word);
                    let reason = format!("\"{text}\" is no corner of a face");
                    fault.get_or_insert((FindingKind::FaceUnreadable, text, reason));
                }
            }
            if comment {
                break;
            }
        }
        let corners = faces.corners.len() - begin;
        if fault.is_none() && corners < 3 {
            let reason = format!("a face needs three corners or more, here are {corners}");
            fault = Some((FindingKind::FaceShort, String::new(), reason));
        }
        if let Some((kind, name, reason)) = fault {
            findings.add(kind, &name, Some(line));
            faces.refused.get_or_insert((line, reason));
            faces.corners.truncate(begin);
            return;
        }
        faces.arities.push(u32::try_from(corners).unwrap_or(NONE));
        faces.lines.push(line);
        faces.parts.push(self.parts.place());
    }

    /// `# color r g b`.
    fn comment(&mut self, keyword: &[u8], rest: &[u8]) {
        if self.edge_color.is_some() {
            return;
        }
        let color = match keyword {
            b"#" => rest.strip_prefix(b"color").or_else(|| rest.strip_prefix(b"colour")),
            b"#color" | b"#colour" => Some(rest),
            _ => None,
        };
        if let Some(color) = color {
            self.edge_color(color);
        }
    }

    /// Takes `r g b`, 0 to 255, as the colour of edges, where it is that and the first.
    fn edge_color(&mut self, rest: &[u8]) -> bool {
        match row::<3>(rest) {
            Ok(row) if row.count == 3 && row.values.iter().all(|x| x.is_finite()) => {
                let color = Color(row.values.map(|x| byte(f64::from(x) / 255.0)));
                self.edge_color.get_or_insert(color);
                true
            }
            _ => false,
        }
    }

    /// White for vertices without a colour; 0 to 1 for colours of 0 to 255.
    fn complete_colors(&mut self, findings: &mut Findings) {
        if self.colors.is_empty() {
            return;
        }
        self.colors.resize(self.vertices.kept() as usize, [f32::NAN; 3]);
        let largest = self.colors.iter().flatten().fold(0.0, |a: f32, b| a.max(*b));
        // A rounding error above 1 makes no byte of it.
        let unit = if largest > 1.01 { 255.0 } else { 1.0 };
        if unit > 1.0 {
            findings.add(FindingKind::ColorBytes, "", None);
        }
        for color in &mut self.colors {
            if color.iter().all(|x| x.is_finite()) {
                *color = color.map(|x| (x / unit).clamp(0.0, 1.0));
            } else {
                findings.add(FindingKind::ColorPartly, "", None);
                *color = [1.0; 3];
            }
        }
    }
}

/// The numbers of a statement: at most `N` of them are kept.
struct Row<'a, const N: usize> {
    values: [f32; N],
    texts: [&'a [u8]; N],
    /// How many there are.
    count: usize,
}

fn row<const N: usize>(rest: &[u8]) -> Result<Row<'_, N>, String> {
    let mut row = Row { values: [0.0; N], texts: [&b""[..]; N], count: 0 };
    for word in words(rest) {
        let (value, text) = number(word).map_err(|fault| fault.0)?;
        if row.count < N {
            (row.values[row.count], row.texts[row.count]) = (value, text);
        }
        row.count += 1;
        if text.len() < word.len() {
            break;
        }
    }
    Ok(row)
}

impl Rows {
    /// Adds the first `needed` numbers of a row, where they are finite; says whether they are.
    fn add<const N: usize>(
        &mut self,
        keyword: &[u8],
        row: &Row<'_, N>,
        needed: usize,
    ) -> Result<bool, String> {
        if self.count >= WRONG - 2 {
            return Err("there are more of these than can be numbered".to_owned());
        }
        self.count += 1;
        if !row.values[..needed].iter().all(|x| x.is_finite()) {
            self.lost.push(self.count - 1);
            return Ok(false);
        }
        self.text.extend_from_slice(keyword);
        for text in &row.texts[..needed] {
            self.text.push(b' ');
            self.text.extend_from_slice(text);
        }
        self.text.push(b'\n');
        Ok(true)
    }
}

/// A corner `v`, `v/vt`, `v//vn` or `v/vt/vn`; `None` where it is no such thing.
fn corner(word: &[u8], counts: [u32; 3]) -> Option<RawCorner> {
    let mut places = [NONE; 3];
    for (i, part) in word.split(|b| *b == b'/').enumerate() {
        if i == 3 {
            return None;
        }
        if !part.is_empty() {
            places[i] = index(part, counts[i])?;
        }
    }
    let [vertex, uv, normal] = places;
    (vertex != NONE).then_some(RawCorner { vertex, uv, normal })
}

/// An index counted from 0: positive ones count from 1, negative ones back from `count`.
fn index(digits: &[u8], count: u32) -> Option<u32> {
    let (back, digits) = match digits {
        [b'-', rest @ ..] => (true, rest),
        [b'+', rest @ ..] => (false, rest),
        _ => (false, digits),
    };
    if digits.is_empty() {
        return None;
    }
    let value = digits.iter().try_fold(0_u64, |value, digit| {
        let digit = digit.is_ascii_digit().then(|| digit - b'0')?;
        // Whatever is beyond 32 bits is as wrong as anything else there.
        Some((value * 10 + u64::from(digit)).min(u64::from(u32::MAX)))
    })?;
    let value = u32::try_from(value).unwrap_or(u32::MAX);
    let place =
        if back { count.checked_sub(value).filter(|_| value > 0) } else { value.checked_sub(1) };
    Some(place.map_or(WRONG, |place| place.min(WRONG)))
}

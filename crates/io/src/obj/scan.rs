//! Parses the statements of a chunk of an OBJ file.
//!
//! Chunks are parsed independently. Lines are therefore counted from the start of the chunk, and
//! the names of parts from earlier chunks may be missing. A negative index counts back from its own
//! position, so it can be resolved only if the preceding statements are counted. The range of
//! positive indices is checked at the end of the file.
//!
//! Most lines take the fast path (`quick`), and tobj parses their numbers (`rows`). The other lines
//! are parsed here, on the tolerant path; their numbers reach tobj rewritten.

use super::faces::INHERITED;
use super::lines::{Line, Lines, Oddity, excerpt, number, words};
use super::piece::{Counts, Piece, Stop, Trust};
use super::strokes::StrokeKind;
use crate::findings::FindingKind;
use crate::progress::Cancelled;
use marraztu_core::base::color::{Color, byte};

impl Piece {
    /// Parses the statements of a chunk up to its end or the first unreadable one. `before` counts
    /// the preceding statements of each kind, if known. `reached` is called now and then with the
    /// number of bytes consumed.
    pub(super) fn read(
        chunk: &[u8],
        before: Option<Counts>,
        mut reached: impl FnMut(usize) -> Result<(), Cancelled>,
    ) -> Result<Self, Cancelled> {
        let mut piece = Self::new(before, Trust::Plain);
        piece.scan(chunk, &mut reached)?;
        // tobj rejected a line, so this time every number is rewritten.
        if !piece.read_rows(chunk) {
            piece = Self::new(before, Trust::Nothing);
            piece.scan(chunk, &mut reached)?;
            if !piece.read_rows(chunk) && piece.stop.is_none() {
                piece.stop = Some(Stop::Unread);
            }
        }
        Ok(piece)
    }

    fn scan(
        &mut self,
        chunk: &[u8],
        reached: &mut impl FnMut(usize) -> Result<(), Cancelled>,
    ) -> Result<(), Cancelled> {
        let mut lines = Lines::within(chunk);
        let mut count = 0_u32;
        loop {
            count = count.wrapping_add(1);
            // An atomic update for every line would slow all threads down.
            if count.is_multiple_of(4096) {
                reached(lines.position())?;
            }
            if let Some(length) = self.quick(&lines) {
                lines.pass(length);
                continue;
            }
            let Some(line) = lines.next() else { break };
            if let Err(stop) = self.statement(&line) {
                self.stop = Some(stop);
                break;
            }
        }
        self.lines = lines.number();
        let (count, first) = lines.control();
        self.findings.note_all(FindingKind::ControlCharacter, count, Some(first));
        Ok(())
    }

    /// Lets tobj parse the rows of numbers; returns whether it succeeded.
    fn read_rows(&mut self, chunk: &[u8]) -> bool {
        // Such a chunk is parsed again from its beginning.
        matches!(self.stop, Some(Stop::CountsBack))
            || self.vertices.read(chunk) && self.uvs.read(chunk) && self.normals.read(chunk)
    }

    fn statement(&mut self, line: &Line<'_>) -> Result<(), Stop> {
        let (keyword, rest) = line.statement();
        if line.oddity == Some(Oddity::NotContinued) {
            self.findings.add(FindingKind::NotContinued, &excerpt(keyword), Some(line.number));
        }
        match keyword {
            b"v" => self.vertex(rest, line.number),
            b"vt" => self.uv(rest, line.number),
            b"vn" => self.normal(rest, line.number),
            b"f" | b"fo" => self.face(rest, line.number)?,
            b"o" => self.parts.rename(|now| {
                (now.names.object, now.names.group) = (Some(line.name()), None);
            }),
            b"g" => self.parts.rename(|now| now.names.group = Some(line.name())),
            b"usemtl" => self.parts.rename(|now| {
                (now.names.material, now.line) = (Some(line.name()), line.number);
            }),
            b"mtllib" => self.libraries.push((line.number, line.name())),
            b"c" if self.edge_color(rest) => {}
            b"l" => self.strokes(StrokeKind::Line, rest, line.number)?,
            b"p" => self.strokes(StrokeKind::Points, rest, line.number)?,
            b"s" => self.smoothing(rest, line.number),
            // Statements that do not change the shape are skipped silently.
            b"mg" | b"bevel" | b"c_interp" | b"d_interp" | b"lod" | b"usemap" | b"maplib"
            | b"shadow_obj" | b"trace_obj" | b"t" => {}
            // Free-form geometry is missing from the picture, so it is reported.
            b"vp" | b"cstype" | b"deg" | b"bmat" | b"step" | b"curv" | b"curv2" | b"surf"
            | b"parm" | b"trim" | b"hole" | b"scrv" | b"sp" | b"end" | b"con" | b"ctech"
            | b"stech" => {
                self.findings.note(FindingKind::FreeForm, line.number);
            }
            b"#MRGB" => {
                self.findings.add(FindingKind::ColorComments, "#MRGB", Some(line.number));
            }
            _ if keyword.starts_with(b"#") => self.comment(keyword, rest),
            _ => {
                self.findings.add(FindingKind::Unknown, &excerpt(keyword), Some(line.number));
            }
        }
        Ok(())
    }

    /// Parses `v x y z`, `v x y z w`, `v x y z r g b` and `v x y z r g b a`.
    fn vertex(&mut self, rest: &[u8], line: u32) {
        let row = row::<7>(rest).and_then(|row| match row.count {
            count @ ..3 => Err(format!("a vertex needs three numbers, but has {count}")),
            _ => Ok(row),
        });
        let row = match row {
            Ok(row) => row,
            Err(reason) => {
                self.vertices.lose();
                self.findings.add(FindingKind::VertexUnreadable, &reason, Some(line));
                self.refused.get_or_insert((line, reason));
                return;
            }
        };
        self.note_odd(&row, line);
        let Row { values: [x, y, z, more @ ..], count, .. } = row;
        // Four numbers include a weight, six or seven a colour; other counts are odd.
        match count {
            4 if more[0] != 1.0 => self.findings.note(FindingKind::Weight, line),
            5 | 8.. => self.findings.note(FindingKind::ExtraNumbers, line),
            _ => {}
        }
        let color = matches!(count, 6 | 7).then_some([more[0], more[1], more[2]]);
        if !self.vertices.add([x, y, z], color) {
            self.findings.note(FindingKind::VertexNotFinite, line);
        }
    }

    /// Parses `vt u`, `vt u v` and `vt u v w`.
    fn uv(&mut self, rest: &[u8], line: u32) {
        let Ok(row @ Row { count: 1.., .. }) = row::<2>(rest) else {
            self.uvs.lose();
            return self.findings.note(FindingKind::UvUnreadable, line);
        };
        self.note_odd(&row, line);
        if row.count == 1 {
            self.findings.note(FindingKind::UvSingle, line);
        }
        if !self.uvs.add(row.values, None) {
            self.findings.note(FindingKind::UvNotFinite, line);
        }
    }

    /// Parses `vn x y z`.
    fn normal(&mut self, rest: &[u8], line: u32) {
        let Ok(row @ Row { count: 3.., .. }) = row::<3>(rest) else {
            self.normals.lose();
            return self.findings.note(FindingKind::NormalUnreadable, line);
        };
        self.note_odd(&row, line);
        if !self.normals.add(row.values, None) {
            self.findings.note(FindingKind::NormalNotFinite, line);
        }
    }

    /// Notes a row with a number in unusual notation.
    fn note_odd<const N: usize>(&mut self, row: &Row<'_, N>, line: u32) {
        if let Some(word) = row.odd {
            self.findings.add(FindingKind::NumberOdd, &excerpt(word), Some(line));
        }
    }

    /// Parses `s group`, `s on` and `s off`.
    fn smoothing(&mut self, rest: &[u8], line: u32) {
        let text = rest.split(|b| *b == b'#').next().unwrap_or_default().trim_ascii();
        // Groups are numbers, or sets of 32 bits, which some programs write with a sign.
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "32 bits")]
        let bits = |number: i64| (number as u32).min(INHERITED - 1);
        let is_in_range = |number: &i64| (i32::MIN.into()..=u32::MAX.into()).contains(number);
        let number = || std::str::from_utf8(text).ok()?.parse().ok().filter(is_in_range);
        let group = match &text.to_ascii_lowercase()[..] {
            b"off" => Some(0),
            b"on" => Some(1),
            _ => number().map(bits),
        };
        self.smoothing = group.unwrap_or_else(|| {
            self.findings.add(FindingKind::SmoothingUnreadable, &excerpt(text), Some(line));
            0
        });
    }

    /// Parses `# color r g b`.
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

    /// Parses `r g b`, 0 to 255, as the colour of edges; the first one counts. Returns whether it
    /// is valid.
    fn edge_color(&mut self, rest: &[u8]) -> bool {
        match row::<3>(rest) {
            Ok(row) if row.count == 3 && row.values.iter().all(|x| x.is_finite()) => {
                let color = Color(row.values.map(|x| byte(x / 255.0)));
                self.edge_color.get_or_insert(color);
                true
            }
            _ => false,
        }
    }
}

/// The numbers of a statement: at most `N` are kept, and missing ones are 0.
#[derive(Clone, Copy)]
struct Row<'a, const N: usize> {
    values: [f64; N],
    /// The number of words, even beyond `N`.
    count: usize,
    /// The first number in unusual notation.
    odd: Option<&'a [u8]>,
}

fn row<const N: usize>(rest: &[u8]) -> Result<Row<'_, N>, String> {
    let mut row = Row { values: [0.0; N], count: 0, odd: None };
    for word in words(rest) {
        let number = number(word).map_err(|fault| fault.0)?;
        if row.count < N {
            row.values[row.count] = number.value;
        }
        if number.is_odd {
            row.odd = row.odd.or(Some(word));
        }
        row.count += 1;
        if number.ends_line {
            break;
        }
    }
    Ok(row)
}

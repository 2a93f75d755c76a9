//! Reads ASCII STL files.
//!
//! Words decide, not lines: a line may hold several statements. Comments and words that are not
//! statements are skipped. A facet with a corner that is not three finite numbers is left out.

use std::iter;

use super::solids::{PIECE, Solids};
use crate::error::LoadError;
use crate::findings::{FindingKind, Findings};
use crate::obj::lines::{excerpt, number};
use crate::progress::Progress;

/// The words that begin statements in a solid.
const KEYWORDS: [&str; 6] = ["facet", "outer", "vertex", "endloop", "endfacet", "endsolid"];

/// The beginnings of comments in the files of several programs.
const COMMENTS: [&[u8]; 3] = [b"#", b"//", b";"];

/// Returns whether a word begins a comment.
pub(super) fn is_comment(word: &[u8]) -> bool {
    COMMENTS.iter().any(|begin| word.starts_with(begin))
}

/// Parses a text. Fails if a facet does not have three corners, the text ends within a facet, or
/// `progress` is cancelled.
pub(super) fn read(
    bytes: &[u8],
    file: &str,
    findings: &mut Findings,
    progress: &Progress,
) -> Result<Solids, LoadError> {
    let mut reader = Reader { file, line: 0, solids: Solids::default(), facet: None, findings };
    let (mut at, mut statement_count) = (0, 0_usize);
    for line in bytes.split(|byte| matches!(byte, b'\n' | b'\r')) {
        let begin = at;
        at += line.len() + 1;
        // CR LF is one line end.
        if line.is_empty() && begin > 0 && bytes[begin - 1..].starts_with(b"\r\n") {
            continue;
        }
        reader.line = reader.line.saturating_add(1);
        let text = String::from_utf8_lossy(line);
        let words = words(&text);
        for (word, arguments) in statements(&words) {
            if statement_count.is_multiple_of(PIECE) {
                progress.reached(begin, bytes.len())?;
            }
            statement_count += 1;
            reader.statement(word, arguments)?;
        }
    }
    if reader.facet.is_some() {
        return Err(reader.wrong("the file ends within a facet".to_owned()));
    }
    Ok(reader.solids)
}

/// Splits a line into words up to a comment. In the line of a name, only a sign between blanks
/// begins a comment: `part #3` is a name.
fn words(line: &str) -> Vec<&str> {
    let all = || line.split_ascii_whitespace();
    let first = all().next().unwrap_or_default();
    let is_named = ["solid", "endsolid"].iter().any(|word| first.eq_ignore_ascii_case(word));
    let ends = |word: &&str| match is_named {
        true => COMMENTS.contains(&word.as_bytes()),
        false => is_comment(word.as_bytes()),
    };
    all().take_while(|word| !ends(word)).collect()
}

struct Reader<'a> {
    file: &'a str,
    /// The number of the current line, from 1.
    line: u32,
    solids: Solids,
    facet: Option<Facet>,
    findings: &'a mut Findings,
}

/// A facet in progress.
#[derive(Default)]
struct Facet {
    /// The number of its corners. The first three are kept.
    count: usize,
    corners: [[f32; 3]; 3],
}

impl Reader<'_> {
    fn wrong(&self, reason: String) -> LoadError {
        LoadError::line(self.file, self.line, reason)
    }

    fn statement(&mut self, word: &str, arguments: &[&str]) -> Result<(), LoadError> {
        match word.to_ascii_lowercase().as_str() {
            "solid" => self.solids.begin(arguments.join(" ")),
            "facet" => {
                self.end_facet()?;
                self.facet = Some(Facet::default());
            }
            "vertex" if self.facet.is_some() => {
                let corner = self.corner(arguments);
                if let Some(Facet { count, corners }) = &mut self.facet {
                    if let Some(place) = corners.get_mut(*count) {
                        *place = corner;
                    }
                    *count += 1;
                }
            }
            "endfacet" => self.end_facet()?,
            "outer" | "endloop" | "endsolid" => {}
            _ => {
                let word = excerpt(word.as_bytes());
                self.findings.add(FindingKind::StlUnknown, &word, Some(self.line));
            }
        }
        Ok(())
    }

    /// Returns the position of a corner, with NaN for numbers that are missing or cannot be read.
    fn corner(&mut self, words: &[&str]) -> [f32; 3] {
        if words.len() != 3 {
            return [f32::NAN; 3];
        }
        std::array::from_fn(|i| {
            let word = words[i];
            // Parsing as f32 rounds once.
            word.parse().unwrap_or_else(|_unusual| match number(word.as_bytes()) {
                Ok(number) => {
                    if number.is_odd {
                        self.findings.add(FindingKind::NumberOdd, word, Some(self.line));
                    }
                    #[expect(clippy::cast_possible_truncation, reason = "positions are f32")]
                    let value = number.value as f32;
                    value
                }
                Err(_) => f32::NAN,
            })
        })
    }

    fn end_facet(&mut self) -> Result<(), LoadError> {
        let Some(Facet { count, corners }) = self.facet.take() else { return Ok(()) };
        if count != 3 {
            return Err(self.wrong(format!("the facet has {count} corners instead of 3")));
        }
        if !self.solids.add(corners) {
            self.findings.note(FindingKind::TriangleNotFinite, self.line);
        }
        Ok(())
    }
}

/// Splits the words of a line into statements, each with its arguments. Usually there is one.
fn statements<'a>(mut words: &'a [&'a str]) -> impl Iterator<Item = (&'a str, &'a [&'a str])> {
    iter::from_fn(move || {
        let (word, after) = words.split_first()?;
        let (arguments, next) = after.split_at(argument_count(word, after));
        words = next;
        Some((*word, arguments))
    })
}

/// Returns the number of words that belong to a statement: all up to the next one in the line.
fn argument_count(word: &str, after: &[&str]) -> usize {
    let is = |word: &str, other: &str| word.eq_ignore_ascii_case(other);
    // Names may contain keywords, so only a whole statement ends a name.
    let is_facet = |pair: &[&str]| is(pair[0], "facet") && is(pair[1], "normal");
    let facet = || after.windows(2).position(is_facet);
    let end = match word.to_ascii_lowercase().as_str() {
        "solid" => facet(),
        "endsolid" => {
            facet().map(|end| after[..end].iter().position(|word| is(word, "solid")).unwrap_or(end))
        }
        _ => after
            .iter()
            .position(|word| is(word, "solid") || KEYWORDS.iter().any(|keyword| is(word, keyword))),
    };
    end.unwrap_or(after.len())
}

//! The lines of an OBJ or MTL file, whichever program wrote it.
//!
//! A line ends with LF, CR LF or CR, and goes on with the next if its last character is a back
//! slash. Bytes that are not UTF-8 are taken as Latin-1; a byte-order mark at the beginning is
//! skipped.

use std::borrow::Cow;

use memchr::memchr2;

/// A line, with those that continue it.
#[derive(Clone, Debug)]
pub(in crate::io) struct Line<'a> {
    /// The number of its first part, counted from 1.
    pub(in crate::io) number: u32,
    /// Its text, without blanks at its ends; continuations are joined by a blank.
    text: Cow<'a, [u8]>,
    /// The same, joined by nothing, if it differs: names go on without a blank.
    joined: Option<Vec<u8>>,
}

/// Goes through the lines of a file; empty ones are passed over.
#[derive(Debug)]
pub(in crate::io) struct Lines<'a> {
    bytes: &'a [u8],
    at: usize,
    number: u32,
}

impl<'a> Lines<'a> {
    /// The lines of a whole file.
    pub(in crate::io) fn new(bytes: &'a [u8]) -> Self {
        Self::within(unmarked(bytes))
    }

    /// The lines of a part of a file.
    pub(super) const fn within(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0, number: 0 }
    }

    /// How many bytes are behind.
    pub(super) const fn position(&self) -> usize {
        self.at
    }

    /// How many lines are behind.
    pub(super) const fn number(&self) -> u32 {
        self.number
    }

    /// The bytes that are not behind yet.
    pub(super) fn rest(&self) -> &'a [u8] {
        &self.bytes[self.at..]
    }

    /// Passes over a line of `length` bytes, its ending among them.
    pub(super) const fn pass(&mut self, length: usize) {
        self.at += length;
        self.number = self.number.saturating_add(1);
    }

    /// The next line of the file as it stands there, trimmed.
    fn physical(&mut self) -> Option<&'a [u8]> {
        let rest = &self.bytes[self.at..];
        if rest.is_empty() {
            return None;
        }
        self.number = self.number.saturating_add(1);
        let length = memchr2(b'\n', b'\r', rest).unwrap_or(rest.len());
        let ending = match &rest[length..] {
            [b'\r', b'\n', ..] => 2,
            [] => 0,
            _ => 1,
        };
        self.at += length + ending;
        Some(rest[..length].trim_ascii())
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = Line<'a>;

    fn next(&mut self) -> Option<Line<'a>> {
        loop {
            let first = self.physical()?;
            if first.is_empty() {
                continue;
            }
            let number = self.number;
            let Some(begin) = first.strip_suffix(b"\\") else {
                return Some(Line { number, text: Cow::Borrowed(first), joined: None });
            };
            let (mut text, mut joined) = (begin.to_vec(), begin.to_vec());
            while let Some(next) = self.physical() {
                let (part, goes_on) = match next.strip_suffix(b"\\") {
                    Some(part) => (part, true),
                    None => (next, false),
                };
                text.push(b' ');
                text.extend_from_slice(part);
                joined.extend_from_slice(part);
                if !goes_on {
                    break;
                }
            }
            return Some(Line { number, text: Cow::Owned(text), joined: Some(joined) });
        }
    }
}

impl Line<'_> {
    /// The first word, and what follows it.
    pub(in crate::io) fn statement(&self) -> (&[u8], &[u8]) {
        split_word(&self.text)
    }

    /// The name that follows the first word: blanks inside it are kept, a comment after it is not.
    ///
    /// In a name a comment begins with a `#` between blanks; `Material #25` is a name.
    pub(in crate::io) fn name(&self) -> String {
        let (_, rest) = split_word(self.joined.as_deref().unwrap_or(&self.text));
        let comment = (0..rest.len()).find(|&i| {
            let blank =
                |i: Option<usize>| i.and_then(|i| rest.get(i)).is_none_or(u8::is_ascii_whitespace);
            rest[i] == b'#' && blank(i.checked_sub(1)) && blank(Some(i + 1))
        });
        decode(rest[..comment.unwrap_or(rest.len())].trim_ascii())
    }
}

/// A file without the byte-order mark that it may begin with.
pub(super) fn unmarked(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes)
}

/// The first word of a text that begins with one, and what follows it, trimmed.
fn split_word(text: &[u8]) -> (&[u8], &[u8]) {
    let end = text.iter().position(u8::is_ascii_whitespace).unwrap_or(text.len());
    let (word, rest) = text.split_at(end);
    (word, rest.trim_ascii())
}

/// The words of a text up to a comment.
pub(in crate::io) fn words(text: &[u8]) -> impl Iterator<Item = &[u8]> {
    text.split(u8::is_ascii_whitespace)
        .filter(|word| !word.is_empty())
        .take_while(|word| word[0] != b'#')
}

/// Text of UTF-8 or, if it is not UTF-8, of Latin-1.
pub(in crate::io) fn decode(bytes: &[u8]) -> String {
    match std::str::from_utf8(bytes) {
        Ok(text) => text.to_owned(),
        Err(_) => bytes.iter().copied().map(char::from).collect(),
    }
}

/// A word for a message, cut off if it is long.
pub(in crate::io) fn excerpt(word: &[u8]) -> String {
    const MOST: usize = 40;
    // No character of UTF-8 has more than four bytes.
    let text = decode(&word[..word.len().min(4 * MOST)]);
    let is_cut = 4 * MOST < word.len() || text.chars().nth(MOST).is_some();
    let shown: String = text.chars().take(MOST).collect();
    let shown = shown.replace(char::is_control, "\u{FFFD}");
    if is_cut { shown + "..." } else { shown }
}

/// Why a word is not a number.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in crate::io) struct NoNumber(pub(in crate::io) String);

/// A number of 32 bits, with the part of the word that says it: a comment may follow at once.
///
/// The spellings of C libraries for infinities and NaN are read as such; the text
/// is then of no use.
pub(in crate::io) fn number(word: &[u8]) -> Result<(f32, &[u8]), NoNumber> {
    let parse = |word: &[u8]| std::str::from_utf8(word).ok()?.parse::<f32>().ok();
    if let Some(value) = parse(word) {
        return Ok((value, word));
    }
    let plain = word.to_ascii_lowercase();
    if plain.windows(2).any(|two| two == b".#") || plain.windows(4).any(|four| four == b"nan(") {
        return Ok((f32::NAN, word));
    }
    let before_comment = word.split(|b| *b == b'#').next().unwrap_or(word);
    if let Some(value) = parse(before_comment) {
        return Ok((value, before_comment));
    }
    let text = excerpt(word);
    let point = text.replacen(',', ".", 1);
    Err(NoNumber(if point != text && point.parse::<f32>().is_ok() {
        format!("\"{text}\" has a decimal comma; write a decimal point")
    } else {
        format!("\"{text}\" is not a number")
    }))
}

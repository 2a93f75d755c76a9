//! The lines of an OBJ or MTL file, whichever program wrote it.
//!
//! A line ends with LF, CR LF or CR, and goes on with the next if its last character is a
//! backslash. A comment does not go on, and neither does a line before one that begins with a
//! keyword: paths such as `C:\out\` end in a backslash, too. Vertical tabs, form feeds and NUL are
//! blanks. Bytes that are not UTF-8 are taken as Latin-1; a byte-order mark at the beginning is
//! skipped.

use std::borrow::Cow;

use memchr::memchr2;

/// A line, with those that continue it.
#[derive(Clone, Debug)]
pub(crate) struct Line<'a> {
    /// The number of its first part, counted from 1.
    pub(crate) number: u32,
    /// Its text, without blanks at its ends; continuations are joined by a blank.
    text: Cow<'a, [u8]>,
    /// The same, joined by nothing, if it differs: names go on without a blank.
    joined: Option<Vec<u8>>,
    /// An oddity of its form.
    pub(crate) oddity: Option<Oddity>,
}

/// An oddity of a line's form.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Oddity {
    /// It ends in a backslash, but the next line is a statement.
    NotContinued,
}

/// Goes through the lines of a file; empty ones are passed over.
#[derive(Debug)]
pub(crate) struct Lines<'a> {
    bytes: &'a [u8],
    at: usize,
    number: u32,
    /// The number of lines with control characters, and the first of them.
    control: (usize, u32),
}

impl<'a> Lines<'a> {
    /// The lines of a whole file.
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        Self::within(unmarked(bytes))
    }

    /// The lines of a part of a file.
    pub(super) const fn within(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0, number: 0, control: (0, 0) }
    }

    /// How many bytes are behind.
    pub(super) const fn position(&self) -> usize {
        self.at
    }

    /// How many lines are behind.
    pub(super) const fn number(&self) -> u32 {
        self.number
    }

    /// The number of lines so far with control characters, and the first of them.
    pub(super) const fn control(&self) -> (usize, u32) {
        self.control
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
        let line = &rest[..length];
        if line.iter().copied().any(is_odd_blank) {
            let (count, first) = &mut self.control;
            *first = if *count == 0 { self.number } else { *first };
            *count += 1;
        }
        Some(trimmed(line))
    }

    /// Whether the next line of the file begins with a keyword.
    fn precedes_statement(&self) -> bool {
        let rest = &self.bytes[self.at..];
        let end = memchr2(b'\n', b'\r', rest).unwrap_or(rest.len());
        let (word, arguments) = split_word(trimmed(&rest[..end]));
        let is_comment = word.starts_with(b"#");
        is_comment || !arguments.is_empty() && KEYWORDS.contains(&word)
    }
}

/// The keywords that a line is not continued with.
const KEYWORDS: [&[u8]; 32] = [
    b"v",
    b"vt",
    b"vn",
    b"vp",
    b"f",
    b"l",
    b"p",
    b"g",
    b"o",
    b"s",
    b"usemtl",
    b"mtllib",
    b"newmtl",
    b"Ka",
    b"Kd",
    b"Ks",
    b"Ke",
    b"Ns",
    b"Ni",
    b"Tr",
    b"Tf",
    b"illum",
    b"map_Ka",
    b"map_Kd",
    b"map_Ks",
    b"map_Ke",
    b"map_Ns",
    b"map_d",
    b"map_Bump",
    b"map_bump",
    b"bump",
    b"norm",
];

/// A control character that is taken as a blank.
const fn is_odd_blank(byte: u8) -> bool {
    matches!(byte, b'\x0B' | b'\x0C' | 0)
}

/// A line without blanks at its ends.
fn trimmed(mut line: &[u8]) -> &[u8] {
    let is_blank = |byte: &u8| byte.is_ascii_whitespace() || is_odd_blank(*byte);
    while let [first, rest @ ..] = line
        && is_blank(first)
    {
        line = rest;
    }
    while let [rest @ .., last] = line
        && is_blank(last)
    {
        line = rest;
    }
    line
}

/// A line with blanks for control characters.
fn cleaned(line: &[u8]) -> Cow<'_, [u8]> {
    if !line.iter().copied().any(is_odd_blank) {
        return Cow::Borrowed(line);
    }
    Cow::Owned(line.iter().map(|byte| if is_odd_blank(*byte) { b' ' } else { *byte }).collect())
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
            let whole = |first: &'a [u8], oddity: Option<Oddity>| {
                Some(Line { number, text: cleaned(first), joined: None, oddity })
            };
            let Some(begin) = first.strip_suffix(b"\\") else { return whole(first, None) };
            if first.starts_with(b"#") {
                return whole(first, None);
            }
            if self.precedes_statement() {
                return whole(begin, Some(Oddity::NotContinued));
            }
            let (mut text, mut joined) = (begin.to_vec(), begin.to_vec());
            let mut oddity = None;
            while let Some(next) = self.physical() {
                let (part, goes_on) = match next.strip_suffix(b"\\") {
                    Some(part) if self.precedes_statement() => {
                        oddity = Some(Oddity::NotContinued);
                        (part, false)
                    }
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
            let text = Cow::Owned(cleaned(&text).into_owned());
            return Some(Line { number, text, joined: Some(joined), oddity });
        }
    }
}

impl Line<'_> {
    /// The first word, and what follows it.
    pub(crate) fn statement(&self) -> (&[u8], &[u8]) {
        split_word(&self.text)
    }

    /// The name that follows the first word: blanks inside it are kept, a comment after it is not.
    ///
    /// In a name a comment begins with a `#` between blanks; `Material #25` is a name.
    pub(crate) fn name(&self) -> String {
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
pub(crate) fn words(text: &[u8]) -> impl Iterator<Item = &[u8]> {
    text.split(u8::is_ascii_whitespace)
        .filter(|word| !word.is_empty())
        .take_while(|word| word[0] != b'#')
}

/// Text of UTF-8 or, if it is not UTF-8, of Latin-1.
pub(crate) fn decode(bytes: &[u8]) -> String {
    match std::str::from_utf8(bytes) {
        Ok(text) => text.to_owned(),
        Err(_) => bytes.iter().copied().map(char::from).collect(),
    }
}

/// A word for a message, cut off if it is long.
pub(crate) fn excerpt(word: &[u8]) -> String {
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
pub(crate) struct NoNumber(pub(crate) String);

/// A number of a file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Number {
    pub(crate) value: f64,
    /// It is written in a way that the format does not have.
    pub(crate) is_odd: bool,
    /// A comment follows at once.
    pub(crate) ends_line: bool,
}

/// The number that a word says.
///
/// The spellings of C libraries for infinities and NaN are read as such. Exponents of Fortran
/// (`1D0`), decimal commas, the suffix of a C literal and the minus sign of Unicode are read, too,
/// and said to be odd.
pub(crate) fn number(word: &[u8]) -> Result<Number, NoNumber> {
    let parse = |word: &[u8]| std::str::from_utf8(word).ok()?.parse::<f64>().ok();
    let [plain, odd] =
        [false, true].map(|is_odd| move |value| Number { value, is_odd, ends_line: false });
    if let Some(value) = parse(word) {
        return Ok(plain(value));
    }
    let lower = word.to_ascii_lowercase();
    if lower.windows(2).any(|two| two == b".#") || lower.windows(4).any(|four| four == b"nan(") {
        return Ok(plain(f64::NAN));
    }
    if let Some(end) = word.iter().position(|byte| *byte == b'#').filter(|end| *end > 0) {
        return number(&word[..end]).map(|number| Number { ends_line: true, ..number });
    }
    if let Some(value) = respelled(&lower).and_then(|word| parse(word.as_bytes())) {
        return Ok(odd(value));
    }
    Err(NoNumber(format!("\"{}\" is not a number", excerpt(word))))
}

/// A number as Rust spells it, from the spellings of other languages.
fn respelled(lower: &[u8]) -> Option<String> {
    let text = std::str::from_utf8(lower).ok()?.replace('\u{2212}', "-");
    let text = text.trim_end_matches([',', ';']);
    let text = text.strip_suffix(['f', 'l']).unwrap_or(text);
    // Words such as "d" or "food" are not numbers, even if a letter is replaced.
    let starts = text.starts_with(|sign: char| sign.is_ascii_digit() || "+-.,".contains(sign));
    let commas = text.matches(',').count();
    let respelled = match commas {
        0 => text.replacen(['d', 'q'], "e", 1),
        1 if !text.contains('.') => text.replacen(',', ".", 1),
        _ => return None,
    };
    starts.then_some(respelled)
}

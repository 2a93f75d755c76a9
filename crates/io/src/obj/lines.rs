//! Splits an OBJ or MTL file into lines, tolerating the output of all known programs.
//!
//! A line ends with LF, CR LF or CR, and continues on the next if its last character is a
//! backslash. Comments do not continue, and neither do lines before one that begins with a keyword:
//! paths such as `C:\out\` end in a backslash, too. Vertical tabs, form feeds and NUL count as
//! blanks. Bytes that are not UTF-8 are decoded as Latin-1; a byte-order mark at the beginning is
//! skipped.

use std::borrow::Cow;

use memchr::memchr2;

/// A line with its continuations.
#[derive(Clone, Debug)]
pub(crate) struct Line<'a> {
    /// The number of the first physical line, counted from 1.
    pub(crate) number: u32,
    /// The trimmed text; continuations are joined by a blank.
    text: Cow<'a, [u8]>,
    /// The text with continuations joined directly, if it differs: names continue without a blank.
    joined: Option<Vec<u8>>,
    /// An oddity in the form of the line.
    pub(crate) oddity: Option<Oddity>,
}

/// An oddity in the form of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Oddity {
    /// The line ends in a backslash, but the next line is a statement.
    NotContinued,
}

/// Iterates over the lines of a file; empty lines are skipped.
#[derive(Debug)]
pub(crate) struct Lines<'a> {
    bytes: &'a [u8],
    at: usize,
    number: u32,
    /// The number of lines with control characters, and the first such line.
    control: (usize, u32),
}

impl<'a> Lines<'a> {
    /// Iterates over the lines of a whole file.
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        Self::within(unmarked(bytes))
    }

    /// Iterates over the lines of a part of a file.
    pub(super) const fn within(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0, number: 0, control: (0, 0) }
    }

    /// Returns the number of bytes consumed.
    pub(super) const fn position(&self) -> usize {
        self.at
    }

    /// Returns the number of lines consumed.
    pub(super) const fn number(&self) -> u32 {
        self.number
    }

    /// Returns the number of lines so far with control characters, and the first such line.
    pub(super) const fn control(&self) -> (usize, u32) {
        self.control
    }

    /// Returns the unconsumed bytes.
    pub(super) fn rest(&self) -> &'a [u8] {
        &self.bytes[self.at..]
    }

    /// Skips a line of `length` bytes, including its line end.
    pub(super) const fn pass(&mut self, length: usize) {
        self.at += length;
        self.number = self.number.saturating_add(1);
    }

    /// Returns the next physical line, trimmed.
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

    /// Returns whether the next physical line begins with a keyword.
    fn precedes_statement(&self) -> bool {
        let rest = &self.bytes[self.at..];
        let end = memchr2(b'\n', b'\r', rest).unwrap_or(rest.len());
        let (word, arguments) = split_word(trimmed(&rest[..end]));
        let is_comment = word.starts_with(b"#");
        let is_keyword = || KEYWORDS.split(' ').any(|keyword| keyword.as_bytes() == word);
        is_comment || !arguments.is_empty() && is_keyword()
    }
}

/// The keywords that end a continued line.
const KEYWORDS: &str = "v vt vn vp f fo l p g o s usemtl mtllib newmtl Ka Kd Ks Ke Kt Ns Ni d Tr \
    Tf illum sharpness bsdf Pr Pm Ps Pc Pcr aniso anisor map_Ka map_Kd map_Ks map_Ke map_Ns map_d \
    map_Bump map_bump map_norm map_Kn bump norm disp decal refl";

/// Returns whether a control character counts as a blank.
const fn is_odd_blank(byte: u8) -> bool {
    matches!(byte, b'\x0B' | b'\x0C' | 0)
}

/// Trims a line.
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

/// Replaces control characters by blanks.
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
            // Nearly all lines end here, without a copy.
            let Some(begin) = first.strip_suffix(b"\\") else { return whole(first, None) };
            if first.starts_with(b"#") {
                return whole(first, None);
            }
            if self.precedes_statement() {
                return whole(begin, Some(Oddity::NotContinued));
            }
            // Numbers are joined with a blank, names without one.
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
    /// Returns the first word, and the rest of the line.
    pub(crate) fn statement(&self) -> (&[u8], &[u8]) {
        split_word(&self.text)
    }

    /// Returns the name after the first word, with its inner blanks but without a comment.
    ///
    /// In a name, only a `#` between blanks begins a comment: `Material #25` is a name.
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

/// Removes a byte-order mark at the beginning of a file.
pub(crate) fn unmarked(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes)
}

/// Splits a text into its first word and the trimmed rest.
fn split_word(text: &[u8]) -> (&[u8], &[u8]) {
    let end = text.iter().position(u8::is_ascii_whitespace).unwrap_or(text.len());
    let (word, rest) = text.split_at(end);
    (word, rest.trim_ascii())
}

/// Returns the words of a text up to a comment.
pub(crate) fn words(text: &[u8]) -> impl Iterator<Item = &[u8]> {
    text.split(u8::is_ascii_whitespace)
        .filter(|word| !word.is_empty())
        .take_while(|word| word[0] != b'#')
}

/// Decodes UTF-8 or, if the bytes are invalid, Latin-1.
pub(crate) fn decode(bytes: &[u8]) -> String {
    match std::str::from_utf8(bytes) {
        Ok(text) => text.to_owned(),
        Err(_) => bytes.iter().copied().map(char::from).collect(),
    }
}

/// Shortens a word for a message.
pub(crate) fn excerpt(word: &[u8]) -> String {
    const MOST: usize = 40;
    // A UTF-8 character has at most four bytes.
    let text = decode(&word[..word.len().min(4 * MOST)]);
    let is_cut = 4 * MOST < word.len() || text.chars().nth(MOST).is_some();
    let shown: String = text.chars().take(MOST).collect();
    let shown = shown.replace(char::is_control, "\u{FFFD}");
    if is_cut { shown + "..." } else { shown }
}

/// The reason why a word is not a number.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct NoNumber(pub(crate) String);

/// A parsed number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Number {
    pub(crate) value: f64,
    /// Whether the notation is not part of the format.
    pub(crate) is_odd: bool,
    /// Whether a comment follows without a blank.
    pub(crate) ends_line: bool,
}

/// Parses a number.
///
/// The notations of C libraries for infinities and NaN are accepted. Fortran exponents (`1D0`),
/// decimal commas, C suffixes and the Unicode minus sign are accepted as well, and marked as odd.
pub(crate) fn number(word: &[u8]) -> Result<Number, NoNumber> {
    let parse = |word: &[u8]| std::str::from_utf8(word).ok()?.parse::<f64>().ok();
    let [plain, odd] =
        [false, true].map(|is_odd| move |value| Number { value, is_odd, ends_line: false });
    // Nearly all numbers parse here; the notations below are rare.
    if let Some(value) = parse(word) {
        return Ok(plain(value));
    }
    let lower = word.to_ascii_lowercase();
    // Old C libraries write 1.#INF, 1.#QNAN and nan(ind).
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

/// Converts numbers in the notation of other languages to Rust's.
fn respelled(lower: &[u8]) -> Option<String> {
    let text = std::str::from_utf8(lower).ok()?.replace('\u{2212}', "-");
    let text = text.trim_end_matches([',', ';']);
    let text = text.strip_suffix(['f', 'l']).unwrap_or(text);
    // Words such as "d" or "food" are not numbers, even with a letter replaced.
    let starts = text.starts_with(|sign: char| sign.is_ascii_digit() || "+-.,".contains(sign));
    let commas = text.matches(',').count();
    let respelled = match commas {
        0 => text.replacen(['d', 'q'], "e", 1),
        1 if !text.contains('.') => text.replacen(',', ".", 1),
        _ => return None,
    };
    starts.then_some(respelled)
}

//! Splits a text into chunks that can be parsed independently.
//!
//! A chunk ends at a line end without a continuation, so every statement lies in one chunk, and the
//! concatenation of all chunks is the text. Threads read chunks from the file on demand, which
//! keeps only the chunks in progress in memory.

use std::io::Read;

use memchr::memrchr2;

use crate::error::{LoadError, NO_MEMORY};

/// A text that is read chunk by chunk.
#[derive(Debug)]
pub(super) struct Chunks<'a, R> {
    source: R,
    /// The name of the file.
    file: &'a str,
    sizes: Sizes,
    /// Bytes that were read but belong to the next chunk.
    rest: Vec<u8>,
    /// The number of chunks taken.
    taken: usize,
    /// The number of bytes read.
    read: usize,
    /// Whether the source is exhausted.
    ended: bool,
}

/// Limits in bytes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sizes {
    /// The minimum size of a chunk, unless the text ends earlier.
    pub(super) chunk: usize,
    /// The maximum size of a statement.
    pub(super) statement: usize,
    /// The maximum size of the text.
    pub(super) text: usize,
}

impl<'a, R: Read> Chunks<'a, R> {
    pub(super) const fn new(source: R, file: &'a str, sizes: Sizes) -> Self {
        Self { source, file, sizes, rest: Vec::new(), taken: 0, read: 0, ended: false }
    }

    /// Replaces `chunk` by the next chunk and returns its index, from 0. Fails if the text cannot
    /// be read, or if it or a statement is too long.
    pub(super) fn take(&mut self, chunk: &mut Vec<u8>) -> Result<Option<usize>, LoadError> {
        chunk.clear();
        chunk.append(&mut self.rest);
        // Reads more until the chunk contains a complete statement.
        let mut wanted = self.sizes.chunk.max(1);
        let end = loop {
            self.fill(chunk, wanted)?;
            if let Some(end) = if self.ended { Some(chunk.len()) } else { end(chunk) } {
                break end;
            }
            if chunk.len() > self.sizes.statement {
                let most = self.sizes.statement >> 20;
                let reason = format!("a statement is longer than {most} MB");
                return Err(LoadError::file(self.file, reason));
            }
            wanted = 2 * chunk.len();
        };
        self.rest.extend_from_slice(&chunk[end..]);
        chunk.truncate(end);
        let number = self.taken;
        self.taken += 1;
        Ok((end > 0).then_some(number))
    }

    /// Discards the rest of the source.
    pub(super) fn stop(&mut self) {
        self.rest.clear();
        self.ended = true;
    }

    /// Returns whether the source is exhausted.
    pub(super) const fn ended(&self) -> bool {
        self.ended
    }

    /// Reads until there are `wanted` bytes, or the source ends.
    fn fill(&mut self, chunk: &mut Vec<u8>, wanted: usize) -> Result<(), LoadError> {
        let system = |error: std::io::Error| LoadError::system(self.file, &error);
        let missing = wanted.saturating_sub(chunk.len());
        if self.ended || missing == 0 {
            return Ok(());
        }
        chunk.try_reserve(missing).map_err(|_full| LoadError::file(self.file, NO_MEMORY))?;
        let limit = u64::try_from(missing).unwrap_or(u64::MAX);
        let new = self.source.by_ref().take(limit).read_to_end(chunk).map_err(system)?;
        self.ended = new < missing;
        self.read = self.read.saturating_add(new);
        if self.read > self.sizes.text {
            return Err(LoadError::too_large(self.file, self.sizes.text));
        }
        Ok(())
    }
}

/// Returns the end of the last complete statement in a text.
fn end(text: &[u8]) -> Option<usize> {
    // A LF may follow a trailing CR in the next read.
    let mut end = text.len() - usize::from(text.last() == Some(&b'\r'));
    loop {
        end = memrchr2(b'\n', b'\r', &text[..end])?;
        if !ends_in_back_slash(&text[..end]) {
            return Some(end + 1);
        }
    }
}

/// Returns whether the last line of a text ends in a backslash, ignoring blanks. The text may end
/// between CR and LF.
fn ends_in_back_slash(text: &[u8]) -> bool {
    let text = text.strip_suffix(b"\r").unwrap_or(text);
    text.iter().rev().find(|sign| !matches!(sign, b' ' | b'\t' | b'\x0C')) == Some(&b'\\')
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZES: Sizes = Sizes { chunk: 1, statement: 1 << 20, text: 3 << 20 };

    fn chunks(text: impl Read, sizes: Sizes) -> Result<Vec<Vec<u8>>, LoadError> {
        let mut chunks = Chunks::new(text, "a.obj", sizes);
        let mut all = Vec::new();
        let mut chunk = b"what was there before".to_vec();
        while let Some(number) = chunks.take(&mut chunk)? {
            assert_eq!(number, all.len());
            all.push(chunk.clone());
        }
        Ok(all)
    }

    #[test]
    fn chunks_end_with_lines_and_are_the_text_together() {
        let text = b"v 1\nv 2 \\\n3\r\nv \\ \r\n\r\nf 1\rf 2\\";
        let all: Vec<&[u8]> =
            vec![b"v 1\n", b"v 2 \\\n3\r\n", b"v \\ \r\n\r\n", b"f 1\r", b"f 2\\"];
        for chunk in 0..40 {
            let chunks = chunks(&text[..], Sizes { chunk, ..SIZES }).unwrap();
            assert_eq!(chunks.concat(), text);
            let mut rest = &all[..];
            for chunk in chunks {
                let count = (1..=rest.len()).find(|n| rest[..*n].concat() == chunk);
                rest = &rest[count.expect("a chunk is made of whole statements")..];
            }
        }
        assert_eq!(chunks(&text[..], SIZES).unwrap().len(), 4);
    }

    #[test]
    fn endless_input_is_read_only_up_to_the_limit() {
        let refusal = |sign| chunks(std::io::repeat(sign), SIZES).unwrap_err().to_string();
        assert_eq!(refusal(b'x'), "a.obj: a statement is longer than 1 MB");
        assert_eq!(refusal(b'\n'), "a.obj: the file is larger than 3 MB");
    }
}

//! A text in chunks that can be read apart.
//!
//! A chunk ends where a line ends that the next one does not continue; so every statement lies in
//! one chunk, and the chunks together are the text.

use memchr::memchr2;

/// Cuts a text into chunks of at least `least` bytes each, but for the last.
pub(super) fn chunks(mut text: &[u8], least: usize) -> Vec<&[u8]> {
    let mut chunks = Vec::new();
    while !text.is_empty() {
        let (chunk, rest) = text.split_at(end(text, least));
        chunks.push(chunk);
        text = rest;
    }
    chunks
}

/// Where the first chunk of a text ends.
fn end(text: &[u8], least: usize) -> usize {
    let mut at = least.max(1) - 1;
    while let Some(ending) = text.get(at..).and_then(|rest| memchr2(b'\n', b'\r', rest)) {
        let continued = ends_in_back_slash(&text[..at + ending]);
        at += ending + 1;
        if text[at - 1] == b'\r' && text.get(at) == Some(&b'\n') {
            at += 1;
        }
        if !continued {
            return at;
        }
    }
    text.len()
}

/// Whether the last sign of a text's last line that is no blank is a back slash. The text may end
/// between CR and LF.
fn ends_in_back_slash(text: &[u8]) -> bool {
    let text = text.strip_suffix(b"\r").unwrap_or(text);
    text.iter().rev().find(|sign| !matches!(sign, b' ' | b'\t' | b'\x0C')) == Some(&b'\\')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chunks_end_with_lines_and_are_the_text_together() {
        let text = b"v 1\nv 2 \\\n3\r\nv \\ \r\n\r\nf 1\rf 2\\";
        let all: Vec<&[u8]> =
            vec![b"v 1\n", b"v 2 \\\n3\r\n", b"v \\ \r\n\r\n", b"f 1\r", b"f 2\\"];
        assert_eq!(chunks(text, 1), all);
        for least in 0..40 {
            let chunks = chunks(text, least);
            assert_eq!(chunks.concat(), text);
            let mut rest = &all[..];
            for chunk in chunks {
                let count = (1..=rest.len()).find(|n| rest[..*n].concat() == chunk);
                rest = &rest[count.expect("a chunk is made of whole statements")..];
            }
        }
    }
}

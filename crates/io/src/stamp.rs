//! Stamps: short texts in the files of pictures.
//!
//! A batch stamps each picture with a hash of everything that the picture depends on. A later run
//! compares the stamps and skips the pictures that would not change. The stamp is part of the file,
//! so it is moved, copied and deleted with it. Reading a stamp reads the first few hundred bytes of
//! the file and its end, which shows whether the file is complete.
//!
//! | format | place of the stamp |
//! |---|---|
//! | PNG | a `tEXt` chunk before the pixels (PNG specification, 11.3.4.3) |
//! | JPEG | a comment segment (ITU-T T.81, B.2.4.5) |
//! | WebP | an unknown chunk at the end of an extended file (RFC 9649, section 2.7) |
//! | PPM | a comment in the header |
//! | OpenEXR, NumPy | a line after the content, which readers ignore |

use std::fs::File;
use std::io::{Cursor, Read, Seek, SeekFrom};
use std::path::Path;

use super::picture::{PictureFormat, has_alpha, png_with_text, sides};
use marraztu_core::base::image::Picture;

/// The keyword of the text in a PNG.
pub(super) const KEYWORD: &str = "Marraztu-Stamp";

/// The beginning of a stamp in formats whose comments have no keyword.
const MARK: &str = "Marraztu-Stamp: ";

/// The name of the chunk in a WebP.
const CHUNK: &[u8; 4] = b"MRZT";

/// The bytes at the beginning of a file that are searched for a stamp.
const HEAD: usize = 512;

/// The longest stamp in bytes.
const LONGEST: usize = 200;

/// Encodes a picture with a stamp, as the bytes of a file. The stamp is printable ASCII.
///
/// # Errors
/// The reason, if the format cannot hold the picture or the stamp.
pub fn encode_stamped(
    format: &PictureFormat,
    picture: &Picture,
    stamp: &str,
) -> Result<Vec<u8>, String> {
    let is_plain = |byte: u8| (b' '..=b'~').contains(&byte);
    if stamp.len() > LONGEST || !stamp.bytes().all(is_plain) {
        return Err(format!("a stamp has at most {LONGEST} characters of ASCII"));
    }
    if format.name == "PNG" {
        return png_with_text(picture, KEYWORD, stamp);
    }
    let content = format.encode(picture)?;
    match format.name {
        "JPEG" => Ok(stamped_jpeg(content, stamp)),
        "WebP" => Ok(stamped_webp(&content, picture, stamp)),
        "PPM" => Ok(stamped_ppm(content, stamp)),
        name => Err(format!("{name} files have no place for a stamp")),
    }
}

/// Appends a stamp to a file of numbers: OpenEXR or NumPy. The stamp is printable ASCII.
pub fn stamped_at_end(mut content: Vec<u8>, stamp: &str) -> Vec<u8> {
    content.extend_from_slice([MARK, stamp, "\n"].concat().as_bytes());
    content
}

/// Inserts a comment after the first segment, which readers expect to be JFIF's.
fn stamped_jpeg(mut content: Vec<u8>, stamp: &str) -> Vec<u8> {
    let at = match content[..] {
        [0xFF, 0xD8, 0xFF, 0xE0, high, low, ..] => 4 + usize::from(u16::from_be_bytes([high, low])),
        _ => 2,
    };
    let text = [MARK, stamp].concat();
    let length = u16::try_from(text.len() + 2).unwrap_or(u16::MAX).to_be_bytes();
    let segment = [&[0xFF, 0xFE], &length[..], text.as_bytes()].concat();
    let at = at.min(content.len());
    content.splice(at..at, segment);
    content
}

/// Inserts a comment after the magic number.
fn stamped_ppm(mut content: Vec<u8>, stamp: &str) -> Vec<u8> {
    let at = content.iter().position(|byte| *byte == b'\n').map_or(0, |end| end + 1);
    content.splice(at..at, format!("# {MARK}{stamp}\n").into_bytes());
    content
}

/// Converts a simple file to an extended one, which may contain other chunks.
fn stamped_webp(content: &[u8], picture: &Picture, stamp: &str) -> Vec<u8> {
    /// The flag of pictures with transparent pixels.
    const ALPHA: u8 = 0x10;
    let flags = if has_alpha(picture) { ALPHA } else { 0 };
    let mut extended = vec![flags, 0, 0, 0];
    for side in sides(picture) {
        extended.extend_from_slice(&(side - 1).to_le_bytes()[..3]);
    }
    // The signature has 12 bytes: "RIFF", the size of the rest, "WEBP".
    let pixels = content.get(12..).unwrap_or_default();
    let body = [&chunk(b"VP8X", &extended)[..], pixels, &chunk(CHUNK, stamp.as_bytes())].concat();
    let size = u32::try_from(body.len() + 4).unwrap_or(u32::MAX).to_le_bytes();
    [b"RIFF", &size[..], b"WEBP", &body].concat()
}

/// A chunk of a RIFF file, padded to an even length.
fn chunk(name: &[u8; 4], content: &[u8]) -> Vec<u8> {
    let size = u32::try_from(content.len()).unwrap_or(u32::MAX).to_le_bytes();
    let padding: &[u8] = if content.len().is_multiple_of(2) { &[] } else { &[0] };
    [name, &size[..], content, padding].concat()
}

/// Reads the stamp of a picture. `None` if the file does not exist, has no stamp, or is incomplete.
pub fn read_stamp(path: &Path) -> Option<String> {
    let file = File::open(path).ok()?;
    let length = file.metadata().ok()?.len();
    stamp_in(file, length)
}

/// Works like [`read_stamp`], for the content of a file.
pub fn stamp_of(content: &[u8]) -> Option<String> {
    stamp_in(Cursor::new(content), content.len() as u64)
}

/// Finds the stamp in a file of this length.
fn stamp_in(mut file: impl Read + Seek, length: u64) -> Option<String> {
    let mut head = Vec::with_capacity(HEAD);
    file.by_ref().take(HEAD as u64).read_to_end(&mut head).ok()?;
    let (stamp, is_whole) = match head[..] {
        [0x89, b'P', b'N', b'G', ..] => {
            (png_stamp(&head)?, ends_with(&mut file, b"\0\0\0\0IEND\xAEB`\x82"))
        }
        [0xFF, 0xD8, ..] => (jpeg_stamp(&head)?, ends_with(&mut file, b"\xFF\xD9")),
        [b'R', b'I', b'F', b'F', ..] => webp_stamp(&head, &mut file, length)?,
        [b'P', b'6', b'\n', ..] => ppm_stamp(&head, length)?,
        // A stamp at the end shows that the file is complete.
        [0x76, 0x2F, 0x31, 0x01, ..] | [0x93, b'N', b'U', b'M', ..] => {
            (stamp_at_end(&mut file, length)?, true)
        }
        _ => return None,
    };
    is_whole.then(|| String::from_utf8(stamp).ok()).flatten()
}

/// Returns whether a file ends with these bytes.
fn ends_with(file: &mut (impl Read + Seek), end: &[u8]) -> bool {
    let mut last = Vec::new();
    let back = i64::try_from(end.len()).unwrap_or(i64::MAX);
    let read = file.seek(SeekFrom::End(-back)).and_then(|_| file.read_to_end(&mut last));
    read.is_ok() && last == end
}

/// Finds the text chunk before the pixels.
fn png_stamp(head: &[u8]) -> Option<Vec<u8>> {
    let mut rest = head.get(8..)?;
    loop {
        let (size, after) = rest.split_first_chunk::<4>()?;
        let size = usize::try_from(u32::from_be_bytes(*size)).ok()?;
        let (name, content) = after.split_first_chunk::<4>()?;
        let content = content.get(..size)?;
        if name == b"tEXt"
            && let Some(text) = content.strip_prefix(KEYWORD.as_bytes())
        {
            return text.strip_prefix(b"\0").map(<[u8]>::to_vec);
        }
        // A checksum of four bytes follows the content.
        rest = after.get(4 + size + 4..)?;
    }
}

/// Finds the comment among the segments before the pixels.
fn jpeg_stamp(head: &[u8]) -> Option<Vec<u8>> {
    let mut rest = head.get(2..)?;
    while let [0xFF, kind, high, low, ..] = *rest {
        let size = usize::from(u16::from_be_bytes([high, low]));
        let content = rest.get(4..2 + size)?;
        if kind == 0xFE
            && let Some(text) = content.strip_prefix(MARK.as_bytes())
        {
            return Some(text.to_vec());
        }
        rest = rest.get(2 + size..)?;
    }
    None
}

/// Reads the chunk after the pixels. The file is complete if its size is the stated one.
fn webp_stamp(head: &[u8], file: &mut (impl Read + Seek), length: u64) -> Option<(Vec<u8>, bool)> {
    let number = |at: usize| Some(u32::from_le_bytes(*head.get(at..)?.first_chunk()?));
    // The signature has 12 bytes and the extended header 18.
    if head.get(12..16)? != b"VP8X" {
        return None;
    }
    let pixels = u64::from(number(34)?);
    file.seek(SeekFrom::Start(38 + pixels + pixels % 2)).ok()?;
    let mut last = Vec::new();
    file.take(HEAD as u64).read_to_end(&mut last).ok()?;
    let (name, after) = last.split_first_chunk::<4>()?;
    let (size, content) = after.split_first_chunk::<4>()?;
    let size = usize::try_from(u32::from_le_bytes(*size)).ok()?;
    let stamp = content.get(..size).filter(|_| name == CHUNK)?;
    Some((stamp.to_vec(), u64::from(number(4)?) + 8 == length))
}

/// Reads the stamp after the content.
fn stamp_at_end(file: &mut (impl Read + Seek), length: u64) -> Option<Vec<u8>> {
    let most = (MARK.len() + LONGEST + 1) as u64;
    file.seek(SeekFrom::Start(length.saturating_sub(most))).ok()?;
    let mut last = Vec::new();
    file.read_to_end(&mut last).ok()?;
    let text = last.strip_suffix(b"\n")?;
    let at = text.windows(MARK.len()).rposition(|part| part == MARK.as_bytes())?;
    Some(text[at + MARK.len()..].to_vec())
}

/// Finds the comment in the header. The file is complete if it contains all pixels.
fn ppm_stamp(head: &[u8], length: u64) -> Option<(Vec<u8>, bool)> {
    let mark = ["# ", MARK].concat();
    let mut lines = head.split_inclusive(|byte| *byte == b'\n').take(4);
    let header: usize = lines.clone().map(<[u8]>::len).sum();
    let stamp = lines.nth(1)?.strip_prefix(mark.as_bytes())?.strip_suffix(b"\n")?;
    let sides = std::str::from_utf8(lines.next()?).ok()?;
    let pixels: u64 =
        sides.split_whitespace().filter_map(|side| side.parse::<u64>().ok()).product();
    Some((stamp.to_vec(), u64::try_from(header).ok()? + 3 * pixels == length))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{PICTURE_FORMATS, load_picture, save_encoded};
    use marraztu_core::base::image::Size;

    const STAMP: &str = "v1 0123456789abcdef";

    fn picture(alpha: u8) -> Picture {
        let pixels = vec![[255, 0, 0, 255], [0, 255, 0, alpha], [0, 0, 255, 255]];
        Picture::from_pixels(Size::new(3, 1), pixels).unwrap()
    }

    #[test]
    fn every_format_keeps_its_pixels_and_its_stamp() {
        let folder = tempfile::tempdir().unwrap();
        for format in PICTURE_FORMATS {
            for alpha in [255, 7] {
                let name = format!("{alpha}.{}", format.endings[0]);
                let [plain, stamped] =
                    ["plain-", ""].map(|begin| folder.path().join(format!("{begin}{name}")));
                save_encoded(&plain, &format.encode(&picture(alpha)).unwrap()).unwrap();
                let content = encode_stamped(format, &picture(alpha), STAMP).unwrap();
                save_encoded(&stamped, &content).unwrap();
                assert_eq!(read_stamp(&stamped).as_deref(), Some(STAMP), "{name}");
                assert_eq!(stamp_of(&content).as_deref(), Some(STAMP), "{name}");
                assert_eq!(read_stamp(&plain), None, "{name}");
                assert_eq!(
                    load_picture(&stamped).unwrap(),
                    load_picture(&plain).unwrap(),
                    "{name}"
                );
                // Every file that ends early is incomplete.
                for end in 0..content.len() {
                    std::fs::write(&stamped, &content[..end]).unwrap();
                    assert_eq!(read_stamp(&stamped), None, "{name}, {end} bytes");
                }
            }
        }
        assert_eq!(read_stamp(&folder.path().join("absent.png")), None);
    }

    #[test]
    fn numbers_keep_their_stamp_at_the_end() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        for begin in [&b"\x93NUMPY\x01\x00"[..], b"\x76\x2F\x31\x01"] {
            let plain = [begin, &[0xAB; 400]].concat();
            let content = stamped_at_end(plain.clone(), STAMP);
            assert_eq!(content[..plain.len()], plain);
            std::fs::write(&path, &content).unwrap();
            assert_eq!(read_stamp(&path).as_deref(), Some(STAMP));
            for end in 0..content.len() {
                std::fs::write(&path, &content[..end]).unwrap();
                assert_eq!(read_stamp(&path), None, "{end} bytes");
            }
        }
    }

    #[test]
    fn a_stamp_that_a_file_cannot_hold_is_rejected() {
        for stamp in ["two\nlines", "\u{e9}", &"x".repeat(LONGEST + 1)] {
            assert!(encode_stamped(&PICTURE_FORMATS[0], &picture(255), stamp).is_err(), "{stamp}");
        }
    }
}

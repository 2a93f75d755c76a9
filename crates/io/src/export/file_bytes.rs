//! The bytes of a texture's file, for exports that use its picture as it is.
//!
//! Encoding a photograph as PNG would make it ten times as large, so PNG and JPEG files are copied.
//! A file is copied only if decoding it again gives the texels of the texture: they may have been
//! merged with others, or the file may have changed since it was read.
//!
//! Programs disagree about statements that change how a file is shown: the orientation in Exif,
//! colour spaces and animation. This program ignores them, as glTF 2.0 requires of colour spaces
//! (section 3.8.3), so they are removed from the copy. The compressed texels stay as they are.

use std::path::Path;

use image::ImageFormat;

use crate::examples;
use crate::progress::Progress;
use crate::read::read;
use crate::texture::{MOST_BYTES, decoded};
use marraztu_core::base::image::Picture;

/// An encoded picture.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Encoded {
    pub(super) bytes: Vec<u8>,
    /// The extension of its file, without the dot.
    pub(super) ending: &'static str,
}

/// Returns the bytes of a PNG or JPEG file for a picture; `None` if the file does not hold exactly
/// this picture, or not every program can read it.
pub(super) fn of_picture(source: &Path, picture: &Picture) -> Option<Encoded> {
    let bytes = content(source).ok()?;
    let format = image::guess_format(&bytes).ok()?;
    let bytes = match format {
        ImageFormat::Png => plain_png(&bytes)?,
        ImageFormat::Jpeg => upright_jpeg(bytes)?,
        _ => return None,
    };
    let ending = ending(format);
    (decoded(source, &bytes)? == *picture).then_some(Encoded { bytes, ending })
}

/// Returns the bytes of any file that holds a picture. Fails with the reason if it is missing or
/// holds anything else: a model must not make an export copy other files of the user.
pub(super) fn of_file(source: &Path) -> Result<Encoded, String> {
    let bytes = content(source)?;
    let format = image::guess_format(&bytes).ok();
    // TGA files have no signature.
    let is_tga = || ImageFormat::from_path(source).ok() == Some(ImageFormat::Tga);
    let tga = || (is_tga() && decoded(source, &bytes).is_some()).then_some(ImageFormat::Tga);
    match format.or_else(tga) {
        Some(format) => Ok(Encoded { ending: ending(format), bytes }),
        None => Err("this is not a picture".to_owned()),
    }
}

fn ending(format: ImageFormat) -> &'static str {
    format.extensions_str().first().copied().unwrap_or("picture")
}

fn content(source: &Path) -> Result<Vec<u8>, String> {
    match examples::content(source) {
        Some(content) => Ok(content.into_owned()),
        None => read(source, MOST_BYTES, &Progress::new()).map_err(|error| error.reason()),
    }
}

/// Removes the chunks of a PNG file that ask for another presentation of its texels: colour spaces
/// other than sRGB, pixels that are not square, animation and Exif. `None` if a chunk is cut off.
fn plain_png(bytes: &[u8]) -> Option<Vec<u8>> {
    const SIGNATURE: usize = 8;
    /// Length, kind and checksum.
    const FRAME: usize = 12;
    let mut plain = bytes.get(..SIGNATURE)?.to_vec();
    let mut rest = &bytes[SIGNATURE..];
    while let Some((head, _)) = rest.split_first_chunk::<4>() {
        let length = usize::try_from(u32::from_be_bytes(*head)).ok()?;
        let (chunk, after) = rest.split_at_checked(length.checked_add(FRAME)?)?;
        let kind = chunk[4..].first_chunk::<4>()?;
        if !alters_png(kind, &chunk[8..8 + length]) {
            plain.extend(chunk);
        }
        rest = after;
        if kind == b"IEND" {
            break;
        }
    }
    Some(plain)
}

/// Returns whether a PNG chunk changes how the texels are shown ("PNG Specification", third
/// edition, section 11.3).
fn alters_png(kind: &[u8; 4], content: &[u8]) -> bool {
    /// 100,000 times the chromaticities of white, red, green and blue in sRGB.
    const SRGB: [u32; 8] = [31_270, 32_900, 64_000, 33_000, 30_000, 60_000, 15_000, 6_000];
    /// 100,000 times the gamma that approximates sRGB.
    const GAMMA: [u32; 1] = [45_455];
    let numbers = || content.as_chunks().0.iter().map(|bytes| u32::from_be_bytes(*bytes));
    match kind {
        b"gAMA" => !numbers().eq(GAMMA),
        b"cHRM" => !numbers().eq(SRGB),
        b"pHYs" => content.get(..4) != content.get(4..8),
        b"iCCP" | b"cICP" | b"mDCV" | b"cLLI" | b"eXIf" | b"acTL" | b"fcTL" | b"fdAT" => true,
        _ => false,
    }
}

/// Sets the orientation in the Exif of a JPEG to upright. `None` if the file is not grey or RGB:
/// programs disagree about CMYK, and glTF does not have it.
fn upright_jpeg(mut bytes: Vec<u8>) -> Option<Vec<u8>> {
    let mut at = 2;
    loop {
        let [0xFF, kind] = *bytes.get(at..)?.first_chunk()? else { return None };
        match kind {
            // Fill bytes.
            0xFF => {
                at += 1;
                continue;
            }
            0x01 | 0xD0..=0xD8 => {
                at += 2;
                continue;
            }
            _ => {}
        }
        let length = usize::from(u16::from_be_bytes(*bytes.get(at + 2..)?.first_chunk()?));
        let segment = bytes.get_mut(at + 4..at + 2 + length)?;
        match kind {
            0xE1 => {
                // Exif that is not understood states no orientation.
                let _ = set_upright(segment);
            }
            // A frame header: precision, height, width, and the number of components.
            0xC0..=0xC3 | 0xC5..=0xC7 | 0xC9..=0xCB | 0xCD..=0xCF => {
                return matches!(segment.get(5)?, 1 | 3).then_some(bytes);
            }
            0xDA => return None,
            _ => {}
        }
        at += 2 + length;
    }
}

/// Sets the orientation in an Exif segment to upright, if it has one ("Exif 2.32", 4.6.4: tag 274).
fn set_upright(segment: &mut [u8]) -> Option<()> {
    const HEAD: &[u8] = b"Exif\0\0";
    if !segment.starts_with(HEAD) {
        return None;
    }
    let tiff = &mut segment[HEAD.len()..];
    let little = match tiff.get(..2)? {
        b"II" => true,
        b"MM" => false,
        _ => return None,
    };
    let short = |bytes: [u8; 2]| match little {
        true => u16::from_le_bytes(bytes),
        false => u16::from_be_bytes(bytes),
    };
    let long = *tiff.get(4..)?.first_chunk()?;
    let list = if little { u32::from_le_bytes(long) } else { u32::from_be_bytes(long) };
    let list = usize::try_from(list).ok()?;
    let count = usize::from(short(*tiff.get(list..)?.first_chunk()?));
    for entry in tiff.get_mut(list + 2..)?.chunks_exact_mut(12).take(count) {
        if short([entry[0], entry[1]]) == 274 {
            let upright = if little { [1, 0] } else { [0, 1] };
            entry[8..10].copy_from_slice(&upright);
        }
    }
    Some(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A JPEG of grey noise.
    fn jpeg() -> Vec<u8> {
        let noise = |x: u32, y: u32| image::Luma([(x * 37 + y * 91).to_le_bytes()[0]]);
        let mut jpeg = std::io::Cursor::new(Vec::new());
        image::GrayImage::from_fn(24, 16, noise).write_to(&mut jpeg, ImageFormat::Jpeg).unwrap();
        jpeg.into_inner()
    }

    #[test]
    fn the_orientation_in_exif_is_removed_and_nothing_else_changes() {
        let plain = jpeg();
        let with_exif = |little: bool, orientation: u16| {
            let short = |x: u16| if little { x.to_le_bytes() } else { x.to_be_bytes() };
            let long = |x: u32| if little { x.to_le_bytes() } else { x.to_be_bytes() };
            let mut exif = b"Exif\0\0".to_vec();
            exif.extend(if little { b"II" } else { b"MM" });
            exif.extend(short(42));
            exif.extend(long(8));
            exif.extend(short(2));
            for (tag, value) in [(256, 24), (274, orientation)] {
                exif.extend([short(tag), short(3)].concat());
                exif.extend(long(1));
                exif.extend([short(value), short(0)].concat());
            }
            exif.extend(long(0));
            let length = u16::try_from(exif.len() + 2).unwrap().to_be_bytes();
            [&plain[..2], &[0xFF, 0xE1], &length, &exif, &plain[2..]].concat()
        };
        for little in [true, false] {
            let upright = with_exif(little, 1);
            assert_eq!(upright_jpeg(with_exif(little, 6)), Some(upright.clone()));
            assert_eq!(upright_jpeg(upright.clone()), Some(upright.clone()));
            // The picture of a turned file is the stored one, as on import.
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join("a.jpg");
            std::fs::write(&path, with_exif(little, 6)).unwrap();
            let picture = crate::load_picture(&path).unwrap();
            assert_eq!((picture.size().width, picture.size().height), (24, 16));
            assert_eq!(of_picture(&path, &picture).unwrap().bytes, upright);
        }
        assert_eq!(upright_jpeg(plain.clone()), Some(plain));
    }

    #[test]
    fn a_jpeg_of_four_components_or_without_a_frame_is_not_copied() {
        let mut cmyk = jpeg();
        let frame = cmyk.windows(2).position(|it| it == [0xFF, 0xC0]).unwrap();
        assert_eq!(cmyk[frame + 9], 1);
        cmyk[frame + 9] = 4;
        assert_eq!(upright_jpeg(cmyk), None);
        for end in 0..frame {
            assert_eq!(upright_jpeg(jpeg()[..end].to_vec()), None, "{end}");
        }
    }

    #[test]
    fn chunks_that_change_how_a_png_is_shown_are_removed() {
        let mut png = std::io::Cursor::new(Vec::new());
        image::RgbaImage::new(3, 2).write_to(&mut png, ImageFormat::Png).unwrap();
        let png = png.into_inner();
        // After the signature and the header.
        let with = |kind: &[u8; 4], content: &[u8]| {
            let length = u32::try_from(content.len()).unwrap().to_be_bytes();
            [&png[..33], &length, kind, content, &[0; 4], &png[33..]].concat()
        };
        let numbers = |all: &[u32]| all.iter().flat_map(|n| n.to_be_bytes()).collect::<Vec<u8>>();
        let srgb = [31_270, 32_900, 64_000, 33_000, 30_000, 60_000, 15_000, 6_000];
        let rows: [(&[u8; 4], Vec<u8>, bool); 9] = [
            (b"gAMA", numbers(&[45_455]), true),
            (b"gAMA", numbers(&[100_000]), false),
            (b"cHRM", numbers(&srgb), true),
            (b"cHRM", numbers(&[1; 8]), false),
            (b"pHYs", [numbers(&[9, 9]), vec![1]].concat(), true),
            (b"pHYs", [numbers(&[9, 8]), vec![1]].concat(), false),
            (b"tEXt", b"Comment\0hello".to_vec(), true),
            (b"iCCP", b"p\0\0x".to_vec(), false),
            (b"eXIf", b"II*\0".to_vec(), false),
        ];
        for (kind, content, stays) in rows {
            let given = with(kind, &content);
            let expected = if stays { &given } else { &png };
            assert_eq!(plain_png(&given).as_ref(), Some(expected), "{kind:?} {content:?}");
        }
        assert_eq!(plain_png(&[&png[..], b"more"].concat()), Some(png.clone()));
        assert_eq!(plain_png(&png[..png.len() - 1]), None);
    }
}

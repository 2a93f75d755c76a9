//! Loads textures and other pictures.

use std::collections::BTreeMap;
use std::io::Cursor;
use std::path::{Path, PathBuf};

use image::{ColorType, DynamicImage, ImageDecoder, ImageFormat, ImageReader};

use super::error::{LoadError, shown};
use super::findings::{Finding, FindingKind, Findings};
use super::picture::either;
use super::progress::Progress;
use super::read::read;
use marraztu_core::base::Shared;
use marraztu_core::base::image::{Picture, Size};
use marraztu_core::scene::Texture;

/// The largest side of a texture, in texels.
pub(super) const LARGEST_SIDE: u32 = 16_384;

/// The most memory for decoding a picture.
const MOST_MEMORY: u64 = 2 << 30;

/// The most bytes in a file.
pub(super) const MOST_BYTES: usize = 2 << 30;

/// The input formats of textures, by their common names.
const FORMATS: &[(&str, ImageFormat)] = &[
    ("PNG", ImageFormat::Png),
    ("JPEG", ImageFormat::Jpeg),
    ("WebP", ImageFormat::WebP),
    ("TIFF", ImageFormat::Tiff),
    ("BMP", ImageFormat::Bmp),
    ("TGA", ImageFormat::Tga),
    ("GIF", ImageFormat::Gif),
];

/// The input formats of panoramas beyond those of textures: light in floats.
pub(super) const FLOAT_FORMATS: [ImageFormat; 2] = [ImageFormat::Hdr, ImageFormat::OpenExr];

/// Lists the input formats of textures for a sentence.
pub fn texture_formats() -> String {
    either(FORMATS.iter().map(|(name, _)| (*name).to_owned()))
}

/// Returns the file extensions of textures.
pub fn texture_endings() -> Vec<&'static str> {
    FORMATS.iter().flat_map(|(_, format)| format.extensions_str()).copied().collect()
}

/// The error for a file of another kind.
fn unknown(floats: &[ImageFormat]) -> String {
    match floats {
        [] => format!("this is not a {}", texture_formats()),
        _ => format!("this is neither a Radiance HDR or OpenEXR file nor a {}", texture_formats()),
    }
}

/// Loads a texture that the user chooses: it repeats, and uses the model's texture coordinates.
///
/// # Errors
/// If the file cannot be read or is not a picture.
pub fn load_texture(path: &Path) -> Result<Shared<Texture>, LoadError> {
    load_texture_with(path, &mut Vec::new())
}

/// Works like [`load_texture`], and notes oddities of the file.
///
/// # Errors
/// The same as [`load_texture`].
pub fn load_texture_with(
    path: &Path,
    findings: &mut Vec<Finding>,
) -> Result<Shared<Texture>, LoadError> {
    Pictures::default().texture(path, findings)
}

/// Loads a picture in any input format, whatever its extension. Only the first picture of a GIF is
/// used.
///
/// # Errors
/// If the file cannot be read, is not a picture, or is too large.
pub fn load_picture(path: &Path) -> Result<Picture, LoadError> {
    let (picture, _) = decode(path, usize::MAX)?;
    Ok(picture)
}

/// The pictures of one model or scene: each file is decoded once and shared.
#[derive(Debug, Default)]
pub(super) struct Pictures {
    read: BTreeMap<PathBuf, Result<Read, LoadError>>,
}

/// A picture from a file.
#[derive(Clone, Debug)]
pub(super) struct Read {
    pub(super) picture: Shared<Picture>,
    /// Whether the file is truncated.
    pub(super) cut_off: bool,
}

impl Pictures {
    /// Returns the picture of a file. Fails if it cannot be read, is not a picture, or has more
    /// than `most` texels. The size is checked before decoding.
    pub(super) fn read(&mut self, path: &Path, most: usize) -> Result<Read, LoadError> {
        // One file may have several paths.
        let file = std::fs::canonicalize(path).unwrap_or_else(|_missing| path.to_owned());
        if let Some(read) = self.read.get(&file) {
            let fits = |read: &Read| read.picture.size().area() <= most;
            return match read {
                Ok(read) if !fits(read) => Err(too_many_texels(path)),
                known => known.clone(),
            };
        }
        let read = decode(path, most)
            .map(|(picture, cut_off)| Read { picture: Shared::new(picture), cut_off });
        // A call with a higher limit may still decode it.
        if read.as_ref().err() != Some(&too_many_texels(path)) {
            self.read.insert(file, read.clone());
        }
        read
    }

    /// Returns the texture of a file. It repeats, and uses the model's texture coordinates. Fails
    /// if the file cannot be read or is not a picture.
    pub(super) fn texture(
        &mut self,
        path: &Path,
        findings: &mut Vec<Finding>,
    ) -> Result<Shared<Texture>, LoadError> {
        let Read { picture, cut_off } = self.read(path, usize::MAX)?;
        if cut_off {
            let mut own = Findings::new(&shown(path));
            own.add(FindingKind::TextureCutOff, &shown(path), None);
            findings.extend(own.into_list());
        }
        // An absolute path stays valid when the current folder changes.
        let source = std::path::absolute(path).unwrap_or_else(|_empty| path.to_owned());
        Ok(Shared::new(Texture::new(source, picture)))
    }
}

fn too_many_texels(path: &Path) -> LoadError {
    LoadError::file(&shown(path), "the textures would take more than 2 GB of memory")
}

/// Decodes a file; returns the picture and whether the file is truncated.
fn decode(path: &Path, most: usize) -> Result<(Picture, bool), LoadError> {
    let fail = |reason: &str| LoadError::file(&shown(path), reason);
    let bytes = read(path, MOST_BYTES, &Progress::new())?;
    let (decoded, cut_off) = decode_bytes(path, &bytes, most, &[])?;
    let picture = picture(decoded).ok_or_else(|| fail("the picture is damaged"))?;
    if picture.size().area() == 0 {
        return Err(fail("the picture is empty"));
    }
    Ok((picture, cut_off))
}

/// Decodes the content of a file; `None` if it is damaged, truncated or not a picture.
pub(super) fn decoded(path: &Path, content: &[u8]) -> Option<Picture> {
    let (decoded, cut_off) = decode_bytes(path, content, usize::MAX, &[]).ok()?;
    picture(decoded).filter(|_| !cut_off)
}

/// Decodes the content of a file to 8 bits per channel; with its pixels of 16 bits per channel, row
/// by row, if it has those. Fails if it is not a picture, or too large.
pub(super) fn decode_deep(
    path: &Path,
    content: &[u8],
) -> Result<(Picture, Option<Deep>), LoadError> {
    let (decoded, _) = decode_bytes(path, content, usize::MAX, &[])?;
    let is_deep = matches!(
        decoded.color(),
        ColorType::L16 | ColorType::La16 | ColorType::Rgb16 | ColorType::Rgba16
    );
    let deep = is_deep.then(|| decoded.to_rgba16().into_raw().as_chunks().0.to_vec());
    let picture = picture(decoded).filter(|picture| picture.size().area() > 0);
    let picture = picture.ok_or_else(|| LoadError::file(&shown(path), "the picture is damaged"))?;
    Ok((picture, deep))
}

/// Pixels of 16 bits: red, green, blue and opacity.
type Deep = Vec<[u16; 4]>;

/// Works like [`decode`], for the content of a file with any number of bits per channel, and for
/// pictures in floats of these formats.
pub(super) fn decode_bytes(
    path: &Path,
    bytes: &[u8],
    most: usize,
    floats: &[ImageFormat],
) -> Result<(DynamicImage, bool), LoadError> {
    let file = shown(path);
    let fail = |reason: String| LoadError::file(&file, reason);
    let mut reader = ImageReader::new(Cursor::new(bytes));
    // TGA files have no signature, so the extension decides.
    if let Ok(format) = ImageFormat::from_path(path) {
        reader.set_format(format);
    }
    let mut reader =
        reader.with_guessed_format().map_err(|error| LoadError::system(&file, &error))?;
    let is_known =
        |format: ImageFormat| floats.contains(&format) || !FLOAT_FORMATS.contains(&format);
    if !reader.format().is_some_and(is_known) {
        return Err(fail(unknown(floats)));
    }
    let cut_off = reader.format() == Some(ImageFormat::Jpeg) && jpeg_ends_early(bytes);
    let states_no_alpha = reader.format() == Some(ImageFormat::Tga) && tga_states_no_alpha(bytes);
    // Limits protect against small files that claim huge pictures.
    let mut limits = image::Limits::default();
    limits.max_image_width = Some(LARGEST_SIDE);
    limits.max_image_height = Some(LARGEST_SIDE);
    limits.max_alloc = Some(MOST_MEMORY);
    reader.limits(limits);
    let decoded = move || {
        let decoder = reader.into_decoder()?;
        let (width, height) = decoder.dimensions();
        if width as usize * height as usize > most {
            return Ok(None);
        }
        DynamicImage::from_decoder(decoder).map(Some)
    };
    // A decoder that panics on a damaged file must not crash the editor.
    let mut decoded = std::panic::catch_unwind(std::panic::AssertUnwindSafe(decoded))
        .map_err(|_panic| fail("the picture is damaged".to_owned()))?
        .map_err(|error| fail(reason(&error, floats)))?
        .ok_or_else(|| too_many_texels(path))?;
    // Some programs write alpha without stating it, so only an empty channel is ignored.
    if states_no_alpha
        && let DynamicImage::ImageRgba8(texels) = &mut decoded
        && texels.pixels().all(|texel| texel.0[3] == 0)
    {
        texels.pixels_mut().for_each(|texel| texel.0[3] = 255);
    }
    Ok((decoded, cut_off))
}

fn picture(decoded: DynamicImage) -> Option<Picture> {
    let size = Size::new(decoded.width() as usize, decoded.height() as usize);
    let texels = match decoded {
        DynamicImage::ImageRgb8(texels) => {
            let (texels, _) = texels.as_chunks();
            texels.iter().map(|[r, g, b]| [*r, *g, *b, 255]).collect()
        }
        other => other.into_rgba8().as_chunks().0.to_vec(),
    };
    Picture::from_pixels(size, texels)
}

/// Returns whether a TGA file has 32 bits per texel, but states that none of them are alpha
/// ("Truevision TGA File Format Specification", 1991, fields 5.5 and 5.6).
fn tga_states_no_alpha(bytes: &[u8]) -> bool {
    bytes.get(16..18).is_some_and(|it| it[0] == 32 && it[1] & 15 == 0)
}

/// Returns whether a JPEG lacks its end marker: the decoder then fills the missing part.
fn jpeg_ends_early(bytes: &[u8]) -> bool {
    // Skip the start marker. Segments follow: FF, a kind, and usually a length and content.
    let mut rest = bytes.get(2..).unwrap_or_default();
    while let [first, kind, after @ ..] = rest {
        rest = match (first, kind) {
            (0xFF, 0xD9) => return false,
            // Stuffing, restarts and fill bytes have no content. All other bytes are entropy-coded
            // data.
            (0xFF, 0x00 | 0x01 | 0xD0..=0xD8) => after,
            (0xFF, 0xFF) | (0..=0xFE, _) => &rest[1..],
            _ => {
                let [high, low, ..] = after else { return true };
                let length = usize::from(u16::from_be_bytes([*high, *low]));
                after.get(length..).unwrap_or_default()
            }
        };
    }
    true
}

/// Decodes a built-in picture; `None` if that fails.
pub(super) fn own_picture(content: &[u8]) -> Option<Picture> {
    picture(image::load_from_memory(content).ok()?)
}

fn reason(error: &image::ImageError, floats: &[ImageFormat]) -> String {
    use image::ImageError;
    use image::error::{LimitErrorKind, UnsupportedErrorKind};
    match error {
        ImageError::Limits(limit) if matches!(limit.kind(), LimitErrorKind::DimensionError) => {
            format!("the picture is larger than {LARGEST_SIDE} x {LARGEST_SIDE}")
        }
        ImageError::Limits(_) => {
            format!("the picture takes more than {} GB of memory", MOST_MEMORY >> 30)
        }
        ImageError::Unsupported(it) if matches!(it.kind(), UnsupportedErrorKind::Format(_)) => {
            unknown(floats)
        }
        ImageError::Unsupported(_) => {
            "this kind of the picture's format cannot be read; save it as PNG".to_owned()
        }
        ImageError::Decoding(it) if it.format_hint() == ImageFormat::Hdr.into() => {
            "it is damaged, or of a kind of Radiance HDR that cannot be read (only -Y H +X W, RGB)"
                .to_owned()
        }
        ImageError::Decoding(it) if it.format_hint() == ImageFormat::OpenExr.into() => {
            "it is damaged, or has no channels R, G and B outside of layers".to_owned()
        }
        _ => "the picture is damaged".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A TIFF with a palette of colours, one pixel large.
    fn palette_tiff() -> Vec<u8> {
        let entries = [
            (256, 1),
            (257, 1),
            (258, 8),
            (259, 1),
            (262, 3),
            (273, 122),
            (277, 1),
            (278, 1),
            (279, 1),
        ];
        let mut tiff = b"II*\0\x08\0\0\0\x09\0".to_vec();
        for (tag, value) in entries {
            tiff.extend([tag, 3].into_iter().flat_map(u16::to_le_bytes));
            tiff.extend([1, value].into_iter().flat_map(u32::to_le_bytes));
        }
        tiff.extend([0; 5]);
        tiff
    }

    #[test]
    fn a_kind_of_a_format_that_is_not_read_is_no_unknown_format() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("p.tif");
        std::fs::write(&path, palette_tiff()).unwrap();
        let error = load_picture(&path).unwrap_err().to_string();
        assert!(error.contains("cannot be read; save it as PNG"), "{error}");
    }

    #[test]
    fn every_kind_of_picture_is_read_whatever_its_name_ends_in() {
        let folder = tempfile::tempdir().unwrap();
        let texels = [[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255], [255, 255, 255, 255]];
        let drawn = image::RgbaImage::from_fn(8, 8, |x, y| {
            image::Rgba(texels[(x / 4 + y / 4 * 2) as usize])
        });
        for (_, format) in FORMATS.iter().copied() {
            // Only TGA files have no signature.
            let path =
                folder.path().join(if format == ImageFormat::Tga { "a.tga" } else { "a.picture" });
            let written = DynamicImage::from(drawn.clone()).to_rgb8();
            written.save_with_format(&path, format).unwrap();
            let read = load_picture(&path).unwrap();
            assert_eq!(read.size(), Size::new(8, 8), "{format:?}");
            for (x, y, texel) in [(0, 0, texels[0]), (7, 0, texels[1]), (0, 7, texels[2])] {
                for (got, expected) in read.pixel(x, y).into_iter().zip(texel) {
                    // JPEG blurs; a swapped row or channel would differ by more.
                    assert!(got.abs_diff(expected) < 64, "{format:?} at {x}, {y}: {got}");
                }
            }
        }
    }

    #[test]
    fn a_tga_without_attribute_bits_is_not_wholly_transparent() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.tga");
        // An uncompressed picture of 2 x 1 texels: blue, green, red, alpha.
        let pixel = |attributes: u8, alphas: [u8; 2]| {
            let mut bytes = [0; 26];
            bytes[2] = 2;
            (bytes[12], bytes[14]) = (2, 1);
            (bytes[16], bytes[17]) = (32, attributes);
            bytes[18..].copy_from_slice(&[0, 0, 255, alphas[0], 9, 0, 0, alphas[1]]);
            std::fs::write(&path, bytes).unwrap();
            load_picture(&path).unwrap().pixels().to_vec()
        };
        assert_eq!(pixel(0, [0, 0]), [[255, 0, 0, 255], [0, 0, 9, 255]]);
        // Some programs write alpha without stating it.
        assert_eq!(pixel(0, [0, 200]), [[255, 0, 0, 0], [0, 0, 9, 200]]);
        assert_eq!(pixel(8, [0, 0]), [[255, 0, 0, 0], [0, 0, 9, 0]]);
    }

    #[test]
    fn a_file_that_is_not_a_picture_or_is_too_large_or_truncated_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        let file = format!("{}: ", path.display());
        let refusal = || {
            let refusal = load_picture(&path).unwrap_err().to_string();
            refusal.strip_prefix(&file).unwrap().to_owned()
        };
        assert_eq!(refusal(), "there is no such file");
        image::RgbImage::new(16_385, 1).save(&path).unwrap();
        assert_eq!(refusal(), "the picture is larger than 16384 x 16384");
        image::RgbImage::new(64, 64).save(&path).unwrap();
        let whole = std::fs::read(&path).unwrap();
        std::fs::write(&path, &whole[..whole.len() / 2]).unwrap();
        assert!(refusal().starts_with("the picture is damaged"), "{}", refusal());
        std::fs::write(&path, b"hello").unwrap();
        assert!(refusal().starts_with("the picture is damaged"), "{}", refusal());
    }

    #[test]
    fn a_jpeg_that_ends_early_is_read_with_a_finding_wherever_it_is_cut() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.jpg");
        let noise =
            |x: u32, y: u32| image::Rgb([x * 37 + y * 91, x * y, x].map(|n| n.to_le_bytes()[0]));
        image::RgbImage::from_fn(64, 64, noise).save(&path).unwrap();
        let whole = std::fs::read(&path).unwrap();
        let found = |bytes: &[u8]| {
            std::fs::write(&path, bytes).unwrap();
            let mut findings = Vec::new();
            let loaded = load_texture_with(&path, &mut findings);
            loaded.map(|_| findings.iter().map(|finding| finding.kind).collect::<Vec<_>>())
        };
        assert_eq!(found(&whole), Ok(vec![]));
        assert_eq!(found(&[&whole[..], b"more"].concat()), Ok(vec![]));
        for part in 1..8 {
            let cut = whole.len() / 2 + whole.len() * part / 16;
            assert_eq!(found(&whole[..cut]), Ok(vec![FindingKind::TextureCutOff]), "{cut}");
        }
    }

    #[test]
    fn a_picture_is_decoded_once_and_never_if_its_texels_are_too_many() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        image::RgbImage::new(16, 16).save(&path).unwrap();
        let mut pictures = Pictures::default();
        let first = pictures.read(&path, 256).unwrap().picture;
        let again = pictures.read(&folder.path().join("./a.png"), 256).unwrap().picture;
        assert!(Shared::same(&first, &again));
        assert_eq!(pictures.read(&path, 255).unwrap_err(), too_many_texels(&path));
        // A header without texels: the size is rejected before memory is allocated.
        let whole = std::fs::read(&path).unwrap();
        let headless = folder.path().join("b.png");
        std::fs::write(&headless, &whole[..50]).unwrap();
        assert_eq!(decode(&headless, 255).unwrap_err(), too_many_texels(&headless));
        assert_ne!(decode(&headless, 256).unwrap_err(), too_many_texels(&headless));
    }
}

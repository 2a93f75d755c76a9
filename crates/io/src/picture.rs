//! Saves pictures.
//!
//! PNG and PPM are written in bands of rows, directly into the file, so a picture of a gigabyte is
//! never copied.

use std::borrow::Cow;
use std::fs::File;
use std::io::{Read, Write};
use std::path::Path;

use image::codecs::jpeg::JpegEncoder;
use image::codecs::webp::WebPEncoder;
use image::{ExtendedColorType, GenericImageView, ImageEncoder, ImageError, Rgb};

use super::replace::{SaveError, Worth, check_target, replace, replace_by};
use marraztu_core::base::image::{Picture, Size};

/// The quality of a JPEG, from 1 to 100: artefacts are barely visible.
const JPEG_QUALITY: u8 = 92;

/// The first bytes of an array of NumPy.
pub(super) const NUMPY: &[u8] = b"\x93NUMPY";

/// The number of bytes that identify the format of a picture.
const SIGNATURE: u64 = 64;

/// An output format of pictures.
#[derive(Debug)]
pub struct PictureFormat {
    /// The common name.
    pub name: &'static str,
    /// The extensions in lower case, the usual one first.
    pub endings: &'static [&'static str],
    /// Whether pixels can be transparent.
    pub has_alpha: bool,
    encode: fn(&Picture, &mut dyn Write) -> Result<(), std::io::Error>,
    /// Encodes rows as they come; `None` if the encoder needs all of them at once.
    stream: Option<Stream>,
}

type Stream = fn(&Header<'_>, &mut Rows<'_>, &mut dyn Write) -> std::io::Result<()>;

/// Passes the rows of a picture to a function, from top to bottom.
type Rows<'a> = dyn FnMut(&mut Put<'_>) -> std::io::Result<()> + 'a;

type Put<'a> = dyn FnMut(&Picture) -> std::io::Result<()> + 'a;

/// The output formats of pictures.
pub static PICTURE_FORMATS: &[PictureFormat] = &[
    PictureFormat {
        name: "PNG",
        endings: &["png"],
        has_alpha: true,
        encode: |picture, to| write_png_with(picture, None, to),
        stream: Some(stream_png),
    },
    PictureFormat {
        name: "JPEG",
        endings: &["jpg", "jpeg"],
        has_alpha: false,
        encode: |picture, to| {
            let mut encoder = JpegEncoder::new_with_quality(to, JPEG_QUALITY);
            encoder.encode_image(&Opaque(picture)).map_err(cause)
        },
        stream: None,
    },
    PictureFormat {
        name: "WebP",
        endings: &["webp"],
        has_alpha: true,
        encode: |picture, to| {
            let [width, height] = sides(picture);
            let (bytes, kind) = match has_alpha(picture) {
                true => (Cow::Borrowed(picture.pixels().as_flattened()), ExtendedColorType::Rgba8),
                false => (Cow::Owned(opaque_bytes(picture.pixels())), ExtendedColorType::Rgb8),
            };
            let written = WebPEncoder::new_lossless(to).write_image(&bytes, width, height, kind);
            written.map_err(cause)
        },
        stream: None,
    },
    PictureFormat {
        name: "PPM",
        endings: &["ppm"],
        has_alpha: false,
        encode: |picture, to| {
            let header = Header { size: picture.size(), has_alpha: false, text: None };
            stream_ppm(&header, &mut |put| put(picture), to)
        },
        stream: Some(stream_ppm),
    },
];

impl PictureFormat {
    /// Returns the format for a file's extension.
    ///
    /// # Errors
    /// All supported extensions, if the name has another one.
    pub fn of(path: &Path) -> Result<&'static Self, String> {
        let ending = path.extension().map(|ending| ending.to_ascii_lowercase());
        let ending = ending.as_deref().and_then(|ending| ending.to_str()).unwrap_or_default();
        let found = PICTURE_FORMATS.iter().find(|format| format.endings.contains(&ending));
        found.ok_or_else(|| format!("its name has to end in {}", Self::usual_endings()))
    }

    /// Lists the usual extensions of all formats: ".png, .jpg, .webp or .ppm".
    pub fn usual_endings() -> String {
        either(PICTURE_FORMATS.iter().map(|format| format!(".{}", format.endings[0])))
    }

    /// Encodes a picture as the bytes of a file.
    ///
    /// # Errors
    /// The reason, if the format cannot hold it.
    pub fn encode(&self, picture: &Picture) -> Result<Vec<u8>, String> {
        let mut content = Vec::new();
        (self.encode)(picture, &mut content).map_err(|error| error.to_string())?;
        Ok(content)
    }

    /// Encodes a picture of this size that arrives in bands. `transparent` says whether pixels may
    /// be transparent; if the picture is a single band, its pixels are asked.
    ///
    /// # Errors
    /// If `next` fails, or `to` cannot be written.
    pub fn encode_bands(
        &self,
        size: Size,
        transparent: bool,
        next: &mut NextBand<'_>,
        to: &mut dyn Write,
    ) -> std::io::Result<()> {
        let Some(first) = next()? else { return Ok(()) };
        if first.size() == size {
            return (self.encode)(&first, to);
        }
        let Some(stream) = self.stream else {
            let mut pixels = Vec::with_capacity(size.area());
            pixels.extend_from_slice(first.pixels());
            drop(first);
            while let Some(band) = next()? {
                pixels.extend_from_slice(band.pixels());
            }
            let whole = Picture::from_pixels(size, pixels);
            let whole = whole.ok_or_else(|| std::io::Error::other("a part is missing"))?;
            return (self.encode)(&whole, to);
        };
        let mut first = Some(first);
        let mut rows = |put: &mut Put<'_>| {
            first.take().map_or(Ok(()), |band| put(&band))?;
            while let Some(band) = next()? {
                put(&band)?;
            }
            Ok(())
        };
        stream(&Header { size, has_alpha: transparent, text: None }, &mut rows, to)
    }
}

/// The facts at the start of a file.
struct Header<'t> {
    size: Size,
    has_alpha: bool,
    /// A keyword with a text.
    text: Option<(&'t str, &'t str)>,
}

/// Joins words for a sentence: "a, b or c".
pub(super) fn either(words: impl Iterator<Item = String>) -> String {
    let words: Vec<String> = words.collect();
    match words.split_last() {
        Some((last, [])) => last.clone(),
        Some((last, others)) => format!("{} or {last}", others.join(", ")),
        None => String::new(),
    }
}

/// Saves a picture in the format of the path's extension.
///
/// # Errors
/// If the extension is unknown, or the file cannot be written; an existing file is unchanged.
pub fn save_picture(path: &Path, picture: &Picture) -> Result<(), SaveError> {
    let fail = |reason: String| SaveError::new(path, reason);
    let format = PictureFormat::of(path).map_err(fail)?;
    replace_by(path, Worth::Product, &mut |file| {
        let mut file = std::io::BufWriter::new(file);
        (format.encode)(picture, &mut file)?;
        file.flush()
    })
}

/// Saves a picture that arrives in bands of rows, from top to bottom. PNG and PPM are written band
/// by band; other formats need the whole picture.
///
/// # Errors
/// If the extension is unknown, `next` fails, or the file cannot be written; an existing file is
/// unchanged.
pub fn save_bands(
    path: &Path,
    size: Size,
    transparent: bool,
    next: &mut NextBand<'_>,
) -> Result<(), SaveError> {
    let format = PictureFormat::of(path).map_err(|reason| SaveError::new(path, reason))?;
    replace_by(path, Worth::Product, &mut |file| {
        let mut file = std::io::BufWriter::new(file);
        format.encode_bands(size, transparent, next, &mut file)?;
        file.flush()
    })
}

/// A function that returns the next rows of a picture, and `None` after the last ones.
pub type NextBand<'a> = dyn FnMut() -> std::io::Result<Option<Picture>> + 'a;

/// Saves an encoded picture.
///
/// # Errors
/// If the file cannot be written; an existing file is unchanged.
pub fn save_encoded(path: &Path, content: &[u8]) -> Result<(), SaveError> {
    replace(path, content, Worth::Product)
}

/// Checks that the format for `path` has an alpha channel, for transparent pictures.
///
/// # Errors
/// If it has no alpha channel.
pub fn check_alpha(path: &Path) -> Result<(), SaveError> {
    let fail = |reason: String| SaveError::new(path, reason);
    let format = PictureFormat::of(path).map_err(fail)?;
    if format.has_alpha {
        return Ok(());
    }
    let able = PICTURE_FORMATS.iter().filter(|format| format.has_alpha);
    let able = either(able.map(|format| format!(".{}", format.endings[0])));
    Err(fail(format!("{} has no transparent pixels; choose a name in {able}", format.name)))
}

/// Checks, before anything is drawn, whether a picture can be saved at `path`. An existing file
/// must be a picture, or empty.
///
/// # Errors
/// If it cannot.
pub fn check_picture_target(path: &Path) -> Result<(), SaveError> {
    PictureFormat::of(path).map_err(|reason| SaveError::new(path, reason))?;
    check_layer_target(path)
}

/// Works like [`check_picture_target`], for any format of layers.
///
/// # Errors
/// If a file cannot be saved at `path`.
pub fn check_layer_target(path: &Path) -> Result<(), SaveError> {
    check_target(path)?;
    check_replaced(path)
}

/// Checks that an existing file at `path` is a picture, or empty.
///
/// # Errors
/// If it is another file.
pub fn check_replaced(path: &Path) -> Result<(), SaveError> {
    let fail = |reason: &str| SaveError::new(path, reason);
    let mut begin = Vec::new();
    let Ok(file) = File::open(path) else { return Ok(()) };
    match file.take(SIGNATURE).read_to_end(&mut begin) {
        Ok(0) => Ok(()),
        Ok(_) if image::guess_format(&begin).is_ok() || begin.starts_with(NUMPY) => Ok(()),
        _ => Err(fail("a file with this name exists and is not a picture; choose another name")),
    }
}

/// The number of rows that are converted at a time.
const BAND: usize = 64;

/// Returns whether any pixel is transparent.
pub(super) fn has_alpha(picture: &Picture) -> bool {
    picture.pixels().iter().any(|pixel| pixel[3] != 255)
}

/// A picture without its alpha channel, for encoders that ask for pixels.
struct Opaque<'a>(&'a Picture);

impl GenericImageView for Opaque<'_> {
    type Pixel = Rgb<u8>;

    fn dimensions(&self) -> (u32, u32) {
        sides(self.0).into()
    }

    fn get_pixel(&self, x: u32, y: u32) -> Rgb<u8> {
        let [r, g, b, _] = self.0.pixel(x as usize, y as usize);
        Rgb([r, g, b])
    }
}

/// Returns the width and height of a picture, as formats store them.
pub(super) fn sides(picture: &Picture) -> [u32; 2] {
    sides_of(picture.size())
}

pub(super) fn sides_of(size: Size) -> [u32; 2] {
    [size.width, size.height].map(|side| u32::try_from(side).unwrap_or(u32::MAX))
}

/// Encodes a picture as PNG with a comment.
pub(crate) fn png_with_comment(picture: &Picture, comment: &str) -> Result<Vec<u8>, String> {
    png_with_text(picture, "Comment", comment)
}

/// Encodes a picture as PNG with a text chunk.
pub(crate) fn png_with_text(
    picture: &Picture,
    keyword: &str,
    text: &str,
) -> Result<Vec<u8>, String> {
    let mut content = Vec::new();
    let written = write_png_with(picture, Some((keyword, text)), &mut content);
    written.map(|()| content).map_err(|error| error.to_string())
}

fn write_png_with(
    picture: &Picture,
    text: Option<(&str, &str)>,
    to: &mut dyn Write,
) -> std::io::Result<()> {
    let (size, has_alpha) = (picture.size(), has_alpha(picture));
    stream_png(&Header { size, has_alpha, text }, &mut |put| put(picture), to)
}

/// Returns the error of the file that an encoder of `image` passes on.
fn cause(error: ImageError) -> std::io::Error {
    match error {
        ImageError::IoError(error) => error,
        error => std::io::Error::other(error),
    }
}

fn stream_png(header: &Header<'_>, rows: &mut Rows<'_>, to: &mut dyn Write) -> std::io::Result<()> {
    let mut watched = Watched { to, failed: None };
    encode_png(header, rows, &mut watched).map_err(|error| match (watched.failed, error) {
        (Some(error), _) | (None, png::EncodingError::IoError(error)) => error,
        (None, error) => error.into(),
    })
}

/// Keeps the last error of a file: the encoder of PNG passes on its text alone.
struct Watched<'a> {
    to: &'a mut dyn Write,
    failed: Option<std::io::Error>,
}

impl Write for Watched<'_> {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        let written = self.to.write(bytes);
        written.map_err(|error| std::io::Error::from(self.failed.insert(error).kind()))
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.to.flush()
    }
}

fn encode_png(
    header: &Header<'_>,
    rows: &mut Rows<'_>,
    to: &mut dyn Write,
) -> Result<(), png::EncodingError> {
    let [width, height] = sides_of(header.size);
    let mut encoder = png::Encoder::new(to, width, height);
    encoder.set_color(if header.has_alpha { png::ColorType::Rgba } else { png::ColorType::Rgb });
    encoder.set_depth(png::BitDepth::Eight);
    // Fast compression with adaptive filters: drawing should not wait for the encoder.
    encoder.set_compression(png::Compression::Fast);
    encoder.set_filter(png::Filter::Adaptive);
    if let Some((keyword, text)) = header.text {
        encoder.add_text_chunk(keyword.to_owned(), text.to_owned())?;
    }
    let mut writer = encoder.write_header()?;
    let mut stream = writer.stream_writer()?;
    rows(&mut |picture| {
        picture.pixels().chunks(BAND * picture.size().width.max(1)).try_for_each(
            |band| match header.has_alpha {
                true => stream.write_all(band.as_flattened()),
                false => stream.write_all(&opaque_bytes(band)),
            },
        )
    })?;
    stream.finish()?;
    writer.finish()
}

fn stream_ppm(header: &Header<'_>, rows: &mut Rows<'_>, to: &mut dyn Write) -> std::io::Result<()> {
    write!(to, "P6\n{} {}\n255\n", header.size.width, header.size.height)?;
    rows(&mut |picture| {
        let mut bands = picture.pixels().chunks(BAND * picture.size().width.max(1));
        bands.try_for_each(|band| to.write_all(&opaque_bytes(band)))
    })
}

fn opaque_bytes(pixels: &[[u8; 4]]) -> Vec<u8> {
    pixels.iter().flat_map(|[r, g, b, _]| [*r, *g, *b]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::load_picture;
    use marraztu_core::base::rng::Rng;

    fn picture(alpha: u8) -> Picture {
        let pixels = vec![[255, 0, 0, 255], [0, 255, 0, alpha], [0, 0, 255, 255], [1, 2, 3, 255]];
        Picture::from_pixels(Size::new(2, 2), pixels).unwrap()
    }

    #[test]
    fn a_png_comes_back_as_it_went_with_and_without_alpha() {
        let folder = tempfile::tempdir().unwrap();
        for alpha in [255, 0, 7] {
            let path = folder.path().join(format!("{alpha}.PNG"));
            save_picture(&path, &picture(alpha)).unwrap();
            assert_eq!(load_picture(&path).unwrap(), picture(alpha));
        }
    }

    #[test]
    fn a_webp_comes_back_as_it_went_and_a_jpeg_nearly() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.webp");
        for alpha in [255, 7] {
            save_picture(&path, &picture(alpha)).unwrap();
            assert_eq!(load_picture(&path).unwrap(), picture(alpha));
        }
        let gray = Picture::filled(Size::new(16, 16), [100, 110, 120, 255]);
        for name in ["a.jpg", "a.JPEG"] {
            let path = folder.path().join(name);
            save_picture(&path, &gray).unwrap();
            assert!(std::fs::read(&path).unwrap().starts_with(b"\xFF\xD8\xFF"));
            let [r, g, b, _] = load_picture(&path).unwrap().pixel(5, 5);
            let near = |a: u8, b: u8| a.abs_diff(b) <= 2;
            assert!(near(r, 100) && near(g, 110) && near(b, 120), "{r} {g} {b}");
        }
    }

    #[test]
    fn a_target_is_a_picture_or_a_new_file_in_a_folder_that_is_there() {
        let folder = tempfile::tempdir().unwrap();
        let reason = |name: &str| {
            let checked = check_picture_target(&folder.path().join(name));
            checked.map_err(|error| error.reason)
        };
        save_picture(&folder.path().join("a.png"), &picture(255)).unwrap();
        std::fs::write(folder.path().join("empty.jpg"), "").unwrap();
        std::fs::write(folder.path().join("poem.ppm"), "Roses are red").unwrap();
        std::fs::create_dir(folder.path().join("b.png")).unwrap();
        assert_eq!(["a.png", "empty.jpg", "new.webp"].map(reason), [Ok(()), Ok(()), Ok(())]);
        for (name, word) in [
            ("poem.ppm", "exists and is not a picture"),
            ("b.png", "this is a folder"),
            ("none/a.png", "does not exist"),
            ("poem.ppm/a.png", "is not a folder"),
            ("a.tiff", "has to end in"),
        ] {
            assert!(reason(name).unwrap_err().contains(word), "{name}: {:?}", reason(name));
        }
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 4, "nothing was left there");
    }

    #[test]
    fn a_ppm_is_three_bytes_a_pixel_after_its_size() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.ppm");
        save_picture(&path, &picture(255)).unwrap();
        let content = std::fs::read(&path).unwrap();
        assert_eq!(content, b"P6\n2 2\n255\n\xFF\0\0\0\xFF\0\0\0\xFF\x01\x02\x03");
    }

    #[test]
    fn another_ending_is_refused_and_a_failed_save_leaves_nothing_behind() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.tiff");
        let error = save_picture(&path, &picture(255)).unwrap_err();
        let reason = "could not be saved: its name has to end in .png, .jpg, .webp or .ppm";
        assert_eq!(error.to_string(), format!("{} {reason}", path.display()));
        std::fs::create_dir(folder.path().join("b.png")).unwrap();
        assert!(save_picture(&folder.path().join("b.png"), &picture(255)).is_err());
        assert!(save_picture(&folder.path().join("none/c.png"), &picture(255)).is_err());
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    /// Bands of one row are read back as the same pixels as the whole picture.
    #[test]
    fn a_picture_in_bands_is_the_same_file_and_an_incomplete_one_is_none() {
        let folder = tempfile::tempdir().unwrap();
        let size = Size::new(2, 2);
        let band = |row: usize, alpha: u8| {
            let pixels = picture(alpha).pixels()[2 * row..][..2].to_vec();
            Picture::from_pixels(Size::new(2, 1), pixels).unwrap()
        };
        for (format, alpha) in PICTURE_FORMATS.iter().flat_map(|it| [(it, 255), (it, 7)]) {
            let path = folder.path().join(format!("a.{}", format.endings[0]));
            let mut rows = [0, 1].map(|row| band(row, alpha)).into_iter();
            save_bands(&path, size, alpha < 255, &mut || Ok(rows.next())).unwrap();
            let file = std::fs::read(&path).unwrap();
            assert!(file == format.encode(&picture(alpha)).unwrap(), "{} {alpha}", format.name);
            let fails: &mut NextBand<'_> = &mut || Err(std::io::Error::other("no more"));
            assert!(save_bands(&folder.path().join("b.png"), size, false, fails).is_err());
        }
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), PICTURE_FORMATS.len());
    }

    #[test]
    fn every_format_passes_on_that_the_disk_is_full() {
        struct Full(usize);
        impl Write for Full {
            fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
                let left = self.0.checked_sub(bytes.len());
                self.0 = left.ok_or(std::io::ErrorKind::StorageFull)?;
                Ok(bytes.len())
            }
            fn flush(&mut self) -> std::io::Result<()> {
                Ok(())
            }
        }
        let mut rng = Rng::new(1);
        let pixels = (0..300 * 300).map(|_| [0; 4].map(|_| rng.index(256).to_le_bytes()[0]));
        let noise = Picture::from_pixels(Size::new(300, 300), pixels.collect()).unwrap();
        for (format, room) in PICTURE_FORMATS.iter().flat_map(|it| [(it, 0), (it, 9999)]) {
            let error = (format.encode)(&noise, &mut Full(room)).unwrap_err();
            assert_eq!(error.kind(), std::io::ErrorKind::StorageFull, "{} {room}", format.name);
        }
    }
}

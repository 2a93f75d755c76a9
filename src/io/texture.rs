//! Pictures to be laid over surfaces.

use std::path::Path;

use super::error::{LoadError, short_name};
use crate::base::Shared;
use crate::base::image::{Picture, Size};
use crate::scene::{Texture, Wrap};

/// The largest side of a texture, in texels.
const LARGEST_SIDE: u32 = 16_384;

/// Why a file is refused whose format is not known.
const NO_PICTURE: &str = "this is no PNG, JPEG, WebP, TIFF, BMP, TGA or GIF";

/// The most memory that reading a picture may take.
const MOST_MEMORY: u64 = 2 << 30;

/// Reads a texture that the user gives by hand: it repeats, and lies as the model's places say.
///
/// # Errors
/// Where the file cannot be read or is no picture.
pub fn load_texture(path: &Path) -> Result<Shared<Texture>, LoadError> {
    Ok(Shared::new(Texture {
        // Complete, so that it holds wherever the program goes on to work.
        source: std::path::absolute(path).unwrap_or_else(|_empty| path.to_owned()),
        picture: load_picture(path)?,
        wrap: Wrap::Repeat,
        offset: [0.0; 2],
        scale: [1.0; 2],
    }))
}

/// Reads a PNG, JPEG, WebP, TIFF, BMP, TGA or GIF (its first picture), whatever its name ends in.
///
/// # Errors
/// Where the file cannot be read, is no picture, or too large a one.
pub fn load_picture(path: &Path) -> Result<Picture, LoadError> {
    let file = short_name(path);
    let system = |error: std::io::Error| LoadError::system(&file, &error);
    let reader = image::ImageReader::open(path).map_err(system)?;
    let mut reader = reader.with_guessed_format().map_err(system)?;
    if reader.format().is_none() {
        return Err(LoadError::file(&file, NO_PICTURE));
    }
    let mut limits = image::Limits::default();
    limits.max_image_width = Some(LARGEST_SIDE);
    limits.max_image_height = Some(LARGEST_SIDE);
    limits.max_alloc = Some(MOST_MEMORY);
    reader.limits(limits);
    // A decoder that breaks down on a damaged file must not take the editor with it.
    let decoded = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| reader.decode()))
        .map_err(|_panic| LoadError::file(&file, "the picture is damaged"))?
        .map_err(|error| LoadError::file(&file, reason(&error)))?;
    let texels = decoded.into_rgba8();
    let size = Size::new(texels.width() as usize, texels.height() as usize);
    if size.area() == 0 {
        return Err(LoadError::file(&file, "the picture is empty"));
    }
    Picture::from_pixels(size, texels.as_raw().as_chunks().0.to_vec())
        .ok_or_else(|| LoadError::file(&file, "the picture is damaged"))
}

/// A picture that the program carries; `None` where it is none.
pub(super) fn own_picture(content: &[u8]) -> Option<Picture> {
    let texels = image::load_from_memory(content).ok()?.into_rgba8();
    let size = Size::new(texels.width() as usize, texels.height() as usize);
    Picture::from_pixels(size, texels.as_raw().as_chunks().0.to_vec())
}

fn reason(error: &image::ImageError) -> String {
    use image::ImageError;
    use image::error::LimitErrorKind;
    match error {
        ImageError::Limits(limit) if matches!(limit.kind(), LimitErrorKind::DimensionError) => {
            format!("the picture is larger than {LARGEST_SIDE} x {LARGEST_SIDE}")
        }
        ImageError::Limits(_) => {
            format!("the picture takes more than {} GB of memory", MOST_MEMORY >> 30)
        }
        ImageError::IoError(error) => super::error::reason(error),
        ImageError::Unsupported(_) => NO_PICTURE.to_owned(),
        other => format!("the picture is damaged: {other}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_of_picture_is_read_whatever_its_name_ends_in() {
        use image::ImageFormat::{Bmp, Gif, Jpeg, Png, Tga, Tiff, WebP};
        let folder = tempfile::tempdir().unwrap();
        let texels = [[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255], [255, 255, 255, 255]];
        let drawn = image::RgbaImage::from_fn(8, 8, |x, y| {
            image::Rgba(texels[(x / 4 + y / 4 * 2) as usize])
        });
        for format in [Bmp, Gif, Jpeg, Png, Tga, Tiff, WebP] {
            // Only a TGA has nothing in it that tells what it is.
            let path = folder.path().join(if format == Tga { "a.tga" } else { "a.picture" });
            let written = image::DynamicImage::from(drawn.clone()).to_rgb8();
            written.save_with_format(&path, format).unwrap();
            let read = load_picture(&path).unwrap();
            assert_eq!(read.size(), Size::new(8, 8), "{format:?}");
            for (x, y, texel) in [(0, 0, texels[0]), (7, 0, texels[1]), (0, 7, texels[2])] {
                for (got, expected) in read.pixel(x, y).into_iter().zip(texel) {
                    // JPEG blurs; a row or a channel in the wrong place is farther off.
                    assert!(got.abs_diff(expected) < 64, "{format:?} at {x}, {y}: {got}");
                }
            }
        }
    }

    #[test]
    fn a_picture_that_is_none_or_too_large_or_cut_off_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        let refusal = || load_picture(&path).unwrap_err().to_string();
        assert_eq!(refusal(), "a.png: there is no such file");
        image::RgbImage::new(16_385, 1).save(&path).unwrap();
        assert_eq!(refusal(), "a.png: the picture is larger than 16384 x 16384");
        image::RgbImage::new(64, 64).save(&path).unwrap();
        let whole = std::fs::read(&path).unwrap();
        std::fs::write(&path, &whole[..whole.len() / 2]).unwrap();
        assert!(refusal().starts_with("a.png: "), "{}", refusal());
        std::fs::write(&path, b"hello").unwrap();
        assert!(refusal().starts_with("a.png: the picture is damaged"), "{}", refusal());
    }
}

//! Pictures to be laid over surfaces.

use std::path::Path;

use super::error::{LoadError, short_name};
use crate::base::Shared;
use crate::base::image::{Picture, Size};
use crate::scene::{Texture, Wrap};

/// The largest side of a texture, in texels.
const LARGEST_SIDE: u32 = 16_384;

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

/// Reads a PNG, JPEG, BMP, TGA or GIF (its first picture), whatever its name ends in.
///
/// # Errors
/// Where the file cannot be read, is no picture, or too large a one.
pub fn load_picture(path: &Path) -> Result<Picture, LoadError> {
    let file = short_name(path);
    let system = |error: std::io::Error| LoadError::system(&file, &error);
    let reader = image::ImageReader::open(path).map_err(system)?;
    let mut reader = reader.with_guessed_format().map_err(system)?;
    if reader.format().is_none() {
        return Err(LoadError::file(&file, "this is no PNG, JPEG, BMP, TGA or GIF"));
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

fn reason(error: &image::ImageError) -> String {
    use image::ImageError;
    match error {
        ImageError::Limits(_) => {
            format!("the picture is larger than {LARGEST_SIDE} x {LARGEST_SIDE}")
        }
        ImageError::IoError(error) => super::error::reason(error),
        ImageError::Unsupported(_) => "this is no PNG, JPEG, BMP, TGA or GIF".to_owned(),
        other => format!("the picture is damaged: {other}"),
    }
}

//! Pictures to the disk.

use std::path::Path;

use image::{ExtendedColorType, ImageEncoder};

use super::replace::{SaveError, Worth, replace};
use crate::base::image::Picture;

/// Saves a picture as PNG or PPM, by the ending of its name.
///
/// A PNG has an alpha channel only where a pixel needs one; a PPM has none.
///
/// # Errors
/// Where the name ends in anything else, or the file cannot be written; what was there before still
/// is.
pub fn save_picture(path: &Path, picture: &Picture) -> Result<(), SaveError> {
    let ending = path.extension().map(|ending| ending.to_ascii_lowercase());
    let content = match ending.as_deref().and_then(|ending| ending.to_str()) {
        Some("png") => png(picture).map_err(|error| SaveError::new(path, error.to_string()))?,
        Some("ppm") => ppm(picture),
        _ => return Err(SaveError::new(path, "its name has to end in .png or .ppm")),
    };
    replace(path, &content, Worth::Product)
}

fn png(picture: &Picture) -> Result<Vec<u8>, image::ImageError> {
    let opaque = picture.pixels().iter().all(|pixel| pixel[3] == 255);
    let (bytes, color) = if opaque {
        (opaque_bytes(picture), ExtendedColorType::Rgb8)
    } else {
        (picture.pixels().as_flattened().to_vec(), ExtendedColorType::Rgba8)
    };
    let size = picture.size();
    let side = |side: usize| u32::try_from(side).unwrap_or(u32::MAX);
    let mut content = Vec::new();
    let encoder = image::codecs::png::PngEncoder::new(&mut content);
    encoder.write_image(&bytes, side(size.width), side(size.height), color)?;
    Ok(content)
}

fn ppm(picture: &Picture) -> Vec<u8> {
    let size = picture.size();
    let head = format!("P6\n{} {}\n255\n", size.width, size.height);
    [head.as_bytes(), &opaque_bytes(picture)].concat()
}

fn opaque_bytes(picture: &Picture) -> Vec<u8> {
    let mut bytes = vec![[0; 3]; picture.size().area()];
    for (bytes, [r, g, b, _]) in bytes.iter_mut().zip(picture.pixels()) {
        *bytes = [*r, *g, *b];
    }
    bytes.into_flattened()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::image::Size;
    use crate::io::load_picture;

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
        let reason = "could not be saved: its name has to end in .png or .ppm";
        assert_eq!(error.to_string(), format!("{} {reason}", path.display()));
        std::fs::create_dir(folder.path().join("b.png")).unwrap();
        assert!(save_picture(&folder.path().join("b.png"), &picture(255)).is_err());
        assert!(save_picture(&folder.path().join("none/c.png"), &picture(255)).is_err());
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }
}

//! Loads panoramas.

use std::path::Path;

use image::ColorType;

use super::error::{LoadError, shown};
use super::progress::Progress;
use super::read::read;
use super::texture::{FLOAT_FORMATS, MOST_BYTES, decode_bytes, texture_endings};
use marraztu_core::base::Shared;
use marraztu_core::base::image::{Picture, Size};
use marraztu_core::scene::Panorama;

/// Returns the file extensions of panoramas.
pub fn panorama_endings() -> Vec<&'static str> {
    let floats = FLOAT_FORMATS.iter().flat_map(|format| format.extensions_str()).copied();
    floats.chain(texture_endings()).collect()
}

/// Loads a panorama: the light of Radiance HDR and OpenEXR files is linear, and that of other
/// pictures stored.
///
/// # Errors
/// If the file cannot be read, is not a picture, or is too large.
pub fn load_panorama(path: &Path) -> Result<Panorama, LoadError> {
    load_panorama_within(path, Panorama::MOST_TEXELS)
}

/// Works like [`load_panorama`], with at most this number of texels.
pub(super) fn load_panorama_within(path: &Path, most: usize) -> Result<Panorama, LoadError> {
    panorama_of(path, &read(path, MOST_BYTES, &Progress::new())?, most)
}

/// Decodes the panorama of a file with at most this number of texels.
pub(super) fn panorama_of(path: &Path, content: &[u8], most: usize) -> Result<Panorama, LoadError> {
    let most = most.min(Panorama::MOST_TEXELS);
    // Some programs sign their Radiance files with the name of the encoding.
    let signed = content.strip_prefix(b"#?RGBE").map(|rest| [&b"#?RADIANCE"[..], rest].concat());
    let content = signed.as_deref().unwrap_or(content);
    let (decoded, cut_off) = decode_bytes(path, content, most, &FLOAT_FORMATS)?;
    let damaged = || LoadError::file(&shown(path), "the picture is damaged");
    if cut_off {
        return Err(damaged());
    }
    let is_linear = matches!(decoded.color(), ColorType::Rgb32F | ColorType::Rgba32F);
    let size = Size::new(decoded.width() as usize, decoded.height() as usize);
    let light = decoded.into_rgb32f().into_raw();
    let (texels, _) = light.as_chunks();
    // An absolute path stays valid when the current folder changes.
    let source = std::path::absolute(path).unwrap_or_else(|_empty| path.to_owned());
    Panorama::new(source, size, texels.to_vec(), is_linear).ok_or_else(damaged)
}

/// The faces of a cube in MTL files, in the order of [`panorama_of_cube`].
pub(super) const CUBE: [&str; 6] =
    ["cube_right", "cube_left", "cube_top", "cube_bottom", "cube_front", "cube_back"];

/// The largest face of a cube that keeps its size.
const LARGEST_FACE: usize = 1024;

/// Converts the six pictures of a cube, seen from its middle, to a panorama: right is +X, top +Y
/// and front +Z. Right, left, front and back stand upright; the upper edge of the top and the lower
/// edge of the bottom touch the back.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    clippy::cast_sign_loss,
    reason = "within a picture"
)]
pub(super) fn panorama_of_cube(source: &Path, faces: &[Shared<Picture>]) -> Panorama {
    let side = faces.iter().map(|face| face.size().height).max().unwrap_or(1).min(LARGEST_FACE);
    let size = Size::new(4 * side, 2 * side);
    let texels = (0..size.area()).map(|place| {
        let [x, y, z] = Panorama::direction(size, place).to_array();
        let most = x.abs().max(y.abs()).max(z.abs());
        // The face, and the place to the right and up on it.
        let (face, right, up) = match () {
            () if x == most => (0, z, y),
            () if -x == most => (1, -z, y),
            () if y == most => (2, -x, -z),
            () if -y == most => (3, -x, z),
            () if z == most => (4, -x, y),
            () => (5, x, y),
        };
        let Some(face) = faces.get(face) else { return [0.0; 3] };
        let Size { width, height } = face.size();
        let at = |part: f64, count: usize| {
            let along = (part / most + 1.0) / 2.0 * count as f64;
            (along.max(0.0) as usize).min(count - 1)
        };
        let [r, g, b, _] = face.pixel(at(right, width), height - 1 - at(up, height));
        [r, g, b].map(|byte| f32::from(byte) / 255.0)
    });
    let texels = texels.collect();
    let placeholder = || Panorama::placeholder(source.to_owned());
    Panorama::new(source, size, texels, false).unwrap_or_else(placeholder)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn loaded(name: &str, picture: &image::DynamicImage) -> Panorama {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        picture.save(&path).unwrap();
        let panorama = load_panorama(&path).unwrap();
        assert_eq!(panorama.source, path);
        panorama
    }

    #[test]
    fn floats_are_linear_and_bytes_are_stored() {
        let mut light = image::Rgb32FImage::new(4, 2);
        light.put_pixel(3, 0, image::Rgb([8.0, 0.5, 0.25]));
        let light = image::DynamicImage::from(light);
        let towards = glam::DVec3::new(1.0, 1.0, 1.0).normalize_or_zero();
        for name in ["sky.hdr", "sky.exr"] {
            let panorama = loaded(name, &light);
            assert_eq!(panorama.size(), Size::new(4, 2), "{name}");
            // The texel of the upper right corner lies to the right, above and behind.
            let [seen, ..] = panorama.light(true).seen(towards, 0.0);
            assert!(seen > 3.0, "{name}: {seen}");
        }
        let bytes = image::RgbImage::from_pixel(4, 2, image::Rgb([51, 102, 255]));
        let panorama = loaded("sky.png", &image::DynamicImage::from(bytes));
        let seen = panorama.light(false).seen(towards, 0.0);
        assert!((seen[0] - 0.2).abs() < 1e-6 && (seen[2] - 1.0).abs() < 1e-6, "{seen:?}");
    }

    #[test]
    fn radiance_files_may_be_signed_with_their_encoding() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.hdr");
        let texels = [128, 64, 32, 129].repeat(2);
        for name in ["RADIANCE", "RGBE"] {
            let head = format!("#?{name}\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n");
            std::fs::write(&path, [head.as_bytes(), &texels].concat()).unwrap();
            let [seen, ..] = load_panorama(&path).unwrap().light(true).seen(glam::DVec3::X, 0.0);
            assert!((seen - 1.0).abs() < 0.02, "{name}: {seen}");
        }
    }

    #[test]
    fn what_is_no_picture_is_one_error() {
        let folder = tempfile::tempdir().unwrap();
        for (name, content) in
            [("a.hdr", &b"#?RADIANCE\n\n"[..]), ("b.exr", b"v/1\x01"), ("c", b"")]
        {
            let path = folder.path().join(name);
            std::fs::write(&path, content).unwrap();
            let error = load_panorama(&path).unwrap_err().to_string();
            assert!(!error.contains('\n') && error.contains(name), "{error}");
        }
        assert!(load_panorama(&folder.path().join("none.hdr")).is_err());
    }
}

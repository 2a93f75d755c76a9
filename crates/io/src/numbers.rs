//! Reads pictures for comparison: colours, and the numbers of OpenEXR files and NumPy arrays.
//!
//! Numbers are compared as f64, which holds every f32 and every integer of 32 bits. Arrays follow
//! <https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html>; the crates that read
//! all of their headers need a parser of Python's literals, and the three keys of this one do not.

use std::collections::BTreeMap;
use std::io::Cursor;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use exr::meta::MetaData;
use exr::prelude::{FlatImage, FlatSamples, ReadChannels as _, ReadLayers as _};

use super::error::{LoadError, shown};
use super::picture::NUMPY;
use super::progress::Progress;
use super::read::read;
use super::texture::{LARGEST_SIDE, MOST_BYTES, decode_deep};
use marraztu_core::base::image::{Picture, Size};

/// The first bytes of an OpenEXR file.
const OPEN_EXR: &[u8] = b"\x76\x2F\x31\x01";

/// The most numbers of a file: 2 GB.
const MOST_NUMBERS: usize = (2 << 30) / size_of::<f64>();

/// The content of a picture file.
#[derive(Clone, Debug, PartialEq)]
pub enum PictureContent {
    /// Colours with 8 bits per channel.
    Colors(Picture),
    /// Colours with 16 bits per channel, row by row: red, green, blue and opacity. The picture has
    /// them in 8 bits.
    DeepColors(Picture, Vec<[u16; 4]>),
    /// The numbers of an OpenEXR file, or of an array of NumPy.
    Numbers(Numbers),
}

/// Pictures of numbers, by channel.
#[derive(Clone, Debug, PartialEq)]
pub struct Numbers {
    /// The width and height of each channel.
    pub size: Size,
    /// The numbers of each channel, row by row from the top. The channels of an OpenEXR file have
    /// its names; those of an array are "0", "1" and so on.
    pub channels: BTreeMap<String, Vec<f64>>,
}

impl PictureContent {
    /// Returns the width and height.
    pub const fn size(&self) -> Size {
        match self {
            Self::Colors(picture) | Self::DeepColors(picture, _) => picture.size(),
            Self::Numbers(numbers) => numbers.size,
        }
    }
}

/// Loads a picture in any input format of textures, an OpenEXR file or an array of NumPy, whatever
/// its extension. An array has the shape (height, width) or (height, width, channels), in the order
/// of C. Integers of 64 bits above 2^53 are rounded.
///
/// # Errors
/// If the file cannot be read, has none of these formats, or is too large.
pub fn load_content(path: &Path) -> Result<PictureContent, LoadError> {
    let bytes = read(path, MOST_BYTES, &Progress::new())?;
    let numbers = if bytes.starts_with(NUMPY) {
        array(&bytes)
    } else if bytes.starts_with(OPEN_EXR) {
        open_exr(&bytes)
    } else {
        let (picture, deep) = decode_deep(path, &bytes)?;
        return Ok(match deep {
            Some(deep) => PictureContent::DeepColors(picture, deep),
            None => PictureContent::Colors(picture),
        });
    };
    let numbers = numbers.map_err(|reason| LoadError::file(&shown(path), reason))?;
    Ok(PictureContent::Numbers(numbers))
}

/// Checks a size before memory is reserved for it.
fn checked(width: usize, height: usize, channels: usize) -> Result<Size, String> {
    let side = LARGEST_SIDE as usize;
    let count = width.saturating_mul(height).saturating_mul(channels);
    if count == 0 {
        return Err("the picture is empty".to_owned());
    }
    if width.max(height) > side || count > MOST_NUMBERS {
        return Err(format!(
            "the picture is larger than {side} x {side} pixels, or takes more than 2 GB"
        ));
    }
    Ok(Size::new(width, height))
}

/// Reads an OpenEXR file.
fn open_exr(bytes: &[u8]) -> Result<Numbers, String> {
    // A decoder that panics on a damaged file must not stop the program.
    let decoded = catch_unwind(AssertUnwindSafe(|| decoded(bytes)));
    let (size, image) =
        decoded.unwrap_or_else(|_panic| Err("the picture is damaged".to_owned()))?;
    let mut channels = BTreeMap::new();
    for layer in image.layer_data {
        let layer_name = layer.attributes.layer_name.map(|name| format!("{name}."));
        for channel in layer.channel_data.list {
            let name = format!("{}{}", layer_name.as_deref().unwrap_or_default(), channel.name);
            let numbers = wide(&channel.sample_data);
            if numbers.len() != size.area() {
                return Err(format!("the channel {name} has fewer samples than pixels"));
            }
            channels.insert(name, numbers);
        }
    }
    Ok(Numbers { size, channels })
}

/// Decodes the layers of an OpenEXR file, which have one size.
fn decoded(bytes: &[u8]) -> Result<(Size, FlatImage), String> {
    let headers = MetaData::read_from_buffered(Cursor::new(bytes), false);
    let headers = headers.map_err(|error| error.to_string())?.headers;
    let channels = headers.iter().map(|header| header.channels.list.len()).sum();
    let sizes: Vec<_> = headers.iter().map(|header| header.layer_size).collect();
    let (Some(first), true) = (sizes.first(), sizes.windows(2).all(|two| two[0] == two[1])) else {
        return Err("the layers have different sizes".to_owned());
    };
    let size = checked(first.width(), first.height(), channels)?;
    let reader = exr::prelude::read().no_deep_data().largest_resolution_level();
    let reader = reader.all_channels().all_layers().all_attributes();
    let image = reader.from_buffered(Cursor::new(bytes)).map_err(|error| error.to_string())?;
    Ok((size, image))
}

fn wide(samples: &FlatSamples) -> Vec<f64> {
    match samples {
        FlatSamples::F16(values) => values.iter().map(|x| f64::from(x.to_f32())).collect(),
        FlatSamples::F32(values) => values.iter().map(|x| f64::from(*x)).collect(),
        FlatSamples::U32(values) => values.iter().map(|x| f64::from(*x)).collect(),
    }
}

/// Reads an array of NumPy.
fn array(bytes: &[u8]) -> Result<Numbers, String> {
    let cut_off = || "the array is cut off".to_owned();
    // The magic bytes are followed by two bytes of a version, and the length of the header in two
    // bytes, or in four from version 2 on.
    let rest = bytes.get(NUMPY.len()..).unwrap_or_default();
    let ([major, _, rest @ ..], false) = (rest, rest.len() < 6) else { return Err(cut_off()) };
    let (length, rest) = match major {
        1 => (usize::from(u16::from_le_bytes([rest[0], rest[1]])), &rest[2..]),
        _ => {
            let (length, rest) = rest.split_first_chunk().ok_or_else(cut_off)?;
            (u32::from_le_bytes(*length) as usize, rest)
        }
    };
    let (header, content) = rest.split_at_checked(length).ok_or_else(cut_off)?;
    let header = String::from_utf8_lossy(header);
    let (kind, shape) = header_fields(&header)?;
    let (height, width, count) = match shape[..] {
        [height, width] => (height, width, 1),
        [height, width, channels] => (height, width, channels),
        _ => {
            let expected = "(height, width) or (height, width, channels)";
            return Err(format!("the array has {} axes instead of {expected}", shape.len()));
        }
    };
    let size = checked(width, height, count)?;
    let (length, number) = number_kind(&kind)
        .ok_or_else(|| format!("the array has elements of the kind {kind:?} instead of numbers"))?;
    // Further bytes, such as the stamp of a batch, are ignored as by NumPy.
    let content = content.get(..length * size.area() * count).ok_or_else(cut_off)?;
    let channel = |first: usize| {
        content.chunks_exact(length).skip(first).step_by(count).map(number).collect()
    };
    let channels = (0..count).map(|i| (i.to_string(), channel(i))).collect();
    Ok(Numbers { size, channels })
}

/// Reads the header of an array: a dictionary such as "{'descr': '<f4', 'fortran_order': False,
/// 'shape': (2, 3), }". Returns the kind of its elements, and its shape.
fn header_fields(header: &str) -> Result<(String, Vec<usize>), String> {
    let unreadable = || "the header of the array cannot be read".to_owned();
    let after = |key: &str| {
        let (_, value) = header.split_once(&format!("'{key}':")).ok_or_else(unreadable)?;
        Ok::<&str, String>(value.trim_start())
    };
    let kind = after("descr")?.split('\'').nth(1).ok_or_else(unreadable)?;
    if after("fortran_order")?.starts_with("True") {
        return Err(
            "the array is in the order of Fortran; save numpy.ascontiguousarray of it".into()
        );
    }
    let shape = after("shape")?.strip_prefix('(').and_then(|shape| shape.split(')').next());
    let sides = shape.ok_or_else(unreadable)?.split(',').map(str::trim);
    let sides = sides.filter(|side| !side.is_empty()).map(str::parse);
    let sides: Result<Vec<usize>, _> = sides.collect();
    Ok((kind.to_owned(), sides.map_err(|_number| unreadable())?))
}

/// Reads a number from its bytes.
type Number = fn(&[u8]) -> f64;

/// Returns the length in bytes of the elements of a kind such as "<f4", and the function that reads
/// one. `None` for kinds that are not real numbers.
#[expect(clippy::cast_precision_loss, reason = "documented for integers of 64 bits")]
fn number_kind(kind: &str) -> Option<(usize, Number)> {
    macro_rules! number {
        ($type:ty, $from:ident, |$value:ident| $wide:expr) => {
            (size_of::<$type>(), |bytes| {
                let $value = <$type>::$from(bytes.try_into().expect("chunks have this length"));
                $wide
            })
        };
    }
    Some(match kind {
        "|b1" | "|u1" => number!(u8, from_le_bytes, |x| f64::from(x)),
        "|i1" => number!(i8, from_le_bytes, |x| f64::from(x)),
        "<u2" => number!(u16, from_le_bytes, |x| f64::from(x)),
        ">u2" => number!(u16, from_be_bytes, |x| f64::from(x)),
        "<i2" => number!(i16, from_le_bytes, |x| f64::from(x)),
        ">i2" => number!(i16, from_be_bytes, |x| f64::from(x)),
        "<u4" => number!(u32, from_le_bytes, |x| f64::from(x)),
        ">u4" => number!(u32, from_be_bytes, |x| f64::from(x)),
        "<i4" => number!(i32, from_le_bytes, |x| f64::from(x)),
        ">i4" => number!(i32, from_be_bytes, |x| f64::from(x)),
        "<u8" => number!(u64, from_le_bytes, |x| x as f64),
        ">u8" => number!(u64, from_be_bytes, |x| x as f64),
        "<i8" => number!(i64, from_le_bytes, |x| x as f64),
        ">i8" => number!(i64, from_be_bytes, |x| x as f64),
        "<f2" => number!(u16, from_le_bytes, |x| half(x)),
        ">f2" => number!(u16, from_be_bytes, |x| half(x)),
        "<f4" => number!(f32, from_le_bytes, |x| f64::from(x)),
        ">f4" => number!(f32, from_be_bytes, |x| f64::from(x)),
        "<f8" => number!(f64, from_le_bytes, |x| x),
        ">f8" => number!(f64, from_be_bytes, |x| x),
        _ => return None,
    })
}

/// Converts the bits of a number of 16 bits.
fn half(bits: u16) -> f64 {
    f64::from(exr::prelude::f16::from_bits(bits).to_f32())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{LayerKind, LayerNumbers, LayerPicture, layer_npy, layers_exr};

    const SIZE: Size = Size::new(3, 2);

    /// Writes a file, and loads it.
    fn loaded(bytes: &[u8]) -> Result<PictureContent, String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.bin");
        std::fs::write(&path, bytes).unwrap();
        load_content(&path).map_err(|error| error.reason())
    }

    fn numbers(channels: &[(&str, &[f64])]) -> PictureContent {
        let channel = |(name, values): &(&str, &[f64])| ((*name).to_owned(), values.to_vec());
        PictureContent::Numbers(Numbers {
            size: SIZE,
            channels: channels.iter().map(channel).collect(),
        })
    }

    /// An array with this header and content, as NumPy writes it, without padding.
    fn array_of(header: &str, content: &[u8]) -> Vec<u8> {
        let length = u16::try_from(header.len()).unwrap().to_le_bytes();
        [NUMPY, &[1, 0], &length, header.as_bytes(), content].concat()
    }

    fn header(kind: &str, shape: &str) -> String {
        format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}, }}")
    }

    #[test]
    fn the_layers_that_this_program_writes_come_back_as_they_went() {
        let depths = [1.5, f32::INFINITY, 0.1, 2.0, 3.0, 1e-30];
        let wide = depths.map(f64::from);
        let ids = [0, 1, 70_000, i32::MAX, 4, 5];
        let layer = |name, kind, channels, numbers| LayerPicture { name, kind, channels, numbers };
        let depth = layer("depth", LayerKind::Depth, &["Z"], LayerNumbers::F32(&depths));
        let object = layer("object", LayerKind::Ids, &["id"], LayerNumbers::I32(&ids));
        let ids = ids.map(f64::from);
        assert_eq!(loaded(&layer_npy(SIZE, &depth)), Ok(numbers(&[("0", &wide)])));
        assert_eq!(loaded(&layer_npy(SIZE, &object)), Ok(numbers(&[("0", &ids)])));
        let exr = layers_exr(SIZE, &[depth, object], None).unwrap();
        assert_eq!(loaded(&exr), Ok(numbers(&[("Z", &wide), ("id", &ids)])));
    }

    #[test]
    fn arrays_of_each_kind_and_byte_order_have_the_numbers_of_numpy() {
        // 2 in each kind, as by `numpy.full((2, 3), 2, kind).tobytes()`.
        for (kind, two) in [
            ("|u1", &[2][..]),
            ("|i1", &[2]),
            ("<u2", &[2, 0]),
            (">i2", &[0, 2]),
            ("<i4", &[2, 0, 0, 0]),
            (">u4", &[0, 0, 0, 2]),
            ("<i8", &[2, 0, 0, 0, 0, 0, 0, 0]),
            (">u8", &[0, 0, 0, 0, 0, 0, 0, 2]),
            ("<f2", &[0, 0x40]),
            (">f2", &[0x40, 0]),
            (">f4", &[0x40, 0, 0, 0]),
            ("<f8", &[0, 0, 0, 0, 0, 0, 0, 0x40]),
        ] {
            let array = array_of(&header(kind, "(2, 3)"), &two.repeat(6));
            assert_eq!(loaded(&array), Ok(numbers(&[("0", &[2.0; 6])])), "{kind}");
        }
        // The last bytes are a stamp, not numbers.
        let interleaved: Vec<u8> = (0..20).collect();
        let array = array_of(&header("|u1", "(2, 3, 2)"), &interleaved);
        let even = [0.0, 2.0, 4.0, 6.0, 8.0, 10.0];
        assert_eq!(loaded(&array), Ok(numbers(&[("0", &even), ("1", &even.map(|x| x + 1.0))])));
    }

    #[test]
    fn arrays_that_are_damaged_or_no_pictures_are_rejected_with_a_reason() {
        let fortran = header("|u1", "(2, 3)").replace("False", "True");
        for (array, reason) in [
            (NUMPY.to_vec(), "cut off"),
            ([NUMPY, &[1, 0, 255, 255, 0]].concat(), "cut off"),
            ([NUMPY, &[2, 0, 255, 255, 255, 255]].concat(), "cut off"),
            (array_of("{}", &[]), "header of the array cannot be read"),
            (array_of(&header("|u1", "(2, x)"), &[]), "header of the array cannot be read"),
            (array_of(&header("|u1", "(6,)"), &[0; 6]), "1 axes"),
            (array_of(&header("<c8", "(2, 3)"), &[0; 48]), "kind \"<c8\""),
            (array_of(&header("|u1", "(2, 3)"), &[0; 5]), "cut off"),
            (array_of(&header("|u1", "(0, 3)"), &[]), "empty"),
            (array_of(&header("|u1", "(99999999999, 99999999999)"), &[0; 6]), "larger than"),
            (array_of(&fortran, &[0; 6]), "ascontiguousarray"),
        ] {
            let error = loaded(&array).unwrap_err();
            assert!(error.contains(reason), "{error} instead of {reason}");
        }
    }

    #[test]
    fn an_exr_that_is_damaged_is_rejected_wherever_it_ends_or_changes() {
        let values = [1.0; 6];
        let numbers = LayerNumbers::F32(&values);
        let depth = LayerPicture { name: "d", kind: LayerKind::Depth, channels: &["Z"], numbers };
        let whole = layers_exr(SIZE, &[depth], None).unwrap();
        for length in 4..whole.len() {
            assert!(loaded(&whole[..length]).is_err(), "{length}");
            // A changed byte may be harmless, but never stops the program.
            let mut changed = whole.clone();
            changed[length] ^= 0x81;
            let _ = loaded(&changed);
        }
    }
}

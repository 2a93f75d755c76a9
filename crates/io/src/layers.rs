//! Encodes the layers of a picture: PNG with 16 bits, OpenEXR, and arrays of NumPy.
//!
//! | layer | PNG | OpenEXR | NumPy |
//! |---|---|---|---|
//! | colour | see [`PICTURE_FORMATS`](crate::PICTURE_FORMATS) | `R G B A`, linear, times A | u8 |
//! | depth | 16 bits, units times a scale; 0 for the background | f32, infinite background | f32 |
//! | normal | 16 bits, (n + 1) / 2 | f32 | f32 |
//! | ids | 16 bits, or id = R + 256 G + 65536 B | u32 | i32 |
//! | mask | 8 bits: 0 or 255 | u32: 0 or 1 | u8: 0 or 1 |
//! | position, uv | none | f32 | f32 |
//!
//! OpenEXR: <https://openexr.com/en/latest/TechnicalIntroduction.html>. NumPy:
//! <https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html>.

use std::io::Cursor;

use exr::prelude::{
    AnyChannel, AnyChannels, Compression, Encoding, FlatSamples, Image, Layer as ExrLayer,
    LayerAttributes, Vec2, WritableImage as _,
};
use glam::DMat4;

use super::picture::sides_of;
use super::stamp::KEYWORD;
use marraztu_core::base::color::linear_factors;
use marraztu_core::base::image::Size;

/// The numbers of a layer: row by row from the top, and the channels of a pixel together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LayerNumbers<'a> {
    /// 32 bits, floating point.
    F32(&'a [f32]),
    /// 32 bits, from 0.
    I32(&'a [i32]),
    /// Bytes.
    U8(&'a [u8]),
}

/// The meaning of a layer's numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LayerKind {
    /// Red, green, blue and alpha in bytes, encoded in sRGB, not multiplied by alpha.
    Color,
    /// A distance, infinite for the background.
    Depth,
    /// Unit vectors; 0 for the background.
    Normal,
    /// Positions or texture coordinates.
    Vector,
    /// Numbers from 0.
    Ids,
    /// 0 or 1.
    Mask,
}

/// A layer to encode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LayerPicture<'a> {
    /// The name in messages, and the beginning of channel names.
    pub name: &'a str,
    /// The meaning of the numbers.
    pub kind: LayerKind,
    /// The names of the channels in an OpenEXR file, one for each channel.
    pub channels: &'a [&'a str],
    /// The numbers: width x height x channels.
    pub numbers: LayerNumbers<'a>,
}

/// The form of ids in a PNG.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum IdPixels {
    /// Grey with 16 bits.
    #[default]
    Grey,
    /// id = R + 256 G + 65536 B, as in COCO.
    Rgb,
}

/// How numbers become the pixels of a PNG.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PngNumbers {
    /// The number of steps of depth per unit.
    pub depth_scale: f64,
    /// The form of ids.
    pub ids: IdPixels,
}

impl Default for PngNumbers {
    /// Thousandths of a unit, and grey ids.
    fn default() -> Self {
        Self { depth_scale: 1000.0, ids: IdPixels::Grey }
    }
}

/// The matrices of an OpenEXR file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExrCamera {
    /// From the world to the camera: x to the right, y up, z forward.
    pub camera_from_world: DMat4,
    /// From the world to normalised device coordinates, from -1 to 1.
    pub ndc_from_world: DMat4,
}

/// Encodes a layer as an array of NumPy, with the shape (height, width) or (height, width,
/// channels).
pub fn layer_npy(size: Size, layer: &LayerPicture<'_>) -> Vec<u8> {
    let channels = match layer.channels.len() {
        1 => String::new(),
        count => format!(", {count}"),
    };
    let kind = match layer.numbers {
        LayerNumbers::F32(_) => "<f4",
        LayerNumbers::I32(_) => "<i4",
        LayerNumbers::U8(_) => "|u1",
    };
    let Size { width, height } = size;
    let shape = format!("({height}, {width}{channels})");
    let mut header =
        format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}, }}").into_bytes();
    // The header is padded with spaces and ends with a new line, so the numbers start at a multiple
    // of 64 bytes.
    const BEGIN: &[u8] = b"\x93NUMPY\x01\x00";
    let length = (BEGIN.len() + 2 + header.len() + 1).next_multiple_of(64) - BEGIN.len() - 2;
    header.resize(length - 1, b' ');
    header.push(b'\n');
    let length = u16::try_from(length).expect("a short header").to_le_bytes();
    let mut content = [BEGIN, &length, &header].concat();
    content.reserve(4 * size.area() * layer.channels.len());
    match layer.numbers {
        LayerNumbers::F32(values) => values.iter().for_each(|x| content.extend(x.to_le_bytes())),
        LayerNumbers::I32(values) => values.iter().for_each(|x| content.extend(x.to_le_bytes())),
        LayerNumbers::U8(values) => content.extend(values),
    }
    content
}

/// Encodes a layer as PNG, with a stamp if one is given: see
/// [`encode_stamped`](crate::encode_stamped). Layers of colour are encoded by
/// [`PICTURE_FORMATS`](crate::PICTURE_FORMATS).
///
/// # Errors
/// The reason, if its numbers do not fit in 16 bits.
pub fn layer_png(
    size: Size,
    layer: &LayerPicture<'_>,
    how: &PngNumbers,
    stamp: Option<&str>,
) -> Result<Vec<u8>, String> {
    let encode = |color, depth, bytes: &[u8]| png_of(size, color, depth, bytes, stamp);
    let wide = |values: &[u16]| values.iter().flat_map(|x| x.to_be_bytes()).collect::<Vec<u8>>();
    match (layer.kind, layer.numbers) {
        (LayerKind::Depth, LayerNumbers::F32(values)) => {
            let steps = values.iter().map(|value| depth_steps(layer.name, *value, how.depth_scale));
            let steps = steps.collect::<Result<Vec<u16>, _>>()?;
            encode(png::ColorType::Grayscale, png::BitDepth::Sixteen, &wide(&steps))
        }
        (LayerKind::Normal, LayerNumbers::F32(values)) => {
            let (normals, _) = values.as_chunks::<3>();
            let steps: Vec<u16> = normals.iter().flat_map(normal_steps).collect();
            encode(png::ColorType::Rgb, png::BitDepth::Sixteen, &wide(&steps))
        }
        (LayerKind::Ids, LayerNumbers::I32(values)) => match how.ids {
            IdPixels::Grey => {
                let ids = values.iter().map(|id| {
                    u16::try_from(*id).map_err(|_too_large| {
                        format!(
                            "the layer {} has the id {id}, and a grey PNG ends at 65535: use ids \
                             as RGB, or EXR or npy",
                            layer.name
                        )
                    })
                });
                let ids = ids.collect::<Result<Vec<u16>, _>>()?;
                encode(png::ColorType::Grayscale, png::BitDepth::Sixteen, &wide(&ids))
            }
            IdPixels::Rgb => {
                let mut bytes = Vec::with_capacity(3 * values.len());
                for id in values {
                    let [r, g, b, more] = id.to_le_bytes();
                    if more != 0 {
                        return Err(format!(
                            "the layer {} has the id {id}, and RGB ends at 16777215: use EXR or \
                             npy",
                            layer.name
                        ));
                    }
                    bytes.extend([r, g, b]);
                }
                encode(png::ColorType::Rgb, png::BitDepth::Eight, &bytes)
            }
        },
        (LayerKind::Mask, LayerNumbers::U8(values)) => {
            let bytes: Vec<u8> = values.iter().map(|value| value.saturating_mul(255)).collect();
            encode(png::ColorType::Grayscale, png::BitDepth::Eight, &bytes)
        }
        _ => Err(format!("a PNG cannot hold the layer {}: use EXR or npy", layer.name)),
    }
}

/// Converts a depth to steps: 0 for the background, else 1 to 65535.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "checked just before")]
fn depth_steps(name: &str, depth: f32, scale: f64) -> Result<u16, String> {
    if depth == f32::INFINITY {
        return Ok(0);
    }
    let steps = (f64::from(depth) * scale).round();
    if (1.0..=65535.0).contains(&steps) {
        return Ok(steps as u16);
    }
    Err(format!(
        "the {name} of {depth} units is {steps} steps at the depth scale {scale}, and a PNG holds \
         1 to 65535: change --depth-scale, or use EXR or npy"
    ))
}

/// Converts a normal to 16 bits per component; 0 for the background.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within 0 to 65535")]
fn normal_steps(normal: &[f32; 3]) -> [u16; 3] {
    if *normal == [0.0; 3] {
        return [0; 3];
    }
    normal.map(|x| ((f64::from(x).clamp(-1.0, 1.0) + 1.0) / 2.0 * 65535.0).round() as u16)
}

fn png_of(
    size: Size,
    color: png::ColorType,
    depth: png::BitDepth,
    bytes: &[u8],
    stamp: Option<&str>,
) -> Result<Vec<u8>, String> {
    let mut content = Vec::new();
    let mut encode = || -> Result<(), png::EncodingError> {
        let [width, height] = sides_of(size);
        let mut encoder = png::Encoder::new(&mut content, width, height);
        encoder.set_color(color);
        encoder.set_depth(depth);
        encoder.set_compression(png::Compression::Fast);
        encoder.set_filter(png::Filter::Adaptive);
        if let Some(stamp) = stamp {
            encoder.add_text_chunk(KEYWORD.to_owned(), stamp.to_owned())?;
        }
        let mut writer = encoder.write_header()?;
        writer.write_image_data(bytes)?;
        writer.finish()
    };
    encode().map_err(|error| error.to_string())?;
    Ok(content)
}

/// Encodes layers as one OpenEXR file: 32 bits, ZIP, one channel for each of their channels.
///
/// # Errors
/// The reason, if they cannot be encoded.
pub fn layers_exr(
    size: Size,
    layers: &[LayerPicture<'_>],
    camera: Option<&ExrCamera>,
) -> Result<Vec<u8>, String> {
    let channels =
        layers.iter().flat_map(|layer| {
            let count = layer.channels.len();
            layer.channels.iter().enumerate().map(move |(channel, name)| {
                AnyChannel::new(*name, exr_samples(layer, channel, count))
            })
        });
    let mut attributes = LayerAttributes::default();
    if let Some(camera) = camera {
        // OpenEXR multiplies rows by matrices, so the columns are stored one after the other.
        #[expect(clippy::cast_possible_truncation, reason = "the format has f32")]
        let stored = |matrix: DMat4| matrix.to_cols_array().map(|x| x as f32);
        attributes.world_to_camera = Some(stored(camera.camera_from_world));
        attributes.world_to_normalized_device = Some(stored(camera.ndc_from_world));
    }
    let encoding = Encoding { compression: Compression::ZIP16, ..Encoding::default() };
    let channels = AnyChannels::sort(channels.collect());
    let layer = ExrLayer::new(Vec2(size.width, size.height), attributes, encoding, channels);
    let mut content = Cursor::new(Vec::new());
    let written = Image::from_layer(layer).write().non_parallel().to_buffered(&mut content);
    written.map_err(|error| error.to_string())?;
    Ok(content.into_inner())
}

/// Returns one channel of a layer.
fn exr_samples(layer: &LayerPicture<'_>, channel: usize, count: usize) -> FlatSamples {
    match layer.numbers {
        LayerNumbers::F32(values) => {
            FlatSamples::F32(values.iter().skip(channel).step_by(count).copied().collect())
        }
        LayerNumbers::I32(values) => {
            let values = values.iter().skip(channel).step_by(count);
            FlatSamples::U32(values.map(|id| id.max(&0).cast_unsigned()).collect())
        }
        LayerNumbers::U8(values) if layer.kind == LayerKind::Color => FlatSamples::F32(
            values.chunks_exact(count).map(|pixel| light(pixel, channel)).collect(),
        ),
        LayerNumbers::U8(values) => FlatSamples::U32(
            values.iter().skip(channel).step_by(count).map(|x| (*x).into()).collect(),
        ),
    }
}

/// Converts a channel of a pixel to linear light, multiplied by alpha.
#[expect(clippy::cast_possible_truncation, reason = "the nearest f32 is meant")]
fn light(pixel: &[u8], channel: usize) -> f32 {
    let alpha = pixel.get(3).map_or(1.0, |alpha| f64::from(*alpha) / 255.0);
    if channel == 3 {
        alpha as f32
    } else {
        (linear_factors()[usize::from(pixel[channel])] * alpha) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use exr::prelude::{FlatImage, ReadChannels as _, ReadLayers as _, read};

    const SIZE: Size = Size::new(3, 2);

    fn depth(values: &[f32]) -> LayerPicture<'_> {
        let numbers = LayerNumbers::F32(values);
        LayerPicture { name: "depth", kind: LayerKind::Depth, channels: &["Z"], numbers }
    }

    fn ids(values: &[i32]) -> LayerPicture<'_> {
        let numbers = LayerNumbers::I32(values);
        LayerPicture { name: "object", kind: LayerKind::Ids, channels: &["id"], numbers }
    }

    /// Decodes a PNG to its samples, row by row.
    fn decoded(png: &[u8]) -> (png::ColorType, Vec<u16>) {
        let decoder = png::Decoder::new(Cursor::new(png));
        let mut reader = decoder.read_info().unwrap();
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut bytes).unwrap();
        let samples = match info.bit_depth {
            png::BitDepth::Sixteen => {
                bytes.as_chunks().0.iter().map(|two| u16::from_be_bytes(*two)).collect()
            }
            _ => bytes.iter().map(|byte| u16::from(*byte)).collect(),
        };
        (info.color_type, samples)
    }

    #[test]
    fn an_array_has_the_header_that_numpy_writes() {
        let npy = layer_npy(SIZE, &depth(&[1.0, 2.0, 3.0, 4.0, 5.0, f32::INFINITY]));
        // numpy.save of an array of this type and shape, with NumPy 2.
        let header =
            b"\x93NUMPY\x01\x00v\x00{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3), }";
        assert!(npy.starts_with(header));
        assert_eq!((npy.len(), &npy[126..132]), (128 + 24, &b" \n\0\0\x80\x3F"[..]));
        assert_eq!(npy[148..], f32::INFINITY.to_le_bytes());
        let bytes = [7; 18];
        let numbers = LayerNumbers::U8(&bytes);
        let channels = &["R", "G", "B"];
        let color = LayerPicture { name: "color", kind: LayerKind::Color, channels, numbers };
        let npy = layer_npy(SIZE, &color);
        let text = String::from_utf8_lossy(&npy[10..128]);
        assert!(text.starts_with("{'descr': '|u1', 'fortran_order': False, 'shape': (2, 3, 3), }"));
    }

    #[test]
    fn an_exr_keeps_every_number_and_the_camera() {
        let depths = [1.5, f32::INFINITY, 0.1, 2.0, 3.0, 1e-30];
        let normals: Vec<f32> = (0..18_u8).map(|i| f32::from(i) / 7.0).collect();
        let numbers = LayerNumbers::F32(&normals);
        let channels = &["normal.X", "normal.Y", "normal.Z"];
        let normal = LayerPicture { name: "normal", kind: LayerKind::Normal, channels, numbers };
        let objects = [0, 1, 70_000, i32::MAX, 4, 5];
        let colors = [0, 128, 255, 255, 255, 255, 255, 128].repeat(3);
        let numbers = LayerNumbers::U8(&colors);
        let channels = &["R", "G", "B", "A"];
        let color = LayerPicture { name: "color", kind: LayerKind::Color, channels, numbers };
        let camera = ExrCamera {
            camera_from_world: DMat4::from_translation(glam::DVec3::new(1.0, 2.0, 3.0)),
            ndc_from_world: DMat4::from_scale(glam::DVec3::new(4.0, 5.0, 6.0)),
        };
        let layers = [color, depth(&depths), normal, ids(&objects)];
        let exr = layers_exr(SIZE, &layers, Some(&camera)).unwrap();
        assert_eq!(exr, layers_exr(SIZE, &layers, Some(&camera)).unwrap());
        let image: FlatImage = read()
            .no_deep_data()
            .largest_resolution_level()
            .all_channels()
            .all_layers()
            .all_attributes()
            .non_parallel()
            .from_buffered(Cursor::new(&exr))
            .unwrap();
        let layer = &image.layer_data[0];
        assert_eq!(layer.encoding.compression, Compression::ZIP16);
        let channel = |name: &str| {
            let list = &layer.channel_data.list;
            list.iter()
                .find(|channel| channel.name.to_string() == name)
                .unwrap()
                .sample_data
                .clone()
        };
        let names: Vec<String> =
            layer.channel_data.list.iter().map(|channel| channel.name.to_string()).collect();
        assert_eq!(names, ["A", "B", "G", "R", "Z", "id", "normal.X", "normal.Y", "normal.Z"]);
        assert_eq!(channel("Z"), FlatSamples::F32(depths.to_vec()));
        let y = normals.iter().skip(1).step_by(3).copied().collect();
        assert_eq!(channel("normal.Y"), FlatSamples::F32(y));
        assert_eq!(channel("id"), FlatSamples::U32(objects.map(i32::cast_unsigned).to_vec()));
        // Byte 128 of sRGB is 0.2159 in linear light; IEC 61966-2-1. Alpha multiplies it.
        let FlatSamples::F32(green) = channel("G") else { panic!() };
        assert!((green[0] - 0.215_861).abs() < 1e-5, "{green:?}");
        let FlatSamples::F32(red) = channel("R") else { panic!() };
        assert!((red[1] - 128.0 / 255.0).abs() < 1e-6, "{red:?}");
        let stored = layer.attributes.world_to_camera.unwrap();
        assert_eq!(stored[12..], [1.0, 2.0, 3.0, 1.0]);
        assert_eq!(layer.attributes.world_to_normalized_device.unwrap()[5], 5.0);
    }

    #[test]
    fn a_png_has_steps_of_depth_halves_of_normals_and_ids() {
        let how = PngNumbers::default();
        let png = |layer: &LayerPicture<'_>, how: &PngNumbers| {
            layer_png(SIZE, layer, how, Some("stamp")).map(|png| decoded(&png))
        };
        let depths = [0.001, f32::INFINITY, 1.2344, 1.2346, 65.535, 2.0];
        let (kind, steps) = png(&depth(&depths), &how).unwrap();
        assert_eq!(
            (kind, &*steps),
            (png::ColorType::Grayscale, &[1, 0, 1234, 1235, 65535, 2000][..])
        );
        let fine = PngNumbers { depth_scale: 10.0, ..how };
        for (values, how, reason) in [
            ([65.536; 6], &how, "the depth of 65.536 units is 65536 steps at the depth scale 1000"),
            ([0.0004; 6], &how, "is 0 steps"),
            ([-3.0; 6], &fine, "is -30 steps at the depth scale 10"),
            ([f32::NAN; 6], &how, "NaN"),
        ] {
            let error = png(&depth(&values), how).unwrap_err();
            assert!(error.contains(reason), "{error}");
        }
        let normals = [[0.0_f32, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0; 3]].concat().repeat(2);
        let numbers = LayerNumbers::F32(&normals);
        let channels = &["x", "y", "z"];
        let normal = LayerPicture { name: "normal", kind: LayerKind::Normal, channels, numbers };
        let (kind, steps) = png(&normal, &how).unwrap();
        assert_eq!(kind, png::ColorType::Rgb);
        assert_eq!(steps[..9], [32768, 32768, 65535, 0, 32768, 32768, 0, 0, 0]);
        let (_, grey) = png(&ids(&[0, 1, 2, 65535, 4, 5]), &how).unwrap();
        assert_eq!(grey, [0, 1, 2, 65535, 4, 5]);
        let large = [0, 1, 256, 65536, 16_777_215, 5];
        assert!(png(&ids(&large), &how).unwrap_err().contains("ends at 65535"));
        let (_, rgb) = png(&ids(&large), &PngNumbers { ids: IdPixels::Rgb, ..how }).unwrap();
        assert_eq!(rgb[3..15], [1, 0, 0, 0, 1, 0, 0, 0, 1, 255, 255, 255]);
        let too_large = [1 << 24; 6];
        let rgb = PngNumbers { ids: IdPixels::Rgb, ..how };
        assert!(png(&ids(&too_large), &rgb).unwrap_err().contains("16777215"));
        let bits = [0, 1, 1, 0, 0, 1];
        let numbers = LayerNumbers::U8(&bits);
        let mask =
            LayerPicture { name: "mask", kind: LayerKind::Mask, channels: &["mask"], numbers };
        assert_eq!(png(&mask, &how).unwrap().1, [0, 255, 255, 0, 0, 255]);
    }
}

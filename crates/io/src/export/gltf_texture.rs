//! The textures of glTF, and their mapping onto surfaces.
//!
//! glTF stores the opacity of a surface in the alpha of its texture, so an opacity map is merged
//! into the texture. Offset and scale are applied to the texture coordinates. Maps with different
//! layouts get several sets of coordinates, because more readers support sets than the extension
//! for transforms.

use std::collections::HashMap;

use gltf_json::validation::Checked;
use gltf_json::{Index, image, texture};
use rayon::prelude::*;

use super::gltf::Writer;
use super::gltf_buffer::single;
use super::look::{Look, Pictures};
use marraztu_core::base::Shared;
use marraztu_core::base::image::{Picture, Size};
use marraztu_core::scene::{MapKind, Texture, Wrap};

/// The most texels of a texture that is merged from two of different sizes.
const MOST_TEXELS: usize = 1 << 26;

/// The offset and scale of a texture on a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Layout {
    offset: [f64; 2],
    scale: [f64; 2],
}

impl Default for Layout {
    fn default() -> Self {
        Self { offset: [0.0; 2], scale: [1.0; 2] }
    }
}

impl Layout {
    fn of(texture: &Texture) -> Self {
        Self { offset: texture.offset, scale: texture.scale }
    }

    /// Returns texture coordinates with (0, 0) at the upper left.
    pub(super) fn laid(&self, [u, v]: [f32; 2]) -> [f32; 2] {
        let along = |x: f32, i: usize| f64::from(x) * self.scale[i] + self.offset[i];
        [single(along(u, 0)), single(1.0 - along(v, 1))]
    }
}

/// Returns the layouts of a look's textures, in the order of a vertex's texture coordinates.
pub(super) fn layouts(look: &Look) -> Vec<Layout> {
    let map = |kind| look.map(kind).map(|map| &map.texture);
    let base = look.texture.as_ref().or_else(|| map(MapKind::Opacity));
    let mut layouts = Vec::new();
    for texture in [base, map(MapKind::Emission), map(MapKind::Normal)].into_iter().flatten() {
        let layout = Layout::of(texture);
        if !layouts.contains(&layout) {
            layouts.push(layout);
        }
    }
    layouts
}

/// The textures of one look.
#[derive(Debug)]
pub(super) struct Infos {
    /// The colour, with the opacity as alpha.
    pub(super) base: Option<texture::Info>,
    pub(super) emission: Option<texture::Info>,
    pub(super) normal: Option<texture::Info>,
    /// The effect of the alpha of `base`.
    pub(super) cover: Cover,
}

/// The effect of a texture's alpha.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Cover {
    /// No effect: alpha is 255 everywhere.
    Whole,
    /// Alpha cuts holes.
    Holes,
    /// Alpha fades smoothly.
    Fades,
}

/// The textures written so far.
#[derive(Debug, Default)]
pub(super) struct Textures {
    pictures: Pictures,
    /// The name of each picture.
    names: Vec<String>,
    textures: HashMap<(usize, Wrap), Index<gltf_json::Texture>>,
    samplers: HashMap<Wrap, Index<texture::Sampler>>,
    /// Textures merged with opacity maps, by both keys.
    merged: HashMap<[Option<TextureKey>; 2], Shared<Texture>>,
}

/// The picture, wrapping and layout of a texture.
type TextureKey = (usize, Wrap, [u64; 4]);

fn key(texture: &Texture) -> TextureKey {
    let Texture { picture, wrap, offset, scale, .. } = texture;
    let bits = [offset[0], offset[1], scale[0], scale[1]].map(f64::to_bits);
    (Shared::address(picture), *wrap, bits)
}

impl Writer<'_> {
    /// Writes the textures of a look.
    pub(super) fn infos(&mut self, textures: &mut Textures, look: &Look) -> Infos {
        let layouts = layouts(look);
        let opacity = look.map(MapKind::Opacity).map(|map| &map.texture);
        let base = textures.with_opacity(look.texture.as_ref(), opacity);
        // Blending is needed only if alpha has values between 0 and 255.
        let fades = look.texture.as_ref().is_some_and(|it| it.picture.has_partial_alpha())
            || opacity.is_some_and(|it| it.picture.fades());
        let cover = match &base {
            Some(_) if fades => Cover::Fades,
            Some(base) if base.picture.least_alpha() < 255 => Cover::Holes,
            _ => Cover::Whole,
        };
        let mut info = |texture: &Shared<Texture>| {
            let layout = layouts.iter().position(|layout| *layout == Layout::of(texture));
            texture::Info {
                index: self.texture(textures, texture),
                tex_coord: layout.and_then(|i| u32::try_from(i).ok()).unwrap_or(0),
                extensions: None,
                extras: Default::default(),
            }
        };
        let mut map = |kind| look.map(kind).map(|map| info(&map.texture));
        let (emission, normal) = (map(MapKind::Emission), map(MapKind::Normal));
        Infos { base: base.as_ref().map(&mut info), emission, normal, cover }
    }

    fn texture(
        &mut self,
        textures: &mut Textures,
        of: &Shared<Texture>,
    ) -> Index<gltf_json::Texture> {
        // A new picture also gets a name.
        let number = textures.pictures.number(&of.picture);
        if number == textures.names.len() {
            let stem = of.source.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            textures.names.push(stem);
        }
        let root = &mut self.root;
        // Textures are shared by picture and wrapping: the layout is in the coordinates.
        *textures.textures.entry((number, of.wrap)).or_insert_with(|| {
            let sampler = textures.samplers.entry(of.wrap);
            let sampler = *sampler.or_insert_with(|| root.push(sampler_of(of.wrap)));
            root.push(gltf_json::Texture {
                name: None,
                sampler: Some(sampler),
                source: Index::new(u32::try_from(number).unwrap_or(u32::MAX)),
                extensions: None,
                extras: Default::default(),
            })
        })
    }

    /// Writes the pictures into the buffer.
    pub(super) fn images(&mut self, textures: Textures) -> Result<(), String> {
        let Textures { pictures, names, .. } = textures;
        for (bytes, name) in pictures.encoded()?.into_iter().zip(names) {
            let view = self.buffer.view(&mut self.root, bytes, None);
            self.root.push(gltf_json::Image {
                buffer_view: Some(view),
                mime_type: Some(image::MimeType("image/png".to_owned())),
                name: Some(name).filter(|name| !name.is_empty()),
                uri: None,
                extensions: None,
                extras: Default::default(),
            });
        }
        Ok(())
    }
}

fn sampler_of(wrap: Wrap) -> texture::Sampler {
    let wrap = Checked::Valid(match wrap {
        Wrap::Repeat => texture::WrappingMode::Repeat,
        Wrap::Clamp => texture::WrappingMode::ClampToEdge,
    });
    texture::Sampler {
        mag_filter: Some(Checked::Valid(texture::MagFilter::Linear)),
        min_filter: Some(Checked::Valid(texture::MinFilter::LinearMipmapLinear)),
        wrap_s: wrap,
        wrap_t: wrap,
        ..texture::Sampler::default()
    }
}

impl Textures {
    /// Merges an opacity map into the alpha of a texture, or of white if there is only a map.
    fn with_opacity(
        &mut self,
        texture: Option<&Shared<Texture>>,
        map: Option<&Shared<Texture>>,
    ) -> Option<Shared<Texture>> {
        let Some(map) = map else { return texture.cloned() };
        if let Some(texture) = texture {
            let is_same = key(texture) == key(map) && map.picture.least_alpha() < 255;
            if is_same || map.picture.pixels().iter().all(|pixel| *pixel == [255; 4]) {
                return Some(texture.clone());
            }
        }
        let keys = [texture.map(|texture| key(texture)), Some(key(map))];
        let merged = self.merged.entry(keys);
        Some(merged.or_insert_with(|| Shared::new(merged_texture(texture, map))).clone())
    }
}

/// Multiplies a texture's alpha by an opacity map: by its alpha, or by its luminance if the map is
/// opaque. The result has the larger width and height, up to [`MOST_TEXELS`].
fn merged_texture(texture: Option<&Shared<Texture>>, map: &Texture) -> Texture {
    let by_brightness = map.picture.least_alpha() == 255;
    let opacity = |[r, g, b, alpha]: [f64; 4]| {
        if by_brightness { 0.2126 * r + 0.7152 * g + 0.0722 * b } else { alpha }
    };
    let Some(texture) = texture else {
        let white = |pixel: &[u8; 4]| [255, 255, 255, byte(opacity(pixel.map(f64::from)))];
        let pixels = map.picture.pixels().iter().map(white).collect();
        return with_pixels(map, map.picture.size(), pixels);
    };
    // The pictures may differ in size and layout, so both are sampled at the same surface point.
    let (own, other) = (texture.picture.size(), map.picture.size());
    let larger = Size::new(own.width.max(other.width), own.height.max(other.height));
    let size = if larger.area() <= MOST_TEXELS { larger } else { own };
    let mut pixels = vec![[0; 4]; size.area()];
    let rows = pixels.par_chunks_mut(size.width.max(1)).enumerate();
    rows.for_each(|(y, row)| {
        for (x, pixel) in row.iter_mut().enumerate() {
            let at = [middle(x, size.width), 1.0 - middle(y, size.height)];
            let [r, g, b, alpha] = sample(&texture.picture, texture.wrap, at);
            let over = opacity(sample(&map.picture, map.wrap, moved(texture, map, at)));
            *pixel = [r, g, b, alpha * over / 255.0].map(byte);
        }
    });
    with_pixels(texture, size, pixels)
}

fn with_pixels(like: &Texture, size: Size, pixels: Vec<[u8; 4]>) -> Texture {
    let picture = Picture::from_pixels(size, pixels).unwrap_or_default();
    Texture { picture: Shared::new(picture), ..like.clone() }
}

/// Returns the centre of a texel, from 0 to 1.
#[expect(clippy::cast_precision_loss, reason = "pictures have fewer rows than 2^52")]
fn middle(i: usize, count: usize) -> f64 {
    (i as f64 + 0.5) / count as f64
}

/// Converts coordinates in a texture to coordinates in a map at the same point of the surface.
fn moved(texture: &Texture, map: &Texture, at: [f64; 2]) -> [f64; 2] {
    std::array::from_fn(|i| {
        if texture.scale[i] == map.scale[i] || texture.scale[i] == 0.0 {
            return at[i] - texture.offset[i] + map.offset[i];
        }
        (at[i] - texture.offset[i]) / texture.scale[i] * map.scale[i] + map.offset[i]
    })
}

/// Samples a picture with bilinear filtering; (0, 0) is its lower left corner.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within the picture")]
#[expect(clippy::cast_precision_loss, reason = "pictures have fewer rows than 2^52")]
fn sample(picture: &Picture, wrap: Wrap, [u, v]: [f64; 2]) -> [f64; 4] {
    let size = picture.size();
    // Texel centres are at half integers.
    let along = |x: f64, count: usize| {
        let (x, count) = (x * count as f64 - 0.5, count as f64);
        let texel = |x: f64| match wrap {
            Wrap::Repeat => x.rem_euclid(count).min(count - 1.0) as usize,
            Wrap::Clamp => x.clamp(0.0, count - 1.0) as usize,
        };
        let first = x.floor();
        (texel(first), texel(first + 1.0), x - first)
    };
    let (left, right, across) = along(u, size.width);
    let (upper, lower, down) = along(1.0 - v, size.height);
    let row = |y| {
        let [a, b] = [left, right].map(|x| picture.pixel(x, y).map(f64::from));
        std::array::from_fn(|i| a[i] + (b[i] - a[i]) * across)
    };
    let [a, b]: [[f64; 4]; 2] = [upper, lower].map(row);
    std::array::from_fn(|i| a[i] + (b[i] - a[i]) * down)
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 255")]
fn byte(x: f64) -> u8 {
    x.round().clamp(0.0, 255.0) as u8
}

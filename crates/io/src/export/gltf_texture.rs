//! The textures of glTF, and their mapping onto surfaces.
//!
//! glTF stores the opacity of a surface in the alpha of its texture, so an opacity map is merged
//! into the texture ([`gltf_opacity`](super::gltf_opacity)). Offset and scale are applied to the
//! texture coordinates. Maps with different layouts get several sets of coordinates, because more
//! readers support sets than the extension for transforms.

use std::collections::HashMap;

use gltf_json::validation::Checked;
use gltf_json::{Index, image, texture};

use super::file_bytes::Encoded;
use super::gltf::Writer;
use super::gltf_opacity::{Layout, Merging, white_with};
use super::part_look::Look;
use super::pictures::Pictures;
use marraztu_core::base::Shared;
use marraztu_core::scene::{MapKind, Texture, Wrap};

/// Returns the layouts of a look's textures, in the order of a vertex's texture coordinates.
pub(super) fn layouts(look: &Look) -> Vec<Layout> {
    let map = |kind| look.map(kind).map(|map| &*map.texture);
    let base = match (look.texture.as_deref(), map(MapKind::Opacity)) {
        (Some(texture), Some(map)) => Some(Merging::of(texture, map).layout),
        (texture, map) => texture.or(map).map(Layout::of),
    };
    let others =
        [look.rough_metal.texture.as_deref(), map(MapKind::Emission), map(MapKind::Normal)]
            .map(|texture| texture.map(Layout::of));
    let mut layouts = Vec::new();
    for layout in base.into_iter().chain(others.into_iter().flatten()) {
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
    /// Roughness and metalness.
    pub(super) rough_metal: Option<texture::Info>,
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
    /// Whether a merged texture is an approximation.
    pub(super) approximated: bool,
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
        let rough_metal = look.rough_metal.texture.as_ref().map(&mut info);
        let mut map = |kind| look.map(kind).map(|map| info(&map.texture));
        let (emission, normal) = (map(MapKind::Emission), map(MapKind::Normal));
        Infos { base: base.as_ref().map(&mut info), emission, normal, rough_metal, cover }
    }

    fn texture(
        &mut self,
        textures: &mut Textures,
        of: &Shared<Texture>,
    ) -> Index<gltf_json::Texture> {
        // A new picture also gets a name.
        let number = textures.pictures.number(of);
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
        for (encoded, name) in pictures.encoded()?.into_iter().zip(names) {
            let Encoded { bytes, ending } = encoded?;
            let kind = if ending == "jpg" { "image/jpeg" } else { "image/png" };
            let view = self.buffer.view(&mut self.root, bytes, None);
            self.root.push(gltf_json::Image {
                buffer_view: Some(view),
                mime_type: Some(image::MimeType(kind.to_owned())),
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
        let keys = [texture.map(|texture| key(texture)), Some(key(map))];
        let merging = texture.map(|texture| (texture, Merging::of(texture, map)));
        if let Some((texture, merging)) = &merging {
            let is_same = keys[0] == keys[1] && map.picture.least_alpha() < 255;
            let is_white = || map.picture.pixels().iter().all(|pixel| *pixel == [255; 4]);
            if is_same || (merging.layout == Layout::of(texture) && is_white()) {
                return Some((*texture).clone());
            }
            self.approximated |= !merging.is_exact;
        }
        let merged = || match merging {
            Some((texture, merging)) => merging.merged(texture, map),
            None => white_with(map),
        };
        Some(self.merged.entry(keys).or_insert_with(|| Shared::new(merged())).clone())
    }
}

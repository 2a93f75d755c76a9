//! Converts Phong materials to glTF materials.

use std::collections::BTreeSet;

use gltf_json::material::{AlphaCutoff, AlphaMode, PbrBaseColorFactor, StrengthFactor};
use gltf_json::validation::Checked;
use gltf_json::{extensions, material};

use super::gltf::Writer;
use super::gltf_buffer::single;
use super::gltf_roughness::is_rough_metal;
use super::gltf_texture::{Cover, Infos, Textures};
use super::part_look::Look;
use marraztu_core::base::{Shared, color};
use marraztu_core::scene::{MapKind, Texture};

impl Writer<'_> {
    /// Writes the materials and the textures that they use.
    pub(super) fn materials(&mut self) -> Result<(), String> {
        let mut textures = Textures::default();
        let looks = std::mem::take(&mut self.looks.all);
        if looks.iter().any(loses_maps) {
            let text = "glTF has no height, specular or ambient maps: left out";
            self.notes.push(text.to_owned());
        }
        self.notes.extend(self.looks.scalars.notes().cloned());
        let lost: BTreeSet<&str> = looks.iter().flat_map(lost_maps).collect();
        if !lost.is_empty() {
            let lost: Vec<&str> = lost.into_iter().collect();
            self.notes.push(format!("glTF has no maps like {}: left out", lost.join(", ")));
        }
        for look in &looks {
            let infos = self.infos(&mut textures, look);
            if look.unlit {
                self.uses("KHR_materials_unlit");
            }
            if strength(look).is_some() {
                self.uses("KHR_materials_emissive_strength");
            }
            self.root.push(surface(look, infos));
        }
        if textures.approximated {
            let text = "glTF has one texture for colour and opacity: an opacity map that repeats \
                        differently from its texture is approximated";
            self.notes.push(text.to_owned());
        }
        self.images(textures)
    }
}

/// Returns whether a look has maps that glTF lacks. An ambient map that equals the texture is not a
/// loss: ambient light shows the texture anyway.
fn loses_maps(look: &Look) -> bool {
    look.maps.iter().any(|(kind, map)| match kind {
        MapKind::Specular => true,
        MapKind::Bump => look.map(MapKind::Normal).is_none(),
        MapKind::Ambient => {
            let is_shown = |it: &Shared<Texture>| Shared::same(&it.picture, &map.texture.picture);
            !look.texture.as_ref().is_some_and(is_shown)
        }
        // An exponent map becomes roughness, which an unlit surface does not have.
        MapKind::Exponent => look.rough_metal.texture.is_none(),
        MapKind::Opacity | MapKind::Emission | MapKind::Normal => false,
    })
}

/// Returns the keywords of the maps that glTF lacks.
fn lost_maps(look: &Look) -> impl Iterator<Item = &str> {
    let lost = look.undrawn_maps.iter().filter(|map| look.unlit || !is_rough_metal(map));
    lost.map(|map| map.keyword.as_str())
}

/// Converts a Phong material to metallic roughness.
fn surface(look: &Look, infos: Infos) -> gltf_json::Material {
    let Infos { base, emission, normal, rough_metal, cover } = infos;
    let normal_texture = normal.map(|info| material::NormalTexture {
        index: info.index,
        scale: 1.0,
        tex_coord: info.tex_coord,
        extensions: None,
        extras: Default::default(),
    });
    let [r, g, b] = look.base.map(linear);
    // Most readers sort blended surfaces, so blending is used only for partial alpha.
    let alpha_mode = match cover {
        _ if look.opacity < 1.0 => AlphaMode::Blend,
        Cover::Fades => AlphaMode::Blend,
        Cover::Holes => AlphaMode::Mask,
        Cover::Whole => AlphaMode::Opaque,
    };
    // glTF limits emission to 1; brighter light goes into the strength extension.
    let strength = strength(look);
    let emissive = look.material.emission.map(|x| color::linear(x) / strength.unwrap_or(1.0));
    let extensions = extensions::material::Material {
        unlit: look.unlit.then(extensions::material::Unlit::default),
        emissive_strength: strength.map(|strength| extensions::material::EmissiveStrength {
            emissive_strength: extensions::material::EmissiveStrengthFactor(single(strength)),
        }),
    };
    gltf_json::Material {
        alpha_cutoff: (alpha_mode == AlphaMode::Mask).then_some(AlphaCutoff(0.5)),
        alpha_mode: Checked::Valid(alpha_mode),
        double_sided: look.two_sided,
        emissive_texture: emission,
        emissive_factor: material::EmissiveFactor(emissive.map(factor)),
        normal_texture,
        name: Some(look.name.clone()).filter(|name| !name.is_empty()),
        pbr_metallic_roughness: material::PbrMetallicRoughness {
            base_color_factor: PbrBaseColorFactor([r, g, b, factor(look.opacity)]),
            base_color_texture: base,
            metallic_factor: StrengthFactor(factor(look.rough_metal.metalness)),
            metallic_roughness_texture: rough_metal,
            roughness_factor: StrengthFactor(factor(look.rough_metal.roughness)),
            ..material::PbrMetallicRoughness::default()
        },
        extensions: Some(extensions),
        ..gltf_json::Material::default()
    }
}

/// Returns the brightness of an emission brighter than white, as a multiple of white.
fn strength(look: &Look) -> Option<f64> {
    let most = look.material.emission.into_iter().map(color::linear).fold(0.0, f64::max);
    (most > 1.0 && !look.unlit).then_some(most)
}

/// Clamps a factor to 0..=1; NaN counts as 1.
fn factor(x: f64) -> f32 {
    if x < 1.0 { single(x.max(0.0)) } else { 1.0 }
}

/// Converts a display value to linear light (IEC 61966-2-1).
pub(super) fn linear(display: f64) -> f32 {
    single(color::linear(display.min(1.0)))
}

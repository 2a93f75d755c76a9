//! Phong's materials as those of glTF.

use gltf_json::material::{AlphaCutoff, AlphaMode, PbrBaseColorFactor, StrengthFactor};
use gltf_json::validation::Checked;
use gltf_json::{extensions, material, texture};

use super::gltf_buffer::single;
use super::look::Look;

/// A material: Phong's as metallic roughness.
pub(super) fn surface(
    i: usize,
    look: &Look,
    infos: [Option<texture::Info>; 3],
) -> gltf_json::Material {
    let [info, emissive, normal] = infos;
    let normal = normal.map(|info| material::NormalTexture {
        index: info.index,
        scale: 1.0,
        tex_coord: 0,
        extensions: None,
        extras: Default::default(),
    });
    let base = match (&look.texture, look.colored) {
        (Some(_), _) => look.tint,
        (None, true) => [1.0; 3],
        (None, false) => look.material.diffuse,
    };
    let [r, g, b] = base.map(linear);
    let has_holes = look.texture.as_ref().is_some_and(|it| it.picture.least_alpha() < 255);
    let unlit = look.unlit.then(extensions::material::Unlit::default);
    gltf_json::Material {
        alpha_cutoff: has_holes.then_some(AlphaCutoff(0.5)),
        alpha_mode: Checked::Valid(match (has_holes, look.opacity < 1.0) {
            (true, _) => AlphaMode::Mask,
            (false, true) => AlphaMode::Blend,
            (false, false) => AlphaMode::Opaque,
        }),
        double_sided: look.two_sided,
        emissive_texture: emissive,
        emissive_factor: material::EmissiveFactor(look.material.emission.map(linear)),
        normal_texture: normal,
        name: Some(format!("material {}", i + 1)),
        pbr_metallic_roughness: material::PbrMetallicRoughness {
            base_color_factor: PbrBaseColorFactor([r, g, b, single(look.opacity)]),
            base_color_texture: info,
            metallic_factor: StrengthFactor(0.0),
            roughness_factor: StrengthFactor(roughness(look.material.exponent)),
            ..material::PbrMetallicRoughness::default()
        },
        extensions: Some(extensions::material::Material { unlit }),
        ..gltf_json::Material::default()
    }
}

/// The roughness for a highlight with Phong's exponent.
fn roughness(exponent: f64) -> f32 {
    single(libm::pow(2.0 / (4.0 * exponent.max(0.0) + 2.0), 0.25))
}

/// A display value as linear light (IEC 61966-2-1).
pub(super) fn linear(display: f64) -> f32 {
    let s = display.clamp(0.0, 1.0);
    single(if s <= 0.04045 { s / 12.92 } else { libm::pow((s + 0.055) / 1.055, 2.4) })
}

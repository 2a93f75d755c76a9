//! Plans the emission of surfaces, and their maps in addition to the texture.

use super::planning::{Ground, LARGEST, Planner, Planning};
use crate::frame::Rules;
use crate::frame::draw::Stage;
use crate::frame::extras::{Bump, Extras, Glow};
use crate::lights::{Form, PhongMaterial};
use marraztu_core::accuracy::LightAt;
use marraztu_core::base::Shared;
use marraztu_core::base::color::linear;
use marraztu_core::scene::{
    MapKind, Material, Optics, PartLook, SurfaceMap, Texture, Transmission,
};

/// Returns a map of a part, if its mesh has texture coordinates.
pub(super) fn mapped<'a>(
    ground: &Ground<'_>,
    look: &PartLook<'a>,
    kind: MapKind,
) -> Option<&'a SurfaceMap> {
    look.map(kind).filter(|_| !ground.object.model.mesh.uvs().is_empty())
}

/// Returns a material with colours decoded from sRGB.
pub(super) fn decoded(material: &Material) -> Material {
    let Material { ambient, diffuse, specular, exponent, emission, optics } = *material;
    let [ambient, diffuse, specular, emission] =
        [ambient, diffuse, specular, emission].map(|color| color.map(linear));
    let transmission = match optics.transmission {
        Transmission::Filter(filter) => Transmission::Filter(filter.map(linear)),
        other => other,
    };
    let optics = Optics { transmission, ..optics };
    Material { ambient, diffuse, specular, exponent, emission, optics }
}

/// Returns whether an opacity map is the texture itself with the same layout: its alpha counts
/// already.
pub(super) fn holds_same_alpha(texture: Option<&Shared<Texture>>, map: &Shared<Texture>) -> bool {
    texture.is_some_and(|texture| {
        let is_same = Shared::same(texture, map)
            || (Shared::same(&texture.picture, &map.picture)
                && (texture.wrap, texture.offset, texture.scale)
                    == (map.wrap, map.offset, map.scale));
        // An opaque map counts by its brightness instead of its alpha.
        is_same && map.picture.least_alpha() < 255
    })
}

/// Returns the emission of a surface, if it has any.
pub(super) fn emission(
    rules: Rules,
    ground: &Ground<'_>,
    look: &PartLook<'_>,
    factor: f64,
) -> Option<Glow> {
    // Files may hold any number.
    let number = |k: f64| if k.is_nan() { 0.0 } else { k.clamp(0.0, LARGEST) };
    let color = look.material.emission.map(|k| number(k * factor));
    if rules.emission(color).is_some() {
        return None;
    }
    let map = mapped(ground, look, MapKind::Emission).map(|map| map.texture.clone());
    Some(Glow { color, map })
}

/// Replaces the ambient stages of a surface with a separate ambient map by one glow. `None` if
/// there is no such light, or the map is the texture, which multiplies ambient light anyway.
pub(super) fn mapped_ambient(
    into: &Planning,
    ground: &Ground<'_>,
    (look, texture): (&PartLook<'_>, Option<&Shared<Texture>>),
    material: &PhongMaterial,
    stages: &mut Vec<Stage>,
) -> Option<Glow> {
    let map = &mapped(ground, look, MapKind::Ambient)?.texture;
    if texture.is_some_and(|texture| Shared::same(texture, map)) {
        return None;
    }
    let mut color = None;
    stages.retain(|stage| {
        // Only ambient light reads no positions.
        if !stage.effect.reads_positions {
            let light = into.plan.lights[stage.light as usize].color;
            let sum = color.get_or_insert([0.0; 3]);
            *sum = std::array::from_fn(|i| sum[i] + light[i] * material.ambient[i]);
        }
        stage.effect.reads_positions
    });
    color.map(|color| Glow { color, map: Some(map.clone()) })
}

impl Planner<'_> {
    /// Returns the map that tilts the normals of a part: the normal map, if it has both kinds. Only
    /// light per pixel can show it.
    pub(super) fn bump(
        &self,
        rules: Rules,
        ground: &Ground<'_>,
        look: &PartLook<'_>,
    ) -> Option<Bump> {
        if self.shot.settings.light != LightAt::Pixel {
            return None;
        }
        if let Some(normals) = mapped(ground, look, MapKind::Normal) {
            return Some(Bump { map: normals.texture.clone(), gain: None });
        }
        let heights = mapped(ground, look, MapKind::Bump)?;
        // A gain that is infinite or NaN counts as flat.
        let gain = if heights.gain.is_finite() { heights.gain.clamp(-1e6, 1e6) } else { 0.0 };
        let is_flat = rules.bumps(gain).is_some();
        (!is_flat).then(|| Bump { map: heights.texture.clone(), gain: Some(gain) })
    }

    /// Sets the maps of highlights, if there are any.
    pub(super) fn map_highlights(
        &self,
        ground: &Ground<'_>,
        look: &PartLook<'_>,
        extras: &mut Extras,
        stages: &mut [Stage],
    ) {
        // Without highlights, no pixel shows either map.
        if stages.iter().all(|stage| stage.highlight == Form::Plain) {
            return;
        }
        let map = |kind| mapped(ground, look, kind).map(|map| map.texture.clone());
        extras.specular = map(MapKind::Specular);
        // Only light per pixel can follow a map of exponents.
        if self.shot.settings.light == LightAt::Pixel {
            extras.exponent = map(MapKind::Exponent);
        }
        for stage in stages {
            stage.is_mapped = extras.exponent.is_some() && stage.highlight != Form::Plain;
        }
    }
}

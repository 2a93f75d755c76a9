//! Plans shadows: which lights and which objects cast them.
//!
//! Everything drawn filled casts shadows, from both of its sides, even if the observer does not see
//! it. Things that are not drawn cast no shadows: hidden objects and parts, a wireframe, parts with
//! an opacity below one half, excluded polygons, and the marks of cameras and bulbs. Light passes
//! through holes of textures.

use std::borrow::Cow;

use glam::DMat3;

use super::maps::holds_same_alpha;
use super::planning::{Ground, Planner, Planning, Shining};
use super::rules::TexturedSurface;
use super::uses::{Effect, EffectState, EffectUse, Thing};
use crate::frame::FramePlan;
use crate::frame::shadows::{Caster, CasterPart, Holes, Shadows};
use marraztu_core::base::math;
use marraztu_core::scene::{Fill, ItemId, MapKind, Object, ObjectId, PartLook};

/// The fewest samples of a light for each sample of a pixel, unless fewer are chosen.
const LEAST_SAMPLES: u32 = 16;

/// The same for each ray of a pixel: mirrors and glass send on many.
pub(super) const LEAST_OF_RAYS: u32 = 2;

/// Returns the samples of a light for each of the points of a pixel that are lit one by one: they
/// share those of the pixel, and have at least `least`, unless fewer are chosen.
pub(super) fn light_samples(plan: &FramePlan, points: u32, least: u32) -> u32 {
    let chosen = plan.variants.light_samples.count();
    (chosen / points).max(chosen.min(least))
}

impl Planner<'_> {
    /// Adds the casters, if any light casts shadows.
    pub(super) fn add_shadows(&self, into: &mut Planning) {
        let is_filled = self.shot.view.fill == Fill::Filled;
        if is_filled && into.plan.shadows.sources.iter().any(Option::is_some) {
            let mut objects: Vec<_> = self.shot.scene.objects.iter().collect();
            // By id, so reordering the list of objects does not change the casters.
            objects.sort_by_key(|(id, _)| *id);
            objects.retain(|(id, object)| self.not_asked_for(*id, object).is_none());
            let casters = objects.into_iter().filter_map(|(id, object)| self.caster(id, object));
            into.plan.shadows.casters = casters.collect();
            let points = if into.plan.lit_by_sample { into.plan.samples.count() } else { 1 };
            into.plan.shadows.samples = light_samples(&into.plan, points, LEAST_SAMPLES);
        }
        if into.plan.shadows.casters.is_empty() {
            into.plan.shadows = Shadows::default();
        }
        // Explains each light that could cast shadows and does not.
        for shining in &self.shining {
            let Some(light) = self.shot.scene.lights.get(shining.id) else { continue };
            let reason = match () {
                () if !light.can_cast_shadows() => continue,
                () if !light.shadows => "switched off",
                () if !is_filled => "edges only",
                () if into.plan.shadows.casters.is_empty() => "no object casts shadows",
                () => continue,
            };
            into.notes.add(|| note(shining, None, EffectState::left_out(reason)));
        }
    }

    fn caster(&self, id: ObjectId, object: &Object) -> Option<Caster> {
        let world_from_object = object.world_from_mesh(self.shot.view.time);
        let mesh = &object.model.mesh;
        // An object with a flat placement is not drawn, so it casts no shadow.
        let is_flat = !math::has_full_rank(DMat3::from_mat4(world_from_object));
        if is_flat || mesh.polygon_count() == 0 {
            return None;
        }
        let parts = (0..mesh.parts().len())
            .map(|part| u32::try_from(part).expect("parts are numbered by 32 bits"))
            .map(|part| self.caster_part(object, part))
            .collect();
        let polygons = self.polygons_of(id);
        let (item, model) = (ItemId::Object(id), object.model.clone());
        Some(Caster { item, model, world_from_object, parts, polygons })
    }

    /// Notes whether the shadows of a light fall on an object. `no_light` is the reason why its
    /// light does not reach the object, if there is one.
    pub(super) fn note_shadows(
        into: &mut Planning,
        ground: &Ground<'_>,
        shining: &Shining,
        no_light: Option<&'static str>,
    ) {
        if into.plan.shadows.source(shining.light).is_none() {
            return;
        }
        let is_mark = !matches!(ground.item, ItemId::Object(_));
        let samples = into.plan.shadows.samples;
        let method: Cow<'static, str> = match into.plan.variants.shadow_method.map() {
            None if into.plan.shadows.radius(shining.light) > 0.0 => {
                format!("soft, {samples} samples").into()
            }
            None => "exact".into(),
            Some(form) if form.is_filtered => "shadow maps, 3 x 3 texels".into(),
            Some(_) => "shadow maps".into(),
        };
        let reason = if is_mark { Some("markers receive no shadows") } else { no_light };
        let state = reason.map_or(EffectState::On(method), EffectState::left_out);
        into.notes.add(|| note(shining, ground.thing(), state));
    }
}

/// Describes the shadows of a light.
fn note(shining: &Shining, on: Option<Thing>, state: EffectState) -> EffectUse {
    let name = format!("Shadows of {}", shining.name);
    EffectUse { name, ..EffectUse::new(Effect::Shadows(shining.id), on, state) }
}

impl Planner<'_> {
    /// Returns the caster of a part of an object. `None` if the part is not drawn.
    fn caster_part(&self, object: &Object, part: u32) -> Option<CasterPart> {
        let mut look = object.part_look(part);
        self.settle_transmission(object, &mut look);
        let filter = self.filter(object, &look);
        // Below one half, even opaque texels fail the alpha test.
        if !object.shows_part(part) || look.opacity < 0.5 {
            return None;
        }
        Some(CasterPart { holes: holes(object, &look), filter })
    }
}

/// Returns the holes of a part of an object, if it has any.
fn holes(object: &Object, look: &PartLook<'_>) -> Option<Holes> {
    let mapped = !object.model.mesh.uvs().is_empty();
    let texture = look.texture.filter(|_| mapped);
    let map = look.map(MapKind::Opacity).filter(|_| mapped).map(|map| &map.texture);
    // A map with the texture's alpha would count twice.
    let map = map.filter(|map| !holds_same_alpha(texture, map));
    let surface = TexturedSurface { texture, opacity_map: map, opacity: look.opacity };
    let holes = || Holes {
        texture: texture.cloned(),
        map: map.cloned(),
        // NaN counts as opaque, as on the visible surface.
        opacity: if look.opacity < 1.0 { look.opacity } else { 1.0 },
    };
    let is_pictured = texture.is_some() || map.is_some();
    (is_pictured && !surface.passes_everywhere()).then(holes)
}

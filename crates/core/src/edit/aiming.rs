//! Aims lights: finds the position of a light and its direction to a point.

use glam::DVec3;

use super::{Change, GesturePhase, Refusal, framing, lights, placement, set_transform};
use crate::base::math;
use crate::scene::{Aim, Anchor, ItemId, LightId, LightOrigin, Scene, SpotOwner, Tracked, View};

/// The distance of a sun's mark from the middle of the scene, in the scene's radii.
const SUN: f64 = 0.6;

/// A light within this distance of an object's centre, in the object's radii, is in the centre.
const NEAR: f64 = 0.1;

/// Returns the selected light, if it can be aimed.
///
/// # Errors
/// If the light is neither a spot nor a sun, or is locked.
pub fn can_aim(scene: &Scene, view: &View) -> Result<LightId, Refusal> {
    let (id, light) = set_transform::selected_light(scene, view)?;
    set_transform::unlocked(scene, ItemId::Light(id))?;
    if light.kind.has_direction() { Ok(id) } else { Err(Refusal::NotAimed) }
}

/// Returns the position and direction of a light, for its mark and for aiming it.
///
/// A sun is infinitely far away, so its position is next to the scene, on the side from which it
/// shines. Ambient light has no position, so the result is `None`.
pub fn stands(scene: &Scene, view: &View, id: LightId) -> Option<Aim> {
    let LightOrigin { position, direction } =
        scene.light_origin(view, &scene.lights.get(id)?.kind)?;
    match (position, direction) {
        (None, None) => None,
        (None, Some(direction)) => {
            let ids: Vec<_> = scene.objects.ids().collect();
            let sphere = framing::sphere(scene, view, &ids);
            let (centre, radius) =
                sphere.map_or((DVec3::ZERO, 100.0), |sphere| (sphere.centre, sphere.radius));
            Some(Aim { position: centre - direction * (SUN * radius).max(1e-3), direction })
        }
        (Some(position), direction) => {
            Some(Aim { position, direction: direction.unwrap_or(DVec3::NEG_Y) })
        }
    }
}

/// Aims the selected light at the centre of the selected object.
///
/// # Errors
/// If the scene has no object, or the light cannot be aimed or is in the object's centre.
pub fn aim_at_selection(scene: &Scene, view: &View, phase: GesturePhase) -> Change {
    let id = can_aim(scene, view)?;
    let (object, _) = set_transform::selected_object(scene, view)?;
    let sphere = framing::sphere(scene, view, &[object]).ok_or(Refusal::NothingToFrame)?;
    let from = stands(scene, view, id).ok_or(Refusal::NotAimed)?.position;
    if from.distance(sphere.centre) < NEAR * sphere.radius {
        // From inside the object, no direction leads to it.
        return Err(Refusal::AimedAtItself);
    }
    aim(scene, view, id, sphere.centre, phase)
}

/// Aims a light at a point. A spot that follows its owner becomes fixed at its current position.
///
/// # Errors
/// If the light cannot be aimed or is at that point.
pub fn aim(scene: &Scene, view: &View, id: LightId, at: DVec3, phase: GesturePhase) -> Change {
    let light = scene.lights.get(id).ok_or(Refusal::Gone)?;
    let from = stands(scene, view, id).ok_or(Refusal::NotAimed)?.position;
    let direction = math::unit(at - from).ok_or(Refusal::AimedAtItself)?;
    match light.kind.anchor() {
        Anchor::Everywhere | Anchor::Position(_) => Err(Refusal::NotAimed),
        Anchor::Direction(_) | Anchor::Owner(SpotOwner::Fixed(_)) => {
            placement::light_direction(scene, id, direction, phase)
        }
        Anchor::Owner(_) => {
            let aim = Aim { position: from, direction };
            lights::set_owner(scene, id, SpotOwner::Fixed(Tracked::new(aim)))
        }
    }
}

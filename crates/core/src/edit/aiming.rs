//! Aims lights: where each stands, and which direction leads to a point.

use glam::DVec3;

use super::{GesturePhase, Refusal, framing, lights, placement, set_transform};
use crate::base::math;
use crate::scene::{
    Aim, Anchor, Command, ItemId, LightId, LightOrigin, Scene, SpotOwner, Tracked, View,
};

/// How far from the middle of the scene the mark of a sun stands, in its radii.
const SUN: f64 = 0.6;

/// A light nearer to the centre of an object than this, in the object's radii, is in the centre.
const NEAR: f64 = 0.1;

/// The selected light, if it can be aimed.
///
/// # Errors
/// If it is neither a spot nor a sun.
pub fn can_aim(scene: &Scene, view: &View) -> Result<LightId, Refusal> {
    let (id, light) = set_transform::selected_light(scene, view)?;
    set_transform::unlocked(scene, ItemId::Light(id))?;
    if light.kind.has_direction() { Ok(id) } else { Err(Refusal::NotAimed) }
}

/// The position and the direction of a light, for its mark and to aim it.
///
/// A sun, which is infinitely far away, stands beside the scene, on the side that it shines from;
/// ambient light stands nowhere.
#[must_use]
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
/// If there is no object, or the light cannot be aimed or stands in the centre.
pub fn aim_at_selection(
    scene: &Scene,
    view: &View,
    phase: GesturePhase,
) -> Result<Command, Refusal> {
    let id = can_aim(scene, view)?;
    let (object, _) = set_transform::selected_object(scene, view)?;
    let sphere = framing::sphere(scene, view, &[object]).ok_or(Refusal::NothingToFrame)?;
    let from = stands(scene, view, id).ok_or(Refusal::NotAimed)?.position;
    if from.distance(sphere.centre) < NEAR * sphere.radius {
        // From within the object no direction leads to it.
        return Err(Refusal::AimedAtItself);
    }
    aim(scene, view, id, sphere.centre, phase)
}

/// Aims a light at a point. A spot that follows its owner stays where it is from then on.
///
/// # Errors
/// If the light cannot be aimed or stands there.
pub fn aim(
    scene: &Scene,
    view: &View,
    id: LightId,
    at: DVec3,
    phase: GesturePhase,
) -> Result<Command, Refusal> {
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

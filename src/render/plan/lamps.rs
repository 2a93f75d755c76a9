//! The lights of a frame, in the observer's terms.

use glam::{DMat4, DVec3};

use super::{FramePlan, ObserverSpace};
use crate::base::math;
use crate::render::effects::{self, Entry, Lamp};
use crate::scene::{Attenuation, LightId, LightKind, Scene, SpotOwner, View};

/// The lights that shine, in the observer's space.
pub(super) fn lamps(
    plan: &mut FramePlan,
    scene: &Scene,
    view: &View,
    observer: &ObserverSpace,
) -> Vec<Shining> {
    let mut shining = Vec::new();
    // The oldest first, as with objects: the order of the list cannot show in the last bit of a sum.
    let mut lights: Vec<_> = scene.lights.iter().collect();
    lights.sort_by_key(|(id, _)| *id);
    for (id, light) in lights {
        if !light.on {
            plan.skip(&light.name, "switched off");
            continue;
        }
        let Some(source) = source(scene, view, &light.kind) else {
            let reason = match &light.kind {
                LightKind::Spot { owner: SpotOwner::SelectedObject, .. } => "no object",
                _ => "what it is fixed to is not there",
            };
            plan.skip(&light.name, reason);
            continue;
        };
        let lamp = u32::try_from(plan.lamps.len()).expect("fewer than 2^32 lights");
        let place = observer.view_from_world.transform_point3(source.position);
        if !place.is_finite() {
            plan.skip(&light.name, "its place is no number");
            continue;
        }
        let (position, attenuation) = within_reach(place, &light.attenuation, observer.unit);
        let turned = math::unit(observer.view_from_world.transform_vector3(source.direction));
        plan.lamps.push(Lamp {
            color: light.color.factors(),
            position: position.to_array(),
            direction: turned.unwrap_or(DVec3::NEG_Z).to_array(),
            attenuation,
            cos_half_aperture: source.cos_half_aperture,
            exponent: source.exponent,
        });
        shining.push(Shining { id, name: light.name.clone(), effect: source.effect, lamp });
    }
    shining
}

/// How far off a lamp may be, in units of view space, so that in f32 its distance has a square.
const REACH: f64 = 1e15;

/// A lamp's place in view space and the coefficients by which it fades there. One that is farther than
/// [`REACH`] is brought that near, and fades in proportion: seen from a view of some thousand units,
/// neither its direction nor its light changes by a part in 10^11.
fn within_reach(place: DVec3, fades: &Attenuation, unit: f64) -> (DVec3, [f64; 3]) {
    let largest = place.abs().max_element();
    let nearer = if largest > REACH { largest / REACH } else { 1.0 };
    // Held to what has a square.
    let step = (nearer / unit).min(1e150);
    // What fades to nothing at once fades so at any distance.
    let held = |coefficient: f64| coefficient.min(f64::MAX);
    let coefficients =
        [fades.constant, held(fades.linear * step), held(fades.quadratic * step * step)];
    (place / nearer, coefficients)
}

/// A light that shines in this frame.
#[derive(Clone, Debug)]
pub(super) struct Shining {
    pub(super) id: LightId,
    pub(super) name: String,
    pub(super) effect: &'static Entry,
    /// The place of its light among the lamps of the plan.
    pub(super) lamp: u32,
}

/// Where light comes from, in world space.
struct Source {
    effect: &'static Entry,
    position: DVec3,
    direction: DVec3,
    cos_half_aperture: f64,
    exponent: f64,
}

/// Where a light is now; `None` for a spot whose owner is not there.
fn source(scene: &Scene, view: &View, kind: &LightKind) -> Option<Source> {
    let source = |effect, position, direction| Source {
        effect,
        position,
        direction,
        cos_half_aperture: -1.0,
        exponent: 0.0,
    };
    Some(match kind {
        LightKind::Ambient => source(&effects::AMBIENT, DVec3::ZERO, DVec3::NEG_Z),
        LightKind::Sun { direction } => source(&effects::SUN, DVec3::ZERO, *direction.now()),
        LightKind::Bulb { position, orbit } => {
            source(&effects::BULB, orbit.at(*position.now(), view.time), DVec3::NEG_Z)
        }
        LightKind::Spot { owner, half_aperture, exponent } => {
            let (position, direction) = owner_aim(scene, view, owner)?;
            Source {
                cos_half_aperture: libm::cos(half_aperture.to_radians()),
                exponent: *exponent,
                ..source(&effects::SPOT, position, direction)
            }
        }
    })
}

/// From where and which way a spot shines.
fn owner_aim(scene: &Scene, view: &View, owner: &SpotOwner) -> Option<(DVec3, DVec3)> {
    let along = |frame: DMat4| (frame.w_axis.truncate(), -frame.z_axis.truncate());
    let object = |id| scene.objects.get(id).map(|o| along(Scene::frame_of_object(o, view.time)));
    let camera = |id| scene.cameras.get(id).map(|c| along(c.pose.now().world_from_camera()));
    match owner {
        SpotOwner::SelectedObject => object(view.object?),
        SpotOwner::SelectedCamera => camera(view.camera),
        SpotOwner::Object(id) => object(*id),
        SpotOwner::Camera(id) => camera(*id),
        SpotOwner::Fixed(aim) => Some((aim.now().position, aim.now().direction)),
    }
}

//! The lights of a frame, in the observer's terms.

use glam::DVec3;

use super::planning::{Planning, Shining};
use super::rules::LightFacts;
use super::uses::{Effect, EffectUse, State};
use crate::base::math;
use crate::render::lights;
use crate::render::lights::{LightRow, ViewLight};
use crate::render::plan::observer::ObserverSpace;
use crate::scene::{Aim, Attenuation, LightKind, Scene, View};

/// The lights that a frame evaluates, in the observer's space.
pub(super) fn lamps(
    into: &mut Planning,
    scene: &Scene,
    view: &View,
    observer: &ObserverSpace,
) -> Vec<Shining> {
    let mut shining = Vec::new();
    // The oldest first, as with objects: the order of the list cannot show in the last bit of a sum.
    let mut lights: Vec<_> = scene.lights.iter().collect();
    lights.sort_by_key(|(id, _)| *id);
    for (id, light) in lights {
        let place_of = |source: &Source| observer.view_from_world.transform_point3(source.position);
        let source = source(scene, view, &light.kind).filter(|source| place_of(source).is_finite());
        let facts = LightFacts { light, is_placed: source.is_some() };
        if let Some(reason) = into.plan.rules.light(&facts) {
            into.notes.add(|| EffectUse {
                effect: Effect::Light(id),
                name: light.name.clone(),
                on: None,
                state: State::exact(reason),
                pixels: None,
            });
            continue;
        }
        // What is off or nowhere shines black: so it can be computed, too.
        let shines = light.on && source.is_some();
        let source = source.unwrap_or_else(|| Source::new(&lights::SPOT));
        let lamp = u32::try_from(into.plan.lamps.len()).expect("fewer than 2^32 lights");
        let (position, attenuation) =
            within_reach(place_of(&source), &light.attenuation, observer.unit);
        let turned = math::unit(observer.view_from_world.transform_vector3(source.direction));
        into.plan.lights.push(id);
        into.plan.lamps.push(ViewLight {
            color: if shines { light.color.factors() } else { [0.0; 3] },
            position: position.to_array(),
            direction: turned.unwrap_or(DVec3::NEG_Z).to_array(),
            attenuation,
            cos_half_aperture: source.cos_half_aperture,
            exponent: source.exponent.min(LARGEST),
        });
        shining.push(Shining { id, name: light.name.clone(), effect: source.effect, lamp, shines });
    }
    shining
}

/// How far off a lamp may be, in units of view space, so that in f32 its distance has a square.
const REACH: f64 = 1e15;

/// The largest exponent: what is off the axis is dark long before it.
const LARGEST: f64 = 1e30;

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

/// Where light comes from, in world space.
struct Source {
    effect: &'static LightRow,
    position: DVec3,
    direction: DVec3,
    cos_half_aperture: f64,
    exponent: f64,
}

impl Source {
    /// Light that goes everywhere from the origin.
    const fn new(effect: &'static LightRow) -> Self {
        Self {
            effect,
            position: DVec3::ZERO,
            direction: DVec3::NEG_Z,
            cos_half_aperture: -1.0,
            exponent: 0.0,
        }
    }
}

/// Where a light is now; `None` for a spot whose owner is not there.
fn source(scene: &Scene, view: &View, kind: &LightKind) -> Option<Source> {
    Some(match kind {
        LightKind::Ambient => Source::new(&lights::AMBIENT),
        LightKind::Sun { direction } => {
            Source { direction: *direction.now(), ..Source::new(&lights::SUN) }
        }
        LightKind::Bulb { position, orbit } => {
            Source { position: orbit.at(*position.now(), view.time), ..Source::new(&lights::BULB) }
        }
        LightKind::Spot { owner, half_aperture, exponent } => {
            let Aim { position, direction } = scene.aim(view, owner)?;
            Source {
                position,
                direction,
                cos_half_aperture: libm::cos(half_aperture.to_radians()),
                exponent: *exponent,
                ..Source::new(&lights::SPOT)
            }
        }
    })
}

//! The lights of a frame, in view space.

use glam::DVec3;

use super::observer::ObserverSpace;
use super::planning::{Planning, Shining};
use super::rules::LightFacts;
use super::uses::{Effect, EffectState, EffectUse};
use crate::frame::panorama::PlacedPanorama;
use crate::frame::shadows::ShadowSource;
use crate::lights::{self, LightRow, ViewLight};
use marraztu_core::base::color::Color;
use marraztu_core::base::{color, math};
use marraztu_core::scene::{
    Attenuation, CONCENTRATION, HALF_APERTURE, Light, LightKind, LightOrigin, Scene, View,
};

/// Transforms the lights that a frame evaluates to view space.
pub(super) fn view_lights(
    into: &mut Planning,
    scene: &Scene,
    view: &View,
    observer: &ObserverSpace,
) -> Vec<Shining> {
    let mut shining = Vec::new();
    let linear = into.plan.variants.are_linear();
    let factor = exposure(into, view);
    // The oldest first, as with objects: the order of the list must not change the last bit of a
    // sum.
    let mut lights: Vec<_> = scene.lights.iter().collect();
    lights.sort_by_key(|(id, _)| *id);
    for (id, light) in lights {
        let place_of = |source: &Source| observer.view_from_world.transform_point3(source.position);
        let source = source(scene, view, &light.kind).filter(|source| place_of(source).is_finite());
        let facts = LightFacts { light, is_placed: source.is_some() };
        if let Some(reason) = into.plan.rules.light(&facts) {
            into.notes.add(|| EffectUse {
                name: light.name.clone(),
                ..EffectUse::new(Effect::Light(id), None, EffectState::left_out(reason))
            });
            continue;
        }
        // A light that is off or has no position is black, which lets it be computed, too.
        let shines = light.on && source.is_some();
        let source = source.unwrap_or_else(|| Source::new(&lights::SPOT));
        let is_soft = shines && light.is_soft() && into.plan.variants.have_soft_shadows();
        let Ball { source, attenuation, radius } = match is_soft {
            true => ball(light, source, observer),
            false => Ball { source, attenuation: light.attenuation, radius: 0.0 },
        };
        let index = u32::try_from(into.plan.lights.len()).expect("fewer than 2^32 lights");
        let (position, attenuation) = within_reach(place_of(&source), &attenuation, observer.unit);
        let turned = math::unit(observer.view_from_world.transform_vector3(source.direction));
        into.plan.shadows.sources.push(shadow_source(light, &source).filter(|_| shines));
        into.plan.shadows.radii.push(radius);
        into.plan.light_ids.push(id);
        let shine = |color: Color| match (shines, linear) {
            (false, _) => [0.0; 3],
            (true, false) => color.factors().map(|x| x * factor),
            (true, true) => color.factors().map(|x| color::linear(x) * factor),
        };
        let color = shine(light.color);
        let panorama = light.kind.panorama().map(|sky| {
            PlacedPanorama::new(sky, (Some(index), color), observer.view_from_world, linear)
        });
        into.plan.lights.push(ViewLight {
            color,
            ground: match light.kind {
                LightKind::Sky { ground, .. } => shine(ground),
                _ => [0.0; 3],
            },
            position: position.to_array(),
            direction: turned.unwrap_or(DVec3::NEG_Z).to_array(),
            attenuation,
            cos_half_aperture: source.cos_half_aperture,
            exponent: source.exponent.min(LARGEST),
        });
        // A black sky is left out, and the background is seen.
        into.plan.panoramas.extend(panorama.filter(|_| shines && color != [0.0; 3]));
        shining.push(Shining {
            id,
            name: light.name.clone(),
            effect: source.effect,
            light: index,
            shines,
        });
    }
    shining
}

/// A light with an extent, as a ball.
struct Ball {
    source: Source,
    attenuation: Attenuation,
    /// The radius in world space.
    radius: f64,
}

/// The distance of a sun with an extent from the observer, in units of view space: over a view of
/// about a thousand units, its direction changes by a millionth.
const FAR_SUN: f64 = 1e9;

/// Returns a light with an extent as a ball: a sun is a bulb far away that does not fade.
fn ball(light: &Light, source: Source, observer: &ObserverSpace) -> Ball {
    if matches!(light.kind, LightKind::Sky { .. }) {
        return Ball { source, attenuation: light.attenuation, radius: f64::INFINITY };
    }
    if light.kind.has_position() {
        return Ball { source, attenuation: light.attenuation, radius: light.size };
    }
    let distance = FAR_SUN / observer.unit;
    let eye = observer.world_from_view.w_axis.truncate();
    let towards = math::unit(source.direction).map_or(DVec3::Y, |direction| -direction);
    let attenuation = Attenuation { constant: 1.0, linear: 0.0, quadratic: 0.0 };
    Ball {
        source: Source { effect: &lights::BULB, position: eye + towards * distance, ..source },
        attenuation,
        radius: distance * libm::sin((light.size / 2.0).to_radians()),
    }
}

/// Returns the factor of all light, and adds its row to the explanation.
fn exposure(into: &mut Planning, view: &View) -> f64 {
    let factor = view.light_factor();
    into.notes.add(|| {
        let state = match view.exposure {
            0.0 => EffectState::left_out("it is 0"),
            _ => EffectState::On(format!("all light times {factor:.3}").into()),
        };
        EffectUse::new(Effect::Exposure, None, state)
    });
    factor
}

/// Returns the end of shadow rays, if the light casts shadows.
fn shadow_source(light: &Light, source: &Source) -> Option<ShadowSource> {
    let is_ball = std::ptr::eq(source.effect, &lights::BULB);
    let end = if light.kind.has_position() && light.kind.has_direction() {
        match math::unit(source.direction) {
            Some(direction) => ShadowSource::Cone {
                at: source.position,
                direction,
                cos_half_aperture: source.cos_half_aperture,
            },
            // Without a valid direction, shadows are planned all around the light.
            None => ShadowSource::Point(source.position),
        }
    } else if light.kind.has_position() || is_ball {
        ShadowSource::Point(source.position)
    } else if matches!(light.kind, LightKind::Sky { .. }) {
        ShadowSource::Everywhere
    } else if light.kind.has_direction() {
        ShadowSource::Direction(-math::unit(source.direction)?)
    } else {
        return None;
    };
    light.shadows.then_some(end)
}

/// The largest distance of a light, in units of view space, with a square that fits f32.
const REACH: f64 = 1e15;

/// The largest exponent of a spot: at this exponent, everything off its axis is dark.
const LARGEST: f64 = 1e30;

/// Returns a light's position and attenuation in view space. A light farther than [`REACH`] is
/// moved to that distance, with its attenuation in proportion: within a view of about a thousand
/// units, neither its direction nor its light changes by a part in 10^11.
fn within_reach(place: DVec3, fades: &Attenuation, unit: f64) -> (DVec3, [f64; 3]) {
    let largest = place.abs().max_element();
    let nearer = if largest > REACH { largest / REACH } else { 1.0 };
    // Clamped to keep its square within f64.
    let step = (nearer / unit).min(1e150);
    // A coefficient beyond the largest number is dark at any distance.
    let clamped = |coefficient: f64| coefficient.min(f64::MAX);
    // A distance d in view space is d * step in the world, so coefficients take its powers.
    let coefficients =
        [fades.constant, clamped(fades.linear * step), clamped(fades.quadratic * step * step)];
    (place / nearer, coefficients)
}

/// The source of a light in world space.
struct Source {
    effect: &'static LightRow,
    position: DVec3,
    direction: DVec3,
    cos_half_aperture: f64,
    exponent: f64,
}

impl Source {
    /// Creates light that goes everywhere from the origin.
    const fn new(effect: &'static LightRow) -> Self {
        Self {
            effect,
            position: DVec3::ZERO,
            // The sky shines downwards.
            direction: DVec3::NEG_Y,
            cos_half_aperture: -1.0,
            exponent: 0.0,
        }
    }
}

/// Returns the source of a light at the view's time. `None` for a spot without an existing owner.
fn source(scene: &Scene, view: &View, kind: &LightKind) -> Option<Source> {
    let LightOrigin { position, direction } = scene.light_origin(view, kind)?;
    let everywhere = Source::new(lights::row_of(kind));
    Some(Source {
        position: position.unwrap_or(everywhere.position),
        direction: direction.unwrap_or(everywhere.direction),
        cos_half_aperture: (HALF_APERTURE.get)(kind)
            .map_or(everywhere.cos_half_aperture, |degrees| libm::cos(degrees.to_radians())),
        exponent: (CONCENTRATION.get)(kind).unwrap_or(everywhere.exponent),
        ..everywhere
    })
}

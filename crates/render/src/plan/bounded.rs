//! Leaves out light that adds less than half a step of a byte.
//!
//! Two budgets add up to less than half a step of a byte, so the bytes of a pixel differ by one
//! step at most. One budget is for whole lights, the faintest first, on an object or in a tile. The
//! other is for the tails of highlights: powers below a common value count as 0.

use crate::frame::draw::Stage;
use crate::lights::region::Region;
use crate::lights::{Form, PhongMaterial, ViewLight};

/// Steps of a byte in a factor of 1.
const STEPS: f64 = 255.0;

/// The budget of lights that are left out, in steps of a byte.
pub(super) const LIGHTS: f64 = 0.249;

/// The budget of the tails of highlights, in steps of a byte.
const HIGHLIGHTS: f64 = 0.249;

/// A bound of how far rounding can raise light above its equation.
const ROUNDING: f64 = 1.0 + 1e-4;

/// The most that a light adds to a channel, in steps of a byte.
pub(super) fn most(
    stage: &Stage,
    light: &ViewLight,
    material: &PhongMaterial,
    region: Option<&Region>,
) -> f64 {
    let highlight = stage.highlight != Form::Plain;
    STEPS * ROUNDING * (stage.effect.max_contribution)(light, material, highlight, region)
}

/// Removes the faintest lights as long as their sum stays below `budget` steps of a byte. Returns
/// the sum, and calls `tell` with each light that is removed and its bound.
pub(super) fn thin<T>(
    lights: &mut Vec<T>,
    most: impl Fn(&T) -> f64,
    budget: f64,
    mut tell: impl FnMut(&T, f64),
) -> f64 {
    let mut sum = 0.0;
    loop {
        let bounds = lights.iter().map(&most).enumerate();
        match bounds.min_by(|a, b| a.1.total_cmp(&b.1)) {
            Some((at, bound)) if sum + bound < budget => {
                sum += bound;
                tell(&lights.remove(at), bound);
            }
            _ => return sum,
        }
    }
}

/// The value below which the powers of highlights may count as 0: p such that, with I Ks and the
/// attenuation of each light,
///
///   255 p (sum of I Ks att spot) = the budget
///
/// `None` if there is no highlight; 1 or more if all of them may be left out.
pub(super) fn least_power(
    stages: &[Stage],
    (lights, material): (&[ViewLight], &PhongMaterial),
    region: Option<&Region>,
) -> Option<f64> {
    let lit = stages.iter().filter(|stage| stage.highlight != Form::Plain);
    let strengths =
        lit.map(|stage| strength(stage, &lights[stage.light as usize], material, region));
    let sum = strengths.reduce(|sum, strength| sum + strength)?;
    Some(HIGHLIGHTS / (STEPS * ROUNDING * sum))
}

/// A bound of what highlights lose if powers below `power` count as 0, in steps of a byte.
pub(super) fn cut_off(
    stages: &[Stage],
    lit: (&[ViewLight], &PhongMaterial),
    region: Option<&Region>,
    power: f64,
) -> f64 {
    least_power(stages, lit, region).map_or(0.0, |whole| HIGHLIGHTS * power / whole)
}

/// The largest brightness of a highlight's centre, as a factor.
fn strength(
    stage: &Stage,
    light: &ViewLight,
    material: &PhongMaterial,
    region: Option<&Region>,
) -> f64 {
    let channels = light.color.iter().zip(material.specular).map(|(color, ks)| color * ks);
    channels.fold(0.0, f64::max) * (stage.effect.max_falloff)(light, region)
}

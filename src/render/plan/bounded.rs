//! What may be left out although it would be seen: light that adds too little to matter.
//!
//! Two budgets, together less than half a step of a byte: whatever is left out of a pixel, before
//! rounding its channels are off by less than that, and its bytes by one step at most. One budget is
//! for whole lights, smallest first, on an object or on what a tile shows of it; the other is for the
//! foot of highlights, whose powers count as 0 below a common value.

use crate::render::frame::draw::Form;
use crate::render::frame::draw::Stage;
use crate::render::lights::region::Region;
use crate::render::lights::{PhongMaterial, ViewLight};

/// Steps of a byte in a factor of 1.
const STEPS: f64 = 255.0;

/// What lights that are left out may add up to, in steps of a byte.
pub(super) const LIGHTS: f64 = 0.249;

/// What cut off highlights may add up to, in steps of a byte.
const HIGHLIGHTS: f64 = 0.249;

/// Rounding can bring light above what its equation says; by much less than this.
const ROUNDING: f64 = 1.0 + 1e-4;

/// What a light adds to a channel at most, in steps of a byte.
pub(super) fn most(
    stage: &Stage,
    lamp: &ViewLight,
    matter: &PhongMaterial,
    region: Option<&Region>,
) -> f64 {
    let highlight = stage.highlight != Form::Plain;
    STEPS * ROUNDING * (stage.effect.max_contribution)(lamp, matter, highlight, region)
}

/// Takes out of some lights what adds least, as long as all of it stays below `budget` steps of a byte.
/// Gives what it adds together; each light that goes is told of with what it adds.
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

/// The value below which all powers of highlights may count as 0: with I Ks of each light and the part
/// of it that arrives, p such that
///
///   255 p (sum of I Ks att spot) = the budget
///
/// `None` where there is no highlight; 1 or more where all of them may go.
pub(super) fn least_power(
    stages: &[Stage],
    (lamps, matter): (&[ViewLight], &PhongMaterial),
    region: Option<&Region>,
) -> Option<f64> {
    let lit = stages.iter().filter(|stage| stage.highlight != Form::Plain);
    let strengths = lit.map(|stage| strength(stage, &lamps[stage.lamp as usize], matter, region));
    let sum = strengths.reduce(|sum, strength| sum + strength)?;
    Some(HIGHLIGHTS / (STEPS * ROUNDING * sum))
}

/// What is cut off of the highlights where powers below `power` count as 0, in steps of a byte.
pub(super) fn cut_off(
    stages: &[Stage],
    lit: (&[ViewLight], &PhongMaterial),
    region: Option<&Region>,
    power: f64,
) -> f64 {
    least_power(stages, lit, region).map_or(0.0, |whole| HIGHLIGHTS * power / whole)
}

/// The brightest that the middle of a highlight may be, as a factor.
fn strength(
    stage: &Stage,
    lamp: &ViewLight,
    matter: &PhongMaterial,
    region: Option<&Region>,
) -> f64 {
    let channels = lamp.color.iter().zip(matter.specular).map(|(color, ks)| color * ks);
    channels.fold(0.0, f64::max) * (stage.effect.max_falloff)(lamp, region)
}

//! Point lights.

use super::Which;
use super::batch::{Reflected, Sample, set};
use super::phong::{LightTerm, phong};
use super::shader::LightShader;
use crate::simd::{Lanes, Real as _, Vec3};

/// A point that shines equally in all directions and fades with distance.
pub(crate) struct Bulb;

impl LightShader for Bulb {
    const NAME: &'static str = "Bulb";
    const WHICH: Which = Which::Bulb;

    #[inline(always)]
    fn shade<M: Lanes>(
        lanes: M,
        sample: Sample<M::R>,
        term: &LightTerm<M::Number>,
    ) -> Option<Reflected<M::R>> {
        let (to_light, strength) = arriving(lanes, sample.position, term);
        phong(lanes, sample, to_light, Some(strength), term)
    }
}

/// Computes the direction to a light, and its attenuation at the distance d:
///
///   att(d) = 1 / (a0 + a1 d + a2 d^2);   0 at d = 0, where a light adds nothing
#[inline(always)]
pub(crate) fn arriving<M: Lanes>(
    lanes: M,
    position: Vec3<M::R>,
    term: &LightTerm<M::Number>,
) -> (Vec3<M::R>, M::R) {
    let to_light = set(lanes, term.position).minus(position);
    let square = to_light.dot(to_light);
    // 1 / d, or 0 at the light itself and if the square overflows.
    let per_d = square.reciprocal_root();
    let (zero, one) = (lanes.lift(0.0), lanes.lift(1.0));
    // The division is skipped for lights that do not fade.
    let mut left = one;
    if term.fades {
        let d = square * per_d;
        let Vec3([a0, a1, a2]) = set(lanes, term.attenuation);
        left = one / (a0 + (a1 + a2 * d) * d);
    }
    (to_light.times(per_d), per_d.if_more(zero, left, zero))
}

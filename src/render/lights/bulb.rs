//! Light from a point, in all directions.

use super::batch::{Reflected, Sample, set};
use super::phong::{
    Highlight, LightTerm, PhongMaterial, ViewLight, lamp_is_noop, max_attenuation, phong,
};
use super::region::Region;
use super::shader::LightShader;
use super::turning::Turning;
use crate::render::simd::{Lanes, Real as _, Vec3};

/// A point that shines alike in all directions and fades with distance.
pub(crate) struct Bulb;

impl LightShader for Bulb {
    const NAME: &'static str = "Bulb";

    fn is_noop(lamp: &ViewLight, matter: &PhongMaterial) -> Option<&'static str> {
        lamp_is_noop(lamp, matter)
    }

    fn is_behind(lamp: &ViewLight, region: &Region, turning: &Turning) -> bool {
        turning.all(|normal| region.faces_away(normal, lamp.position.into()))
    }

    fn max_falloff(lamp: &ViewLight, region: Option<&Region>) -> f64 {
        max_attenuation(lamp, region)
    }

    #[inline(always)]
    fn shade<M: Lanes, H: Highlight>(
        lanes: M,
        sample: Sample<M::R>,
        shine: &LightTerm<M::Number>,
    ) -> Option<Reflected<M::R>> {
        let (to_light, strength) = arriving(lanes, sample.position, shine);
        phong::<M, H>(lanes, sample, to_light, Some(strength), shine)
    }
}

/// The direction to a lamp, and the part of its light that is left at the distance d:
///
///   att(d) = 1 / (a0 + a1 d + a2 d^2);   0 at d = 0, where a lamp adds nothing
#[inline(always)]
pub(crate) fn arriving<M: Lanes>(
    lanes: M,
    position: Vec3<M::R>,
    shine: &LightTerm<M::Number>,
) -> (Vec3<M::R>, M::R) {
    let way = set(lanes, shine.position).minus(position);
    let square = way.dot(way);
    let per_d = square.reciprocal_root();
    let (zero, one) = (lanes.lift(0.0), lanes.lift(1.0));
    let mut left = one;
    if shine.fades {
        let d = square * per_d;
        let Vec3([a0, a1, a2]) = set(lanes, shine.attenuation);
        left = one / (a0 + (a1 + a2 * d) * d);
    }
    (way.times(per_d), per_d.if_more(zero, left, zero))
}

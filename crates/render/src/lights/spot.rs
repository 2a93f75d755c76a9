//! Spot lights.

use super::Which;
use super::batch::{Reflected, Sample, set};
use super::bulb::arriving;
use super::phong::{LightTerm, ViewLight, max_attenuation, phong};
use super::region::Region;
use super::shader::LightShader;
use crate::simd::{Lanes, Real};

/// A point that shines in a cone around an axis.
pub(crate) struct Spot;

impl LightShader for Spot {
    const NAME: &'static str = "Spot";
    const WHICH: Which = Which::Spot;
    const HAS_REACH: bool = true;

    fn is_culled(light: &ViewLight, region: &Region) -> Option<&'static str> {
        let (apex, axis) = (light.position.into(), light.direction.into());
        if light.cos_half_aperture >= 1.0 {
            // A cosine never exceeds 1.
            Some("its cone is closed")
        } else if region.misses_cone(apex, axis, light.cos_half_aperture) {
            Some("nothing is within its cone")
        } else {
            None
        }
    }

    fn max_falloff(light: &ViewLight, region: Option<&Region>) -> f64 {
        let (apex, axis) = (light.position.into(), light.direction.into());
        let cosine = region.map_or(1.0, |region| region.most_cosine(apex, axis));
        // A negative base with a fractional exponent would give NaN.
        max_attenuation(light, region) * libm::pow(cosine.max(0.0), light.exponent)
    }

    fn fraction_at(light: &ViewLight, cosine: f64) -> f64 {
        let inside = cosine > light.cos_half_aperture;
        if inside { libm::pow(cosine, light.exponent) } else { 0.0 }
    }

    /// With c = min(1, F.(-L)), F the axis: the fraction c^n of the light arrives if c exceeds the
    /// cosine of the half-aperture; if not, nothing arrives. Warn, "Lighting Controls for Synthetic
    /// Images", SIGGRAPH 1983.
    #[inline(always)]
    fn shade<M: Lanes>(
        lanes: M,
        sample: Sample<M::R>,
        term: &LightTerm<M::Number>,
    ) -> Option<Reflected<M::R>> {
        let (to_light, strength) = arriving(lanes, sample.position, term);
        // Rounding can bring the cosine above 1, where powers are not defined.
        let c = Real::min(set(lanes, term.axis).dot(to_light), lanes.lift(1.0));
        let border = lanes.set(term.cos_half_aperture);
        // The power is only computed if a position is inside the cone.
        if !lanes.any_more(c, border) {
            return None;
        }
        let gathered = c.power(&term.gathered);
        // Positions outside the cone may share a vector with others inside.
        let strength = c.if_more(border, strength * gathered, lanes.lift(0.0));
        phong(lanes, sample, to_light, Some(strength), term)
    }
}

//! Light from a point, in a cone.

use super::bulb::arriving;
use super::{
    Effect, Highlight, Lamp, Matter, Reflected, Sample, Shine, lamp_needless, most_left, phong, set,
};
use crate::render::plan::Turning;
use crate::render::numbers::real::{Machine, Real};
use crate::render::region::Region;

/// A point that shines along an axis.
pub(super) struct Spot;

impl Effect for Spot {
    const NAME: &'static str = "Spot";
    const HAS_REACH: bool = true;

    fn needless(lamp: &Lamp, matter: &Matter) -> Option<&'static str> {
        lamp_needless(lamp, matter)
    }

    fn misses(lamp: &Lamp, region: &Region) -> Option<&'static str> {
        let (apex, axis) = (lamp.position.into(), lamp.direction.into());
        if lamp.cos_half_aperture >= 1.0 {
            // No cosine is more than 1.
            Some("its cone is closed")
        } else if region.misses_cone(apex, axis, lamp.cos_half_aperture) {
            Some("nothing is within its cone")
        } else {
            None
        }
    }

    fn is_behind(lamp: &Lamp, region: &Region, turning: &Turning) -> bool {
        turning.all(|normal| region.faces_away(normal, lamp.position.into()))
    }

    fn arrives(lamp: &Lamp, region: Option<&Region>) -> f64 {
        let (apex, axis) = (lamp.position.into(), lamp.direction.into());
        let cosine = region.map_or(1.0, |region| region.most_cosine(apex, axis));
        most_left(lamp, region) * libm::pow(cosine.max(0.0), lamp.exponent)
    }

    /// With c = min(1, F.(-L)), F the axis: c^n of the light arrives where c is more than the cosine
    /// of the half-aperture, and none outside. Warn, "Lighting Controls for Synthetic Images",
    /// SIGGRAPH 1983.
    #[inline(always)]
    fn shade<M: Machine, H: Highlight>(
        machine: M,
        sample: Sample<M::R>,
        shine: &Shine<M::Number>,
    ) -> Option<Reflected<M::R>> {
        let (to_light, strength) = arriving(machine, sample.position, shine);
        let c = Real::min(set(machine, shine.axis).dot(to_light), machine.lift(1.0));
        let border = machine.set(shine.cos_half_aperture);
        if !machine.any_more(c, border) {
            return None;
        }
        let gathered = c.power(&shine.gathered);
        let strength = c.if_more(border, strength * gathered, machine.lift(0.0));
        phong::<M, H>(machine, sample, to_light, Some(strength), shine)
    }
}

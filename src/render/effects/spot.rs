//! Light from a point, in a cone.

use super::bulb::arriving;
use super::{Effect, Highlight, Lamp, Matter, Reflected, Sample, lamp_needless, phong};
use crate::render::real::{Real, Triple};

/// A point that shines along an axis.
pub(super) struct Spot;

impl Effect for Spot {
    const NAME: &'static str = "Spot";

    fn needless(lamp: &Lamp, matter: &Matter) -> Option<&'static str> {
        lamp_needless(lamp, matter)
    }

    /// With c = min(1, F.(-L)), F the axis: c^n of the light arrives where c is more than the cosine
    /// of the half-aperture, and none outside. Warn, "Lighting Controls for Synthetic Images",
    /// SIGGRAPH 1983.
    #[inline(always)]
    fn shade<R: Real, H: Highlight>(
        sample: Sample<R>,
        lamp: &Lamp,
        matter: &Matter,
    ) -> Reflected<R> {
        let (to_light, strength) = arriving(sample.position, lamp);
        let [x, y, z] = lamp.direction;
        let axis = Triple::lift(strength, [-x, -y, -z]);
        let c = Real::min(axis.dot(to_light), strength.lift(1.0));
        let gathered = c.power(lamp.exponent, matter.floor);
        let border = strength.lift(lamp.cos_half_aperture);
        let strength = c.if_more(border, strength * gathered, strength.lift(0.0));
        phong::<R, H>(sample, to_light, strength, lamp, matter)
    }
}

//! Light from a point, in all directions.

use super::{
    Effect, Highlight, Lamp, Matter, Reflected, Sample, lamp_needless, most_left, phong,
};
use crate::render::plan::Facing;
use crate::render::real::{Machine, Real, Triple};
use crate::render::region::Region;

/// A point that shines alike in all directions and fades with distance.
pub(super) struct Bulb;

impl Effect for Bulb {
    const NAME: &'static str = "Bulb";

    fn needless(lamp: &Lamp, matter: &Matter) -> Option<&'static str> {
        lamp_needless(lamp, matter)
    }

    fn is_behind(lamp: &Lamp, region: &Region, facing: &Facing) -> bool {
        facing.all(|normal| region.faces_away(normal, lamp.position.into()))
    }

    fn arrives(lamp: &Lamp, region: Option<&Region>) -> f64 {
        most_left(lamp, region)
    }

    #[inline(always)]
    fn shade<M: Machine, H: Highlight>(
        machine: M,
        sample: Sample<M::R>,
        lamp: &Lamp,
        matter: &Matter,
    ) -> Option<Reflected<M::R>> {
        let (to_light, strength) = arriving(sample.position, lamp);
        phong::<M, H>(machine, sample, to_light, strength, lamp, matter)
    }
}

/// The direction to a lamp, and the part of its light that is left at the distance d:
///
///   att(d) = 1 / (a0 + a1 d + a2 d^2);   0 at d = 0, where a lamp adds nothing
#[inline(always)]
pub(super) fn arriving<R: Real>(position: Triple<R>, lamp: &Lamp) -> (Triple<R>, R) {
    let way = Triple::lift(position.0[0], lamp.position).minus(position);
    let square = way.dot(way);
    let (zero, one) = (square.lift(0.0), square.lift(1.0));
    let d = square.if_more(zero, square, one).sqrt();
    let [a0, a1, a2] = lamp.attenuation;
    let faded = one / (square.lift(a0) + (square.lift(a1) + square.lift(a2) * d) * d);
    (way.times(one / d), square.if_more(zero, faded, zero))
}

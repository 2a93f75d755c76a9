//! Light from a point, in all directions.

use super::{
    Effect, Highlight, Lamp, Matter, Reflected, Sample, Shine, lamp_needless, most_left, phong, set,
};
use crate::render::plan::Turning;
use crate::render::numbers::real::{Machine, Real as _, Triple};
use crate::render::region::Region;

/// A point that shines alike in all directions and fades with distance.
pub(super) struct Bulb;

impl Effect for Bulb {
    const NAME: &'static str = "Bulb";

    fn needless(lamp: &Lamp, matter: &Matter) -> Option<&'static str> {
        lamp_needless(lamp, matter)
    }

    fn is_behind(lamp: &Lamp, region: &Region, turning: &Turning) -> bool {
        turning.all(|normal| region.faces_away(normal, lamp.position.into()))
    }

    fn arrives(lamp: &Lamp, region: Option<&Region>) -> f64 {
        most_left(lamp, region)
    }

    #[inline(always)]
    fn shade<M: Machine, H: Highlight>(
        machine: M,
        sample: Sample<M::R>,
        shine: &Shine<M::Number>,
    ) -> Option<Reflected<M::R>> {
        let (to_light, strength) = arriving(machine, sample.position, shine);
        phong::<M, H>(machine, sample, to_light, Some(strength), shine)
    }
}

/// The direction to a lamp, and the part of its light that is left at the distance d:
///
///   att(d) = 1 / (a0 + a1 d + a2 d^2);   0 at d = 0, where a lamp adds nothing
#[inline(always)]
pub(super) fn arriving<M: Machine>(
    machine: M,
    position: Triple<M::R>,
    shine: &Shine<M::Number>,
) -> (Triple<M::R>, M::R) {
    let way = set(machine, shine.position).minus(position);
    let square = way.dot(way);
    let per_d = square.reciprocal_root();
    let (zero, one) = (machine.lift(0.0), machine.lift(1.0));
    let mut left = one;
    if shine.fades {
        let d = square * per_d;
        let Triple([a0, a1, a2]) = set(machine, shine.attenuation);
        left = one / (a0 + (a1 + a2 * d) * d);
    }
    (way.times(per_d), per_d.if_more(zero, left, zero))
}

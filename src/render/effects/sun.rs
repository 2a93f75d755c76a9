//! Light from infinitely far away.

use glam::DVec3;

use super::{Effect, Highlight, Lamp, Matter, Reflected, Sample, lamp_needless, phong};
use crate::render::plan::Facing;
use crate::render::real::{Machine, Triple};
use crate::render::region::{EDGE_ON, Region};

/// The same direction at every place, and no fading.
pub(super) struct Sun;

impl Effect for Sun {
    const NAME: &'static str = "Sun";

    fn needless(lamp: &Lamp, matter: &Matter) -> Option<&'static str> {
        lamp_needless(lamp, matter)
    }

    fn is_behind(lamp: &Lamp, _: &Region, facing: &Facing) -> bool {
        let way = DVec3::from_array(lamp.direction);
        facing.all(|normal| normal.dot(way) > EDGE_ON)
    }

    #[inline(always)]
    fn shade<M: Machine, H: Highlight>(
        machine: M,
        sample: Sample<M::R>,
        lamp: &Lamp,
        matter: &Matter,
    ) -> Option<Reflected<M::R>> {
        let one = machine.lift(1.0);
        let [x, y, z] = lamp.direction;
        let to_light = Triple::lift(one, [-x, -y, -z]);
        phong::<M, H>(machine, sample, to_light, one, lamp, matter)
    }
}

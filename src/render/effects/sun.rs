//! Light from infinitely far away.

use glam::DVec3;

use super::{Effect, Highlight, Lamp, Matter, Reflected, Sample, Shine, lamp_needless, phong, set};
use crate::render::plan::Turning;
use crate::render::numbers::real::Machine;
use crate::render::region::{EDGE_ON, Region};

/// The same direction at every place, and no fading.
pub(super) struct Sun;

impl Effect for Sun {
    const NAME: &'static str = "Sun";

    fn needless(lamp: &Lamp, matter: &Matter) -> Option<&'static str> {
        lamp_needless(lamp, matter)
    }

    fn is_behind(lamp: &Lamp, _: &Region, turning: &Turning) -> bool {
        let way = DVec3::from_array(lamp.direction);
        turning.all(|normal| normal.dot(way) > EDGE_ON)
    }

    #[inline(always)]
    fn shade<M: Machine, H: Highlight>(
        machine: M,
        sample: Sample<M::R>,
        shine: &Shine<M::Number>,
    ) -> Option<Reflected<M::R>> {
        phong::<M, H>(machine, sample, set(machine, shine.axis), None, shine)
    }
}

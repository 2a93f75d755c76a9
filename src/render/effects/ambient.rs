//! Light from everywhere.

use super::{
    Effect, Highlight, Lamp, Matter, Reflected, Sample, Shine, most_of_channels, set,
};
use crate::render::numbers::real::Machine;
use crate::render::region::Region;

/// The same light at every place, whichever way it faces: Ia Ka.
pub(super) struct Ambient;

impl Effect for Ambient {
    const NAME: &'static str = "Ambient light";
    const READS_PLACES: bool = false;

    fn needless(lamp: &Lamp, matter: &Matter) -> Option<&'static str> {
        if lamp.color == [0.0; 3] {
            Some("its colour is black")
        } else if matter.ambient == [0.0; 3] {
            Some("Ka of the material is 0")
        } else {
            None
        }
    }

    fn most(lamp: &Lamp, matter: &Matter, _: bool, _: Option<&Region>) -> f64 {
        most_of_channels(lamp.color, matter.ambient)
    }

    #[inline(always)]
    fn shade<M: Machine, H: Highlight>(
        machine: M,
        _: Sample<M::R>,
        shine: &Shine<M::Number>,
    ) -> Option<Reflected<M::R>> {
        Some(Reflected { diffuse: set(machine, shine.ambient), specular: None })
    }
}

//! Light from everywhere.

use super::{Effect, Highlight, Lamp, Matter, Reflected, Sample, most_of_channels};
use crate::render::real::{Machine, Triple};
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
        lamp: &Lamp,
        matter: &Matter,
    ) -> Option<Reflected<M::R>> {
        let ([r, g, b], [x, y, z]) = (lamp.color, matter.ambient);
        let diffuse = Triple::lift(machine.lift(0.0), [r * x, g * y, b * z]);
        Some(Reflected { diffuse, specular: None })
    }
}

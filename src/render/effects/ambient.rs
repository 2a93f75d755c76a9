//! Light from everywhere.

use super::{Effect, Highlight, Lamp, Matter, Reflected, Sample};
use crate::render::real::{Real, Triple};

/// The same light at every place, whichever way it faces: Ia Ka.
pub(super) struct Ambient;

impl Effect for Ambient {
    const NAME: &'static str = "Ambient light";

    fn needless(lamp: &Lamp, matter: &Matter) -> Option<&'static str> {
        if lamp.color == [0.0; 3] {
            Some("its colour is black")
        } else if matter.ambient == [0.0; 3] {
            Some("Ka of the material is 0")
        } else {
            None
        }
    }

    #[inline(always)]
    fn shade<R: Real, H: Highlight>(
        sample: Sample<R>,
        lamp: &Lamp,
        matter: &Matter,
    ) -> Reflected<R> {
        let like = sample.position.0[0];
        let ([r, g, b], [x, y, z]) = (lamp.color, matter.ambient);
        let diffuse = Triple::lift(like, [r * x, g * y, b * z]);
        Reflected { diffuse, specular: Triple::lift(like, [0.0; 3]) }
    }
}

//! Light from infinitely far away.

use super::{Effect, Highlight, Lamp, Matter, Reflected, Sample, lamp_needless, phong};
use crate::render::real::{Real, Triple};

/// The same direction at every place, and no fading.
pub(super) struct Sun;

impl Effect for Sun {
    const NAME: &'static str = "Sun";

    fn needless(lamp: &Lamp, matter: &Matter) -> Option<&'static str> {
        lamp_needless(lamp, matter)
    }

    #[inline(always)]
    fn shade<R: Real, H: Highlight>(
        sample: Sample<R>,
        lamp: &Lamp,
        matter: &Matter,
    ) -> Reflected<R> {
        let like = sample.position.0[0];
        let [x, y, z] = lamp.direction;
        let to_light = Triple::lift(like, [-x, -y, -z]);
        phong::<R, H>(sample, to_light, like.lift(1.0), lamp, matter)
    }
}

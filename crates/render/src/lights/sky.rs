//! Light of the sky: one colour from above the horizon and another from below it.

use super::Which;
use super::batch::{Reflected, Sample, set};
use super::phong::{LightTerm, PhongMaterial, ViewLight};
use super::shader::LightShader;
use crate::simd::Lanes;

/// Light from the two halves of a sphere around everything. A surface whose normal leans from the
/// vertical by the angle a sees the fraction (1 + cos a) / 2 of the upper half, weighted by the
/// cosine of incidence: its diffuse light is Kd times the mean of both colours by these fractions.
///
/// Moon and Spencer, "Illumination from a Non-Uniform Sky", 1942, for a uniform sky.
pub(crate) struct Sky;

impl LightShader for Sky {
    const NAME: &'static str = "Sky";
    const WHICH: Which = Which::Sky;
    const HAS_POSITION: bool = false;

    fn is_noop(light: &ViewLight, material: &PhongMaterial) -> Option<&'static str> {
        if light.color == [0.0; 3] && light.ground == [0.0; 3] {
            Some("its colours are black")
        } else if material.diffuse == [0.0; 3] {
            Some("Kd of the material is 0")
        } else {
            None
        }
    }

    #[inline(always)]
    fn shade<M: Lanes>(
        lanes: M,
        sample: Sample<M::R>,
        term: &LightTerm<M::Number>,
    ) -> Option<Reflected<M::R>> {
        let up = sample.normal.dot(set(lanes, term.axis));
        let half = lanes.lift(0.5);
        let share = half + up * half;
        let (above, below) = (set(lanes, term.diffuse), set(lanes, term.ground));
        let diffuse = below.plus(above.minus(below).times(share));
        Some(Reflected { diffuse, specular: None })
    }
}

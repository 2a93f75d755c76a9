//! Ambient light.

use super::Which;
use super::batch::{Reflected, Sample, set};
use super::phong::{LightTerm, PhongMaterial, ViewLight};
use super::shader::LightShader;
use crate::simd::Lanes;

/// Light that is equal at every position and for every normal: Ia Ka.
pub(crate) struct Ambient;

impl LightShader for Ambient {
    const NAME: &'static str = "Ambient light";
    const WHICH: Which = Which::Ambient;
    const READS_POSITIONS: bool = false;
    const HAS_POSITION: bool = false;

    fn is_noop(light: &ViewLight, material: &PhongMaterial) -> Option<&'static str> {
        if light.color == [0.0; 3] {
            Some("its colour is black")
        } else if material.ambient == [0.0; 3] {
            Some("Ka of the material is 0")
        } else {
            None
        }
    }

    #[inline(always)]
    fn shade<M: Lanes>(
        lanes: M,
        _: Sample<M::R>,
        term: &LightTerm<M::Number>,
    ) -> Option<Reflected<M::R>> {
        Some(Reflected { diffuse: set(lanes, term.ambient), specular: None })
    }
}

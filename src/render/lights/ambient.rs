//! Light from everywhere.

use super::batch::{Reflected, Sample, set};
use super::phong::{Highlight, LightTerm, PhongMaterial, ViewLight, max_channel};
use super::region::Region;
use super::shader::LightShader;
use crate::render::simd::Lanes;

/// The same light at every place, whichever way it faces: Ia Ka.
pub(crate) struct Ambient;

impl LightShader for Ambient {
    const NAME: &'static str = "Ambient light";
    const READS_POSITIONS: bool = false;

    fn is_noop(lamp: &ViewLight, matter: &PhongMaterial) -> Option<&'static str> {
        if lamp.color == [0.0; 3] {
            Some("its colour is black")
        } else if matter.ambient == [0.0; 3] {
            Some("Ka of the material is 0")
        } else {
            None
        }
    }

    fn max_contribution(
        lamp: &ViewLight,
        matter: &PhongMaterial,
        _: bool,
        _: Option<&Region>,
    ) -> f64 {
        max_channel(lamp.color, matter.ambient)
    }

    #[inline(always)]
    fn shade<M: Lanes, H: Highlight>(
        lanes: M,
        _: Sample<M::R>,
        shine: &LightTerm<M::Number>,
    ) -> Option<Reflected<M::R>> {
        Some(Reflected { diffuse: set(lanes, shine.ambient), specular: None })
    }
}

//! Directional lights.

use glam::DVec3;

use super::Which;
use super::batch::{Reflected, Sample, set};
use super::phong::{LightTerm, ViewLight, phong};
use super::region::{EDGE_ON, Region};
use super::shader::LightShader;
use crate::simd::Lanes;

/// A light with the same direction at every position and no attenuation.
pub(crate) struct Sun;

impl LightShader for Sun {
    const NAME: &'static str = "Sun";
    const WHICH: Which = Which::Sun;
    const HAS_POSITION: bool = false;

    fn is_behind(light: &ViewLight, _: &Region, normals: &[DVec3]) -> bool {
        let direction = DVec3::from_array(light.direction);
        // `direction` is the light's travel, so light from behind has a positive cosine.
        normals.iter().all(|normal| normal.dot(direction) > EDGE_ON)
    }

    #[inline(always)]
    fn shade<M: Lanes>(
        lanes: M,
        sample: Sample<M::R>,
        term: &LightTerm<M::Number>,
    ) -> Option<Reflected<M::R>> {
        phong(lanes, sample, set(lanes, term.axis), None, term)
    }
}

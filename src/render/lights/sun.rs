//! Light from infinitely far away.

use glam::DVec3;

use super::batch::{Reflected, Sample, set};
use super::phong::{Highlight, LightTerm, PhongMaterial, ViewLight, lamp_is_noop, phong};
use super::region::{EDGE_ON, Region};
use super::shader::LightShader;
use super::turning::Turning;
use crate::render::simd::Lanes;

/// The same direction at every place, and no fading.
pub(crate) struct Sun;

impl LightShader for Sun {
    const NAME: &'static str = "Sun";

    fn is_noop(lamp: &ViewLight, matter: &PhongMaterial) -> Option<&'static str> {
        lamp_is_noop(lamp, matter)
    }

    fn is_behind(lamp: &ViewLight, _: &Region, turning: &Turning) -> bool {
        let way = DVec3::from_array(lamp.direction);
        turning.all(|normal| normal.dot(way) > EDGE_ON)
    }

    #[inline(always)]
    fn shade<M: Lanes, H: Highlight>(
        lanes: M,
        sample: Sample<M::R>,
        shine: &LightTerm<M::Number>,
    ) -> Option<Reflected<M::R>> {
        phong::<M, H>(lanes, sample, set(lanes, shine.axis), None, shine)
    }
}

//! The shader trait of a kind of light, and its row in the table.

use glam::DVec3;

use super::Which;
use super::batch::{Reflected, Sample};
use super::phong::{LightTerm, PhongMaterial, ViewLight, max_attenuation};
use super::region::Region;
use crate::simd::Lanes;

/// The shader of a kind of light.
pub(crate) trait LightShader {
    /// The name in the plan.
    const NAME: &'static str;
    /// The shader as an enum.
    const WHICH: Which;
    /// Whether the shader reads positions, normals or directions to the observer.
    const READS_POSITIONS: bool = true;
    /// Whether the light has a position, and fades with the distance from it.
    const HAS_POSITION: bool = true;
    /// Whether the light's reach is limited; only then can `is_culled` cull it.
    const HAS_REACH: bool = false;
    /// Returns why the light adds nothing to a material, if so. Leaving it out then changes no bit.
    fn is_noop(light: &ViewLight, material: &PhongMaterial) -> Option<&'static str> {
        let zero = |color: [f64; 3]| color == [0.0; 3];
        if zero(light.color) {
            Some("its colour is black")
        } else if zero(material.diffuse) && zero(material.specular) {
            Some("Kd and Ks of the material are 0")
        } else {
            None
        }
    }
    /// Returns why no light arrives in a region, if so. Leaving it out there then changes no bit.
    fn is_culled(_: &ViewLight, _: &Region) -> Option<&'static str> {
        None
    }
    /// Returns whether the light comes from behind all faces of a region, given their normals (of
    /// length 1). Leaving it out there then changes no bit.
    fn is_behind(light: &ViewLight, region: &Region, normals: &[DVec3]) -> bool {
        let from = light.position.into();
        Self::HAS_POSITION && normals.iter().all(|normal| region.faces_away(*normal, from))
    }
    /// Returns the largest fraction of the light that arrives in a region, or anywhere without one.
    fn max_falloff(light: &ViewLight, region: Option<&Region>) -> f64 {
        if Self::HAS_POSITION { max_attenuation(light, region) } else { 1.0 }
    }
    /// Returns the fraction of the light in a direction, by the cosine between the direction and
    /// the axis, for explanations.
    fn fraction_at(_: &ViewLight, _cosine: f64) -> f64 {
        1.0
    }
    /// Shades some positions; `None` if it adds nothing at any of them.
    fn shade<M: Lanes>(
        lanes: M,
        sample: Sample<M::R>,
        term: &LightTerm<M::Number>,
    ) -> Option<Reflected<M::R>>;
}

/// A row of the table of light kinds: the constants and functions of its [`LightShader`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct LightRow {
    pub(crate) name: &'static str,
    pub(crate) which: Which,
    pub(crate) reads_positions: bool,
    pub(crate) has_position: bool,
    pub(crate) has_reach: bool,
    pub(crate) is_noop: fn(&ViewLight, &PhongMaterial) -> Option<&'static str>,
    pub(crate) is_culled: fn(&ViewLight, &Region) -> Option<&'static str>,
    pub(crate) is_behind: fn(&ViewLight, &Region, &[DVec3]) -> bool,
    pub(crate) max_falloff: fn(&ViewLight, Option<&Region>) -> f64,
    pub(crate) fraction_at: fn(&ViewLight, f64) -> f64,
}

impl LightRow {
    /// Creates the row of a shader.
    pub(super) const fn of<E: LightShader>() -> Self {
        Self {
            name: E::NAME,
            which: E::WHICH,
            reads_positions: E::READS_POSITIONS,
            has_position: E::HAS_POSITION,
            has_reach: E::HAS_REACH,
            is_noop: E::is_noop,
            is_culled: E::is_culled,
            is_behind: E::is_behind,
            max_falloff: E::max_falloff,
            fraction_at: E::fraction_at,
        }
    }
}

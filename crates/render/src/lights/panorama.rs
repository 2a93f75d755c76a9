//! Light of a sky with a panorama.

use super::Which;
use super::batch::{Reflected, Sample};
use super::phong::{LightTerm, PhongMaterial, ViewLight};
use super::shader::LightShader;
use crate::simd::{Lanes, Real as _, Vec3};

/// Light from a picture of everything around: a polynomial of the normal. See
/// `PlacedPanorama::irradiance`.
pub(crate) struct Panorama;

impl LightShader for Panorama {
    const NAME: &'static str = "Sky (panorama)";
    const WHICH: Which = Which::Panorama;
    const HAS_POSITION: bool = false;

    fn is_noop(light: &ViewLight, material: &PhongMaterial) -> Option<&'static str> {
        if light.color == [0.0; 3] {
            Some("its colour is black")
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
        let irradiance = term.irradiance.as_deref()?;
        let Vec3([x, y, z]) = sample.normal;
        let diffuse = irradiance.each_ref().map(|factors| {
            let [one, by_x, by_y, by_z, xx, yy, zz, xy, xz, yz] =
                factors.map(|factor| lanes.set(factor));
            let even = one + (xx * x) * x + (yy * y) * y + (zz * z) * z;
            let odd = by_x * x + by_y * y + by_z * z;
            let mixed = (xy * x) * y + (xz * x) * z + (yz * y) * z;
            // The polynomial may fall below 0 opposite a bright lamp.
            (even + odd + mixed).max(lanes.lift(0.0))
        });
        Some(Reflected { diffuse: Vec3(diffuse), specular: None })
    }
}

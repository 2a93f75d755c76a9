//! The shader trait of a kind of light, and its compiled variants.

use std::marker::PhantomData;

use fearless_simd::Level;
use glam::DVec3;

use super::batch::{Batch, Reflected, Sample, add, load};
use super::phong::{
    Form, HalfVector, Highlight, LightTerm, Mapped, Nothing, PhongMaterial, Reflection, ViewLight,
    max_attenuation,
};
use super::region::Region;
use crate::simd::{Kernel, Lanes, Number};

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
    fn shade<M: Lanes, H: Highlight>(
        lanes: M,
        sample: Sample<M::R>,
        term: &LightTerm<M::Number>,
    ) -> Option<Reflected<M::R>>;
}

/// The shader of a row of the table of light kinds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Which {
    /// Ambient light.
    Ambient,
    /// The sky.
    Sky,
    /// A sun.
    Sun,
    /// A bulb.
    Bulb,
    /// A spot.
    Spot,
}

/// A light shader compiled for one form of highlight: in f64 for the reference, and in f32 for the
/// editor.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Variant {
    reference: fn(Level, &mut Batch<f64>, &LightTerm<f64>),
    fast: fn(Level, &mut Batch<f32>, &LightTerm<f32>),
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
    /// Returns the variant with a form of highlight, and whether a map multiplies its exponent.
    pub(crate) variant: fn(Form, bool) -> Variant,
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
            variant: |form, is_mapped| match (form, is_mapped) {
                // Without a highlight, its exponent is not read.
                (Form::Plain, _) => variant::<E, Nothing>(),
                (Form::Reflection, false) => variant::<E, Reflection>(),
                (Form::HalfVector, false) => variant::<E, HalfVector>(),
                (Form::Reflection, true) => variant::<E, Mapped<Reflection>>(),
                (Form::HalfVector, true) => variant::<E, Mapped<HalfVector>>(),
            },
        }
    }
}

const fn variant<E: LightShader, H: Highlight>() -> Variant {
    Variant { reference: shade::<f64, E, H>, fast: shade::<f32, E, H> }
}

/// Adds the light of a shader at every position of a batch.
fn shade<T: Number, E: LightShader, H: Highlight>(
    level: Level,
    batch: &mut Batch<T>,
    term: &LightTerm<T>,
) {
    T::run(level, Shade::<T, E, H> { batch, term, of: PhantomData });
}

struct Shade<'a, T, E, H> {
    batch: &'a mut Batch<T>,
    term: &'a LightTerm<T>,
    of: PhantomData<(E, H)>,
}

impl<T: Number, E: LightShader, H: Highlight> Kernel<T> for Shade<'_, T, E, H> {
    #[inline(always)]
    fn run<M: Lanes<Number = T>>(self, lanes: M) {
        let batch = self.batch;
        for at in (0..batch.len).step_by(M::LANES) {
            let sample = Sample {
                position: load(lanes, &batch.position, at),
                normal: load(lanes, &batch.normal, at),
                to_eye: load(lanes, &batch.to_eye, at),
                // The condition is constant, so variants without a map load nothing.
                exponent: match H::IS_MAPPED {
                    true => lanes.load(&batch.exponent, at),
                    false => lanes.lift(1.0),
                },
            };
            // Most lights reach only some positions; a light that adds nothing stores nothing.
            let Some(reflected) = E::shade::<M, H>(lanes, sample, self.term) else {
                continue;
            };
            add(lanes, reflected.diffuse, &mut batch.diffuse, at);
            if let Some(specular) = reflected.specular {
                add(lanes, specular, &mut batch.specular, at);
            }
        }
    }
}

/// A number type that light shaders are compiled for.
pub(crate) trait Light: Number {
    /// Adds the light of a shader at every position of a batch.
    fn add_light(variant: Variant, level: Level, batch: &mut Batch<Self>, term: &LightTerm<Self>);
}

impl Light for f64 {
    fn add_light(variant: Variant, level: Level, batch: &mut Batch<Self>, term: &LightTerm<Self>) {
        (variant.reference)(level, batch, term);
    }
}

impl Light for f32 {
    fn add_light(variant: Variant, level: Level, batch: &mut Batch<Self>, term: &LightTerm<Self>) {
        (variant.fast)(level, batch, term);
    }
}

//! Phong lighting: lights, materials, their products, and the specular highlight.
//!
//! Phong, "Illumination for Computer Generated Pictures", CACM 1975.

use super::Which;
use super::batch::{Reflected, Sample, set};
use super::region::Region;
use crate::simd::power::least_cosine;
use crate::simd::{Lanes, Number, Power, Real, Vec3};

/// A light of a frame, in view space.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct ViewLight {
    /// The colour, as factors.
    pub(crate) color: [f64; 3],
    /// The colour below the horizon, of a sky.
    pub(crate) ground: [f64; 3],
    /// The position.
    pub(crate) position: [f64; 3],
    /// The direction of its light, of length 1.
    pub(crate) direction: [f64; 3],
    /// The coefficients of 1, d and d^2 in the attenuation.
    pub(crate) attenuation: [f64; 3],
    /// The cosine of the cone's half-aperture.
    pub(crate) cos_half_aperture: f64,
    /// The exponent that concentrates the light along the axis.
    pub(crate) exponent: f64,
}

/// The diffuse light on a surface, as a polynomial of its normal n, for each channel: the factors
/// of 1, x, y, z, x^2, y^2, z^2, xy, xz and yz.
pub(crate) type Irradiance<T> = [[T; 10]; 3];

/// The coefficients of the Phong model.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct PhongMaterial {
    /// Ka.
    pub(crate) ambient: [f64; 3],
    /// Kd.
    pub(crate) diffuse: [f64; 3],
    /// Ks.
    pub(crate) specular: [f64; 3],
    /// Ns.
    pub(crate) exponent: f64,
    /// A power below 2^`floor` counts as 0.
    pub(crate) floor: f64,
    /// The power of every cosine up to this one counts as 0.
    pub(crate) least_cosine: f64,
}

impl PhongMaterial {
    /// Returns whether a light can have a highlight on this material.
    pub(crate) fn mirrors(&self, light: &ViewLight) -> bool {
        self.specular.iter().zip(light.color).any(|(ks, color)| ks * color != 0.0)
    }

    /// Sets the floor below which powers count as 0.
    pub(crate) fn with_floor(self, floor: f64) -> Self {
        // The cosine whose power is the floor, or a little less, so that rounding leaves nothing
        // out.
        let least = least_cosine(self.exponent, floor);
        Self { floor, least_cosine: least * (1.0 - 1e-5), ..self }
    }
}

/// The products of a light and a material, in the arithmetic of shading.
#[derive(Clone, Debug)]
pub(crate) struct LightTerm<T> {
    /// The shader of the light.
    pub(crate) which: Which,
    /// The form of the highlight.
    pub(crate) form: Form,
    /// Whether a map multiplies the exponent of the highlight: see [`Sample::exponent`].
    pub(crate) is_mapped: bool,
    /// I Ka.
    pub(crate) ambient: [T; 3],
    /// I Kd.
    pub(crate) diffuse: [T; 3],
    /// I Ks.
    pub(crate) specular: [T; 3],
    /// Kd times the colour below the horizon.
    pub(crate) ground: [T; 3],
    /// Kd times the light of a panorama, if there is one.
    pub(crate) irradiance: Option<Box<Irradiance<T>>>,
    /// See [`ViewLight::position`].
    pub(crate) position: [T; 3],
    /// The direction against the light's travel.
    pub(crate) axis: [T; 3],
    /// See [`ViewLight::attenuation`].
    pub(crate) attenuation: [T; 3],
    /// Whether the light fades with distance.
    pub(crate) fades: bool,
    /// See [`ViewLight::cos_half_aperture`].
    pub(crate) cos_half_aperture: T,
    /// The exponent by which its light is concentrated along the axis.
    pub(crate) gathered: Power,
    /// The power of the highlight, with the exponent Ns.
    pub(crate) highlight: Power,
    /// See [`PhongMaterial::least_cosine`].
    pub(crate) least_cosine: T,
}

impl<T: Number> LightTerm<T> {
    /// Multiplies a light and a material, with the prepared power of the material's highlight.
    pub(crate) fn new(
        light: &ViewLight,
        material: &PhongMaterial,
        highlight: Power,
        (which, form, is_mapped): (Which, Form, bool),
    ) -> Self {
        let all = |numbers: [f64; 3]| numbers.map(T::from_f64);
        // Each product is formed in f64 and rounded once.
        let times = |k: [f64; 3]| all([0, 1, 2].map(|i| light.color[i] * k[i]));
        Self {
            which,
            form,
            is_mapped,
            ambient: times(material.ambient),
            diffuse: times(material.diffuse),
            specular: times(material.specular),
            ground: all([0, 1, 2].map(|i| light.ground[i] * material.diffuse[i])),
            irradiance: None,
            position: all(light.position),
            axis: all(light.direction.map(|x| -x)),
            attenuation: all(light.attenuation),
            // With these coefficients, the attenuation is exactly 1 at any distance.
            fades: light.attenuation != [1.0, 0.0, 0.0],
            cos_half_aperture: T::from_f64(light.cos_half_aperture),
            gathered: Power::new(light.exponent, GATHERED_FLOOR),
            highlight,
            least_cosine: T::from_f64(material.least_cosine),
        }
    }
}

impl<T: Number> LightTerm<T> {
    /// Adds the light of a panorama on a material.
    pub(crate) fn with(self, irradiance: &Irradiance<f64>, material: &PhongMaterial) -> Self {
        let of = |i: usize| irradiance[i].map(|it| T::from_f64(it * material.diffuse[i]));
        Self { irradiance: Some(Box::new([of(0), of(1), of(2)])), ..self }
    }
}

/// The floor of the powers by which spots concentrate their light: less than 2^-24 counts as 0.
const GATHERED_FLOOR: f64 = -24.0;

/// The forms of specular highlights.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Form {
    /// None: Ks is 0.
    Plain,
    /// (R.V)^Ns with R = 2 (N.L) N - L: Phong, "Illumination for Computer Generated Pictures", CACM
    /// 1975.
    Reflection,
    /// (N.H)^Ns with H half-way between L and V: Blinn, "Models of Light Reflection for Computer
    /// Synthesized Pictures", SIGGRAPH 1977.
    HalfVector,
}

/// Computes the cosine to be raised to the exponent, if there is a highlight. `n_l` is N.L, more
/// than 0.
#[inline(always)]
fn cosine<R: Real>(form: Form, sample: Sample<R>, to_light: Vec3<R>, n_l: R) -> Option<R> {
    match form {
        Form::Plain => None,
        Form::Reflection => {
            let n_v = sample.normal.dot(sample.to_eye);
            let two = n_l.lift(2.0);
            // R.V = 2 (N.L) (N.V) - L.V saves computing R.
            Some(two * n_l * n_v - to_light.dot(sample.to_eye))
        }
        Form::HalfVector => Some(sample.normal.dot(to_light.plus(sample.to_eye).unit())),
    }
}

/// The cosine between light and normal up to which a light has no highlight.
///
/// A highlight starts abruptly as N.L rises above 0. If a light lies in the plane of a face, which
/// is not rare, N.L is only a rounding error, and that error would decide whether the whole face
/// has a highlight. The bound is a hundred times the error, and 0.0006 degrees.
const GRAZING: f64 = 1e-5;

/// Multiplies light by a strength, if there is one.
#[inline(always)]
fn weakened<R: Real>(part: R, strength: Option<R>) -> R {
    match strength {
        Some(strength) => part * strength,
        None => part,
    }
}

/// Computes the diffuse and specular Phong reflection of light from a direction:
///
///   diffuse = s I Kd max(0, N.L),   specular = s I Ks [N.L > 0 and c > 0] c^Ns
///
/// with s the remaining `strength` of the light's intensity I (1 if it is `None`), L the direction
/// `to_light`, and c the cosine of the highlight's [`Form`].
#[inline(always)]
pub(super) fn phong<M: Lanes>(
    lanes: M,
    sample: Sample<M::R>,
    to_light: Vec3<M::R>,
    strength: Option<M::R>,
    term: &LightTerm<M::Number>,
) -> Option<Reflected<M::R>> {
    let zero = lanes.lift(0.0);
    let n_l = sample.normal.dot(to_light);
    // Many batches face away from a light, which ends their computation.
    if !lanes.any_more(n_l, zero) {
        return None;
    }
    let diffuse = set(lanes, term.diffuse).times(weakened(Real::max(n_l, zero), strength));
    let mut specular = None;
    if let Some(cosine) = cosine(term.form, sample, to_light, n_l) {
        // Light that grazes the surface has no highlight.
        let lit = n_l.if_more(lanes.lift(GRAZING), cosine, zero);
        // A map can widen the highlight to any cosine.
        let least = if term.is_mapped { zero } else { lanes.set(term.least_cosine) };
        if lanes.any_more(lit, least) {
            // Rounding can bring a cosine above 1.
            let cosine = Real::min(lit, lanes.lift(1.0));
            let power = match term.is_mapped {
                true => cosine.power_times(&term.highlight, sample.exponent),
                false => cosine.power(&term.highlight),
            };
            specular = Some(set(lanes, term.specular).times(weakened(power, strength)));
        }
    }
    Some(Reflected { diffuse, specular })
}

/// The largest attenuation factor of a light over a region.
pub(super) fn max_attenuation(light: &ViewLight, region: Option<&Region>) -> f64 {
    // The light is strongest at the smallest distance.
    let d = region.map_or(0.0, |region| region.least_distance(light.position.into()));
    let [a0, a1, a2] = light.attenuation;
    1.0 / (a0 + (a1 + a2 * d) * d)
}

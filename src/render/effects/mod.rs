//! The effects of light, and the table of them.
//!
//! An effect is one file in this folder and one line in the list below. It says when a scene calls
//! for it and how it lights a surface, once, over [`Real`]; from the list come its compiled variants,
//! its place in the plan, and its tests. A frame pays for the effects that it uses and for no other.
//!
//! Light is computed in view space, for a batch of places at a time: pixels, vertices or faces alike.

use fearless_simd::{Level, Simd, SimdBase as _, dispatch, f32x16};

use super::real::{Real, Triple};

/// Places lit together: a block of 8 x 8 pixels, small enough for the nearest cache, large enough
/// that the call of an effect costs nothing beside its work.
pub const BATCH: usize = 64;

const LANES: usize = 16;

/// Places on surfaces on their way through the effects: an array for each quantity.
#[derive(Clone, Debug)]
pub struct Batch<T> {
    /// How many places there are; what lies behind them is of no meaning.
    pub len: usize,
    /// Where they are, in view space.
    pub position: [[T; BATCH]; 3],
    /// Their normals: of length 1, or zero where there is none.
    pub normal: [[T; BATCH]; 3],
    /// The directions to the observer, of length 1: V.
    pub to_eye: [[T; BATCH]; 3],
    /// Light that takes the colour of the surface: ambient and diffuse.
    pub diffuse: [[T; BATCH]; 3],
    /// Light that keeps its own colour.
    pub specular: [[T; BATCH]; 3],
}

impl<T: Copy + Default> Default for Batch<T> {
    fn default() -> Self {
        let zero = [[T::default(); BATCH]; 3];
        Self { len: 0, position: zero, normal: zero, to_eye: zero, diffuse: zero, specular: zero }
    }
}

/// A place on a surface, or several.
#[derive(Clone, Copy, Debug)]
pub struct Sample<R> {
    /// See [`Batch::position`].
    pub position: Triple<R>,
    /// See [`Batch::normal`].
    pub normal: Triple<R>,
    /// See [`Batch::to_eye`].
    pub to_eye: Triple<R>,
}

/// What the observer gets from a place by one effect.
#[derive(Clone, Copy, Debug)]
pub struct Reflected<R> {
    /// See [`Batch::diffuse`].
    pub diffuse: Triple<R>,
    /// See [`Batch::specular`].
    pub specular: Triple<R>,
}

/// A light that shines in this frame, in view space.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lamp {
    /// Its colour as factors.
    pub color: [f64; 3],
    /// Where it is.
    pub position: [f64; 3],
    /// The way its light goes, of length 1.
    pub direction: [f64; 3],
    /// The coefficients of 1, d and d^2 by which it fades.
    pub attenuation: [f64; 3],
    /// The cosine at the border of its cone.
    pub cos_half_aperture: f64,
    /// How much its light is gathered along the axis.
    pub exponent: f64,
}

/// What a surface does with light.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Matter {
    /// Ka.
    pub ambient: [f64; 3],
    /// Kd.
    pub diffuse: [f64; 3],
    /// Ks.
    pub specular: [f64; 3],
    /// Ns.
    pub exponent: f64,
    /// A power below 2^`floor` counts as 0.
    pub floor: f64,
}

/// One way of lighting a surface.
pub trait Effect {
    /// Its name in the plan.
    const NAME: &'static str;
    /// Why the surface needs none of it, where it does not: leaving it out then changes no bit.
    fn needless(lamp: &Lamp, matter: &Matter) -> Option<&'static str>;
    /// What the observer gets from a place.
    fn shade<R: Real, H: Highlight>(
        sample: Sample<R>,
        lamp: &Lamp,
        matter: &Matter,
    ) -> Reflected<R>;
}

/// The form of a highlight.
pub trait Highlight {
    /// The cosine whose power is the highlight, where there is one; `n_l` is N.L, more than 0.
    fn cosine<R: Real>(sample: Sample<R>, to_light: Triple<R>, n_l: R) -> Option<R>;
}

/// No highlight.
#[derive(Debug)]
pub struct Nothing;
/// R.V with R = 2 (N.L) N - L: Phong, "Illumination for Computer Generated Pictures", CACM 1975.
#[derive(Debug)]
pub struct Reflection;
/// N.H with H half-way between L and V: Blinn, "Models of Light Reflection for Computer Synthesized
/// Pictures", SIGGRAPH 1977.
#[derive(Debug)]
pub struct HalfVector;

impl Highlight for Nothing {
    #[inline(always)]
    fn cosine<R: Real>(_: Sample<R>, _: Triple<R>, _: R) -> Option<R> {
        None
    }
}

impl Highlight for Reflection {
    #[inline(always)]
    fn cosine<R: Real>(sample: Sample<R>, to_light: Triple<R>, n_l: R) -> Option<R> {
        let n_v = sample.normal.dot(sample.to_eye);
        let two = n_l.lift(2.0);
        Some(two * n_l * n_v - to_light.dot(sample.to_eye))
    }
}

impl Highlight for HalfVector {
    #[inline(always)]
    fn cosine<R: Real>(sample: Sample<R>, to_light: Triple<R>, _: R) -> Option<R> {
        Some(sample.normal.dot(to_light.plus(sample.to_eye).unit()))
    }
}

/// Light that arrives from a direction, reflected:
///
///   diffuse = s I Kd max(0, N.L),   specular = s I Ks [N.L > 0 and c > 0] c^Ns
///
/// with s the `strength` that is left of the lamp's light I, L the direction `to_light`, and c the
/// cosine of the [`Highlight`].
#[inline(always)]
fn phong<R: Real, H: Highlight>(
    sample: Sample<R>,
    to_light: Triple<R>,
    strength: R,
    lamp: &Lamp,
    matter: &Matter,
) -> Reflected<R> {
    let zero = strength.lift(0.0);
    let n_l = sample.normal.dot(to_light);
    let scattered = Real::max(n_l, zero) * strength;
    let color = lamp.color;
    let product = |by: [f64; 3]| [color[0] * by[0], color[1] * by[1], color[2] * by[2]];
    let specular = match H::cosine(sample, to_light, n_l) {
        None => Triple::lift(strength, [0.0; 3]),
        Some(cosine) => {
            // Rounding can bring a cosine above 1.
            let cosine = Real::min(cosine, zero.lift(1.0));
            let power = cosine.power(matter.exponent, matter.floor);
            let mirrored = n_l.if_more(zero, power, zero) * strength;
            Triple::lift(strength, product(matter.specular)).times(mirrored)
        }
    };
    let diffuse = Triple::lift(strength, product(matter.diffuse)).times(scattered);
    Reflected { diffuse, specular }
}

/// Why a lamp needs not be looked at for a surface.
fn lamp_needless(lamp: &Lamp, matter: &Matter) -> Option<&'static str> {
    let zero = |color: [f64; 3]| color == [0.0; 3];
    if zero(lamp.color) {
        Some("its colour is black")
    } else if zero(matter.diffuse) && zero(matter.specular) {
        Some("Kd and Ks of the material are 0")
    } else {
        None
    }
}

/// An effect compiled for one form of highlight: for the reference, and for what the editor shows.
#[derive(Clone, Copy, Debug)]
pub struct Variant {
    reference: fn(&mut Batch<f64>, &Lamp, &Matter),
    fast: fn(Level, &mut Batch<f32>, &Lamp, &Matter),
}

/// A row of the table.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// See [`Effect::NAME`].
    pub name: &'static str,
    /// See [`Effect::needless`].
    pub needless: fn(&Lamp, &Matter) -> Option<&'static str>,
    /// Without a highlight.
    pub plain: Variant,
    /// With [`Reflection`].
    pub reflection: Variant,
    /// With [`HalfVector`].
    pub half_vector: Variant,
}

macro_rules! effects {
    ($($file:ident :: $effect:ident as $place:ident),+ $(,)?) => {
        $(mod $file;)+
        $(
            /// The table's row of this name.
            pub static $place: Entry = entry::<$file::$effect>();
        )+
        /// Every effect of light.
        pub static EFFECTS: &[&Entry] = &[$(&$place),+];
    };
}

effects! {
    ambient::Ambient as AMBIENT,
    sun::Sun as SUN,
    bulb::Bulb as BULB,
    spot::Spot as SPOT,
}

const fn entry<E: Effect>() -> Entry {
    Entry {
        name: E::NAME,
        needless: E::needless,
        plain: variant::<E, Nothing>(),
        reflection: variant::<E, Reflection>(),
        half_vector: variant::<E, HalfVector>(),
    }
}

const fn variant<E: Effect, H: Highlight>() -> Variant {
    Variant { reference: reference::<E, H>, fast: fast::<E, H> }
}

fn reference<E: Effect, H: Highlight>(batch: &mut Batch<f64>, lamp: &Lamp, matter: &Matter) {
    for i in 0..batch.len {
        let pick = |rows: &[[f64; BATCH]; 3]| Triple(rows.each_ref().map(|row| row[i]));
        let sample = Sample {
            position: pick(&batch.position),
            normal: pick(&batch.normal),
            to_eye: pick(&batch.to_eye),
        };
        let reflected = E::shade::<f64, H>(sample, lamp, matter);
        for axis in 0..3 {
            batch.diffuse[axis][i] += reflected.diffuse.0[axis];
            batch.specular[axis][i] += reflected.specular.0[axis];
        }
    }
}

fn fast<E: Effect, H: Highlight>(
    level: Level,
    batch: &mut Batch<f32>,
    lamp: &Lamp,
    matter: &Matter,
) {
    dispatch!(level, simd => sixteens::<_, E, H>(simd, batch, lamp, matter));
}

#[inline(always)]
fn sixteens<S: Simd, E: Effect, H: Highlight>(
    simd: S,
    batch: &mut Batch<f32>,
    lamp: &Lamp,
    matter: &Matter,
) {
    for i in (0..batch.len).step_by(LANES) {
        let sample = Sample {
            position: load(simd, &batch.position, i),
            normal: load(simd, &batch.normal, i),
            to_eye: load(simd, &batch.to_eye, i),
        };
        let reflected = E::shade::<_, H>(sample, lamp, matter);
        let diffuse = load(simd, &batch.diffuse, i).plus(reflected.diffuse);
        let specular = load(simd, &batch.specular, i).plus(reflected.specular);
        store(diffuse, &mut batch.diffuse, i);
        store(specular, &mut batch.specular, i);
    }
}

#[inline(always)]
fn load<S: Simd>(simd: S, [x, y, z]: &[[f32; BATCH]; 3], i: usize) -> Triple<f32x16<S>> {
    let row = i..i + LANES;
    Triple([
        f32x16::from_slice(simd, &x[row.clone()]),
        f32x16::from_slice(simd, &y[row.clone()]),
        f32x16::from_slice(simd, &z[row]),
    ])
}

#[inline(always)]
fn store<S: Simd>(from: Triple<f32x16<S>>, [x, y, z]: &mut [[f32; BATCH]; 3], i: usize) {
    let row = i..i + LANES;
    from.0[0].store_slice(&mut x[row.clone()]);
    from.0[1].store_slice(&mut y[row.clone()]);
    from.0[2].store_slice(&mut z[row]);
}

/// The numbers that a batch can hold.
pub trait Number: Real + Default + Into<f64> + Send + Sync + std::fmt::Debug + 'static {
    /// The nearest such number.
    fn from_f64(number: f64) -> Self;
    /// The byte nearest to 255 times the number: clamped once, rounded, NaN gives 0.
    fn byte(self) -> u8;
    /// Adds what an effect reflects at every place of the batch.
    fn run(variant: &Variant, level: Level, batch: &mut Batch<Self>, lamp: &Lamp, matter: &Matter);
}

impl Number for f64 {
    #[inline(always)]
    fn from_f64(number: f64) -> Self {
        number
    }

    #[inline(always)]
    fn byte(self) -> u8 {
        crate::base::color::byte(self)
    }

    fn run(variant: &Variant, _: Level, batch: &mut Batch<Self>, lamp: &Lamp, matter: &Matter) {
        (variant.reference)(batch, lamp, matter);
    }
}

impl Number for f32 {
    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, reason = "rounding to the nearest f32 is meant")]
    fn from_f64(number: f64) -> Self {
        number as Self
    }

    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped before")]
    fn byte(self) -> u8 {
        (Real::min(Real::max(self, 0.0), 1.0) * 255.0 + 0.5) as u8
    }

    fn run(variant: &Variant, level: Level, batch: &mut Batch<Self>, lamp: &Lamp, matter: &Matter) {
        (variant.fast)(level, batch, lamp, matter);
    }
}

#[cfg(test)]
mod tests;

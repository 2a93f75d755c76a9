//! The effects of light, and the table of them.
//!
//! An effect is one file in this folder and one line in the list below. It says when a scene calls
//! for it and how it lights a surface, once, over [`Real`]; from the list come its compiled variants,
//! its place in the plan, and its tests. A frame pays for the effects that it uses and for no other.
//!
//! Light is computed in view space, for a batch of places at a time: pixels, vertices or faces alike.

use std::marker::PhantomData;

use fearless_simd::Level;

use super::numbers::real::{Kernel, Machine, Number, Power, Real, Triple};
use super::plan::Turning;
use super::region::Region;
use super::shading::located::Interpolated;
use super::ways::Ways;
use super::ways::power::least_cosine;
use crate::scene::{Normalising, SpecularPower};

/// Places lit together: a block of 8 x 8 pixels, small enough for the nearest cache, large enough
/// that the call of an effect costs nothing beside its work.
pub const BATCH: usize = 64;

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

impl<T: Copy + Default> Batch<T> {
    /// Takes all light away.
    pub(super) fn darken(&mut self) {
        for row in self.diffuse.iter_mut().chain(&mut self.specular) {
            row.fill(T::default());
        }
    }
}

impl<T: Number> Batch<T> {
    /// Puts some places in, from `at` on.
    #[inline(always)]
    pub(super) fn put<M: Machine<Number = T>>(
        &mut self,
        machine: M,
        sample: Sample<M::R>,
        at: usize,
    ) {
        store(machine, sample.position, &mut self.position, at);
        store(machine, sample.normal, &mut self.normal, at);
        store(machine, sample.to_eye, &mut self.to_eye, at);
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
    /// See [`Batch::specular`]; `None` where there is nothing of it.
    pub specular: Option<Triple<R>>,
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
    /// The power of every cosine up to this one counts as 0.
    pub least_cosine: f64,
}

impl Matter {
    /// Whether any of a lamp's light can come back as a highlight.
    #[must_use]
    pub fn mirrors(&self, lamp: &Lamp) -> bool {
        self.specular.iter().zip(lamp.color).any(|(ks, color)| ks * color != 0.0)
    }

    /// Sets from where on a power counts as 0, by the way that powers are taken.
    #[must_use]
    pub fn with_floor(self, floor: f64, way: SpecularPower) -> Self {
        // The cosine whose power is the floor; a little less, so that rounding leaves nothing out.
        let least = least_cosine(way, self.exponent, floor);
        Self { floor, least_cosine: least * (1.0 - 1e-5), ..self }
    }
}

/// A lamp on a surface, in the numbers that light is computed in.
#[derive(Clone, Debug)]
pub struct Shine<T> {
    /// I Ka.
    pub ambient: [T; 3],
    /// I Kd.
    pub diffuse: [T; 3],
    /// I Ks.
    pub specular: [T; 3],
    /// See [`Lamp::position`].
    pub position: [T; 3],
    /// Against the way its light goes.
    pub axis: [T; 3],
    /// See [`Lamp::attenuation`].
    pub attenuation: [T; 3],
    /// Whether its light fades with distance.
    pub fades: bool,
    /// See [`Lamp::cos_half_aperture`].
    pub cos_half_aperture: T,
    /// How much its light is gathered along the axis.
    pub gathered: Power,
    /// The power of the highlight.
    pub highlight: Power,
    /// See [`Matter::least_cosine`].
    pub least_cosine: T,
    /// By which rare way, where it is one.
    way: Option<Normalising>,
}

impl<T: Number> Shine<T> {
    /// What a lamp does to a surface.
    #[must_use]
    pub fn new(lamp: &Lamp, matter: &Matter) -> Self {
        let all = |numbers: [f64; 3]| numbers.map(T::from_f64);
        let times = |k: [f64; 3]| all([0, 1, 2].map(|i| lamp.color[i] * k[i]));
        Self {
            ambient: times(matter.ambient),
            diffuse: times(matter.diffuse),
            specular: times(matter.specular),
            position: all(lamp.position),
            axis: all(lamp.direction.map(|x| -x)),
            attenuation: all(lamp.attenuation),
            fades: lamp.attenuation != [1.0, 0.0, 0.0],
            cos_half_aperture: T::from_f64(lamp.cos_half_aperture),
            gathered: Power::new(lamp.exponent, GATHERED_FLOOR),
            highlight: Power::new(matter.exponent, matter.floor),
            least_cosine: T::from_f64(matter.least_cosine),
            way: None,
        }
    }

    /// The same by the ways of a frame, with the power of the material's highlight.
    #[must_use]
    pub(super) fn by(ways: &Ways, lamp: &Lamp, matter: &Matter, highlight: &Power) -> Self {
        match ways.rare_light::<T>() {
            None => Self::new(lamp, matter),
            way => Self { highlight: highlight.clone(), way, ..Self::new(lamp, matter) },
        }
    }
}

/// A cosine's power below 2^-24 counts as 0, where a spot gathers its light by it.
const GATHERED_FLOOR: f64 = -24.0;

/// One way of lighting a surface.
pub trait Effect {
    /// Its name in the plan.
    const NAME: &'static str;
    /// Whether it looks at where a place is, how it is turned, or from where it is seen.
    const READS_PLACES: bool = true;
    /// Whether it shines on a part of space only, so that `misses` may say so.
    const HAS_REACH: bool = false;
    /// Why the surface needs none of it, where it does not: leaving it out then changes no bit.
    fn needless(lamp: &Lamp, matter: &Matter) -> Option<&'static str>;
    /// Why none of it arrives in a region, where that is so: leaving it out there then changes no bit.
    fn misses(_: &Lamp, _: &Region) -> Option<&'static str> {
        None
    }
    /// Whether it comes from behind all faces of a region, which are turned as `turning` says: leaving
    /// it out there then changes no bit.
    fn is_behind(_: &Lamp, _: &Region, _: &Turning) -> bool {
        false
    }
    /// The largest part of the lamp's light that arrives in a region, anywhere where none is said.
    fn arrives(_: &Lamp, _: Option<&Region>) -> f64 {
        1.0
    }
    /// The most that it adds to a channel at any place of a region, with its highlight or without, as
    /// a factor; a surface's texture takes away from that at most.
    fn most(lamp: &Lamp, matter: &Matter, highlight: bool, region: Option<&Region>) -> f64 {
        let mut sent_back = matter.diffuse;
        if highlight {
            for (kd, ks) in sent_back.iter_mut().zip(matter.specular) {
                *kd += ks;
            }
        }
        most_of_channels(lamp.color, sent_back) * Self::arrives(lamp, region)
    }
    /// What the observer gets from some places; `None` where that is nothing at all of them.
    fn shade<M: Machine, H: Highlight>(
        machine: M,
        sample: Sample<M::R>,
        shine: &Shine<M::Number>,
    ) -> Option<Reflected<M::R>>;
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

/// Light that comes in along a surface, to this cosine of its angle to the normal, has no highlight.
///
/// A highlight begins at once where N.L comes above 0. A lamp in the very plane of a face, which is
/// nothing rare, leaves N.L to rounding; without this, rounding would decide whether all of the face
/// has a highlight. It is a hundred times the rounding error, and 0.0006 degrees.
const GRAZING: f64 = 1e-5;

/// What is left of a part of light.
#[inline(always)]
fn weakened<R: Real>(part: R, strength: Option<R>) -> R {
    match strength {
        Some(strength) => part * strength,
        None => part,
    }
}

/// Light that arrives from a direction, reflected:
///
///   diffuse = s I Kd max(0, N.L),   specular = s I Ks [N.L > 0 and c > 0] c^Ns
///
/// with s the `strength` that is left of the lamp's light I (1 where it is `None`), L the direction `to_light`, and c the
/// cosine of the [`Highlight`].
#[inline(always)]
fn phong<M: Machine, H: Highlight>(
    machine: M,
    sample: Sample<M::R>,
    to_light: Triple<M::R>,
    strength: Option<M::R>,
    shine: &Shine<M::Number>,
) -> Option<Reflected<M::R>> {
    let zero = machine.lift(0.0);
    let n_l = sample.normal.dot(to_light);
    if !machine.any_more(n_l, zero) {
        return None;
    }
    let diffuse = set(machine, shine.diffuse).times(weakened(Real::max(n_l, zero), strength));
    let mut specular = None;
    if let Some(cosine) = H::cosine(sample, to_light, n_l) {
        let lit = n_l.if_more(machine.lift(GRAZING), cosine, zero);
        if machine.any_more(lit, machine.set(shine.least_cosine)) {
            // Rounding can bring a cosine above 1.
            let power = Real::min(lit, machine.lift(1.0)).power(&shine.highlight);
            specular = Some(set(machine, shine.specular).times(weakened(power, strength)));
        }
    }
    Some(Reflected { diffuse, specular })
}

/// The largest of a surface's three channels under a light.
fn most_of_channels(color: [f64; 3], sent_back: [f64; 3]) -> f64 {
    color.iter().zip(sent_back).map(|(color, part)| color * part).fold(0.0, f64::max)
}

/// The largest part of a lamp's light that is left at its distance from a region.
fn most_left(lamp: &Lamp, region: Option<&Region>) -> f64 {
    let d = region.map_or(0.0, |region| region.least_distance(lamp.position.into()));
    let [a0, a1, a2] = lamp.attenuation;
    1.0 / (a0 + (a1 + a2 * d) * d)
}

/// Three numbers, the same for all lanes.
#[inline(always)]
pub(super) fn set<M: Machine>(machine: M, numbers: [M::Number; 3]) -> Triple<M::R> {
    Triple([machine.set(numbers[0]), machine.set(numbers[1]), machine.set(numbers[2])])
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
    reference: fn(Level, &mut Batch<f64>, &Shine<f64>),
    fast: fn(Level, &mut Batch<f32>, &Shine<f32>),
}

/// A row of the table.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// See [`Effect::NAME`].
    pub name: &'static str,
    /// See [`Effect::READS_PLACES`].
    pub reads_places: bool,
    /// See [`Effect::HAS_REACH`].
    pub has_reach: bool,
    /// See [`Effect::needless`].
    pub needless: fn(&Lamp, &Matter) -> Option<&'static str>,
    /// See [`Effect::misses`].
    pub misses: fn(&Lamp, &Region) -> Option<&'static str>,
    /// See [`Effect::is_behind`].
    pub is_behind: fn(&Lamp, &Region, &Turning) -> bool,
    /// See [`Effect::arrives`].
    pub arrives: fn(&Lamp, Option<&Region>) -> f64,
    /// See [`Effect::most`].
    pub most: fn(&Lamp, &Matter, bool, Option<&Region>) -> f64,
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
        reads_places: E::READS_PLACES,
        has_reach: E::HAS_REACH,
        needless: E::needless,
        misses: E::misses,
        is_behind: E::is_behind,
        arrives: E::arrives,
        most: E::most,
        plain: variant::<E, Nothing>(),
        reflection: variant::<E, Reflection>(),
        half_vector: variant::<E, HalfVector>(),
    }
}

const fn variant<E: Effect, H: Highlight>() -> Variant {
    Variant { reference: shade::<f64, E, H>, fast: shade::<f32, E, H> }
}

/// Adds what an effect reflects at every place of a batch.
fn shade<T: Number, E: Effect, H: Highlight>(level: Level, batch: &mut Batch<T>, shine: &Shine<T>) {
    T::run_by(level, shine.way, Shade::<T, E, H> { batch, shine, of: PhantomData });
}

struct Shade<'a, T, E, H> {
    batch: &'a mut Batch<T>,
    shine: &'a Shine<T>,
    of: PhantomData<(E, H)>,
}

impl<T: Number, E: Effect, H: Highlight> Kernel<T> for Shade<'_, T, E, H> {
    #[inline(always)]
    fn run<M: Machine<Number = T>>(self, machine: M) {
        let batch = self.batch;
        for at in (0..batch.len).step_by(M::LANES) {
            let sample = Sample {
                position: load(machine, &batch.position, at),
                normal: load(machine, &batch.normal, at),
                to_eye: load(machine, &batch.to_eye, at),
            };
            let Some(reflected) = E::shade::<M, H>(machine, sample, self.shine) else {
                continue;
            };
            add(machine, reflected.diffuse, &mut batch.diffuse, at);
            if let Some(specular) = reflected.specular {
                add(machine, specular, &mut batch.specular, at);
            }
        }
    }
}

/// Three rows of numbers.
pub(super) type Rows<T> = [[T; BATCH]; 3];

/// Takes from three rows.
#[inline(always)]
pub(super) fn load<M: Machine>(machine: M, [x, y, z]: &Rows<M::Number>, at: usize) -> Triple<M::R> {
    Triple([machine.load(x, at), machine.load(y, at), machine.load(z, at)])
}

/// Puts into three rows.
#[inline(always)]
pub(super) fn store<M: Machine>(
    machine: M,
    value: Triple<M::R>,
    [x, y, z]: &mut Rows<M::Number>,
    at: usize,
) {
    machine.store(value.0[0], x, at);
    machine.store(value.0[1], y, at);
    machine.store(value.0[2], z, at);
}

#[inline(always)]
fn add<M: Machine>(machine: M, more: Triple<M::R>, rows: &mut Rows<M::Number>, at: usize) {
    let sum = load(machine, rows, at).plus(more);
    store(machine, sum, rows, at);
}

/// Numbers that effects are compiled for.
pub trait Light: Number + Interpolated {
    /// Adds what an effect reflects at every place of the batch.
    fn add_light(variant: &Variant, level: Level, batch: &mut Batch<Self>, shine: &Shine<Self>);
}

impl Light for f64 {
    fn add_light(variant: &Variant, level: Level, batch: &mut Batch<Self>, shine: &Shine<Self>) {
        (variant.reference)(level, batch, shine);
    }
}

impl Light for f32 {
    fn add_light(variant: &Variant, level: Level, batch: &mut Batch<Self>, shine: &Shine<Self>) {
        (variant.fast)(level, batch, shine);
    }
}

#[cfg(test)]
mod tests;

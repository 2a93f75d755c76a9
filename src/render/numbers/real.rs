//! The numbers that light is written in.
//!
//! Every equation of light is written once, over [`Real`], and compiled three times: for `f64`, one
//! at a time, the reference that pictures are judged by; for `f32x16`, sixteen at a time, what the
//! editor shows; and for `f32`, which does to one number what `f32x16` does to sixteen.
//!
//! There is no fused multiply-add here. It rounds once where `a * b + c` rounds twice, and only some
//! processors have it; without it a picture is the same, bit for bit, on all of them. Nor is there a
//! minimum or maximum of the processor's own: they disagree about NaN and about the sign of zero.

use std::ops::{Add, Div, Mul, Neg, Sub};

use fearless_simd::{Level, dispatch};

use super::pick::SLOTS;
use super::sixteen::Sixteen;
use crate::render::effects::BATCH;
pub use crate::render::ways::ByWay;
use crate::render::ways::Choosing;
pub use crate::render::ways::power::Power;
use crate::scene::{Normalising, SpecularPower};

/// A real number, or several of them side by side.
pub trait Real:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// A constant beside `self`: as many of it as `self` has numbers.
    #[must_use]
    fn lift(self, constant: f64) -> Self;
    /// One by the square root; 0 where `self` is not more than 0, and where its bits tell no digits:
    /// infinity, NaN, and what is below the normal numbers.
    #[must_use]
    fn reciprocal_root(self) -> Self;
    /// `yes` where `self` is more than `than`, `no` elsewhere and where either is NaN.
    #[must_use]
    fn if_more(self, than: Self, yes: Self, no: Self) -> Self;
    /// The power of `self`, which is from 0 to 1; 0 where that is below the floor, and where `self`
    /// is 0.
    #[must_use]
    fn power(self, power: &Power) -> Self;

    /// The larger of two numbers; `other` where `self` is NaN.
    #[inline(always)]
    #[must_use]
    fn max(self, other: Self) -> Self {
        self.if_more(other, self, other)
    }

    /// The smaller of two numbers; `other` where `self` is NaN.
    #[inline(always)]
    #[must_use]
    fn min(self, other: Self) -> Self {
        other.if_more(self, self, other)
    }
}

impl Real for f64 {
    #[inline(always)]
    fn lift(self, constant: f64) -> Self {
        constant
    }

    #[inline(always)]
    fn reciprocal_root(self) -> Self {
        if self > 0.0 && self < Self::INFINITY { 1.0 / self.sqrt() } else { 0.0 }
    }

    #[inline(always)]
    fn if_more(self, than: Self, yes: Self, no: Self) -> Self {
        if self > than { yes } else { no }
    }

    #[inline(always)]
    fn power(self, power: &Power) -> Self {
        if self.is_nan() || self <= 0.0 {
            return 0.0;
        }
        let result = libm::pow(self, power.exponent);
        if result > power.least { result } else { 0.0 }
    }
}

/// What takes numbers from rows in memory, some at a time, computes with them, and puts them back.
///
/// Code that is written over a machine is compiled for each: see [`Kernel`].
pub trait Machine: Copy {
    /// The numbers in memory.
    type Number: Copy;
    /// The numbers that are computed with: [`Self::LANES`] of them.
    type R: ByWay;
    /// Places in a row: [`Self::LANES`] of them.
    type Slots: Copy;
    /// How many numbers are taken at a time.
    const LANES: usize;
    /// The numbers of a row that begin at `at`.
    fn load(self, row: &[Self::Number], at: usize) -> Self::R;
    /// The numbers of four rows that lie side by side, from `at` on.
    fn load_four(self, rows: &[[Self::Number; 4]], at: usize) -> [Self::R; 4];
    /// Puts numbers into four rows that lie side by side, from `at` on.
    fn store_four(self, values: [Self::R; 4], rows: &mut [[Self::Number; 4]], at: usize);
    /// Puts numbers into a row from `at` on.
    fn store(self, value: Self::R, row: &mut [Self::Number], at: usize);
    /// The whole numbers of a row that begin at `at`.
    fn whole(self, row: &[i32], at: usize) -> Self::R;
    /// Puts colours into a row of pixels: red, green, blue and 255, as bytes in this order, each the
    /// nearest to 255 times the number, as [`Number::byte`] has it.
    fn store_pixels(self, color: Triple<Self::R>, row: &mut [u32], at: usize);
    /// The same, each the whole part of 255 times the number and a threshold from 0 to 1.
    fn store_pixels_by(
        self,
        color: Triple<Self::R>,
        threshold: Self::R,
        row: &mut [u32],
        at: usize,
    );
    /// Puts colours into three rows: red, green and blue as the bytes of [`Self::store_pixels_by`] before
    /// they are rounded down, in parts of 2^-16.
    fn store_parts(
        self,
        color: Triple<Self::R>,
        threshold: Self::R,
        rows: &mut [[u32; BATCH]; 3],
        at: usize,
    );
    /// A constant.
    fn lift(self, constant: f64) -> Self::R;
    /// One number for all.
    fn set(self, number: Self::Number) -> Self::R;
    /// The places in rows of `SLOTS` that [`Self::pick`] takes numbers from.
    fn slots(self, slots: &[i32], at: usize) -> Self::Slots;
    /// The numbers of a row at some places, all of which are among the first `PAGES` times sixteen.
    fn pick<const PAGES: usize>(self, row: &[Self::Number; SLOTS], slots: Self::Slots) -> Self::R;
    /// Whether any of some numbers is more than its counterpart.
    fn any_more(self, a: Self::R, b: Self::R) -> bool;
}

/// Work that is written once for every [`Machine`] over the same numbers.
pub trait Kernel<T> {
    /// Does the work. Implementations are `#[inline(always)]`, so that they are compiled for the
    /// instructions that the machine stands for.
    fn run<M: Machine<Number = T>>(self, machine: M);
}

/// Computes in f64, one number at a time.
#[derive(Clone, Copy, Debug)]
pub struct Exact;

impl Machine for Exact {
    type Number = f64;
    type R = f64;
    type Slots = usize;
    const LANES: usize = 1;

    #[inline(always)]
    fn load(self, row: &[f64], at: usize) -> f64 {
        row[at]
    }

    #[inline(always)]
    fn load_four(self, rows: &[[f64; 4]], at: usize) -> [f64; 4] {
        rows[at]
    }

    #[inline(always)]
    fn store_four(self, values: [f64; 4], rows: &mut [[f64; 4]], at: usize) {
        rows[at] = values;
    }

    #[inline(always)]
    fn store(self, value: f64, row: &mut [f64], at: usize) {
        row[at] = value;
    }

    #[inline(always)]
    fn whole(self, row: &[i32], at: usize) -> f64 {
        f64::from(row[at])
    }

    #[inline(always)]
    fn store_pixels(self, color: Triple<f64>, row: &mut [u32], at: usize) {
        let [r, g, b] = color.0.map(Number::byte);
        row[at] = u32::from_le_bytes([r, g, b, 255]);
    }

    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped before")]
    fn store_pixels_by(self, color: Triple<f64>, threshold: f64, row: &mut [u32], at: usize) {
        let byte = |x: f64| (Real::min(Real::max(x, 0.0), 1.0) * 255.0 + threshold) as u8;
        let [r, g, b] = color.0.map(byte);
        row[at] = u32::from_le_bytes([r, g, b, 255]);
    }

    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "below 2^24")]
    fn store_parts(
        self,
        color: Triple<f64>,
        threshold: f64,
        rows: &mut [[u32; BATCH]; 3],
        at: usize,
    ) {
        for (row, number) in rows.iter_mut().zip(color.0) {
            let held = Real::min(Real::max(number, 0.0), 1.0);
            row[at] = ((held * 255.0 + threshold) * PARTS) as u32;
        }
    }

    #[inline(always)]
    fn lift(self, constant: f64) -> f64 {
        constant
    }

    #[inline(always)]
    fn set(self, number: f64) -> f64 {
        number
    }

    #[inline(always)]
    #[expect(clippy::cast_sign_loss, reason = "places are not negative")]
    fn slots(self, slots: &[i32], at: usize) -> usize {
        slots[at] as usize
    }

    #[inline(always)]
    fn pick<const PAGES: usize>(self, row: &[f64; SLOTS], slot: usize) -> f64 {
        row[slot]
    }

    #[inline(always)]
    fn any_more(self, a: f64, b: f64) -> bool {
        a > b
    }
}

/// Into how many parts a step of a byte is cut where colours are added up.
pub(super) const PARTS: f64 = 65536.0;

/// The numbers that pictures can be computed in.
pub trait Number: Real + Default + Into<f64> + Send + Sync + std::fmt::Debug + 'static {
    /// The nearest such number.
    fn from_f64(number: f64) -> Self;
    /// The byte nearest to 255 times the number: clamped once, rounded, NaN gives 0.
    fn byte(self) -> u8;
    /// How such numbers take powers by themselves.
    const POWER: SpecularPower;
    /// Does the work with the machine for such numbers, and with instructions of this level.
    fn run(level: Level, kernel: impl Kernel<Self>);
    /// The same by a rare way, where there is one.
    fn run_by(level: Level, way: Option<Normalising>, kernel: impl Kernel<Self>);
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

    const POWER: SpecularPower = SpecularPower::Library;

    fn run(_: Level, kernel: impl Kernel<Self>) {
        kernel.run(Exact);
    }

    fn run_by(level: Level, way: Option<Normalising>, kernel: impl Kernel<Self>) {
        match way {
            None => Self::run(level, kernel),
            Some(way) => kernel.run(Choosing { machine: Exact, way }),
        }
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

    const POWER: SpecularPower = SpecularPower::Polynomial;

    fn run(level: Level, kernel: impl Kernel<Self>) {
        dispatch!(level, simd => kernel.run(Sixteen(simd)));
    }

    fn run_by(level: Level, way: Option<Normalising>, kernel: impl Kernel<Self>) {
        match way {
            None => Self::run(level, kernel),
            Some(way) => {
                dispatch!(level, simd => kernel.run(Choosing { machine: Sixteen(simd), way }));
            }
        }
    }
}

/// Three numbers: a direction, a place, or light in red, green and blue.
#[derive(Clone, Copy, Debug)]
pub struct Triple<R>(pub [R; 3]);

impl<R: Real> Triple<R> {
    /// The same constants beside `like`.
    #[inline(always)]
    pub fn lift(like: R, [x, y, z]: [f64; 3]) -> Self {
        Self([like.lift(x), like.lift(y), like.lift(z)])
    }

    /// The dot product.
    #[inline(always)]
    pub fn dot(self, other: Self) -> R {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        a * x + b * y + c * z
    }

    /// Each number times `factor`.
    #[inline(always)]
    #[must_use]
    pub fn times(self, factor: R) -> Self {
        let [x, y, z] = self.0;
        Self([x * factor, y * factor, z * factor])
    }

    /// The sum, number by number.
    #[inline(always)]
    #[must_use]
    pub fn plus(self, other: Self) -> Self {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        Self([a + x, b + y, c + z])
    }

    /// The difference, number by number.
    #[inline(always)]
    #[must_use]
    pub fn minus(self, other: Self) -> Self {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        Self([a - x, b - y, c - z])
    }

    /// At length 1; what has no length stays without.
    #[inline(always)]
    #[must_use]
    pub fn unit(self) -> Self {
        self.times(self.dot(self).reciprocal_root())
    }
}

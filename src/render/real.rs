//! The numbers that light is written in.
//!
//! Every equation of light is written once, over [`Real`], and compiled three times: for `f64`, one
//! at a time, the reference that pictures are judged by; for [`f32x16`], sixteen at a time, what the
//! editor shows; and for `f32`, which does to one number what `f32x16` does to sixteen.
//!
//! There is no fused multiply-add here. It rounds once where `a * b + c` rounds twice, and only some
//! processors have it; without it a picture is the same, bit for bit, on all of them. Nor is there a
//! minimum or maximum of the processor's own: they disagree about NaN and about the sign of zero.

use std::ops::{Add, Div, Mul, Neg, Sub};

use fearless_simd::{
    Bytes as _, Level, Select as _, Simd, SimdBase as _, SimdFloat as _, SimdInt as _,
    SimdInto as _, SimdMask as _, dispatch, f32x16, i32x16,
};

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
    /// The square root.
    #[must_use]
    fn sqrt(self) -> Self;
    /// `yes` where `self` is more than `than`, `no` elsewhere and where either is NaN.
    #[must_use]
    fn if_more(self, than: Self, yes: Self, no: Self) -> Self;
    /// `self` to the power of `exponent`, for `self` from 0 to 1 and an exponent of at least 0; 0
    /// where the power is below 2^`floor`, and where `self` is 0.
    ///
    /// The floor keeps subnormal numbers out, and the work with them.
    #[must_use]
    fn power(self, exponent: f64, floor: f64) -> Self;

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
    fn sqrt(self) -> Self {
        self.sqrt()
    }

    #[inline(always)]
    fn if_more(self, than: Self, yes: Self, no: Self) -> Self {
        if self > than { yes } else { no }
    }

    #[inline(always)]
    fn power(self, exponent: f64, floor: f64) -> Self {
        if self.is_nan() || self <= 0.0 {
            return 0.0;
        }
        let power = libm::pow(self, exponent);
        if power > libm::exp2(floor) { power } else { 0.0 }
    }
}

/// Numbers of 32 bits whose exponent can be taken apart from their digits.
trait Single: Real {
    /// m and e with self = m 2^e, m from 1/sqrt 2 to sqrt 2, for normal numbers above 0.
    fn split(self) -> (Self, Self);
    /// 2^n for a whole number n from -126 to 127.
    fn power_of_two(self) -> Self;
    /// The nearest whole number, ties to even.
    fn round(self) -> Self;
}

/// Below this, a number of 32 bits is not normal any more.
const SMALLEST: f64 = 1.2e-38;

/// x^n = 2^(n log2 x), to 3e-6 of itself for powers above 2^-24.
///
///   x = m 2^e, f = m - 1:   ln m = f - f^2/2 + f^3 P(f)
///
/// with the polynomials of `logf` and `exp2f` in Moshier's Cephes library. Since ln m is right to a
/// part of itself, and not of 1, the power is right for x next to 1 however large n is.
#[inline(always)]
fn single_power<R: Single>(x: R, exponent: f64, floor: f64) -> R {
    const LOGARITHM: [f64; 9] = [
        7.037_683_629e-2,
        -1.151_461_031e-1,
        1.167_699_874e-1,
        -1.242_014_084_6e-1,
        1.424_932_278_7e-1,
        -1.666_805_766_5e-1,
        2.000_071_476_5e-1,
        -2.499_999_399_3e-1,
        3.333_333_117_4e-1,
    ];
    const EXPONENTIAL: [f64; 7] = [
        1.535_336_188_319_5e-4,
        1.339_887_440_266_574e-3,
        9.618_437_357_674_64e-3,
        5.550_332_471_162_809e-2,
        2.402_264_791_363_012e-1,
        6.931_472_028_550_42e-1,
        1.0,
    ];
    let (m, e) = Real::max(x, x.lift(SMALLEST)).split();
    let f = m - x.lift(1.0);
    let square = f * f;
    let ln = f - square * x.lift(0.5) + square * f * polynomial(f, &LOGARITHM);
    let log2 = ln * x.lift(std::f64::consts::LOG2_E) + e;

    let power = log2 * x.lift(exponent);
    // Held to what 2^n can be made of; what is below the floor is thrown away in the end.
    let held = Real::max(power, x.lift(-126.0));
    let whole = held.round();
    let result = polynomial(held - whole, &EXPONENTIAL) * whole.power_of_two();
    let zero = x.lift(0.0);
    x.if_more(zero, power.if_more(x.lift(floor), result, zero), zero)
}

/// A polynomial by Horner's rule, the coefficient of the highest power first.
#[inline(always)]
fn polynomial<R: Real>(x: R, coefficients: &[f64]) -> R {
    let mut sum = x.lift(0.0);
    for coefficient in coefficients {
        sum = sum * x + x.lift(*coefficient);
    }
    sum
}

const EXPONENT_BITS: i32 = 0xff << 23;
const ONE_BITS: i32 = 127 << 23;
/// The digits of sqrt 2, which decide to which power of two a number is nearer.
const SQRT_2_BITS: i32 = 0x3fb5_04f3;

impl Real for f32 {
    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, reason = "rounding to the nearest f32 is meant")]
    fn lift(self, constant: f64) -> Self {
        constant as Self
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        self.sqrt()
    }

    #[inline(always)]
    fn if_more(self, than: Self, yes: Self, no: Self) -> Self {
        if self > than { yes } else { no }
    }

    #[inline(always)]
    fn power(self, exponent: f64, floor: f64) -> Self {
        single_power(self, exponent, floor)
    }
}

impl Single for f32 {
    #[inline(always)]
    #[expect(clippy::cast_precision_loss, reason = "an exponent has eight bits")]
    fn split(self) -> (Self, Self) {
        let bits = self.to_bits().cast_signed();
        let digits = (bits & !EXPONENT_BITS) | ONE_BITS;
        let up = i32::from(digits > SQRT_2_BITS);
        let m = Self::from_bits((digits - (up << 23)).cast_unsigned());
        (m, ((bits >> 23) - 127 + up) as Self)
    }

    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, reason = "a whole number from -126 to 127")]
    fn power_of_two(self) -> Self {
        Self::from_bits(((self as i32 + 127) << 23).cast_unsigned())
    }

    #[inline(always)]
    fn round(self) -> Self {
        self.round_ties_even()
    }
}

impl<S: Simd> Real for f32x16<S> {
    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, reason = "rounding to the nearest f32 is meant")]
    fn lift(self, constant: f64) -> Self {
        (constant as f32).simd_into(self.simd)
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        fearless_simd::SimdFloat::sqrt(self)
    }

    #[inline(always)]
    fn if_more(self, than: Self, yes: Self, no: Self) -> Self {
        self.simd_gt(than).select(yes, no)
    }

    #[inline(always)]
    fn power(self, exponent: f64, floor: f64) -> Self {
        single_power(self, exponent, floor)
    }
}

impl<S: Simd> Single for f32x16<S> {
    #[inline(always)]
    fn split(self) -> (Self, Self) {
        let bits: i32x16<S> = self.bitcast();
        let digits = (bits & !EXPONENT_BITS) | ONE_BITS;
        let zero: i32x16<S> = 0.simd_into(self.simd);
        let up = digits.simd_gt(SQRT_2_BITS).select(zero + 1, zero);
        let m: Self = (digits - (up << 23)).bitcast();
        (m, ((bits >> 23) - 127 + up).to_float())
    }

    #[inline(always)]
    fn power_of_two(self) -> Self {
        let n: i32x16<S> = self.to_int();
        ((n + 127) << 23).bitcast()
    }

    #[inline(always)]
    fn round(self) -> Self {
        self.round_ties_even()
    }
}

/// What takes numbers from rows in memory, some at a time, computes with them, and puts them back.
///
/// Code that is written over a machine is compiled for each: see [`Kernel`].
pub trait Machine: Copy {
    /// The numbers in memory.
    type Number: Copy;
    /// The numbers that are computed with: [`Self::LANES`] of them.
    type R: Real;
    /// How many numbers are taken at a time.
    const LANES: usize;
    /// The numbers of a row that begin at `at`.
    fn load(self, row: &[Self::Number], at: usize) -> Self::R;
    /// The numbers of four rows that lie side by side, from `at` on.
    fn load_four(self, rows: &[[Self::Number; 4]], at: usize) -> [Self::R; 4];
    /// Puts numbers into a row from `at` on.
    fn store(self, value: Self::R, row: &mut [Self::Number], at: usize);
    /// Puts the bytes nearest to 255 times the numbers into a row, as [`Number::byte`] has it.
    fn store_bytes(self, value: Self::R, row: &mut [i32], at: usize);
    /// A constant.
    fn lift(self, constant: f64) -> Self::R;
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
    fn store(self, value: f64, row: &mut [f64], at: usize) {
        row[at] = value;
    }

    #[inline(always)]
    fn store_bytes(self, value: f64, row: &mut [i32], at: usize) {
        row[at] = i32::from(value.byte());
    }

    #[inline(always)]
    fn lift(self, constant: f64) -> f64 {
        constant
    }

    #[inline(always)]
    fn any_more(self, a: f64, b: f64) -> bool {
        a > b
    }
}

/// Computes in f32, sixteen numbers at a time, with the instructions that `S` stands for.
#[derive(Clone, Copy, Debug)]
pub struct Sixteen<S>(pub S);

impl<S: Simd> Machine for Sixteen<S> {
    type Number = f32;
    type R = f32x16<S>;
    const LANES: usize = 16;

    #[inline(always)]
    fn load(self, row: &[f32], at: usize) -> f32x16<S> {
        f32x16::from_slice(self.0, &row[at..at + 16])
    }

    #[inline(always)]
    fn load_four(self, rows: &[[f32; 4]], at: usize) -> [f32x16<S>; 4] {
        let flat = rows[at..at + 16].as_flattened();
        let first = f32x16::from_slice(self.0, &flat[..16]);
        let second = f32x16::from_slice(self.0, &flat[16..32]);
        let third = f32x16::from_slice(self.0, &flat[32..48]);
        let fourth = f32x16::from_slice(self.0, &flat[48..]);
        let (even_low, odd_low) = first.deinterleave(second);
        let (even_high, odd_high) = third.deinterleave(fourth);
        let (a, c) = even_low.deinterleave(even_high);
        let (b, d) = odd_low.deinterleave(odd_high);
        [a, b, c, d]
    }

    #[inline(always)]
    fn store(self, value: f32x16<S>, row: &mut [f32], at: usize) {
        value.store_slice(&mut row[at..at + 16]);
    }

    #[inline(always)]
    fn store_bytes(self, value: f32x16<S>, row: &mut [i32], at: usize) {
        let (zero, one) = (self.lift(0.0), self.lift(1.0));
        let held = Real::min(Real::max(value, zero), one) * 255.0 + 0.5;
        held.to_int::<i32x16<S>>().store_slice(&mut row[at..at + 16]);
    }

    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, reason = "rounding to the nearest f32 is meant")]
    fn lift(self, constant: f64) -> f32x16<S> {
        (constant as f32).simd_into(self.0)
    }

    #[inline(always)]
    fn any_more(self, a: f32x16<S>, b: f32x16<S>) -> bool {
        a.simd_gt(b).any_true()
    }
}

/// The numbers that pictures can be computed in.
pub trait Number: Real + Default + Into<f64> + Send + Sync + std::fmt::Debug + 'static {
    /// The nearest such number.
    fn from_f64(number: f64) -> Self;
    /// The byte nearest to 255 times the number: clamped once, rounded, NaN gives 0.
    fn byte(self) -> u8;
    /// Does the work with the machine for such numbers, and with instructions of this level.
    fn run(level: Level, kernel: impl Kernel<Self>);
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

    fn run(_: Level, kernel: impl Kernel<Self>) {
        kernel.run(Exact);
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

    fn run(level: Level, kernel: impl Kernel<Self>) {
        dispatch!(level, simd => kernel.run(Sixteen(simd)));
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

    /// At length 1; zero stays zero.
    #[inline(always)]
    #[must_use]
    pub fn unit(self) -> Self {
        let square = self.dot(self);
        let zero = square.lift(0.0);
        let one = square.lift(1.0);
        let length = square.if_more(zero, square, one).sqrt();
        self.times(one / length)
    }
}

#[cfg(test)]
#[expect(clippy::cast_possible_truncation, reason = "small numbers")]
mod tests {
    use super::*;

    fn powers(x: &[f32; 16], exponent: f64, level: Level) -> [f32; 16] {
        let mut out = [0.0; 16];
        dispatch!(level, simd => {
            f32x16::from_slice(simd, x).power(exponent, -24.0).store_slice(&mut out);
        });
        out
    }

    #[test]
    fn a_power_is_wrong_by_less_than_it_says() {
        let mut worst = 0.0_f64;
        for exponent in [0.0, 0.5, 1.0, 5.0, 27.8974, 76.8, 128.0, 1000.0] {
            for i in 1..=60_000_u16 {
                let x = f32::from(i) / 60_000.0;
                let want = libm::pow(f64::from(x), exponent);
                let got = f64::from(Real::power(x, exponent, -24.0));
                if want > libm::exp2(-23.99) {
                    worst = worst.max((got - want).abs() / want);
                } else if want < libm::exp2(-24.01) {
                    assert_eq!(got, 0.0);
                }
            }
        }
        assert!(worst < 3e-6, "{worst:e}");
    }

    #[test]
    fn one_number_and_sixteen_have_the_same_bits() {
        for start in (0..65_536_u32).step_by(16) {
            let x: [f32; 16] = std::array::from_fn(|i| f32::from_bits((start + i as u32) * 16_256));
            for exponent in [5.0, 76.8] {
                let sixteen = powers(&x, exponent, Level::new());
                let one = x.map(|x| Real::power(x, exponent, -10.0).to_bits());
                let cut = sixteen.map(|p| if p > 2_f32.powi(-10) { p.to_bits() } else { 0 });
                assert_eq!(one, cut, "{x:?}");
            }
        }
    }

    #[test]
    fn powers_at_the_borders() {
        for number in [0.0_f32, -1.0, -0.0, f32::NAN] {
            assert_eq!(Real::power(number, 5.0, -24.0), 0.0);
            assert_eq!(Real::power(f64::from(number), 5.0, -24.0).max(0.0), 0.0);
        }
        assert_eq!(Real::power(1.0_f32, 128.0, -24.0), 1.0);
        assert_eq!(Real::power(0.5_f32, 0.0, -24.0), 1.0);
    }

    #[test]
    fn zero_has_no_direction_and_stays_zero() {
        assert_eq!(Triple([0.0_f32; 3]).unit().0, [0.0; 3]);
    }
}

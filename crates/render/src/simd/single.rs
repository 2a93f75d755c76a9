//! Implements [`Real`] in f32: for one number, and for sixteen with the same bits.
//!
//! Powers and reciprocal roots consist of sums, products and integer operations on the bits. These
//! are the same on every processor. They take a fraction of the time of the hardware's square root
//! and division, which would dominate lighting.

use fearless_simd::{
    Bytes as _, Select as _, Simd, SimdBase, SimdFloat as _, SimdInt as _, SimdInto as _, f32x16,
    i32x16,
};

use super::power::Power;
use super::real::Real;

/// An f32 number, or sixteen, that can be split into exponent and mantissa.
trait Single: Real {
    /// Splits a normal number above 0 into m and e with self = m 2^e, m from 1/sqrt 2 to sqrt 2.
    fn split(self) -> (Self, Self);
    /// Computes 2^n for an integer n from -126 to 127.
    fn power_of_two(self) -> Self;
    /// Rounds to the nearest integer, ties to even.
    fn round(self) -> Self;
    /// Returns the number with the bits `from` minus half of the bits of `self`.
    fn halved_from(self, from: i32) -> Self;
    /// Returns `yes` if `self` is a normal number above 0, else 0.
    fn if_normal(self, yes: Self) -> Self;
}

/// A number just above the smallest normal f32.
const SMALLEST: f64 = 1.2e-38;

/// Computes the reciprocal root of a normal number above 0, with a relative error of 1.5e-7.
/// Returns 0 for all other numbers.
///
///   y0 = bits(0x5f1ffff9 - bits(x) / 2)
///   y1 = y0 (1.68191391 - 0.703952253 x y0^2)                  to 6.5e-4
///   y2 = y1 (1 + h/2 + 3 h^2/8),  h = 1 - x y1^2               to 7e-10, and rounding
///
/// The first line halves the logarithm, because the bits of a number approximate its logarithm.
/// Constants of the first two lines: Kadlec, "Improving the fast inverse square root", 2010. The
/// third line is a Householder step of order 3.
#[inline(always)]
fn single_reciprocal_root<R: Single>(x: R) -> R {
    let y = x.halved_from(0x5f1f_fff9);
    let y = y * (x.lift(1.681_913_91) - x * x.lift(0.703_952_253) * (y * y));
    let h = x.lift(1.0) - x * y * y;
    // Numbers without a reciprocal root hold garbage here and get 0.
    x.if_normal(y + y * (h * (x.lift(0.5) + h * x.lift(0.375))))
}

/// x^n, with a relative error of 4e-6 for powers above 2^-24.
#[inline(always)]
fn single_power<R: Single>(x: R, power: &Power) -> R {
    match power.whole {
        Some(n) => whole_power(x, n, power),
        None => any_power(x, x.lift(power.exponent), power),
    }
}

/// x^n by squaring, with n roundings at most.
#[inline(always)]
fn whole_power<R: Single>(x: R, n: u32, power: &Power) -> R {
    // Clamped so that no intermediate result becomes subnormal and the power stays below the floor.
    let mut square = Real::max(x, x.lift(power.clamped));
    let mut result = x.lift(1.0);
    let mut left = n;
    // Exponentiation by squaring: the bits of n select the squares to multiply.
    loop {
        if left & 1 == 1 {
            result = result * square;
        }
        left >>= 1;
        if left == 0 {
            break;
        }
        square = square * square;
    }
    result.if_more(x.lift(power.least), result, x.lift(0.0))
}

/// x^n = 2^(n log2 x).
///
///   x = m 2^e, f = m - 1:   ln m = f - f^2/2 + f^3 P(f)
///
/// with the polynomials of `logf` and `exp2f` in Moshier's Cephes library. Since the error of ln m
/// is relative to ln m, and not to 1, the power is accurate for x near 1 however large n is.
#[inline(always)]
fn any_power<R: Single>(x: R, exponent: R, power: &Power) -> R {
    const EXPONENTIAL: [f64; 7] = [
        1.535_336_188_319_5e-4,
        1.339_887_440_266_574e-3,
        9.618_437_357_674_64e-3,
        5.550_332_471_162_809e-2,
        2.402_264_791_363_012e-1,
        6.931_472_028_550_42e-1,
        1.0,
    ];
    let log2 = binary_logarithm(x) * exponent;
    // Clamped to the exponents of f32; results below the floor are discarded in the end.
    let clamped = Real::max(log2, x.lift(-126.0));
    // 2^whole is exact in the exponent bits, so the polynomial only covers -1/2 to 1/2.
    let whole = clamped.round();
    let result = polynomial(clamped - whole, &EXPONENTIAL) * whole.power_of_two();
    let zero = x.lift(0.0);
    // Comparisons with NaN are false, so NaN gives 0 like numbers that are not positive.
    x.if_more(zero, log2.if_more(x.lift(power.floor), result, zero), zero)
}

/// Computes log2 x of a number above 0, with a relative error of about 1e-7. Subnormal numbers
/// count as the smallest normal number. See [`any_power`].
#[inline(always)]
fn binary_logarithm<R: Single>(x: R) -> R {
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
    let (m, e) = Real::max(x, x.lift(SMALLEST)).split();
    // m is between 1 / sqrt 2 and sqrt 2, so f is at most 0.42 and the polynomial stays short.
    let f = m - x.lift(1.0);
    let square = f * f;
    let ln = f - square * x.lift(0.5) + square * f * polynomial(f, &LOGARITHM);
    ln * x.lift(std::f64::consts::LOG2_E) + e
}

/// Computes log2 of sixteen numbers of at least 1, to within 4e-6; exact for powers of two. With
/// x = 2^e (1 + f), it is e + f + f (1 - f) p(f), with the p of the smallest error.
#[inline(always)]
pub(crate) fn log2<S: Simd>(x: f32x16<S>) -> f32x16<S> {
    const LOGARITHM: [f64; 5] =
        [2.584_145e-2, -9.595_646_1e-2, 1.819_488_84e-1, -2.756_003_13e-1, 4.425_449_44e-1];
    let bits: i32x16<S> = x.bitcast();
    let m: f32x16<S> = ((bits & !EXPONENT_BITS) | ONE_BITS).bitcast();
    // Numbers of at least 1 have no sign bit: the upper bits are the exponent alone.
    let exponent = (bits >> 23) - 127;
    let f = m - 1.0;
    // f (1 - f) vanishes at both ends, so powers of two are exact and the pieces meet there.
    exponent.to_float::<f32x16<S>>() + (f + f * (1.0 - f) * polynomial(f, &LOGARITHM))
}

/// Evaluates a polynomial by Horner's rule, the coefficient of the highest power first.
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
/// The bits of sqrt 2: a larger mantissa is closer to the next power of two.
const SQRT_2_BITS: i32 = 0x3fb5_04f3;

impl Real for f32 {
    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, reason = "rounding to the nearest f32 is meant")]
    fn lift(self, constant: f64) -> Self {
        constant as Self
    }

    #[inline(always)]
    fn if_more(self, than: Self, yes: Self, no: Self) -> Self {
        if self > than { yes } else { no }
    }

    #[inline(always)]
    fn power(self, power: &Power) -> Self {
        single_power(self, power)
    }

    #[inline(always)]
    fn power_times(self, power: &Power, factor: Self) -> Self {
        any_power(self, self.lift(power.exponent) * factor, power)
    }

    #[inline(always)]
    fn reciprocal_root(self) -> Self {
        single_reciprocal_root(self)
    }
}

impl Single for f32 {
    #[inline(always)]
    #[expect(clippy::cast_precision_loss, reason = "an exponent has eight bits")]
    fn split(self) -> (Self, Self) {
        let bits = self.to_bits().cast_signed();
        // The mantissa with the exponent of 1: from 1 to below 2.
        let digits = (bits & !EXPONENT_BITS) | ONE_BITS;
        // Mantissas above sqrt 2 are halved, and the exponent grows by one.
        let up = i32::from(digits > SQRT_2_BITS);
        let m = Self::from_bits((digits - (up << 23)).cast_unsigned());
        (m, ((bits >> 23) - 127 + up) as Self)
    }

    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, reason = "a whole number from -126 to 127")]
    fn power_of_two(self) -> Self {
        // The mantissa of a power of two is 0, and its exponent bits are n + 127.
        Self::from_bits(((self as i32 + 127) << 23).cast_unsigned())
    }

    #[inline(always)]
    fn round(self) -> Self {
        self.round_ties_even()
    }

    #[inline(always)]
    fn halved_from(self, from: i32) -> Self {
        // Negative numbers may overflow here; `if_normal` discards their results.
        Self::from_bits(from.wrapping_sub(self.to_bits().cast_signed() >> 1).cast_unsigned())
    }

    #[inline(always)]
    fn if_normal(self, yes: Self) -> Self {
        if self.is_normal() && self > 0.0 { yes } else { 0.0 }
    }
}

/// Returns whether the processor's maximum of a and b is a if a > b, else b, even for NaN and
/// zeros, as on x86. "Intel 64 and IA-32 Architectures Software Developer's Manual", MAXPS.
#[inline(always)]
pub(super) fn has_own_maximum<S: Simd>(simd: S) -> bool {
    match simd.level() {
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        fearless_simd::Level::Sse2(_)
        | fearless_simd::Level::Sse4_2(_)
        | fearless_simd::Level::Avx2(_)
        | fearless_simd::Level::Avx512(_) => true,
        _ => false,
    }
}

impl<S: Simd> Real for f32x16<S> {
    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, reason = "rounding to the nearest f32 is meant")]
    fn lift(self, constant: f64) -> Self {
        (constant as f32).simd_into(self.simd)
    }

    #[inline(always)]
    fn if_more(self, than: Self, yes: Self, no: Self) -> Self {
        self.simd_gt(than).select(yes, no)
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        if has_own_maximum(self.simd) {
            return <Self as SimdBase<S>>::max(self, other);
        }
        self.if_more(other, self, other)
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        if has_own_maximum(self.simd) {
            return <Self as SimdBase<S>>::min(self, other);
        }
        other.if_more(self, self, other)
    }

    #[inline(always)]
    fn power(self, power: &Power) -> Self {
        single_power(self, power)
    }

    #[inline(always)]
    fn power_times(self, power: &Power, factor: Self) -> Self {
        any_power(self, self.lift(power.exponent) * factor, power)
    }

    #[inline(always)]
    fn reciprocal_root(self) -> Self {
        single_reciprocal_root(self)
    }
}

impl<S: Simd> Single for f32x16<S> {
    #[inline(always)]
    fn split(self) -> (Self, Self) {
        let bits: i32x16<S> = self.bitcast();
        let digits = (bits & !EXPONENT_BITS) | ONE_BITS;
        let zero: i32x16<S> = 0.simd_into(self.simd);
        // Mantissas above sqrt 2 are halved by one step of the exponent bits.
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

    #[inline(always)]
    fn halved_from(self, from: i32) -> Self {
        let bits: i32x16<S> = self.bitcast();
        (i32x16::splat(self.simd, from) - (bits >> 1)).bitcast()
    }

    #[inline(always)]
    fn if_normal(self, yes: Self) -> Self {
        let bits: i32x16<S> = self.bitcast();
        // The bits minus the bits of the smallest normal number: negative if the number is smaller.
        let above = bits - (1 << 23);
        let zero = self.lift(0.0);
        // Infinity and NaN have all exponent bits set, so they are too large.
        let normal = above.simd_ge(0) & above.simd_lt(EXPONENT_BITS - (1 << 23));
        normal.select(yes, zero)
    }
}

#[cfg(test)]
#[expect(clippy::cast_possible_truncation, reason = "small numbers")]
mod tests {
    use crate::simd::level::dispatch;
    use fearless_simd::Level;

    use super::super::vec3::Vec3;
    use super::*;

    fn powers(x: &[f32; 16], exponent: f64, level: Level) -> [f32; 16] {
        let mut out = [0.0; 16];
        dispatch!(level, simd => {
            f32x16::from_slice(simd, x).power(&Power::new(exponent, -24.0)).store_slice(&mut out);
        });
        out
    }

    #[test]
    fn a_power_is_wrong_by_less_than_it_says() {
        let mut worst = 0.0_f64;
        for exponent in [0.0, 0.5, 1.0, 5.0, 27.8974, 32.0, 64.0, 76.8, 128.0, 1000.0] {
            for i in 1..=60_000_u16 {
                let x = f32::from(i) / 60_000.0;
                let want = libm::pow(f64::from(x), exponent);
                let got = f64::from(Real::power(x, &Power::new(exponent, -24.0)));
                if want > libm::exp2(-23.99) {
                    worst = worst.max((got - want).abs() / want);
                } else if want < libm::exp2(-24.01) {
                    assert_eq!(got, 0.0);
                }
            }
        }
        assert!(worst < 4e-6, "{worst:e}");
    }

    #[test]
    fn one_number_and_sixteen_have_the_same_bits() {
        for start in (0..65_536_u32).step_by(16) {
            let x: [f32; 16] = std::array::from_fn(|i| f32::from_bits((start + i as u32) * 16_256));
            for exponent in [5.0, 76.8] {
                let sixteen = powers(&x, exponent, Level::new());
                let one = x.map(|x| Real::power(x, &Power::new(exponent, -10.0)).to_bits());
                let cut = sixteen.map(|p| if p > 2_f32.powi(-10) { p.to_bits() } else { 0 });
                assert_eq!(one, cut, "{x:?}");
            }
        }
    }

    #[test]
    fn powers_at_the_borders() {
        for number in [0.0_f32, -1.0, -0.0, f32::NAN] {
            assert_eq!(Real::power(number, &Power::new(5.0, -24.0)), 0.0);
            assert_eq!(Real::power(f64::from(number), &Power::new(5.0, -24.0)).max(0.0), 0.0);
        }
        assert_eq!(Real::power(1.0_f32, &Power::new(128.0, -24.0)), 1.0);
        assert_eq!(Real::power(0.5_f32, &Power::new(0.0, -24.0)), 1.0);
    }

    #[test]
    fn a_logarithm_is_wrong_by_less_than_it_says() {
        let mut worst = 0.0_f64;
        for exponent in 0..30_u32 {
            for step in (0..1_u32 << 23).step_by(16 * 97) {
                let bits = |lane: usize| ((127 + exponent) << 23) + step + lane as u32;
                let x: [f32; 16] = std::array::from_fn(|lane| f32::from_bits(bits(lane)));
                let mut got = [0.0; 16];
                dispatch!(Level::new(), simd => {
                    log2(f32x16::from_slice(simd, &x)).store_slice(&mut got);
                });
                for (x, got) in x.into_iter().zip(got) {
                    worst = worst.max((f64::from(got) - libm::log2(f64::from(x))).abs());
                }
                if step == 0 {
                    assert_eq!(got[0], exponent as f32);
                }
            }
        }
        assert!(worst < 4e-6, "{worst:e}");
    }

    #[test]
    fn a_reciprocal_root_is_wrong_by_less_than_it_says() {
        let mut worst = 0.0_f64;
        // Every 97th number between two powers of two, which covers all mantissas, and numbers of
        // all magnitudes.
        let digits = (0x3f80_0000..0x4080_0000).step_by(97);
        let sizes = (0x0080_0000..0x7f80_0000).step_by(9_973);
        for x in digits.chain(sizes).map(f32::from_bits) {
            let want = 1.0 / f64::from(x).sqrt();
            worst = worst.max((f64::from(x.reciprocal_root()) - want).abs() / want);
        }
        assert!(worst < 1.5e-7, "{worst:e}");
    }

    #[test]
    fn numbers_without_a_reciprocal_root_give_zero() {
        for x in [0.0, -0.0, -1.0, -1e-40, 1e-40, f32::INFINITY, f32::NEG_INFINITY, f32::NAN] {
            let mut sixteen = [1.0; 16];
            dispatch!(Level::new(), simd => {
                f32x16::splat(simd, x).reciprocal_root().store_slice(&mut sixteen);
            });
            assert_eq!((x.reciprocal_root(), sixteen), (0.0, [0.0; 16]), "{x}");
        }
    }

    #[test]
    fn zero_has_no_direction_and_stays_zero() {
        assert_eq!(Vec3([0.0_f32; 3]).unit().0, [0.0; 3]);
    }
}

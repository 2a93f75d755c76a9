//! A real number, or several of them side by side.
//!
//! Every equation of light is written once, over [`Real`], and compiled twice: for `f64x8`, eight
//! at a time, the reference that pictures are judged by, and for `f32x16`, sixteen at a time, what
//! the editor shows. `f64` and `f32` do to one number what these do to eight and sixteen.
//!
//! There is no fused multiply-add here. It rounds once where `a * b + c` rounds twice, and only
//! some processors have it; without it a picture is the same, bit for bit, on all of them. Nor are
//! the processor's own minimum and maximum used: processors disagree about NaN and about the sign
//! of zero.

use std::ops::{Add, Div, Mul, Neg, Sub};

use super::power::Power;
use super::power_variants;

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
    /// 1 / the square root; 0 if `self` is not more than 0, infinite, NaN or subnormal.
    #[must_use]
    fn reciprocal_root(self) -> Self;
    /// `yes` if `self` is more than `than`, else `no`, also if either is NaN.
    #[must_use]
    fn if_more(self, than: Self, yes: Self, no: Self) -> Self;
    /// The power of `self`, which is from 0 to 1; 0 if it is below the floor, or `self` is 0.
    #[must_use]
    fn power(self, power: &Power) -> Self;
    /// The same with the exponent times `factor`, by the default of the arithmetic.
    #[must_use]
    fn power_times(self, power: &Power, factor: Self) -> Self;

    /// The larger of two numbers; `other` if `self` is NaN.
    #[inline(always)]
    #[must_use]
    fn max(self, other: Self) -> Self {
        self.if_more(other, self, other)
    }

    /// The smaller of two numbers; `other` if `self` is NaN.
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
        power_variants::power(power, self)
    }

    #[inline(always)]
    fn power_times(self, power: &Power, factor: Self) -> Self {
        if self.is_nan() || self <= 0.0 {
            return 0.0;
        }
        let result = libm::pow(self, power.exponent * factor);
        if result > power.least { result } else { 0.0 }
    }
}

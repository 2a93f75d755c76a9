//! A real number, or several of them in lanes.
//!
//! Every equation of light is written once, over [`Real`], and compiled twice: for `f64x8`, the
//! reference that pictures are compared with, and for `f32x16`, used by the editor. `f64` and `f32`
//! apply the same operations to a single number.
//!
//! Fused multiply-add is not used. It rounds once where `a * b + c` rounds twice, and only some
//! processors have it. Without it, a picture is bit for bit the same on all of them. For the same
//! reason the processor's minimum and maximum are not used here: processors disagree about NaN and
//! about the sign of zero.

use std::ops::{Add, Div, Mul, Neg, Sub};

use super::power::{self, Power};

/// A real number, or several of them in lanes.
pub trait Real:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// Repeats a constant in as many lanes as `self` has.
    #[must_use]
    fn lift(self, constant: f64) -> Self;
    /// Computes 1 / the square root. Returns 0 if `self` is not positive, infinite or NaN, or a
    /// subnormal f32.
    #[must_use]
    fn reciprocal_root(self) -> Self;
    /// Returns `yes` if `self` is more than `than`; else, or if either is NaN, `no`.
    #[must_use]
    fn if_more(self, than: Self, yes: Self, no: Self) -> Self;
    /// Returns the power of `self`, which is from 0 to 1; 0 if it is below the floor, or `self` is
    /// 0.
    #[must_use]
    fn power(self, power: &Power) -> Self;
    /// The same with the exponent times `factor`.
    #[must_use]
    fn power_times(self, power: &Power, factor: Self) -> Self;

    /// Returns the larger of two numbers, or `other` if `self` is NaN.
    #[inline(always)]
    #[must_use]
    fn max(self, other: Self) -> Self {
        self.if_more(other, self, other)
    }

    /// Returns the smaller of two numbers, or `other` if `self` is NaN.
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
        power::power(power, self, 1.0)
    }

    #[inline(always)]
    fn power_times(self, power: &Power, factor: Self) -> Self {
        power::power(power, self, factor)
    }
}

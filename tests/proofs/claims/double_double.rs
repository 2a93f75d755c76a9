//! Double-double numbers, about 32 decimal digits: the oracle of arithmetic.
//!
//! A number is the sum of two f64. The second is at most half an ulp of the first.
//! Dekker, "A Floating-Point Technique for Extending the Available Precision", Numerische
//! Mathematik 1971; Knuth, "The Art of Computer Programming", volume 2, section 4.2.2.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// A double-double number.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Double {
    high: f64,
    low: f64,
}

/// a + b exactly: the nearest f64 and the rounding error.
fn two_sum(a: f64, b: f64) -> Double {
    let high = a + b;
    let part = high - a;
    Double { high, low: (a - (high - part)) + (b - part) }
}

/// a b exactly, by splitting the factors into halves of 26 bits.
fn two_product(a: f64, b: f64) -> Double {
    let halves = |x: f64| {
        let shifted = x * 134_217_729.0;
        let high = shifted - (shifted - x);
        (high, x - high)
    };
    let high = a * b;
    let ((a1, a2), (b1, b2)) = (halves(a), halves(b));
    Double { high, low: ((a1 * b1 - high) + a1 * b2 + a2 * b1) + a2 * b2 }
}

impl Double {
    /// One.
    pub(crate) const ONE: Self = Self { high: 1.0, low: 0.0 };
    /// Pi.
    pub(crate) const PI: Self =
        Self { high: std::f64::consts::PI, low: 1.224_646_799_147_353_2e-16 };

    /// The nearest f64.
    #[must_use]
    pub(crate) const fn nearest(self) -> f64 {
        self.high
    }

    /// The absolute value.
    #[must_use]
    pub(crate) fn abs(self) -> Self {
        if self.high < 0.0 { -self } else { self }
    }

    /// The square root of a non-negative number, by one Newton step from the f64 root.
    #[must_use]
    pub(crate) fn sqrt(self) -> Self {
        if self.high <= 0.0 {
            return Self::default();
        }
        let root = Self::from(self.high.sqrt());
        root + (self - root * root) / (root + root)
    }

    /// Sine and cosine of an angle below 1/2, by their Taylor series.
    #[must_use]
    pub(crate) fn sin_cos(self) -> (Self, Self) {
        let (mut sin, mut cos) = (Self::default(), Self::default());
        let mut term = Self::ONE;
        for n in 0..28 {
            // The terms x^n / n! with the signs + + - -.
            let signed = if n % 4 < 2 { term } else { -term };
            let sum = if n % 2 == 0 { &mut cos } else { &mut sin };
            *sum = *sum + signed;
            term = term * self / Self::from(f64::from(n + 1));
        }
        (sin, cos)
    }
}

impl From<f64> for Double {
    fn from(high: f64) -> Self {
        Self { high, low: 0.0 }
    }
}

impl Add for Double {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let (high, low) = (two_sum(self.high, other.high), two_sum(self.low, other.low));
        let sum = two_sum(high.high, high.low + low.high);
        two_sum(sum.high, sum.low + low.low)
    }
}

impl Neg for Double {
    type Output = Self;

    fn neg(self) -> Self {
        Self { high: -self.high, low: -self.low }
    }
}

impl Sub for Double {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Double {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let product = two_product(self.high, other.high);
        let crossed = self.high * other.low + self.low * other.high;
        two_sum(product.high, product.low + crossed)
    }
}

impl Div for Double {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        let first = Self::from(self.high / other.high);
        let rest = self - first * other;
        let second = Self::from(rest.high / other.high);
        let rest = rest - second * other;
        first + second + Self::from(rest.high / other.high)
    }
}

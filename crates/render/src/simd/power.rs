//! The power of a highlight: a cosine to an exponent (its shininess).
//!
//! A power is prepared once per material, so its exponent is examined before any pixel is drawn. In
//! f32, whole exponents up to 64 are reached by squaring, others by a polynomial; in f64, the power
//! function of libm computes one number at a time. Results below the floor count as 0.

/// An exponent, prepared for computing powers with it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Power {
    /// The exponent, at least 0.
    pub(crate) exponent: f64,
    /// A power below 2^`floor` counts as 0. That avoids subnormal numbers, which are slow.
    pub(crate) floor: f64,
    /// 2^`floor`.
    pub(crate) least: f64,
    /// The exponent, if it is an integer that squaring reaches fast.
    pub(crate) whole: Option<u32>,
    /// A number whose power is below the floor, but normal in f32; for integer exponents.
    pub(crate) clamped: f64,
}

impl Power {
    /// The largest exponent that is reached by squaring.
    const LARGEST: u32 = 64;

    /// Prepares powers with an exponent of at least 0, which are 0 below 2^`floor`, with `floor`
    /// from -60 to 0.
    #[must_use]
    pub fn new(exponent: f64, floor: f64) -> Self {
        // An integer exponent takes a few products instead of a logarithm and an exponential.
        let whole = (1..=Self::LARGEST).find(|n| f64::from(*n) == exponent);
        // Its power is at least 2^-126, so still normal, and at most 2^-64, so below any floor.
        let clamped = whole.map_or(0.0, |n| libm::exp2(-f64::from(126 / n)));
        Self { exponent, floor, least: libm::exp2(floor), whole, clamped }
    }
}

/// The largest number whose power is certainly not above 2^`floor`.
pub(crate) fn least_cosine(exponent: f64, floor: f64) -> f64 {
    // With exponent 0, every power is 1, so no cosine can be left out.
    if exponent <= 0.0 { 0.0 } else { libm::exp2(floor / exponent) }
}

/// The power of a number from 0 to 1, with the exponent times `factor`.
#[inline(never)]
pub(crate) fn power(power: &Power, x: f64, factor: f64) -> f64 {
    if x.is_nan() || x <= 0.0 {
        return 0.0;
    }
    let result = libm::pow(x, power.exponent * factor);
    if result > power.least { result } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::Real as _;

    /// The error of powers in f32, in steps of a byte, for the exponent of chrome.
    #[test]
    #[expect(clippy::cast_possible_truncation, reason = "the nearest f32 is meant")]
    fn a_highlight_in_f32_is_within_0_002_of_a_byte_step() {
        let exponent = 76.8;
        let power = Power::new(exponent, -24.0);
        let apart = |i: u32| {
            let x = f64::from(i) / 100_000.0;
            let want = libm::pow(x, exponent);
            assert!((x.power(&power) - want).abs() * 255.0 < 0.0001, "{x}");
            (f64::from((x as f32).power(&power)) - want).abs()
        };
        let worst = 255.0 * (0..=100_000).map(apart).fold(0.0, f64::max);
        assert!(worst < 0.002, "{worst}");
    }

    #[test]
    #[expect(clippy::cast_possible_truncation, reason = "the nearest f32 is meant")]
    fn below_its_least_cosine_a_power_counts_as_nothing() {
        for exponent in [0.0, 0.5, 1.0, 10.0, 64.0, 76.8, 1000.0] {
            let power = Power::new(exponent, -10.0);
            let least = least_cosine(exponent, -10.0) * (1.0 - 1e-5);
            for i in 0..=1000 {
                let x = least * f64::from(i) / 1000.0;
                let powers = (x.power(&power), (x as f32).power(&power));
                assert_eq!(powers, (0.0, 0.0), "{exponent}: {x}");
            }
        }
    }
}

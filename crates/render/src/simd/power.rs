//! The power of a highlight: a cosine to an exponent (its shininess), by each variant.
//!
//! A power is prepared once per material, so its exponent is examined before any pixel is drawn.
//! Results below the floor count as 0 in every variant.

use super::real::Real as _;
use marraztu_core::accuracy::SpecularPower;

/// An exponent, and the variant that computes powers with it.
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
    /// The variant; `None` is the polynomial in f32, and `libm` in f64.
    pub(super) variant: Option<SpecularPower>,
}

impl Power {
    /// The largest exponent that is reached by squaring.
    const LARGEST: u32 = 64;

    /// Prepares powers with an exponent of at least 0, which are 0 below 2^`floor`, with `floor`
    /// from -60 to 0, by the default of the arithmetic.
    #[must_use]
    pub fn new(exponent: f64, floor: f64) -> Self {
        // An integer exponent takes a few products instead of a logarithm and an exponential.
        let whole = (1..=Self::LARGEST).find(|n| f64::from(*n) == exponent);
        // Its power is at least 2^-126, so still normal, and at most 2^-64, so below any floor.
        let clamped = whole.map_or(0.0, |n| libm::exp2(-f64::from(126 / n)));
        Self { exponent, floor, least: libm::exp2(floor), whole, clamped, variant: None }
    }

    /// The same by a variant that the settings choose.
    #[must_use]
    pub(crate) fn by(variant: SpecularPower, exponent: f64, floor: f64) -> Self {
        Self { variant: Some(variant), ..Self::new(exponent, floor) }
    }

    /// Whether it is computed for sixteen numbers at once by the default code.
    #[inline(always)]
    pub(crate) const fn is_default(&self) -> bool {
        matches!(self.variant, None | Some(SpecularPower::Polynomial))
    }
}

/// The largest number whose power is certainly not above 2^`floor`, by a variant.
pub(crate) fn least_cosine(variant: SpecularPower, exponent: f64, floor: f64) -> f64 {
    // With exponent 0, every power is 1, so no cosine can be left out.
    if exponent <= 0.0 {
        return 0.0;
    }
    let least = libm::exp2(floor);
    let cosine = libm::exp2(floor / exponent);
    match variant {
        SpecularPower::Library | SpecularPower::Polynomial => cosine,
        // s = x / (n - n x + x), so x = s n / (1 - s + s n).
        SpecularPower::Schlick => least * exponent / (1.0 - least + least * exponent),
    }
}

/// The power of a number from 0 to 1.
#[inline(never)]
#[expect(clippy::cast_possible_truncation, reason = "32 bits are meant")]
pub(crate) fn power(power: &Power, x: f64) -> f64 {
    if x.is_nan() || x <= 0.0 {
        return 0.0;
    }
    let n = power.exponent;
    let result = match power.variant {
        None | Some(SpecularPower::Library) => libm::pow(x, n),
        Some(SpecularPower::Polynomial) => f64::from((x as f32).power(power)),
        // Schlick, "A Fast Alternative to Phong's Specular Model", Graphics Gems IV, 1994. The
        // approximation is also 0 at 0 and 1 at 1.
        Some(SpecularPower::Schlick) => x / (n - n * x + x),
    };
    if result > power.least { result } else { 0.0 }
}

/// Replaces sixteen numbers by their powers.
#[inline(never)]
#[expect(clippy::cast_possible_truncation, reason = "the nearest f32 is meant")]
pub(crate) fn power_of_sixteen(power: &Power, x: &mut [f32; 16]) {
    if power.variant == Some(SpecularPower::Schlick) {
        // Written in f32, so that the compiler uses vectors.
        let (n, least) = (power.exponent as f32, power.least as f32);
        for x in x.iter_mut() {
            // The maximum turns NaN and negative numbers into 0, which gives the power 0.
            let clamped = x.max(0.0);
            let result = clamped / (n - n * clamped + clamped);
            *x = if result > least { result } else { 0.0 };
        }
    } else {
        for x in x.iter_mut() {
            *x = self::power(power, f64::from(*x)) as f32;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn worst(variant: SpecularPower, exponent: f64) -> f64 {
        let power = Power::by(variant, exponent, -24.0);
        let apart = |i: u32| {
            let x = f64::from(i) / 100_000.0;
            (super::power(&power, x) - libm::pow(x, exponent)).abs()
        };
        255.0 * (0..=100_000).map(apart).fold(0.0, f64::max)
    }

    /// The errors that the table of axes states, in steps of a byte, for the exponent of chrome.
    #[test]
    fn each_way_is_as_wrong_as_the_table_of_axes_says() {
        for (variant, least, most) in [
            (SpecularPower::Library, 0.0, 0.0001),
            (SpecularPower::Polynomial, 0.0, 0.002),
            (SpecularPower::Schlick, 45.0, 52.0),
        ] {
            let worst = worst(variant, 76.8);
            assert!((least..=most).contains(&worst), "{variant:?}: {worst}");
        }
    }

    #[test]
    fn sixteen_numbers_have_the_powers_of_one() {
        let ways = [SpecularPower::Library, SpecularPower::Schlick];
        for variant in ways {
            for exponent in [0.0, 1.0, 32.0, 76.8, 1024.0] {
                let power = Power::by(variant, exponent, -10.0);
                for start in 0..64_u8 {
                    let mut x: [f32; 16] =
                        std::array::from_fn(|i| (f32::from(start) * 16.0 + i as f32) / 1023.0);
                    let want = x.map(|x| super::power(&power, f64::from(x)));
                    power_of_sixteen(&power, &mut x);
                    for (got, want) in x.into_iter().zip(want) {
                        let near = (f64::from(got) - want).abs() < 1e-4 * want.max(0.011);
                        assert!(near, "{variant:?} {exponent}: {got} for {want}");
                    }
                }
            }
        }
    }

    #[test]
    fn below_its_least_cosine_a_power_counts_as_nothing_by_every_way() {
        for variant in [SpecularPower::Library, SpecularPower::Polynomial, SpecularPower::Schlick] {
            for exponent in [0.0, 0.5, 1.0, 10.0, 64.0, 76.8, 1000.0] {
                let power = Power::by(variant, exponent, -10.0);
                let least = least_cosine(variant, exponent, -10.0) * (1.0 - 1e-5);
                for i in 0..=1000 {
                    let x = least * f64::from(i) / 1000.0;
                    assert_eq!(super::power(&power, x), 0.0, "{variant:?} {exponent}: {x}");
                }
            }
        }
    }
}

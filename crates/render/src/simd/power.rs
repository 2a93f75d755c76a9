//! The power of a highlight: a cosine to an exponent (its shininess), by each variant.
//!
//! A power is prepared once per material, so its exponent is examined before any pixel is drawn.
//! Results below the floor count as 0 in every variant.

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
        let whole = (1..=Self::LARGEST).find(|n| f64::from(*n) == exponent);
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

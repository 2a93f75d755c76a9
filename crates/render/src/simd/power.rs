//! The power of a highlight: a cosine to an exponent (its shininess), by each variant.
//!
//! A power is prepared once per material: its exponent is examined and its table is filled before
//! any pixel is drawn. Results below the floor count as 0 in every variant.

use std::sync::Arc;

use marraztu_core::accuracy::SpecularPower;

/// An exponent, and the variant that computes powers with it.
#[derive(Clone, Debug, Default, PartialEq)]
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
    /// The variant.
    pub(super) variant: PowerVariant,
}

/// The variants of powers.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) enum PowerVariant {
    /// The default of the arithmetic.
    #[default]
    Default,
    /// `libm`'s.
    Library,
    /// That of sixteen numbers at once: squarings for integer exponents, else a polynomial.
    Polynomial,
    /// The exponent is two to this power.
    Squarings(u32),
    /// Powers of the numbers i / 255: the nearest is taken.
    Nearest(Arc<[f64]>),
    /// Powers of the numbers i / 1023, with linear interpolation between them.
    Linear(Arc<[f64]>),
    /// x / (n - n x + x): Schlick, "A Fast Alternative to Phong's Specular Model", Graphics Gems
    /// IV, 1994. An approximation that is also 0 at 0 and 1 at 1.
    Schlick,
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
        Self {
            exponent,
            floor,
            least: libm::exp2(floor),
            whole,
            clamped,
            variant: PowerVariant::Default,
        }
    }

    /// The same by a variant that the settings choose. A table that is in `tables` already is
    /// reused.
    #[must_use]
    pub(crate) fn by(
        variant: SpecularPower,
        exponent: f64,
        floor: f64,
        tables: &mut Tables,
    ) -> Self {
        let variant = match variant {
            SpecularPower::Library => PowerVariant::Library,
            SpecularPower::Polynomial => PowerVariant::Polynomial,
            SpecularPower::Squaring => {
                squarings(exponent).map_or(PowerVariant::Polynomial, PowerVariant::Squarings)
            }
            SpecularPower::Table1024 => PowerVariant::Linear(tables.of(exponent, 1024)),
            SpecularPower::Table256 => PowerVariant::Nearest(tables.of(exponent, 256)),
            SpecularPower::Schlick => PowerVariant::Schlick,
        };
        Self { variant, ..Self::new(exponent, floor) }
    }

    /// Whether it is computed for sixteen numbers at once by the default code.
    #[inline(always)]
    pub(crate) const fn is_default(&self) -> bool {
        matches!(self.variant, PowerVariant::Default | PowerVariant::Polynomial)
    }
}

/// k, if n is 2^k.
pub(crate) fn squarings(n: f64) -> Option<u32> {
    (0..=20).find(|k| libm::exp2(f64::from(*k)) == n)
}

/// Tables of powers, by their exponents.
#[derive(Debug, Default)]
pub(crate) struct Tables(Vec<(f64, Arc<[f64]>)>);

impl Tables {
    /// The most tables that are kept: a scene has few materials.
    const MOST: usize = 64;

    #[expect(clippy::cast_precision_loss, reason = "small numbers")]
    fn of(&mut self, exponent: f64, size: usize) -> Arc<[f64]> {
        let is_it = |(other, table): &&(f64, Arc<[f64]>)| *other == exponent && table.len() == size;
        if let Some((_, table)) = self.0.iter().find(is_it) {
            return Arc::clone(table);
        }
        let last = (size - 1) as f64;
        let table: Arc<[f64]> = (0..size).map(|i| libm::pow(i as f64 / last, exponent)).collect();
        if self.0.len() == Self::MOST {
            self.0.clear();
        }
        self.0.push((exponent, Arc::clone(&table)));
        table
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
        SpecularPower::Library | SpecularPower::Polynomial | SpecularPower::Squaring => cosine,
        // Up to one step of the table below.
        SpecularPower::Table1024 | SpecularPower::Table256 => (cosine - 1.0 / 255.0).max(0.0),
        // s = x / (n - n x + x), so x = s n / (1 - s + s n).
        SpecularPower::Schlick => least * exponent / (1.0 - least + least * exponent),
    }
}

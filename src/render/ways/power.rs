//! Powers of cosines, by each way that a highlight may be computed.
//!
//! A power that a material calls for is made ready once: its exponent is looked at, and its table is
//! filled, before any pixel asks. What is below the floor counts as 0 by every way.

use std::sync::Arc;

use crate::scene::SpecularPower;

/// To which power numbers are taken, and how.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Power {
    /// At least 0.
    pub(in crate::render) exponent: f64,
    /// A power below 2^`floor` counts as 0. It keeps subnormal numbers out, and the work with them.
    pub(in crate::render) floor: f64,
    /// 2^`floor`.
    pub(in crate::render) least: f64,
    /// The exponent, where it is a whole number that squaring reaches fast.
    pub(in crate::render) whole: Option<u32>,
    /// A number whose power is below the floor, but normal in 32 bits; where the exponent is whole.
    pub(in crate::render) held: f64,
    /// By which of the rare ways.
    rare: Rare,
}

/// The ways that are not those of the numbers themselves.
#[derive(Clone, Debug, Default, PartialEq)]
enum Rare {
    /// The number's own.
    #[default]
    Own,
    /// `libm`'s.
    Library,
    /// The power of sixteen numbers at once: squarings of whole exponents, a polynomial elsewhere.
    Polynomial,
    /// The exponent is two to this power.
    Squarings(u32),
    /// Powers of the numbers i / 255: the nearest is taken.
    Nearest(Arc<[f64]>),
    /// Powers of the numbers i / 1023: between two of them runs a line.
    Linear(Arc<[f64]>),
    /// x / (n - n x + x): Schlick, "A Fast Alternative to Phong's Specular Model", Graphics Gems IV,
    /// 1994. Another curve, that is 0 at 0 and 1 at 1 too.
    Schlick,
}

impl Power {
    /// The largest exponent that is reached by squaring.
    const LARGEST: u32 = 64;

    /// The power with an exponent of at least 0; 0 where it is below 2^`floor`, from -60 to 0. It is
    /// taken as the numbers do it by themselves.
    #[must_use]
    pub fn new(exponent: f64, floor: f64) -> Self {
        let whole = (1..=Self::LARGEST).find(|n| f64::from(*n) == exponent);
        let held = whole.map_or(0.0, |n| libm::exp2(-f64::from(126 / n)));
        Self { exponent, floor, least: libm::exp2(floor), whole, held, rare: Rare::Own }
    }

    /// The same by a way that settings name. A table that is among `tables` already is used again.
    #[must_use]
    pub(in crate::render) fn by(
        way: SpecularPower,
        exponent: f64,
        floor: f64,
        tables: &mut Tables,
    ) -> Self {
        let rare = match way {
            SpecularPower::Library => Rare::Library,
            SpecularPower::Polynomial => Rare::Polynomial,
            SpecularPower::Squaring => {
                squarings(exponent).map_or(Rare::Polynomial, Rare::Squarings)
            }
            SpecularPower::Table1024 => Rare::Linear(tables.of(exponent, 1024)),
            SpecularPower::Table256 => Rare::Nearest(tables.of(exponent, 256)),
            SpecularPower::Schlick => Rare::Schlick,
        };
        Self { rare, ..Self::new(exponent, floor) }
    }

    /// Whether sixteen numbers take it at once, and do it by themselves.
    #[inline(always)]
    pub(super) const fn is_own(&self) -> bool {
        matches!(self.rare, Rare::Own | Rare::Polynomial)
    }

    /// The power of a number from 0 to 1.
    #[inline(never)]
    pub(super) fn of(&self, x: f64) -> f64 {
        if x.is_nan() || x <= 0.0 {
            return 0.0;
        }
        let n = self.exponent;
        let power = match &self.rare {
            Rare::Own | Rare::Library => libm::pow(x, n),
            Rare::Polynomial => in_32_bits(x, self),
            Rare::Squarings(times) => (0..*times).fold(x, |x, _| x * x),
            Rare::Nearest(table) => nearest(table, x),
            Rare::Linear(table) => linear(table, x),
            Rare::Schlick => x / (n - n * x + x),
        };
        if power > self.least { power } else { 0.0 }
    }

    /// Replaces sixteen numbers by their powers.
    #[inline(never)]
    #[expect(clippy::cast_possible_truncation, reason = "the nearest f32 is meant")]
    pub(super) fn of_sixteen(&self, x: &mut [f32; 16]) {
        let n = self.exponent as f32;
        match &self.rare {
            Rare::Squarings(times) => {
                for x in x.iter_mut() {
                    *x = x.max(0.0);
                }
                // Held, so that nothing becomes subnormal: that is where the time would go.
                for _ in 0..*times {
                    for x in x.iter_mut() {
                        *x = if *x > 1e-18 { *x * *x } else { 0.0 };
                    }
                }
                let least = self.least as f32;
                for x in x.iter_mut() {
                    *x = if *x > least { *x } else { 0.0 };
                }
            }
            Rare::Schlick => {
                let least = self.least as f32;
                for x in x.iter_mut() {
                    let held = x.max(0.0);
                    let power = held / (n - n * held + held);
                    *x = if power > least { power } else { 0.0 };
                }
            }
            _ => {
                for x in x.iter_mut() {
                    *x = self.of(f64::from(*x)) as f32;
                }
            }
        }
    }
}

#[expect(clippy::cast_possible_truncation, reason = "32 bits are meant")]
fn in_32_bits(x: f64, power: &Power) -> f64 {
    use crate::render::numbers::real::Real as _;
    f64::from((x as f32).power(power))
}

/// k, where n is 2^k.
pub(super) fn squarings(n: f64) -> Option<u32> {
    (0..=20).find(|k| libm::exp2(f64::from(*k)) == n)
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from 0 to 255")]
fn nearest(table: &[f64], x: f64) -> f64 {
    table[((x * 255.0 + 0.5) as usize).min(255)]
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_precision_loss,
    reason = "from 0 to 1023"
)]
fn linear(table: &[f64], x: f64) -> f64 {
    let at = x * 1023.0;
    let below = (at as usize).min(1022);
    table[below] + (table[below + 1] - table[below]) * (at - below as f64)
}

/// Tables of powers that were filled, by their exponents.
#[derive(Debug, Default)]
pub(in crate::render) struct Tables(Vec<(f64, Arc<[f64]>)>);

impl Tables {
    /// As many are kept at most: a scene has few materials.
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

/// The largest number whose power is surely not above 2^`floor`, by a way that settings name.
pub(in crate::render) fn least_cosine(way: SpecularPower, exponent: f64, floor: f64) -> f64 {
    if exponent <= 0.0 {
        return 0.0;
    }
    let least = libm::exp2(floor);
    let cosine = libm::exp2(floor / exponent);
    match way {
        SpecularPower::Library | SpecularPower::Polynomial | SpecularPower::Squaring => cosine,
        // Up to a whole step of the table below.
        SpecularPower::Table1024 | SpecularPower::Table256 => (cosine - 1.0 / 255.0).max(0.0),
        // s = x / (n - n x + x), so x = s n / (1 - s + s n).
        SpecularPower::Schlick => least * exponent / (1.0 - least + least * exponent),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn worst(way: SpecularPower, exponent: f64) -> f64 {
        let power = Power::by(way, exponent, -24.0, &mut Tables::default());
        let apart = |i: u32| {
            let x = f64::from(i) / 100_000.0;
            (power.of(x) - libm::pow(x, exponent)).abs()
        };
        255.0 * (0..=100_000).map(apart).fold(0.0, f64::max)
    }

    /// The errors that the table of axes states, in steps of a byte, at the exponent of chrome.
    #[test]
    fn each_way_is_as_wrong_as_the_table_of_axes_says() {
        for (way, least, most) in [
            (SpecularPower::Library, 0.0, 0.0001),
            (SpecularPower::Polynomial, 0.0, 0.002),
            (SpecularPower::Table1024, 0.1, 0.18),
            (SpecularPower::Table256, 30.0, 36.0),
            (SpecularPower::Schlick, 45.0, 52.0),
        ] {
            let worst = worst(way, 76.8);
            assert!((least..=most).contains(&worst), "{way:?}: {worst}");
        }
        // All of it below the floor of 2^-24.
        assert!(worst(SpecularPower::Squaring, 128.0) < 1.6e-5);
        assert!(worst(SpecularPower::Squaring, 76.8) < 0.002, "where it does not apply");
    }

    #[test]
    fn sixteen_numbers_have_the_powers_of_one() {
        let ways = [
            SpecularPower::Library,
            SpecularPower::Table1024,
            SpecularPower::Table256,
            SpecularPower::Squaring,
            SpecularPower::Schlick,
        ];
        for way in ways {
            for exponent in [0.0, 1.0, 32.0, 76.8, 1024.0] {
                let power = Power::by(way, exponent, -10.0, &mut Tables::default());
                for start in 0..64_u8 {
                    let mut x: [f32; 16] =
                        std::array::from_fn(|i| (f32::from(start) * 16.0 + i as f32) / 1023.0);
                    let want = x.map(|x| power.of(f64::from(x)));
                    power.of_sixteen(&mut x);
                    for (got, want) in x.into_iter().zip(want) {
                        let near = (f64::from(got) - want).abs() < 1e-4 * want.max(0.011);
                        assert!(near, "{way:?} {exponent}: {got} for {want}");
                    }
                }
            }
        }
    }

    #[test]
    fn below_its_least_cosine_a_power_counts_as_nothing_by_every_way() {
        for way in [
            SpecularPower::Library,
            SpecularPower::Polynomial,
            SpecularPower::Squaring,
            SpecularPower::Table1024,
            SpecularPower::Table256,
            SpecularPower::Schlick,
        ] {
            for exponent in [0.0, 0.5, 1.0, 10.0, 64.0, 76.8, 1000.0] {
                let power = Power::by(way, exponent, -10.0, &mut Tables::default());
                let least = least_cosine(way, exponent, -10.0) * (1.0 - 1e-5);
                for i in 0..=1000 {
                    let x = least * f64::from(i) / 1000.0;
                    assert_eq!(power.of(x), 0.0, "{way:?} {exponent}: {x}");
                }
            }
        }
    }
}

//! Variants of the power of a highlight: tables, squarings, Schlick's approximation.

use super::power::{Power, PowerVariant};
use super::real::Real as _;

/// The power of a number from 0 to 1.
#[inline(never)]
pub(crate) fn power(power: &Power, x: f64) -> f64 {
    if x.is_nan() || x <= 0.0 {
        return 0.0;
    }
    let n = power.exponent;
    let result = match &power.variant {
        PowerVariant::Default | PowerVariant::Library => libm::pow(x, n),
        PowerVariant::Polynomial => in_32_bits(x, power),
        PowerVariant::Squarings(times) => (0..*times).fold(x, |x, _| x * x),
        PowerVariant::Nearest(table) => nearest(table, x),
        PowerVariant::Linear(table) => linear(table, x),
        PowerVariant::Schlick => x / (n - n * x + x),
    };
    if result > power.least { result } else { 0.0 }
}

/// Replaces sixteen numbers by their powers.
#[inline(never)]
#[expect(clippy::cast_possible_truncation, reason = "the nearest f32 is meant")]
pub(crate) fn power_of_sixteen(power: &Power, x: &mut [f32; 16]) {
    let n = power.exponent as f32;
    match &power.variant {
        PowerVariant::Squarings(times) => {
            for x in x.iter_mut() {
                *x = x.max(0.0);
            }
            // Clamped, so that nothing becomes subnormal, which would be slow.
            for _ in 0..*times {
                for x in x.iter_mut() {
                    *x = if *x > 1e-18 { *x * *x } else { 0.0 };
                }
            }
            let least = power.least as f32;
            for x in x.iter_mut() {
                *x = if *x > least { *x } else { 0.0 };
            }
        }
        PowerVariant::Schlick => {
            let least = power.least as f32;
            for x in x.iter_mut() {
                let clamped = x.max(0.0);
                let result = clamped / (n - n * clamped + clamped);
                *x = if result > least { result } else { 0.0 };
            }
        }
        PowerVariant::Default
        | PowerVariant::Library
        | PowerVariant::Polynomial
        | PowerVariant::Nearest(_)
        | PowerVariant::Linear(_) => {
            for x in x.iter_mut() {
                *x = self::power(power, f64::from(*x)) as f32;
            }
        }
    }
}

#[expect(clippy::cast_possible_truncation, reason = "32 bits are meant")]
fn in_32_bits(x: f64, power: &Power) -> f64 {
    f64::from((x as f32).power(power))
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

#[cfg(test)]
mod tests {
    use super::super::power::{Tables, least_cosine};
    use super::*;
    use marraztu_core::accuracy::SpecularPower;

    fn worst(variant: SpecularPower, exponent: f64) -> f64 {
        let power = Power::by(variant, exponent, -24.0, &mut Tables::default());
        let apart = |i: u32| {
            let x = f64::from(i) / 100_000.0;
            (self::power(&power, x) - libm::pow(x, exponent)).abs()
        };
        255.0 * (0..=100_000).map(apart).fold(0.0, f64::max)
    }

    /// The errors that the table of axes states, in steps of a byte, for the exponent of chrome.
    #[test]
    fn each_way_is_as_wrong_as_the_table_of_axes_says() {
        for (variant, least, most) in [
            (SpecularPower::Library, 0.0, 0.0001),
            (SpecularPower::Polynomial, 0.0, 0.002),
            (SpecularPower::Table1024, 0.1, 0.18),
            (SpecularPower::Table256, 30.0, 36.0),
            (SpecularPower::Schlick, 45.0, 52.0),
        ] {
            let worst = worst(variant, 76.8);
            assert!((least..=most).contains(&worst), "{variant:?}: {worst}");
        }
        // All of that is below the floor of 2^-24.
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
        for variant in ways {
            for exponent in [0.0, 1.0, 32.0, 76.8, 1024.0] {
                let power = Power::by(variant, exponent, -10.0, &mut Tables::default());
                for start in 0..64_u8 {
                    let mut x: [f32; 16] =
                        std::array::from_fn(|i| (f32::from(start) * 16.0 + i as f32) / 1023.0);
                    let want = x.map(|x| self::power(&power, f64::from(x)));
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
        for variant in [
            SpecularPower::Library,
            SpecularPower::Polynomial,
            SpecularPower::Squaring,
            SpecularPower::Table1024,
            SpecularPower::Table256,
            SpecularPower::Schlick,
        ] {
            for exponent in [0.0, 0.5, 1.0, 10.0, 64.0, 76.8, 1000.0] {
                let power = Power::by(variant, exponent, -10.0, &mut Tables::default());
                let least = least_cosine(variant, exponent, -10.0) * (1.0 - 1e-5);
                for i in 0..=1000 {
                    let x = least * f64::from(i) / 1000.0;
                    assert_eq!(self::power(&power, x), 0.0, "{variant:?} {exponent}: {x}");
                }
            }
        }
    }
}

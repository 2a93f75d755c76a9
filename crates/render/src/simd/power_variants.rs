//! Variants of the power of a highlight that are not the default.

use super::power::Power;
use super::real::Real as _;
use marraztu_core::accuracy::SpecularPower;

/// The power of a number from 0 to 1.
#[inline(never)]
pub(crate) fn power(power: &Power, x: f64) -> f64 {
    if x.is_nan() || x <= 0.0 {
        return 0.0;
    }
    let n = power.exponent;
    let result = match power.variant {
        None | Some(SpecularPower::Library) => libm::pow(x, n),
        Some(SpecularPower::Polynomial) => in_32_bits(x, power),
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

#[expect(clippy::cast_possible_truncation, reason = "32 bits are meant")]
fn in_32_bits(x: f64, power: &Power) -> f64 {
    f64::from((x as f32).power(power))
}

#[cfg(test)]
mod tests {
    use super::super::power::least_cosine;
    use super::*;

    fn worst(variant: SpecularPower, exponent: f64) -> f64 {
        let power = Power::by(variant, exponent, -24.0);
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
        for variant in [SpecularPower::Library, SpecularPower::Polynomial, SpecularPower::Schlick] {
            for exponent in [0.0, 0.5, 1.0, 10.0, 64.0, 76.8, 1000.0] {
                let power = Power::by(variant, exponent, -10.0);
                let least = least_cosine(variant, exponent, -10.0) * (1.0 - 1e-5);
                for i in 0..=1000 {
                    let x = least * f64::from(i) / 1000.0;
                    assert_eq!(self::power(&power, x), 0.0, "{variant:?} {exponent}: {x}");
                }
            }
        }
    }
}

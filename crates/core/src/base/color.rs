//! Colours, as bytes and as factors.
//!
//! Colours are display values throughout: a byte from 0 to 255 represents a factor from 0 to 1,
//! without a transfer curve. The exception is light computed in linear sRGB: [`linear`] then
//! decodes colours, and [`encoded`] encodes pictures.

use std::sync::OnceLock;

use serde::{Deserialize, Serialize};

use super::once::get_or_compute;

/// Red, green and blue, each from 0 to 255.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Color(pub [u8; 3]);

impl Color {
    /// Black.
    pub const BLACK: Self = Self([0, 0, 0]);
    /// White.
    pub const WHITE: Self = Self([255, 255, 255]);
    /// The colour of back faces, and of edges of polygons that face away.
    pub const BACK_FACE: Self = Self([255, 0, 0]);

    /// The named colours, as in CSS; gray has two spellings.
    pub const NAMED: [(&str, Self); 10] = [
        ("black", Self::BLACK),
        ("white", Self::WHITE),
        ("gray", Self([128, 128, 128])),
        ("grey", Self([128, 128, 128])),
        ("red", Self([255, 0, 0])),
        ("green", Self([0, 128, 0])),
        ("blue", Self([0, 0, 255])),
        ("yellow", Self([255, 255, 0])),
        ("cyan", Self([0, 255, 255])),
        ("magenta", Self([255, 0, 255])),
    ];

    /// Finds the colour with this name, in upper or lower case.
    pub fn named(name: &str) -> Option<Self> {
        let is_it = |(own, _): &&(&str, Self)| own.eq_ignore_ascii_case(name);
        Self::NAMED.iter().find(is_it).map(|(_, color)| *color)
    }

    /// Returns the factors from 0 to 1 that the bytes represent.
    pub fn factors(self) -> [f64; 3] {
        self.0.map(|byte| f64::from(byte) / 255.0)
    }

    /// Returns the nearest colour to three factors, which are clamped to 0 to 1.
    pub fn from_factors(factors: [f64; 3]) -> Self {
        Self(factors.map(byte))
    }

    /// Returns the colour as an opaque pixel.
    pub fn opaque(self) -> [u8; 4] {
        let [r, g, b] = self.0;
        [r, g, b, 255]
    }
}

/// Returns the byte nearest to 255 times a factor: clamped once, rounded to nearest. NaN gives 0.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped just before")]
pub fn byte(factor: f64) -> u8 {
    // Unlike `clamp`, `max` returns the other number if one is NaN.
    let factor = factor.max(0.0);
    (factor.min(1.0) * 255.0 + 0.5) as u8
}

/// Decodes an sRGB colour to its linear value, from 0 to 1 for values from 0 to 1:
///
///   c / 12.92 up to 0.04045,   ((c + 0.055) / 1.055)^2.4 above
///
/// Values above 1 follow the same curve; NaN and values below 0 give 0. IEC 61966-2-1:1999.
pub fn linear(stored: f64) -> f64 {
    let stored = stored.max(0.0);
    if stored <= 0.04045 { stored / 12.92 } else { libm::pow((stored + 0.055) / 1.055, 2.4) }
}

/// Returns the [`linear`] value of each byte, from 0 to 1.
pub fn linear_factors() -> &'static [f64; 256] {
    static TABLE: OnceLock<[f64; 256]> = OnceLock::new();
    get_or_compute(&TABLE, || std::array::from_fn(|byte| linear(byte as f64 / 255.0)))
}

/// Encodes a linear value as an sRGB colour: the inverse of [`linear`].
pub fn encoded(linear: f64) -> f64 {
    let linear = linear.max(0.0);
    if linear <= 0.003_130_8 {
        12.92 * linear
    } else {
        1.055 * libm::pow(linear, 1.0 / 2.4) - 0.055
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn linear_light_keeps_black_white_and_every_byte() {
        for value in 0..=255_u8 {
            let stored = f64::from(value) / 255.0;
            assert_eq!(byte(encoded(linear(stored))), value);
        }
        assert_eq!((linear(0.0), linear(1.0), encoded(0.0)), (0.0, 1.0, 0.0));
        // From an external source: the middle between black and white light is 188, and 18% grey is
        // 118.
        assert_eq!((byte(encoded(0.5)), byte(encoded(0.18))), (188, 118));
        assert_eq!((linear(f64::NAN), linear(-1.0), encoded(-1.0)), (0.0, 0.0, 0.0));
    }

    #[test]
    fn a_byte_becomes_a_factor_and_the_same_byte_again() {
        for value in 0..=255 {
            let color = Color([value; 3]);
            assert_eq!(Color::from_factors(color.factors()), color);
        }
    }

    #[test]
    fn nan_is_black_and_infinity_is_full() {
        assert_eq!([byte(f64::NAN), byte(f64::INFINITY), byte(f64::NEG_INFINITY)], [0, 255, 0]);
    }
}

//! Combines light with the surface colour, and rounds colours to bytes: by truncating, to the
//! nearest byte, or by ordered dithering.
//!
//! A byte is the integer part of 255 c + t, with a threshold t from 0 to 1: one half rounds to
//! nearest, and 0 truncates. A threshold that varies from pixel to pixel dithers: the fraction
//! decides how often pixels are rounded up, so a smooth gradient stays smooth on average.
//!
//! The pattern: Bayer, "An Optimum Method for Two-Level Rendition of Continuous-Tone Pictures", ICC
//! 1973, of order 8.

use super::colors::{Colors, Form};
use super::fragments::Fragments;
use crate::lights::{Batch, Rows, load, set};
use crate::screen::tiles::BLOCK_PIXELS;
use crate::simd::{BATCH, Encoding, Kernel, Lanes, Number, Vec3};
use marraztu_core::accuracy::Rounding;

/// The surface colour t: one tint, or a texel for each pixel.
#[derive(Clone, Copy, Debug)]
pub(crate) enum SurfaceColor<'a, T> {
    Tint([T; 3]),
    Texels(&'a Rows<T>),
}

impl<T: Number> SurfaceColor<'_, T> {
    #[inline(always)]
    pub(crate) fn at<M: Lanes<Number = T>>(self, lanes: M, at: usize) -> Vec3<M::R> {
        match self {
            Self::Tint(tint) => set(lanes, tint),
            Self::Texels(texels) => load(lanes, texels, at),
        }
    }
}

/// Converts colours to bytes: t D + S + e if the surface is lit, else t + e, with diffuse light D,
/// specular light S and emitted light e; encoded if they are linear. Only `FINISHES` adds e and
/// encodes: most surfaces need a smaller kernel.
pub(crate) struct Quantize<'a, T, const FINISHES: bool> {
    pub(crate) batch: &'a Batch<T>,
    pub(crate) lit: bool,
    pub(crate) own: SurfaceColor<'a, T>,
    /// The emitted light e.
    pub(crate) glow: Option<&'a Rows<T>>,
    /// The rounding threshold of each pixel, if it is not one half.
    pub(crate) thresholds: Option<&'a [T; BATCH]>,
    /// The encoding, if colours are linear.
    pub(crate) encoding: Option<&'a Encoding>,
    pub(crate) colors: &'a mut Colors,
}

impl<T: Number, const FINISHES: bool> Kernel<T> for Quantize<'_, T, FINISHES> {
    #[inline(always)]
    fn run<M: Lanes<Number = T>>(self, lanes: M) {
        let Self { batch, lit, own, glow, mut thresholds, encoding, colors } = self;
        // Linear values are rounded later, when they are summed and encoded.
        if FINISHES && encoding.is_some() && colors.form == Form::Parts {
            thresholds = None;
        }
        for at in (0..batch.len).step_by(M::LANES) {
            let mut color = own.at(lanes, at);
            if lit {
                color = reflected(lanes, color, batch, at);
            }
            if FINISHES && let Some(glow) = glow {
                color = color.plus(load(lanes, glow, at));
            }
            // Bytes are encoded now; fixed-point sums stay linear until they are averaged.
            if FINISHES
                && let Some(encoding) = encoding
                && colors.form == Form::Pixels
            {
                let Vec3([r, g, b]) = color;
                color = Vec3([encoding.of(r), encoding.of(g), encoding.of(b)]);
            }
            match thresholds {
                None => colors.store(lanes, color, at),
                Some(thresholds) => {
                    colors.store_by(lanes, color, lanes.load(thresholds, at), at);
                }
            }
        }
    }
}

/// Computes t D + S at some pixels.
#[inline(always)]
pub(crate) fn reflected<M: Lanes>(
    lanes: M,
    Vec3([tr, tg, tb]): Vec3<M::R>,
    batch: &Batch<M::Number>,
    at: usize,
) -> Vec3<M::R> {
    let Vec3([r, g, b]) = load(lanes, &batch.diffuse, at);
    let specular = load(lanes, &batch.specular, at);
    Vec3([tr * r, tg * g, tb * b]).plus(specular)
}

/// Returns the threshold added to 255 c at a pixel before truncating.
fn threshold(rounding: Rounding, x: i32, y: i32) -> f64 {
    match rounding {
        Rounding::Truncated => 0.0,
        Rounding::Nearest => 0.5,
        Rounding::Dithered => (f64::from(bayer(x & 7, y & 7)) + 0.5) / 64.0,
    }
}

/// Returns the entry of the Bayer matrix at a pixel, from 0 to 63: the bits of x xor y and of y
/// interleaved, the lowest first.
#[expect(clippy::cast_possible_truncation, reason = "the last bits are meant")]
const fn bayer(x: i32, y: i32) -> u8 {
    let (x, y) = ((x ^ y) as u8, y as u8);
    let mut number = 0;
    let mut bit = 0;
    while bit < 3 {
        number = number << 2 | (x >> bit & 1) << 1 | (y >> bit & 1);
        bit += 1;
    }
    number
}

/// The thresholds of a list of fragments. Thresholds that are equal for all lists are cached.
#[derive(Debug)]
pub(crate) struct Thresholds<T> {
    rounding: Option<Rounding>,
    all: [T; BATCH],
}

impl<T: Number> Default for Thresholds<T> {
    fn default() -> Self {
        Self { rounding: None, all: [T::default(); BATCH] }
    }
}

impl<T: Number> Thresholds<T> {
    /// Returns the thresholds of a list.
    pub(crate) fn of(&mut self, rounding: Rounding, fragments: &Fragments) -> &[T; BATCH] {
        if rounding == Rounding::Dithered {
            let pixels = fragments.x.iter().zip(&fragments.y);
            for (to, (x, y)) in self.all.iter_mut().zip(pixels) {
                *to = T::from_f64(threshold(rounding, *x, *y));
            }
        } else if self.rounding != Some(rounding) {
            self.all = [T::from_f64(threshold(rounding, 0, 0)); BATCH];
        }
        self.rounding = Some(rounding);
        &self.all
    }
}

/// Returns the thresholds of a block's pixels, which are the same for every block.
pub(crate) fn block_thresholds(rounding: Rounding) -> [f32; BLOCK_PIXELS] {
    let mut fragments = Fragments::default();
    // The pattern has the size of a block, so the first block serves for all.
    fragments.list_full_block(0, [0; 2]);
    let mut thresholds = Thresholds::default();
    let all = thresholds.of(rounding, &fragments);
    std::array::from_fn(|i| all[i])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_pattern_begins_as_bayer_has_it_and_holds_every_number_once() {
        let row = |y: i32| std::array::from_fn(|x| bayer(i32::try_from(x).unwrap(), y));
        assert_eq!(row(0), [0, 32, 8, 40, 2, 34, 10, 42]);
        assert_eq!(row(1), [48, 16, 56, 24, 50, 18, 58, 26]);
        let mut all: Vec<u8> = (0..8).flat_map(row).collect();
        all.sort_unstable();
        assert!(all.into_iter().eq(0..64));
    }

    #[test]
    fn on_average_a_pattern_gives_the_colour_and_cutting_off_gives_half_a_step_less() {
        let mean = |rounding: Rounding| {
            let bytes = (0..64 * 257).map(|i: i32| {
                let (pixel, color) = (i % 64, f64::from(i / 64) / 257.0);
                let t = threshold(rounding, pixel % 8, pixel / 8);
                (255.0 * color + t).floor() - 255.0 * color
            });
            bytes.sum::<f64>() / f64::from(64 * 257)
        };
        assert!(mean(Rounding::Dithered).abs() < 0.01, "{}", mean(Rounding::Dithered));
        assert!(mean(Rounding::Nearest).abs() < 0.01, "{}", mean(Rounding::Nearest));
        assert!((mean(Rounding::Truncated) + 0.5).abs() < 0.01, "{}", mean(Rounding::Truncated));
    }
}

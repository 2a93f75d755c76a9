//! Colours of a list of fragments: bytes to store, or fixed-point numbers for the MSAA resolve.
//!
//! A pixel that shows one triangle becomes four bytes immediately. A pixel that shows several gets
//! the mean of their colours. Each colour is clamped and kept in units of 2^-16 of a step of a
//! byte, before rounding down, and colours are added as integers. The sum is therefore independent
//! of its order, and the mean of equal colours is the byte that each of them would become.

use std::sync::OnceLock;

use crate::simd::dispatch;
use fearless_simd::Level;

use crate::screen::tiles::BLOCK_PIXELS;
use crate::simd::gather::SLOTS;
use crate::simd::{BATCH, Lanes, Vec3};
use marraztu_core::base::color::linear;
use marraztu_core::base::once::get_or_compute;

/// The format of colours.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Form {
    /// Bytes, to be stored.
    #[default]
    Pixels,
    /// Fixed point, to be added up.
    Parts,
}

/// The colours of a list of pixels.
#[derive(Debug)]
#[repr(align(64))]
pub(crate) struct Colors {
    pub(crate) form: Form,
    /// Whether fixed-point numbers are linear values, which are encoded after summing.
    pub(crate) linear: bool,
    /// Red, green, blue and 255 in memory order.
    pub(crate) pixels: [u32; BATCH],
    /// Red, green and blue, in fixed point.
    parts: [[u32; BATCH]; 3],
}

/// The fractional bits of the fixed-point format.
const BITS: u32 = 16;

impl Default for Colors {
    fn default() -> Self {
        Self { form: Form::Pixels, linear: false, pixels: [0; BATCH], parts: [[0; BATCH]; 3] }
    }
}

impl Colors {
    /// Stores colours, starting at `at`.
    #[inline(always)]
    pub(crate) fn store<M: Lanes>(&mut self, lanes: M, color: Vec3<M::R>, at: usize) {
        match self.form {
            Form::Pixels => lanes.store_pixels(color, &mut self.pixels, at),
            Form::Parts => {
                // Linear values are rounded later, when they are encoded.
                let half = if self.linear { 0.0 } else { 0.5 };
                lanes.store_parts(color, lanes.lift(half), &mut self.parts, at);
            }
        }
    }

    /// Stores colours with a rounding threshold for each instead of one half.
    #[inline(always)]
    pub(crate) fn store_by<M: Lanes>(
        &mut self,
        lanes: M,
        color: Vec3<M::R>,
        threshold: M::R,
        at: usize,
    ) {
        match self.form {
            Form::Pixels => lanes.store_pixels_by(color, threshold, &mut self.pixels, at),
            Form::Parts => lanes.store_parts(color, threshold, &mut self.parts, at),
        }
    }

    /// Sets all colours to one.
    pub(crate) fn fill(&mut self, color: [u8; 4]) {
        match self.form {
            Form::Pixels => self.pixels.fill(u32::from_le_bytes(color)),
            Form::Parts => {
                for (row, byte) in self.parts.iter_mut().zip(color) {
                    row.fill(parts(byte, self.linear));
                }
            }
        }
    }

    /// Sets one colour.
    pub(crate) fn set(&mut self, i: usize, color: [u8; 4]) {
        match self.form {
            Form::Pixels => self.pixels[i] = u32::from_le_bytes(color),
            Form::Parts => {
                for (row, byte) in self.parts.iter_mut().zip(color) {
                    row[i] = parts(byte, self.linear);
                }
            }
        }
    }

    /// Returns one colour in fixed point.
    #[inline(always)]
    pub(crate) fn part(&self, i: usize) -> [u32; 3] {
        let [red, green, blue] = &self.parts;
        let i = i.min(BATCH - 1);
        [red[i], green[i], blue[i]]
    }

    /// Replaces the colours of triangles, one per slot, by the colours of pixels with these slots.
    pub(crate) fn hand_out(&mut self, slots: &[i32]) {
        let hand_out = |row: &mut [u32; BATCH]| {
            // A copy, because pixels overwrite the row that holds the colours of slots.
            let before: [u32; SLOTS] = std::array::from_fn(|slot| row[slot]);
            for (color, slot) in row.iter_mut().zip(slots) {
                *color = before[slot.cast_unsigned() as usize % SLOTS];
            }
        };
        match self.form {
            Form::Pixels => hand_out(&mut self.pixels),
            Form::Parts => self.parts.iter_mut().for_each(hand_out),
        }
    }
}

/// Returns the mean of 2^`log2` opaque pixels, of their light if they are `linear`.
#[inline(always)]
pub(crate) fn mean<'a>(
    pixels: impl Iterator<Item = &'a [u8; 4]>,
    log2: u32,
    linear: bool,
) -> [u8; 4] {
    let mut sums = [0; 3];
    for pixel in pixels {
        for (sum, byte) in sums.iter_mut().zip(pixel) {
            *sum += if linear { parts(*byte, true) } else { u32::from(*byte) };
        }
    }
    let [r, g, b] = sums.map(|sum| {
        // Stored bytes are rounded to nearest by adding half of the divisor.
        let byte =
            if linear { encoded_byte(sum >> log2) } else { (sum + (1 << log2 >> 1)) >> log2 };
        byte.to_le_bytes()[0]
    });
    [r, g, b, 255]
}

/// Converts a byte to fixed point: the middle of its step, or its linear value.
fn parts(byte: u8, linear: bool) -> u32 {
    if linear {
        return linear_parts().of_bytes[usize::from(byte)];
    }
    (u32::from(byte) << BITS) + (1 << (BITS - 1))
}

/// Linear values in fixed point: white is 255 times 2^16.
#[derive(Debug)]
struct LinearParts {
    /// The linear value of each byte.
    of_bytes: [u32; 256],
    /// The smallest value that is encoded as each byte but the first.
    least: [u32; 255],
}

fn linear_parts() -> &'static LinearParts {
    static TABLE: OnceLock<LinearParts> = OnceLock::new();
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::cast_precision_loss,
        reason = "from 0 to 255 x 2^16"
    )]
    get_or_compute(&TABLE, || {
        let parts = |stored: f64| linear(stored / 255.0) * 255.0 * f64::from(1_u32 << BITS);
        LinearParts {
            of_bytes: std::array::from_fn(|byte| parts(byte as f64).round() as u32),
            // The border between two bytes is halfway between them, before decoding.
            least: std::array::from_fn(|byte| parts(byte as f64 + 0.5).ceil() as u32),
        }
    })
}

/// Computes the tables of linear values before drawing, so no thread has to wait for them.
pub(crate) fn prepare_linear() {
    linear_parts();
}

/// Returns the byte that encodes a linear value in fixed point.
fn encoded_byte(value: u32) -> u32 {
    // The number of borders at or below the value is its byte: no power is computed.
    let least = &linear_parts().least;
    u32::try_from(least.partition_point(|least| *least <= value)).unwrap_or(255)
}

/// The colours of a block's pixels, summed over their samples: at most 2^8 samples, each below
/// 2^24.
#[derive(Clone, Debug)]
pub(crate) struct Sums {
    sums: [[u32; 4]; BLOCK_PIXELS],
    /// Whether the sums are sums of linear values.
    linear: bool,
}

impl Sums {
    /// Creates empty sums of stored colours or of linear values.
    pub(crate) const fn new(linear: bool) -> Self {
        Self { sums: [[0; 4]; BLOCK_PIXELS], linear }
    }

    /// Adds a colour to a pixel of the block, weighted by the number of samples that show it.
    #[inline(always)]
    pub(crate) fn add(&mut self, place: usize, color: [u8; 4], samples: i32) {
        let linear = self.linear;
        let sum = &mut self.sums[place % BLOCK_PIXELS];
        for (sum, byte) in sum.iter_mut().zip(color) {
            *sum += parts(byte, linear) * samples.cast_unsigned();
        }
    }

    /// Returns the sum of a pixel.
    pub(crate) const fn parts(&self, place: usize) -> [u32; 3] {
        let [red, green, blue, _] = self.sums[place % BLOCK_PIXELS];
        [red, green, blue]
    }

    /// Adds a colour in fixed point to a pixel.
    #[inline(always)]
    pub(crate) fn add_parts(&mut self, place: usize, color: [u32; 3]) {
        for (sum, part) in self.sums[place % BLOCK_PIXELS].iter_mut().zip(color) {
            *sum += part;
        }
    }

    /// Adds a colour in fixed point to each pixel, weighted by the number of samples that show it.
    pub(crate) fn add_to_all(
        &mut self,
        level: Level,
        parts: &[[u32; 4]; BLOCK_PIXELS],
        samples: &[i32; BLOCK_PIXELS],
    ) {
        dispatch!(level, _ => for ((sum, parts), samples) in
            self.sums.iter_mut().zip(parts).zip(samples)
        {
            for (sum, part) in sum.iter_mut().zip(parts) {
                *sum += part * samples.cast_unsigned();
            }
        });
    }

    /// Adds a colour to every pixel.
    pub(crate) fn add_everywhere(&mut self, color: [u8; 4], samples: i32) {
        let parts = color.map(|byte| parts(byte, self.linear) * samples.cast_unsigned());
        for sum in &mut self.sums {
            for (sum, part) in sum.iter_mut().zip(parts) {
                *sum += part;
            }
        }
    }

    /// Adds the first of some colours, each to its pixel and weighted by its samples.
    #[inline(always)]
    pub(crate) fn add_all(&mut self, colors: &Colors, pixels: &[u8], samples: &[i32]) {
        let [red, green, blue] = &colors.parts;
        for (i, (place, samples)) in pixels.iter().zip(samples).enumerate() {
            let sum = &mut self.sums[usize::from(*place) % BLOCK_PIXELS];
            let samples = samples.cast_unsigned();
            let i = i.min(BATCH - 1);
            sum[0] += red[i] * samples;
            sum[1] += green[i] * samples;
            sum[2] += blue[i] * samples;
        }
    }

    /// Returns the means of 2^`log2` samples as pixels, row by row (MSAA resolve).
    #[inline(always)]
    pub(crate) fn means(&self, log2: u32) -> [u32; BLOCK_PIXELS] {
        // Parts include their rounding threshold, so the shift only truncates.
        let shift = BITS + log2;
        if self.linear {
            return self.sums.map(|[r, g, b, _]| {
                let [r, g, b] = [r, g, b].map(|sum| encoded_byte(sum >> log2));
                r | g << 8 | b << 16 | 255 << 24
            });
        }
        std::array::from_fn(|i| {
            let [r, g, b, _] = self.sums[i];
            r >> shift | (g >> shift) << 8 | (b >> shift) << 16 | 255 << 24
        })
    }
}

#[cfg(test)]
#[expect(clippy::cast_possible_truncation, reason = "below 2^24")]
mod tests {
    use super::*;
    use crate::simd::Sixteen;
    use crate::simd::{Exact, Number};

    /// Colours of both formats, from numbers that are equal for all three channels.
    fn both(numbers: &[f32; BATCH]) -> [Colors; 2] {
        [Form::Pixels, Form::Parts].map(|form| {
            let mut colors = Colors { form, ..Colors::default() };
            dispatch!(Level::new(), simd => {
                let lanes = Sixteen(simd);
                for at in (0..BATCH).step_by(16) {
                    let number = lanes.load(numbers, at);
                    colors.store(lanes, Vec3([number; 3]), at);
                }
            });
            colors
        })
    }

    #[test]
    fn the_mean_of_equal_colours_is_the_byte_that_each_of_them_is() {
        let indices: [u8; BLOCK_PIXELS] = std::array::from_fn(|i| i.to_le_bytes()[0]);
        for round in 0..2000_u16 {
            // Around the borders between two bytes, below 0, above 1, and NaN.
            let numbers: [f32; BATCH] = std::array::from_fn(|i| match (round, i) {
                (0, 0) => f32::NAN,
                (0, _) => i as f32 - 30.0,
                _ => (f32::from(round) * 64.0 + i as f32) / 128_000.0,
            });
            let [pixels, colors] = both(&numbers);
            for (samples, log2) in [(4, 2), (64, 6), (256, 8)] {
                let mut sums = Sums::new(false);
                sums.add_all(&colors, &indices, &[samples / 4; BATCH]);
                sums.add_all(&colors, &indices, &[samples / 4 * 3; BATCH]);
                assert_eq!(sums.means(log2)[..], pixels.pixels[..BLOCK_PIXELS], "{numbers:?}");
            }
            let mut exact = Colors { form: Form::Parts, ..Colors::default() };
            for (i, number) in numbers.iter().enumerate() {
                exact.store(Exact, Vec3([f64::from(*number); 3]), i);
                assert_eq!((exact.parts[0][i] >> BITS) as u8, f64::from(*number).byte());
            }
        }
    }

    #[test]
    fn a_mean_of_linear_values_is_that_of_light_and_each_byte_comes_back() {
        for byte in 0..=255_u8 {
            let mut sums = Sums::new(true);
            sums.add_everywhere([byte; 4], 64);
            assert_eq!(sums.means(6)[5], u32::from_le_bytes([byte, byte, byte, 255]));
        }
        let mut sums = Sums::new(true);
        sums.add_everywhere([0; 4], 2);
        sums.add_everywhere([255; 4], 2);
        assert_eq!(sums.means(2)[0], u32::from_le_bytes([188, 188, 188, 255]));
    }

    #[test]
    fn a_mean_is_that_of_all_bytes_with_halves_rounded_up() {
        for (few, many) in [(0, 255), (17, 18), (255, 254), (3, 3)] {
            for share in 0..=4 {
                let mut sums = Sums::new(false);
                sums.add_everywhere([few; 4], share);
                sums.add_everywhere([many; 4], 4 - share);
                let sum = i32::from(few) * share + i32::from(many) * (4 - share);
                let byte = u8::try_from((sum + 2) / 4).unwrap();
                let want = u32::from_le_bytes([byte, byte, byte, 255]);
                assert!(sums.means(2).iter().all(|mean| *mean == want));
            }
        }
    }
}

//! A cache of colours from earlier passes over a picture.
//!
//! Sixteen and sixty-four samples per pixel are drawn four at a time. Light is evaluated at the
//! centre of a pixel, or at the triangle's point nearest to it. Every pass would therefore compute
//! the same colour for a triangle in a pixel. The colour is cached, and only triangles that earlier
//! passes did not show are lit.

use crate::simd::dispatch;
use fearless_simd::{Level, SimdBase as _, SimdMask as _, u32x16};

use super::colors::Colors;
use crate::screen::tiles::BLOCK_PIXELS;

/// The colour of one triangle for each pixel of a block.
#[derive(Clone, Debug)]
pub(crate) struct Kept {
    /// The triangles' numbers; [`NOTHING`] without a cached colour.
    numbers: [u32; BLOCK_PIXELS],
    /// The colours, in the fixed-point format of [`Colors`].
    parts: [[u32; 4]; BLOCK_PIXELS],
}

/// The number of the background, which is never cached.
const NOTHING: u32 = u32::MAX;

impl Default for Kept {
    fn default() -> Self {
        Self { numbers: [NOTHING; BLOCK_PIXELS], parts: [[0; 4]; BLOCK_PIXELS] }
    }
}

impl Kept {
    /// Returns whether all pixels hold the colour of one triangle.
    pub(crate) fn are_all_of(&self, number: u32) -> bool {
        self.numbers.iter().all(|own| *own == number)
    }

    /// Returns the pixels that hold the colour of the triangle with their number.
    pub(crate) fn known(&self, level: Level, numbers: &[u32; BLOCK_PIXELS]) -> u64 {
        dispatch!(level, simd => {
            let mut known = 0;
            for at in (0..BLOCK_PIXELS).step_by(16) {
                let own = u32x16::from_slice(simd, &self.numbers[at..at + 16]);
                let asked = u32x16::from_slice(simd, &numbers[at..at + 16]);
                let is_nothing = own.simd_eq(NOTHING);
                known |= (own.simd_eq(asked) & !is_nothing).to_bitmask() << at;
            }
            known
        })
    }

    /// Returns the colours of all pixels.
    pub(crate) const fn parts(&self) -> &[[u32; 4]; BLOCK_PIXELS] {
        &self.parts
    }

    /// Caches the colours of some fragments, each in its pixel and for the triangle of its slot.
    pub(crate) fn keep(&mut self, colors: &Colors, pixels: &[u8], slots: &[i32], numbers: &[u32]) {
        for (i, (place, slot)) in pixels.iter().zip(slots).enumerate() {
            let place = usize::from(*place) % BLOCK_PIXELS;
            let [red, green, blue] = colors.part(i);
            self.numbers[place] = numbers[slot.cast_unsigned() as usize % numbers.len()];
            self.parts[place] = [red, green, blue, 0];
        }
    }
}

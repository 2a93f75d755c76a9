//! The colours that earlier passes over a picture have lit.
//!
//! Sixteen and sixty-four samples per pixel are drawn four at a time. Light is evaluated at the
//! centre of a pixel, or at the point of the triangle that is nearest to it, so that every pass
//! would compute the same colour of a triangle in a pixel. It is kept, and only what earlier passes
//! did not show is lit.

use crate::simd::dispatch;
use fearless_simd::{Level, SimdBase as _, SimdMask as _, u32x16};

use super::colors::Colors;
use crate::screen::tiles::BLOCK_PIXELS;

/// For each pixel of a block the colour of one triangle.
#[derive(Clone, Debug)]
pub(crate) struct Kept {
    /// The triangles' numbers; [`NOTHING`] if nothing is kept.
    numbers: [u32; BLOCK_PIXELS],
    /// Their colours in the fixed-point form of [`Colors`].
    parts: [[u32; 4]; BLOCK_PIXELS],
}

/// The number of the background, whose colour is not kept.
const NOTHING: u32 = u32::MAX;

impl Default for Kept {
    fn default() -> Self {
        Self { numbers: [NOTHING; BLOCK_PIXELS], parts: [[0; 4]; BLOCK_PIXELS] }
    }
}

impl Kept {
    /// Whether the colours of all pixels are those of one triangle.
    pub(crate) fn are_all_of(&self, number: u32) -> bool {
        self.numbers.iter().all(|own| *own == number)
    }

    /// The pixels whose colour is that of the triangle with their number.
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

    /// The colours of all pixels.
    pub(crate) const fn parts(&self) -> &[[u32; 4]; BLOCK_PIXELS] {
        &self.parts
    }

    /// Keeps the colours of some fragments, each in its pixel and for the triangle of its slot.
    pub(crate) fn keep(&mut self, colors: &Colors, pixels: &[u8], slots: &[i32], numbers: &[u32]) {
        for (i, (place, slot)) in pixels.iter().zip(slots).enumerate() {
            let place = usize::from(*place) % BLOCK_PIXELS;
            let [red, green, blue] = colors.part(i);
            self.numbers[place] = numbers[slot.cast_unsigned() as usize % numbers.len()];
            self.parts[place] = [red, green, blue, 0];
        }
    }
}

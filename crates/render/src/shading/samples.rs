//! The samples of a block, compared, and the colours kept from earlier passes over a picture.

use crate::simd::{Bits, dispatch};
use fearless_simd::{Level, Simd, SimdBase as _, SimdMask as _, u32x16};

use super::colors::{Colors, Sums};
use crate::raster::entries::keys_and_numbers;
use crate::raster::visibility_buffer::{Plane, number_of};
use crate::screen::sample_positions::MANY;
use crate::screen::tiles::BLOCK_PIXELS;

/// The primitives that the samples of a block's pixels show.
#[derive(Debug)]
pub(crate) struct Samples {
    /// The entries of the first samples.
    pub(crate) first: Plane,
    /// The number of samples that show the same primitive.
    pub(super) shares: [i32; BLOCK_PIXELS],
    /// The other primitives of all pixels.
    pub(super) others: Vec<Other>,
}

/// A primitive that some samples of a pixel show, but not the first.
#[derive(Clone, Copy, Debug)]
pub(super) struct Other {
    pub(super) place: usize,
    pub(super) number: u32,
    /// The number of samples that show it.
    pub(super) share: i32,
}

impl Default for Samples {
    fn default() -> Self {
        Self { first: [0; BLOCK_PIXELS], shares: [0; BLOCK_PIXELS], others: Vec::new() }
    }
}

impl Samples {
    /// Compares the entries of each pixel of a block, which has `count` side by side. Returns
    /// whether each pixel shows a single primitive.
    pub(crate) fn compare(&mut self, level: Level, entries: &[u64], count: usize) -> bool {
        self.others.clear();
        dispatch!(level, simd => match count {
            4 => self.compare_in::<_, 4>(simd, entries),
            _ => self.compare_in::<_, MANY>(simd, entries),
        });
        self.others.is_empty()
    }

    #[inline(always)]
    fn compare_in<S: Simd, const N: usize>(&mut self, simd: S, entries: &[u64]) {
        let pixels: Option<&[_; BLOCK_PIXELS]> = entries.as_chunks::<N>().0.first_chunk();
        let Some(pixels) = pixels else { return };
        // The samples of each pixel that are not listed yet, and the pixels that have any.
        let (mut left, mut next) = ([0; BLOCK_PIXELS], 0);
        for (place, samples) in pixels.iter().enumerate() {
            self.first[place] = samples[0];
            let same = alike(simd, samples, number_of(samples[0]));
            self.shares[place] = same.count_ones().cast_signed();
            left[place] = ((1 << N) - 1) & !same;
            next |= u64::from(left[place] != 0) << place;
        }
        // All pixels' second primitives are listed before the third ones: the number of a pixel's
        // primitives is unpredictable.
        while next != 0 {
            for place in Bits(std::mem::take(&mut next)) {
                let place = place % BLOCK_PIXELS;
                let samples = &pixels[place];
                let number = number_of(samples[left[place].trailing_zeros() as usize % N]);
                let same = alike(simd, samples, number);
                self.others.push(Other { place, number, share: same.count_ones().cast_signed() });
                left[place] &= !same;
                next |= u64::from(left[place] != 0) << place;
            }
        }
    }

    /// Adds the cached colours of earlier passes. Returns the pixels whose first primitive was not
    /// lit in an earlier pass; other primitives that were are removed.
    pub(super) fn add_kept(&mut self, level: Level, kept: &Kept, sums: &mut Sums) -> u64 {
        let known = kept.known(level, &self.first.map(number_of));
        if known != 0 {
            // Pixels without a cached colour get a share of 0 instead of a branch.
            let bit = |place: usize| i32::from(known >> place & 1 == 1);
            let shares = std::array::from_fn(|place| self.shares[place] * bit(place));
            sums.add_to_all(level, kept.parts(), &shares);
        }
        self.others.retain(|other| {
            let Other { place, number, share } = *other;
            let is_known = number != NOTHING && kept.numbers[place] == number;
            if is_known {
                let [red, green, blue, _] = kept.parts[place];
                let parts = [red, green, blue].map(|part| part * share.cast_unsigned());
                sums.add_parts(place, parts);
            }
            !is_known
        });
        !known
    }
}

/// Returns the samples of a pixel that show this primitive, a bit for each.
#[inline(always)]
fn alike<S: Simd, const N: usize>(simd: S, samples: &[u64; N], number: u32) -> u64 {
    if N == MANY {
        return keys_and_numbers(simd, samples).1.simd_eq(number).to_bitmask();
    }
    let bit = |i: usize| u64::from(number_of(samples[i]) == number) << i;
    (0..N).fold(0, |alike, i| alike | bit(i))
}

/// The colour of one triangle for each pixel of a block, from earlier passes over the picture.
///
/// Sixty-four samples per pixel are drawn sixteen at a time. Light is evaluated at the centre of a
/// pixel, or at the triangle's point nearest to it. Every pass would therefore compute
/// the same colour for a triangle in a pixel. The colour is cached, and only triangles that earlier
/// passes did not show are lit.
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
                // Empty entries hold the background's number, which must not match.
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

#[cfg(test)]
#[expect(clippy::cast_possible_truncation, clippy::cast_possible_wrap, reason = "small numbers")]
mod tests {
    use super::*;

    #[test]
    fn every_sample_counts_once_with_the_first_that_shows_the_same() {
        let mut state = 1_u64;
        for round in 0..500 {
            let count = if round % 2 == 0 { 4 } else { MANY };
            let mut entry = || {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                match state >> 62 {
                    0 => 0,
                    number => (state >> 20) << 32 | u64::from(!u32::try_from(number).unwrap()),
                }
            };
            let mut entries: Vec<u64> = (0..count * BLOCK_PIXELS).map(|_| entry()).collect();
            // In some blocks, the samples of a pixel differ only in their depths.
            if round % 10 < 2 {
                for pixel in entries.chunks_mut(count) {
                    let number = pixel[0] & u64::from(u32::MAX);
                    pixel.iter_mut().for_each(|it| *it = *it >> 32 << 32 | number);
                }
            }
            let mut samples = Samples::default();
            let alike = samples.compare(Level::new(), &entries, count);
            let mut want = Vec::new();
            for (place, pixel) in entries.chunks(count).enumerate() {
                let numbers: Vec<u32> = pixel.iter().map(|word| number_of(*word)).collect();
                let shows =
                    |own: u32| numbers.iter().filter(|number| **number == own).count() as i32;
                assert_eq!(samples.first[place], pixel[0]);
                assert_eq!(samples.shares[place], shows(numbers[0]));
                for (sample, own) in numbers.iter().enumerate() {
                    if !numbers[..sample].contains(own) && sample > 0 {
                        want.push((place, *own, shows(*own)));
                    }
                }
            }
            let mut got: Vec<_> =
                samples.others.iter().map(|it| (it.place, it.number, it.share)).collect();
            // Places are listed in rounds, each from the first.
            got.sort_by_key(|(place, ..)| *place);
            assert_eq!(got, want);
            assert_eq!(alike, want.is_empty());
        }
    }
}

//! The positions of samples in a pixel.
//!
//! A sample is the pixel's centre moved by whole subpixels. It shows what the centre would show if
//! all corners were moved the opposite way, so everything that is exact with one sample is exact
//! with several. Up to sixteen samples are drawn in one pass, each group of four around the
//! centre. More samples take several passes, and the MSAA resolve adds their colours.
//!
//! Four and sixteen samples are at Vulkan's "Standard sample locations", multiples of 1/16 pixel;
//! sixty-four and 256 are on a grid of 8 x 8 and 16 x 16.

use fearless_simd::{Simd, SimdBase as _, i32x16};

use crate::screen::coverage::SUBPIXELS;
use crate::screen::tiles::BLOCK;
use marraztu_core::accuracy::Samples;

/// The largest number of samples in a pass. Kernels are compiled for one sample, at the centre, and
/// for several: up to this many.
pub(crate) const MANY: usize = 16;

/// The number of samples in a group around the centre.
const FOUR: usize = 4;

/// The positions of one pass's samples in every pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct SamplePositions {
    /// The offsets of sixteen neighbouring entries of the visibility buffer from the centre of the
    /// first pixel, in subpixels, along x and along y; all 0 if the centre is the only sample. The
    /// first `count` are those of a pixel's samples.
    entries: [[i32; MANY]; 2],
    count: usize,
    /// The smallest and largest offset on each axis.
    least: [i32; 2],
    most: [i32; 2],
}

impl Default for SamplePositions {
    fn default() -> Self {
        Self::MIDDLE
    }
}

#[expect(clippy::cast_possible_truncation, reason = "at most sixteen samples")]
impl SamplePositions {
    /// A single sample at the centre.
    const MIDDLE: Self = Self { entries: [[0; MANY]; 2], count: 1, least: [0; 2], most: [0; 2] };

    /// Creates a pass of groups of four samples, given in `parts` of a pixel from the upper left
    /// corner.
    const fn new(parts: i32, groups: &[[[i32; 2]; FOUR]]) -> Self {
        let count = FOUR * groups.len();
        let mut positions = Self { least: [128; 2], most: [-128; 2], count, ..Self::MIDDLE };
        let mut i = 0;
        while i < 2 * MANY {
            let (entry, axis) = (i / 2, i % 2);
            let (pixel, sample) = (entry / count, entry % count);
            // Positions count from the upper left corner; the centre is at 128 subpixels.
            let shift = groups[sample / FOUR][sample % FOUR][axis] * (256 / parts) - 128;
            // Neighbouring pixels are on the right.
            let from_first = if axis == 0 { pixel as i32 * SUBPIXELS } else { 0 };
            positions.entries[axis][entry] = shift + from_first;
            if shift < positions.least[axis] {
                positions.least[axis] = shift;
            }
            if shift > positions.most[axis] {
                positions.most[axis] = shift;
            }
            i += 1;
        }
        positions
    }

    /// Returns the number of samples.
    pub(crate) const fn count(&self) -> usize {
        self.count
    }

    /// Returns the share of a fragment that all samples of the pass show.
    pub(crate) const fn shares(&self) -> i32 {
        self.count as i32
    }

    /// Returns whether the pass has several samples.
    pub(crate) const fn are_many(&self) -> bool {
        self.count > 1
    }

    /// Returns the number of samples, for a kernel of up to `N` samples.
    #[inline(always)]
    pub(crate) const fn count_in<const N: usize>(&self) -> usize {
        // A constant for one sample.
        if N == 1 { 1 } else { self.count }
    }

    /// Returns the offset of sample `i` from the centre, in subpixels, in a kernel of up to `N`
    /// samples.
    #[inline(always)]
    pub(crate) const fn shift<const N: usize>(&self, i: usize) -> [i32; 2] {
        if N == 1 { [0; 2] } else { self.of_entry(i) }
    }

    /// Returns the number of neighbouring pixels of a row with sixteen samples together; for
    /// several samples.
    #[inline(always)]
    pub(crate) const fn pixels_across(&self) -> i32 {
        (MANY / self.count) as i32
    }

    /// Returns the column and row in a block of the first of [`Self::pixels_across`] pixels.
    #[inline(always)]
    pub(crate) const fn pixel_of(&self, group: usize) -> [i32; 2] {
        let pixel = group as i32 * self.pixels_across();
        [pixel % BLOCK, pixel / BLOCK]
    }

    /// Returns the offset of an entry of the visibility buffer, out of sixteen neighbours, from the
    /// centre of their first pixel, in subpixels.
    #[inline(always)]
    pub(crate) const fn of_entry(&self, lane: usize) -> [i32; 2] {
        let [x, y] = &self.entries;
        [x[lane % MANY], y[lane % MANY]]
    }

    /// Returns the offsets of sixteen entries, along x and along y. See [`Self::of_entry`].
    #[inline(always)]
    pub(crate) fn of_entries<S: Simd>(&self, simd: S) -> [i32x16<S>; 2] {
        let [x, y] = &self.entries;
        [i32x16::from_slice(simd, x), i32x16::from_slice(simd, y)]
    }

    /// Returns the smallest and largest offset on each axis.
    #[inline(always)]
    pub(crate) const fn reach<const N: usize>(&self) -> [[i32; 2]; 2] {
        if N == 1 { [[0; 2]; 2] } else { [self.least, self.most] }
    }
}

/// Returns the passes that draw this number of samples per pixel.
pub(crate) const fn passes(samples: Samples) -> &'static [SamplePositions] {
    match samples {
        Samples::One => &[SamplePositions::MIDDLE],
        Samples::Four => &QUARTERS,
        Samples::Sixteen => &SIXTEEN,
        Samples::SixtyFour => &SIXTY_FOUR,
        Samples::TwoFiftySix => &TWO_FIFTY_SIX,
    }
}

/// Returns the offset of each sample from the centre of its pixel, in subpixels.
pub(crate) fn shifts(samples: Samples) -> impl ExactSizeIterator<Item = [i32; 2]> {
    let passes = passes(samples);
    let count = passes[0].count();
    (0..passes.len() * count).map(move |i| passes[i / count].of_entry(i % count))
}

const QUARTERS: [SamplePositions; 1] =
    [SamplePositions::new(16, &[[[6, 2], [14, 6], [2, 10], [10, 14]]])];

/// Vulkan's sixteen positions, in groups of four around the centre, the nearest first.
const SIXTEEN: [SamplePositions; 1] = [SamplePositions::new(
    16,
    &[
        [[9, 9], [7, 5], [5, 10], [12, 7]],
        [[3, 6], [10, 13], [2, 12], [11, 3]],
        [[6, 14], [8, 1], [4, 2], [13, 11]],
        [[0, 8], [15, 4], [14, 15], [1, 0]],
    ],
)];

/// Grids of 8 x 8 and 16 x 16.
const SIXTY_FOUR: [SamplePositions; 4] = grid(8);
const TWO_FIFTY_SIX: [SamplePositions; 16] = grid(16);

/// Returns a grid of `side` x `side` samples: each position in the upper left quarter with its
/// rotations by quarter turns, the nearest first.
const fn grid<const PASSES: usize>(side: i32) -> [SamplePositions; PASSES] {
    const GROUPS: usize = MANY / FOUR;
    let (mut passes, half, parts) = ([SamplePositions::MIDDLE; PASSES], side / 2, 2 * side);
    let mut groups = [[[0; 2]; FOUR]; GROUPS];
    let mut i = 0;
    while i < half * half {
        // From the centre outwards, so that the nearest samples come first.
        let (x, y) = (side - 1 - 2 * (i % half), side - 1 - 2 * (i / half));
        // Quarter turns keep each group balanced around the centre.
        let at = i as usize;
        groups[at % GROUPS] = [[x, y], [parts - y, x], [parts - x, parts - y], [y, parts - x]];
        if at % GROUPS == GROUPS - 1 {
            passes[at / GROUPS] = SamplePositions::new(parts, &groups);
        }
        i += 1;
    }
    passes
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(samples: Samples) -> Vec<[i32; 2]> {
        shifts(samples).collect()
    }

    #[test]
    fn each_four_lie_around_the_middle() {
        for samples in &Samples::ALL[1..] {
            for shifts in all(*samples).as_chunks::<FOUR>().0 {
                // In every direction, some lie on one side of a line through the centre, some on
                // the other.
                for line in shifts {
                    let sides = shifts.map(|at| line[0] * at[1] - line[1] * at[0]);
                    assert!(sides.iter().any(|side| *side > 0), "{shifts:?}");
                    assert!(sides.iter().any(|side| *side < 0), "{shifts:?}");
                }
            }
        }
    }

    #[test]
    fn sixteen_are_on_sixteen_rows_and_columns_and_more_on_grids() {
        for axis in 0..2 {
            let mut sixteen: Vec<i32> = all(Samples::Sixteen).iter().map(|at| at[axis]).collect();
            sixteen.sort_unstable();
            assert!(sixteen.iter().copied().eq((-8..8).map(|i| 16 * i)), "{sixteen:?}");
        }
        let mut grid = all(Samples::SixtyFour);
        grid.sort_unstable();
        let want = (0..64).map(|i| [i / 8, i % 8].map(|i| 32 * i - 112));
        assert!(grid.iter().copied().eq(want), "{grid:?}");
        let mut grid = all(Samples::TwoFiftySix);
        grid.sort_unstable();
        let want = (0..256).map(|i| [i / 16, i % 16].map(|i| 16 * i - 120));
        assert!(grid.iter().copied().eq(want), "{grid:?}");
    }
}

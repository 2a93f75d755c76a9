//! Where in its pixels a picture is looked at.
//!
//! A sample is the middle of its pixel moved by whole parts of a pixel, so what it shows is what
//! the middle would show if all corners were moved the other way: everything that is exact with one
//! sample is exact with many. Samples are looked at four at a time, each four around the middle;
//! sixteen and sixty-four are four and sixteen passes, whose colours are added up.
//!
//! Four and sixteen lie where Vulkan has them ("Standard sample locations", in multiples of 1/16 of
//! a pixel), sixty-four on a grid of 8 x 8.

use crate::accuracy::Samples;

/// How many samples a pass looks at, where it does not look at the middle alone.
pub(crate) const FOUR: usize = 4;

/// The share of what all samples of a pass show.
pub(crate) const ALL: i32 = 4;

/// What one pass looks at in every pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct SamplePositions {
    /// From the middle, in parts of a pixel; all 0 where that is what is looked at.
    shifts: [[i32; 2]; FOUR],
    /// The least and the largest of them in either direction.
    least: [i32; 2],
    most: [i32; 2],
    many: bool,
}

impl SamplePositions {
    /// The middle alone.
    const MIDDLE: Self = Self { shifts: [[0; 2]; FOUR], least: [0; 2], most: [0; 2], many: false };

    /// Four places, by sixteenths of a pixel from the upper left corner.
    const fn new(sixteenths: [[i32; 2]; FOUR]) -> Self {
        let mut positions = Self { least: [128; 2], most: [-128; 2], many: true, ..Self::MIDDLE };
        let mut i = 0;
        while i < 2 * FOUR {
            let (sample, axis) = (i / 2, i % 2);
            let shift = (sixteenths[sample][axis] - 8) * 16;
            positions.shifts[sample][axis] = shift;
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

    /// How many there are: [`FOUR`], or one.
    pub(crate) const fn count(&self) -> usize {
        if self.many { FOUR } else { 1 }
    }

    /// Whether there are four of them.
    pub(crate) const fn are_many(&self) -> bool {
        self.many
    }

    /// Where sample `i` of `N` lies, in parts of a pixel from the middle.
    #[inline(always)]
    pub(crate) const fn shift<const N: usize>(&self, i: usize) -> [i32; 2] {
        if N == 1 { [0; 2] } else { self.shifts[i % FOUR] }
    }

    /// The least and the largest shifts.
    #[inline(always)]
    pub(crate) const fn reach<const N: usize>(&self) -> [[i32; 2]; 2] {
        if N == 1 { [[0; 2]; 2] } else { [self.least, self.most] }
    }
}

/// The passes that pictures with so many samples are made of.
pub(crate) const fn passes(samples: Samples) -> &'static [SamplePositions] {
    match samples {
        Samples::One => &[SamplePositions::MIDDLE],
        Samples::Four => &QUARTERS,
        Samples::Sixteen => &SIXTEEN,
        Samples::SixtyFour => &SIXTY_FOUR,
    }
}

/// How far each sample of a pixel with so many lies from its middle, in parts of a pixel.
pub(crate) fn shifts(samples: Samples) -> impl ExactSizeIterator<Item = [i32; 2]> {
    let passes = passes(samples);
    let count = passes[0].count();
    (0..passes.len() * count).map(move |i| passes[i / count].shifts[i % count])
}

const QUARTERS: [SamplePositions; 1] = [SamplePositions::new([[6, 2], [14, 6], [2, 10], [10, 14]])];

/// Vulkan's sixteen, in an order in which each four lie around the middle, the nearest first.
const SIXTEEN: [SamplePositions; 4] = [
    SamplePositions::new([[9, 9], [7, 5], [5, 10], [12, 7]]),
    SamplePositions::new([[3, 6], [10, 13], [2, 12], [11, 3]]),
    SamplePositions::new([[6, 14], [8, 1], [4, 2], [13, 11]]),
    SamplePositions::new([[0, 8], [15, 4], [14, 15], [1, 0]]),
];

/// A place of the grid's upper left quarter, and where quarter turns take it; the nearest first.
const SIXTY_FOUR: [SamplePositions; 16] = {
    let mut passes = [SamplePositions::MIDDLE; 16];
    let mut i = 0;
    while i < 16 {
        let (x, y) = (7 - 2 * (i % 4), 7 - 2 * (i / 4));
        passes[i as usize] =
            SamplePositions::new([[x, y], [16 - y, x], [16 - x, 16 - y], [y, 16 - x]]);
        i += 1;
    }
    passes
};

#[cfg(test)]
mod tests {
    use super::*;

    fn all(samples: Samples) -> Vec<[i32; 2]> {
        passes(samples).iter().flat_map(|positions| positions.shifts).collect()
    }

    #[test]
    fn each_four_lie_around_the_middle() {
        for samples in [Samples::Four, Samples::Sixteen, Samples::SixtyFour] {
            for SamplePositions { shifts, .. } in passes(samples) {
                // In every direction, some lie on one side of a line through the middle, some on
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
    fn sixteen_are_on_sixteen_rows_and_columns_and_sixty_four_on_a_grid() {
        for axis in 0..2 {
            let mut sixteen: Vec<i32> = all(Samples::Sixteen).iter().map(|at| at[axis]).collect();
            sixteen.sort_unstable();
            assert!(sixteen.iter().copied().eq((-8..8).map(|i| 16 * i)), "{sixteen:?}");
        }
        let mut grid = all(Samples::SixtyFour);
        grid.sort_unstable();
        let want = (0..64).map(|i| [i / 8, i % 8].map(|i| 32 * i - 112));
        assert!(grid.iter().copied().eq(want), "{grid:?}");
    }
}

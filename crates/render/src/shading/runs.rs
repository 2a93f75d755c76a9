//! The primitives of a block's pixels, and the runs of pixels with the same one.

use crate::simd::{Bits, dispatch};
use fearless_simd::{Level, Simd, SimdBase as _, SimdMask as _, SimdNarrow as _, u32x16, u64x8};

use crate::screen::tiles::{BLOCK, BLOCK_PIXELS};

/// The padding before the first pixel, which gives every pixel a left neighbour.
pub(super) const MARGIN: usize = 16;
const ROW: usize = BLOCK as usize;
// A bit for the first pixel of each row.
const FIRST_COLUMN: u64 = 0x0101_0101_0101_0101;

/// Masks of the pixels that show triangles or lines: bit i is pixel i.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shown {
    pub(crate) triangles: u64,
    pub(crate) lines: u64,
}

/// The primitives of a block's pixels, and the runs along its rows.
#[derive(Debug)]
pub(crate) struct Runs {
    /// The numbers of the primitives, after a margin.
    pub(super) numbers: [u32; MARGIN + BLOCK_PIXELS],
    /// The pixels that show triangles, or the background, or the same as their left neighbour, or
    /// the same as the pixel above.
    pub(super) triangles: u64,
    background: u64,
    pub(super) left: u64,
    above: u64,
}

impl Runs {
    /// Finds the runs of a block.
    pub(crate) fn of(level: Level, visibility: &[u64; BLOCK_PIXELS]) -> Self {
        dispatch!(level, simd => Self::find(simd, visibility))
    }

    #[inline(always)]
    pub(crate) fn find<S: Simd>(simd: S, visibility: &[u64; BLOCK_PIXELS]) -> Self {
        // The background's number belongs to no triangle.
        let mut before = u32x16::splat(simd, u32::MAX);
        let mut numbers = [u32::MAX; MARGIN + BLOCK_PIXELS];
        let (mut triangles, mut background, mut left, mut above) = (0, 0, 0, 0);
        for at in (0..BLOCK_PIXELS).step_by(16) {
            // The lower half of an entry is the inverted number of its primitive.
            let words = |at| u64x8::from_slice(simd, &visibility[at..at + 8]);
            let own = !words(at).narrow(words(at + 8));
            own.store_slice(&mut numbers[MARGIN + at..][..16]);
            // Numbers from 2^31 on are lines, and the last one is the background.
            triangles |= own.simd_lt(1 << 31).to_bitmask() << at;
            background |= own.simd_eq(u32::MAX).to_bitmask() << at;
            // The last lane of the sixteen before, and all but the last lane of these.
            left |= own.simd_eq(before.slide::<15>(own)).to_bitmask() << at;
            above |= own.simd_eq(before.slide::<ROW>(own)).to_bitmask() << at;
            before = own;
        }
        Self { numbers, triangles, background, left, above }
    }

    /// Returns the starts of runs with a triangle that is not in the row above.
    pub(crate) const fn new_starts(&self) -> u64 {
        self.triangles & !self.left & !self.above
    }

    /// Calls `take` with the triangles of runs that are not in the row above.
    #[inline(always)]
    pub(crate) fn each_new(&self, mut take: impl FnMut(u32)) {
        for start in Bits(self.new_starts()) {
            take(self.number(start));
        }
    }

    /// Returns the starts of runs of triangles, in each row of the block.
    pub(super) const fn starts(&self) -> u64 {
        self.triangles & (!self.left | FIRST_COLUMN)
    }

    /// Returns the masks of triangles and lines.
    pub(crate) const fn shown(&self) -> Shown {
        Shown { triangles: self.triangles, lines: !self.triangles & !self.background }
    }

    /// Returns the number of the first triangle.
    pub(crate) const fn first_triangle(&self) -> u32 {
        self.number(self.triangles.trailing_zeros() as usize)
    }

    /// Returns the starts of all runs, in each row of the block.
    pub(crate) const fn starts_in_rows(&self) -> u64 {
        !self.left | FIRST_COLUMN
    }

    /// Returns the number of the primitive at a pixel.
    #[inline(always)]
    pub(crate) const fn number(&self, pixel: usize) -> u32 {
        self.numbers[MARGIN + pixel % BLOCK_PIXELS]
    }
}

//! What the pixels of a block show, and where that changes from pixel to pixel.

use crate::simd::dispatch;
use fearless_simd::{Level, Simd, SimdBase as _, SimdMask as _, SimdNarrow as _, u32x16, u64x8};

use crate::screen::tiles::{BLOCK, BLOCK_PIXELS};

/// Padding before the first pixel, so that every pixel has a left neighbour.
pub(super) const MARGIN: usize = 16;
const ROW: usize = BLOCK as usize;
const FIRST_COLUMN: u64 = 0x0101_0101_0101_0101;

/// Masks of the pixels that show triangles or lines: bit i stands for pixel i.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shown {
    pub(crate) triangles: u64,
    pub(crate) lines: u64,
}

/// What the pixels of a block show, and where along its rows that changes.
#[derive(Debug)]
pub(crate) struct Runs {
    /// The numbers of the primitives, after a margin.
    pub(super) numbers: [u32; MARGIN + BLOCK_PIXELS],
    /// The pixels that show triangles, nothing, the same as their left neighbours, and the same as
    /// those above.
    pub(super) triangles: u64,
    background: u64,
    pub(super) left: u64,
    above: u64,
}

impl Runs {
    /// The runs of a block.
    pub(crate) fn of(level: Level, visibility: &[u64; BLOCK_PIXELS]) -> Self {
        dispatch!(level, simd => Self::find(simd, visibility))
    }

    #[inline(always)]
    pub(crate) fn find<S: Simd>(simd: S, visibility: &[u64; BLOCK_PIXELS]) -> Self {
        // The number of the background is not that of any triangle.
        let mut before = u32x16::splat(simd, u32::MAX);
        let mut numbers = [u32::MAX; MARGIN + BLOCK_PIXELS];
        let (mut triangles, mut background, mut left, mut above) = (0, 0, 0, 0);
        for at in (0..BLOCK_PIXELS).step_by(16) {
            let words = |at| u64x8::from_slice(simd, &visibility[at..at + 8]);
            let own = !words(at).narrow(words(at + 8));
            own.store_slice(&mut numbers[MARGIN + at..][..16]);
            triangles |= own.simd_lt(1 << 31).to_bitmask() << at;
            background |= own.simd_eq(u32::MAX).to_bitmask() << at;
            // The last lane of those before, and all but the last of its own.
            left |= own.simd_eq(before.slide::<15>(own)).to_bitmask() << at;
            above |= own.simd_eq(before.slide::<ROW>(own)).to_bitmask() << at;
            before = own;
        }
        Self { numbers, triangles, background, left, above }
    }

    /// The pixels at which runs of triangles begin that do not show in the row above.
    pub(crate) const fn new_starts(&self) -> u64 {
        self.triangles & !self.left & !self.above
    }

    /// Calls `take` with the triangles of the runs that do not show in the row above.
    #[inline(always)]
    pub(crate) fn each_new(&self, mut take: impl FnMut(u32)) {
        let mut starts = self.new_starts();
        while starts != 0 {
            take(self.number(starts.trailing_zeros() as usize));
            starts &= starts - 1;
        }
    }

    /// The pixels at which runs of triangles begin, in each row of the block.
    pub(super) const fn starts(&self) -> u64 {
        self.triangles & (!self.left | FIRST_COLUMN)
    }

    /// What the block shows.
    pub(crate) const fn shown(&self) -> Shown {
        Shown { triangles: self.triangles, lines: !self.triangles & !self.background }
    }

    /// The number of the first triangle.
    pub(crate) const fn first_triangle(&self) -> u32 {
        self.number(self.triangles.trailing_zeros() as usize)
    }

    /// The pixels at which runs of anything begin, in each row of the block.
    pub(crate) const fn starts_in_rows(&self) -> u64 {
        !self.left | FIRST_COLUMN
    }

    /// The number of the primitive at a pixel.
    #[inline(always)]
    pub(crate) const fn number(&self, pixel: usize) -> u32 {
        self.numbers[MARGIN + pixel % BLOCK_PIXELS]
    }
}

//! Queues of small triangles that wait to be drawn sixteen at a time.

use fearless_simd::{Select as _, Simd, SimdBase as _, SimdMask as _, i32x16, mask32x16};

use super::hits::PACK;

/// The sizes of bounding boxes, in pixels along a side, with a queue each.
pub(crate) const SMALL: [i32; 5] = [1, 2, 4, 8, 16];

/// The numbers stored per triangle: x and y of its corners, their depths, the triangle's number.
pub(crate) const ROWS: usize = 10;

/// Sixteen triangles, row by row.
pub(crate) type Pack<S> = [i32x16<S>; ROWS];

/// A queue of up to [`WAITING`] triangles.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(crate) struct Queue {
    rows: [[i32; WAITING + PACK]; ROWS],
    pub(super) count: usize,
}

/// The largest number of waiting triangles: enough that triangles are read long after their stores.
pub(super) const WAITING: usize = 128;

impl Default for Queue {
    fn default() -> Self {
        let row = [0; WAITING + PACK];
        Self { rows: [row; ROWS], count: 0 }
    }
}

impl Queue {
    /// Adds some of sixteen triangles. Returns whether the queue is full.
    #[inline(always)]
    pub(crate) fn add<S: Simd>(
        &mut self,
        pack: &Pack<S>,
        some: mask32x16<S>,
        count: usize,
    ) -> bool {
        // The count is below WAITING here; the remainder only saves bounds checks.
        let at = self.count % WAITING;
        for (row, values) in self.rows.iter_mut().zip(pack) {
            values.compress(some).store_slice(&mut row[at..at + PACK]);
        }
        self.count = at + count;
        self.count >= WAITING
    }

    /// Returns the number of triangles drawn next.
    #[inline(always)]
    pub(super) fn waiting(&self) -> usize {
        self.count.min(WAITING)
    }

    /// Empties the queue.
    pub(crate) const fn clear(&mut self) {
        self.count = 0;
    }

    /// Returns sixteen triangles, starting at `at`. The last pack is filled up with empty
    /// triangles.
    #[inline(always)]
    pub(super) fn pack<S: Simd>(&self, simd: S, at: usize) -> Pack<S> {
        let mut pack = [i32x16::splat(simd, 0); ROWS];
        for (values, row) in pack.iter_mut().zip(&self.rows) {
            *values = i32x16::from_slice(simd, &row[at..at + PACK]);
        }
        let left = self.waiting() - at;
        if left < PACK {
            let there = mask32x16::from_bitmask(simd, (1 << left) - 1);
            // An empty box holds no pixels.
            let nothing = i32x16::splat(simd, 0);
            for row in &mut pack {
                *row = there.select(*row, nothing);
            }
        }
        pack
    }

    /// Removes up to [`WAITING`] triangles and moves the rest to the front.
    #[inline(always)]
    pub(super) fn forget(&mut self) {
        if self.count < WAITING {
            self.count = 0;
            return;
        }
        // A full queue overflows by fewer than sixteen triangles.
        for row in &mut self.rows {
            let (first, others) = row.split_at_mut(WAITING);
            first[..PACK].copy_from_slice(others);
        }
        self.count -= WAITING;
    }
}

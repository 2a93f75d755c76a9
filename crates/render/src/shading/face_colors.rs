//! The colours of faces that were already lit in the same frame.
//!
//! With light per face, a triangle has the same colour everywhere. A table of the frame, shared by
//! all threads, holds the colours by triangle number. Before a tile is coloured, its triangles that
//! are not in the table are lit, a batch at a time; then its pixels are looked up. No thread waits
//! for another: pixels of a triangle that another thread is about to light are shaded from lists,
//! and if two threads light the same triangle, both compute the same colour.

use std::hint::select_unpredictable;
use std::sync::atomic::{AtomicU32, Ordering};

use prefetch_index::prefetch_index;

use super::full_blocks::ROW;
use crate::screen::tiles::BLOCK_PIXELS;
use crate::simd::Bits;

/// The lowest bit of the mark, stored in place of alpha, that tells the frame of an entry.
const MARK: u32 = 24;

/// The table of a frame.
#[derive(Debug)]
pub(crate) struct FaceColors {
    /// Red, green and blue, and in place of alpha the mark of the frame: an even number if the
    /// colour is known, the odd number below it if some thread is about to light the triangle. The
    /// last entry is a sentinel.
    entries: Vec<AtomicU32>,
    /// The mark of entries with a known colour.
    known: u32,
}

impl Default for FaceColors {
    fn default() -> Self {
        Self { entries: Vec::new(), known: 2 }
    }
}

impl FaceColors {
    /// Begins a frame of this many triangles: invalidates all colours.
    pub(crate) fn begin(&mut self, triangles: usize) {
        self.known += 2;
        // The mark has 8 bits; before it repeats, all entries are dropped.
        if self.known > 0xff || self.entries.capacity() <= triangles {
            *self = Self::default();
        }
        self.entries.resize_with(triangles + 1, AtomicU32::default);
        // The sentinel always counts as known, so it is never claimed.
        *self.entries[triangles].get_mut() = self.known << MARK;
    }

    /// Prefetches a triangle's entry.
    #[inline(always)]
    pub(crate) fn prefetch(&self, number: u32) {
        prefetch_index(&self.entries, number as usize);
    }

    /// Returns whether a triangle has to be lit. If so, later calls for this tile return false.
    ///
    /// Written without a branch, because new triangles are unpredictable.
    #[inline(always)]
    pub(crate) fn claim(&self, number: u32) -> bool {
        let last = self.entries.len() - 1;
        let place = (number as usize).min(last);
        let is_new = self.entries[place].load(Ordering::Relaxed) >> MARK < self.known - 1;
        // The sentinel takes the store if nothing has to be marked.
        let to = select_unpredictable(is_new, place, last);
        self.entries[to].store((self.known - 1) << MARK, Ordering::Relaxed);
        is_new
    }

    /// Sets the colour of a triangle.
    #[inline(always)]
    pub(crate) fn put(&self, number: u32, color: u32) {
        let color = color & ((1 << MARK) - 1) | self.known << MARK;
        self.entries[number as usize].store(color, Ordering::Relaxed);
    }

    /// Looks up the colours of a block's pixels from their entries in the visibility buffer, once
    /// per run of pixels with the same entry: a third of the time of looking up every pixel. No run
    /// that starts at one of `starts` is longer than a row. Pixels without a triangle get
    /// `background`; the last row of `colors` is room for a run. Returns whether all colours are
    /// known.
    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, reason = "the lower half of a word is the number")]
    pub(crate) fn of_block(
        &self,
        (visibility, starts): (&[u64; BLOCK_PIXELS], u64),
        background: u32,
        colors: &mut [u32; BLOCK_PIXELS + ROW],
    ) -> bool {
        let mut unknown = 0;
        for at in Bits(starts) {
            let at = at % BLOCK_PIXELS;
            let word = visibility[at];
            let color = if word == 0 {
                background
            } else {
                // Lines have numbers beyond the table, and count as unknown.
                let entry = self.entries.get(!(word as u32) as usize);
                let entry = entry.map_or(0, |entry| entry.load(Ordering::Relaxed));
                // Checked once at the end: a branch per run would be unpredictable.
                unknown |= (entry >> MARK) ^ self.known;
                entry | 0xff << MARK
            };
            colors[at..][..ROW].fill(color);
        }
        unknown == 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn word(number: u32) -> u64 {
        1 << 62 | u64::from(!number)
    }

    #[test]
    fn colours_are_known_in_their_frame_alone_and_claimed_once() {
        let mut faces = FaceColors::default();
        let visibility = std::array::from_fn(|i| [0, word(7), word(8)][i % 3]);
        let mut colors = [0; BLOCK_PIXELS + ROW];
        for frame in 0..300 {
            faces.begin(9);
            assert!(!faces.of_block((&visibility, u64::MAX), 1, &mut colors), "frame {frame}");
            assert!(faces.claim(7) && !faces.claim(7) && faces.claim(8));
            assert!(!faces.claim(9), "there is no such triangle");
            faces.put(7, 0xff00_0005 + frame);
            assert!(!faces.of_block((&visibility, u64::MAX), 1, &mut colors), "one is not lit yet");
            faces.put(8, 0xff01_0203);
            assert!(!faces.claim(7) && !faces.claim(8));
            assert!(faces.of_block((&visibility, u64::MAX), 1, &mut colors));
            assert_eq!(colors[..4], [1, 0xff00_0005 + frame, 0xff01_0203, 1]);
        }
        faces.begin(20);
        assert!(faces.claim(8) && faces.claim(19));
    }
}

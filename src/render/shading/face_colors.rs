//! The colours of faces that were lit before in the same frame.
//!
//! With light per face, a triangle has the same colour wherever it shows. A table of the frame,
//! which all threads share, holds the colours by the numbers of the triangles. Before a tile is
//! coloured, the triangles that it shows and that are not in the table are lit, as many at a time
//! as a batch holds; then its pixels are looked up. If two threads light the same triangle, both
//! get the same colour.

use std::sync::atomic::{AtomicU32, Ordering};

use crate::render::screen::tiles::BLOCK_PIXELS;

/// The lowest of the bits, those of alpha, that say which frame an entry belongs to.
const MARK: u32 = 24;

/// The table of a frame.
#[derive(Debug)]
pub(crate) struct FaceColors {
    /// Red, green and blue, and in place of alpha the mark of the frame: an even number if the
    /// colour is known, the odd one below it if some thread is about to light the triangle.
    entries: Vec<AtomicU32>,
    /// The mark of entries whose colour is known.
    known: u32,
}

impl Default for FaceColors {
    fn default() -> Self {
        Self { entries: Vec::new(), known: 2 }
    }
}

impl FaceColors {
    /// Begins a frame of this many triangles: forgets all colours.
    pub(crate) fn begin(&mut self, triangles: usize) {
        self.known += 2;
        if self.known > 0xff || self.entries.capacity() < triangles {
            *self = Self::default();
        }
        self.entries.resize_with(triangles, AtomicU32::default);
    }

    /// Whether a triangle has to be lit; if so, no later call for this tile says so again.
    #[inline(always)]
    pub(crate) fn claim(&self, number: u32) -> bool {
        let Some(entry) = self.entries.get(number as usize) else { return false };
        let is_new = entry.load(Ordering::Relaxed) >> MARK < self.known - 1;
        if is_new {
            entry.store((self.known - 1) << MARK, Ordering::Relaxed);
        }
        is_new
    }

    /// Sets the colour of a triangle.
    #[inline(always)]
    pub(crate) fn put(&self, number: u32, color: u32) {
        let color = color & ((1 << MARK) - 1) | self.known << MARK;
        self.entries[number as usize].store(color, Ordering::Relaxed);
    }

    /// Looks up the colours of a block's pixels, from their entries in the visibility buffer; those
    /// that show nothing get `background`. `None` if a colour is not known.
    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, reason = "the lower half of a word is the number")]
    pub(crate) fn of_block(
        &self,
        visibility: &[u64; BLOCK_PIXELS],
        background: u32,
    ) -> Option<[u32; BLOCK_PIXELS]> {
        let mut colors = [background; BLOCK_PIXELS];
        let mut unknown = 0;
        for (color, word) in colors.iter_mut().zip(visibility) {
            if *word != 0 {
                let entry = self.entries.get(!(*word as u32) as usize);
                let entry = entry.map_or(0, |entry| entry.load(Ordering::Relaxed));
                unknown |= (entry >> MARK) ^ self.known;
                *color = entry | 0xff << MARK;
            }
        }
        (unknown == 0).then_some(colors)
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
        for frame in 0..300 {
            faces.begin(9);
            assert!(faces.of_block(&visibility, 1).is_none(), "frame {frame}");
            assert!(faces.claim(7) && !faces.claim(7) && faces.claim(8));
            assert!(!faces.claim(9), "there is no such triangle");
            faces.put(7, 0xff00_0005 + frame);
            assert!(faces.of_block(&visibility, 1).is_none(), "one is not lit yet");
            faces.put(8, 0xff01_0203);
            assert!(!faces.claim(7) && !faces.claim(8));
            let colors = faces.of_block(&visibility, 1).unwrap();
            assert_eq!(colors[..4], [1, 0xff00_0005 + frame, 0xff01_0203, 1]);
        }
        faces.begin(20);
        assert!(faces.claim(8) && faces.claim(19));
    }
}

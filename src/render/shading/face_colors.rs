//! The colours of faces that were lit before in the same frame.
//!
//! With light per face, a face shows in many blocks, and in each it has the same colour. A small
//! table remembers the colours of the faces that were lit last, by the numbers of their triangles;
//! a triangle that has lost its entry to another is lit again, to the same colour.

use crate::render::simd::BATCH;
use crate::render::simd::gather::SLOTS;

/// Entries of the table. Of two triangles with the same entry, the later one has it.
const TABLE: usize = 1024;

/// The table of one thread.
#[derive(Debug)]
pub(crate) struct FaceColors {
    /// The frame; entries of other frames are not valid.
    frame: u32,
    /// The frame above and the triangle's number below, and the colour.
    entries: Box<[(u64, u32); TABLE]>,
}

impl Default for FaceColors {
    fn default() -> Self {
        Self { frame: 1, entries: Box::new([(0, 0); TABLE]) }
    }
}

impl FaceColors {
    /// Begins a frame: forgets all colours.
    pub(crate) fn begin(&mut self) {
        self.frame = self.frame.wrapping_add(1);
        if self.frame == 0 {
            *self = Self::default();
        }
    }

    const fn key(&self, number: u32) -> u64 {
        (self.frame as u64) << 32 | number as u64
    }

    /// Gives the colours of some triangles, if all of them are known.
    pub(crate) fn find(&self, numbers: &[u32]) -> Option<[u32; BATCH]> {
        let mut colors = [0; BATCH];
        for (color, number) in colors.iter_mut().zip(&numbers[..numbers.len().min(SLOTS)]) {
            let (key, known) = self.entries[*number as usize % TABLE];
            if key != self.key(*number) {
                return None;
            }
            *color = known;
        }
        Some(colors)
    }

    /// Remembers the colours of some triangles.
    pub(crate) fn keep(&mut self, numbers: &[u32], colors: &[u32; BATCH]) {
        for (number, color) in numbers.iter().zip(colors) {
            self.entries[*number as usize % TABLE] = (self.key(*number), *color);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_known_until_another_triangle_or_frame_takes_their_place() {
        let mut faces = FaceColors::default();
        let [one, other] = [7, 7 + u32::try_from(TABLE).unwrap()];
        let colors = |color| std::array::from_fn(|_| color);
        assert_eq!(faces.find(&[0]), None);
        faces.keep(&[one, 8], &colors(5));
        assert_eq!(faces.find(&[8, one]).unwrap()[..3], [5, 5, 0]);
        assert_eq!(faces.find(&[one, other]), None);
        faces.keep(&[other], &colors(6));
        assert_eq!((faces.find(&[one]), faces.find(&[other]).unwrap()[0]), (None, 6));
        faces.begin();
        assert_eq!(faces.find(&[8]), None);
        faces.frame = u32::MAX;
        faces.keep(&[8], &colors(9));
        faces.begin();
        assert_eq!(faces.find(&[8]), None);
    }
}

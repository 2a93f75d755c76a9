//! The words of pixels: how near something is, and what it is.
//!
//! One word of 64 bits a pixel: the bits of the depth above, the inverted number of the primitive
//! below. So the larger word is what is seen.

use fearless_simd::Simd;

use crate::render::raster::lines::LineNumber;
use crate::render::screen::sample_positions::FOUR;
use crate::render::screen::tiles::BLOCK_PIXELS;

/// What is seen at a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Visible {
    /// Nothing.
    Background,
    /// A triangle, by its number in the frame.
    Triangle(u32),
    /// A line, by its number in the frame and its colour.
    Line(LineNumber),
}

/// What a word says is seen.
#[inline(always)]
#[expect(clippy::cast_possible_truncation, reason = "the lower half is meant")]
pub(crate) const fn seen(word: u64) -> Visible {
    seen_number(!(word as u32))
}

/// What the number of a primitive says is seen. The background has that of the word 0, which is
/// none of a line.
#[inline(always)]
pub(crate) const fn seen_number(number: u32) -> Visible {
    match LineNumber::of(number) {
        _ if number == u32::MAX => Visible::Background,
        Some(line) => Visible::Line(line),
        None => Visible::Triangle(number),
    }
}

/// What a word says of the depth: its bits, where it is kept as mostly.
pub(crate) const fn key(word: u64) -> u32 {
    (word >> 32) as u32
}

#[inline(always)]
pub(crate) fn word(depth: f32, number: u32) -> u64 {
    u64::from(depth.to_bits()) << 32 | u64::from(!number)
}

/// The words of a block for each of four samples.
pub(crate) type Planes = [[u64; BLOCK_PIXELS]; FOUR];

/// The bits of the least and of the largest depth of the triangles among some words.
#[inline(always)]
#[expect(clippy::cast_possible_truncation, reason = "the lower half is meant")]
pub(crate) fn depths_of<S: Simd>(_: S, visibility: &[u64]) -> [u32; 2] {
    let (mut low, mut high) = (u32::MAX, 0);
    for word in visibility {
        let depth = (*word >> 32) as u32;
        // The numbers of lines are the upper half of all; the background has the lowest word.
        let is_triangle = *word as u32 >> 31 == 1;
        low = low.min(if is_triangle { depth } else { u32::MAX });
        high = high.max(if is_triangle { depth } else { 0 });
    }
    [low, high]
}

//! The visibility buffer: the depth and the primitive of each sample, as an
//! [entry](super::entries).

use fearless_simd::{
    Bytes as _, Select as _, Simd, SimdBase as _, SimdMask as _, f32x16, f64x8, mask32x16, u32x16,
};

use super::depth_format::Format;
use super::lines::LineNumber;
use crate::screen::tiles::BLOCK_PIXELS;

/// The primitive visible at a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Visible {
    /// No primitive.
    Background,
    /// A triangle, by its number in the frame.
    Triangle(u32),
    /// A line, by its number in the frame and its colour.
    Line(LineNumber),
}

/// The number of the background, which has the entry 0.
pub(crate) const BACKGROUND: u32 = u32::MAX;

/// Returns the number of the primitive of an entry.
#[inline(always)]
#[expect(clippy::cast_possible_truncation, reason = "the lower half is meant")]
pub(crate) const fn number_of(word: u64) -> u32 {
    !(word as u32)
}

/// Returns the primitive of an entry.
#[inline(always)]
pub(crate) const fn seen(word: u64) -> Visible {
    seen_number(number_of(word))
}

/// Returns the primitive with a number. The background's number belongs to no line.
#[inline(always)]
pub(crate) const fn seen_number(number: u32) -> Visible {
    match LineNumber::of(number) {
        _ if number == BACKGROUND => Visible::Background,
        Some(line) => Visible::Line(line),
        None => Visible::Triangle(number),
    }
}

/// Runs the depth test on two rows of a block: writes the sixteen entries of a triangle with these
/// depths, in covered pixels that pass the test.
///
/// Entries are compared as f64. Their bits are in the order of the numbers, because keys are below
/// the bits of infinity, and every processor has a maximum of f64.
#[inline(always)]
pub(crate) fn put_rows<S: Simd>(
    format: Format,
    simd: S,
    covered: mask32x16<S>,
    depth: f32x16<S>,
    number: u32,
    visibility: &mut [u64; 16],
) {
    let (upper, lower) = entries(format, simd, covered, depth, number);
    let (up, down) = bytemuck::cast_slice_mut::<u64, f64>(visibility).split_at_mut(8);
    for (new, row) in [(upper, up), (lower, down)] {
        let old = f64x8::from_slice(simd, row);
        new.max(old).store_slice(row);
    }
}

/// Returns a bit mask of the covered pixels, out of sixteen, that pass the depth test. See
/// [`put_rows`].
#[inline(always)]
pub(crate) fn in_front<S: Simd>(
    format: Format,
    simd: S,
    covered: mask32x16<S>,
    depth: f32x16<S>,
    number: u32,
    visibility: &[u64; 16],
) -> u64 {
    let (upper, lower) = entries(format, simd, covered, depth, number);
    let (up, down) = bytemuck::cast_slice::<u64, f64>(visibility).split_at(8);
    let front = |new: f64x8<S>, row: &[f64]| new.simd_gt(f64x8::from_slice(simd, row)).to_bitmask();
    front(upper, up) | front(lower, down) << 8
}

/// Returns entries as f64 for covered pixels, and 0 for all others.
#[inline(always)]
fn entries<S: Simd>(
    format: Format,
    simd: S,
    covered: mask32x16<S>,
    depth: f32x16<S>,
    number: u32,
) -> (f64x8<S>, f64x8<S>) {
    // 0 is the entry of the background, which never passes the depth test.
    let nothing = u32x16::splat(simd, 0);
    let depth = covered.select(format.keys(depth), nothing);
    let number = covered.select(u32x16::splat(simd, !number), nothing);
    let (upper, lower) = number.interleave(depth);
    (upper.bitcast(), lower.bitcast())
}

/// The entries of a block for one sample.
pub(crate) type Plane = [u64; BLOCK_PIXELS];

/// Returns the smallest and largest key of the triangles in the entries of whole blocks.
#[inline(always)]
pub(crate) fn depths_of<S: Simd>(simd: S, visibility: &[u64]) -> [u32; 2] {
    let (none, all) = (u32x16::splat(simd, 0), u32x16::splat(simd, u32::MAX));
    let (mut low, mut high) = (all, none);
    let halves: &[u32] = bytemuck::cast_slice(visibility);
    for sixteen in halves.chunks_exact(32) {
        let upper = u32x16::from_slice(simd, &sixteen[..16]);
        // Numbers stay inverted here, so triangles have the top bit.
        let (number, key) = upper.deinterleave(u32x16::from_slice(simd, &sixteen[16..]));
        // Lines have the upper half of all numbers; the background has the lowest entry.
        let is_triangle = number.simd_ge(1 << 31);
        low = low.min(is_triangle.select(key, all));
        high = high.max(is_triangle.select(key, none));
    }
    [low.reduce_min(), high.reduce_max()]
}

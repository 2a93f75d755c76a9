//! Entries of the visibility buffer.
//!
//! A sample's entry is one 64-bit word: the depth key in the upper half, the inverted number of the
//! primitive in the lower half. The depth test is then a maximum: the larger entry is visible.

use fearless_simd::{Bytes as _, Simd, SimdBase as _, f64x8, u32x16};

/// Returns the entry of a primitive with a key of the depth format.
#[inline(always)]
pub(crate) fn word(key: u32, number: u32) -> u64 {
    u64::from(key) << 32 | u64::from(!number)
}

/// Returns the depth of an entry, as a key of the depth format.
pub(crate) const fn key(word: u64) -> u32 {
    (word >> 32) as u32
}

/// Stores the entries of sixteen primitives with these keys and numbers.
#[inline(always)]
pub(crate) fn put_words<S: Simd>(keys: u32x16<S>, numbers: u32x16<S>, to: &mut [u64]) {
    let [first, last] = halves(keys, numbers);
    let to: &mut [f64] = bytemuck::cast_slice_mut(to);
    first.store_slice(&mut to[..8]);
    last.store_slice(&mut to[8..16]);
}

/// Returns the first eight and the last eight of sixteen entries.
#[inline(always)]
fn halves<S: Simd>(keys: u32x16<S>, numbers: u32x16<S>) -> [f64x8<S>; 2] {
    // Words are little-endian: the number comes before the key.
    let (low, high) = (!numbers).interleave(keys);
    [low.bitcast(), high.bitcast()]
}

/// Returns the keys and numbers of sixteen entries.
#[inline(always)]
pub(crate) fn keys_and_numbers<S: Simd>(simd: S, words: &[u64]) -> (u32x16<S>, u32x16<S>) {
    let halves: &[u32] = bytemuck::cast_slice(words);
    let first = u32x16::from_slice(simd, &halves[..16]);
    let last = u32x16::from_slice(simd, &halves[16..32]);
    let (numbers, keys) = first.deinterleave(last);
    (keys, !numbers)
}

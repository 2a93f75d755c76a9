//! Entries of the visibility buffer.
//!
//! A sample's entry is one 64-bit word: the key of the depth above, the inverted number of the
//! primitive below. So the depth test is a maximum: the larger entry is visible.

use fearless_simd::{Simd, SimdBase as _, u32x16};

/// The entry of a primitive with a key of the depth format.
#[inline(always)]
pub(crate) fn word(key: u32, number: u32) -> u64 {
    u64::from(key) << 32 | u64::from(!number)
}

/// The depth of an entry, as a key of the depth format.
pub(crate) const fn key(word: u64) -> u32 {
    (word >> 32) as u32
}

/// Stores the entries of sixteen primitives with these keys and numbers.
#[inline(always)]
pub(crate) fn put_words<S: Simd>(keys: u32x16<S>, numbers: u32x16<S>, to: &mut [u64]) {
    let (first, last) = (!numbers).interleave(keys);
    let to: &mut [u32] = bytemuck::cast_slice_mut(to);
    first.store_slice(&mut to[..16]);
    last.store_slice(&mut to[16..32]);
}

/// The keys and the numbers of sixteen entries.
#[inline(always)]
pub(crate) fn keys_and_numbers<S: Simd>(simd: S, words: &[u64]) -> (u32x16<S>, u32x16<S>) {
    let halves: &[u32] = bytemuck::cast_slice(words);
    let first = u32x16::from_slice(simd, &halves[..16]);
    let last = u32x16::from_slice(simd, &halves[16..32]);
    let (numbers, keys) = first.deinterleave(last);
    (keys, !numbers)
}

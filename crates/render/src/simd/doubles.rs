//! Converts integers to f64.

use fearless_simd::{Bytes as _, Simd, SimdBase as _, f64x8, i32x16};

/// The upper half of the bits of 2^52 as f64. The bits of 2^52 + n, for n below 2^32, end in n.
const UPPER: i32 = 0x4330_0000;
/// 2^52 + 2^31.
const TO_SIGNED: f64 = 4_503_601_774_854_144.0;

/// Converts sixteen integers to f64. Only AVX-512 has an instruction that converts to eight f64 at
/// once.
#[inline(always)]
pub(crate) fn in_f64<S: Simd>(numbers: i32x16<S>) -> [f64x8<S>; 2] {
    // Flipping the top bit adds 2^31, so the integer is not negative. The subtraction removes it
    // again.
    let (low, high) = (numbers ^ i32::MIN).interleave(i32x16::splat(numbers.simd, UPPER));
    [low.bitcast::<f64x8<S>>() - TO_SIGNED, high.bitcast::<f64x8<S>>() - TO_SIGNED]
}

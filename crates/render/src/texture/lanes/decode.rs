//! Converts the bytes of texels to numbers.

use std::sync::OnceLock;

use fearless_simd::{Simd, SimdBase as _, SimdInt as _, f32x16, i32x16};

use crate::simd::{Real, Vec3};
use marraztu_core::base::color::linear_factors;
use marraztu_core::base::once::get_or_compute;

/// Interpolates: a + (b - a) part.
#[inline(always)]
pub(super) fn between<R: Real>(a: Vec3<R>, b: Vec3<R>, part: R) -> Vec3<R> {
    a.plus(b.minus(a).times(part))
}

/// Unpacks red, green and blue of texels, from 0 to 255.
#[inline(always)]
pub(super) fn channels<S: Simd>(texels: i32x16<S>) -> Vec3<f32x16<S>> {
    Vec3([
        (texels & 255).to_float(),
        ((texels >> 8) & 255).to_float(),
        ((texels >> 16) & 255).to_float(),
    ])
}

/// The conversion from the bytes of texels to numbers.
pub(crate) trait Decode {
    /// Converts texels to red, green and blue, from 0 to 255.
    fn channels<S: Simd>(texels: i32x16<S>) -> Vec3<f32x16<S>>;
}

/// Bytes used as they are stored.
pub(crate) struct Stored;
/// Bytes decoded from sRGB.
pub(crate) struct Linear;

impl Decode for Stored {
    #[inline(always)]
    fn channels<S: Simd>(texels: i32x16<S>) -> Vec3<f32x16<S>> {
        channels(texels)
    }
}

impl Decode for Linear {
    #[inline(always)]
    fn channels<S: Simd>(texels: i32x16<S>) -> Vec3<f32x16<S>> {
        let simd = texels.simd;
        let table = decoded_bytes();
        let texels = <[i32; 16]>::from(texels);
        let mut rows = [[0.0; 16]; 3];
        for (lane, texel) in texels.into_iter().enumerate() {
            let [r, g, b, _] = texel.to_le_bytes();
            rows[0][lane] = table[usize::from(r)];
            rows[1][lane] = table[usize::from(g)];
            rows[2][lane] = table[usize::from(b)];
        }
        Vec3([
            f32x16::from_slice(simd, &rows[0]),
            f32x16::from_slice(simd, &rows[1]),
            f32x16::from_slice(simd, &rows[2]),
        ])
    }
}

/// Returns the table of linear values: 255 times the linear value of each byte.
fn decoded_bytes() -> &'static [f32; 256] {
    static TABLE: OnceLock<[f32; 256]> = OnceLock::new();
    #[expect(clippy::cast_possible_truncation, reason = "the nearest f32 is meant")]
    get_or_compute(&TABLE, || linear_factors().map(|linear| (255.0 * linear) as f32))
}

/// Fills the decoding tables before drawing, so no thread has to wait for them.
pub(crate) fn prepare_decoding() {
    decoded_bytes();
}

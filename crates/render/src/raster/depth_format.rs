//! Depth formats: the key of a depth, which is the upper half of an entry in the visibility buffer.
//!
//! In every format the larger key is the nearer one. Formats with 0 at the near plane are stored as
//! the difference from their largest number. Two depths still get equal keys exactly if they are
//! equal after rounding. All formats round the same depths, sixteen pixels at a time.
//!
//! One step of depth at z 1000, between near 1 and far 2000, is 15.3 units in 16 bits and 0.06 in
//! 24 bits. It is also 0.06 in f32, because the finest steps of f32 lie near 0 and are wasted on
//! the near plane. With reversed depth, 0 at the far plane, it is 5.8e-5. Reed, "Depth Precision
//! Visualized", 2015.

use fearless_simd::{
    Bytes as _, Select as _, Simd, SimdBase as _, SimdFloat as _, SimdInt as _, f32x16, i32x16,
    u32x16,
};

use marraztu_core::accuracy::DepthFormat;

/// The bits of 1.
const ONE: u32 = 1.0_f32.to_bits();

/// The offset of the keys of all formats but the default, so no entry is a subnormal f64.
const FIRST: u32 = 1 << 29;

/// A depth format. Depths are 1 at the near plane and 0 at the far plane.
///
/// Kernels select the format once for sixteen pixels: further kernels for the default alone are up
/// to 3% faster, and are a tenth of the code of all kernels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Format(pub(crate) DepthFormat);

impl Format {
    /// Returns whether keys are the bits of depths.
    #[inline(always)]
    pub(crate) fn keeps_bits(self) -> bool {
        self.0 == DepthFormat::F32Reversed
    }

    /// Returns the additional depth bias of lines in steps of the format, on top of the bias in
    /// default steps.
    #[inline(always)]
    pub(crate) fn lines_nearer(self) -> u32 {
        // The bias in steps of f32 is lost in the rounding to a coarser format.
        if self.keeps_bits() { 0 } else { 2 }
    }

    /// Returns the key of a depth.
    #[inline(always)]
    pub(crate) fn key(self, depth: f32) -> u32 {
        match self.0 {
            DepthFormat::F32Reversed => depth.to_bits(),
            // Rounded like a buffer of 1 - depth, then subtracted to make nearer keys larger.
            DepthFormat::F32 => FIRST + ONE - (1.0 - depth).to_bits(),
            DepthFormat::Bits24 => whole(depth, 24),
            DepthFormat::Bits16 => whole(depth, 16),
        }
    }

    /// Returns the keys of sixteen depths.
    #[inline(always)]
    pub(crate) fn keys<S: Simd>(self, depth: f32x16<S>) -> u32x16<S> {
        match self.0 {
            DepthFormat::F32Reversed => depth.bitcast(),
            DepthFormat::F32 => {
                let one = f32x16::splat(depth.simd, 1.0);
                let all = u32x16::splat(depth.simd, FIRST + ONE);
                all - (one - depth).bitcast::<u32x16<S>>()
            }
            DepthFormat::Bits24 => whole_keys(depth, 24),
            DepthFormat::Bits16 => whole_keys(depth, 16),
        }
    }
}

/// Returns the largest number with this many bits.
const fn largest(bits: u32) -> u32 {
    (1 << bits) - 1
}

/// Returns the key of an integer format: the largest number minus the rounded 1 - depth.
#[inline(always)]
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "up to 2^24")]
fn whole(depth: f32, bits: u32) -> u32 {
    let largest = largest(bits);
    FIRST + largest - ((1.0 - f64::from(depth)) * f64::from(largest)).round() as u32
}

/// Computes the integer keys of sixteen depths. With L = 2^BITS - 1, the key is L - round(L - L d),
/// halves away from 0, which is the smallest integer not less than L d - 1/2. With 2^BITS d = i +
/// f, i an integer and f below 1, that is
///
///   i + 1 if f - 1/2 > d,   i - 1 if f + 1/2 <= d,   else i
///
/// and all of these numbers are exact in f32 whenever they decide.
#[inline(always)]
#[expect(clippy::cast_precision_loss, reason = "a power of two")]
fn whole_keys<S: Simd>(depth: f32x16<S>, bits: u32) -> u32x16<S> {
    let simd = depth.simd;
    // A power of two scales depths exactly, and the fraction is exact, too.
    let all = depth * (1_u32 << bits) as f32;
    let whole: i32x16<S> = all.to_int();
    let rest = all - whole.to_float::<f32x16<S>>();
    let up = (rest - 0.5).simd_gt(depth);
    let down = depth.simd_ge(rest + 0.5);
    let first = i32x16::splat(simd, FIRST.cast_signed());
    let (more, less) = (first + 1, first - 1);
    (whole + up.select(more, down.select(less, first))).bitcast()
}

/// Returns the depth of a key, and its largest error.
#[expect(clippy::cast_possible_truncation, reason = "the nearest f32 is meant")]
fn depth_and_error(format: DepthFormat, key: u32) -> (f32, f32) {
    let part = |bits: u32| {
        let step = 1.0 / f64::from(largest(bits));
        ((f64::from(key.saturating_sub(FIRST)) * step) as f32, step as f32)
    };
    match format {
        DepthFormat::F32Reversed => (f32::from_bits(key), 0.0),
        DepthFormat::F32 => (1.0 - f32::from_bits((FIRST + ONE).saturating_sub(key)), f32::EPSILON),
        DepthFormat::Bits24 => part(24),
        DepthFormat::Bits16 => part(16),
    }
}

/// Returns the depth of a key: 1 at the near plane, 0 at the far plane.
pub(crate) fn depth(format: DepthFormat, key: u32) -> f32 {
    depth_and_error(format, key).0
}

/// Returns bounds of the depths with keys between two keys.
pub(crate) fn depths_between(format: DepthFormat, [low, high]: [u32; 2]) -> [f32; 2] {
    let (low, below) = depth_and_error(format, low);
    let (high, above) = depth_and_error(format, high);
    [(low - below).max(0.0), (high + above).min(1.0)]
}

#[cfg(test)]
#[expect(clippy::cast_possible_truncation, reason = "small numbers")]
mod tests {
    use crate::simd::dispatch;
    use fearless_simd::{Level, SimdBase as _};

    use super::*;
    use marraztu_core::base::rng::Rng;

    fn key(format: DepthFormat, depth: f32) -> u32 {
        Format(format).key(depth)
    }

    /// Returns the distance at which two planes near z = 1000 are always distinguished.
    fn step(format: DepthFormat) -> f64 {
        let (near, far) = (1.0, 2000.0);
        let depth = |z: f64| (near * far / z - near) / (far - near);
        let at = |z: f64| key(format, depth(z) as f32);
        let mut from = 1000.0;
        while at(from) == at(1000.0) {
            from -= 1e-6 * (1000.0 - from).max(1.0);
        }
        let (mut z, first) = (from, at(from));
        while at(z) == first {
            z -= 1e-3 * (from - z).max(1e-3);
        }
        from - z
    }

    #[test]
    fn a_step_of_depth_is_as_wide_as_the_table_of_axes_says() {
        for (format, want) in [
            (DepthFormat::Bits16, 15.3),
            (DepthFormat::Bits24, 0.060),
            (DepthFormat::F32, 0.060),
            (DepthFormat::F32Reversed, 5.8e-5),
        ] {
            let step = step(format);
            assert!((step / want - 1.0).abs() < 0.1, "{format:?}: {step}");
        }
    }

    #[test]
    fn sixteen_depths_have_the_keys_of_one() {
        let mut rng = Rng::new(1);
        for round in 0..20_000_u32 {
            let depths: [f32; 16] = std::array::from_fn(|_| {
                let random = (rng.bits() >> 40) as u32;
                match round % 4 {
                    0 => random as f32 / 16_777_216.0,
                    // Next to a step between two integers.
                    1 => (random % 65_536) as f32 / 65_535.0,
                    2 => (((random % 65_536) as f32 + 0.5) / 65_535.0).min(1.0),
                    // Of every magnitude.
                    _ => f32::from_bits(random % 1024 + (random >> 10) * (ONE / 16_384)).min(1.0),
                }
            });
            for format in [
                DepthFormat::F32Reversed,
                DepthFormat::F32,
                DepthFormat::Bits24,
                DepthFormat::Bits16,
            ] {
                let mut keys = [0; 16];
                dispatch!(Level::new(), simd => {
                    let depths = f32x16::from_slice(simd, &depths);
                    Format(format).keys(depths).store_slice(&mut keys);
                });
                assert_eq!(keys, depths.map(|depth| key(format, depth)), "{format:?} {depths:?}");
            }
        }
    }

    #[test]
    fn keys_of_depths_are_monotonic_and_decode_within_the_error() {
        for (format, error) in [
            (DepthFormat::Bits16, 0.6 / 65_535.0),
            (DepthFormat::Bits24, 6e-8),
            (DepthFormat::F32, 6e-8),
            (DepthFormat::F32Reversed, 0.0),
        ] {
            let mut last = 0;
            for i in 0..=100_000_u32 {
                let it = i as f32 / 100_000.0;
                let own = key(format, it);
                assert!(own >= last, "{format:?} {it}");
                assert!((depth(format, own) - it).abs() <= error, "{format:?} {it}");
                let [low, high] = depths_between(format, [own; 2]);
                assert!(low <= it && it <= high, "{format:?} {it}: {low} to {high}");
                last = own;
            }
        }
    }
}

//! Depth formats: the upper half of a pixel's entry in the visibility buffer.
//!
//! In every format the larger key is the nearer. Formats in which 0 is near are stored as the
//! difference from their largest number, which keeps exactly those depths equal that are equal
//! after rounding.
//!
//! One step of depth at z 1000, between near 1 and far 2000, is 15.3 units in 16 bits, 0.06 in 24,
//! and 0.06 in f32 too, whose finest steps are near 0 and wasted on the near plane; with reversed
//! depth, 0 at the far plane, it is 5.8e-5. Reed, "Depth Precision Visualized", 2015.

use crate::accuracy::DepthFormat;

/// The bits of 1.
const ONE: u32 = 1.0_f32.to_bits();

/// The largest integer of some bits.
const fn largest(bits: u32) -> u32 {
    (1 << bits) - 1
}

/// The key of a depth that is 1 at the near plane and 0 at the far one.
pub(crate) fn key(format: DepthFormat, depth: f32) -> u32 {
    match format {
        DepthFormat::F32Reversed => depth.to_bits(),
        DepthFormat::F32 => ONE - (1.0 - depth).to_bits(),
        DepthFormat::Bits24 => whole(depth, 24),
        DepthFormat::Bits16 => whole(depth, 16),
    }
}

/// The depth of a key, 1 at the near plane and 0 at the far one.
#[expect(clippy::cast_possible_truncation, reason = "the nearest f32 is meant")]
pub(crate) fn depth(format: DepthFormat, key: u32) -> f32 {
    let part = |bits: u32| (f64::from(key) / f64::from(largest(bits))) as f32;
    match format {
        DepthFormat::F32Reversed => f32::from_bits(key),
        DepthFormat::F32 => 1.0 - f32::from_bits(ONE - key.min(ONE)),
        DepthFormat::Bits24 => part(24),
        DepthFormat::Bits16 => part(16),
    }
}

/// The largest integer less the rounded 1 - depth.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from 0 to 2^24")]
fn whole(depth: f32, bits: u32) -> u32 {
    let largest = largest(bits);
    largest - ((1.0 - f64::from(depth)) * f64::from(largest)).round() as u32
}

#[cfg(test)]
#[expect(clippy::cast_possible_truncation, reason = "small numbers")]
mod tests {
    use super::*;

    /// The distance at which two planes about z = 1000 are always told apart.
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
    fn what_is_nearer_is_kept_as_no_less_and_comes_back() {
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
                last = own;
            }
        }
    }
}

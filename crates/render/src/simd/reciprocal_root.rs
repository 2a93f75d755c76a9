//! Variants of the reciprocal square root: fast and inexact.
//!
//! Processors have an instruction that estimates it: with a relative error of 3.7e-4 with SSE and
//! AVX and 6.1e-5 with AVX-512, and not with the same bits on processors of different makers.
//! Without it, the estimate is made from the number's bits, to 6.5e-4. A Newton step doubles the
//! digits:
//!
//!   y' = y (3/2 - x y^2 / 2)
//!
//! Intel, "Intrinsics Guide", `rsqrtps` and `vrsqrt14ps`; for the bits, Kadlec, "Improving the fast
//! inverse square root", 2010.

#[cfg(target_arch = "x86_64")]
use std::arch::x86_64::{__m128, __m256, __m512, _mm_rsqrt_ps, _mm256_rsqrt_ps, _mm512_rsqrt14_ps};

use fearless_simd::{Simd, SimdBase as _, f32x16};
#[cfg(target_arch = "x86_64")]
use fearless_simd::{SimdCombine as _, SimdInto as _, SimdSplit as _, f32x4, f32x8};

use super::real::Real;
use marraztu_core::accuracy::Normalising;

/// Below this, an f32 is subnormal; above the other, it is infinite.
const SMALLEST: f64 = 1.175_494_4e-38;
const LARGEST: f64 = 3.402_823_4e38;

#[cfg(target_arch = "x86_64")]
fearless_simd::kernel!(
    #[inline]
    fn estimate_avx512(avx512: Avx512, x: __m512) -> __m512 {
        _mm512_rsqrt14_ps(x)
    }
);

#[cfg(target_arch = "x86_64")]
fearless_simd::kernel!(
    #[inline]
    fn estimate_avx2(avx2: Avx2, x: __m256) -> __m256 {
        _mm256_rsqrt_ps(x)
    }
);

#[cfg(target_arch = "x86_64")]
fearless_simd::kernel!(
    #[inline]
    fn estimate_sse2(sse2: Sse2, x: __m128) -> __m128 {
        _mm_rsqrt_ps(x)
    }
);

/// The processor's estimate of the reciprocal root of normal numbers above 0.
#[inline(always)]
fn estimate<S: Simd>(x: f32x16<S>) -> f32x16<S> {
    #[cfg(target_arch = "x86_64")]
    {
        let (simd, level) = (x.simd, x.simd.level());
        if let Some(avx512) = level.as_avx512() {
            return estimate_avx512(avx512, x.into()).simd_into(simd);
        }
        let (low, high) = x.split();
        if let Some(avx2) = level.as_avx2() {
            let half = |x: f32x8<S>| -> f32x8<S> { estimate_avx2(avx2, x.into()).simd_into(simd) };
            return half(low).combine(half(high));
        }
        if let Some(sse2) = level.as_sse2() {
            let quarter =
                |x: f32x4<S>| -> f32x4<S> { estimate_sse2(sse2, x.into()).simd_into(simd) };
            let half = |x: f32x8<S>| -> f32x8<S> {
                let (low, high) = x.split();
                quarter(low).combine(quarter(high))
            };
            return half(low).combine(half(high));
        }
    }
    let mut lanes: [f32; 16] = *x;
    for lane in &mut lanes {
        *lane = of_bits(*lane);
    }
    f32x16::from_slice(x.simd, &lanes)
}

/// The estimate from the bits of a normal number above 0.
#[inline(always)]
fn of_bits(x: f32) -> f32 {
    let y = f32::from_bits(0x5f1f_fff9_u32.wrapping_sub(x.to_bits() >> 1));
    y * (1.681_913_9 - x * 0.703_952_25 * (y * y))
}

#[inline(always)]
fn newton<R: Real>(x: R, y: R) -> R {
    y * (x.lift(1.5) - x * x.lift(0.5) * (y * y))
}

/// `y` if `x` is a normal number above 0, else 0.
#[inline(always)]
fn if_normal<R: Real>(x: R, y: R) -> R {
    let zero = x.lift(0.0);
    x.if_more(x.lift(LARGEST), zero, x.if_more(x.lift(SMALLEST), y, zero))
}

/// Sixteen reciprocal roots.
#[inline(always)]
pub(crate) fn sixteen<S: Simd>(x: f32x16<S>, variant: Normalising) -> f32x16<S> {
    match variant {
        Normalising::Root => x.reciprocal_root(),
        Normalising::Newton => if_normal(x, newton(x, estimate(x))),
        Normalising::Rsqrt => if_normal(x, estimate(x)),
    }
}

/// The same in f64, which has no such instruction: the estimate is made from the bits.
#[inline(always)]
#[expect(clippy::cast_possible_truncation, reason = "it is an estimate")]
pub(crate) fn one(x: f64, variant: Normalising) -> f64 {
    let estimate = || f64::from(of_bits(x as f32));
    match variant {
        Normalising::Root => x.reciprocal_root(),
        Normalising::Newton => if_normal(x, newton(x, estimate())),
        Normalising::Rsqrt => if_normal(x, estimate()),
    }
}

#[cfg(test)]
mod tests {
    use fearless_simd::{Level, dispatch};

    use super::*;

    fn roots(level: Level, x: [f32; 16], variant: Normalising) -> [f32; 16] {
        let mut out = [0.0; 16];
        dispatch!(level, simd => {
            sixteen(f32x16::from_slice(simd, &x), variant).store_slice(&mut out);
        });
        out
    }

    fn levels() -> Vec<Level> {
        let best = Level::new();
        #[cfg(target_arch = "x86_64")]
        let older = [best.as_sse2().map(Level::Sse2), best.as_avx2().map(Level::Avx2)];
        #[cfg(not(target_arch = "x86_64"))]
        let older = [None; 2];
        older.into_iter().flatten().chain([best]).collect()
    }

    #[test]
    fn an_estimate_has_eleven_digits_of_two_and_newton_doubles_them() {
        for (variant, least, most) in
            [(Normalising::Rsqrt, 1e-6, 6.6e-4), (Normalising::Newton, 0.0, 7e-7)]
        {
            for level in levels() {
                let (mut worst, mut worst_of_64) = (0.0_f64, 0.0_f64);
                for start in (0x3f80_0000..0x4080_0000_u32).step_by(9_973) {
                    let x = [0; 16].map(|_: i32| f32::from_bits(start));
                    let want = 1.0 / f64::from(x[0]).sqrt();
                    let apart = |got: f64| (got - want).abs() / want;
                    worst = worst.max(apart(f64::from(roots(level, x, variant)[5])));
                    worst_of_64 = worst_of_64.max(apart(one(f64::from(x[0]), variant)));
                }
                assert!((least..most).contains(&worst), "{variant:?} {level:?}: {worst:e}");
                assert!((least..most).contains(&worst_of_64), "{variant:?}: {worst_of_64:e}");
            }
        }
    }

    #[test]
    fn what_has_no_reciprocal_root_gives_zero() {
        for variant in [Normalising::Rsqrt, Normalising::Newton, Normalising::Root] {
            for x in [0.0, -0.0, -1.0, 1e-40, f32::INFINITY, f32::NEG_INFINITY, f32::NAN] {
                for level in levels() {
                    assert_eq!(
                        roots(level, [x; 16], variant),
                        [0.0; 16],
                        "{x} {variant:?} {level:?}"
                    );
                }
                let in_64 = if x == 1e-40 { 0.0 } else { one(f64::from(x), variant) };
                assert_eq!(in_64, 0.0, "{x} {variant:?}");
            }
        }
    }
}

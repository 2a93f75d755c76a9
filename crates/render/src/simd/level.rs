//! Chooses code by the instruction set of the processor.

use fearless_simd::Level;

/// The instruction sets that this crate is compiled for and the processor has, the best last. Empty
/// on an x86-64 processor without SSE4.2, which cannot draw.
#[must_use]
pub fn levels() -> Vec<Level> {
    let best = Level::new();
    #[cfg(target_arch = "x86_64")]
    let levels = [
        best.as_sse4_2().map(Level::Sse4_2),
        best.as_avx2().map(Level::Avx2),
        best.as_avx512().map(Level::Avx512),
    ];
    #[cfg(not(target_arch = "x86_64"))]
    let levels = [Some(best)];
    levels.into_iter().flatten().collect()
}

/// Runs an operation that is compiled for the instruction set of a `Level`. The operation is
/// inlined into a function of that instruction set, with `simd` as the token of its vectors.
///
/// Three sets are compiled on x86-64: SSE4.2, AVX2 and AVX-512. Each further set would add a
/// third to the time of compiling this crate.
macro_rules! dispatch {
    ($level:expr, $simd:pat => $operation:expr) => {
        match $level {
            #[cfg(target_arch = "x86_64")]
            ::fearless_simd::Level::Avx512(token) => {
                $crate::simd::level::vectorized!(token, $simd => $operation)
            }
            #[cfg(target_arch = "x86_64")]
            ::fearless_simd::Level::Avx2(token) => {
                $crate::simd::level::vectorized!(token, $simd => $operation)
            }
            #[cfg(target_arch = "x86_64")]
            ::fearless_simd::Level::Sse4_2(token) => {
                $crate::simd::level::vectorized!(token, $simd => $operation)
            }
            #[cfg(target_arch = "x86_64")]
            _ => unreachable!("Renderer::new checks the level"),
            #[cfg(not(target_arch = "x86_64"))]
            level => ::fearless_simd::dispatch!(level, $simd => $operation),
        }
    };
}
pub(crate) use dispatch;

#[cfg(target_arch = "x86_64")]
macro_rules! vectorized {
    ($token:expr, $simd:pat => $operation:expr) => {{
        let token = $token;
        let $simd = token;
        // The closure has no instruction set of its own: only inlining gives it one.
        ::fearless_simd::Simd::vectorize(
            token,
            #[inline(always)]
            || $operation,
        )
    }};
}
#[cfg(target_arch = "x86_64")]
pub(crate) use vectorized;

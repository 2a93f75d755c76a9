//! Chooses code by the instruction set of the processor.
//!
//! Three sets are compiled on x86-64: SSE4.2, AVX2 and AVX-512, in that order of the size of their
//! code. `RUSTFLAGS="--cfg one_level"` compiles SSE4.2 alone, for mutation tests and for work on
//! code that does not depend on the set.

use fearless_simd::Level;

/// Returns the instruction sets that this crate is compiled for and the processor has, the best
/// last. Empty on an x86-64 processor without SSE4.2, which cannot draw.
#[must_use]
pub fn levels() -> Vec<Level> {
    let best = Level::new();
    // A processor also has every set below its best one.
    #[cfg(target_arch = "x86_64")]
    let levels = [
        best.as_sse4_2().map(Level::Sse4_2),
        best.as_avx2().filter(|_| !cfg!(one_level)).map(Level::Avx2),
        best.as_avx512().filter(|_| !cfg!(one_level)).map(Level::Avx512),
    ];
    #[cfg(not(target_arch = "x86_64"))]
    let levels = [Some(best)];
    levels.into_iter().flatten().collect()
}

/// Returns whether this crate has code for an instruction set.
pub(crate) fn is_compiled(level: Level) -> bool {
    #[cfg(target_arch = "x86_64")]
    {
        level.as_sse4_2().is_some()
    }
    #[cfg(not(target_arch = "x86_64"))]
    {
        let _: Level = level;
        true
    }
}

/// Returns whether an instruction set is AVX-512, which other processors do not know.
pub(crate) fn is_avx512(level: Level) -> bool {
    #[cfg(target_arch = "x86_64")]
    {
        level.as_avx512().is_some()
    }
    #[cfg(not(target_arch = "x86_64"))]
    {
        let _: Level = level;
        false
    }
}

/// Runs an operation that is compiled for the instruction set of a `Level`. The operation is
/// inlined into a function of that instruction set, with `simd` as the token of its vectors.
macro_rules! dispatch {
    ($level:expr, $simd:pat => $operation:expr) => {
        match $level {
            #[cfg(all(target_arch = "x86_64", not(one_level)))]
            ::fearless_simd::Level::Avx512(token) => {
                $crate::simd::level::vectorized!(token, $simd => $operation)
            }
            #[cfg(all(target_arch = "x86_64", not(one_level)))]
            ::fearless_simd::Level::Avx2(token) => {
                $crate::simd::level::vectorized!(token, $simd => $operation)
            }
            // Any other level runs the code for SSE4.2, the lowest set that is compiled.
            #[cfg(target_arch = "x86_64")]
            level => match level.as_sse4_2() {
                Some(token) => $crate::simd::level::vectorized!(token, $simd => $operation),
                None => unreachable!("Renderer::new checks the level"),
            },
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
        // Only inlining gives the closure the instruction set of its caller.
        ::fearless_simd::Simd::vectorize(
            token,
            #[inline(always)]
            || $operation,
        )
    }};
}
#[cfg(target_arch = "x86_64")]
pub(crate) use vectorized;

//! Gathers sixteen numbers at once from a short table.
//!
//! A block shows few triangles on many pixels. Attributes of the triangles are stored in rows, one
//! number per triangle, and pixels gather from them. Some processors have an instruction that
//! permutes the lanes of a register; without it, numbers are gathered one by one.

use fearless_simd::{Bytes as _, Level, Simd, SimdBase as _, f32x16, i32x16};

use super::level::is_avx512;

/// The length of a table.
pub(crate) const SLOTS: usize = 64;

/// Sixteen slots, and how many are in use.
#[derive(Clone, Copy, Debug)]
pub struct Slots<S: Simd> {
    pub(crate) lanes: i32x16<S>,
    pub(crate) count: usize,
}

/// Gathers the numbers of a row at some slots.
#[inline(always)]
pub(crate) fn pick<S: Simd>(simd: S, row: &[i32; SLOTS], slots: Slots<S>) -> i32x16<S> {
    let Slots { lanes, count } = slots;
    match simd.level() {
        // The branches are the same for all pixels of a list.
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        Level::Avx512(token) => {
            // `S` is this level here, so the copy through an array only changes the type.
            let lanes = i32x16::from_slice(token, &<[i32; 16]>::from(lanes));
            let picked = if count <= 16 {
                x86::of_one(token, page(token, row, 0), lanes)
            } else {
                let low = x86::of_two(token, page(token, row, 0), page(token, row, 1), lanes);
                // Two permutations of two registers each cover all 64 slots; a comparison selects
                // one of them.
                if count <= 32 {
                    low
                } else {
                    let high = x86::of_two(token, page(token, row, 2), page(token, row, 3), lanes);
                    fearless_simd::Select::select(lanes.simd_lt(32), low, high)
                }
            };
            i32x16::from_slice(simd, &<[i32; 16]>::from(picked))
        }
        // AVX2 permutes eight lanes: from more than sixteen, numbers are gathered one by one.
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        Level::Avx2(token) if count <= 16 => {
            let lanes = i32x16::from_slice(token, &<[i32; 16]>::from(lanes));
            let picked = x86::of_halves(token, page(token, row, 0), lanes);
            i32x16::from_slice(simd, &<[i32; 16]>::from(picked))
        }
        _ => {
            let mut picked = [0; 16];
            for (picked, slot) in picked.iter_mut().zip(<[i32; 16]>::from(lanes)) {
                *picked = row[slot.cast_unsigned() as usize % SLOTS];
            }
            i32x16::from_slice(simd, &picked)
        }
    }
}

/// Returns whether one instruction permutes sixteen lanes.
#[inline(always)]
pub(crate) fn permutes(level: Level) -> bool {
    is_avx512(level)
}

/// Gathers the numbers in some lanes, all below sixteen.
#[inline(always)]
pub(crate) fn permute<S: Simd>(of: i32x16<S>, lanes: i32x16<S>) -> i32x16<S> {
    let simd = of.simd;
    match simd.level() {
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        Level::Avx512(token) => {
            let lanes = i32x16::from_slice(token, &<[i32; 16]>::from(lanes));
            let of = i32x16::from_slice(token, &<[i32; 16]>::from(of));
            i32x16::from_slice(simd, &<[i32; 16]>::from(x86::of_one(token, of, lanes)))
        }
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        Level::Avx2(token) => {
            let lanes = i32x16::from_slice(token, &<[i32; 16]>::from(lanes));
            let of = i32x16::from_slice(token, &<[i32; 16]>::from(of));
            i32x16::from_slice(simd, &<[i32; 16]>::from(x86::of_halves(token, of, lanes)))
        }
        _ => {
            let of = <[i32; 16]>::from(of);
            let lanes = <[i32; 16]>::from(lanes);
            let mut picked = [0; 16];
            for (picked, lane) in picked.iter_mut().zip(lanes) {
                *picked = of[lane.cast_unsigned() as usize % 16];
            }
            i32x16::from_slice(simd, &picked)
        }
    }
}

/// Gathers the numbers in some lanes, like [`permute`].
#[inline(always)]
pub(crate) fn of_lanes<S: Simd>(of: f32x16<S>, lanes: i32x16<S>) -> f32x16<S> {
    permute(of.bitcast(), lanes).bitcast()
}

/// Returns the number of slots up to which gathering takes no longer than from a few.
pub(crate) fn most_gathered(level: Level) -> usize {
    if is_avx512(level) { 32 } else { 16 }
}

/// Loads sixteen numbers of a row.
#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
#[inline(always)]
fn page<S: Simd>(simd: S, row: &[i32; SLOTS], page: usize) -> i32x16<S> {
    i32x16::from_slice(simd, &row[16 * page..16 * page + 16])
}

/// The instructions that permute lanes by the indices in another register.
#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
mod x86 {
    #[cfg(target_arch = "x86")]
    use std::arch::x86::{
        _mm256_permutevar8x32_epi32, _mm512_permutex2var_epi32, _mm512_permutexvar_epi32,
    };
    #[cfg(target_arch = "x86_64")]
    use std::arch::x86_64::{
        _mm256_permutevar8x32_epi32, _mm512_permutex2var_epi32, _mm512_permutexvar_epi32,
    };

    use fearless_simd::x86::{Avx2, Avx512};
    use fearless_simd::{
        Select as _, SimdBase as _, SimdCombine as _, SimdInto as _, SimdSplit as _, i32x8, i32x16,
    };

    fearless_simd::kernel!(
        #[inline(always)]
        pub(crate) fn of_one(
            token: Avx512,
            page: i32x16<Avx512>,
            slots: i32x16<Avx512>,
        ) -> i32x16<Avx512> {
            _mm512_permutexvar_epi32(slots.into(), page.into()).simd_into(token)
        }
    );

    fearless_simd::kernel!(
        #[inline(always)]
        pub(crate) fn of_two(
            token: Avx512,
            low: i32x16<Avx512>,
            high: i32x16<Avx512>,
            slots: i32x16<Avx512>,
        ) -> i32x16<Avx512> {
            _mm512_permutex2var_epi32(low.into(), slots.into(), high.into()).simd_into(token)
        }
    );

    fearless_simd::kernel!(
        #[inline(always)]
        fn of_eight(token: Avx2, half: i32x8<Avx2>, slots: i32x8<Avx2>) -> i32x8<Avx2> {
            _mm256_permutevar8x32_epi32(half.into(), slots.into()).simd_into(token)
        }
    );

    /// Gathers from sixteen numbers, by halves of eight.
    #[inline(always)]
    pub(crate) fn of_halves(token: Avx2, page: i32x16<Avx2>, slots: i32x16<Avx2>) -> i32x16<Avx2> {
        // The instruction reads the lowest three bits of an index, so 8 to 15 fit the upper half as
        // they are. Both halves are looked up, and the index selects one.
        let (low, high) = page.split();
        let (first, second) = slots.split();
        let from_low = of_eight(token, low, first).combine(of_eight(token, low, second));
        let from_high = of_eight(token, high, first).combine(of_eight(token, high, second));
        slots.simd_lt(8).select(from_low, from_high)
    }
}

#[cfg(test)]
mod tests {
    use crate::simd::dispatch;
    use fearless_simd::Level;

    use super::*;
    use marraztu_core::base::rng::Rng;

    fn picked(level: Level, row: &[i32; SLOTS], slots: &[i32; 16], count: usize) -> [i32; 16] {
        let mut out = [0; 16];
        dispatch!(level, simd => {
            let lanes = i32x16::from_slice(simd, slots);
            pick(simd, row, Slots { lanes, count }).store_slice(&mut out);
        });
        out
    }

    #[test]
    fn every_level_gathers_the_values_at_the_slots() {
        let row: [i32; SLOTS] = std::array::from_fn(|i| 1000 - 7 * i32::try_from(i).unwrap());
        let mut rng = Rng::new(1);
        for _ in 0..200 {
            let slots = [0; 16].map(|_| u32::try_from(rng.below(64)).unwrap());
            for level in crate::simd::levels() {
                let want = |below: u32| slots.map(|slot| row[(slot % below) as usize]);
                let of = |below: u32| slots.map(|slot| (slot % below).cast_signed());
                assert_eq!(picked(level, &row, &of(16), 16), want(16));
                assert_eq!(picked(level, &row, &of(32), 32), want(32));
                assert_eq!(picked(level, &row, &of(64), 64), want(64));
            }
        }
    }
}

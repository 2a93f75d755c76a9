//! Points of the unit square for the samples of a light: the (0, 2)-sequence of Sobol', scrambled
//! for each point that is lit.
//!
//! Of any 2^k points that begin at a multiple of 2^k, one lies in each cell of every grid of 2^k
//! equal cells. Scrambling keeps that (Owen, "Randomly Permuted (t, m, s)-Nets", 1995), and makes
//! noise instead of stripes. All is done in integers: the points are the same everywhere.
//!
//! Kollig and Keller, "Efficient Multidimensional Sampling", Eurographics 2002; Burley, "Practical
//! Hash-based Owen Scrambling", JCGT 2020; Vegdahl, "Building a Better LK Hash", 2021.

use glam::DVec3;

/// Returns sample `i` of a sequence: two numbers above 0 and below 1.
pub(super) fn sample(i: u32, seed: u32) -> [f64; 2] {
    // The order of the samples is scrambled, too, so that two lights do not share it.
    let i = scrambled(i, seed);
    let first = scrambled(i.reverse_bits(), mixed(seed ^ 0x68bc_21eb));
    let second = scrambled(sobol(i), mixed(seed ^ 0x02e5_be93));
    [first, second].map(|bits| (f64::from(bits) + 0.5) / 4_294_967_296.0)
}

/// Returns the second coordinate of point `i` of Sobol's sequence.
const fn sobol(mut i: u32) -> u32 {
    let (mut direction, mut bits) = (1_u32 << 31, 0);
    while i != 0 {
        if i & 1 == 1 {
            bits ^= direction;
        }
        i >>= 1;
        direction ^= direction >> 1;
    }
    bits
}

/// Scrambles the bits of a number: the highest bit may flip, and each lower bit depending on all
/// bits above it.
const fn scrambled(bits: u32, seed: u32) -> u32 {
    let mut x = bits.reverse_bits();
    x ^= x.wrapping_mul(0x3d20_adea);
    x = x.wrapping_add(seed);
    x = x.wrapping_mul((seed >> 16) | 1);
    x ^= x.wrapping_mul(0x0552_6c56);
    x ^= x.wrapping_mul(0x53a2_2864);
    x.reverse_bits()
}

/// Returns the seed of a point for a light. Equal points have equal seeds.
pub(super) fn seed_of(point: DVec3, light: u32) -> u32 {
    let fold = |seed: u32, x: f64| {
        // Adding 0 turns -0 into 0.
        let bits = (x + 0.0).to_bits();
        let [low, high] = [bits & 0xffff_ffff, bits >> 32].map(|x| u32::try_from(x).unwrap_or(0));
        mixed(mixed(seed ^ low) ^ high)
    };
    point.to_array().into_iter().fold(mixed(light.wrapping_add(0x9e37_79b9)), fold)
}

/// Mixes the bits of a number: a permutation. Wellons, "Prospecting for Hash Functions", 2018.
const fn mixed(x: u32) -> u32 {
    let x = (x ^ x >> 16).wrapping_mul(0x21f0_aaad);
    let x = (x ^ x >> 15).wrapping_mul(0x735a_2d97);
    x ^ x >> 15
}

#[cfg(test)]
mod tests {
    #![expect(clippy::cast_possible_truncation, reason = "coordinates below 256")]

    use super::*;

    #[test]
    fn samples_are_stratified_and_the_first_ones_are_those_of_a_longer_sequence() {
        for seed in (0..200).map(mixed) {
            for log2 in [2, 4, 6, 8] {
                let count = 1_u32 << log2;
                let all: Vec<[f64; 2]> = (0..count).map(|i| sample(i, seed)).collect();
                // One sample in each cell of each grid: 1 x n, 2 x n/2, ... n x 1.
                for columns in (0..=log2).map(|k| 1_u32 << k) {
                    let rows = count / columns;
                    let mut cells = vec![0; count as usize];
                    for [x, y] in &all {
                        let [x, y] = [x * f64::from(columns), y * f64::from(rows)];
                        cells[x as usize * rows as usize + y as usize] += 1;
                    }
                    assert!(cells.iter().all(|n| *n == 1), "{seed}: {count} in {columns} columns");
                }
            }
        }
    }

    #[test]
    fn each_point_has_its_own_sequence() {
        let seed = |x: f64, light| seed_of(DVec3::new(x, 0.0, 1.0), light);
        assert_eq!(seed(0.0, 1), seed(-0.0, 1));
        let mut seeds: Vec<u32> = (0..1000).map(|i| seed(f64::from(i) * 1e-9, i % 3)).collect();
        seeds.sort_unstable();
        seeds.dedup();
        assert_eq!(seeds.len(), 1000);
        // Their first samples are spread evenly.
        let mut cells = [0_u32; 16];
        for i in 0..16_000 {
            let [x, y] = sample(0, seed(f64::from(i), 0));
            cells[(x * 4.0) as usize * 4 + (y * 4.0) as usize] += 1;
        }
        assert!(cells.iter().all(|n| (850..1150).contains(n)), "{cells:?}");
    }
}

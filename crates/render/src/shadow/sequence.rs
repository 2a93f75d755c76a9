//! Points of the unit square for the samples of a light: one (0, 2)-sequence of Sobol' for each
//! light, scrambled. Each pixel takes a part of it.
//!
//! Of any 2^k points that begin at a multiple of 2^k, one lies in each cell of every grid of 2^k
//! equal cells. Scrambling keeps that (Owen, "Randomly Permuted (t, m, s)-Nets", 1995), and makes
//! noise instead of stripes. Pixels take their parts along a Z-curve, so the samples of a square of
//! pixels are spread as evenly as the samples of one pixel. The errors of neighbours mostly
//! cancel, so the noise is fine (Ahmed and Wonka, "Screen-space Blue-noise
//! Diffusion of Monte Carlo Sampling Error via Hierarchical Ordering of Pixels", 2020). All is done
//! in integers: the points are the same everywhere.
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

/// Returns the seed of the sequence of a light.
pub(super) const fn seed_of(light: u32) -> u32 {
    mixed(light.wrapping_add(0x9e37_79b9))
}

/// Returns the place of a pixel along a Z-curve, from its column and row.
pub(crate) fn place_of_pixel(pixel: [i32; 2]) -> u32 {
    let [x, y] = pixel.map(|at| {
        let spread = |x: u32, by: u32, mask: u32| (x | x << by) & mask;
        let x = spread(at.cast_unsigned() & 0xffff, 8, 0x00ff_00ff);
        let x = spread(x, 4, 0x0f0f_0f0f);
        spread(spread(x, 2, 0x3333_3333), 1, 0x5555_5555)
    });
    x | y << 1
}

/// Returns a place in the sequence for a point without a pixel. Equal points have equal places.
pub(crate) fn place_of_point(point: DVec3) -> u32 {
    point.to_array().into_iter().fold(0, |place, x| {
        // Adding 0 turns -0 into 0.
        let bits = (x + 0.0).to_bits();
        let [low, high] = [bits & 0xffff_ffff, bits >> 32].map(|x| u32::try_from(x).unwrap_or(0));
        mixed(mixed(place ^ low) ^ high)
    })
}

/// Returns the place of the points that a pixel's rays meet after this many bounces.
pub(crate) const fn after_bounces(place: u32, bounces: u32) -> u32 {
    // All places change alike, so the places of a square of pixels stay together.
    place ^ mixed(bounces)
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
    fn points_without_pixels_have_their_own_places() {
        let place = |x: f64| place_of_point(DVec3::new(x, 0.0, 1.0));
        assert_eq!(place(0.0), place(-0.0));
        let mut places: Vec<u32> = (0..1000).map(|i| place(f64::from(i) * 1e-9)).collect();
        places.sort_unstable();
        places.dedup();
        assert_eq!(places.len(), 1000);
        // Their first samples are spread evenly.
        let mut cells = [0_u32; 16];
        for i in 0..16_000 {
            let [x, y] = sample(place(f64::from(i)).wrapping_mul(16), seed_of(0));
            cells[(x * 4.0) as usize * 4 + (y * 4.0) as usize] += 1;
        }
        assert!(cells.iter().all(|n| (850..1150).contains(n)), "{cells:?}");
    }

    #[test]
    fn the_samples_of_a_square_of_pixels_are_as_even_as_those_of_one() {
        assert_eq!(place_of_pixel([0xffff, 0]), 0x5555_5555);
        assert_eq!(place_of_pixel([0b101, 0b011]), 0b01_10_11);
        // Four samples of each of 8 x 8 pixels: one in each of 16 x 16 cells, after bounces, too.
        for (light, bounces) in [(0, 0), (3, 0), (3, 1), (7, 4)] {
            let mut cells = [0; 256];
            for i in 0..64 {
                let place = place_of_pixel([8 * 5 + i % 8, 8 * 9 + i / 8]);
                for number in 0..4 {
                    let number = after_bounces(place, bounces).wrapping_mul(4) + number;
                    let [x, y] = sample(number, seed_of(light)).map(|x| (x * 16.0) as usize);
                    cells[16 * y + x] += 1;
                }
            }
            assert!(cells.iter().all(|n| *n == 1), "light {light}, {bounces} bounces: {cells:?}");
        }
    }
}

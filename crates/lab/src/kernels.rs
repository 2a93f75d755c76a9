//! Measures four small kernels in plain Rust and with SIMD: equal results, different times.
//!
//! An ancestor of this program compared C and assembler on these: the dot product, interpolation, a
//! vector times a matrix, and the clearing of a depth buffer. Both versions add in the same order
//! and fuse nothing, so all bits are equal. The plain version is a loop, compiled for the oldest
//! supported processor; the compiler may vectorise it.

use fearless_simd::{Level, Simd, SimdBase as _, dispatch, f32x4, f32x16};
use serde::{Deserialize, Serialize};

use super::pairs::{Limits, Ratio, Unmeasured, Watch, abba};
use super::timing::{Clock, Work};
use super::word::Word;

/// The number of vectors per kernel: 800 x 800 depths.
const VECTORS: usize = 160_000;

/// The number of kernels.
pub const COUNT: usize = KERNELS.len();

/// The measurement of a kernel.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Kernel {
    /// The name of the computation.
    #[serde(deserialize_with = "crate::word::read")]
    pub name: Word,
    /// The time of SIMD relative to the plain version.
    pub ratio: Ratio,
    /// Whether all bits of the results are equal.
    pub equal: bool,
}

/// The inputs and outputs of kernels: vectors of four numbers, one after the other.
#[derive(Clone, Debug, PartialEq)]
struct Rows {
    a: Vec<f32>,
    b: Vec<f32>,
    out: Vec<f32>,
}

type Run = fn(Level, &mut Rows);

struct Way {
    name: &'static str,
    plain: Run,
    simd: Run,
}

const KERNELS: [Way; 4] = [
    Way {
        name: "dot product",
        plain: |_, rows| plain_dot(rows),
        simd: |level, rows| dispatch!(level, simd => simd_dot(simd, rows)),
    },
    Way {
        name: "interpolation",
        plain: |_, rows| plain_mix(rows),
        simd: |level, rows| dispatch!(level, simd => simd_mix(simd, rows)),
    },
    Way {
        name: "vector times matrix",
        plain: |_, rows| plain_transform(rows),
        simd: |level, rows| dispatch!(level, simd => simd_transform(simd, rows)),
    },
    Way {
        name: "depth clear",
        plain: |_, rows| plain_clear(rows),
        simd: |level, rows| dispatch!(level, simd => simd_clear(simd, rows)),
    },
];

impl Rows {
    fn new() -> Self {
        let wave = |by: f64| -> Vec<f32> {
            #[expect(clippy::cast_possible_truncation, reason = "a rounded number is meant")]
            let at = |i: usize| libm::sin(by * f64::from(u32::try_from(i).unwrap_or(0))) as f32;
            (0..4 * VECTORS).map(at).collect()
        };
        Self { a: wave(0.7), b: wave(1.3), out: vec![0.0; 4 * VECTORS] }
    }
}

/// Measures the kernel with this index.
///
/// # Errors
/// If it was cancelled, or if every pair was disturbed.
pub fn measure(
    number: usize,
    clock: &mut dyn Clock,
    limits: &Limits,
    watch: &Watch,
) -> Result<Kernel, Unmeasured> {
    let Way { name, plain, simd } = KERNELS[number];
    let (level, mut rows) = (Level::new(), [Rows::new(), Rows::new()]);
    let ratio = abba(limits, watch, &mut |which| {
        let (run, rows) = ([plain, simd][which], &mut rows[which]);
        let time = clock.time(Work::Kernel(name), &mut || run(level, std::hint::black_box(rows)));
        Ok(time.as_secs_f64() * 1e3)
    })?;
    Ok(Kernel { name, ratio, equal: bits(&rows[0].out) == bits(&rows[1].out) })
}

fn bits(numbers: &[f32]) -> Vec<u32> {
    numbers.iter().map(|number| number.to_bits()).collect()
}

/// The weight of `b` in the interpolation.
const PART: f32 = 0.3;
/// The depth that a buffer is cleared to.
const FAR: f32 = 1.0;
/// The rows of the matrix; row vectors are multiplied from the left.
const MATRIX: [[f32; 4]; 4] =
    [[0.8, 0.1, -0.3, 0.0], [-0.2, 0.9, 0.1, 0.0], [0.3, -0.1, 0.7, 0.0], [5.0, -2.0, 1.0, 1.0]];

#[inline(never)]
fn plain_dot(rows: &mut Rows) {
    let pairs = rows.a.chunks_exact(4).zip(rows.b.chunks_exact(4));
    for (out, (a, b)) in rows.out.iter_mut().zip(pairs) {
        *out = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
    }
}

/// Transposes 16 vectors into rows of their first, second, third and fourth numbers. It is a
/// function because the compiler would not use the instructions of `S` in a closure.
#[inline(always)]
fn turned<S: Simd>(simd: S, flat: &[f32]) -> [f32x16<S>; 4] {
    let first = f32x16::from_slice(simd, &flat[..16]);
    let second = f32x16::from_slice(simd, &flat[16..32]);
    let third = f32x16::from_slice(simd, &flat[32..48]);
    let fourth = f32x16::from_slice(simd, &flat[48..64]);
    // Two rounds of deinterleaving transpose 16 x 4 numbers.
    let (even_low, odd_low) = first.deinterleave(second);
    let (even_high, odd_high) = third.deinterleave(fourth);
    let (x, z) = even_low.deinterleave(even_high);
    let (y, w) = odd_low.deinterleave(odd_high);
    [x, y, z, w]
}

#[inline(always)]
fn simd_dot<S: Simd>(simd: S, rows: &mut Rows) {
    let pairs = rows.a.chunks_exact(64).zip(rows.b.chunks_exact(64));
    for (out, (a, b)) in rows.out.chunks_exact_mut(16).zip(pairs) {
        let (a, b) = (turned(simd, a), turned(simd, b));
        let sum = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
        sum.store_slice(out);
    }
}

#[inline(never)]
fn plain_mix(rows: &mut Rows) {
    for ((out, a), b) in rows.out.iter_mut().zip(&rows.a).zip(&rows.b) {
        *out = a + (b - a) * PART;
    }
}

#[inline(always)]
fn simd_mix<S: Simd>(simd: S, rows: &mut Rows) {
    let pairs = rows.a.chunks_exact(16).zip(rows.b.chunks_exact(16));
    for (out, (a, b)) in rows.out.chunks_exact_mut(16).zip(pairs) {
        let (a, b) = (f32x16::from_slice(simd, a), f32x16::from_slice(simd, b));
        (a + (b - a) * f32x16::splat(simd, PART)).store_slice(out);
    }
}

#[inline(never)]
fn plain_transform(rows: &mut Rows) {
    let [x, y, z, w] = MATRIX;
    for (out, v) in rows.out.chunks_exact_mut(4).zip(rows.a.chunks_exact(4)) {
        for (i, out) in out.iter_mut().enumerate() {
            *out = v[0] * x[i] + v[1] * y[i] + v[2] * z[i] + v[3] * w[i];
        }
    }
}

#[inline(always)]
fn simd_transform<S: Simd>(simd: S, rows: &mut Rows) {
    let x = f32x4::from_slice(simd, &MATRIX[0]);
    let y = f32x4::from_slice(simd, &MATRIX[1]);
    let z = f32x4::from_slice(simd, &MATRIX[2]);
    let w = f32x4::from_slice(simd, &MATRIX[3]);
    for (out, v) in rows.out.chunks_exact_mut(4).zip(rows.a.chunks_exact(4)) {
        let first = x * f32x4::splat(simd, v[0]) + y * f32x4::splat(simd, v[1]);
        let third = z * f32x4::splat(simd, v[2]);
        (first + third + w * f32x4::splat(simd, v[3])).store_slice(out);
    }
}

#[inline(never)]
fn plain_clear(rows: &mut Rows) {
    for depth in &mut rows.out {
        *depth = FAR;
    }
}

#[inline(always)]
fn simd_clear<S: Simd>(simd: S, rows: &mut Rows) {
    let far = f32x16::splat(simd, FAR);
    for depth in rows.out.chunks_exact_mut(16) {
        far.store_slice(depth);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: (1, 2, 3, 4) . (5, 6, 7, 8) = 70; mixed by 0.3, the first number is 2.2; times the
    /// matrix it is 0.8 - 0.4 + 0.9 + 20 = 21.3.
    #[test]
    fn plain_and_simd_kernels_agree_bit_for_bit_with_a_result_by_hand() {
        let expected: [f32; COUNT] = [70.0, 2.2, 21.3, FAR];
        for (way, expected) in KERNELS.iter().zip(expected) {
            let mut rows = Rows::new();
            rows.a[..4].copy_from_slice(&[1.0, 2.0, 3.0, 4.0]);
            rows.b[..4].copy_from_slice(&[5.0, 6.0, 7.0, 8.0]);
            let mut others = rows.clone();
            (way.plain)(Level::new(), &mut rows);
            (way.simd)(Level::new(), &mut others);
            assert!((rows.out[0] - expected).abs() < 1e-5, "{}: {}", way.name, rows.out[0]);
            assert_eq!(bits(&rows.out), bits(&others.out), "{}", way.name);
        }
    }
}

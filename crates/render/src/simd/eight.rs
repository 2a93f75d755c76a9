//! The lanes of the most exact pictures: f64, eight at a time, with the same bits as one at a time.

use fearless_simd::{
    Level, Select as _, Simd, SimdBase, SimdFloat as _, SimdInto as _, SimdMask as _, f64x8,
};

use super::gather::SLOTS;
use super::lanes::{BATCH, Kernel, Lanes, Number, PARTS};
use super::level::dispatch;
use super::power::Power;
use super::real::Real;
use super::single::has_own_maximum;
use super::vec3::Vec3;

/// Computes in f64, eight numbers at a time, with the instruction set `S`.
#[derive(Clone, Copy, Debug)]
pub struct Eight<S>(pub S);

impl<S: Simd> Real for f64x8<S> {
    #[inline(always)]
    fn lift(self, constant: f64) -> Self {
        constant.simd_into(self.simd)
    }

    #[inline(always)]
    fn reciprocal_root(self) -> Self {
        let (zero, one) = (self.lift(0.0), self.lift(1.0));
        // Comparisons with NaN are false, so NaN gives 0 as well.
        let is_normal = self.simd_gt(zero) & self.simd_lt(self.lift(f64::INFINITY));
        is_normal.select(one / self.sqrt(), zero)
    }

    #[inline(always)]
    fn if_more(self, than: Self, yes: Self, no: Self) -> Self {
        self.simd_gt(than).select(yes, no)
    }

    #[inline(always)]
    fn power(self, power: &Power) -> Self {
        let mut lanes: [f64; 8] = *self;
        for lane in &mut lanes {
            *lane = lane.power(power);
        }
        Self::from_slice(self.simd, &lanes)
    }

    #[inline(always)]
    fn power_times(self, power: &Power, factor: Self) -> Self {
        let mut lanes: [f64; 8] = *self;
        for (lane, factor) in lanes.iter_mut().zip(*factor) {
            *lane = lane.power_times(power, factor);
        }
        Self::from_slice(self.simd, &lanes)
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        // x86 has an instruction with exactly this rule for NaN and zeros.
        if has_own_maximum(self.simd) {
            return <Self as SimdBase<S>>::max(self, other);
        }
        self.if_more(other, self, other)
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        if has_own_maximum(self.simd) {
            return <Self as SimdBase<S>>::min(self, other);
        }
        other.if_more(self, self, other)
    }
}

impl<S: Simd> Lanes for Eight<S> {
    type Number = f64;
    type R = f64x8<S>;
    type Slots = [i32; 8];
    const LANES: usize = 8;

    #[inline(always)]
    fn load(self, row: &[f64], at: usize) -> f64x8<S> {
        f64x8::from_slice(self.0, &row[at..at + 8])
    }

    #[inline(always)]
    fn load_four(self, rows: &[[f64; 4]], at: usize) -> [f64x8<S>; 4] {
        let mut values = [[0.0; 8]; 4];
        for (lane, row) in rows[at..at + 8].iter().enumerate() {
            for (to, from) in values.iter_mut().zip(row) {
                to[lane] = *from;
            }
        }
        let [a, b, c, d] = &values;
        [self.load(a, 0), self.load(b, 0), self.load(c, 0), self.load(d, 0)]
    }

    #[inline(always)]
    fn store_four(self, values: [f64x8<S>; 4], rows: &mut [[f64; 4]], at: usize) {
        let [a, b, c, d] = values;
        let values: [[f64; 8]; 4] = [*a, *b, *c, *d];
        for (lane, row) in rows[at..at + 8].iter_mut().enumerate() {
            for (to, from) in row.iter_mut().zip(&values) {
                *to = from[lane];
            }
        }
    }

    #[inline(always)]
    fn store(self, value: f64x8<S>, row: &mut [f64], at: usize) {
        value.store_slice(&mut row[at..at + 8]);
    }

    #[inline(always)]
    fn whole(self, row: &[i32], at: usize) -> f64x8<S> {
        let mut lanes = [0.0; 8];
        for (lane, number) in lanes.iter_mut().zip(&row[at..at + 8]) {
            *lane = f64::from(*number);
        }
        f64x8::from_slice(self.0, &lanes)
    }

    #[inline(always)]
    fn store_pixels_by(
        self,
        Vec3([r, g, b]): Vec3<f64x8<S>>,
        threshold: f64x8<S>,
        row: &mut [u32],
        at: usize,
    ) {
        let [r, g, b] = [
            before_rounding(r, threshold).floor(),
            before_rounding(g, threshold).floor(),
            before_rounding(b, threshold).floor(),
        ];
        // f64 holds the four bytes of a pixel exactly, so they are added up as one number.
        let pixels = r + g * 256.0 + b * 65536.0 + f64::from(255_u32 << 24);
        store_whole(pixels, &mut row[at..at + 8]);
    }

    #[inline(always)]
    fn store_parts(
        self,
        color: Vec3<f64x8<S>>,
        threshold: f64x8<S>,
        rows: &mut [[u32; BATCH]; 3],
        at: usize,
    ) {
        for (row, number) in rows.iter_mut().zip(color.0) {
            let parts = (before_rounding(number, threshold) * PARTS).floor();
            store_whole(parts, &mut row[at..at + 8]);
        }
    }

    #[inline(always)]
    fn set(self, number: f64) -> f64x8<S> {
        number.simd_into(self.0)
    }

    #[inline(always)]
    fn slots(self, (slots, _): (&[i32], usize), at: usize) -> [i32; 8] {
        let mut lanes = [0; 8];
        lanes.copy_from_slice(&slots[at..at + 8]);
        lanes
    }

    #[inline(always)]
    fn pick(self, row: &[f64; SLOTS], slots: [i32; 8]) -> f64x8<S> {
        let mut picked = [0.0; 8];
        for (picked, slot) in picked.iter_mut().zip(slots) {
            // The remainder leaves valid slots as they are and spares a bounds check.
            *picked = row[slot.cast_unsigned() as usize % SLOTS];
        }
        f64x8::from_slice(self.0, &picked)
    }

    #[inline(always)]
    fn any_more(self, a: f64x8<S>, b: f64x8<S>) -> bool {
        a.simd_gt(b).any_true()
    }
}

/// Computes 255 times a number plus the threshold, which is rounded down to a byte later.
#[inline(always)]
fn before_rounding<S: Simd>(number: f64x8<S>, threshold: f64x8<S>) -> f64x8<S> {
    let (zero, one) = (number.lift(0.0), number.lift(1.0));
    Real::min(Real::max(number, zero), one) * 255.0 + threshold
}

/// Stores whole numbers from 0 to 2^32 - 1: the bits of 2^52 + n end in n.
#[inline(always)]
#[expect(clippy::cast_possible_truncation, reason = "the last bits are meant")]
fn store_whole<S: Simd>(numbers: f64x8<S>, to: &mut [u32]) {
    let shifted: [f64; 8] = *(numbers + 4_503_599_627_370_496.0);
    for (to, number) in to.iter_mut().zip(shifted) {
        *to = number.to_bits() as u32;
    }
}

impl Number for f64 {
    #[inline(always)]
    fn from_f64(number: f64) -> Self {
        number
    }

    #[inline(always)]
    fn byte(self) -> u8 {
        marraztu_core::base::color::byte(self)
    }

    fn run(level: Level, kernel: impl Kernel<Self>) {
        dispatch!(level, simd => kernel.run(Eight(simd)));
    }
}

#[cfg(test)]
mod tests {
    use crate::simd::dispatch;

    use super::*;
    use crate::simd::{Exact, Kernel};

    /// The results of a kernel for numbers, slots and whole numbers.
    #[derive(Debug, PartialEq)]
    struct Made {
        numbers: Vec<u64>,
        pixels: [u32; BATCH],
        parts: [[u32; BATCH]; 3],
    }

    /// A kernel that applies every operation of lanes to a row of numbers.
    struct All<'a> {
        row: &'a [f64; SLOTS],
        slots: &'a [i32; SLOTS],
        power: &'a Power,
        made: &'a mut Made,
    }

    impl Kernel<f64> for All<'_> {
        #[inline(always)]
        fn run<M: Lanes<Number = f64>>(self, lanes: M) {
            let Self { row, slots, power, made } = self;
            let mut rows = [[0.0; BATCH]; 9];
            let mut fours = [[0.0; 4]; BATCH];
            for at in (0..SLOTS).step_by(M::LANES) {
                let x = lanes.load(row, at);
                let picked = lanes.pick(row, lanes.slots((slots, SLOTS), at));
                let values = [
                    x.reciprocal_root(),
                    x.power(power),
                    x.power_times(power, picked),
                    Real::max(x, picked),
                    Real::min(x, picked),
                    x.if_more(picked, lanes.lift(1.0), lanes.set(2.0)),
                    -x / picked + x * x - picked,
                    lanes.whole(slots, at),
                    if lanes.any_more(x, lanes.lift(f64::MAX)) { picked } else { x },
                ];
                for (to, value) in rows.iter_mut().zip(values) {
                    lanes.store(value, to, at);
                }
                let color = Vec3([x, picked, x * picked]);
                lanes.store_four([x, picked, x, -x], &mut fours, at);
                let [a, _, _, d] = lanes.load_four(&fours, at);
                lanes.store(a - d, &mut rows[8], at);
                if at % 16 < 8 {
                    lanes.store_pixels(color, &mut made.pixels, at);
                } else {
                    lanes.store_pixels_by(color, lanes.lift(0.25), &mut made.pixels, at);
                }
                lanes.store_parts(color, lanes.lift(0.75), &mut made.parts, at);
            }
            let numbers = rows.as_flattened().iter().chain(fours.as_flattened());
            // The sign of NaN differs between processors.
            let bits = |x: &f64| if x.is_nan() { f64::NAN.to_bits() } else { x.to_bits() };
            made.numbers = numbers.map(bits).collect();
        }
    }

    fn made(run: impl FnOnce(&mut Made)) -> Made {
        let mut made = Made { numbers: Vec::new(), pixels: [0; BATCH], parts: [[0; BATCH]; 3] };
        run(&mut made);
        made
    }

    #[test]
    fn eight_numbers_have_the_bits_of_one_at_a_time() {
        let odd = [0.0, -0.0, 1.0, -1.0, f64::NAN, f64::INFINITY, -f64::INFINITY, 1e-320, 1e300];
        let levels = crate::simd::levels();
        for (round, exponent) in (0_u32..).zip([0.5, 1.0, 27.9, 32.0, 1000.0]) {
            let row: &[f64; SLOTS] = &std::array::from_fn(|i| match odd.get(i) {
                Some(odd) if round > 0 => *odd,
                _ => ((i as f64 + f64::from(round)) * 0.754_877).fract(),
            });
            let slots: &[i32; SLOTS] =
                &std::array::from_fn(|i| ((i * 29 + 5) % SLOTS).try_into().unwrap());
            let power = &Power::new(exponent, -24.0);
            let one = made(|made| All { row, slots, power, made }.run(Exact));
            for level in &levels {
                let eight = made(|made| {
                    dispatch!(*level, simd => All { row, slots, power, made }.run(Eight(simd)));
                });
                assert_eq!(eight, one, "{exponent} {level:?}");
            }
        }
    }
}

//! The lanes of the editor: f32, sixteen at a time.

use fearless_simd::{
    Bytes as _, Level, Simd, SimdBase as _, SimdFloat as _, SimdInt as _, SimdInto as _,
    SimdMask as _, f32x16, i32x16, u32x16,
};

use super::gather::{SLOTS, Slots, pick};
use super::lanes::{BATCH, Kernel, Lanes, Number, PARTS};
use super::level::dispatch;
use super::real::Real;
use super::vec3::Vec3;
use marraztu_core::base::math::each;

/// Computes in f32, sixteen numbers at a time, with the instruction set `S`.
#[derive(Clone, Copy, Debug)]
pub struct Sixteen<S>(pub S);

impl<S: Simd> Lanes for Sixteen<S> {
    type Number = f32;
    type R = f32x16<S>;
    type Slots = Slots<S>;
    const LANES: usize = 16;

    #[inline(always)]
    fn load(self, row: &[f32], at: usize) -> f32x16<S> {
        f32x16::from_slice(self.0, &row[at..at + 16])
    }

    #[inline(always)]
    fn load_four(self, rows: &[[f32; 4]], at: usize) -> [f32x16<S>; 4] {
        let flat = rows[at..at + 16].as_flattened();
        let first = f32x16::from_slice(self.0, &flat[..16]);
        let second = f32x16::from_slice(self.0, &flat[16..32]);
        let third = f32x16::from_slice(self.0, &flat[32..48]);
        let fourth = f32x16::from_slice(self.0, &flat[48..]);
        // A 4 x 16 transpose in registers.
        let (even_low, odd_low) = first.deinterleave(second);
        let (even_high, odd_high) = third.deinterleave(fourth);
        let (a, c) = even_low.deinterleave(even_high);
        let (b, d) = odd_low.deinterleave(odd_high);
        [a, b, c, d]
    }

    #[inline(always)]
    fn store_four(self, [a, b, c, d]: [f32x16<S>; 4], rows: &mut [[f32; 4]], at: usize) {
        // Interleaving undoes the deinterleaving of `load_four`, in reverse order.
        let (even_low, even_high) = a.interleave(c);
        let (odd_low, odd_high) = b.interleave(d);
        let (first, second) = even_low.interleave(odd_low);
        let (third, fourth) = even_high.interleave(odd_high);
        let flat = rows[at..at + 16].as_flattened_mut();
        first.store_slice(&mut flat[..16]);
        second.store_slice(&mut flat[16..32]);
        third.store_slice(&mut flat[32..48]);
        fourth.store_slice(&mut flat[48..]);
    }

    #[inline(always)]
    fn store(self, value: f32x16<S>, row: &mut [f32], at: usize) {
        value.store_slice(&mut row[at..at + 16]);
    }

    #[inline(always)]
    fn whole(self, row: &[i32], at: usize) -> f32x16<S> {
        i32x16::from_slice(self.0, &row[at..at + 16]).to_float()
    }

    #[inline(always)]
    fn store_pixels_by(
        self,
        color: Vec3<f32x16<S>>,
        threshold: f32x16<S>,
        row: &mut [u32],
        at: usize,
    ) {
        // The conversion to integers rounds down, because the numbers are not negative.
        let [r, g, b] = each(
            color.0,
            #[inline(always)]
            |number| before_rounding(number, threshold).to_int::<i32x16<S>>(),
        );
        // The order of bytes in memory: red lowest, alpha 255 on top.
        let pixels = r | (g << 8) | (b << 16) | (255 << 24_i32);
        pixels.bitcast::<u32x16<S>>().store_slice(&mut row[at..at + 16]);
    }

    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, reason = "a power of two")]
    fn store_parts(
        self,
        color: Vec3<f32x16<S>>,
        threshold: f32x16<S>,
        rows: &mut [[u32; BATCH]; 3],
        at: usize,
    ) {
        for (row, number) in rows.iter_mut().zip(color.0) {
            let parts: i32x16<S> = (before_rounding(number, threshold) * PARTS as f32).to_int();
            parts.bitcast::<u32x16<S>>().store_slice(&mut row[at..at + 16]);
        }
    }

    #[inline(always)]
    fn set(self, number: f32) -> f32x16<S> {
        number.simd_into(self.0)
    }

    #[inline(always)]
    fn slots(self, (slots, count): (&[i32], usize), at: usize) -> Slots<S> {
        Slots { lanes: i32x16::from_slice(self.0, &slots[at..at + 16]), count }
    }

    #[inline(always)]
    fn pick(self, row: &[f32; SLOTS], slots: Slots<S>) -> f32x16<S> {
        pick(self.0, bytemuck::cast_ref(row), slots).bitcast()
    }

    #[inline(always)]
    fn any_more(self, a: f32x16<S>, b: f32x16<S>) -> bool {
        a.simd_gt(b).any_true()
    }
}

/// Computes 255 times a number plus the threshold, which is rounded down to a byte later.
#[inline(always)]
fn before_rounding<S: Simd>(number: f32x16<S>, threshold: f32x16<S>) -> f32x16<S> {
    let (zero, one) = (number.lift(0.0), number.lift(1.0));
    Real::min(Real::max(number, zero), one) * 255.0 + threshold
}

impl Number for f32 {
    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, reason = "rounding to the nearest f32 is meant")]
    fn from_f64(number: f64) -> Self {
        number as Self
    }

    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped before")]
    fn byte(self) -> u8 {
        (Real::min(Real::max(self, 0.0), 1.0) * 255.0 + 0.5) as u8
    }

    fn run(level: Level, kernel: impl Kernel<Self>) {
        dispatch!(level, simd => kernel.run(Sixteen(simd)));
    }
}

//! Computes one f64 at a time, as simply as possible. Tests compare [`Eight`](super::Eight) with
//! it.

use super::gather::SLOTS;
use super::lanes::{BATCH, Lanes, PARTS};
use super::real::Real;
use super::vec3::Vec3;
use marraztu_core::base::color::byte;

/// Computes in f64, one number at a time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Exact;

impl Lanes for Exact {
    type Number = f64;
    type R = f64;
    type Slots = usize;
    const LANES: usize = 1;

    fn load(self, row: &[f64], at: usize) -> f64 {
        row[at]
    }

    fn load_four(self, rows: &[[f64; 4]], at: usize) -> [f64; 4] {
        rows[at]
    }

    fn store_four(self, values: [f64; 4], rows: &mut [[f64; 4]], at: usize) {
        rows[at] = values;
    }

    fn store(self, value: f64, row: &mut [f64], at: usize) {
        row[at] = value;
    }

    fn whole(self, row: &[i32], at: usize) -> f64 {
        f64::from(row[at])
    }

    fn store_pixels(self, color: Vec3<f64>, row: &mut [u32], at: usize) {
        let [r, g, b] = color.0.map(byte);
        row[at] = u32::from_le_bytes([r, g, b, 255]);
    }

    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped before")]
    fn store_pixels_by(self, color: Vec3<f64>, threshold: f64, row: &mut [u32], at: usize) {
        let byte = |x: f64| (Real::min(Real::max(x, 0.0), 1.0) * 255.0 + threshold) as u8;
        let [r, g, b] = color.0.map(byte);
        row[at] = u32::from_le_bytes([r, g, b, 255]);
    }

    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "below 2^24")]
    fn store_parts(
        self,
        color: Vec3<f64>,
        threshold: f64,
        rows: &mut [[u32; BATCH]; 3],
        at: usize,
    ) {
        for (row, number) in rows.iter_mut().zip(color.0) {
            let clamped = Real::min(Real::max(number, 0.0), 1.0);
            row[at] = ((clamped * 255.0 + threshold) * PARTS) as u32;
        }
    }

    fn set(self, number: f64) -> f64 {
        number
    }

    #[expect(clippy::cast_sign_loss, reason = "places are not negative")]
    fn slots(self, (slots, _): (&[i32], usize), at: usize) -> usize {
        slots[at] as usize
    }

    fn pick(self, row: &[f64; SLOTS], slot: usize) -> f64 {
        row[slot]
    }

    fn any_more(self, a: f64, b: f64) -> bool {
        a > b
    }
}

//! The numbers that light is computed with, eight or sixteen at once.
//!
//! * [`Real`]: the operations used by the equations of light; `single` implements them in f32.
//! * [`Lanes`]: loads numbers from memory and stores them; [`Eight`] handles eight f64 at a time,
//!   [`Sixteen`] sixteen f32. A [`Kernel`] is work that is compiled for both.
//! * `gather`: gathers numbers from short tables.
//! * [`Power`]: powers of cosines.

mod doubles;
mod eight;
mod encoding;
#[cfg(test)]
mod exact;
pub(crate) mod gather;
mod lanes;
pub(crate) mod level;
pub(crate) mod power;
mod real;
mod single;
mod sixteen;
mod vec3;

pub(crate) use doubles::in_f64;
pub use eight::Eight;
pub(crate) use encoding::Encoding;
#[cfg(test)]
pub(crate) use exact::Exact;
pub use lanes::{BATCH, Kernel, Lanes, Number};
pub(crate) use level::dispatch;
pub use level::levels;
pub use power::Power;
pub use real::Real;
pub(crate) use single::log2;
pub use sixteen::Sixteen;
pub use vec3::Vec3;

/// The numbers of sixteen lanes.
pub(crate) const UP_TO_SIXTEEN: [i32; 16] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15];

/// Iterates over the indices of the set bits of a mask, the lowest first.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bits(pub(crate) u64);

impl Iterator for Bits {
    type Item = usize;

    #[inline(always)]
    fn next(&mut self) -> Option<usize> {
        if self.0 == 0 {
            return None;
        }
        let i = self.0.trailing_zeros() as usize;
        self.0 &= self.0 - 1;
        Some(i)
    }
}

//! The number types of pictures.

use crate::simd::dispatch;
use fearless_simd::Level;

use super::eight::Eight;
use super::lanes::Kernel;
use super::real::Real;
use super::sixteen::Sixteen;

/// A number type that pictures can be computed in.
pub trait Number:
    Real + Default + PartialEq + Into<f64> + Send + Sync + std::fmt::Debug + 'static
{
    /// Converts to the nearest number of this type.
    fn from_f64(number: f64) -> Self;
    /// Returns the byte nearest to 255 times the number, clamped and rounded. NaN gives 0.
    fn byte(self) -> u8;
    /// Runs a kernel with the lanes for such numbers and the instructions of this level.
    fn run(level: Level, kernel: impl Kernel<Self>);
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

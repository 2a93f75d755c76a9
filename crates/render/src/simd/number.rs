//! The number types of pictures.

use fearless_simd::{Level, dispatch};

use super::eight::Eight;
use super::lanes::Kernel;
use super::real::Real;
use super::sixteen::Sixteen;
use super::variant_lanes::VariantLanes;
use marraztu_core::accuracy::{Normalising, SpecularPower};

/// A number type that pictures can be computed in.
pub trait Number:
    Real + Default + PartialEq + Into<f64> + Send + Sync + std::fmt::Debug + 'static
{
    /// Converts to the nearest number of this type.
    fn from_f64(number: f64) -> Self;
    /// Returns the byte nearest to 255 times the number, clamped and rounded. NaN gives 0.
    fn byte(self) -> u8;
    /// The default variant of powers for such numbers.
    const POWER: SpecularPower;
    /// Runs a kernel with the lanes for such numbers and the instructions of this level.
    fn run(level: Level, kernel: impl Kernel<Self>);
    /// The same by a variant of roots, if there is one.
    fn run_variant(level: Level, variant: Option<Normalising>, kernel: impl Kernel<Self>);
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

    const POWER: SpecularPower = SpecularPower::Library;

    fn run(level: Level, kernel: impl Kernel<Self>) {
        dispatch!(level, simd => kernel.run(Eight(simd)));
    }

    fn run_variant(level: Level, variant: Option<Normalising>, kernel: impl Kernel<Self>) {
        match variant {
            None => Self::run(level, kernel),
            Some(variant) => {
                dispatch!(level, simd => {
                    kernel.run(VariantLanes { lanes: Eight(simd), variant });
                });
            }
        }
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

    const POWER: SpecularPower = SpecularPower::Polynomial;

    fn run(level: Level, kernel: impl Kernel<Self>) {
        dispatch!(level, simd => kernel.run(Sixteen(simd)));
    }

    fn run_variant(level: Level, variant: Option<Normalising>, kernel: impl Kernel<Self>) {
        match variant {
            None => Self::run(level, kernel),
            Some(variant) => {
                dispatch!(level, simd => {
                    kernel.run(VariantLanes { lanes: Sixteen(simd), variant });
                });
            }
        }
    }
}

//! The sRGB curve over [`Real`]: from linear values to stored values.

use super::power::Power;
use super::real::Real;

/// Encodes linear colours as sRGB: see [`encoded`](marraztu_core::base::color::encoded). In f32 the
/// error is below 1e-6.
#[derive(Clone, Debug)]
pub(crate) struct Encoding(Power);

impl Encoding {
    /// Prepares the power of the curve.
    pub(crate) fn new() -> Self {
        // The power is used from 0.0031308 up, where its binary logarithm divided by 2.4 is above
        // -4.
        Self(Power::new(1.0 / 2.4, -4.0))
    }

    /// Encodes a number, clamped to 0 to 1. NaN gives 0.
    #[inline(always)]
    pub(crate) fn of<R: Real>(&self, linear: R) -> R {
        let (zero, one) = (linear.lift(0.0), linear.lift(1.0));
        // The maximum comes first: it turns NaN into 0.
        let x = Real::min(Real::max(linear, zero), one);
        // Both pieces of the curve are computed in all lanes; the selection keeps one.
        let curve = x.power_times(&self.0, one) * x.lift(1.055) - x.lift(0.055);
        x.if_more(x.lift(0.003_130_8), curve, x * x.lift(12.92))
    }
}

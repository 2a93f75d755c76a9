//! Numbers whose reciprocal roots and powers are computed by a variant that the settings choose.
//!
//! Such a number carries its [`Normalising`]; a [`Power`] knows its own variant. All numbers of a
//! batch have the same variant, so it is matched once per root.

use std::ops::{Add, Div, Mul, Neg, Sub};

use fearless_simd::{Simd, SimdBase as _, f32x16};

use super::power::Power;
use super::real::Real;
use super::{power_variants, reciprocal_root};
use marraztu_core::accuracy::Normalising;

/// Numbers that can compute roots and powers by a variant.
pub trait VariantReal: Real {
    /// Like [`Real::reciprocal_root`], by a variant.
    #[must_use]
    fn reciprocal_root_by(self, variant: Normalising) -> Self;
    /// Like [`Real::power`], by the power's variant.
    #[must_use]
    fn power_by(self, power: &Power) -> Self;
}

impl<S: Simd> VariantReal for f32x16<S> {
    #[inline(always)]
    fn reciprocal_root_by(self, variant: Normalising) -> Self {
        reciprocal_root::sixteen(self, variant)
    }

    #[inline(always)]
    fn power_by(self, power: &Power) -> Self {
        if power.is_default() {
            return self.power(power);
        }
        let mut lanes: [f32; 16] = *self;
        power_variants::power_of_sixteen(power, &mut lanes);
        Self::from_slice(self.simd, &lanes)
    }
}

/// Numbers, with the variant of their roots.
#[derive(Clone, Copy, Debug)]
pub(crate) struct VariantNumber<R> {
    pub(super) value: R,
    pub(super) variant: Normalising,
}

impl<R> VariantNumber<R> {
    #[inline(always)]
    const fn with(self, value: R) -> Self
    where
        R: Copy,
    {
        Self { value, variant: self.variant }
    }
}

macro_rules! operators {
    ($($trait:ident $method:ident),+) => {
        $(
            impl<R: Real> $trait for VariantNumber<R> {
                type Output = Self;

                #[inline(always)]
                fn $method(self, other: Self) -> Self {
                    self.with(self.value.$method(other.value))
                }
            }
        )+
    };
}

operators! { Add add, Sub sub, Mul mul, Div div }

impl<R: Real> Neg for VariantNumber<R> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        self.with(-self.value)
    }
}

impl<R: VariantReal> Real for VariantNumber<R> {
    #[inline(always)]
    fn lift(self, constant: f64) -> Self {
        self.with(self.value.lift(constant))
    }

    #[inline(always)]
    fn reciprocal_root(self) -> Self {
        self.with(self.value.reciprocal_root_by(self.variant))
    }

    #[inline(always)]
    fn if_more(self, than: Self, yes: Self, no: Self) -> Self {
        self.with(self.value.if_more(than.value, yes.value, no.value))
    }

    #[inline(always)]
    fn power(self, power: &Power) -> Self {
        self.with(self.value.power_by(power))
    }

    #[inline(always)]
    fn power_times(self, power: &Power, factor: Self) -> Self {
        self.with(self.value.power_times(power, factor.value))
    }
}

impl<R: VariantReal> VariantReal for VariantNumber<R> {
    #[inline(always)]
    fn reciprocal_root_by(self, variant: Normalising) -> Self {
        self.with(self.value.reciprocal_root_by(variant))
    }

    #[inline(always)]
    fn power_by(self, power: &Power) -> Self {
        self.power(power)
    }
}

//! Light by a rare way, from the equations that all light is written in.
//!
//! A number that is chosen about carries the way in which its roots are taken; a power knows its own.
//! The compiler sees the same way in all numbers of a batch, so it is asked for once a root.

use std::ops::{Add, Div, Mul, Neg, Sub};

use fearless_simd::{Simd, SimdBase as _, f32x16};

use super::power::Power;
use super::root;
use crate::render::effects::BATCH;
use crate::render::numbers::pick::SLOTS;
use crate::render::numbers::real::{Machine, Real, Triple};
use crate::scene::Normalising;

/// Numbers that can be asked for a rare way.
pub trait ByWay: Real {
    /// As [`Real::reciprocal_root`], by a way that is named.
    #[must_use]
    fn reciprocal_root_by(self, way: Normalising) -> Self;
    /// As [`Real::power`], by the way that the power names.
    #[must_use]
    fn power_by(self, power: &Power) -> Self;
}

impl ByWay for f64 {
    #[inline(always)]
    fn reciprocal_root_by(self, way: Normalising) -> Self {
        root::one(self, way)
    }

    #[inline(always)]
    fn power_by(self, power: &Power) -> Self {
        power.of(self)
    }
}

impl<S: Simd> ByWay for f32x16<S> {
    #[inline(always)]
    fn reciprocal_root_by(self, way: Normalising) -> Self {
        root::sixteen(self, way)
    }

    #[inline(always)]
    fn power_by(self, power: &Power) -> Self {
        if power.is_own() {
            return self.power(power);
        }
        let mut lanes: [f32; 16] = *self;
        power.of_sixteen(&mut lanes);
        Self::from_slice(self.simd, &lanes)
    }
}

/// Numbers, and how their roots are taken.
#[derive(Clone, Copy, Debug)]
pub(in crate::render) struct Chosen<R> {
    value: R,
    way: Normalising,
}

impl<R> Chosen<R> {
    #[inline(always)]
    const fn with(self, value: R) -> Self
    where
        R: Copy,
    {
        Self { value, way: self.way }
    }
}

macro_rules! operators {
    ($($trait:ident $method:ident),+) => {
        $(
            impl<R: Real> $trait for Chosen<R> {
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

impl<R: Real> Neg for Chosen<R> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        self.with(-self.value)
    }
}

impl<R: ByWay> Real for Chosen<R> {
    #[inline(always)]
    fn lift(self, constant: f64) -> Self {
        self.with(self.value.lift(constant))
    }

    #[inline(always)]
    fn reciprocal_root(self) -> Self {
        self.with(self.value.reciprocal_root_by(self.way))
    }

    #[inline(always)]
    fn if_more(self, than: Self, yes: Self, no: Self) -> Self {
        self.with(self.value.if_more(than.value, yes.value, no.value))
    }

    #[inline(always)]
    fn power(self, power: &Power) -> Self {
        self.with(self.value.power_by(power))
    }
}

impl<R: ByWay> ByWay for Chosen<R> {
    #[inline(always)]
    fn reciprocal_root_by(self, way: Normalising) -> Self {
        self.with(self.value.reciprocal_root_by(way))
    }

    #[inline(always)]
    fn power_by(self, power: &Power) -> Self {
        self.power(power)
    }
}

/// What another machine does, by a rare way.
#[derive(Clone, Copy, Debug)]
pub(in crate::render) struct Choosing<M> {
    /// The other.
    pub(in crate::render) machine: M,
    /// How roots are taken.
    pub(in crate::render) way: Normalising,
}

impl<M: Machine> Choosing<M> {
    #[inline(always)]
    const fn chosen(self, value: M::R) -> Chosen<M::R> {
        Chosen { value, way: self.way }
    }
}

impl<M: Machine> Machine for Choosing<M> {
    type Number = M::Number;
    type R = Chosen<M::R>;
    type Slots = M::Slots;
    const LANES: usize = M::LANES;

    #[inline(always)]
    fn load(self, row: &[M::Number], at: usize) -> Self::R {
        self.chosen(self.machine.load(row, at))
    }

    #[inline(always)]
    fn load_four(self, rows: &[[M::Number; 4]], at: usize) -> [Self::R; 4] {
        let [a, b, c, d] = self.machine.load_four(rows, at);
        [self.chosen(a), self.chosen(b), self.chosen(c), self.chosen(d)]
    }

    #[inline(always)]
    fn store_four(self, values: [Self::R; 4], rows: &mut [[M::Number; 4]], at: usize) {
        let [a, b, c, d] = values;
        self.machine.store_four([a.value, b.value, c.value, d.value], rows, at);
    }

    #[inline(always)]
    fn store(self, value: Self::R, row: &mut [M::Number], at: usize) {
        self.machine.store(value.value, row, at);
    }

    #[inline(always)]
    fn whole(self, row: &[i32], at: usize) -> Self::R {
        self.chosen(self.machine.whole(row, at))
    }

    #[inline(always)]
    fn store_pixels(self, Triple([r, g, b]): Triple<Self::R>, row: &mut [u32], at: usize) {
        self.machine.store_pixels(Triple([r.value, g.value, b.value]), row, at);
    }

    #[inline(always)]
    fn store_pixels_by(
        self,
        Triple([r, g, b]): Triple<Self::R>,
        threshold: Self::R,
        row: &mut [u32],
        at: usize,
    ) {
        let color = Triple([r.value, g.value, b.value]);
        self.machine.store_pixels_by(color, threshold.value, row, at);
    }

    #[inline(always)]
    fn store_parts(
        self,
        Triple([r, g, b]): Triple<Self::R>,
        threshold: Self::R,
        rows: &mut [[u32; BATCH]; 3],
        at: usize,
    ) {
        let color = Triple([r.value, g.value, b.value]);
        self.machine.store_parts(color, threshold.value, rows, at);
    }

    #[inline(always)]
    fn lift(self, constant: f64) -> Self::R {
        self.chosen(self.machine.lift(constant))
    }

    #[inline(always)]
    fn set(self, number: M::Number) -> Self::R {
        self.chosen(self.machine.set(number))
    }

    #[inline(always)]
    fn slots(self, slots: &[i32], at: usize) -> M::Slots {
        self.machine.slots(slots, at)
    }

    #[inline(always)]
    fn pick<const PAGES: usize>(self, row: &[M::Number; SLOTS], slots: M::Slots) -> Self::R {
        self.chosen(self.machine.pick::<PAGES>(row, slots))
    }

    #[inline(always)]
    fn any_more(self, a: Self::R, b: Self::R) -> bool {
        self.machine.any_more(a.value, b.value)
    }
}

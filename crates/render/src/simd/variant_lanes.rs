//! Lanes whose numbers compute reciprocal roots and powers by a variant.

use super::gather::SLOTS;
use super::lanes::{BATCH, Lanes};
use super::variant_real::VariantNumber;
use super::vec3::Vec3;
use marraztu_core::accuracy::Normalising;

/// Lanes that compute roots and powers by a variant.
#[derive(Clone, Copy, Debug)]
pub(crate) struct VariantLanes<M> {
    /// The lanes that load and store.
    pub(crate) lanes: M,
    /// The variant of roots.
    pub(crate) variant: Normalising,
}

impl<M: Lanes> VariantLanes<M> {
    /// A number that computes roots by the variant.
    #[inline(always)]
    pub(crate) const fn chosen(self, value: M::R) -> VariantNumber<M::R> {
        VariantNumber { value, variant: self.variant }
    }
}

impl<M: Lanes> Lanes for VariantLanes<M> {
    type Number = M::Number;
    type R = VariantNumber<M::R>;
    type Slots = M::Slots;
    const LANES: usize = M::LANES;

    #[inline(always)]
    fn load(self, row: &[M::Number], at: usize) -> Self::R {
        self.chosen(self.lanes.load(row, at))
    }

    #[inline(always)]
    fn load_four(self, rows: &[[M::Number; 4]], at: usize) -> [Self::R; 4] {
        let [a, b, c, d] = self.lanes.load_four(rows, at);
        [self.chosen(a), self.chosen(b), self.chosen(c), self.chosen(d)]
    }

    #[inline(always)]
    fn store_four(self, values: [Self::R; 4], rows: &mut [[M::Number; 4]], at: usize) {
        let [a, b, c, d] = values;
        self.lanes.store_four([a.value, b.value, c.value, d.value], rows, at);
    }

    #[inline(always)]
    fn store(self, value: Self::R, row: &mut [M::Number], at: usize) {
        self.lanes.store(value.value, row, at);
    }

    #[inline(always)]
    fn whole(self, row: &[i32], at: usize) -> Self::R {
        self.chosen(self.lanes.whole(row, at))
    }

    #[inline(always)]
    fn store_pixels(self, Vec3([r, g, b]): Vec3<Self::R>, row: &mut [u32], at: usize) {
        self.lanes.store_pixels(Vec3([r.value, g.value, b.value]), row, at);
    }

    #[inline(always)]
    fn store_pixels_by(
        self,
        Vec3([r, g, b]): Vec3<Self::R>,
        threshold: Self::R,
        row: &mut [u32],
        at: usize,
    ) {
        let color = Vec3([r.value, g.value, b.value]);
        self.lanes.store_pixels_by(color, threshold.value, row, at);
    }

    #[inline(always)]
    fn store_parts(
        self,
        Vec3([r, g, b]): Vec3<Self::R>,
        threshold: Self::R,
        rows: &mut [[u32; BATCH]; 3],
        at: usize,
    ) {
        let color = Vec3([r.value, g.value, b.value]);
        self.lanes.store_parts(color, threshold.value, rows, at);
    }

    #[inline(always)]
    fn lift(self, constant: f64) -> Self::R {
        self.chosen(self.lanes.lift(constant))
    }

    #[inline(always)]
    fn set(self, number: M::Number) -> Self::R {
        self.chosen(self.lanes.set(number))
    }

    #[inline(always)]
    fn slots(self, slots: &[i32], at: usize) -> M::Slots {
        self.lanes.slots(slots, at)
    }

    #[inline(always)]
    fn pick<const PAGES: usize>(self, row: &[M::Number; SLOTS], slots: M::Slots) -> Self::R {
        self.chosen(self.lanes.pick::<PAGES>(row, slots))
    }

    #[inline(always)]
    fn any_more(self, a: Self::R, b: Self::R) -> bool {
        self.lanes.any_more(a.value, b.value)
    }
}

//! A mip level of a texture, and fetching its texels for sixteen pixels.

use fearless_simd::{
    Select as _, Simd, SimdBase as _, SimdCombine as _, SimdFloat as _, SimdMask as _, f32x16,
    i32x4, i32x16,
};

use super::{Decode, LEVELS, Positions, Sampler, between};
use crate::render::simd::gather::SLOTS;
use crate::render::simd::{Lanes as _, Sixteen, Vec3};
use crate::scene::Wrap;

/// The mip levels that sixteen pixels read.
#[derive(Clone, Copy)]
pub(super) struct MipLevel<S: Simd> {
    /// Their level, if it is the same for all.
    one: Option<usize>,
    numbers: i32x16<S>,
    /// Their sides over those of the first level.
    scale: [f32x16<S>; 2],
    width: i32x16<S>,
    height: i32x16<S>,
}

/// The four texels around sixteen positions.
pub(super) struct Footprint<S: Simd> {
    /// Left and right in the lower row, and in the upper one.
    pub(super) texels: [[i32x16<S>; 2]; 2],
    /// The weight of the right ones.
    pub(super) s: f32x16<S>,
    /// That of the upper ones.
    pub(super) t: f32x16<S>,
}

impl<S: Simd> MipLevel<S> {
    #[inline(always)]
    pub(super) fn of(sampler: &Sampler<'_>, simd: S, numbers: i32x16<S>) -> Self {
        let (low, high) = (numbers.reduce_min(), numbers.reduce_max());
        let [widths, heights] = &sampler.sizes;
        let lanes = Sixteen(simd);
        let one = (low == high).then(|| low.cast_unsigned() as usize % LEVELS);
        let [width, across] = sides_of(lanes, widths, numbers, one);
        let [height, up] = sides_of(lanes, heights, numbers, one);
        let (width, height) = (width.to_int(), height.to_int());
        Self { one, numbers, scale: [across, up], width, height }
    }

    /// The first level, for all pixels.
    #[inline(always)]
    pub(super) fn first(sampler: &Sampler<'_>, simd: S) -> Self {
        let [widths, heights] = &sampler.sizes;
        let width = f32x16::splat(simd, widths[0]).to_int();
        let height = f32x16::splat(simd, heights[0]).to_int();
        let one = f32x16::splat(simd, 1.0);
        let numbers = i32x16::splat(simd, 0);
        Self { one: Some(0), numbers, scale: [one, one], width, height }
    }

    /// The texels at some positions.
    #[inline(always)]
    pub(super) fn nearest(
        &self,
        simd: S,
        sampler: &Sampler<'_>,
        [x, y]: Positions<S>,
    ) -> i32x16<S> {
        // A position on the upper border is that of the last texel.
        let column = x.to_int::<i32x16<S>>().min(self.width - 1);
        let row = y.to_int::<i32x16<S>>().min(self.height - 1);
        self.fetch(simd, sampler, [column, row])
    }

    /// Interpolates between four texels: red, green and blue from 0 to 255.
    #[inline(always)]
    pub(super) fn bilinear<D: Decode>(
        &self,
        simd: S,
        sampler: &Sampler<'_>,
        position: Positions<S>,
    ) -> Vec3<f32x16<S>> {
        let Footprint { texels: [lower, upper], s, t } = self.footprint(simd, sampler, position);
        let below = between(D::channels(lower[0]), D::channels(lower[1]), s);
        let above = between(D::channels(upper[0]), D::channels(upper[1]), s);
        between(below, above, t)
    }

    /// The four texels around some positions.
    #[inline(always)]
    pub(super) fn footprint(
        &self,
        simd: S,
        sampler: &Sampler<'_>,
        [x, y]: Positions<S>,
    ) -> Footprint<S> {
        let (x, y) = (x * self.scale[0] - 0.5, y * self.scale[1] - 0.5);
        let (column, row) = (x.floor(), y.floor());
        let wrap = sampler.levels[0].wrap;
        let columns = beside(column.to_int(), self.width, wrap);
        let [lower, upper] = beside(row.to_int(), self.height, wrap);
        let lower = self.fetch_beside(simd, sampler, columns, lower);
        let upper = self.fetch_beside(simd, sampler, columns, upper);
        Footprint { texels: [lower, upper], s: x - column, t: y - row }
    }

    /// The texels at some columns and rows of the picture; rows count upwards.
    #[inline(always)]
    fn fetch(&self, simd: S, sampler: &Sampler<'_>, [column, row]: [i32x16<S>; 2]) -> i32x16<S> {
        self.fetch_at(simd, sampler, &self.places([column, row]))
    }

    #[inline(always)]
    fn fetch_at(&self, simd: S, sampler: &Sampler<'_>, places: &[i32; 16]) -> i32x16<S> {
        let pixels = self.pixels(sampler);
        let mut texels = [0; 16];
        for (lane, texel) in texels.iter_mut().enumerate() {
            *texel = texel_of(pixels(lane), places[lane]);
        }
        i32x16::from_slice(simd, &texels)
    }

    /// The texels at some columns of some rows, and those at the columns on their right. These are
    /// neighbours in memory, but at the border of the texture, so that two texels are one fetch:
    /// one triangle over 1920 x 1080 pixels takes 0.82 of the time (bilinear, AVX-512).
    #[inline(always)]
    fn fetch_beside(
        &self,
        simd: S,
        sampler: &Sampler<'_>,
        [left, right]: [i32x16<S>; 2],
        row: i32x16<S>,
    ) -> [i32x16<S>; 2] {
        let places = self.places([left, row]);
        let apart = !right.simd_eq(left + 1).to_bitmask() & 0xffff;
        if apart != 0 {
            return self.fetch_apart(simd, sampler, [&places, &self.places([right, row])]);
        }
        let pixels = self.pixels(sampler);
        let four = |lane: usize| {
            let pair = |lane: usize| two_texels_of(pixels(lane), places[lane]);
            let ([a, b], [c, d]) = (pair(lane), pair(lane + 1));
            i32x4::from_slice(simd, &[a, b, c, d])
        };
        // In registers: sixteen that were stored one by one are read back late.
        let low = four(0).combine(four(2)).combine(four(4).combine(four(6)));
        let high = four(8).combine(four(10)).combine(four(12).combine(four(14)));
        low.deinterleave(high).into()
    }

    /// The texels at some pairs of places.
    #[cold]
    #[inline(never)]
    fn fetch_apart(
        &self,
        simd: S,
        sampler: &Sampler<'_>,
        places: [&[i32; 16]; 2],
    ) -> [i32x16<S>; 2] {
        places.map(|places| self.fetch_at(simd, sampler, places))
    }

    /// The places of texels among the pixels of their level.
    #[inline(always)]
    fn places(&self, [column, row]: [i32x16<S>; 2]) -> [i32; 16] {
        // The picture's own rows run down.
        ((self.height - 1 - row) * self.width + column).into()
    }

    /// The pixels of the level of each lane.
    #[inline(always)]
    fn pixels<'a>(&self, sampler: &'a Sampler<'_>) -> impl Fn(usize) -> &'a [[u8; 4]] {
        let one = self.one.map(|level| sampler.levels[level].picture.pixels());
        let numbers = <[i32; 16]>::from(self.numbers);
        #[inline(always)]
        move |lane| one.unwrap_or_else(|| sampler.pixels_of(numbers[lane]))
    }
}

/// The sides of some levels, and those over the first level's; `one` is the level of all lanes, if
/// they have the same.
#[inline(always)]
fn sides_of<S: Simd>(
    lanes: Sixteen<S>,
    sides: &[f32; SLOTS],
    numbers: i32x16<S>,
    one: Option<usize>,
) -> [f32x16<S>; 2] {
    if let Some(level) = one {
        return [lanes.set(sides[level]), lanes.set(sides[level] / sides[0])];
    }
    let side = lanes.pick::<1>(sides, numbers);
    [side, side / lanes.set(sides[0])]
}

/// A texel by its place; 0 for lanes without a pixel, whose places are arbitrary.
#[inline(always)]
fn texel_of(pixels: &[[u8; 4]], place: i32) -> i32 {
    pixels.get(place.cast_unsigned() as usize).map_or(0, |texel| i32::from_le_bytes(*texel))
}

/// A texel and the next one; any two for lanes without a pixel.
#[inline(always)]
fn two_texels_of(pixels: &[[u8; 4]], place: i32) -> [i32; 2] {
    let Some(last) = pixels.len().checked_sub(2) else { return [0; 2] };
    // This costs less than a branch.
    let place = (place.cast_unsigned() as usize).min(last);
    [pixels[place], pixels[place + 1]].map(i32::from_le_bytes)
}

/// A column or row, which is at least -1, and the next one, both brought into the picture.
#[inline(always)]
fn beside<S: Simd>(i: i32x16<S>, count: i32x16<S>, wrap: Wrap) -> [i32x16<S>; 2] {
    let zero = i32x16::splat(i.simd, 0);
    let next = i + 1;
    match wrap {
        Wrap::Repeat => [i.simd_lt(0).select(count - 1, i), next.simd_ge(count).select(zero, next)],
        Wrap::Clamp => [i.max(zero).min(count - 1), next.min(count - 1)],
    }
}

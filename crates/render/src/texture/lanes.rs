//! Samples textures sixteen pixels at a time.
//!
//! Positions, texels and weights follow [`sample`](super::sample) and [`mips`](super::mips), in
//! f32. Only the texels themselves are fetched one by one.

mod decode;
mod mip_level;
mod sampler;
mod texel_places;

use fearless_simd::{
    Select as _, Simd, SimdBase as _, SimdFloat as _, SimdInt as _, SimdMask as _, f32x16, i32x16,
};

use self::decode::{between, channels};
use self::mip_level::{Footprint, MipLevel};
use super::sample::brightness;
use crate::lights::{Rows, load, store};
use crate::simd::{BATCH, Lanes as _, Real, Sixteen, Vec3, log2};
use marraztu_core::accuracy::Filter;
use marraztu_core::scene::Wrap;

pub(crate) use self::decode::{Decode, Linear, Stored, prepare_decoding};
pub(crate) use self::sampler::Sampler;
pub(crate) use self::texel_places::TexelPlaces;

/// The most samples along the longer side of a pixel. Graphics cards have the same limit.
pub(super) const MOST_PROBES: f32 = 16.0;

impl Sampler<'_> {
    /// Samples red, green and blue, as factors, at the first `len` places.
    ///
    /// Each step runs over all places before the next one starts. Within one place, each step waits
    /// for the one before, and processors only overlap instructions that are close together.
    ///
    /// Compiled as a separate function because many kernels sample.
    #[inline(always)]
    pub(crate) fn sample<S: Simd, D: Decode>(
        &self,
        simd: S,
        places: &mut TexelPlaces,
        len: usize,
        to: &mut Rows<f32>,
    ) {
        simd.vectorize(
            #[inline(always)]
            || self.sample_in::<S, D>(simd, places, len, to),
        );
    }

    #[inline(always)]
    fn sample_in<S: Simd, D: Decode>(
        &self,
        simd: S,
        places: &mut TexelPlaces,
        len: usize,
        to: &mut Rows<f32>,
    ) {
        let lanes = Sixteen(simd);
        // Wraps all positions first, in place. Those that the anisotropic filter moves are clamped
        // after that: next to a clamped texture, no sample may lie inside.
        let axes = if self.clamps_probes() { 0..0 } else { 0..2 };
        for axis in axes {
            let row = &mut places.position[axis];
            for at in (0..len).step_by(16) {
                lanes.store(self.reduced(lanes.load(row, at), axis), row, at);
            }
        }
        let first = MipLevel::first(self, simd);
        match self.filter {
            Filter::Nearest => {
                for at in (0..len).step_by(16) {
                    let texels = first.nearest(simd, self, places.at(lanes, at));
                    let Vec3([r, g, b]) = D::channels(texels);
                    store(lanes, Vec3([r / 255.0, g / 255.0, b / 255.0]), to, at);
                }
            }
            Filter::Bilinear => {
                // Bilinear: all addresses first, then all fetches, so the fetches overlap.
                for at in (0..len).step_by(16) {
                    let around = first.around(simd, places.at(lanes, at));
                    places.finer.store(at, &around);
                }
                for at in (0..len).step_by(16) {
                    let around = places.finer.load(simd, at);
                    let color = first.texels(simd, self, &around).color::<D>();
                    store(lanes, color.times(lanes.set(1.0 / 255.0)), to, at);
                }
            }
            Filter::Trilinear | Filter::Anisotropic => {
                self.mipmapped::<S, D>(simd, places, len, to);
            }
        }
    }

    /// Returns whether positions are clamped after they have moved to the samples of a pixel.
    #[inline(always)]
    fn clamps_probes(&self) -> bool {
        self.filter == Filter::Anisotropic && self.levels[0].wrap == Wrap::Clamp
    }

    /// Samples alpha, from 0 to 1, at sixteen positions in texels of the first level.
    #[inline(always)]
    pub(crate) fn alpha<S: Simd>(&self, simd: S, position: [f32x16<S>; 2]) -> f32x16<S> {
        self.scalar::<S, Alpha>(simd, position)
    }

    /// Samples the brightness, from 0 to 1, at sixteen positions in texels of the first level.
    #[inline(always)]
    pub(crate) fn brightness<S: Simd>(&self, simd: S, position: [f32x16<S>; 2]) -> f32x16<S> {
        self.scalar::<S, Brightness>(simd, position)
    }

    #[inline(always)]
    fn scalar<S: Simd, N: OneNumber>(&self, simd: S, position: [f32x16<S>; 2]) -> f32x16<S> {
        let position = [self.reduced(position[0], 0), self.reduced(position[1], 1)];
        // The alpha test reads no mipmaps, so trilinear filters count as bilinear.
        let level = MipLevel::first(self, simd);
        let number = match self.filter {
            Filter::Nearest => N::of(level.nearest(simd, self, position)),
            Filter::Bilinear | Filter::Trilinear | Filter::Anisotropic => {
                let Footprint { texels, s, t } = level.footprint(simd, self, position);
                let [[a, b], [c, d]] = texels;
                let (a, b, c, d) = (N::of(a), N::of(b), N::of(c), N::of(d));
                let (below, above) = (a + (b - a) * s, c + (d - c) * s);
                below + (above - below) * t
            }
        };
        number * (1.0 / 255.0)
    }

    /// Wraps a coordinate in texels into the picture: 0 to its side.
    #[inline(always)]
    fn reduced<S: Simd>(&self, x: f32x16<S>, axis: usize) -> f32x16<S> {
        let side = self.sizes[axis][0];
        let zero = x.lift(0.0);
        match self.levels[0].wrap {
            Wrap::Clamp => Real::min(Real::max(x, zero), f32x16::splat(x.simd, side)),
            Wrap::Repeat => {
                // The floor can be wrong by one repetition because of rounding; the two selections
                // correct it.
                let x = x - (x * (1.0 / side)).floor() * side;
                let x = x.simd_lt(0.0).select(x + side, x);
                x.simd_ge(side).select(x - side, x)
            }
        }
    }

    /// Averages trilinear samples along the longer side of each pixel's footprint, or takes one
    /// sample if the filter is trilinear.
    #[inline(always)]
    fn mipmapped<S: Simd, D: Decode>(
        &self,
        simd: S,
        places: &mut TexelPlaces,
        len: usize,
        to: &mut Rows<f32>,
    ) {
        // If one sample suffices everywhere, the anisotropic filter takes the trilinear path.
        let most =
            if self.filter == Filter::Anisotropic { count_probes(simd, places, len) } else { 1.0 };
        let same = self.find_levels(simd, places, len);
        // The places move along the footprint, so the middles are kept.
        let middle = places.position;
        let mut sums = [[0.0; BATCH]; 3];
        let mut probe = 0.0;
        // Sampling is compiled once for both filters.
        loop {
            if most > 1.0 || self.clamps_probes() {
                self.go_to_probe(simd, places, len, (probe, &middle));
            }
            self.mix_levels::<S, D>(simd, places, (len, &same), to);
            if most > 1.0 {
                add_probe(simd, places, len, (probe, to), &mut sums);
            }
            probe += 1.0;
            if probe >= most {
                break;
            }
        }
        if most > 1.0 {
            for (to, sums) in to.iter_mut().zip(&sums) {
                to[..len].copy_from_slice(&sums[..len]);
            }
        }
    }

    /// Moves each place from the middle of its pixel to a sample, and wraps it. Missing samples
    /// repeat the last one.
    #[inline(always)]
    fn go_to_probe<S: Simd>(
        &self,
        simd: S,
        places: &mut TexelPlaces,
        len: usize,
        (probe, middle): (f32, &[[f32; BATCH]; 2]),
    ) {
        let lanes = Sixteen(simd);
        for at in (0..len).step_by(16) {
            let count = lanes.load(&places.probes, at);
            let own = Real::min(lanes.set(probe), count - 1.0);
            // The middles of N equal parts of the side, from -1/2 to 1/2.
            let part = (own + 0.5) / count - 0.5;
            for (axis, middle) in middle.iter().enumerate() {
                let way = lanes.load(&places.longer[axis], at) * part;
                let position = self.reduced(lanes.load(middle, at) + way, axis);
                lanes.store(position, &mut places.position[axis], at);
            }
        }
    }

    /// Computes the two levels of each place and the weight of the coarser one. Returns the finer
    /// level of each group of sixteen places, if all of them share one.
    #[inline(always)]
    fn find_levels<S: Simd>(
        &self,
        simd: S,
        places: &mut TexelPlaces,
        len: usize,
    ) -> [Option<usize>; BATCH / 16] {
        let lanes = Sixteen(simd);
        #[expect(clippy::cast_precision_loss, reason = "at most 16")]
        let last = lanes.set((self.levels.len() - 1) as f32);
        let (zero, one) = (lanes.set(0.0), lanes.set(1.0));
        let mut same = [None; BATCH / 16];
        // log2 of the squared footprint, halved, is log2 of the footprint.
        for (at, same) in (0..len).step_by(16).zip(&mut same) {
            // Footprints below one texel magnify the texture and read the first level.
            let level = log2(Real::max(lanes.load(&places.footprint, at), one)) * 0.5;
            let level = Real::max(Real::min(level, last), zero);
            let own = level.floor();
            lanes.store(own, &mut places.levels[0], at);
            lanes.store(level - own, &mut places.levels[1], at);
            // With one level in all lanes, its size and its pixels are looked up only once.
            let number: i32x16<S> = own.to_int();
            let first = number[0];
            *same = number.simd_eq(first).all_true().then_some(first.cast_unsigned() as usize);
        }
        same
    }

    /// Samples the two levels of each place, and mixes them.
    #[inline(always)]
    fn mix_levels<S: Simd, D: Decode>(
        &self,
        simd: S,
        places: &mut TexelPlaces,
        (len, same): (usize, &[Option<usize>; BATCH / 16]),
        to: &mut Rows<f32>,
    ) {
        let lanes = Sixteen(simd);
        // First loop: the addresses. The coarser level is skipped if no place of the group needs
        // it.
        for (at, same) in (0..len).step_by(16).zip(same) {
            let position = places.at(lanes, at);
            let around = self.level::<S, 0>(simd, places, at, *same).around(simd, position);
            places.finer.store(at, &around);
            if lanes.load(&places.levels[1], at).simd_gt(0.0).any_true() {
                let around = self.level::<S, 1>(simd, places, at, *same).around(simd, position);
                places.coarser.store(at, &around);
            }
        }
        // Second loop: fetching and mixing.
        for (at, same) in (0..len).step_by(16).zip(same) {
            let around = places.finer.load(simd, at);
            let finer = self.level::<S, 0>(simd, places, at, *same);
            let mut color = finer.texels(simd, self, &around).color::<D>();
            let part = lanes.load(&places.levels[1], at);
            if part.simd_gt(0.0).any_true() {
                let around = places.coarser.load(simd, at);
                let coarser = self.level::<S, 1>(simd, places, at, *same);
                let far = coarser.texels(simd, self, &around).color::<D>();
                color = between(color, far, part);
            }
            store(lanes, color.times(lanes.set(1.0 / 255.0)), to, at);
        }
    }

    /// Returns the finer level of sixteen places, or, if `UP` is 1, the next coarser one (the last
    /// level has no coarser one and is used again). `same` is the finer level if all places share
    /// it.
    #[inline(always)]
    #[expect(clippy::cast_precision_loss, reason = "at most 16")]
    fn level<S: Simd, const UP: usize>(
        &self,
        simd: S,
        places: &TexelPlaces,
        at: usize,
        same: Option<usize>,
    ) -> MipLevel<S> {
        let lanes = Sixteen(simd);
        let end = self.levels.len() - 1;
        let finer = lanes.load(&places.levels[0], at);
        let numbers = if UP == 0 { finer } else { Real::min(finer + 1.0, lanes.set(end as f32)) };
        MipLevel::of(self, simd, numbers, same.map(|level| (level + UP).min(end)))
    }
}

/// Computes the number of samples along the longer side of each pixel, and the footprint of one
/// sample. Returns the largest number.
///
/// The extension `EXT_texture_filter_anisotropic` of OpenGL: N = ceil(longer / shorter), at most
/// 16, and the level is that of longer / N. Sides shorter than a texel count as one.
#[inline(always)]
fn count_probes<S: Simd>(simd: S, places: &mut TexelPlaces, len: usize) -> f32 {
    let lanes = Sixteen(simd);
    let one = lanes.set(1.0);
    let mut most = one;
    for at in (0..len).step_by(16) {
        let longer = lanes.load(&places.footprint, at);
        let shorter = Real::max(lanes.load(&places.shorter, at), one);
        // Both sides are squared, so the root of their quotient is longer / shorter.
        let count = Real::max((longer / shorter).sqrt().ceil(), one);
        let count = Real::min(count, lanes.set(MOST_PROBES));
        // The squared footprint of one sample, which selects the level for longer / N.
        lanes.store(longer / (count * count), &mut places.footprint, at);
        lanes.store(count, &mut places.probes, at);
        most = Real::max(most, count);
    }
    <[f32; 16]>::from(most).into_iter().fold(1.0, f32::max)
}

/// Adds a sample to the sum of each place, with the weight 1/N.
#[inline(always)]
fn add_probe<S: Simd>(
    simd: S,
    places: &TexelPlaces,
    len: usize,
    (probe, texels): (f32, &Rows<f32>),
    sums: &mut Rows<f32>,
) {
    let lanes = Sixteen(simd);
    for at in (0..len).step_by(16) {
        let count = lanes.load(&places.probes, at);
        // Places with fewer samples have repeated their last one, which must not count again.
        let is_there = lanes.set(probe).simd_lt(count);
        let weight = is_there.select(lanes.set(1.0) / count, lanes.set(0.0));
        let sum = load(lanes, sums, at).plus(load(lanes, texels, at).times(weight));
        store(lanes, sum, sums, at);
    }
}

/// The single number that is read from a texel.
trait OneNumber {
    /// Extracts the numbers, from 0 to 255.
    fn of<S: Simd>(texels: i32x16<S>) -> f32x16<S>;
}

/// The texel's alpha.
struct Alpha;
/// The texel's brightness, with the weights of ITU-R BT.709. The brightness of a grey is exactly
/// its byte.
struct Brightness;

impl OneNumber for Alpha {
    #[inline(always)]
    fn of<S: Simd>(texels: i32x16<S>) -> f32x16<S> {
        // Shifting a signed integer copies the sign bit; the mask removes the copies.
        ((texels >> 24) & 255).to_float()
    }
}

impl OneNumber for Brightness {
    #[inline(always)]
    fn of<S: Simd>(texels: i32x16<S>) -> f32x16<S> {
        brightness(channels(texels))
    }
}

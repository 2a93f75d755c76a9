//! Samples textures sixteen pixels at a time.
//!
//! Positions, texels and weights are those of [`sample`](super::sample) and
//! [`mips`](super::mips), in f32; only the texels themselves are fetched one by one.

use std::sync::OnceLock;

use fearless_simd::{
    Select as _, Simd, SimdBase as _, SimdFloat as _, SimdInt as _, SimdMask as _, f32x16, i32x16,
};

use super::sample::{brightness, linear_factors};
use crate::accuracy::Filter;
use crate::base::once::get_or_compute;
use crate::render::simd::gather::SLOTS;
use crate::render::simd::{Lanes as _, Real, Sixteen, Vec3, log2};
use crate::scene::{Texture, Wrap};

/// Mip levels, at most: textures have at most 32,768 texels a side.
const LEVELS: usize = 16;

/// A texture, and the mip maps that its filter reads.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sampler<'a> {
    levels: &'a [Texture],
    filter: Filter,
    /// Width and height of each level.
    sizes: [[f32; SLOTS]; 2],
}

/// Sixteen positions on the texture in texels of its own size, reduced to one repetition.
type Positions<S> = [f32x16<S>; 2];

impl<'a> Sampler<'a> {
    /// Samples the first of these levels, or between them if the filter is trilinear. `None` if the
    /// texture has no texels.
    #[expect(clippy::cast_precision_loss, reason = "pictures have fewer than 2^24 pixels a side")]
    pub(crate) fn new(levels: &'a [Texture], filter: Filter) -> Option<Self> {
        let levels = &levels[..levels.len().min(LEVELS)];
        let mut sizes = [[1.0; SLOTS]; 2];
        for (i, level) in levels.iter().enumerate() {
            let size = level.picture.size();
            (sizes[0][i], sizes[1][i]) = (size.width as f32, size.height as f32);
        }
        let has_texels = levels.first()?.picture.size().area() > 0;
        has_texels.then_some(Self { levels, filter, sizes })
    }

    /// Whether the filter reads mip maps.
    pub(crate) fn reads_mips(&self) -> bool {
        self.filter == Filter::Trilinear
    }

    /// Red, green and blue, as factors, at sixteen positions in texels; `footprint` gives the
    /// square of the texels that a pixel covers.
    ///
    /// Compiled as a function of its own, since many kernels sample.
    #[inline(always)]
    pub(crate) fn sample<S: Simd, D: Decode>(
        &self,
        simd: S,
        position: [f32x16<S>; 2],
        footprint: impl FnOnce() -> f32x16<S>,
    ) -> Vec3<f32x16<S>> {
        let footprint = if self.reads_mips() { footprint() } else { position[0] };
        simd.vectorize(
            #[inline(always)]
            || self.sample_in::<S, D>(simd, position, footprint),
        )
    }

    #[inline(always)]
    fn sample_in<S: Simd, D: Decode>(
        &self,
        simd: S,
        position: [f32x16<S>; 2],
        footprint: f32x16<S>,
    ) -> Vec3<f32x16<S>> {
        let position = [self.reduced(position[0], 0), self.reduced(position[1], 1)];
        match self.filter {
            Filter::Nearest => self.nearest::<S, D>(simd, position),
            Filter::Bilinear => {
                let level = Level::of(self, simd, i32x16::splat(simd, 0));
                let color = level.bilinear::<D>(simd, self, position);
                color.times(f32x16::splat(simd, 1.0 / 255.0))
            }
            Filter::Trilinear => self.trilinear::<S, D>(simd, position, footprint),
        }
    }

    /// Alpha at sixteen positions in texels, from 0 to 1, of the texture's own size.
    #[inline(always)]
    pub(crate) fn alpha<S: Simd>(&self, simd: S, position: [f32x16<S>; 2]) -> f32x16<S> {
        self.scalar(simd, position, alpha_of)
    }

    /// The brightness at sixteen positions in texels, from 0 to 1, of the texture's own size.
    #[inline(always)]
    pub(crate) fn brightness<S: Simd>(&self, simd: S, position: [f32x16<S>; 2]) -> f32x16<S> {
        self.scalar(simd, position, brightness_of)
    }

    #[inline(always)]
    fn scalar<S: Simd>(
        &self,
        simd: S,
        position: [f32x16<S>; 2],
        of: impl Fn(i32x16<S>) -> f32x16<S>,
    ) -> f32x16<S> {
        let position = [self.reduced(position[0], 0), self.reduced(position[1], 1)];
        let level = Level::of(self, simd, i32x16::splat(simd, 0));
        let number = match self.filter {
            Filter::Nearest => of(level.nearest(simd, self, position)),
            Filter::Bilinear | Filter::Trilinear => {
                let Footprint { left, right, lower, upper, s, t } = level.footprint(self, position);
                let at = [[left, lower], [right, lower], [left, upper], [right, upper]];
                let [a, b, c, d] = [
                    of(level.fetch(simd, self, at[0])),
                    of(level.fetch(simd, self, at[1])),
                    of(level.fetch(simd, self, at[2])),
                    of(level.fetch(simd, self, at[3])),
                ];
                let (below, above) = (a + (b - a) * s, c + (d - c) * s);
                below + (above - below) * t
            }
        };
        number * (1.0 / 255.0)
    }

    /// Whether the filter shows texels as they are.
    pub(crate) fn shows_texels(&self) -> bool {
        self.filter == Filter::Nearest
    }

    /// Brings a coordinate in texels into the picture: from 0 to its side.
    #[inline(always)]
    fn reduced<S: Simd>(&self, x: f32x16<S>, axis: usize) -> f32x16<S> {
        let side = self.sizes[axis][0];
        let zero = x.lift(0.0);
        match self.levels[0].wrap {
            Wrap::Clamp => Real::min(Real::max(x, zero), f32x16::splat(x.simd, side)),
            Wrap::Repeat => {
                // Off by one repetition at most, which the last two lines mend.
                let x = x - (x * (1.0 / side)).floor() * side;
                let x = x.simd_lt(0.0).select(x + side, x);
                x.simd_ge(side).select(x - side, x)
            }
        }
    }

    #[inline(always)]
    fn nearest<S: Simd, D: Decode>(&self, simd: S, position: Positions<S>) -> Vec3<f32x16<S>> {
        let level = Level::of(self, simd, i32x16::splat(simd, 0));
        let Vec3([r, g, b]) = D::channels(level.nearest(simd, self, position));
        Vec3([r / 255.0, g / 255.0, b / 255.0])
    }

    #[inline(always)]
    fn trilinear<S: Simd, D: Decode>(
        &self,
        simd: S,
        position: Positions<S>,
        footprint: f32x16<S>,
    ) -> Vec3<f32x16<S>> {
        let one = f32x16::splat(simd, 1.0);
        #[expect(clippy::cast_precision_loss, reason = "at most 16")]
        let last = f32x16::splat(simd, (self.levels.len() - 1) as f32);
        let level = log2(Real::max(footprint, one)) * 0.5;
        let level = Real::max(Real::min(level, last), f32x16::splat(simd, 0.0));
        let below = level.floor();
        let part = level - below;
        let below: i32x16<S> = below.to_int();
        let near = Level::of(self, simd, below).bilinear::<D>(simd, self, position);
        let color = if part.simd_gt(0.0).any_true() {
            let next = (below + 1).min(last.to_int::<i32x16<S>>());
            let far = Level::of(self, simd, next).bilinear::<D>(simd, self, position);
            between(near, far, part)
        } else {
            near
        };
        color.times(f32x16::splat(simd, 1.0 / 255.0))
    }
}

/// The mip levels that sixteen pixels read.
#[derive(Clone, Copy)]
struct Level<S: Simd> {
    /// Their level, if it is the same for all.
    one: Option<usize>,
    numbers: i32x16<S>,
    /// Their sides over those of the first level.
    scale: [f32x16<S>; 2],
    width: i32x16<S>,
    height: i32x16<S>,
}

/// The columns and rows of four texels, and the weights of the right and the upper ones.
#[derive(Clone, Copy)]
struct Footprint<S: Simd> {
    left: i32x16<S>,
    right: i32x16<S>,
    lower: i32x16<S>,
    upper: i32x16<S>,
    s: f32x16<S>,
    t: f32x16<S>,
}

impl<S: Simd> Level<S> {
    #[inline(always)]
    fn of(sampler: &Sampler<'_>, simd: S, numbers: i32x16<S>) -> Self {
        let (low, high) = (numbers.reduce_min(), numbers.reduce_max());
        let [widths, heights] = &sampler.sizes;
        let lanes = Sixteen(simd);
        let one = (low == high).then(|| low.cast_unsigned() as usize % LEVELS);
        let [width, across] = sides_of(lanes, widths, numbers, one);
        let [height, up] = sides_of(lanes, heights, numbers, one);
        let (width, height) = (width.to_int(), height.to_int());
        Self { one, numbers, scale: [across, up], width, height }
    }

    /// The texels at some positions.
    #[inline(always)]
    fn nearest(&self, simd: S, sampler: &Sampler<'_>, [x, y]: Positions<S>) -> i32x16<S> {
        // A position on the upper border is that of the last texel.
        let column = x.to_int::<i32x16<S>>().min(self.width - 1);
        let row = y.to_int::<i32x16<S>>().min(self.height - 1);
        self.fetch(simd, sampler, [column, row])
    }

    /// Interpolates between four texels: red, green and blue from 0 to 255.
    #[inline(always)]
    fn bilinear<D: Decode>(
        &self,
        simd: S,
        sampler: &Sampler<'_>,
        [x, y]: Positions<S>,
    ) -> Vec3<f32x16<S>> {
        let (x, y) = (x * self.scale[0] - 0.5, y * self.scale[1] - 0.5);
        let (column, row) = (x.floor(), y.floor());
        let (s, t) = (x - column, y - row);
        let wrap = sampler.levels[0].wrap;
        let [left, right] = beside(column.to_int(), self.width, wrap);
        let [lower, upper] = beside(row.to_int(), self.height, wrap);
        let below = between(
            D::channels(self.fetch(simd, sampler, [left, lower])),
            D::channels(self.fetch(simd, sampler, [right, lower])),
            s,
        );
        let above = between(
            D::channels(self.fetch(simd, sampler, [left, upper])),
            D::channels(self.fetch(simd, sampler, [right, upper])),
            s,
        );
        between(below, above, t)
    }

    /// The four texels around some positions.
    #[inline(always)]
    fn footprint(&self, sampler: &Sampler<'_>, [x, y]: Positions<S>) -> Footprint<S> {
        let (x, y) = (x * self.scale[0] - 0.5, y * self.scale[1] - 0.5);
        let (column, row) = (x.floor(), y.floor());
        let wrap = sampler.levels[0].wrap;
        let [left, right] = beside(column.to_int(), self.width, wrap);
        let [lower, upper] = beside(row.to_int(), self.height, wrap);
        Footprint { left, right, lower, upper, s: x - column, t: y - row }
    }

    /// The texels at some columns and rows of the picture; rows count upwards.
    #[inline(always)]
    fn fetch(&self, simd: S, sampler: &Sampler<'_>, [column, row]: [i32x16<S>; 2]) -> i32x16<S> {
        // The picture's own rows run down.
        let place = <[i32; 16]>::from((self.height - 1 - row) * self.width + column);
        let mut texels = [0; 16];
        if let Some(level) = self.one {
            let pixels = sampler.levels[level].picture.pixels();
            for (texel, place) in texels.iter_mut().zip(place) {
                *texel = texel_of(pixels, place);
            }
        } else {
            let numbers = <[i32; 16]>::from(self.numbers);
            for ((texel, place), number) in texels.iter_mut().zip(place).zip(numbers) {
                let level = number.cast_unsigned() as usize % LEVELS;
                if let Some(level) = sampler.levels.get(level) {
                    *texel = texel_of(level.picture.pixels(), place);
                }
            }
        }
        i32x16::from_slice(simd, &texels)
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

/// a + (b - a) part.
#[inline(always)]
fn between<R: Real>(a: Vec3<R>, b: Vec3<R>, part: R) -> Vec3<R> {
    a.plus(b.minus(a).times(part))
}

/// A texel by its place; 0 for lanes without a pixel, whose places are arbitrary.
#[inline(always)]
fn texel_of(pixels: &[[u8; 4]], place: i32) -> i32 {
    pixels.get(place.cast_unsigned() as usize).map_or(0, |texel| i32::from_le_bytes(*texel))
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

/// Red, green and blue of texels, from 0 to 255.
#[inline(always)]
fn channels<S: Simd>(texels: i32x16<S>) -> Vec3<f32x16<S>> {
    Vec3([
        (texels & 255).to_float(),
        ((texels >> 8) & 255).to_float(),
        ((texels >> 16) & 255).to_float(),
    ])
}

/// How bytes of texels become numbers.
pub(crate) trait Decode {
    /// Red, green and blue of texels, from 0 to 255.
    fn channels<S: Simd>(texels: i32x16<S>) -> Vec3<f32x16<S>>;
}

/// As they are stored.
pub(crate) struct Stored;
/// Decoded from sRGB.
pub(crate) struct Linear;

impl Decode for Stored {
    #[inline(always)]
    fn channels<S: Simd>(texels: i32x16<S>) -> Vec3<f32x16<S>> {
        channels(texels)
    }
}

impl Decode for Linear {
    #[inline(always)]
    fn channels<S: Simd>(texels: i32x16<S>) -> Vec3<f32x16<S>> {
        let simd = texels.simd;
        let table = decoded_bytes();
        let texels = <[i32; 16]>::from(texels);
        let mut rows = [[0.0; 16]; 3];
        for (lane, texel) in texels.into_iter().enumerate() {
            let [r, g, b, _] = texel.to_le_bytes();
            rows[0][lane] = table[usize::from(r)];
            rows[1][lane] = table[usize::from(g)];
            rows[2][lane] = table[usize::from(b)];
        }
        Vec3([
            f32x16::from_slice(simd, &rows[0]),
            f32x16::from_slice(simd, &rows[1]),
            f32x16::from_slice(simd, &rows[2]),
        ])
    }
}

/// 255 times the linear value of each byte.
fn decoded_bytes() -> &'static [f32; 256] {
    static TABLE: OnceLock<[f32; 256]> = OnceLock::new();
    #[expect(clippy::cast_possible_truncation, reason = "the nearest f32 is meant")]
    get_or_compute(&TABLE, || linear_factors().map(|linear| (255.0 * linear) as f32))
}

/// Computes the tables that decoding reads, so that threads compute none while they draw.
pub(crate) fn prepare_decoding() {
    decoded_bytes();
}

/// The brightness of texels, from 0 to 255; that of a grey is its byte, exactly. The weights are
/// those of ITU-R BT.709.
#[inline(always)]
fn brightness_of<S: Simd>(texels: i32x16<S>) -> f32x16<S> {
    brightness(channels(texels))
}

/// Alpha of texels, from 0 to 255.
#[inline(always)]
fn alpha_of<S: Simd>(texels: i32x16<S>) -> f32x16<S> {
    ((texels >> 24) & 255).to_float()
}

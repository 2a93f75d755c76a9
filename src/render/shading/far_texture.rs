//! Triangles over so many texels that f32 could not tell them apart: their positions on the texture
//! are computed in f64, and reduced to one repetition before they are rounded to f32.

use fearless_simd::{
    Select as _, Simd, SimdBase as _, SimdFloat as _, SimdNarrow as _, f32x16, f64x8,
};

use crate::base::math::each;
use crate::render::screen::weights::HomogeneousWeights;
use crate::render::texture::uv::Uvs;
use crate::scene::{Texture, Wrap};

/// The coordinates in repetitions beyond which positions are arbitrary even in f64.
const FARTHEST: f64 = 1e12;

/// A texture on one triangle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FarTexture {
    /// The slot of the triangle.
    pub(crate) slot: usize,
    weights: HomogeneousWeights,
    along: [Along; 2],
    wrap: Wrap,
}

/// The coordinates along one axis.
#[derive(Clone, Copy, Debug)]
struct Along {
    /// Those of the first corner in repetitions, and the differences of the others from it.
    first: f64,
    second: f64,
    third: f64,
    /// The least and the largest.
    low: f64,
    high: f64,
    /// Texels of one repetition.
    side: f64,
}

impl FarTexture {
    /// Sets up the triangle of a slot; `None` if its coordinates are too large.
    #[expect(clippy::cast_precision_loss, reason = "pictures have fewer than 2^53 pixels a side")]
    pub(crate) fn new(
        slot: usize,
        uvs: Uvs,
        texture: &Texture,
        weights: impl FnOnce() -> HomogeneousWeights,
    ) -> Option<Self> {
        let size = texture.picture.size();
        let sides = [size.width as f64, size.height as f64];
        let along = |axis: usize| {
            let [a, b, c] =
                each(uvs, |uv| uv[axis] * texture.scale[axis] + texture.offset[axis]);
            let (low, high) = (a.min(b).min(c), a.max(b).max(c));
            let side = sides[axis];
            Along { first: a, second: b - a, third: c - a, low, high, side }
        };
        let along = [along(0), along(1)];
        let near = along.iter().all(|it| it.low >= -FARTHEST && it.high <= FARTHEST);
        near.then(|| Self { slot, weights: weights(), along, wrap: texture.wrap })
    }

    /// The position at a pixel, in texels.
    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, reason = "the nearest f32 is meant")]
    pub(crate) fn at(&self, pixel: [i32; 2]) -> [f32; 2] {
        let ([second, third], _) = self.weights.at(pixel);
        self.along.map(|it| {
            let u = it.first + it.second * second + it.third * third;
            let u = if u > it.low { u } else { it.low };
            let u = if u < it.high { u } else { it.high };
            let own = match self.wrap {
                Wrap::Repeat => u - u.floor(),
                Wrap::Clamp => u.clamp(0.0, 1.0),
            };
            (own * it.side) as f32
        })
    }

    /// The same at two rows of eight pixels, from the first on: the same bits.
    #[inline(always)]
    pub(crate) fn of_two_rows<S: Simd>(&self, simd: S, [x, y]: [i32; 2]) -> [f32x16<S>; 2] {
        let (upper, _) = self.weights.of_row(simd, [x, y]);
        let (lower, _) = self.weights.of_row(simd, [x, y + 1]);
        let [u, v] = self.along;
        [
            u.of_row(upper, self.wrap).narrow(u.of_row(lower, self.wrap)),
            v.of_row(upper, self.wrap).narrow(v.of_row(lower, self.wrap)),
        ]
    }
}

impl Along {
    /// The texels at eight pixels.
    #[inline(always)]
    fn of_row<S: Simd>(self, [second, third]: [f64x8<S>; 2], wrap: Wrap) -> f64x8<S> {
        let simd = second.simd;
        let (low, high) = (f64x8::splat(simd, self.low), f64x8::splat(simd, self.high));
        let u = second * self.second + self.first + third * self.third;
        let u = u.simd_gt(low).select(u, low);
        let u = u.simd_lt(high).select(u, high);
        let own = match wrap {
            Wrap::Repeat => u - u.floor(),
            Wrap::Clamp => {
                let (zero, one) = (f64x8::splat(simd, 0.0), f64x8::splat(simd, 1.0));
                let u = u.simd_gt(zero).select(u, zero);
                u.simd_lt(one).select(u, one)
            }
        };
        own * self.side
    }
}

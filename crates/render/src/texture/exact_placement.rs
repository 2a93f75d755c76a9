//! Texture positions in f64, reduced to one repetition before rounding to f32: for triangles that
//! span more texels than f32 can tell apart, and for the alpha test. The sampler clamps those of
//! clamped textures, after their offsets.

use fearless_simd::{Select as _, Simd, SimdBase as _, SimdFloat as _, f64x8};

use super::uv::Uvs;
use marraztu_core::base::math::each;
use marraztu_core::scene::{Texture, Wrap};

/// The coordinate, in repetitions, beyond which positions are arbitrary even in f64.
const FARTHEST: f64 = 1e12;

/// The texture mapping of one triangle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ExactPlacement {
    along: [Along; 2],
    wrap: Wrap,
}

/// The coordinates along one axis.
#[derive(Clone, Copy, Debug)]
struct Along {
    /// The first corner's coordinate in repetitions, and the differences of the others from it.
    first: f64,
    second: f64,
    third: f64,
    /// The smallest and largest coordinate of the three corners.
    low: f64,
    high: f64,
    /// The number of texels in one repetition.
    side: f64,
}

impl ExactPlacement {
    /// Sets up a triangle. `None` if its coordinates are too large.
    #[expect(clippy::cast_precision_loss, reason = "pictures have fewer than 2^53 pixels a side")]
    pub(crate) fn new(uvs: Uvs, texture: &Texture) -> Option<Self> {
        let size = texture.picture.size();
        let sides = [size.width as f64, size.height as f64];
        let along = [0, 1].map(|axis: usize| {
            let [a, b, c] = each(uvs, |uv| uv[axis] * texture.scale[axis] + texture.offset[axis]);
            let (low, high) = (a.min(b).min(c), a.max(b).max(c));
            Along { first: a, second: b - a, third: c - a, low, high, side: sides[axis] }
        });
        let near = along.iter().all(|it| it.low >= -FARTHEST && it.high <= FARTHEST);
        near.then_some(Self { along, wrap: texture.wrap })
    }

    /// Computes the position, in texels, for these weights of the second and third corner.
    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, reason = "the nearest f32 is meant")]
    pub(crate) fn at(&self, [second, third]: [f64; 2]) -> [f32; 2] {
        self.along.map(|it| {
            let u = it.first + it.second * second + it.third * third;
            // Clamped to the triangle's range against rounding.
            let u = if u > it.low { u } else { it.low };
            let u = if u < it.high { u } else { it.high };
            // Whole repetitions are removed in f64, before the position is rounded to f32.
            let own = match self.wrap {
                Wrap::Repeat => u - u.floor(),
                Wrap::Clamp => u,
            };
            (own * it.side) as f32
        })
    }

    /// Computes eight positions with the same bits as [`Self::at`], before rounding to f32.
    #[inline(always)]
    pub(crate) fn of_row<S: Simd>(&self, weights: [f64x8<S>; 2]) -> [f64x8<S>; 2] {
        let [u, v] = self.along;
        [u.of_row(weights, self.wrap), v.of_row(weights, self.wrap)]
    }
}

impl Along {
    /// Computes the texel positions of eight pixels.
    #[inline(always)]
    fn of_row<S: Simd>(self, [second, third]: [f64x8<S>; 2], wrap: Wrap) -> f64x8<S> {
        let simd = second.simd;
        let (low, high) = (f64x8::splat(simd, self.low), f64x8::splat(simd, self.high));
        // Summed in the order of `at`, so that the bits are the same.
        let u = second * self.second + self.first + third * self.third;
        // Selections by comparison treat NaN alike on every processor.
        let u = u.simd_gt(low).select(u, low);
        let u = u.simd_lt(high).select(u, high);
        let own = match wrap {
            Wrap::Repeat => u - u.floor(),
            Wrap::Clamp => u,
        };
        own * self.side
    }
}

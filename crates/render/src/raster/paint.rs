//! Colours of triangles that are not small: with light at vertices, their pixels are coloured while
//! they are drawn, like [hits](super::hit_colors), with the same bits as pixels coloured later.

use fearless_simd::{
    Select as _, Simd, SimdBase as _, SimdMask as _, SimdNarrow as _, f32x16, f64x8, mask32x16,
    u32x16,
};

use super::bins::LargeTriangle;
use super::hit_colors::{Conversion, CornerColors};
use super::hits::PACK;
use super::large::InFront;
use crate::screen::coverage::{doubled_area, is_wide};
use crate::screen::tiles::BLOCK_PIXELS;
use crate::simd::Vec3;
use marraztu_core::base::math::each;

/// Colours the pixels of one triangle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Paint<'a> {
    /// 1 / the doubled area, also in f64 if the triangle is wide.
    per_area: f32,
    wide: Option<f64>,
    by_w: [f32; 3],
    /// The colours of the first corner, and the differences of the others from it.
    colors: [[f32; 3]; 3],
    conversion: Conversion<'a>,
}

impl<'a> Paint<'a> {
    /// Sets up a triangle that is not clipped.
    #[expect(clippy::cast_precision_loss, reason = "the nearest number is meant")]
    pub(crate) fn new(
        triangle: &LargeTriangle,
        [a, b, c]: &CornerColors,
        conversion: Conversion<'a>,
    ) -> Self {
        let corners = each(triangle.corners, |corner| corner.at());
        let area = doubled_area(corners).abs();
        let less = |of: &[f32; 4]| [of[0] - a[0], of[1] - a[1], of[2] - a[2]];
        Self {
            per_area: 1.0 / area as f32,
            wide: is_wide(corners).then(|| 1.0 / area as f64),
            by_w: each(triangle.corners, |corner| corner.inverse_w),
            colors: [[a[0], a[1], a[2]], less(b), less(c)],
            conversion,
        }
    }

    /// Computes the colours of two rows of a block from the edge functions of the second and third
    /// corner there.
    #[inline(always)]
    fn rows<S: Simd>(&self, pair: usize, [second, third]: [f32x16<S>; 2]) -> u32x16<S> {
        let simd = second.simd;
        let splat = |of: [f32; 3]| Vec3(each(of, |number| f32x16::splat(simd, number)));
        let [a, b, c] = self.colors;
        let corners = (splat(self.by_w), [splat(a), splat(b), splat(c)]);
        // Two rows of a block have sixteen of its 64 thresholds.
        let thresholds = &self.conversion.thresholds[pair % 4 * PACK..][..PACK];
        let thresholds = f32x16::from_slice(simd, thresholds);
        self.conversion.pixels(simd, [second, third], corners, thresholds)
    }
}

/// A block being painted, and the colours of the triangle.
#[derive(Debug)]
pub(crate) struct Painted<'a> {
    pub(super) paint: &'a Paint<'a>,
    pub(super) colors: &'a mut [u32; BLOCK_PIXELS],
}

impl Painted<'_> {
    /// Colours the pixels of a mask in two rows of a block, from the edge functions of the second
    /// and third corner there. The triangle must not be wide.
    #[inline(always)]
    pub(super) fn put<S: Simd>(&mut self, pair: usize, pixels: u64, edges: [f32x16<S>; 2]) {
        let linear = [edges[0] * self.paint.per_area, edges[1] * self.paint.per_area];
        self.put_linear(pair, pixels, linear);
    }

    #[inline(always)]
    fn put_linear<S: Simd>(&mut self, pair: usize, pixels: u64, linear: [f32x16<S>; 2]) {
        let simd = linear[0].simd;
        let colors = &mut self.colors.as_chunks_mut::<PACK>().0[pair % 4];
        // Hidden and uncovered pixels keep their colours.
        let before = u32x16::from_slice(simd, colors);
        let new = self.paint.rows(pair, linear);
        mask32x16::from_bitmask(simd, pixels).select(new, before).store_slice(colors);
    }
}

impl<S: Simd> InFront<S> for Painted<'_> {
    #[inline(always)]
    fn opaque(
        &mut self,
        _: S,
        pair: usize,
        pixels: u64,
        [upper, lower]: [[f64x8<S>; 2]; 2],
        _: f32x16<S>,
    ) -> u64 {
        // A wide triangle is scaled in f64, like pixels coloured later, for the same bits.
        match self.paint.wide {
            None => self.put(pair, pixels, [upper[0].narrow(lower[0]), upper[1].narrow(lower[1])]),
            Some(per_area) => {
                let second = (upper[0] * per_area).narrow(lower[0] * per_area);
                let third = (upper[1] * per_area).narrow(lower[1] * per_area);
                self.put_linear(pair, pixels, [second, third]);
            }
        }
        // Painting makes no holes.
        pixels
    }
}

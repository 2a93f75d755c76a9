//! Triangles that span more texels than f32 can tell apart: their texture positions are computed in
//! f64, and reduced to one repetition before rounding to f32.

use fearless_simd::{Simd, SimdNarrow as _, f32x16};

use crate::screen::weights::HomogeneousWeights;
use crate::texture::exact_placement::ExactPlacement;
use crate::texture::uv::Uvs;
use marraztu_core::scene::Texture;

/// A texture on one such triangle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FarTexture {
    /// The slot of the triangle.
    pub(crate) slot: usize,
    weights: HomogeneousWeights,
    placement: ExactPlacement,
}

impl FarTexture {
    /// Sets up the triangle of a slot. `None` if its coordinates are too large.
    pub(crate) fn new(
        slot: usize,
        uvs: Uvs,
        texture: &Texture,
        weights: impl FnOnce() -> HomogeneousWeights,
    ) -> Option<Self> {
        let placement = ExactPlacement::new(uvs, texture)?;
        Some(Self { slot, weights: weights(), placement })
    }

    /// Computes the position at a pixel, in texels.
    pub(crate) fn at(&self, pixel: [i32; 2]) -> [f32; 2] {
        self.placement.at(self.weights.at(pixel).0)
    }

    /// Computes the positions in two rows of eight pixels, with the same bits as [`Self::at`].
    #[inline(always)]
    pub(crate) fn of_two_rows<S: Simd>(&self, simd: S, [x, y]: [i32; 2]) -> [f32x16<S>; 2] {
        let (upper, _) = self.weights.of_row(simd, [x, y]);
        let (lower, _) = self.weights.of_row(simd, [x, y + 1]);
        let ([u, v], [u_below, v_below]) =
            (self.placement.of_row(upper), self.placement.of_row(lower));
        [u.narrow(u_below), v.narrow(v_below)]
    }
}

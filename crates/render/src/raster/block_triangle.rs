//! A triangle that is drawn block by block, by either kind of edge functions.

use fearless_simd::Simd;

use super::alpha_test::BlockHoles;
use super::depth_format::Format;
use super::edges_in_floats::FloatTriangle;
use super::large::{Large, Solid, Touched};
use crate::screen::coverage::PixelBox;
use crate::screen::sample_positions::SamplePositions;
use crate::screen::tiles::BLOCK_PIXELS;

/// A triangle that is drawn block by block, by its rule of coverage.
#[derive(Clone, Copy, Debug)]
pub(crate) enum BlockTriangle {
    Large(Large),
    Floats(FloatTriangle),
}

impl BlockTriangle {
    /// Returns the triangle's number in the frame.
    pub(crate) const fn number(&self) -> u32 {
        match self {
            Self::Large(large) => large.number,
            Self::Floats(triangle) => triangle.number,
        }
    }

    /// Returns the largest depth of the corners.
    pub(crate) const fn high(&self) -> f32 {
        match self {
            Self::Large(large) => large.high,
            Self::Floats(triangle) => triangle.high,
        }
    }

    /// Finds the touched blocks, like [`Large::blocks`].
    #[inline(always)]
    pub(crate) fn blocks<S: Simd, const N: usize>(
        &self,
        simd: S,
        area: PixelBox,
        sample_positions: &SamplePositions,
    ) -> Touched {
        match self {
            Self::Large(large) => large.blocks::<S, N>(simd, area, sample_positions),
            Self::Floats(triangle) => triangle.blocks::<S, N>(simd, area, sample_positions),
        }
    }

    /// Bounds the depth in a fully covered block, like [`Large::depths`].
    #[inline(always)]
    pub(crate) fn depths<const N: usize>(&self, block: usize) -> [f32; 2] {
        match self {
            Self::Large(large) => large.depths::<N>(block),
            Self::Floats(triangle) => triangle.depths::<N>(block),
        }
    }

    /// Draws the triangle into a block, like [`Large::draw`], with the alpha test if it has holes.
    #[inline(always)]
    pub(crate) fn draw<S: Simd>(
        &self,
        format: Format,
        simd: S,
        at: (usize, [i32; 2]),
        whole: bool,
        holes: Option<BlockHoles<'_, '_, '_>>,
        visibility: &mut [u64; BLOCK_PIXELS],
    ) {
        match (self, holes) {
            (Self::Large(large), None) => {
                large.draw(format, simd, at, whole, &mut Solid, visibility);
            }
            (Self::Large(large), Some(mut holes)) => {
                large.draw(format, simd, at, whole, &mut holes, visibility);
            }
            (Self::Floats(triangle), holes) => {
                triangle.draw(format, simd, at, whole, holes.as_ref(), visibility);
            }
        }
    }
}

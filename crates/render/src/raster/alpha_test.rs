//! The alpha test: a pixel with an opacity below one half shows the surface behind. The opacity is
//! the material's, times the texture's alpha, times the opacity map.
//!
//! Alpha is sampled sixteen pixels at a time in f32. Pixels that f32 cannot decide reliably are
//! sampled again in f64. Triangles and blocks are classified first: if all of their texels are
//! opaque, or all holes, they are not sampled: see [`Opacity::holes`].

use fearless_simd::{
    Simd, SimdBase as _, SimdFloat as _, SimdMask as _, SimdNarrow as _, f32x16, f64x8,
};

use super::geometry::ScreenGeometry;
use super::large::InFront;
use crate::frame::FramePlan;
use crate::frame::draw::Pipeline;
use crate::screen::tiles::BLOCK;
use crate::screen::weights::Weights;
use crate::simd::Bits;
use crate::texture::exact_placement::ExactPlacement;
use crate::texture::lanes::Sampler;
use crate::texture::opacity::{Channel, Holes, Opacity, between};
use crate::texture::uv::{Uvs, uv, uvs};
use marraztu_core::accuracy::Filter;

/// An f32 alpha closer to one half than this is undecided.
const NEAR: f32 = 1.0 / 128.0;
/// A position closer to a texel's border than this, in texels, is undecided. Positions in f32 are
/// off by at most 1/1024 texel.
const BORDER: f32 = 1.0 / 512.0;

/// The alpha-tested surface of a pipeline.
#[derive(Debug)]
pub(crate) struct AlphaSurface<'a> {
    pipeline: u32,
    opacity: Opacity<'a>,
    /// The samplers of its textures.
    samplers: [Option<Sampler<'a>>; 2],
}

/// The alpha test of one triangle.
#[derive(Debug)]
pub(crate) struct AlphaTest<'a, 'b> {
    surface: &'b AlphaSurface<'a>,
    weights: Weights,
    uvs: Uvs,
    /// The triangle's position on each texture; `None` if it is too large for lanes.
    placements: [Option<ExactPlacement>; 2],
}

impl<'a> AlphaSurface<'a> {
    /// Returns the surface of a triangle, cached in `last`. `None` if it has no holes.
    pub(crate) fn of<'b>(
        last: &'b mut Option<Self>,
        plan: &'a FramePlan,
        frame: &ScreenGeometry,
        number: u32,
    ) -> Option<&'b Self> {
        let (index, start) = frame.draw_of(number);
        let pipeline = plan.draws[index as usize].pipeline_of(number - start.number);
        // Neighbouring triangles mostly have the same surface.
        if last.as_ref().is_none_or(|last| last.pipeline != pipeline) {
            *last = Self::new(plan, pipeline);
        }
        last.as_ref()
    }

    fn new(plan: &'a FramePlan, pipeline: u32) -> Option<Self> {
        let Pipeline::Shaded(shaded) = &plan.pipelines[pipeline as usize] else { return None };
        let opacity = Opacity::of(shaded, plan.filter)?;
        let samplers = opacity
            .layers()
            .map(|layer| Sampler::new(std::slice::from_ref(layer?.texture), plan.filter));
        Some(Self { pipeline, opacity, samplers })
    }
}

impl<'a, 'b> AlphaTest<'a, 'b> {
    /// Sets up the alpha test of a triangle at samples with this offset. `None` if it has no
    /// texture coordinates.
    pub(crate) fn of(
        surface: &'b AlphaSurface<'a>,
        (plan, frame): (&FramePlan, &ScreenGeometry),
        number: u32,
        shift: [i32; 2],
    ) -> Option<Self> {
        let (index, start) = frame.draw_of(number);
        let draw = &plan.draws[index as usize];
        let number = number - start.number;
        let uvs = uvs(draw, number)?;
        let placements =
            surface.opacity.layers().map(|layer| ExactPlacement::new(uvs, layer?.texture));
        let weights = Weights::new(plan, draw, frame.corners_of(index), number, shift);
        Some(Self { surface, weights, uvs, placements })
    }

    /// Classifies a block, given by its first pixel.
    #[inline(always)]
    pub(crate) fn holes_in_block(&self, [x, y]: [i32; 2]) -> Holes {
        // Texture coordinates inside the block lie between the ones at its four corner pixels.
        let [right, bottom] = [x + BLOCK - 1, y + BLOCK - 1];
        let corners = [[x, y], [right, y], [x, bottom], [right, bottom]];
        let mut uvs = [[0.0; 2]; 4];
        for (corner, at) in uvs.iter_mut().zip(corners) {
            let Some(weights) = self.weights.projected(at) else { return Holes::Somewhere };
            *corner = uv(self.uvs, weights);
        }
        self.surface.opacity.holes(between(uvs))
    }

    /// Returns whether the weights follow from edge functions alone.
    pub(crate) fn has_edges(&self) -> bool {
        self.weights.follow_from_edges()
    }

    /// Returns a bit mask of the opaque pixels out of sixteen, from the edge functions of the
    /// second and third corner in two rows of eight. `pixel` returns the pixel of a lane. The
    /// pixels must be two rows starting at `first`, or any pixels if the weights follow from edge
    /// functions.
    #[inline(always)]
    pub(crate) fn opaque<S: Simd>(
        &self,
        simd: S,
        first: [i32; 2],
        edges: [[f64x8<S>; 2]; 2],
        pixels: u64,
        pixel: impl Fn(usize) -> [i32; 2],
    ) -> u64 {
        // f32 decides most pixels; the rest are sampled one by one in f64.
        let [solid, open] = self.decide(simd, first, edges).unwrap_or([0, u64::MAX]);
        let (mut solid, open) = (solid & !open & pixels, open & pixels);
        for lane in Bits(open) {
            solid |= u64::from(self.is_opaque(pixel(lane))) << lane;
        }
        solid
    }

    /// Returns whether the triangle is opaque at a pixel.
    #[inline(always)]
    pub(crate) fn is_opaque(&self, pixel: [i32; 2]) -> bool {
        self.surface.opacity.at(uv(self.uvs, self.weights.at(pixel))) >= 0.5
    }

    /// Tests two rows in f32: returns a mask of opaque pixels and a mask of undecided ones. It
    /// needs the edge functions of the second and third corner in each row.
    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, reason = "the nearest f32 is meant")]
    fn decide<S: Simd>(
        &self,
        simd: S,
        [x, y]: [i32; 2],
        [upper, lower]: [[f64x8<S>; 2]; 2],
    ) -> Option<[u64; 2]> {
        let AlphaSurface { opacity, samplers, .. } = self.surface;
        let upper = self.weights.of_row(simd, [x, y], upper)?;
        let lower = self.weights.of_row(simd, [x, y + 1], lower)?;
        // The opacity of the material comes first, then each texture scales it.
        let mut alpha = f32x16::splat(simd, opacity.of_material() as f32);
        let mut border = alpha.simd_lt(0.0);
        for (i, layer) in opacity.layers().iter().enumerate() {
            let Some(layer) = layer else { continue };
            let (placement, sampler) = (self.placements[i].as_ref()?, samplers[i].as_ref()?);
            let [u, v] = placement.of_row(upper);
            let [u_below, v_below] = placement.of_row(lower);
            let position = [u.narrow(u_below), v.narrow(v_below)];
            alpha = match layer.channel {
                Channel::Alpha => sampler.alpha(simd, position) * alpha,
                Channel::Brightness => sampler.brightness(simd, position) * alpha,
            };
            // Nearest filtering jumps at the border of a texel, so a position close to it is
            // undecided.
            if sampler.filter == Filter::Nearest {
                for at in position {
                    border |= ((at - at.floor()) - 0.5).abs().simd_gt(0.5 - BORDER);
                }
            }
        }
        // Close to one half, f32 and f64 may differ in the result of the test.
        let open = (alpha - 0.5).abs().simd_lt(NEAR) | border;
        Some([alpha.simd_gt(0.5).to_bitmask(), open.to_bitmask()])
    }
}

/// The alpha test of a triangle in one block.
#[derive(Clone, Copy)]
pub(crate) struct BlockHoles<'a, 'b, 'c> {
    pub(crate) test: &'c AlphaTest<'a, 'b>,
    /// The first pixel of the block.
    pub(crate) first: [i32; 2],
}

impl BlockHoles<'_, '_, '_> {
    /// Tests the pixels of a mask in two rows of the block one by one, and returns the opaque ones.
    pub(crate) fn opaque_pixels(&self, pair: usize, pixels: u64) -> u64 {
        let opaque = Bits(pixels).filter(|lane| self.test.is_opaque(self.pixel(pair, *lane)));
        opaque.fold(0, |opaque, lane| opaque | 1 << lane)
    }

    /// Returns the pixel of a lane in two rows of the block.
    fn pixel(&self, pair: usize, lane: usize) -> [i32; 2] {
        let [x, y] = self.first;
        let at = i32::try_from(16 * pair + lane).unwrap_or(0);
        [x + at % BLOCK, y + at / BLOCK]
    }
}

impl<S: Simd> InFront<S> for BlockHoles<'_, '_, '_> {
    #[inline(always)]
    fn opaque(
        &mut self,
        simd: S,
        pair: usize,
        pixels: u64,
        edges: [[f64x8<S>; 2]; 2],
        _: f32x16<S>,
    ) -> u64 {
        let pixel = |lane: usize| self.pixel(pair, lane);
        self.test.opaque(simd, pixel(0), edges, pixels, pixel)
    }
}

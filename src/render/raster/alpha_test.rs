//! The alpha test: a pixel whose opacity is below one half shows what is behind it. The opacity is
//! the material's, times the texture's alpha, times the map of opacity.
//!
//! Alpha is sampled sixteen pixels at a time in f32. Where that could decide otherwise than f64, it
//! is sampled again in f64.

use fearless_simd::{
    Simd, SimdBase as _, SimdFloat as _, SimdMask as _, SimdNarrow as _, f32x16, f64x8,
};

use super::geometry::ScreenGeometry;
use super::large::Holes;
use crate::accuracy::Filter;
use crate::render::frame::FramePlan;
use crate::render::frame::draw::{Pipeline, Shaded};
use crate::render::screen::tiles::BLOCK;
use crate::render::screen::weights::Weights;
use crate::render::simd::Vec3;
use crate::render::texture::exact_placement::ExactPlacement;
use crate::render::texture::lanes::Sampler;
use crate::render::texture::sample::{brightness, sample};
use crate::render::texture::uv::{Uvs, uv, uvs};
use crate::scene::Texture;

/// How near to one half an alpha in f32 decides nothing, and how near to a border, in texels, a
/// position does not tell the texel. Positions in f32 are off by 1/1024 texel at most.
const NEAR: f32 = 1.0 / 128.0;

/// A triangle that needs the alpha test.
#[derive(Debug)]
pub(crate) struct AlphaTest<'a> {
    weights: Weights,
    uvs: Uvs,
    opacity: f64,
    filter: Filter,
    /// The texture, if there is one; its alpha counts.
    texture: Option<Layer<'a>>,
    /// The map of opacity, if there is one.
    map: Option<Layer<'a>>,
}

/// A picture that makes a surface more or less opaque.
#[derive(Debug)]
struct Layer<'a> {
    texture: &'a Texture,
    channel: Channel,
    /// How lanes sample it; `None` if they cannot.
    lanes: Option<(ExactPlacement, Sampler<'a>)>,
}

/// What of a texel is its opacity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Channel {
    Alpha,
    Brightness,
}

impl<'a> Layer<'a> {
    fn new(plan: &FramePlan, uvs: Uvs, texture: &'a Texture, channel: Channel) -> Self {
        let placement = ExactPlacement::new(uvs, texture);
        let sampler = Sampler::new(std::slice::from_ref(texture), plan.filter);
        Self { texture, channel, lanes: placement.zip(sampler) }
    }

    /// A map of opacity: its alpha, or its brightness if all of it is opaque.
    fn of_map(plan: &FramePlan, uvs: Uvs, texture: &'a Texture) -> Self {
        let is_opaque = texture.picture.least_alpha() == 255;
        let channel = if is_opaque { Channel::Brightness } else { Channel::Alpha };
        Self::new(plan, uvs, texture, channel)
    }

    fn opacity(&self, uv: [f64; 2], filter: Filter) -> f64 {
        let [r, g, b, alpha] = sample::<f64>(self.texture, uv, filter);
        match self.channel {
            Channel::Alpha => alpha,
            Channel::Brightness => brightness(Vec3([r, g, b])),
        }
    }
}

impl<'a> AlphaTest<'a> {
    /// The alpha test of a triangle at samples with this offset; `None` if its pipeline has none.
    pub(crate) fn of(
        plan: &'a FramePlan,
        frame: &ScreenGeometry,
        number: u32,
        shift: [i32; 2],
    ) -> Option<Self> {
        let (index, start) = frame.draw_of(number);
        let draw = &plan.draws[index as usize];
        let number = number - start.number;
        let pipeline = &plan.pipelines[draw.pipeline_of(number) as usize];
        let Pipeline::Shaded(Shaded { cutout: Some(opacity), texture, opacity_map, .. }) = pipeline
        else {
            return None;
        };
        let uvs = uvs(draw, number)?;
        Some(Self {
            weights: Weights::new(plan, draw, frame.corners_of(index), number, shift),
            uvs,
            opacity: *opacity,
            filter: plan.filter,
            texture: texture.as_ref().map(|it| Layer::new(plan, uvs, it, Channel::Alpha)),
            map: opacity_map.as_ref().map(|it| Layer::of_map(plan, uvs, it)),
        })
    }

    /// Whether it passes the test at a pixel.
    #[inline(always)]
    pub(crate) fn is_opaque(&self, pixel: [i32; 2]) -> bool {
        self.opacity_at(pixel) >= 0.5
    }

    /// The opacity of a fragment: d of the material, times the alpha of its texture, times its
    /// map of opacity.
    #[inline(always)]
    pub(crate) fn opacity_at(&self, pixel: [i32; 2]) -> f64 {
        let uv = uv(self.uvs, self.weights.at(pixel));
        let layers = self.texture.iter().chain(&self.map);
        layers.fold(self.opacity, |opacity, layer| opacity * layer.opacity(uv, self.filter))
    }

    /// The pixels of two rows that are opaque and those that f32 cannot decide, a bit for each. The
    /// edge functions are those of the second and the third corner in each row.
    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, reason = "the nearest f32 is meant")]
    fn decide<S: Simd>(
        &self,
        simd: S,
        [x, y]: [i32; 2],
        [upper, lower]: [[f64x8<S>; 2]; 2],
    ) -> Option<[u64; 2]> {
        let upper = self.weights.of_row(simd, [x, y], upper)?;
        let lower = self.weights.of_row(simd, [x, y + 1], lower)?;
        let mut alpha = f32x16::splat(simd, self.opacity as f32);
        let mut border = alpha.simd_lt(0.0);
        for layer in self.texture.iter().chain(&self.map) {
            let (placement, sampler) = layer.lanes.as_ref()?;
            let [u, v] = placement.of_row(upper);
            let [u_below, v_below] = placement.of_row(lower);
            let position = [u.narrow(u_below), v.narrow(v_below)];
            alpha = match layer.channel {
                Channel::Alpha => sampler.alpha(simd, position) * alpha,
                Channel::Brightness => sampler.brightness(simd, position) * alpha,
            };
            if sampler.shows_texels() {
                for at in position {
                    border |= ((at - at.floor()) - 0.5).abs().simd_gt(0.5 - NEAR);
                }
            }
        }
        let open = (alpha - 0.5).abs().simd_lt(NEAR) | border;
        Some([alpha.simd_gt(0.5).to_bitmask(), open.to_bitmask()])
    }
}

/// The alpha test of a triangle in one block.
pub(crate) struct BlockHoles<'a, 'b> {
    pub(crate) test: &'b AlphaTest<'a>,
    /// The first pixel of the block in the picture.
    pub(crate) first: [i32; 2],
}

impl<S: Simd> Holes<S> for BlockHoles<'_, '_> {
    #[inline(always)]
    fn there_are(&self) -> bool {
        true
    }

    #[inline(always)]
    fn opaque(&self, simd: S, pair: usize, pixels: u64, edges: [[f64x8<S>; 2]; 2]) -> u64 {
        let [x, y] = self.first;
        let y = y + 2 * i32::try_from(pair).unwrap_or(0);
        let [solid, open] = self.test.decide(simd, [x, y], edges).unwrap_or([0, u64::MAX]);
        let (mut solid, mut open) = (solid & !open & pixels, open & pixels);
        while open != 0 {
            let lane = open.trailing_zeros();
            open &= open - 1;
            let at = lane.cast_signed();
            if self.test.is_opaque([x + at % BLOCK, y + at / BLOCK]) {
                solid |= 1 << lane;
            }
        }
        solid
    }
}

//! The alpha test: a pixel at which a texture's alpha is below one half shows what is behind it.

use super::geometry::ScreenGeometry;
use crate::accuracy::Filter;
use crate::render::frame::FramePlan;
use crate::render::frame::draw::{Pipeline, Shaded};
use crate::render::screen::weights::Weights;
use crate::render::texture::sample::sample;
use crate::render::texture::uv::{Uvs, uv, uvs};
use crate::scene::Texture;

/// A triangle that needs the alpha test.
#[derive(Debug)]
pub(crate) struct AlphaTest<'a> {
    weights: Weights<'a>,
    uvs: Uvs,
    texture: &'a Texture,
    opacity: f64,
    filter: Filter,
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
        let Pipeline::Shaded(Shaded { cutout: Some(opacity), texture: Some(texture), .. }) =
            pipeline
        else {
            return None;
        };
        Some(Self {
            weights: Weights::new(plan, draw, frame.corners_of(plan, index), number, shift),
            uvs: uvs(draw, number)?,
            texture,
            opacity: *opacity,
            filter: plan.filter,
        })
    }

    /// Whether it passes the test at a pixel.
    #[inline(always)]
    pub(crate) fn is_opaque(&self, pixel: [i32; 2]) -> bool {
        let uv = uv(self.uvs, self.weights.at(pixel));
        sample::<f64>(self.texture, uv, self.filter)[3] * self.opacity >= 0.5
    }
}

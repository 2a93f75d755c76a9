//! The inputs of shading.

use fearless_simd::Level;

use super::light::Lit;
use super::light_terms::LightTerms;
use crate::render::frame::FramePlan;
use crate::render::raster::geometry::ScreenGeometry;

/// Everything that shading reads of a frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ShadingContext<'a, T> {
    pub(crate) level: Level,
    pub(crate) plan: &'a FramePlan,
    pub(crate) frame: &'a ScreenGeometry,
    pub(crate) lit: &'a Lit<T>,
    pub(crate) terms: &'a LightTerms<T>,
}

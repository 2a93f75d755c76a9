//! The inputs of shading.

use fearless_simd::Level;

use super::face_colors::FaceColors;
use super::light::Lit;
use super::light_terms::LightTerms;
use crate::frame::FramePlan;
use crate::frame::color_path::ColorPaths;
use crate::raster::geometry::ScreenGeometry;
use crate::shadow::tracer::Tracer;

/// The parts of a frame that shading reads.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ShadingContext<'a, T> {
    pub(crate) level: Level,
    pub(crate) plan: &'a FramePlan,
    pub(crate) frame: &'a ScreenGeometry,
    pub(crate) lit: &'a Lit<T>,
    pub(crate) terms: &'a LightTerms<T>,
    /// The colours of triangles, if they are looked up.
    pub(crate) faces: Option<&'a FaceColors>,
    /// How pixels are coloured.
    pub(crate) paths: &'a ColorPaths,
    /// The tracer, if any light casts shadows.
    pub(crate) tracer: Option<&'a Tracer<'a>>,
}

impl<'a, T> ShadingContext<'a, T> {
    /// Returns the tracer for a draw, and the draw's own caster. `None` if the draw receives no
    /// shadows.
    pub(crate) fn tracer_of(&self, draw: u32) -> Option<(&'a Tracer<'a>, u32)> {
        let tracer = self.tracer?;
        Some((tracer, tracer.caster_of(draw)?))
    }
}

//! Which variant of a stage settings have chosen, if it is not the default.
//!
//! What every picture is drawn with is compiled for it alone. Every other choice of an axis stands beside
//! it in its stage, and is chosen once a batch, a draw or a tile: a choice that is not made costs a
//! comparison there, and nothing at a pixel.

use crate::accuracy::{
    Coverage, DepthFormat, Interpolation, Normalising, Rounding, Settings, SpecularPower,
    Subpixels, VertexArithmetic,
};
use crate::render::simd::Number;

/// By which ways a frame is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Variants {
    /// How vectors are brought to length 1.
    pub(crate) roots: Normalising,
    /// How powers of highlights are taken.
    pub(crate) powers: SpecularPower,
    /// How colours become bytes.
    pub(crate) rounding: Rounding,
    /// How vertices are placed.
    pub(crate) vertices: VertexArithmetic,
    /// What corners are snapped to.
    pub(crate) subpixels: Subpixels,
    /// Which pixels are covered.
    pub(crate) coverage: Coverage,
    /// How depths are kept.
    pub(crate) depth: DepthFormat,
    /// How what corners carry gets to pixels.
    pub(crate) interpolation: Interpolation,
}

impl Variants {
    /// Those that settings name.
    pub(crate) const fn of(settings: &Settings) -> Self {
        Self {
            roots: settings.normalising,
            powers: settings.power,
            rounding: settings.rounding,
            vertices: settings.vertices,
            subpixels: settings.subpixels,
            coverage: settings.coverage,
            depth: settings.depth,
            interpolation: settings.interpolation,
        }
    }

    /// How roots are taken, where it is not the way that all numbers have of their own.
    pub(crate) fn rare_roots(&self) -> Option<Normalising> {
        (self.roots != Normalising::Root).then_some(self.roots)
    }

    /// The same where powers are taken too: they may be rare with plain roots.
    pub(crate) fn rare_light<T: Number>(&self) -> Option<Normalising> {
        let plain = self.roots == Normalising::Root && self.powers == T::POWER;
        (!plain).then_some(self.roots)
    }

    /// Whether vertices get to the screen as they mostly do.
    pub(crate) fn has_plain_vertices(&self) -> bool {
        self.vertices == VertexArithmetic::F64
            && matches!(self.subpixels, Subpixels::Bits8 | Subpixels::Bits12)
    }

    /// Whether corners have a place of their own beside the one that lines begin at.
    pub(crate) fn has_fine_corners(&self) -> bool {
        self.subpixels == Subpixels::Bits12
    }

    /// Whether triangles are drawn one by one, pixel by pixel.
    pub(crate) fn draws_one_by_one(&self) -> bool {
        self.has_fine_corners()
            || self.coverage != Coverage::Exact
            || self.depth != DepthFormat::F32Reversed
    }

    /// Whether what a pixel takes from its triangle is found pixel by pixel.
    pub(crate) fn has_rare_places(&self) -> bool {
        self.has_fine_corners()
            || self.coverage != Coverage::Exact
            || self.interpolation != Interpolation::Perspective
    }

    /// Whether colours that are mixed between corners are mixed and rounded in a pixel's own way.
    pub(crate) fn mixes_one_by_one(&self) -> bool {
        self.has_rare_places() || self.rounding != Rounding::Nearest
    }

    /// Whether what is seen may be elsewhere than geometry says, so that nothing is left out for where
    /// it is.
    pub(crate) fn has_rare_geometry(&self) -> bool {
        !self.has_plain_vertices() || self.draws_one_by_one() || self.has_rare_places()
    }
}

//! The ways of drawing that few pictures ask for: history, and what is exacter than anybody sees.
//!
//! What every picture is drawn with is compiled for it alone. All else that an axis of accuracy offers
//! is here, beside it, and is chosen once a batch, a draw or a tile: so a choice that nobody makes costs
//! a comparison there, and nothing at a pixel.

pub(super) mod bytes;
mod chosen;
mod cover;
pub(super) mod depth;
pub(super) mod mips;
mod paint;
mod places;
mod points;
pub(super) mod power;
mod root;
pub(super) mod setup;
mod vertices;

pub use self::chosen::ByWay;
pub(super) use self::chosen::Choosing;
use super::numbers::real::Number;
use crate::scene::{
    Coverage, DepthFormat, Interpolation, Normalising, Rounding, Settings, SpecularPower,
    Subpixels, VertexArithmetic,
};

/// By which ways a frame is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Ways {
    /// How vectors are brought to length 1.
    pub(super) roots: Normalising,
    /// How powers of highlights are taken.
    pub(super) powers: SpecularPower,
    /// How colours become bytes.
    pub(super) rounding: Rounding,
    /// How vertices are placed.
    pub(super) vertices: VertexArithmetic,
    /// What corners are snapped to.
    pub(super) subpixels: Subpixels,
    /// Which pixels are covered.
    pub(super) coverage: Coverage,
    /// How depths are kept.
    pub(super) depth: DepthFormat,
    /// How what corners carry gets to pixels.
    pub(super) interpolation: Interpolation,
}

impl Ways {
    /// Those that settings name.
    pub(super) const fn of(settings: &Settings) -> Self {
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
    pub(super) fn rare_roots(&self) -> Option<Normalising> {
        (self.roots != Normalising::Root).then_some(self.roots)
    }

    /// The same where powers are taken too: they may be rare with plain roots.
    pub(super) fn rare_light<T: Number>(&self) -> Option<Normalising> {
        let plain = self.roots == Normalising::Root && self.powers == T::POWER;
        (!plain).then_some(self.roots)
    }

    /// Whether vertices get to the screen as they mostly do.
    pub(super) fn has_plain_vertices(&self) -> bool {
        self.vertices == VertexArithmetic::F64
            && matches!(self.subpixels, Subpixels::Bits8 | Subpixels::Bits12)
    }

    /// Whether corners have a place of their own beside the one that lines begin at.
    pub(super) fn has_fine_corners(&self) -> bool {
        self.subpixels == Subpixels::Bits12
    }

    /// Whether triangles are drawn one by one, pixel by pixel.
    pub(super) fn draws_one_by_one(&self) -> bool {
        self.has_fine_corners()
            || self.coverage != Coverage::Exact
            || self.depth != DepthFormat::F32Reversed
    }

    /// Whether what a pixel takes from its triangle is found pixel by pixel.
    pub(super) fn has_rare_places(&self) -> bool {
        self.has_fine_corners()
            || self.coverage != Coverage::Exact
            || self.interpolation != Interpolation::Perspective
    }

    /// Whether colours that are mixed between corners are mixed and rounded in a pixel's own way.
    pub(super) fn mixes_one_by_one(&self) -> bool {
        self.has_rare_places() || self.rounding != Rounding::Nearest
    }

    /// Whether what is seen may be elsewhere than geometry says, so that nothing is left out for where
    /// it is.
    pub(super) fn has_rare_geometry(&self) -> bool {
        !self.has_plain_vertices() || self.draws_one_by_one() || self.has_rare_places()
    }
}

//! The variant of each stage that the settings choose.
//!
//! The default of each stage is compiled by itself. Every other choice of an axis stands beside it
//! in its stage, and is selected once per batch, draw or tile: an unused variant costs a comparison
//! there, and nothing at a pixel.

use crate::accuracy::{
    BumpFilter, Coverage, DepthFormat, Filter, Interpolation, LightValues, Normalising, Rounding,
    Settings, ShadowMethod, SpecularPower, Subpixels, Tangents, Terminator, VertexArithmetic,
};
use crate::render::simd::Number;

/// How bytes of texels become numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Decoding {
    /// As they are stored.
    Stored,
    /// Decoded from sRGB.
    Linear,
}

/// The grid that corners are snapped to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Grid {
    /// 1/256 pixel.
    #[default]
    Usual,
    /// 1/4096 pixel.
    Fine,
}

impl Grid {
    /// The parts of a pixel, in each direction.
    #[must_use]
    pub const fn parts(self) -> i32 {
        match self {
            Self::Usual => 256,
            Self::Fine => 4096,
        }
    }

    /// An offset in 1/256 pixel, in parts of this grid.
    #[must_use]
    pub const fn offset(self, [x, y]: [i32; 2]) -> [i32; 2] {
        let times = self.parts() / Self::Usual.parts();
        [x * times, y * times]
    }
}

/// The variants of a frame's stages.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Variants {
    /// How vectors are brought to length 1.
    pub(crate) roots: Normalising,
    /// How the power of a highlight is computed.
    pub(crate) powers: SpecularPower,
    /// How colours become bytes.
    pub(crate) rounding: Rounding,
    /// The arithmetic that transforms vertices.
    pub(crate) vertices: VertexArithmetic,
    /// The subpixel grid that corners are snapped to.
    pub(crate) subpixels: Subpixels,
    /// Which pixels are covered.
    pub(crate) coverage: Coverage,
    /// The format of depths.
    pub(crate) depth: DepthFormat,
    /// How attributes are interpolated.
    pub(crate) interpolation: Interpolation,
    /// How the tangents of bumps are found.
    pub(crate) tangents: Tangents,
    /// How the maps of bumps are filtered.
    pub(crate) bump_filter: BumpFilter,
    /// How it is decided whether a light is seen.
    pub(crate) shadow_method: ShadowMethod,
    /// Where rays of shadows begin.
    pub(crate) terminator: Terminator,
    /// In which values light is computed.
    pub(crate) light_values: LightValues,
}

impl Variants {
    /// The variants that the settings choose.
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
            tangents: settings.tangents,
            bump_filter: settings.bump_filter,
            shadow_method: settings.shadow_method,
            terminator: settings.terminator,
            light_values: settings.light_values,
        }
    }

    /// How colours are decoded before light is computed.
    pub(crate) const fn decoding(&self) -> Decoding {
        match self.light_values {
            LightValues::Stored => Decoding::Stored,
            LightValues::Linear => Decoding::Linear,
        }
    }

    /// Whether light is computed in linear values.
    pub(crate) fn are_linear(&self) -> bool {
        self.light_values == LightValues::Linear
    }

    /// The filter of the maps of bumps.
    pub(crate) const fn bump_filter(&self) -> Filter {
        match self.bump_filter {
            BumpFilter::Nearest => Filter::Nearest,
            BumpFilter::Trilinear => Filter::Trilinear,
        }
    }

    /// The variant of reciprocal roots, if it is not the default.
    pub(crate) fn root_variant(&self) -> Option<Normalising> {
        (self.roots != Normalising::Root).then_some(self.roots)
    }

    /// The variant of roots for lighting. It is set too if only powers differ from the arithmetic's
    /// own.
    pub(crate) fn light_variant<T: Number>(&self) -> Option<Normalising> {
        let plain = self.roots == Normalising::Root && self.powers == T::POWER;
        (!plain).then_some(self.roots)
    }

    /// The grid that corners of triangles are snapped to.
    pub(crate) const fn grid(&self) -> Grid {
        match (self.subpixels, self.coverage) {
            (Subpixels::Bits12, Coverage::Exact) => Grid::Fine,
            _ => Grid::Usual,
        }
    }

    /// Whether vertices are transformed and snapped by the defaults.
    pub(crate) fn has_default_vertices(&self) -> bool {
        self.vertices == VertexArithmetic::F64
            && matches!(self.subpixels, Subpixels::Bits8 | Subpixels::Bits12)
    }

    /// Whether a variant may move geometry on the screen, so that nothing may be left out for its
    /// position.
    pub(crate) fn has_geometry_variant(&self) -> bool {
        !self.has_default_vertices()
            || self.grid() != Grid::Usual
            || self.coverage != Coverage::Exact
    }
}

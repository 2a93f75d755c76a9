//! The variant of each stage that the settings choose.
//!
//! The default of each stage is compiled by itself. Every other choice of an axis stands beside it
//! in its stage, and is selected once per batch, draw or tile: an unused variant costs a comparison
//! there, and nothing at a pixel.

use std::ops::Deref;

use marraztu_core::accuracy::{
    BumpFilter, Coverage, Filter, LightValues, Settings, Subpixels, VertexArithmetic,
};

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

/// The variants of a frame's stages: a choice of each axis that a stage has variants for.
///
/// A new axis is among them by itself.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Variants(Settings);

impl Deref for Variants {
    type Target = Settings;

    fn deref(&self) -> &Settings {
        &self.0
    }
}

impl Variants {
    /// The variants that the settings choose.
    pub(crate) fn of(settings: &Settings) -> Self {
        // What is decided for each draw, or stands elsewhere in the plan, is left at its default.
        let Settings { arithmetic, light, samples, filter, .. } = Settings::default();
        let Settings { specular, stretched, transparency, .. } = Settings::default();
        let settings = Settings { arithmetic, light, samples, filter, ..*settings };
        Self(Settings { specular, stretched, transparency, ..settings })
    }

    /// The same with light computed in the values that colours are stored in.
    pub(crate) fn in_stored_values(self) -> Self {
        Self(Settings { light_values: LightValues::Stored, ..self.0 })
    }

    /// How colours are decoded before light is computed.
    pub(crate) const fn decoding(&self) -> Decoding {
        match self.0.light_values {
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
        match self.0.bump_filter {
            BumpFilter::Nearest => Filter::Nearest,
            BumpFilter::Trilinear => Filter::Trilinear,
        }
    }

    /// The grid that corners of triangles are snapped to.
    pub(crate) const fn grid(&self) -> Grid {
        match (self.0.subpixels, self.0.coverage) {
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

//! All that shading reads of the settings.

use super::variants::{Decoding, Variants};
use marraztu_core::accuracy::{Coverage, Filter, Interpolation, Rounding, Tangents, Terminator};

/// The choices that hold for all surfaces of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ShadingMode {
    pub(crate) interpolation: Interpolation,
    /// Whether a pixel may show a triangle that covers none of its samples: coordinates there are
    /// clamped.
    pub(crate) clamps: bool,
    /// The decoding of colours before light is computed. If they are linear, colours are encoded
    /// afterwards.
    pub(crate) decoding: Decoding,
    pub(crate) rounding: Rounding,
    /// The place of the tangents that bump maps need.
    pub(crate) tangents: Tangents,
    pub(crate) bump_filter: Filter,
    /// Whether points are lifted to the smooth surface before shadow rays start.
    pub(crate) terminator: Terminator,
    /// The most mirrors and refractions on the way of a ray.
    pub(crate) bounces: u32,
}

impl ShadingMode {
    /// Returns the mode that the settings choose.
    pub(crate) fn of(variants: &Variants) -> Self {
        Self {
            interpolation: variants.interpolation,
            clamps: variants.coverage != Coverage::Exact,
            decoding: variants.decoding(),
            rounding: variants.rounding,
            tangents: variants.tangents,
            bump_filter: variants.bump_filter(),
            terminator: variants.terminator,
            bounces: variants.bounces.count(),
        }
    }

    /// Returns whether light is computed in linear values.
    pub(crate) fn is_linear(&self) -> bool {
        self.decoding == Decoding::Linear
    }
}

impl Default for ShadingMode {
    fn default() -> Self {
        Self::of(&Variants::default())
    }
}

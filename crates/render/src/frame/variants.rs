//! The variant of each stage, selected by the settings.
//!
//! Every choice of an axis other than the default is a variant of the stage. It is selected once
//! per draw, tile or list, or once for sixteen pixels: the same way for all of them.

use std::ops::Deref;

use super::raster_mode::RasterMode;
use marraztu_core::accuracy::{BumpFilter, Filter, LightSamples, LightValues, Settings, Subpixels};

/// The conversion from the bytes of texels to numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Decoding {
    /// Bytes used as they are stored.
    Stored,
    /// Bytes decoded from sRGB.
    Linear,
}

/// The variants of a frame's stages: a choice for each axis that has variants.
///
/// A new axis is included automatically.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Variants(Settings);

impl Deref for Variants {
    type Target = Settings;

    fn deref(&self) -> &Settings {
        &self.0
    }
}

impl Variants {
    /// Returns the variants that the settings choose.
    pub(crate) fn of(settings: &Settings) -> Self {
        // What is decided for each draw, or stands elsewhere in the plan, is left at its default.
        let Settings { arithmetic, light, samples, filter, .. } = Settings::default();
        let Settings { specular, stretched, transparency, resolution, .. } = Settings::default();
        let settings = Settings { arithmetic, light, samples, filter, ..*settings };
        Self(Settings { specular, stretched, transparency, resolution, ..settings })
    }

    /// Returns the same variants with light computed in stored values.
    pub(crate) fn in_stored_values(self) -> Self {
        Self(Settings { light_values: LightValues::Stored, ..self.0 })
    }

    /// Returns the decoding of colours before light is computed.
    pub(crate) const fn decoding(&self) -> Decoding {
        match self.0.light_values {
            LightValues::Stored => Decoding::Stored,
            LightValues::Linear => Decoding::Linear,
        }
    }

    /// Returns whether lights with an extent have soft shadows.
    pub(crate) fn have_soft_shadows(&self) -> bool {
        self.light_samples != LightSamples::One && self.shadow_method.map().is_none()
    }

    /// Returns whether light is computed in linear values.
    pub(crate) fn are_linear(&self) -> bool {
        self.light_values == LightValues::Linear
    }

    /// Returns the filter of bump maps.
    pub(crate) const fn bump_filter(&self) -> Filter {
        match self.0.bump_filter {
            BumpFilter::Nearest => Filter::Nearest,
            BumpFilter::Trilinear => Filter::Trilinear,
        }
    }

    /// Returns what rasterisation reads of the settings.
    pub(crate) const fn raster_mode(&self) -> RasterMode {
        RasterMode::of(&self.0)
    }

    /// Returns the same variants on the grid of 1/256 pixel.
    pub(crate) fn on_usual_grid(self) -> Self {
        Self(Settings { subpixels: Subpixels::default(), ..self.0 })
    }
}

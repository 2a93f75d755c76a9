//! Prepares a plan for shading: light terms in the shading arithmetic, and mipmaps. What
//! the last picture needed is reused.

use super::colors::prepare_linear;
use super::quantize::block_thresholds;
use crate::frame::FramePlan;
use crate::frame::draw::{Pipeline, Shaded, Stage};
use crate::frame::shading_mode::ShadingMode;
use crate::frame::variants::Decoding;
use crate::lights::{LightTerm, PhongMaterial};
use crate::screen::tiles::BLOCK_PIXELS;
use crate::simd::power::Power;
use crate::simd::{Encoding, Number};
use crate::texture::lanes::prepare_decoding;
use crate::texture::mips::Mips;
use marraztu_core::accuracy::Rounding;
use marraztu_core::base::Shared;
use marraztu_core::scene::Texture;

/// The light terms of each pipeline, in the order of its stages.
#[derive(Debug, Default)]
pub(crate) struct LightTerms<T> {
    terms: Vec<Vec<LightTerm<T>>>,
    /// Mip maps, if the filter needs them.
    mips: Vec<Mips>,
    /// The rounding thresholds of a block's pixels.
    thresholds: Option<(Rounding, [f32; BLOCK_PIXELS])>,
    /// The encoding, if colours are linear.
    encoding: Option<Encoding>,
}

impl<T> LightTerms<T> {
    /// Returns the rounding thresholds of a block's pixels; only after [`prepare`](Self::prepare).
    pub(crate) fn thresholds(&self) -> &[f32; BLOCK_PIXELS] {
        self.thresholds.as_ref().map_or(&[0.5; BLOCK_PIXELS], |(_, thresholds)| thresholds)
    }
}

impl<T: Number> LightTerms<T> {
    /// Prepares the light terms and mipmaps of a plan.
    pub(crate) fn prepare(&mut self, plan: &FramePlan, mode: &ShadingMode) {
        self.encoding = mode.is_linear().then(Encoding::new);
        // Tables are computed before drawing, so no thread waits for them.
        if self.encoding.is_some() {
            prepare_decoding();
            prepare_linear();
        }
        self.prepare_mips(plan, mode);
        let rounding = mode.rounding;
        if self.thresholds.is_none_or(|(known, _)| known != rounding) {
            self.thresholds = Some((rounding, block_thresholds(rounding)));
        }
        self.terms.resize_with(plan.pipelines.len(), Vec::new);
        for (terms, pipeline) in self.terms.iter_mut().zip(&plan.pipelines) {
            terms.clear();
            if let Pipeline::Shaded(Shaded { light: Some(stages), material, .. }) = pipeline {
                let PhongMaterial { exponent, floor, .. } = *material;
                // The exponent depends on the material only, so its lights share the power.
                let highlight = Power::new(exponent, floor);
                let term = |stage: &Stage| {
                    let light = &plan.lights[stage.light as usize];
                    let shader = (stage.effect.which, stage.highlight, stage.is_mapped);
                    let term = LightTerm::new(light, material, highlight, shader);
                    match plan.panorama_of(stage.light) {
                        Some(panorama) => term.with(&panorama.irradiance(), material),
                        None => term,
                    }
                };
                terms.extend(stages.iter().map(term));
            }
        }
    }

    /// Prepares mipmaps, and reuses the mipmaps of the last picture.
    fn prepare_mips(&mut self, plan: &FramePlan, mode: &ShadingMode) {
        let mut before = std::mem::take(&mut self.mips);
        for pipeline in &plan.pipelines {
            let Pipeline::Shaded(shaded) = pipeline else { continue };
            for (texture, decoding) in mipped(plan, mode, shaded) {
                if self.mips_of(texture, decoding).is_none() {
                    // Mipmaps of the last picture are moved over; unused ones are dropped.
                    let known = before.iter().position(|mips| mips.are_of(texture, decoding));
                    self.mips.push(match known {
                        Some(at) => before.swap_remove(at),
                        None => Mips::new(texture, decoding),
                    });
                }
            }
        }
    }

    /// Returns the mipmaps of a texture, if the filter needs them.
    pub(crate) fn mips_of(&self, texture: &Shared<Texture>, decoding: Decoding) -> Option<&Mips> {
        self.mips.iter().find(|mips| mips.are_of(texture, decoding))
    }

    /// Returns the encoding, if colours are linear.
    pub(crate) const fn encoding(&self) -> Option<&Encoding> {
        self.encoding.as_ref()
    }

    /// Returns the light terms of a pipeline.
    pub(crate) fn of(&self, pipeline: u32) -> &[LightTerm<T>] {
        &self.terms[pipeline as usize]
    }
}

/// Iterates over the textures of a surface that need mipmaps, with the decoding for averaging.
fn mipped<'a>(
    plan: &FramePlan,
    mode: &ShadingMode,
    shaded: &'a Shaded,
) -> impl Iterator<Item = (&'a Shared<Texture>, Decoding)> {
    let extras = &shaded.extras;
    let decoding = mode.decoding;
    let colors = shaded.texture.iter().chain(extras.colors()).map(move |it| (it, decoding));
    // Maps of numbers are averaged as stored, even if colours are linear.
    let numbers = extras.exponent.iter().map(|it| (it, Decoding::Stored));
    let bumps = extras.bump.iter().map(|bump| (&bump.map, Decoding::Stored));
    let filtered = plan.filter.reads_mips();
    let bumps_filtered = mode.bump_filter.reads_mips();
    let of_frame = colors.chain(numbers).filter(move |_| filtered);
    of_frame.chain(bumps.filter(move |_| bumps_filtered))
}

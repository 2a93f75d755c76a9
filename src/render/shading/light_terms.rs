//! Prepares a plan for shading: light terms in the shading arithmetic, tables of powers, and mip
//! maps. Those of the last picture are reused.

use super::rounding::block_thresholds;
use crate::accuracy::{Filter, Rounding};
use crate::base::Shared;
use crate::render::frame::FramePlan;
use crate::render::frame::draw::{Pipeline, Shaded};
use crate::render::lights::{LightTerm, PhongMaterial};
use crate::render::simd::power::{Power, Tables};
use crate::render::simd::{BATCH, Number};
use crate::render::texture::mips::Mips;
use crate::scene::Texture;

/// The light terms of each pipeline, in the order of its stages.
#[derive(Debug, Default)]
pub(crate) struct LightTerms<T> {
    terms: Vec<Vec<LightTerm<T>>>,
    tables: Tables,
    /// Mip maps, if the filter needs them.
    mips: Vec<Mips>,
    /// The rounding thresholds of a block's pixels.
    thresholds: Option<(Rounding, [f32; BATCH])>,
}

impl<T> LightTerms<T> {
    /// The rounding thresholds of a block's pixels; only after [`prepare`](Self::prepare).
    pub(crate) fn thresholds(&self) -> &[f32; BATCH] {
        self.thresholds.as_ref().map_or(&[0.5; BATCH], |(_, thresholds)| thresholds)
    }
}

impl<T: Number> LightTerms<T> {
    /// Prepares the light terms and mip maps of a plan.
    pub(crate) fn prepare(&mut self, plan: &FramePlan) {
        self.prepare_mips(plan);
        let rounding = plan.variants.rounding;
        if self.thresholds.is_none_or(|(known, _)| known != rounding) {
            self.thresholds = Some((rounding, block_thresholds(rounding)));
        }
        self.terms.resize_with(plan.pipelines.len(), Vec::new);
        for (terms, pipeline) in self.terms.iter_mut().zip(&plan.pipelines) {
            terms.clear();
            if let Pipeline::Shaded(Shaded { light: Some(stages), material, .. }) = pipeline {
                let PhongMaterial { exponent, floor, .. } = *material;
                let highlight = Power::by(plan.variants.powers, exponent, floor, &mut self.tables);
                let lights = stages.iter().map(|stage| &plan.lights[stage.light as usize]);
                let variant = plan.variants.light_variant::<T>();
                terms.extend(
                    lights.map(|light| LightTerm::by(variant, light, material, &highlight)),
                );
            }
        }
    }

    /// Prepares mip maps, and reuses those of the last picture.
    fn prepare_mips(&mut self, plan: &FramePlan) {
        let before = std::mem::take(&mut self.mips);
        if plan.filter != Filter::Trilinear {
            return;
        }
        let mut before: Vec<Option<Mips>> = before.into_iter().map(Some).collect();
        for pipeline in &plan.pipelines {
            let Pipeline::Shaded(Shaded { texture: Some(texture), .. }) = pipeline else {
                continue;
            };
            if self.mips_of(texture).is_none() {
                let is_it = |mips: &&mut Option<Mips>| {
                    mips.as_ref().is_some_and(|mips| mips.are_of(texture))
                };
                let known = before.iter_mut().find(is_it).and_then(Option::take);
                self.mips.push(known.unwrap_or_else(|| Mips::new(texture)));
            }
        }
    }

    /// The mip maps of a texture, if the filter needs them.
    pub(crate) fn mips_of(&self, texture: &Shared<Texture>) -> Option<&Mips> {
        self.mips.iter().find(|mips| mips.are_of(texture))
    }

    /// The light terms of a pipeline.
    pub(crate) fn of(&self, pipeline: u32) -> &[LightTerm<T>] {
        &self.terms[pipeline as usize]
    }
}

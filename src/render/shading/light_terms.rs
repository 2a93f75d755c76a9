//! What is made ready of a plan before any pixel: lamps in the numbers that light is computed in, tables
//! of powers, and textures at smaller sizes. What the last picture had is used again.

use crate::accuracy::Filter;
use crate::base::Shared;
use crate::render::frame::FramePlan;
use crate::render::frame::draw::{Pipeline, Shaded};
use crate::render::lights::{LightTerm, PhongMaterial};
use crate::render::simd::Number;
use crate::render::simd::power::{Power, Tables};
use crate::render::texture::mips::Mips;
use crate::scene::Texture;

/// For each pipeline its lamps, in the order of its stages.
#[derive(Debug, Default)]
pub(crate) struct LightTerms<T> {
    lamps: Vec<Vec<LightTerm<T>>>,
    tables: Tables,
    /// Textures as they are seen from afar, where that is asked for.
    mips: Vec<Mips>,
}

impl<T: Number> LightTerms<T> {
    /// Prepares the lamps of a plan.
    pub(crate) fn prepare(&mut self, plan: &FramePlan) {
        self.prepare_mips(plan);
        self.lamps.resize_with(plan.pipelines.len(), Vec::new);
        for (shines, pipeline) in self.lamps.iter_mut().zip(&plan.pipelines) {
            shines.clear();
            if let Pipeline::Shaded(Shaded { light: Some(stages), matter, .. }) = pipeline {
                let PhongMaterial { exponent, floor, .. } = *matter;
                let highlight = Power::by(plan.variants.powers, exponent, floor, &mut self.tables);
                let lamps = stages.iter().map(|stage| &plan.lamps[stage.lamp as usize]);
                let variant = plan.variants.rare_light::<T>();
                shines.extend(lamps.map(|lamp| LightTerm::by(variant, lamp, matter, &highlight)));
            }
        }
    }

    /// Prepares textures that are seen from afar. Those of the last picture are there still.
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

    /// A texture as it is seen from afar, where that is asked for.
    pub(crate) fn mips_of(&self, texture: &Shared<Texture>) -> Option<&Mips> {
        self.mips.iter().find(|mips| mips.are_of(texture))
    }

    /// The lamps of a pipeline.
    pub(crate) fn of(&self, pipeline: u32) -> &[LightTerm<T>] {
        &self.lamps[pipeline as usize]
    }
}

//! Removes one effect from a plan, so that its cost can be measured.

use super::rules::Reading;
use super::uses::Effect;
use crate::accuracy::LightValues;
use crate::render::frame::FramePlan;
use crate::render::frame::draw::{Back, Form, Pipeline, Shaded};
use crate::scene::ItemId;

impl FramePlan {
    /// The plan without an effect: another picture, and less work. `None` if it does not use the
    /// effect, or cannot do without it.
    #[must_use]
    pub fn without(&self, effect: Effect) -> Option<Self> {
        let mut plan = self.clone();
        match effect {
            Effect::Light(id) => {
                let index = self.light_ids.iter().position(|light| *light == id)?;
                plan.for_each_light(|stages| stages.retain(|stage| stage.light as usize != index));
            }
            Effect::Shadows(id) => {
                let index = self.light_ids.iter().position(|light| *light == id)?;
                *plan.shadows.sources.get_mut(index)? = None;
            }
            Effect::Highlights => plan.for_each_light(|stages| {
                stages.iter_mut().for_each(|stage| stage.highlight = Form::Plain);
            }),
            Effect::Texture => plan.for_each_shaded(|shaded| {
                shaded.texture = None;
                if shaded.opacity_map.is_none() {
                    shaded.cutout = None;
                }
            }),
            Effect::AlphaTest => plan.for_each_shaded(|shaded| {
                if shaded.cutout.is_some() {
                    (shaded.cutout, shaded.opacity_map) = (None, None);
                }
            }),
            Effect::Transparency => plan.for_each_shaded(|shaded| shaded.opacity = None),
            Effect::VertexColors => plan.for_each_shaded(|shaded| shaded.vertex_colors = false),
            Effect::Emission => plan.for_each_shaded(|shaded| shaded.extras.emission = None),
            Effect::Maps => plan.for_each_shaded(|shaded| {
                shaded.extras.ambient.iter_mut().for_each(|ambient| ambient.map = None);
                (shaded.extras.specular, shaded.extras.exponent) = (None, None);
                for stage in shaded.light.iter_mut().flatten() {
                    stage.is_mapped = false;
                }
            }),
            Effect::Bumps => plan.for_each_shaded(|shaded| shaded.extras.bump = None),
            Effect::LinearLight => plan.variants.light_values = LightValues::Stored,
            Effect::BackFaces => plan.draws.iter_mut().for_each(|draw| draw.back = Back::Culled),
            Effect::Edges => plan.draws.iter_mut().for_each(|draw| draw.lines.edges = false),
            Effect::FaceNormals => {
                plan.draws.iter_mut().for_each(|draw| draw.lines.face_normals = None);
            }
            Effect::VertexNormals => {
                plan.draws.iter_mut().for_each(|draw| draw.lines.vertex_normals = None);
            }
            Effect::Marks => plan.draws.retain(|draw| matches!(draw.item, ItemId::Object(_))),
            Effect::Surfaces => plan.draws.iter_mut().for_each(|draw| draw.filled = false),
            Effect::Normals => return None,
        }
        (plan != *self).then_some(plan)
    }

    fn for_each_shaded(&mut self, change: impl Fn(&mut Shaded)) {
        for pipeline in &mut self.pipelines {
            if let Pipeline::Shaded(shaded) = pipeline {
                change(shaded);
            }
        }
    }

    fn for_each_light(&mut self, change: impl Fn(&mut Vec<crate::render::frame::draw::Stage>)) {
        let rules = self.rules;
        self.for_each_shaded(|shaded| {
            if let Some(stages) = &mut shaded.light {
                change(stages);
                shaded.needs_positions = rules.positions(&Reading::of(stages.iter())).is_none();
            }
        });
    }
}

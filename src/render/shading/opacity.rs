//! The opacity of fragments: of the material, multiplied by the alpha of the texture.

use fearless_simd::dispatch;

use super::context::ShadingContext;
use super::groups::Group;
use super::interpolated::ShadingNumber;
use super::surface::Shader;
use crate::render::frame::draw::{Pipeline, Shaded};
use crate::render::simd::BATCH;
use crate::render::simd::gather::SLOTS;
use crate::render::texture::sample::sample;
use crate::render::texture::uv::{uv, uvs};

impl<T: ShadingNumber> Shader<T> {
    /// The opacity of each fragment of a group that was coloured; 1 for what is opaque.
    #[expect(clippy::cast_possible_truncation, reason = "the nearest f32 is meant")]
    pub(super) fn opacities(
        &self,
        context: &ShadingContext<'_, T>,
        group: &Group<'_>,
    ) -> [f32; BATCH] {
        let Pipeline::Shaded(Shaded { opacity: Some(opacity), texture, .. }) =
            &context.plan.pipelines[group.pipeline as usize]
        else {
            return [1.0; BATCH];
        };
        let mut opacities = [*opacity as f32; BATCH];
        let Some(texture) = texture.as_ref().filter(|it| it.picture.least_alpha() < 255) else {
            return opacities;
        };
        let Self { fragments, attributes, barycentrics, .. } = self;
        let mut corners = [None; SLOTS];
        for (corners, number) in corners.iter_mut().zip(&attributes.numbers[..attributes.count]) {
            *corners = uvs(group.draw, *number);
        }
        let filter = context.plan.filter;
        let own = &mut opacities[..fragments.len];
        // Dispatched so that rounding down uses the processor's instruction, if it has one.
        dispatch!(context.level, _ => for (i, own) in own.iter_mut().enumerate() {
            let slot = fragments.slots[i].cast_unsigned() as usize % SLOTS;
            if let Some(corners) = corners[slot] {
                let uv = uv(corners, barycentrics.weights(i));
                *own = (sample::<f64>(texture, uv, filter)[3] * opacity) as f32;
            }
        });
        opacities
    }
}

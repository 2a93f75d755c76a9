//! The opacity of fragments: the material's, times the texture's alpha, times the opacity map.

use crate::simd::dispatch;

use super::context::{Group, ShadingContext};
use super::interpolated::ShadingNumber;
use super::surface::Shader;
use crate::frame::draw::Shaded;
use crate::simd::BATCH;
use crate::simd::gather::SLOTS;
use crate::texture::sample;
use crate::texture::uv::{uv, uvs};

impl<T: ShadingNumber> Shader<T> {
    /// Returns the opacity of each fragment of a coloured group; 1 for opaque surfaces.
    #[expect(clippy::cast_possible_truncation, reason = "the nearest f32 is meant")]
    pub(super) fn opacities(&self, group: &Group<'_, T>) -> [f32; BATCH] {
        let ShadingContext { level, plan, .. } = *group.context;
        let Some(Shaded { opacity: Some(opacity), texture, opacity_map, .. }) = group.shaded else {
            return [1.0; BATCH];
        };
        let mut opacities = [*opacity as f32; BATCH];
        let texture = texture.as_ref().filter(|it| it.picture.least_alpha() < 255);
        if texture.is_none() && opacity_map.is_none() {
            return opacities;
        }
        let Self { fragments, attributes, barycentrics, .. } = self;
        // Texture coordinates are fetched once per triangle.
        let mut corners = [None; SLOTS];
        for (corners, number) in corners.iter_mut().zip(&attributes.numbers[..attributes.count]) {
            *corners = uvs(group.draw, *number);
        }
        let filter = plan.filter;
        let own = &mut opacities[..fragments.len];
        // Dispatched so rounding down uses the processor's instruction, if it has one.
        dispatch!(level, _ => for (i, own) in own.iter_mut().enumerate() {
            let slot = fragments.slots[i].cast_unsigned() as usize % SLOTS;
            if let Some(corners) = corners[slot] {
                let uv = uv(corners, barycentrics.weights(i));
                let alpha = texture.map_or(1.0, |it| sample::sample::<f64>(it, uv, filter)[3]);
                let mapped = opacity_map.as_ref().map_or(1.0, |it| sample::opacity(it, uv, filter));
                *own = (alpha * mapped * opacity) as f32;
            }
        });
        opacities
    }
}

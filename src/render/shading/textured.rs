//! The colour of a surface, pixel by pixel: texture, vertex colours and tint.

use super::context::ShadingContext;
use super::groups::Group;
use super::interpolated::ShadingNumber;
use super::map_texels::{Points, TexelSource, Texels, place};
use super::surface::Shader;
use crate::render::frame::draw::Shaded;
use crate::render::texture::lanes::Sampler;
use crate::scene::Texture;

impl<T: ShadingNumber> Shader<T> {
    /// t at the pixels of the group: texel x tint x vertex colour, each 1 where absent. `new` says
    /// whether the triangles differ from those before.
    pub(crate) fn texels(
        &mut self,
        context: &ShadingContext<'_, T>,
        group: &Group<'_>,
        shaded: &Shaded,
        new: bool,
    ) {
        for (row, tint) in self.texels.iter_mut().zip(shaded.tint) {
            row.fill(T::from_f64(tint));
        }
        if let Some(texture) = &shaded.texture {
            let source = TexelSource::of_colors(context, texture);
            let Self { fragments, attributes, barycentrics, placed, texels, .. } = self;
            let points = Points { fragments, attributes, barycentrics };
            let of = (source, Texels::Colors, new);
            points.read(context, group, of, placed, (shaded.tint, texels));
        }
        if shaded.vertex_colors {
            let Self { fragments, attributes, barycentrics, texels, .. } = self;
            let points = Points { fragments, attributes, barycentrics };
            let decoding = context.plan.variants.decoding();
            points.multiply_vertex_colors(context.level, group, decoding, texels);
        }
    }

    /// Finds where a texture lies on the triangles of the list.
    pub(super) fn place_texture(
        &mut self,
        context: &ShadingContext<'_, T>,
        group: &Group<'_>,
        texture: &Texture,
        sampler: &Sampler<'_>,
    ) {
        place(context, group, &self.attributes, (texture, sampler), &mut self.placed);
    }
}

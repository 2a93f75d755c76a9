//! The surface colour, pixel by pixel: texture, vertex colours and tint.

use super::context::ShadingContext;
use super::groups::Group;
use super::interpolate::multiply;
use super::interpolated::ShadingNumber;
use super::map_texels::{Points, TexelSource, Texels, place};
use super::surface::Shader;
use crate::frame::draw::Shaded;
use crate::frame::variants::Decoding;
use crate::texture::lanes::Sampler;
use marraztu_core::base::color::linear;
use marraztu_core::base::math::each;
use marraztu_core::scene::Texture;

impl<T: ShadingNumber> Shader<T> {
    /// Computes t at the pixels of the group: texel x tint x vertex colour, each 1 if absent. `new`
    /// tells whether the triangles differ from the last list's.
    pub(crate) fn texels(
        &mut self,
        context: &ShadingContext<'_, T>,
        group: &Group<'_>,
        shaded: &Shaded,
        new: bool,
    ) {
        for (row, tint) in self.texels.iter_mut().zip(shaded.tint) {
            row[..self.fragments.len].fill(T::from_f64(tint));
        }
        if let Some(texture) = &shaded.texture {
            let source = TexelSource::of_colors(context, texture);
            let Self { fragments, attributes, barycentrics, placed, texels, .. } = self;
            let points = Points { fragments, attributes, barycentrics };
            let of = (source, Texels::Colors, new);
            points.read(context, group, of, placed, (shaded.tint, texels));
        }
        // Vertex colours multiply last: t is a product, and order only affects rounding.
        if shaded.vertex_colors {
            if new {
                self.take_vertex_colors(group, context.plan.variants.decoding());
            }
            let Self { fragments, attributes, barycentrics, texels, vertex_colors, .. } = self;
            let at = (context.level, attributes.count);
            multiply(at, fragments, vertex_colors, barycentrics, texels);
        }
    }

    /// Computes the placement of a texture on the triangles of the list.
    pub(super) fn place_texture(
        &mut self,
        context: &ShadingContext<'_, T>,
        group: &Group<'_>,
        texture: &Texture,
        sampler: &Sampler<'_>,
    ) {
        place(context, group, &self.attributes, (texture, sampler), &mut self.placed);
    }
    /// Fetches the vertex colours at the corners of the triangles of the list.
    pub(super) fn take_vertex_colors(&mut self, group: &Group<'_>, decoding: Decoding) {
        let Self { attributes, vertex_colors, .. } = self;
        let mesh = &group.draw.model.mesh;
        let decoded = |c: f32| match decoding {
            Decoding::Linear => linear(f64::from(c)),
            Decoding::Stored => f64::from(c),
        };
        for (slot, number) in attributes.numbers[..attributes.count].iter().enumerate() {
            let [a, b, c] = each(mesh.triangle_colors(*number), |color| each(color, decoded));
            for part in 0..3 {
                let row = [a[part], b[part] - a[part], c[part] - a[part]];
                for (values, value) in vertex_colors.iter_mut().zip(row) {
                    values[part][slot] = T::from_f64(value);
                }
            }
        }
    }
}

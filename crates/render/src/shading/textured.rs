//! The surface colour, pixel by pixel: texture, vertex colours and tint.

use super::groups::Group;
use super::interpolate::{Mixed, Points, mix};
use super::interpolated::ShadingNumber;
use super::map_texels::{TexelSource, Texels};
use super::surface::Shader;
use crate::frame::draw::Shaded;
use crate::frame::variants::Decoding;
use marraztu_core::base::color::linear;
use marraztu_core::base::math::each;

impl<T: ShadingNumber> Shader<T> {
    /// Computes t at the pixels of the group: texel x tint x vertex colour, each 1 if absent.
    pub(crate) fn texels(&mut self, group: &Group<'_, T>, shaded: &Shaded) {
        for (row, tint) in self.texels.iter_mut().zip(shaded.tint) {
            row[..self.fragments.len].fill(T::from_f64(tint));
        }
        if shaded.vertex_colors && self.attributes.are_new {
            self.take_vertex_colors(group);
        }
        let Self { fragments, attributes, barycentrics, placed, texels, vertex_colors, .. } = self;
        let points = Points { fragments, attributes, barycentrics };
        if let Some(texture) = &shaded.texture {
            let source = TexelSource::of_colors(group.context, texture);
            points.read(group, (source, Texels::Colors), placed, (shaded.tint, texels));
        }
        // Vertex colours multiply last: t is a product, and order only affects rounding.
        if shaded.vertex_colors {
            mix(group.context.level, points, vertex_colors, Mixed::Product(texels));
        }
    }

    /// Fetches the vertex colours at the corners of the triangles of the list.
    pub(super) fn take_vertex_colors(&mut self, group: &Group<'_, T>) {
        let Self { attributes, vertex_colors, .. } = self;
        let mesh = &group.draw.model.mesh;
        let decoded = |c: f32| match group.context.plan.variants.decoding() {
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

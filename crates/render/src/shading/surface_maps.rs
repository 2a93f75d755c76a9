//! The properties of a surface pixel by pixel: texture, vertex colours, tint, emission, the maps of
//! its highlights, and opacity.

use super::context::{Group, ShadingContext};
use super::interpolate::{Mixed, Points, mix};
use super::interpolated::ShadingNumber;
use super::map_rows::{Map, MapRows};
use super::map_texels::TexelSource;
use super::shader::Shader;
use super::texels::Texels;
use crate::frame::draw::Shaded;
use crate::frame::extras::{Extras, Glow};
use crate::frame::variants::Decoding;
use crate::simd::gather::SLOTS;
use crate::simd::{BATCH, Vec3, dispatch};
use crate::texture::sample::{brightness, opacity_of, sample};
use crate::texture::uv::{uv, uvs};
use marraztu_core::base::Shared;
use marraztu_core::base::color::linear;
use marraztu_core::base::math::each;
use marraztu_core::scene::Texture;

impl<T: ShadingNumber> Shader<T> {
    /// Computes t at the pixels of the group: texel x tint x vertex colour, each 1 if absent.
    pub(crate) fn texels(&mut self, group: &Group<'_, T>, shaded: &Shaded) {
        // Rows start as the tint; the texture and vertex colours multiply them.
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
        // Vertex colours are decoded before they are interpolated, like texels.
        let decoded = |c: f32| match group.context.mode().decoding {
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

    /// Reads a map of colours or numbers at the fragments of the list, times `base`.
    pub(super) fn read_map(
        &mut self,
        group: &Group<'_, T>,
        (map, source): (Map, TexelSource<'_>),
        base: [f64; 3],
    ) {
        let Self { fragments, attributes, barycentrics, maps, .. } = self;
        let points = Points { fragments, attributes, barycentrics };
        maps.read(group, points, (map, source, Texels::Colors), base);
    }

    /// Computes the colours of the surface at the pixels of the group, if they vary; multiplies
    /// highlights by their map; and computes the light added to the colours. Returns whether there
    /// is any.
    pub(super) fn surface_light(&mut self, group: &Group<'_, T>, shaded: &Shaded) -> bool {
        // Maps come after light, because the map of Ks multiplies highlights.
        if shaded.varies() {
            self.texels(group, shaded);
        }
        if let Some(map) = &shaded.extras.specular {
            self.map_highlights(group, map);
        }
        let glows = shaded.extras.glows().next().is_some();
        if glows {
            self.find_glow(group, shaded);
        }
        glows
    }

    /// Computes the light added to the colour of each pixel: Ke times its map, and mapped ambient
    /// light times tint and vertex colours.
    pub(super) fn find_glow(&mut self, group: &Group<'_, T>, shaded: &Shaded) {
        self.maps.glow = [[T::default(); BATCH]; 3];
        let Extras { emission, ambient, .. } = &shaded.extras;
        // Emission is independent of the lights.
        if let Some(Glow { color, map }) = emission {
            self.read_glow(group, (Map::Emission, map.as_ref()), *color);
            self.add_glow();
        }
        // Mapped ambient light replaces the ambient stages of the surface.
        if let Some(Glow { color, map }) = ambient {
            let tinted = std::array::from_fn(|i| color[i] * shaded.tint[i]);
            self.read_glow(group, (Map::Ambient, map.as_ref()), tinted);
            if shaded.vertex_colors {
                let Self { fragments, attributes, barycentrics, vertex_colors, maps, .. } = self;
                let points = Points { fragments, attributes, barycentrics };
                let to = Mixed::Product(&mut maps.texels);
                mix(group.context.level, points, vertex_colors, to);
            }
            self.add_glow();
        }
    }

    /// Reads light that a map multiplies, if there is one.
    fn read_glow(
        &mut self,
        group: &Group<'_, T>,
        (map, texture): (Map, Option<&Shared<Texture>>),
        color: [f64; 3],
    ) {
        if let Some(texture) = texture {
            self.read_map(group, (map, TexelSource::of_colors(group.context, texture)), color);
        } else {
            for (row, part) in self.maps.texels.iter_mut().zip(color) {
                row.fill(T::from_f64(part));
            }
        }
    }

    /// Adds the last read texels to the glow.
    fn add_glow(&mut self) {
        let MapRows { glow, texels, .. } = &mut *self.maps;
        for (row, more) in glow.iter_mut().zip(texels) {
            for (sum, more) in row.iter_mut().zip(more) {
                *sum = *sum + *more;
            }
        }
    }

    /// Multiplies highlights by the map of Ks.
    pub(super) fn map_highlights(&mut self, group: &Group<'_, T>, map: &Shared<Texture>) {
        let source = TexelSource::of_colors(group.context, map);
        self.read_map(group, (Map::Specular, source), [1.0; 3]);
        for (row, texels) in self.batch.specular.iter_mut().zip(&self.maps.texels) {
            for (light, texel) in row.iter_mut().zip(texels) {
                *light = *light * *texel;
            }
        }
    }

    /// Sets the factors of exponents to the brightness of the map of Ns.
    pub(super) fn map_exponents(&mut self, group: &Group<'_, T>, map: &Shared<Texture>) {
        let source = TexelSource::new(group.context, map, Decoding::Stored);
        self.read_map(group, (Map::Exponent, source), [1.0; 3]);
        let [r, g, b] = &self.maps.texels;
        for (i, factor) in self.batch.exponent.iter_mut().enumerate() {
            *factor = brightness(Vec3([r[i], g[i], b[i]]));
        }
    }

    /// Returns the opacity of each fragment of a coloured group; 1 for opaque surfaces.
    #[expect(clippy::cast_possible_truncation, reason = "the nearest f32 is meant")]
    pub(super) fn opacities(&self, group: &Group<'_, T>) -> [f32; BATCH] {
        let ShadingContext { level, plan, .. } = *group.context;
        let Some(Shaded { opacity: Some(opacity), texture, opacity_map, .. }) = group.shaded else {
            return [1.0; BATCH];
        };
        let mut opacities = [*opacity as f32; BATCH];
        // A texture without transparent texels changes no opacity.
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
                let alpha = texture.map_or(1.0, |it| sample::<f64>(it, uv, filter)[3]);
                let mapped = opacity_map.as_ref().map_or(1.0, |it| opacity_of(it, uv, filter));
                *own = (alpha * mapped * opacity) as f32;
            }
        });
        opacities
    }
}

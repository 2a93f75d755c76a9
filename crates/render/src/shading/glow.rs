//! The light that surfaces emit, and the maps of their highlights.

use super::groups::Group;
use super::interpolate::{Mixed, Points, mix};
use super::interpolated::ShadingNumber;
use super::map_rows::{Map, MapRows};
use super::map_texels::{TexelSource, Texels};
use super::surface::Shader;
use crate::frame::draw::Shaded;
use crate::frame::extras::{Extras, Glow};
use crate::frame::variants::Decoding;
use crate::simd::{BATCH, Vec3};
use crate::texture::sample::brightness;
use marraztu_core::base::Shared;
use marraztu_core::scene::Texture;

impl<T: ShadingNumber> Shader<T> {
    /// Reads a map of colours or numbers at the fragments of the list, times `base`.
    fn read_map(
        &mut self,
        group: &Group<'_, T>,
        (map, source): (Map, TexelSource<'_>),
        base: [f64; 3],
    ) {
        let Self { fragments, attributes, barycentrics, maps, .. } = self;
        let points = Points { fragments, attributes, barycentrics };
        maps.read(group, points, (map, source, Texels::Colors), base);
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
}

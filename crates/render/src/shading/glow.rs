//! The light that surfaces emit, and the maps of their highlights.

use super::context::ShadingContext;
use super::groups::Group;
use super::interpolate::multiply;
use super::interpolated::ShadingNumber;
use super::map_rows::{Map, MapRows};
use super::map_texels::{Points, TexelSource, Texels};
use super::surface::Shader;
use crate::frame::draw::Shaded;
use crate::frame::extras::Extras;
use crate::simd::{BATCH, Vec3};
use crate::texture::sample::brightness;

impl<T: ShadingNumber> Shader<T> {
    /// Calls [`MapRows::read`] for the fragments of the list.
    fn read_map(
        &mut self,
        context: &ShadingContext<'_, T>,
        group: &Group<'_>,
        of: (Map, TexelSource<'_>, Texels, bool),
        base: [f64; 3],
    ) {
        let Self { fragments, attributes, barycentrics, maps, .. } = self;
        maps.read(context, group, &Points { fragments, attributes, barycentrics }, of, base);
    }

    /// Computes the light added to the colour of each pixel: Ke times its map, and mapped ambient
    /// light times tint and vertex colours.
    pub(super) fn find_glow(
        &mut self,
        context: &ShadingContext<'_, T>,
        group: &Group<'_>,
        shaded: &Shaded,
        new: bool,
    ) {
        self.maps.glow = [[T::default(); BATCH]; 3];
        let Extras { emission, ambient, .. } = &shaded.extras;
        // Emission is independent of the lights.
        if let Some(emission) = emission {
            match &emission.map {
                Some(map) => {
                    let source = TexelSource::of_colors(context, map);
                    let of = (Map::Emission, source, Texels::Colors, new);
                    self.read_map(context, group, of, emission.color);
                    self.add_glow();
                }
                None => {
                    for (row, part) in self.maps.glow.iter_mut().zip(emission.color) {
                        row.fill(T::from_f64(part));
                    }
                }
            }
        }
        // Mapped ambient light replaces the ambient stages of the surface.
        if let Some(ambient) = ambient {
            let tinted = std::array::from_fn(|i| ambient.color[i] * shaded.tint[i]);
            match &ambient.map {
                Some(map) => {
                    let source = TexelSource::of_colors(context, map);
                    let of = (Map::Ambient, source, Texels::Colors, new);
                    self.read_map(context, group, of, tinted);
                }
                None => {
                    for (row, part) in self.maps.texels.iter_mut().zip(tinted) {
                        row.fill(T::from_f64(part));
                    }
                }
            }
            if shaded.vertex_colors {
                let Self { fragments, attributes, barycentrics, vertex_colors, maps, .. } = self;
                let at = (context.level, attributes.count);
                multiply(at, fragments, vertex_colors, barycentrics, &mut maps.texels);
            }
            self.add_glow();
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
    pub(super) fn map_highlights(
        &mut self,
        context: &ShadingContext<'_, T>,
        group: &Group<'_>,
        shaded: &Shaded,
        new: bool,
    ) {
        let Some(map) = &shaded.extras.specular else { return };
        let source = TexelSource::of_colors(context, map);
        let of = (Map::Specular, source, Texels::Colors, new);
        self.read_map(context, group, of, [1.0; 3]);
        for (row, texels) in self.batch.specular.iter_mut().zip(&self.maps.texels) {
            for (light, texel) in row.iter_mut().zip(texels) {
                *light = *light * *texel;
            }
        }
    }

    /// Sets the factors of exponents to the brightness of the map of Ns.
    pub(super) fn map_exponents(
        &mut self,
        context: &ShadingContext<'_, T>,
        group: &Group<'_>,
        shaded: &Shaded,
        new: bool,
    ) {
        let Some(map) = &shaded.extras.exponent else { return };
        let source = TexelSource::of_numbers(context, map);
        let of = (Map::Exponent, source, Texels::Colors, new);
        self.read_map(context, group, of, [1.0; 3]);
        let [r, g, b] = &self.maps.texels;
        for (i, factor) in self.batch.exponent.iter_mut().enumerate() {
            *factor = brightness(Vec3([r[i], g[i], b[i]]));
        }
    }
}

//! Selects the colouring of blocks that one triangle covers fully.
//!
//! If colours only have to be interpolated, or only lit, the block is coloured in one pass without
//! a list of fragments. Everything else is coloured like other blocks.

use super::context::ShadingContext;
use super::full_blocks::{BlockLight, Blocks, Canvas, Corners, ROW};
use super::groups::{Group, group_of};
use super::interpolated::ShadingNumber;
use super::map_texels::{TexelSource, TexturePlacement};
use super::surface::{Out, Shader};
use super::texels::PlacedTexture;
use super::triangle_attributes::TriangleAttributes;
use crate::frame::color_path::FullPath;
use crate::frame::draw::Pipeline;
use crate::screen::tiles::BLOCK_PIXELS;
use crate::screen::weights::HomogeneousWeights;

/// Returns the weighting of a triangle's corners in this frame.
fn by<'a, T>(
    context: &'a ShadingContext<'_, T>,
    cut: Option<&'a HomogeneousWeights>,
) -> Corners<'a> {
    let interpolation = context.plan.variants.interpolation;
    Corners { cut, interpolation, thresholds: context.terms.thresholds() }
}

impl<T: ShadingNumber> Shader<T> {
    /// Colours the pixels of blocks that one triangle covers fully.
    pub(crate) fn full_blocks(
        &mut self,
        context: &ShadingContext<'_, T>,
        number: u32,
        blocks: Blocks,
        canvas: &mut Canvas<'_>,
    ) {
        let group = group_of(context, number);
        let [x, y] = blocks.corner;
        self.fragments.list_full_block(number, [x, y]);
        // A triangle that is clipped, wide or without area may need lists all the same.
        let pixels = u64::from(blocks.which.count_ones()) * BLOCK_PIXELS as u64;
        match group.path.full {
            FullPath::Fill => {
                self.path_pixels.filled += pixels;
                return self.fill_blocks(context, &group, blocks, canvas);
            }
            FullPath::Corners if self.mix_blocks(context, &group, blocks, canvas) => {
                self.path_pixels.corners += pixels;
                return;
            }
            FullPath::Light if self.light_blocks(context, &group, blocks, canvas) => {
                self.path_pixels.lit += pixels;
                return;
            }
            FullPath::Corners | FullPath::Light | FullPath::List => {}
        }
        blocks.each(|[column, row]| {
            self.fragments.list_full_block(number, [x + column, y + row]);
            let at = canvas.offset_of([column, row]);
            self.color_group(context, &group, &mut Out::Tile(canvas, at));
        });
    }

    /// Returns the weights of the first triangle, if it is clipped.
    fn cut_weights(
        &self,
        context: &ShadingContext<'_, T>,
        group: &Group<'_>,
    ) -> Option<HomogeneousWeights> {
        let TriangleAttributes { cut, numbers, .. } = &self.attributes;
        let is_cut = cut & 1 == 1;
        is_cut.then(|| HomogeneousWeights::new(context.plan, group.draw, numbers[0], [0; 2]))
    }

    /// Fills fully covered blocks, if all of their pixels have one colour. Returns whether it did.
    fn fill_blocks(
        &mut self,
        context: &ShadingContext<'_, T>,
        group: &Group<'_>,
        blocks: Blocks,
        canvas: &mut Canvas<'_>,
    ) {
        let color = self.first_color(context, group);
        blocks.each(|[column, row]| {
            let at = canvas.offset_of([column, row]);
            for row in canvas.pixels[at..].chunks_mut(canvas.stride).take(ROW) {
                row[..ROW].fill(color);
            }
        });
    }

    /// Colours fully covered blocks in one pass, if only the colours of the corners have to be
    /// interpolated. Returns whether it did.
    fn mix_blocks(
        &mut self,
        context: &ShadingContext<'_, T>,
        group: &Group<'_>,
        blocks: Blocks,
        canvas: &mut Canvas<'_>,
    ) -> bool {
        let ShadingContext { level, plan, lit, .. } = *context;
        let Pipeline::Shaded(shaded) = &plan.pipelines[group.pipeline as usize] else {
            return false;
        };
        let tables = lit.tables(group.draw_index, group.pipeline);
        if self.take(context, group, true) {
            self.carry_diffuse(context, group, shaded, tables);
            self.attributes.spread(level);
        }
        let cut = self.cut_weights(context, group);
        T::mix_blocks(level, &self.attributes, blocks, by(context, cut.as_ref()), canvas)
    }

    /// Colours fully covered blocks, one block at a time without a list of fragments. Applies to
    /// surfaces that are lit per pixel or unlit, with or without a texture and uniform emission,
    /// and have no other effects. Returns whether it did.
    fn light_blocks(
        &mut self,
        context: &ShadingContext<'_, T>,
        group: &Group<'_>,
        blocks: Blocks,
        canvas: &mut Canvas<'_>,
    ) -> bool {
        let ShadingContext { level, plan, terms, .. } = *context;
        let Pipeline::Shaded(shaded) = &plan.pipelines[group.pipeline as usize] else {
            return false;
        };
        let is_lit = shaded.light.is_some();
        let Some(glow) = shaded.extras.even_glow() else { return false };
        let texture = shaded.texture.as_deref();
        let source = shaded.texture.as_ref().map(|it| TexelSource::of_colors(context, it));
        let sampler = source.and_then(|source| source.sampler());
        if texture.is_some() && sampler.is_none() {
            return false;
        }
        // Attributes are only fetched if the triangle differs from the last one.
        let new = self.take(context, group, true);
        if let Some((texture, sampler)) = texture.zip(sampler.as_ref()) {
            if new {
                self.place_texture(context, group, texture, sampler);
            }
            if self.placed.placement.known & 1 == 0 {
                // The fragment list fetches its own attributes.
                self.attributes.forget();
                return false;
            }
        }
        if new && shaded.vertex_colors {
            self.take_vertex_colors(group, plan.variants.decoding());
        }
        let cut = self.cut_weights(context, group);
        let look = self.look_of(plan, group);
        let Self { tile, attributes, batch, placed, vertex_colors, .. } = self;
        let TexturePlacement { placement, far, scratch } = placed;
        let lights = is_lit.then(|| tile.light(plan, group.pipeline, shaded));
        let needs_positions = lights.is_some_and(|lights| lights.needs_positions);
        if !needs_positions {
            attributes.forget();
        } else if new {
            attributes.carry_normals(group.draw);
            attributes.spread(level);
        }
        let light = BlockLight {
            by: by(context, cut.as_ref()),
            look: needs_positions.then_some(look),
            tint: shaded.tint.map(T::from_f64),
            texture: sampler.as_ref().map(|sampler| PlacedTexture { placement, far, sampler }),
            vertex_colors: shaded.vertex_colors.then_some(vertex_colors),
            lights,
            terms: terms.of(group.pipeline),
            glow: shaded.extras.emission.is_some().then(|| glow.map(T::from_f64)),
            encoding: terms.encoding(),
        };
        T::light_blocks(level, attributes, blocks, (light, batch, scratch), canvas)
    }
}

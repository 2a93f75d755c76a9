//! Selects the colouring of blocks that one triangle covers fully.
//!
//! If colours only have to be interpolated, or only lit, the block is coloured in one pass without
//! a list of fragments. Everything else is coloured like other blocks.

use super::context::{Group, ShadingContext, group_of};
use super::full_blocks::{BlockLight, Blocks, Canvas, color};
use super::map_texels::{TexelSource, TexturePlacement, place};
use super::path_number::PathNumber;
use super::shader::{Out, Shader};
use super::texels::PlacedTexture;
use super::triangle_attributes::TriangleAttributes;
use crate::frame::draw::Shaded;
use crate::frame::program::{LightOp, WholePath};
use crate::screen::clipped_weights::ClippedWeights;
use crate::simd::Number as _;

impl<T: PathNumber> Shader<T> {
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
        // The triangle has one colour: it is shaded once, and its blocks are filled.
        if group.program.whole == WholePath::Fill {
            let color = self.first_color(&group);
            self.path_pixels.fill += blocks.pixels();
            return blocks.each(|block| canvas.fill(canvas.offset_of(block), color));
        }
        // A triangle that is clipped, wide or without area may need lists all the same.
        if T::blocks_in_one_pass(self, &group, blocks, canvas) {
            return;
        }
        // All other blocks get a fragment list each.
        blocks.each(|[column, row]| {
            self.fragments.list_full_block(number, [x + column, y + row]);
            let at = canvas.offset_of([column, row]);
            self.color_group(&group, &mut Out::Tile(canvas, at));
        });
    }
}

impl Shader<f32> {
    /// Colours fully covered blocks, one block at a time without a list of fragments. Returns
    /// whether it did.
    pub(super) fn blocks_in_one_pass(
        &mut self,
        group: &Group<'_, f32>,
        blocks: Blocks,
        canvas: &mut Canvas<'_>,
    ) -> bool {
        let Some(shaded) = group.shaded.filter(|_| group.program.whole == WholePath::One) else {
            return false;
        };
        let is_done = match group.program.light {
            LightOp::Vertices(_) => self.mix_blocks(group, shaded, blocks, canvas),
            LightOp::Points | LightOp::Faces | LightOp::None => {
                self.light_blocks(group, shaded, blocks, canvas)
            }
        };
        if is_done {
            self.path_pixels.one += blocks.pixels();
        }
        is_done
    }

    /// Returns the weights of the first triangle, if it is clipped.
    fn cut_weights(&self, group: &Group<'_, f32>) -> Option<ClippedWeights> {
        let TriangleAttributes { cut, numbers, .. } = &self.attributes;
        let is_cut = cut & 1 == 1;
        is_cut.then(|| ClippedWeights::new(group.context.plan, group.draw, numbers[0], [0; 2]))
    }

    /// Colours blocks if only the colours of the corners have to be interpolated.
    fn mix_blocks(
        &mut self,
        group: &Group<'_, f32>,
        shaded: &Shaded,
        blocks: Blocks,
        canvas: &mut Canvas<'_>,
    ) -> bool {
        let ShadingContext { level, terms, lit, .. } = *group.context;
        if self.take(group, true) {
            self.carry_diffuse(group, shaded, lit.tables(group.draw_index, group.pipeline));
        }
        let cut = self.cut_weights(group);
        let Self { attributes, batch, placed, .. } = self;
        let light = BlockLight {
            cut: cut.as_ref(),
            interpolation: group.context.mode().interpolation,
            thresholds: terms.thresholds(),
            look: None,
            tint: [1.0; 3],
            texture: None,
            vertex_colors: Some(&attributes.values),
            lights: None,
            terms: &[],
            glow: None,
            encoding: None,
        };
        color(level, attributes, blocks, (light, batch, &mut placed.scratch), canvas)
    }

    /// Colours blocks of surfaces that are lit per pixel or unlit, with or without a texture and
    /// uniform emission, and have no other effects.
    fn light_blocks(
        &mut self,
        group: &Group<'_, f32>,
        shaded: &Shaded,
        blocks: Blocks,
        canvas: &mut Canvas<'_>,
    ) -> bool {
        let context = group.context;
        let ShadingContext { level, plan, terms, .. } = *context;
        // Emission must be the same at every pixel; maps need a list.
        let Some(glow) = shaded.extras.even_glow() else { return false };
        let texture = shaded.texture.as_deref();
        let source = shaded.texture.as_ref().map(|it| TexelSource::of_colors(context, it));
        let sampler = source.and_then(|source| source.sampler());
        // A texture without texels cannot be sampled in lanes.
        if texture.is_some() && sampler.is_none() {
            return false;
        }
        // Attributes are only fetched if the triangle differs from the last one.
        let new = self.take(group, true);
        if let Some(of) = texture.zip(sampler.as_ref()) {
            if new {
                place(group, &self.attributes, of, &mut self.placed);
            }
            // The triangle has no texture coordinates, or they are too large to be placed.
            if self.placed.placement.known & 1 == 0 {
                // The fragment list fetches its own attributes.
                self.attributes.forget();
                return false;
            }
        }
        if new && shaded.vertex_colors {
            self.take_vertex_colors(group);
        }
        let cut = self.cut_weights(group);
        let look = self.look_of(group);
        let Self { tile, attributes, batch, placed, vertex_colors, .. } = self;
        let TexturePlacement { placement, far, scratch } = placed;
        let lights = shaded.light.is_some().then(|| tile.light(plan, group.pipeline, shaded));
        let needs_positions = lights.is_some_and(|lights| lights.needs_positions);
        // Without normals, these attributes must not be reused for the next block.
        if !needs_positions {
            attributes.forget();
        } else if new {
            attributes.carry_normals(group.draw);
            attributes.spread(level);
        }
        let block_light = BlockLight {
            cut: cut.as_ref(),
            interpolation: context.mode().interpolation,
            thresholds: terms.thresholds(),
            look: needs_positions.then_some(look),
            tint: shaded.tint.map(f32::from_f64),
            texture: sampler.as_ref().map(|sampler| PlacedTexture { placement, far, sampler }),
            vertex_colors: shaded.vertex_colors.then_some(vertex_colors),
            lights,
            terms: terms.of(group.pipeline),
            glow: shaded.extras.emission.is_some().then(|| glow.map(f32::from_f64)),
            encoding: terms.encoding(),
        };
        color(level, attributes, blocks, (block_light, batch, scratch), canvas)
    }
}

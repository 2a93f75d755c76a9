//! Chooses how blocks that one triangle covers fully are coloured.
//!
//! If only colours have to be interpolated, or only lit, that is one pass without a list of
//! fragments; everything else is coloured like other blocks.

use super::context::ShadingContext;
use super::full_blocks::{BlockLight, Blocks, Canvas};
use super::groups::{Group, group_of};
use super::interpolate::Look;
use super::interpolated::ShadingNumber;
use super::surface::{Out, Shader};
use crate::accuracy::{LightAt, Rounding};
use crate::render::frame::draw::{Back, Pipeline};

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
        if self.mix_blocks(context, &group, blocks, canvas)
            || self.light_blocks(context, &group, blocks, canvas)
        {
            return;
        }
        blocks.each(|[column, row]| {
            self.fragments.list_full_block(number, [x + column, y + row]);
            let place = [column, row].map(|i| usize::try_from(i).expect("in the tile"));
            let at = canvas.offset(place);
            self.color_group(context, &group, &mut Out::Tile(canvas, at));
        });
    }

    /// Colours fully covered blocks in one pass, if only the colours of the corners have to be
    /// interpolated. Returns whether that was so.
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
        let mixed = shaded.light.is_some() && plan.light_at == LightAt::Vertex;
        if !mixed || group.draw.back == Back::Red || plan.variants.mixes_one_by_one() {
            return false;
        }
        let tables = lit.tables(group.draw_index, group.pipeline);
        if !tables[0].is_colored() {
            return false;
        }
        if self.take(context, group, true) {
            self.carry_diffuse(context, group, shaded, tables);
            self.attributes.spread(level);
        }
        T::mix_blocks(level, &self.attributes, blocks, canvas)
    }

    /// Colours fully covered blocks, a block at a time without a list of fragments, if they are lit
    /// per pixel and nothing else is done to them. Returns whether that was so.
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
        let pixels = matches!(plan.light_at, LightAt::Pixel | LightAt::Sample);
        let textured = shaded.texture.is_some() || shaded.vertex_colors;
        let has_variant = plan.variants.locates_one_by_one()
            || plan.variants.root_variant().is_some()
            || plan.variants.rounding != Rounding::Nearest;
        if shaded.light.is_none()
            || !pixels
            || textured
            || has_variant
            || group.draw.back == Back::Red
        {
            return false;
        }
        let new = self.take(context, group, true);
        let Self { tile, attributes, batch, .. } = self;
        let lights = tile.light(plan, group.pipeline, shaded);
        if !lights.needs_positions {
            attributes.forget();
        } else if new {
            attributes.carry_normals(group.draw);
            attributes.spread(level);
        }
        let light = BlockLight {
            look: lights.needs_positions.then(|| Look::new(plan, group.draw)),
            tint: shaded.tint.map(T::from_f64),
            lights,
            terms: terms.of(group.pipeline),
        };
        T::light_blocks(level, attributes, blocks, (light, batch), canvas)
    }
}

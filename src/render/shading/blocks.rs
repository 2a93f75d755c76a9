//! Blocks of a tile that one triangle covers as a whole, and in which way they are coloured.
//!
//! Where all that is to do is to mix colours, or to light what is there, that is one pass without a list;
//! all else goes the way of other blocks.

use super::context::ShadingContext;
use super::groups::{Group, group_of};
use super::interpolate::Look;
use super::interpolated::ShadingNumber;
use super::surface::{Out, Shader};
use crate::accuracy::{LightAt, Rounding};
use crate::render::frame::draw::{Back, Pipeline};
use crate::render::shading::full_blocks::{BlockLight, Blocks, Canvas};

impl<T: ShadingNumber> Shader<T> {
    /// Colours the pixels of blocks that one triangle covers as a whole.
    pub(crate) fn whole_blocks(
        &mut self,
        context: &ShadingContext<'_, T>,
        number: u32,
        blocks: Blocks,
        canvas: &mut Canvas<'_>,
    ) {
        let group = group_of(context, number);
        let [x, y] = blocks.corner;
        self.items.list_whole(number, [x, y]);
        if self.mix_blocks(context, &group, blocks, canvas)
            || self.light_blocks(context, &group, blocks, canvas)
        {
            return;
        }
        blocks.each(|[column, row]| {
            self.items.list_whole(number, [x + column, y + row]);
            let place = [column, row].map(|i| usize::try_from(i).expect("in the tile"));
            let at = canvas.place(place);
            self.color_group(context, &group, &mut Out::Tile(canvas, at));
        });
    }

    /// Colours the pixels of blocks that one triangle covers as a whole in one pass, where all that is
    /// to do is to mix the colours of its corners. Says whether it is.
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
            self.faces.spread(level);
        }
        T::mix_blocks(level, &self.faces, blocks, canvas)
    }

    /// Colours the pixels of blocks that one triangle covers as a whole, a block at a time without a
    /// list, where they are lit and nothing else is done to them. Says whether it is so.
    fn light_blocks(
        &mut self,
        context: &ShadingContext<'_, T>,
        group: &Group<'_>,
        blocks: Blocks,
        canvas: &mut Canvas<'_>,
    ) -> bool {
        let ShadingContext { level, plan, shines, .. } = *context;
        let Pipeline::Shaded(shaded) = &plan.pipelines[group.pipeline as usize] else {
            return false;
        };
        let pixels = matches!(plan.light_at, LightAt::Pixel | LightAt::Sample);
        let textured = shaded.texture.is_some() || shaded.vertex_colors;
        let rare = plan.variants.has_rare_places()
            || plan.variants.rare_roots().is_some()
            || plan.variants.rounding != Rounding::Nearest;
        if shaded.light.is_none() || !pixels || textured || rare || group.draw.back == Back::Red {
            return false;
        }
        let new = self.take(context, group, true);
        let Self { tile, faces, batch, .. } = self;
        let lights = tile.light(plan, group.pipeline, shaded);
        if !lights.places {
            faces.forget();
        } else if new {
            faces.carry_normals(group.draw);
            faces.spread(level);
        }
        let light = BlockLight {
            look: lights.places.then(|| Look::new(plan, group.draw)),
            tint: shaded.tint.map(T::from_f64),
            lights,
            shines: shines.of(group.pipeline),
        };
        T::light_blocks(level, faces, blocks, (light, batch), canvas)
    }
}

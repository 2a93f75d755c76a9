//! Colours lists with a separate triangle in nearly each pixel.
//!
//! Triangles of about a pixel gain nothing from slots: each would be looked up, prepared, stored,
//! and gathered again for a single pixel. Here, lane i of sixteen holds the triangle of pixel i,
//! from its vertices to its normals. Lists extend over several blocks, and their inputs are
//! prefetched, because most of them are not in the near caches. The bits are the same as with
//! slots.
//!
//! Clipped triangles, and triangles with edge functions of more than 32 bits, are not tiny.
//!
//! Blocks wait until their pixels fill a list, like other blocks of one surface. If a triangle of
//! the list is clipped or wide, its blocks are coloured one by one instead, with slots.

use crate::accel::Accelerated as _;
use prefetch_index::prefetch_index;

use super::colors::Form;
use super::context::{Group, ShadingContext, are_of};
use super::full_blocks::Canvas;
use super::light::Lighting;
use super::runs::Runs;
use super::shader::{Out, Shader, Waiting};
use super::tiny_triangles::{mix, sample, weigh};
use crate::frame::draw::{Back, Shaded, Stage};
use crate::frame::program::{LightOp, OtherPath};
use crate::raster::entries::word;
use crate::screen::tiles::BLOCK_PIXELS;
use crate::simd::dispatch;
use marraztu_core::scene::Normals;

/// The approximate number of distinct triangles in a block from which they are drawn as tiny ones.
pub(super) const MANY: u32 = 32;

impl Shader<f32> {
    /// Lists a block of tiny triangles, to be coloured by [`Shader::finish_waiting`]. Returns
    /// whether it did; blocks of larger triangles or of several groups are not listed.
    pub(super) fn wait_tiny(
        &mut self,
        group: &Group<'_, f32>,
        (runs, corner): (&Runs, [i32; 2]),
        (canvas, at): (&mut Canvas<'_>, usize),
    ) -> bool {
        // If the list is full or holds larger triangles, the waiting blocks are coloured first.
        if !self.fragments.have_room_for_tiny(runs) || self.waiting.is_empty() {
            self.finish_waiting(group.context, canvas);
            if group.program.others != OtherPath::Each {
                return false;
            }
            self.fragments.begin_tiny();
        }
        let from = self.fragments.len;
        self.fragments.list_tiny(group.context.level, runs, corner);
        let each = self.fragments.each();
        // Another draw or pipeline: the block is removed from the list again.
        if !are_of(group, &each[..1]) || !are_of(group, &each[from..]) {
            self.fragments.shorten(from);
            return false;
        }
        let order = group.draw.model.mesh.draw_order();
        // Read when the list is full, so prefetches have time to arrive.
        each[from..].iter().for_each(|number| order.prefetch(number - group.base));
        self.waiting.push(Waiting { from, at });
        true
    }

    /// Colours the waiting blocks of tiny triangles.
    pub(super) fn finish_tiny(&mut self, group: &Group<'_, f32>, canvas: &mut Canvas<'_>) {
        self.colors.form = Form::Pixels;
        self.colors.linear = group.context.mode().is_linear();
        let Some((shaded, stages)) = group.lit() else { return };
        let is_done = match group.program.light {
            LightOp::Vertices(_) => self.mix_tiny(group, stages),
            LightOp::Points | LightOp::Faces | LightOp::None => self.light_tiny(group, shaded),
        };
        if is_done {
            self.path_pixels.each += self.fragments.len as u64;
            self.copy_waiting(canvas);
        } else {
            self.color_one_by_one(group.context, canvas);
        }
    }

    /// Colours the waiting blocks one after the other, with slots.
    #[cold]
    fn color_one_by_one(&mut self, context: &ShadingContext<'_, f32>, canvas: &mut Canvas<'_>) {
        let all = std::mem::take(&mut self.fragments);
        for block in 0..self.waiting.len() {
            let Waiting { from, at } = self.waiting[block];
            let end = self.waiting.get(block + 1).map_or(all.len, |next| next.from);
            // The entries of the block are rebuilt; any depth serves.
            let mut visibility = [0; BLOCK_PIXELS];
            for (place, number) in all.pixels[from..end].iter().zip(&all.each()[from..end]) {
                visibility[usize::from(*place) % BLOCK_PIXELS] = word(1, *number);
            }
            // Any pixel tells the corner of its block.
            let corner = [all.x[from], all.y[from]].map(|at| at & !7);
            self.fragments.list(context.level, &visibility, corner, 0);
            self.color_fragments(context, &mut Out::Tile(canvas, at));
        }
    }

    /// Computes the barycentric coordinates of the list. Returns whether all triangles are tiny.
    fn weigh_tiny(&mut self, group: &Group<'_, f32>) -> bool {
        let ShadingContext { level, plan, frame, .. } = *group.context;
        let by = (plan.raster_mode().grid, group.context.mode().interpolation);
        let of = (group.draw, frame.corners_of(group.draw_index));
        let Self { fragments, tiny, barycentrics, .. } = self;
        dispatch!(level, simd => weigh(simd, by, of, (fragments, tiny), barycentrics))
    }

    /// Phong shading, like [`Shader::light_points`].
    fn light_tiny(&mut self, group: &Group<'_, f32>, shaded: &Shaded) -> bool {
        let ShadingContext { level, plan, frame, terms, .. } = *group.context;
        self.batch.len = self.fragments.len;
        if self.tile.light(plan, group.pipeline, shaded).needs_positions {
            let look = self.look_of(group);
            let mesh = &group.draw.model.mesh;
            let order = mesh.draw_order();
            let points = order.points(group.draw.normal_source);
            let by_vertex = group.draw.normals == Normals::Vertex;
            let normals = if by_vertex { &points.normals } else { mesh.polygon_normals() };
            // Normals are prefetched while the edge functions are computed.
            let list = (self.fragments.each(), group.base);
            let from = (order, frame.corners_of(group.draw_index));
            let prefetch = |place: u32| prefetch_index(normals, place as usize);
            if by_vertex {
                let corners = |number, ids| points.of(order, number, ids);
                self.tiny.take(from, list, corners, prefetch);
            } else {
                self.tiny.take(from, list, |number, _| [mesh.polygon_of(number); 3], prefetch);
            }
            if !self.weigh_tiny(group) {
                return false;
            }
            let Self { fragments, tiny, barycentrics, batch, .. } = self;
            let normals = (normals, group.draw.back == Back::Lit);
            let of = (&*fragments, &*tiny);
            dispatch!(level, simd => {
                sample(simd, &look, of, normals, barycentrics, batch);
            });
        }
        let light = self.tile.light(plan, group.pipeline, shaded);
        light.light_batch(terms.of(group.pipeline), level, &mut self.batch, None);
        self.quantize(group.context, Some(shaded.tint), (true, false));
        true
    }

    /// Gouraud shading, like [`Shader::mix_light`].
    fn mix_tiny(&mut self, group: &Group<'_, f32>, stages: &[Stage]) -> bool {
        let ShadingContext { level, frame, lit, terms, .. } = *group.context;
        let mesh = &group.draw.model.mesh;
        let order = mesh.draw_order();
        let points = order.points(group.draw.normal_source);
        let tables = lit.tables(group.draw_index, group.pipeline);
        let list = (self.fragments.each(), group.base);
        let from = (order, frame.corners_of(group.draw_index));
        // Light is stored by point, or by corner with face normals.
        match group.draw.normals {
            Normals::Face => {
                let triangles = mesh.triangles();
                let corners = |number: u32, _: [u32; 3]| triangles[number as usize].corners;
                self.tiny.take(from, list, corners, |_| {});
            }
            Normals::Vertex => {
                let corners = |number, ids| points.of(order, number, ids);
                self.tiny.take(from, list, corners, |_| {});
            }
        }
        if !self.weigh_tiny(group) {
            return false;
        }
        let terms = terms.of(group.pipeline);
        let lighting = Lighting { level, draw: group.draw, stages, terms, tracer: None };
        let Self {
            fragments,
            tiny,
            corner_colors,
            barycentrics,
            batch,
            rays,
            colors,
            thresholds,
            ..
        } = self;
        // One table look-up per corner; unlit vertices are lit here.
        for (i, places) in tiny.places[..fragments.len].iter().enumerate() {
            let back = tiny.back[i / 16] >> (i % 16) & 1 != 0;
            let table = tables[usize::from(back)];
            for (rows, place) in corner_colors.iter_mut().zip(places) {
                rows[i] = table.diffuse(*place, &lighting, (&mut *batch, &mut *rays));
            }
        }
        let thresholds = thresholds.of(group.context.mode().rounding, fragments);
        let of = (&**corner_colors, fragments.len);
        dispatch!(level, simd => mix(simd, of, barycentrics, (colors, thresholds)));
        true
    }
}

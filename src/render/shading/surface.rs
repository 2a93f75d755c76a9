//! From what is seen to colours.
//!
//! A block's pixels are listed by the triangles that they show ([`Fragments`]). What is known of these is
//! fetched once for each triangle ([`TriangleAttributes`]), taken from there by the pixels ([`Barycentrics`]), lit
//! ([`Batch`]), and made bytes. Light that is evaluated at faces is evaluated at the faces of the
//! block; no pixel asks where it lies.

use super::barycentric_variants::locate_by_variant;
use super::colors::{Colors, Form, Sums};
use super::context::ShadingContext;
use super::groups::{Group, group_of, one_group};
use super::interpolate::{Mixed, mix, surroundings};
use super::interpolated::ShadingNumber;
use super::light::{Lighting, Table, run};
use crate::accuracy::{LightAt, Rounding};
use crate::base::color::Color;
use crate::render::frame::draw::{Back, Pipeline, Shaded, Stage};
use crate::render::lights::{Batch, Rows};
use crate::render::plan::tile::TilePlan;
use crate::render::raster::visibility_buffer::{Visible, seen};
use crate::render::screen::sample_positions::ALL;
use crate::render::screen::tiles::{BLOCK, BLOCK_PIXELS};
use crate::render::shading::barycentrics::Barycentrics;
use crate::render::shading::fragments::Fragments;
use crate::render::shading::full_blocks::Canvas;
use crate::render::shading::quantize::{Finish, Own};
use crate::render::shading::rounding::{FinishBy, thresholds};
use crate::render::shading::triangle_attributes::TriangleAttributes;
use crate::render::simd::BATCH;
use crate::render::simd::gather::SLOTS;

/// Colours pixels. Each thread has its own.
#[derive(Debug)]
pub(crate) struct Shader<T> {
    /// The lights of the tile that is coloured.
    pub(crate) tile: TilePlan,
    pub(crate) items: Fragments,
    pub(crate) faces: TriangleAttributes<T>,
    pub(crate) located: Barycentrics<T>,
    pub(crate) batch: Batch<T>,
    pub(crate) texels: Rows<T>,
    colors: Colors,
}

/// Where colours of a block go.
#[derive(Debug)]
pub(crate) enum Out<'a, 'b> {
    /// Into a tile, from a place on.
    Tile(&'a mut Canvas<'b>, usize),
    /// To what other samples show.
    Sums(&'a mut Sums),
}

/// What mixing the light of vertices gave.
#[derive(Clone, Copy, Debug)]
enum Mixture {
    /// The bytes of the pixels.
    Bytes,
    /// Their colours, as diffuse light.
    Colors,
    /// Diffuse and specular light.
    Light,
}

impl<T: ShadingNumber> Default for Shader<T> {
    fn default() -> Self {
        Self {
            tile: TilePlan::default(),
            items: Fragments::default(),
            faces: TriangleAttributes::default(),
            located: Barycentrics::default(),
            batch: Batch::default(),
            texels: [[T::default(); BATCH]; 3],
            colors: Colors::default(),
        }
    }
}

impl<T: ShadingNumber> Shader<T> {
    /// Gets ready for another frame.
    pub(crate) const fn begin(&mut self) {
        self.faces.forget();
    }

    /// Colours the pixels of a block whose upper left pixel is `corner` into a tile, from `at` on. What
    /// shows the background is left as it is; says whether anything else is shown.
    pub(crate) fn block(
        &mut self,
        context: &ShadingContext<'_, T>,
        words: &[u64; BLOCK_PIXELS],
        corner: [i32; 2],
        (canvas, at): (&mut Canvas<'_>, usize),
    ) -> bool {
        let shown = self.items.list(context.level, words, corner);
        let mut lines = shown.lines;
        while lines != 0 {
            let i = lines.trailing_zeros() as usize;
            lines &= lines - 1;
            if let Visible::Line(line) = seen(words[i]) {
                canvas.pixels[at + canvas.place(in_block(i))] =
                    context.frame.line_color(context.plan, line);
            }
        }
        if shown.triangles != 0 {
            self.color_items(context, corner, &mut Out::Tile(canvas, at));
        }
        (shown.triangles | shown.lines) != 0
    }

    /// Colours the pixels of the list.
    pub(crate) fn color_items(
        &mut self,
        context: &ShadingContext<'_, T>,
        corner: [i32; 2],
        out: &mut Out<'_, '_>,
    ) {
        if let Some(group) = one_group(context, &self.items) {
            self.color_group(context, &group, out);
        } else {
            self.color_groups(context, corner, out);
        }
    }

    /// Colours the pixels of a block that one triangle covers as a whole.
    pub(crate) fn whole_block(
        &mut self,
        context: &ShadingContext<'_, T>,
        number: u32,
        corner: [i32; 2],
        out: &mut Out<'_, '_>,
    ) {
        self.items.list_whole(number, corner);
        self.items.shares = [ALL; BLOCK_PIXELS];
        self.color_group(context, &group_of(context, number), out);
    }

    /// Colours pixels that are coloured together.
    pub(crate) fn color_group(
        &mut self,
        context: &ShadingContext<'_, T>,
        group: &Group<'_>,
        out: &mut Out<'_, '_>,
    ) {
        self.colors.form = match out {
            Out::Tile(..) => Form::Pixels,
            Out::Sums(_) => Form::Parts,
        };
        self.group(context, group);
        match out {
            Out::Tile(canvas, at) => self.copy(canvas, *at),
            Out::Sums(sums) => {
                let Fragments { len, places, shares, .. } = &self.items;
                sums.add_all(&self.colors, &places[..*len], &shares[..*len]);
            }
        }
    }

    /// Colours the pixels of a block that shows several draws, or parts that are drawn in several
    /// ways.
    fn color_groups(
        &mut self,
        context: &ShadingContext<'_, T>,
        corner: [i32; 2],
        out: &mut Out<'_, '_>,
    ) {
        let mut done = [false; SLOTS];
        let all = std::mem::take(&mut self.items);
        for slot in 0..all.count {
            if done[slot] {
                continue;
            }
            let group = group_of(context, all.numbers[slot]);
            let end = context.frame.draw_of(all.numbers[slot]).1.end;
            let mut keep = [false; SLOTS];
            for (other, number) in all.numbers[..all.count].iter().enumerate().skip(slot) {
                keep[other] = (group.base..end).contains(number)
                    && group.draw.pipeline_of(number - group.base) == group.pipeline;
                done[other] |= keep[other];
            }
            self.items.take_from(&all, &keep, corner);
            self.color_group(context, &group, out);
        }
        self.items = all;
    }

    /// Copies the colours into the tile.
    fn copy(&self, canvas: &mut Canvas<'_>, at: usize) {
        if self.items.is_whole() {
            canvas.put(at, &self.colors.pixels);
        } else {
            let places = &self.items.places[..self.items.len];
            for (i, color) in places.iter().zip(&self.colors.pixels) {
                let place = canvas.place(in_block(usize::from(*i)));
                canvas.pixels[at + place] = color.to_le_bytes();
            }
        }
    }

    fn group(&mut self, context: &ShadingContext<'_, T>, group: &Group<'_>) {
        match &context.plan.pipelines[group.pipeline as usize] {
            Pipeline::Flat(color) => self.colors.fill(color.opaque()),
            Pipeline::Shaded(shaded) => {
                self.shaded(context, group, shaded);
                if group.draw.back == Back::Red {
                    self.redden();
                }
            }
        }
    }

    /// Backs that are red are red.
    fn redden(&mut self) {
        for (i, slot) in self.items.slots[..self.items.len].iter().enumerate() {
            if self.faces.back >> slot & 1 == 1 {
                self.colors.set(i, Color::BACK_FACE.opaque());
            }
        }
    }

    fn shaded(&mut self, context: &ShadingContext<'_, T>, group: &Group<'_>, shaded: &Shaded) {
        let ShadingContext { level, plan, .. } = *context;
        let draw = group.draw;
        let textured = shaded.texture.is_some() || shaded.vertex_colors;
        let rounding = plan.variants.rounding;
        // Every pixel has its own colour.
        let each = textured || rounding == Rounding::Dithered;
        let light = shaded.light.as_deref().map(|stages| (plan.light_at, stages));
        let places = textured || matches!(light, Some((LightAt::Pixel | LightAt::Vertex, _)));
        let new = self.take(context, group, places);
        if places {
            self.located.find(level, &self.items, &self.faces, (plan, draw));
            if plan.variants.has_rare_places() {
                let corners = context.frame.corners_of(plan, group.draw_index);
                locate_by_variant(
                    plan.variants,
                    &self.items,
                    &self.faces,
                    corners,
                    &mut self.located,
                );
            }
        }
        self.batch.len = self.items.len;
        let mut tint = shaded.tint;
        match light {
            None => {}
            Some((LightAt::Pixel | LightAt::Sample, _)) => {
                self.light_pixels(context, group, shaded, new);
            }
            Some((LightAt::Vertex, _)) => match self.mix_light(context, group, shaded, new) {
                Mixture::Bytes => return,
                Mixture::Colors => tint = [1.0; 3],
                Mixture::Light => {}
            },
            Some((LightAt::Face, stages)) => self.light_faces(context, group, stages, each),
        }
        if textured {
            self.texels(context, group, shaded);
        }
        let Self { batch, texels, colors, .. } = self;
        let own = if textured { Own::Texels(texels) } else { Own::Tint(tint.map(T::from_f64)) };
        let lit = light.is_some();
        if rounding == Rounding::Nearest {
            T::run(level, Finish { batch, lit, own, colors });
        } else {
            let thresholds = &thresholds(rounding, &self.items);
            T::run(level, FinishBy { batch, lit, own, thresholds, colors });
        }
        if !(places || each) {
            self.colors.hand_out(&self.items.slots);
        }
    }

    /// Takes the triangles of the list, and where they are if the pixels have `places`. Says whether
    /// they are others than before.
    pub(crate) fn take(
        &mut self,
        context: &ShadingContext<'_, T>,
        group: &Group<'_>,
        places: bool,
    ) -> bool {
        let ShadingContext { level, plan, frame, .. } = *context;
        let Group { draw, draw_index, base, .. } = *group;
        let corners = places || draw.back != Back::Left;
        let order = corners.then(|| draw.model.mesh.draw_order());
        let new = self.faces.take(&self.items, order, draw_index, base);
        if new {
            let vertices = frame.vertices_of(plan, draw_index);
            self.faces.find_sides(draw, plan, frame.corners_of(plan, draw_index));
            if places {
                self.faces.locate(level, draw, plan, vertices);
            }
        }
        new
    }

    /// Light at every pixel.
    fn light_pixels(
        &mut self,
        context: &ShadingContext<'_, T>,
        group: &Group<'_>,
        shaded: &Shaded,
        new: bool,
    ) {
        let ShadingContext { level, plan, shines, .. } = *context;
        let Self { tile, items, faces, located, batch, .. } = self;
        let light = tile.light(plan, group.pipeline, shaded);
        if light.places {
            if new {
                faces.carry_normals(group.draw);
                faces.spread(level);
            }
            surroundings(level, (plan, group.draw), items, faces, located, batch);
        } else {
            // What they carry is not taken, so it is not there.
            faces.forget();
        }
        batch.darken();
        light.shine(shines.of(group.pipeline), level, batch);
    }

    /// Light of the vertices, mixed at every pixel.
    fn mix_light(
        &mut self,
        context: &ShadingContext<'_, T>,
        group: &Group<'_>,
        shaded: &Shaded,
        new: bool,
    ) -> Mixture {
        let ShadingContext { level, plan, .. } = *context;
        let tables = context.lit.tables(group.draw_index, group.pipeline);
        if new || !tables[0].is_colored() {
            self.carry_diffuse(context, group, shaded, tables);
            self.faces.spread(level);
        }
        let Self { items, faces, located, batch, colors, .. } = self;
        let colored = tables[0].is_colored();
        if colored && plan.variants.rounding == Rounding::Nearest {
            mix(level, items, faces, located, Mixed::Colors(colors));
            return Mixture::Bytes;
        }
        mix(level, items, faces, located, Mixed::Rows(&mut batch.diffuse));
        batch.len = items.len;
        if colored {
            batch.specular = [[T::default(); BATCH]; 3];
            return Mixture::Colors;
        }
        faces.carry_light(
            group.draw,
            #[inline(always)]
            |place, back| tables[usize::from(back)].specular(place),
        );
        faces.spread(level);
        mix(level, items, faces, located, Mixed::Rows(&mut batch.specular));
        Mixture::Light
    }

    /// Lets the faces carry the diffuse light of their corners, or their colours.
    pub(crate) fn carry_diffuse(
        &mut self,
        context: &ShadingContext<'_, T>,
        group: &Group<'_>,
        shaded: &Shaded,
        tables: [&Table<T>; 2],
    ) {
        let Self { faces, batch, .. } = self;
        let stages = shaded.light.as_deref().unwrap_or_default();
        let shines = context.shines.of(group.pipeline);
        let lighting = Lighting { level: context.level, draw: group.draw, stages, shines };
        faces.carry_light(
            group.draw,
            #[inline(always)]
            |place, back| tables[usize::from(back)].diffuse(place, &lighting, batch),
        );
    }

    /// Light of the faces: at every pixel where they have `places`, else face by face.
    fn light_faces(
        &mut self,
        context: &ShadingContext<'_, T>,
        group: &Group<'_>,
        stages: &[Stage],
        places: bool,
    ) {
        let ShadingContext { level, lit, shines, .. } = *context;
        let Self { items, faces, batch, .. } = self;
        batch.len = faces.count;
        lit.place_faces(level, (group.draw_index, group.draw), faces, batch);
        batch.darken();
        run(stages, shines.of(group.pipeline), level, batch);
        if places {
            for row in batch.diffuse.iter_mut().chain(&mut batch.specular) {
                let of_faces = *row;
                for (own, slot) in row.iter_mut().zip(&items.slots[..items.len]) {
                    *own = of_faces[slot.cast_unsigned() as usize];
                }
            }
            batch.len = items.len;
        }
    }
}

/// Column and row of pixel `i` of a block.
const fn in_block(i: usize) -> [usize; 2] {
    [i % BLOCK as usize, i / BLOCK as usize]
}

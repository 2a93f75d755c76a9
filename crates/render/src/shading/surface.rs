//! Shades blocks: from visibility to colours.
//!
//! A block's pixels are listed with the triangles that they show ([`Fragments`]). Attributes are
//! fetched once per triangle ([`TriangleAttributes`]), interpolated (`barycentrics`), lit
//! (`lights::Batch`), and converted to bytes. With flat shading, light is evaluated once for each
//! face of the block, and no barycentric coordinates are computed.

use super::bumps::bend;
use super::colors::Form;
use super::context::{Group, ShadingContext, group_of, one_group};
use super::fragments::Fragments;
use super::hits::{Point, no_light, place_normals};
use super::interpolate::{Look, Mixed, Points, mix, surface_samples};
use super::interpolated::ShadingNumber;
use super::light::{Lighting, Table, run};
use super::lit_points::{place_fragments, place_points};
use super::quantize::{Quantize, SurfaceColor};
use super::shader::{Out, Shader};
use super::shadows::{BatchShadows, place_faces};
use super::triangle_attributes::{TriangleAttributes, asks_ahead};
use crate::accel::Accelerated as _;
use crate::frame::draw::{Back, Pipeline, Shaded};
use crate::frame::program::{LightOp, Program, VertexLight};
use crate::plan::tile::TileLight;
use crate::shadow::rays::Origins;
use crate::simd::gather::{SLOTS, most_gathered};
use marraztu_core::accuracy::{LightAt, Rounding};
use marraztu_core::base::color::Color;

/// The points of a list: everything after them is the same.
#[derive(Clone, Copy, Debug)]
pub(super) enum Origin<'a> {
    /// Pixels of the picture.
    Pixels,
    /// Points that rays meet.
    Hits(&'a [Point]),
}

impl<T: ShadingNumber> Shader<T> {
    /// Returns the number of slots up to which triangles keep their slots for the next list:
    /// triangles in several blocks are then prepared once. Returns 0 if that does not pay: with
    /// light per face, all slots are lit for each list.
    pub(super) fn most_slots(&self, context: &ShadingContext<'_, T>) -> usize {
        let is_lit_once = context.plan.light_at == LightAt::Face;
        let pays = !is_lit_once && self.prepares_little && self.attributes.may_go_on();
        if pays { most_gathered(context.level) } else { 0 }
    }

    /// Colours the fragments of the list.
    pub(crate) fn color_fragments(
        &mut self,
        context: &ShadingContext<'_, T>,
        out: &mut Out<'_, '_>,
    ) {
        match one_group(context, &self.fragments) {
            Some(group) => self.color_group(&group, out),
            None => self.color_groups(context, out),
        }
    }

    /// Colours the fragments of a group.
    pub(crate) fn color_group(&mut self, group: &Group<'_, T>, out: &mut Out<'_, '_>) {
        // The fixed-point form is summed; bytes are copied to the tile.
        self.colors.form = match out {
            Out::Tile(..) | Out::Waiting(_) => Form::Pixels,
            Out::Sums(_) | Out::Kept(..) | Out::Layer(_) => Form::Parts,
        };
        self.colors.linear = group.context.mode().is_linear();
        self.group(group);
        self.path_pixels.slots += self.fragments.len as u64;
        match out {
            Out::Tile(canvas, at) => self.copy(canvas, 0..self.fragments.len, *at),
            Out::Waiting(canvas) => self.copy_waiting(canvas),
            Out::Sums(sums) => {
                let Fragments { len, pixels, shares, .. } = &self.fragments;
                sums.add_all(&self.colors, &pixels[..*len], &shares[..*len]);
            }
            Out::Kept(sums, kept, first) => {
                let Fragments { len, pixels, shares, slots, numbers, .. } = &self.fragments;
                let pixels = &pixels[..*len];
                sums.add_all(&self.colors, pixels, &shares[..*len]);
                // Each pixel caches one colour: the triangle of its first sample.
                kept.keep(&self.colors, &pixels[..*len.min(first)], slots, numbers);
            }
            Out::Layer(blend) => {
                let opacities = self.opacities(group);
                let pixels = &self.fragments.pixels[..self.fragments.len];
                for (i, (place, opacity)) in pixels.iter().zip(opacities).enumerate() {
                    blend.put(usize::from(*place), self.colors.part(i), opacity);
                }
            }
        }
    }

    /// Returns the colour of the first fragment of a group.
    pub(crate) fn first_color(&mut self, group: &Group<'_, T>) -> [u8; 4] {
        self.colors.form = Form::Pixels;
        self.group(group);
        self.colors.pixels[0].to_le_bytes()
    }

    /// Colours a block that shows several draws or pipelines, group by group.
    pub(super) fn color_groups(&mut self, context: &ShadingContext<'_, T>, out: &mut Out<'_, '_>) {
        let mut done = [false; SLOTS];
        // Each group gets a list with its part of the fragments.
        let all = std::mem::take(&mut self.fragments);
        for slot in 0..all.count {
            if done[slot] {
                continue;
            }
            let group = group_of(context, all.numbers[slot]);
            let mut keep = [false; SLOTS];
            for (other, number) in all.numbers[..all.count].iter().enumerate().skip(slot) {
                keep[other] = group.holds(*number);
                done[other] |= keep[other];
            }
            self.fragments.take_from(&all, &keep);
            // Triangles of the last list that keep their slots may have no fragments.
            if self.fragments.len > 0 {
                self.color_group(&group, out);
            }
        }
        self.fragments = all;
    }

    pub(super) fn group(&mut self, group: &Group<'_, T>) {
        match &group.context.plan.pipelines[group.pipeline as usize] {
            Pipeline::Flat(color) => self.colors.fill(color.opaque()),
            Pipeline::Shaded(shaded) => {
                self.shaded(group, shaded);
                if group.draw.back == Back::Red {
                    self.redden();
                }
            }
        }
    }

    /// Colours back faces red.
    fn redden(&mut self) {
        for (i, slot) in self.fragments.slots[..self.fragments.len].iter().enumerate() {
            if self.attributes.back >> slot & 1 == 1 {
                self.colors.set(i, Color::BACK_FACE.opaque());
            }
        }
    }

    fn shaded(&mut self, group: &Group<'_, T>, shaded: &Shaded) {
        let Group { context, draw, program, .. } = *group;
        let Program { is_located, is_by_triangle, light, .. } = *program;
        let extras = &shaded.extras;
        // Indices of texture coordinates are prefetched while corners are prepared.
        if shaded.texture.is_some() && asks_ahead(self.fragments.count) {
            let mesh = &draw.model.mesh;
            let numbers = &self.fragments.numbers[..self.fragments.count];
            numbers.iter().for_each(|number| mesh.prefetch_uv_places(number - group.base));
        }
        self.take(group, is_located);
        // Textures are placed for all slots of a list, so keeping slots would save little.
        self.prepares_little = !shaded.varies() && extras.is_empty();
        if is_located {
            self.barycentrics.find(context.level, &self.fragments, &self.attributes, group);
        }
        let Fragments { count, len, .. } = self.fragments;
        self.batch.len = if is_by_triangle { count } else { len };
        // Light comes first. With light at vertices it may contain the tint already.
        let mut tint = shaded.tint;
        match light {
            LightOp::None => {}
            LightOp::Points => self.light_points(group, shaded, Origin::Pixels),
            LightOp::Faces => self.light_faces(group, shaded),
            LightOp::Vertices(light) => {
                self.mix_light(group, shaded, light);
                match light {
                    VertexLight::Bytes => return,
                    VertexLight::Colors => tint = [1.0; 3],
                    VertexLight::Light => {}
                }
            }
        }
        let mut glows = self.surface_light(group, shaded);
        if let Some(rays) = &extras.rays {
            if !glows {
                self.maps.glow = no_light();
            }
            self.see_surroundings(group, rays);
            glows = true;
        }
        let tint = (!shaded.varies()).then_some(tint);
        self.quantize(context, tint, (light != LightOp::None, glows));
        // If each triangle has one colour, the colours of slots are handed out to their pixels.
        if is_by_triangle {
            self.colors.hand_out(&self.fragments.slots[..self.fragments.len]);
        }
    }

    /// Converts the light of the list, times a tint or the texels, plus emission, to colours.
    pub(super) fn quantize(
        &mut self,
        context: &ShadingContext<'_, T>,
        tint: Option<[f64; 3]>,
        (lit, glows): (bool, bool),
    ) {
        let ShadingContext { level, terms, .. } = *context;
        let (rounding, encoding) = (context.mode().rounding, terms.encoding());
        let Self { batch, texels, colors, maps, thresholds, fragments, .. } = self;
        let own = match tint {
            None => SurfaceColor::Texels(texels),
            Some(tint) => SurfaceColor::Tint(tint.map(T::from_f64)),
        };
        // Rounding to nearest is the kernel's default and needs no thresholds.
        let thresholds =
            (rounding != Rounding::Nearest).then(|| thresholds.of(rounding, fragments));
        let glow = glows.then_some(&maps.glow);
        // Most surfaces neither glow nor need encoding, and take the smaller kernel.
        if glows || encoding.is_some() {
            let kernel =
                Quantize::<T, true> { batch, lit, own, glow, thresholds, encoding, colors };
            T::run(level, kernel);
        } else {
            let kernel =
                Quantize::<T, false> { batch, lit, own, glow, thresholds, encoding, colors };
            T::run(level, kernel);
        }
    }

    /// Fetches the triangles of the list, with their screen positions if they are to be `located`.
    /// Returns whether they differ from the last list's.
    pub(crate) fn take(&mut self, group: &Group<'_, T>, located: bool) -> bool {
        let Group { context, draw, draw_index, base, .. } = *group;
        let ShadingContext { level, plan, frame, .. } = *context;
        // Without culling, corners tell back faces from front faces even in flat shading.
        let corners = located || draw.back != Back::Culled;
        let order = corners.then(|| draw.model.mesh.draw_order());
        let new = self.attributes.take(&self.fragments, order, draw_index, base);
        if new {
            let vertices = frame.corners_of(draw_index);
            // Normals are requested now and read after the corners.
            if located && group.program.light == LightOp::Points && asks_ahead(self.fragments.count)
            {
                self.attributes.prefetch_normals(draw);
            }
            self.attributes.find_sides(level, draw, plan, vertices);
            if located {
                self.attributes.locate(level, draw, plan, vertices);
            }
        }
        new
    }

    /// Returns the conversion of a group's pixels to positions and normals, computed once per draw.
    pub(super) fn look_of(&mut self, group: &Group<'_, T>) -> Look<T> {
        match self.look {
            Some((draw, look)) if draw == group.draw_index => look,
            _ => {
                let look = Look::new(group.context.plan, group.draw);
                self.look = Some((group.draw_index, look));
                look
            }
        }
    }

    /// Phong shading: lights every point.
    pub(super) fn light_points(
        &mut self,
        group: &Group<'_, T>,
        shaded: &Shaded,
        origin: Origin<'_>,
    ) {
        let context = group.context;
        let ShadingContext { level, plan, terms, .. } = *context;
        if let Some(map) = &shaded.extras.exponent {
            self.map_exponents(group, map);
        }
        let look = matches!(origin, Origin::Pixels).then(|| self.look_of(group));
        let Self { tile, fragments, attributes, barycentrics, batch, maps, rays, .. } = self;
        // Lights are left out tile by tile; rays have no tile.
        let light = match origin {
            Origin::Pixels => tile.light(plan, group.pipeline, shaded),
            Origin::Hits(_) => TileLight::of(shaded),
        };
        if light.needs_positions {
            if attributes.are_new {
                attributes.carry_normals(group.draw);
                attributes.spread(level);
            }
            let points = Points { fragments, attributes, barycentrics };
            match look {
                Some(look) => surface_samples(level, look, points, batch),
                // Positions and directions are those of the rays.
                None => place_normals(level, group.draw, points, batch),
            }
            // Bump maps tilt the interpolated normals before any light reads them.
            if let Some(bump) = &shaded.extras.bump {
                if shaded.extras.rays.is_some() {
                    maps.unbent = batch.normal;
                }
                bend(group, points, bump, (maps, batch));
            }
        } else {
            // The attributes were not fetched, so the next block must not reuse them.
            attributes.forget();
        }
        // Shadow rays start at the exact points.
        let tracer = context.tracer_of(group.draw_index).filter(|_| light.needs_positions);
        let points = Points { fragments, attributes, barycentrics };
        let mut place = |origins: &mut Origins| match (tracer, origin) {
            (None, _) => {}
            (Some(tracer), Origin::Pixels) => place_fragments(group, tracer, points, origins),
            (Some(tracer), Origin::Hits(hits)) => {
                let hits = hits.iter();
                let hits = hits.map(|it| (it.hit.triangle, it.hit.weights, it.place));
                place_points(group, tracer, (hits, attributes.back), origins);
            }
        };
        let shadows = tracer.map(|(tracer, _)| {
            let shadows = BatchShadows::new(tracer, rays, &mut place);
            match origin {
                Origin::Pixels => shadows.of_pixels(fragments),
                Origin::Hits(_) => shadows,
            }
        });
        light.light_batch(terms.of(group.pipeline), level, batch, shadows);
    }

    /// Gouraud shading: interpolates the light or the colours of vertices at every pixel.
    fn mix_light(&mut self, group: &Group<'_, T>, shaded: &Shaded, light: VertexLight) {
        let ShadingContext { level, lit, .. } = *group.context;
        let tables = lit.tables(group.draw_index, group.pipeline);
        // Tables of colours need one interpolation, tables of light need two.
        if !light.is_colored() {
            // The attributes of the last block hold specular light.
            self.attributes.keep_none();
        }
        if self.attributes.are_new || !light.is_colored() {
            self.carry_diffuse(group, shaded, tables);
        }
        let Self { fragments, attributes, barycentrics, batch, colors, thresholds, .. } = self;
        let interpolate = |attributes: &TriangleAttributes<T>, to| {
            let points = Points { fragments, attributes, barycentrics };
            mix(level, points, &attributes.values, to);
        };
        if light == VertexLight::Bytes {
            // Interpolated and rounded in one pass.
            let thresholds = thresholds.of(group.context.mode().rounding, fragments);
            return interpolate(attributes, Mixed::Colors(colors, thresholds));
        }
        interpolate(attributes, Mixed::Rows(&mut batch.diffuse));
        batch.len = fragments.len;
        if light.is_colored() {
            // Colours include the highlights.
            batch.specular = no_light();
            return;
        }
        // Diffuse light is done; now the same attributes carry specular light.
        attributes.carry_light(
            group.draw,
            #[inline(always)]
            |place, back| tables[usize::from(back)].specular(place),
        );
        attributes.spread(level);
        interpolate(attributes, Mixed::Rows(&mut batch.specular));
    }

    /// Sets the attributes of corners to their diffuse light, or to their final colours, and
    /// prepares them for interpolation.
    pub(crate) fn carry_diffuse(
        &mut self,
        group: &Group<'_, T>,
        shaded: &Shaded,
        tables: [&Table<T>; 2],
    ) {
        let context = group.context;
        let stages = shaded.stages();
        let Self { attributes, batch, rays, .. } = self;
        let terms = context.terms.of(group.pipeline);
        let tracer =
            context.tracer_of(group.draw_index).filter(|_| context.plan.shadows.any_of(stages));
        let lighting = Lighting { level: context.level, draw: group.draw, stages, terms, tracer };
        attributes.carry_light(
            group.draw,
            #[inline(always)]
            |place, back| tables[usize::from(back)].diffuse(place, &lighting, (batch, rays)),
        );
        attributes.spread(context.level);
    }

    /// Flat shading: lights each face, and copies the light to its pixels if they differ.
    fn light_faces(&mut self, group: &Group<'_, T>, shaded: &Shaded) {
        let context = group.context;
        let ShadingContext { level, lit, terms, .. } = *context;
        let Self { fragments, attributes, batch, rays, .. } = self;
        // One position per face: the centre of its polygon.
        batch.len = attributes.count;
        lit.place_faces(level, (group.draw_index, group.draw), attributes, batch);
        let tracer = context.tracer_of(group.draw_index);
        let mut place = |origins: &mut Origins| {
            if let Some(tracer) = tracer {
                place_faces(tracer, group.draw, attributes, origins);
            }
        };
        let shadows = tracer.map(|(tracer, _)| BatchShadows::new(tracer, rays, &mut place));
        run(shaded.stages(), terms.of(group.pipeline), level, batch, shadows);
        // Pixels that need separate colours get a copy of their face's light.
        if !group.program.is_by_triangle {
            for row in batch.diffuse.iter_mut().chain(&mut batch.specular) {
                let of_faces = *row;
                for (own, slot) in row.iter_mut().zip(&fragments.slots[..fragments.len]) {
                    *own = of_faces[slot.cast_unsigned() as usize];
                }
            }
            batch.len = fragments.len;
        }
    }
}

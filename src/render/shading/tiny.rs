//! Colours lists in which nearly each pixel shows a triangle of its own.
//!
//! Triangles of about a pixel gain nothing from slots: each would be looked up, prepared, stored,
//! and gathered again for one pixel. Here, lane i of sixteen holds the triangle of pixel i, from its
//! vertices to its normals. Lists reach over several blocks, and what is read for them is asked for
//! before, since most of it is in no near cache. The bits are those of triangles with slots.
//!
//! Clipped triangles, and those whose edge functions need more than 32 bits, are not tiny: if there
//! is one, the blocks of its list are coloured one by one.

use fearless_simd::{
    Bytes as _, Level, Select as _, Simd, SimdBase as _, SimdInt as _, SimdMask as _, dispatch,
    f32x16, i32x16, mask32x16,
};
use prefetch_index::prefetch_index;

use super::barycentrics::Barycentrics;
use super::colors::{Colors, Form};
use super::context::ShadingContext;
use super::fragments::{Fragments, Runs};
use super::full_blocks::Canvas;
use super::groups::{Group, are_of, group_of};
use super::interpolate::Look;
use super::interpolated::ShadingNumber;
use super::light::{Lighting, Table};
use super::surface::{Out, Shader, Waiting};
use super::triangle_attributes::{Edges, corners};
use crate::accuracy::{Coverage, Interpolation, LightAt};
use crate::render::frame::draw::{Back, Pipeline, Shaded};
use crate::render::frame::{Eye, FramePlan};
use crate::render::lights::Batch;
use crate::render::raster::entries::word;
use crate::render::raster::vertices::fetch;
use crate::render::screen::clip::ScreenVertex;
use crate::render::screen::coverage::Grid;
use crate::render::screen::perspective::between;
use crate::render::screen::tiles::BLOCK_PIXELS;
use crate::render::shadow::rays::RayScratch;
use crate::render::simd::{BATCH, Lanes as _, Number, Sixteen, Vec3};
use crate::scene::{DrawOrder, Normals};

/// The triangles of a list of pixels, one for each pixel.
#[derive(Debug)]
#[repr(align(64))]
pub(crate) struct TinyTriangles {
    /// Their vertices in the mesh's draw order.
    ids: [[u32; 3]; BATCH],
    /// The places of their corners in the list of normals, or of light.
    places: [[u32; 3]; BATCH],
    /// Which of them are back faces, sixteen at a time.
    back: [u64; BATCH / 16],
}

impl Default for TinyTriangles {
    fn default() -> Self {
        Self { ids: [[0; 3]; BATCH], places: [[0; 3]; BATCH], back: [0; BATCH / 16] }
    }
}

impl TinyTriangles {
    /// Sets the triangles to those of a list, all of one draw whose numbers begin at `base`, and
    /// asks the cache for their vertices and for what is at their corners. `corners` gives the
    /// places of a triangle's corners, by its number in the mesh and its vertices; `prefetch` asks
    /// for what is at one.
    #[inline(always)]
    fn take(
        &mut self,
        (order, vertices): (&DrawOrder, &[ScreenVertex]),
        (numbers, base): (&[u32], u32),
        corners: impl Fn(u32, [u32; 3]) -> [u32; 3],
        prefetch: impl Fn(u32),
    ) {
        for (ids, number) in self.ids.iter_mut().zip(numbers) {
            *ids = order.vertices_of(number - base);
            ids.iter().for_each(|id| prefetch_index(vertices, *id as usize));
        }
        let own = self.places.iter_mut().zip(&self.ids).zip(numbers);
        for ((places, ids), number) in own {
            *places = corners(number - base, *ids);
            places.iter().for_each(|place| prefetch(*place));
        }
    }
}

/// What the barycentric coordinates of tiny triangles are computed from.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Weighing<'a> {
    interpolation: Interpolation,
    grid: Grid,
    /// Whether fronts and backs are mirrored.
    mirrored: bool,
    vertices: &'a [ScreenVertex],
}

/// The light at the vertices of a draw, on its front and on its back.
#[derive(Debug)]
pub(crate) struct LitVertices<'a, T> {
    tables: [&'a Table<T>; 2],
    lighting: Lighting<'a, T>,
}

/// Numbers in which tiny triangles are interpolated, if they are.
pub(crate) trait Tiny: Number {
    /// Computes the barycentric coordinates of a list, and which triangles are back faces. Returns
    /// false if one is clipped or wide: then they are meaningless.
    fn weigh(
        level: Level,
        by: Weighing<'_>,
        fragments: &Fragments,
        triangles: &mut TinyTriangles,
        to: &mut Barycentrics<Self>,
    ) -> bool;
    /// Computes position, normal and direction to the observer of every pixel, from the normals at
    /// corners, which are reversed on back faces if those are lit.
    fn sample(
        level: Level,
        look: &Look<Self>,
        of: (&Fragments, &TinyTriangles),
        normals: (&[[f32; 3]], bool),
        weights: &Barycentrics<Self>,
        to: &mut Batch<Self>,
    );
    /// Interpolates the colours at corners.
    fn mix(
        level: Level,
        light: &LitVertices<'_, Self>,
        of: (&Fragments, &TinyTriangles),
        weights: &Barycentrics<Self>,
        scratch: (&mut Batch<Self>, &mut RayScratch),
        to: (&mut Colors, &[Self; BATCH]),
    );
}

impl Tiny for f64 {
    fn weigh(
        _: Level,
        _: Weighing<'_>,
        _: &Fragments,
        _: &mut TinyTriangles,
        _: &mut Barycentrics<Self>,
    ) -> bool {
        false
    }

    fn sample(
        _: Level,
        _: &Look<Self>,
        _: (&Fragments, &TinyTriangles),
        _: (&[[f32; 3]], bool),
        _: &Barycentrics<Self>,
        _: &mut Batch<Self>,
    ) {
    }

    fn mix(
        _: Level,
        _: &LitVertices<'_, Self>,
        _: (&Fragments, &TinyTriangles),
        _: &Barycentrics<Self>,
        _: (&mut Batch<Self>, &mut RayScratch),
        _: (&mut Colors, &[Self; BATCH]),
    ) {
    }
}

impl Tiny for f32 {
    fn weigh(
        level: Level,
        by: Weighing<'_>,
        fragments: &Fragments,
        triangles: &mut TinyTriangles,
        to: &mut Barycentrics<Self>,
    ) -> bool {
        dispatch!(level, simd => weigh(simd, by, fragments, triangles, to))
    }

    fn sample(
        level: Level,
        look: &Look<Self>,
        of: (&Fragments, &TinyTriangles),
        normals: (&[[f32; 3]], bool),
        weights: &Barycentrics<Self>,
        to: &mut Batch<Self>,
    ) {
        dispatch!(level, simd => sample(simd, look, of, normals, weights, to));
    }

    fn mix(
        level: Level,
        light: &LitVertices<'_, Self>,
        of: (&Fragments, &TinyTriangles),
        weights: &Barycentrics<Self>,
        scratch: (&mut Batch<Self>, &mut RayScratch),
        to: (&mut Colors, &[Self; BATCH]),
    ) {
        dispatch!(level, simd => mix(simd, light, of, weights, scratch, to));
    }
}

#[inline(always)]
fn weigh<S: Simd>(
    simd: S,
    by: Weighing<'_>,
    fragments: &Fragments,
    triangles: &mut TinyTriangles,
    to: &mut Barycentrics<f32>,
) -> bool {
    let mut odd = 0;
    for at in (0..fragments.len).step_by(16) {
        let [[x0, y0, _, w0], [x1, y1, _, w1], [x2, y2, _, w2]] =
            corners(simd, &triangles.ids[at..], by.vertices);
        let edges = Edges::new(by.grid, [[x0, y0], [x1, y1], [x2, y2]]);
        let own = u64::MAX >> (64 - (fragments.len - at).min(16));
        odd |= (edges.cut | edges.wide).to_bitmask() & own;
        let front = edges.area.simd_lt(0).to_bitmask();
        triangles.back[at / 16] = if by.mirrored { front } else { !front };
        let x = i32x16::from_slice(simd, &fragments.x[at..at + 16]);
        let y = i32x16::from_slice(simd, &fragments.y[at..at + 16]);
        let per_area = edges.per_area();
        let [[a1, b1, c1], [a2, b2, c2]] = edges.functions;
        let second = (a1 * x + b1 * y + c1).to_float::<f32x16<S>>() * per_area;
        let third = (a2 * x + b2 * y + c2).to_float::<f32x16<S>>() * per_area;
        let by_w = Vec3([w0.bitcast(), w1.bitcast(), w2.bitcast()]);
        to.put(by.interpolation, Sixteen(simd), at, [second, third], by_w);
    }
    odd == 0
}

#[inline(always)]
fn sample<S: Simd>(
    simd: S,
    look: &Look<f32>,
    (fragments, triangles): (&Fragments, &TinyTriangles),
    (normals, turns): (&[[f32; 3]], bool),
    weights: &Barycentrics<f32>,
    to: &mut Batch<f32>,
) {
    let lanes = Sixteen(simd);
    for at in (0..fragments.len).step_by(16) {
        let places = &triangles.places[at..at + 16];
        let [mut a, mut b, mut c] = [
            normals_at(simd, normals, places, 0),
            normals_at(simd, normals, places, 1),
            normals_at(simd, normals, places, 2),
        ];
        if turns {
            let back = mask32x16::from_bitmask(simd, triangles.back[at / 16] & 0xffff);
            (a, b, c) = (turned(a, back), turned(b, back), turned(c, back));
        }
        let by = [lanes.load(&weights.weights[0], at), lanes.load(&weights.weights[1], at)];
        let normal = between([a, b.minus(a), c.minus(a)], by);
        let half = f32x16::splat(simd, 0.5);
        let place = [lanes.whole(&fragments.x, at) + half, lanes.whole(&fragments.y, at) + half];
        // Depths are for orthographic projection, in which no triangle is drawn as tiny.
        let depth = || f32x16::splat(simd, 0.0);
        let sample = look.at(lanes, normal, place, lanes.load(&weights.w, at), depth);
        to.put(lanes, sample, at);
    }
}

/// The normals at one corner of sixteen triangles.
#[inline(always)]
fn normals_at<S: Simd>(
    simd: S,
    normals: &[[f32; 3]],
    places: &[[u32; 3]],
    corner: usize,
) -> Vec3<f32x16<S>> {
    // Unused lanes may have places of other draws.
    let last = normals.len().saturating_sub(1);
    let [x, y, z, _] = fetch(
        simd,
        #[inline(always)]
        |lane| {
            let [x, y, z] = normals[(places[lane][corner] as usize).min(last)];
            [x.to_bits().cast_signed(), y.to_bits().cast_signed(), z.to_bits().cast_signed(), 0]
        },
    );
    Vec3([x.bitcast(), y.bitcast(), z.bitcast()])
}

/// Reverses the normals in some lanes.
#[inline(always)]
fn turned<S: Simd>(Vec3([x, y, z]): Vec3<f32x16<S>>, some: mask32x16<S>) -> Vec3<f32x16<S>> {
    Vec3([some.select(-x, x), some.select(-y, y), some.select(-z, z)])
}

#[inline(always)]
fn mix<S: Simd>(
    simd: S,
    light: &LitVertices<'_, f32>,
    (fragments, triangles): (&Fragments, &TinyTriangles),
    weights: &Barycentrics<f32>,
    (batch, rays): (&mut Batch<f32>, &mut RayScratch),
    (colors, thresholds): (&mut Colors, &[f32; BATCH]),
) {
    let lanes = Sixteen(simd);
    for at in (0..fragments.len).step_by(16) {
        let mut rows = [[[0.0; 4]; 16]; 3];
        let count = (fragments.len - at).min(16);
        for lane in 0..count {
            let back = triangles.back[at / 16] >> lane & 1 != 0;
            let table = light.tables[usize::from(back)];
            let places = triangles.places[at + lane];
            for (row, place) in rows.iter_mut().zip(places) {
                row[lane] = table.diffuse(place, &light.lighting, (batch, rays));
            }
        }
        let [r, g, b, _] = lanes.load_four(&rows[0], 0);
        let first = Vec3([r, g, b]);
        let [r, g, b, _] = lanes.load_four(&rows[1], 0);
        let second = Vec3([r, g, b]).minus(first);
        let [r, g, b, _] = lanes.load_four(&rows[2], 0);
        let third = Vec3([r, g, b]).minus(first);
        let by = [lanes.load(&weights.weights[0], at), lanes.load(&weights.weights[1], at)];
        let color = between([first, second, third], by);
        colors.store_by(lanes, color, lanes.load(thresholds, at), at);
    }
}

/// The distinct triangles of a block, about, from which on they are tiny.
const MANY: u32 = 32;

/// Whether triangles of a group may be drawn as tiny ones: their light is looked up for pixels, or
/// is the colour of vertices, and nothing else is computed from slots.
fn may_be_tiny<T: ShadingNumber>(context: &ShadingContext<'_, T>, group: &Group<'_>) -> bool {
    let plan = context.plan;
    let Some(shaded) = lit(plan, group) else { return false };
    let light = match plan.light_at {
        LightAt::Pixel => true,
        LightAt::Vertex => !plan.variants.are_linear(),
        LightAt::Face | LightAt::Sample => false,
    };
    !T::EXACT
        && light
        && plan.eye == Eye::Point
        && plan.variants.coverage == Coverage::Exact
        && plan.variants.interpolation != Interpolation::EverySixteen
        && plan.variants.root_variant().is_none()
        && shaded.texture.is_none()
        && shaded.opacity.is_none()
        && !shaded.vertex_colors
        && shaded.extras.is_empty()
        && group.draw.back != Back::Red
        && context.tracer_of(group.draw_index).is_none()
}

/// How the surface of a group is shaded, if it is lit.
fn lit<'a>(plan: &'a FramePlan, group: &Group<'_>) -> Option<&'a Shaded> {
    match &plan.pipelines[group.pipeline as usize] {
        Pipeline::Shaded(shaded) => shaded.light.is_some().then_some(shaded),
        Pipeline::Flat(_) => None,
    }
}

impl<T: ShadingNumber> Shader<T> {
    /// Lists a block of tiny triangles, to be coloured when [`Shader::finish_waiting`] is called.
    /// Returns whether it has listed it: it does not if they are not tiny, or of several groups.
    pub(super) fn wait_tiny(
        &mut self,
        context: &ShadingContext<'_, T>,
        runs: &Runs,
        corner: [i32; 2],
        (canvas, at): (&mut Canvas<'_>, usize),
    ) -> bool {
        if runs.new_starts().count_ones() < MANY {
            return false;
        }
        if !self.fragments.have_room_for_tiny(runs) || self.waiting.is_empty() {
            self.finish_waiting(context, canvas);
            if !may_be_tiny(context, &group_of(context, runs.first_triangle())) {
                return false;
            }
            self.fragments.begin_tiny();
        }
        let from = self.fragments.len;
        self.fragments.list_tiny(context.level, runs, corner);
        let each = self.fragments.each();
        let group = group_of(context, each[0]);
        if !are_of(context, &group, &each[from..]) {
            self.fragments.shorten(from);
            return false;
        }
        let order = group.draw.model.mesh.draw_order();
        each[from..].iter().for_each(|number| order.prefetch(number - group.base));
        self.waiting.push(Waiting { from, at });
        true
    }

    /// Colours the blocks of tiny triangles that wait.
    pub(super) fn finish_tiny(&mut self, context: &ShadingContext<'_, T>, canvas: &mut Canvas<'_>) {
        let group = group_of(context, self.fragments.each()[0]);
        self.colors.form = Form::Pixels;
        self.colors.linear = context.plan.variants.are_linear();
        let Some(shaded) = lit(context.plan, &group) else { return };
        let is_done = match context.plan.light_at {
            LightAt::Vertex => self.mix_tiny(context, &group, shaded),
            LightAt::Pixel | LightAt::Sample | LightAt::Face => {
                self.light_tiny(context, &group, shaded)
            }
        };
        if is_done {
            self.copy_waiting(canvas);
        } else {
            self.color_one_by_one(context, canvas);
        }
    }

    /// Colours the blocks that wait one after the other, with slots.
    #[cold]
    fn color_one_by_one(&mut self, context: &ShadingContext<'_, T>, canvas: &mut Canvas<'_>) {
        let all = std::mem::take(&mut self.fragments);
        let ends = self.waiting.iter().skip(1).map(|next| next.from).chain([all.len]);
        let blocks: Vec<_> = self.waiting.iter().copied().zip(ends).collect();
        for (Waiting { from, at }, end) in blocks {
            let mut visibility = [0; BLOCK_PIXELS];
            for (place, number) in all.pixels[from..end].iter().zip(&all.each()[from..end]) {
                visibility[usize::from(*place) % BLOCK_PIXELS] = word(1, *number);
            }
            let corner = [all.x[from], all.y[from]].map(|at| at & !7);
            self.fragments.list(context.level, &visibility, corner);
            self.color_fragments(context, corner, &mut Out::Tile(canvas, at));
        }
    }

    /// Computes the barycentric coordinates of the list. Returns whether all triangles are tiny.
    fn weigh_tiny(&mut self, context: &ShadingContext<'_, T>, group: &Group<'_>) -> bool {
        let ShadingContext { level, plan, frame, .. } = *context;
        let by = Weighing {
            interpolation: plan.variants.interpolation,
            grid: plan.variants.grid(),
            mirrored: group.draw.mirrored,
            vertices: frame.corners_of(group.draw_index),
        };
        T::weigh(level, by, &self.fragments, &mut self.tiny, &mut self.barycentrics)
    }

    /// Phong shading, as [`Shader::light_pixels`].
    fn light_tiny(
        &mut self,
        context: &ShadingContext<'_, T>,
        group: &Group<'_>,
        shaded: &Shaded,
    ) -> bool {
        let ShadingContext { level, plan, frame, terms, .. } = *context;
        self.batch.len = self.fragments.len;
        if self.tile.light(plan, group.pipeline, shaded).needs_positions {
            let look = self.look_of(plan, group);
            let mesh = &group.draw.model.mesh;
            let order = mesh.draw_order();
            let points = order.points(group.draw.normal_source);
            let by_vertex = group.draw.normals == Normals::Vertex;
            let normals = if by_vertex { &points.normals } else { mesh.polygon_normals() };
            let list = (self.fragments.each(), group.base);
            let from = (order, frame.corners_of(group.draw_index));
            let prefetch = |place: u32| prefetch_index(normals, place as usize);
            if by_vertex {
                let corners = |number, ids| points.of(order, number, ids);
                self.tiny.take(from, list, corners, prefetch);
            } else {
                self.tiny.take(from, list, |number, _| [mesh.polygon_of(number); 3], prefetch);
            }
            if !self.weigh_tiny(context, group) {
                return false;
            }
            let Self { fragments, tiny, barycentrics, batch, .. } = self;
            let normals = (normals, group.draw.back == Back::Lit);
            T::sample(level, &look, (fragments, tiny), normals, barycentrics, batch);
        }
        let light = self.tile.light(plan, group.pipeline, shaded);
        light.light_batch(terms.of(group.pipeline), level, &mut self.batch, None);
        self.quantize(context, Some(shaded.tint), (true, false));
        true
    }

    /// Gouraud shading, as [`Shader::mix_light`].
    fn mix_tiny(
        &mut self,
        context: &ShadingContext<'_, T>,
        group: &Group<'_>,
        shaded: &Shaded,
    ) -> bool {
        let ShadingContext { level, plan, frame, lit, terms, .. } = *context;
        let mesh = &group.draw.model.mesh;
        let order = mesh.draw_order();
        let points = order.points(group.draw.normal_source);
        let tables = lit.tables(group.draw_index, group.pipeline);
        let list = (self.fragments.each(), group.base);
        let from = (order, frame.corners_of(group.draw_index));
        let prefetch = |place: u32| tables[0].prefetch(place);
        match group.draw.normals {
            Normals::Face => {
                let triangles = mesh.triangles();
                let corners = |number: u32, _: [u32; 3]| triangles[number as usize].corners;
                self.tiny.take(from, list, corners, prefetch);
            }
            Normals::Vertex => {
                let corners = |number, ids| points.of(order, number, ids);
                self.tiny.take(from, list, corners, prefetch);
            }
        }
        if !self.weigh_tiny(context, group) {
            return false;
        }
        let stages = shaded.light.as_deref().unwrap_or_default();
        let terms = terms.of(group.pipeline);
        let lighting = Lighting { level, draw: group.draw, stages, terms, tracer: None };
        let light = LitVertices { tables, lighting };
        let Self { fragments, tiny, barycentrics, batch, rays, colors, thresholds, .. } = self;
        let thresholds = thresholds.of(plan.variants.rounding, fragments);
        let of = (&*fragments, &*tiny);
        T::mix(level, &light, of, barycentrics, (batch, rays), (colors, thresholds));
        true
    }
}

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
use fearless_simd::{
    Bytes as _, Select as _, Simd, SimdBase as _, SimdInt as _, SimdMask as _, f32x16, i32x16,
    mask32x16,
};
use prefetch_index::prefetch_index;

use super::barycentrics::Barycentrics;
use super::colors::{Colors, Form};
use super::context::{Group, ShadingContext, are_of};
use super::fragments::Fragments;
use super::full_blocks::Canvas;
use super::interpolate::Look;
use super::light::Lighting;
use super::runs::Runs;
use super::surface::{Out, Shader, Waiting};
use super::triangle_attributes::{Edges, corners};
use crate::accel::DrawOrder;
use crate::frame::FramePlan;
use crate::frame::color_path::ListPath;
use crate::frame::draw::{Back, Draw, Shaded, Stage};
use crate::lights::Batch;
use crate::raster::entries::word;
use crate::raster::vertices::fetch;
use crate::screen::clip::ScreenVertex;
use crate::screen::perspective::between;
use crate::screen::tiles::BLOCK_PIXELS;
use crate::simd::{BATCH, Lanes as _, Sixteen, Vec3, dispatch};
use marraztu_core::accuracy::LightAt;
use marraztu_core::scene::Normals;

/// The approximate number of distinct triangles in a block from which they are drawn as tiny ones.
pub(super) const MANY: u32 = 32;

impl Shader<f32> {
    /// Lists a block of tiny triangles, to be coloured by [`Shader::finish_waiting`]. Returns
    /// whether it did; blocks of larger triangles or of several groups are not listed.
    pub(super) fn wait_tiny(
        &mut self,
        group: &Group<'_, f32>,
        runs: &Runs,
        corner: [i32; 2],
        (canvas, at): (&mut Canvas<'_>, usize),
    ) -> bool {
        // If the list is full or holds larger triangles, the waiting blocks are coloured first.
        if !self.fragments.have_room_for_tiny(runs) || self.waiting.is_empty() {
            self.finish_waiting(group.context, canvas);
            if group.path.list != ListPath::Tiny {
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
        self.colors.linear = group.context.plan.variants.are_linear();
        let Some((shaded, stages)) = group.lit() else { return };
        let is_done = match group.context.plan.light_at {
            LightAt::Vertex => self.mix_tiny(group, stages),
            LightAt::Pixel | LightAt::Sample | LightAt::Face => self.light_tiny(group, shaded),
        };
        if is_done {
            self.path_pixels.tiny += self.fragments.len as u64;
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
        let of = (plan, group.draw, frame.corners_of(group.draw_index));
        let Self { fragments, tiny, barycentrics, .. } = self;
        dispatch!(level, simd => weigh(simd, of, fragments, tiny, barycentrics))
    }

    /// Phong shading, like [`Shader::light_pixels`].
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
        let ShadingContext { level, plan, frame, lit, terms, .. } = *group.context;
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
        let thresholds = thresholds.of(plan.variants.rounding, fragments);
        let of = (&**corner_colors, fragments.len);
        dispatch!(level, simd => mix(simd, of, barycentrics, (colors, thresholds)));
        true
    }
}

/// The triangles of a list of pixels, one for each pixel.
#[derive(Debug)]
#[repr(align(64))]
pub(crate) struct TinyTriangles {
    /// The vertices in the mesh's draw order.
    ids: [[u32; 3]; BATCH],
    /// The indices of the corners in the list of normals, or of light.
    pub(super) places: [[u32; 3]; BATCH],
    /// The masks of back faces, sixteen triangles at a time.
    pub(super) back: [u64; BATCH / 16],
}

impl Default for TinyTriangles {
    fn default() -> Self {
        Self { ids: [[0; 3]; BATCH], places: [[0; 3]; BATCH], back: [0; BATCH / 16] }
    }
}

impl TinyTriangles {
    /// Sets the triangles of a list, all of one draw with numbers from `base`, and prefetches their
    /// vertices and corner data. `corners` returns the indices of a triangle's corners, given its
    /// number in the mesh and its vertices; `prefetch` prefetches the data at an index.
    #[inline(always)]
    fn take(
        &mut self,
        (order, vertices): (&DrawOrder, &[ScreenVertex]),
        (numbers, base): (&[u32], u32),
        corners: impl Fn(u32, [u32; 3]) -> [u32; 3],
        prefetch: impl Fn(u32),
    ) {
        // All vertices are requested before any corner is looked up, so the fetches overlap.
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

/// The colours of the corners of some triangles, corner by corner: red, green, blue, and an unused
/// number.
pub(crate) type CornerRows<T> = [[[T; 4]; BATCH]; 3];

/// Computes the barycentric coordinates of a list with these screen vertices, and the masks of back
/// faces. Returns false if a triangle is clipped or wide: the results are then meaningless.
#[inline(always)]
fn weigh<S: Simd>(
    simd: S,
    (plan, draw, vertices): (&FramePlan, &Draw, &[ScreenVertex]),
    fragments: &Fragments,
    triangles: &mut TinyTriangles,
    to: &mut Barycentrics<f32>,
) -> bool {
    let (grid, interpolation) = (plan.raster_mode().grid, plan.variants.interpolation);
    let mut odd = 0;
    for at in (0..fragments.len).step_by(16) {
        let [[x0, y0, _, w0], [x1, y1, _, w1], [x2, y2, _, w2]] =
            corners(simd, &triangles.ids[at..], vertices);
        let edges = Edges::new(grid, [[x0, y0], [x1, y1], [x2, y2]]);
        // Unused lanes hold old triangles, which must not reject the list.
        let own = u64::MAX >> (64 - (fragments.len - at).min(16));
        odd |= (edges.cut | edges.wide).to_bitmask() & own;
        let front = edges.area.simd_lt(0).to_bitmask();
        triangles.back[at / 16] = if draw.mirrored { front } else { !front };
        // Each lane evaluates one triangle at one pixel.
        let x = i32x16::from_slice(simd, &fragments.x[at..at + 16]);
        let y = i32x16::from_slice(simd, &fragments.y[at..at + 16]);
        let per_area = edges.per_area();
        let [[a1, b1, c1], [a2, b2, c2]] = edges.functions;
        let second = (a1 * x + b1 * y + c1).to_float::<f32x16<S>>() * per_area;
        let third = (a2 * x + b2 * y + c2).to_float::<f32x16<S>>() * per_area;
        let by_w = Vec3([w0.bitcast(), w1.bitcast(), w2.bitcast()]);
        to.put(interpolation, Sixteen(simd), at, [second, third], by_w);
    }
    odd == 0
}

/// Computes position, normal and direction to the observer of every pixel, from the normals at
/// corners, which are reversed on lit back faces.
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
        // Back faces are lit with reversed normals.
        if turns {
            let back = mask32x16::from_bitmask(simd, triangles.back[at / 16] & 0xffff);
            (a, b, c) = (turned(a, back), turned(b, back), turned(c, back));
        }
        let normal = between([a, b.minus(a), c.minus(a)], weights.weights_at(lanes, at));
        let half = f32x16::splat(simd, 0.5);
        let place = [lanes.whole(&fragments.x, at) + half, lanes.whole(&fragments.y, at) + half];
        // Depths only matter in orthographic projection, which has no tiny triangles.
        let depth = || f32x16::splat(simd, 0.0);
        let sample = look.at(lanes, normal, place, lanes.load(&weights.w, at), depth);
        to.put(lanes, sample, at);
    }
}

/// Fetches the normals at one corner of sixteen triangles.
#[inline(always)]
fn normals_at<S: Simd>(
    simd: S,
    normals: &[[f32; 3]],
    places: &[[u32; 3]],
    corner: usize,
) -> Vec3<f32x16<S>> {
    // Unused lanes may have indices of other draws.
    let last = normals.len().saturating_sub(1);
    let [x, y, z, _] = fetch(
        simd,
        #[inline(always)]
        |lane| {
            let [x, y, z] = normals[(places[lane][corner] as usize).min(last)];
            let [x, y, z] = [x, y, z].map(|x| x.to_bits().cast_signed());
            // The fourth number is not read.
            [x, y, z, z]
        },
    );
    Vec3([x.bitcast(), y.bitcast(), z.bitcast()])
}

/// Reverses the normals in some lanes.
#[inline(always)]
fn turned<S: Simd>(Vec3([x, y, z]): Vec3<f32x16<S>>, some: mask32x16<S>) -> Vec3<f32x16<S>> {
    Vec3([some.select(-x, x), some.select(-y, y), some.select(-z, z)])
}

/// Interpolates the colours at the corners of a number of pixels.
#[inline(always)]
fn mix<S: Simd>(
    simd: S,
    (rows, len): (&CornerRows<f32>, usize),
    weights: &Barycentrics<f32>,
    (colors, thresholds): (&mut Colors, &[f32; BATCH]),
) {
    let lanes = Sixteen(simd);
    for at in (0..len).step_by(16) {
        let [r, g, b, _] = lanes.load_four(&rows[0], at);
        let first = Vec3([r, g, b]);
        let [r, g, b, _] = lanes.load_four(&rows[1], at);
        let second = Vec3([r, g, b]).minus(first);
        let [r, g, b, _] = lanes.load_four(&rows[2], at);
        let third = Vec3([r, g, b]).minus(first);
        // The same operations as with slots, so the bits are equal.
        let color = between([first, second, third], weights.weights_at(lanes, at));
        colors.store_by(lanes, color, lanes.load(thresholds, at), at);
    }
}

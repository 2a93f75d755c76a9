//! Lighting: per face (flat), per vertex (Gouraud), and of batches of pixels (Phong).
//!
//! Vertices are lit when the first pixel needs one of them, in batches of neighbours. Back faces,
//! hidden parts and vertices outside of the picture are therefore never lit. The light is the same,
//! whichever thread needs it first.

use crate::accel::Accelerated as _;
use std::collections::BTreeSet;
use std::sync::OnceLock;

use fearless_simd::Level;
use glam::{DMat3, DVec3};

use super::interpolated::ShadingNumber;
use super::shadows::{BatchShadows, place_vertices};
use super::triangle_attributes::TriangleAttributes;
use crate::frame::draw::{Back, Draw, Pipeline, Stage};
use crate::frame::program::{LightOp, Programs};
use crate::frame::{Eye, FramePlan};
use crate::lights::{Batch, LightTerm, columns, load, set, set_lights, store, turned};
use crate::plan::tile::TileLight;
use crate::shadow::rays::{Origins, RayScratch};
use crate::shadow::tracer::Tracer;
use crate::simd::{Kernel, Lanes, Number, Real, Vec3};
use marraztu_core::accuracy::LightAt;
use marraztu_core::base::math::each;
use marraztu_core::scene::{Facet, Normals, dvec3};

/// The light at the vertices of a frame, and the transforms for lighting faces.
#[derive(Debug, Default)]
pub(crate) struct Lit<T> {
    tables: Vec<Table<T>>,
    /// The number of tables used by this frame.
    used: usize,
    /// The transform of each draw to view space.
    to_view: Vec<ToView<T>>,
}

/// The number of vertices lit together: few enough that most of them are needed.
const CHUNK: usize = 64;

/// The light of some vertices.
type Lights<T> = [[T; 4]; CHUNK];

/// The light on one side of one draw by one pipeline, at its points or, with face normals, at its
/// corners.
#[derive(Debug, Default)]
pub(crate) struct Table<T> {
    draw: u32,
    pipeline: u32,
    /// The transform to view space, with the normals of this side.
    to_view: Option<ToView<T>>,
    /// The tint t, if the table holds final colours t D + S instead of light.
    tint: Option<[T; 3]>,
    /// Diffuse light D; or final colours, if `specular` is empty.
    diffuse: Vec<OnceLock<Lights<T>>>,
    /// Specular light S, set together with diffuse light.
    specular: Vec<OnceLock<Lights<T>>>,
}

impl<T: ShadingNumber> Lit<T> {
    /// Prepares tables for everything that the plan lights at vertices.
    pub(crate) fn prepare(&mut self, plan: &FramePlan, programs: &Programs) {
        self.to_view.clear();
        self.to_view.extend(plan.draws.iter().map(|draw| ToView::new(plan, draw)));
        self.used = 0;
        // Faces and pixels are lit when they are drawn, and need no tables.
        if plan.light_at != LightAt::Vertex {
            return;
        }
        for (i, draw) in (0_u32..).zip(&plan.draws) {
            // A sorted set without duplicates, because `tables` searches by draw and pipeline.
            let own: BTreeSet<u32> = draw.part_pipelines.iter().flatten().copied().collect();
            for pipeline in own {
                let Pipeline::Shaded(shaded) = &plan.pipelines[pipeline as usize] else { continue };
                let LightOp::Vertices(light) = programs.of(i, pipeline).light else { continue };
                // A second table holds the light on the back, if backs are lit.
                for back in [false, true] {
                    if back && draw.back != Back::Lit {
                        continue;
                    }
                    // Tables of the last frame are reused with their memory.
                    if self.used == self.tables.len() {
                        self.tables.push(Table::default());
                    }
                    let table = &mut self.tables[self.used];
                    (table.draw, table.pipeline) = (i, pipeline);
                    self.used += 1;
                    table.to_view = Some(self.to_view[i as usize].seen_from(back));
                    table.clear(draw, light.is_colored().then_some(shaded.tint));
                }
            }
        }
    }

    /// Returns the light of a draw by a pipeline, on the front and on the back. Both are the same
    /// if only one side is lit.
    pub(crate) fn tables(&self, draw: u32, pipeline: u32) -> [&Table<T>; 2] {
        // The tables are sorted by draw and pipeline, because they were prepared in this order.
        let of = |table: &Table<T>| (table.draw, table.pipeline);
        let tables = &self.tables[..self.used];
        let first = tables.partition_point(|table| of(table) < (draw, pipeline));
        let mut own = tables[first..].iter().take_while(|table| of(table) == (draw, pipeline));
        let front = own.next().expect("what is lit at vertices was made ready");
        [front, own.next().unwrap_or(front)]
    }

    /// Fills a batch with the centres and normals of some faces of a draw, in view space.
    pub(crate) fn place_faces(
        &self,
        level: Level,
        (index, draw): (u32, &Draw),
        attributes: &TriangleAttributes<T>,
        batch: &mut Batch<T>,
    ) {
        let mesh = &draw.model.mesh;
        let facets = mesh.facets();
        for (slot, number) in attributes.numbers[..attributes.count].iter().enumerate() {
            let Facet { centre, normal } = facets[mesh.polygon_of(*number) as usize];
            let turn =
                if attributes.back >> slot & 1 == 1 && draw.back == Back::Lit { -1.0 } else { 1.0 };
            put(batch, slot, centre, normal.map(|x| x * turn));
        }
        let to_view = self.to_view[index as usize];
        T::run(level, Place { batch, to_view });
    }
}

/// Writes a position and a normal of object space into a batch.
#[inline(always)]
fn put<T: Number>(batch: &mut Batch<T>, i: usize, position: [f32; 3], normal: [f32; 3]) {
    for axis in 0..3 {
        batch.position[axis][i] = T::from_f64(f64::from(position[axis]));
        batch.normal[axis][i] = T::from_f64(f64::from(normal[axis]));
    }
}

/// The inputs for lighting the vertices of a draw.
#[derive(Debug)]
pub(crate) struct Lighting<'a, T> {
    pub(crate) level: Level,
    pub(crate) draw: &'a Draw,
    pub(crate) stages: &'a [Stage],
    pub(crate) terms: &'a [LightTerm<T>],
    /// The tracer, and the draw's own caster, if the draw receives shadows.
    pub(crate) tracer: Option<(&'a Tracer<'a>, u32)>,
}

impl<T: ShadingNumber> Table<T> {
    /// Clears the table for a draw, to hold light, or colours of a surface with this tint.
    fn clear(&mut self, draw: &Draw, tint: Option<[f64; 3]>) {
        let count = place_count(draw).div_ceil(CHUNK);
        self.tint = tint.map(|tint| tint.map(T::from_f64));
        self.diffuse.clear();
        self.diffuse.resize_with(count, OnceLock::new);
        self.specular.clear();
        self.specular.resize_with(if tint.is_some() { 0 } else { count }, OnceLock::new);
    }

    /// Returns the diffuse light or final colour of a vertex, and lights it in `batch` if
    /// necessary.
    #[inline(always)]
    pub(crate) fn diffuse(
        &self,
        place: u32,
        lighting: &Lighting<'_, T>,
        (batch, scratch): (&mut Batch<T>, &mut RayScratch),
    ) -> [T; 4] {
        let (chunk, at) = (place as usize / CHUNK, place as usize % CHUNK);
        match self.diffuse[chunk].get() {
            Some(lights) => lights[at],
            None => self.light(chunk, lighting, (batch, scratch))[at],
        }
    }

    /// Returns the specular light of a vertex. Its diffuse light must have been read before.
    #[inline(always)]
    pub(crate) fn specular(&self, place: u32) -> [T; 4] {
        let lights = self.specular[place as usize / CHUNK].get();
        lights.expect("it comes with diffuse light")[place as usize % CHUNK]
    }

    /// Lights a batch of vertices, unless another thread does.
    #[cold]
    #[inline(never)]
    #[expect(
        clippy::disallowed_methods,
        reason = "what lights a batch has other threads do nothing"
    )]
    fn light(
        &self,
        chunk: usize,
        lighting: &Lighting<'_, T>,
        (batch, scratch): (&mut Batch<T>, &mut RayScratch),
    ) -> &Lights<T> {
        let Lighting { level, draw, stages, terms, tracer } = *lighting;
        let to_view = self.to_view.expect("it was made ready");
        self.diffuse[chunk].get_or_init(|| {
            put_places(draw, chunk * CHUNK, batch);
            // Shadow rays need positions in object space, which the transform overwrites.
            let (positions, count) = (tracer.map(|_| batch.position), batch.len);
            T::run(level, Place { batch, to_view });
            let mut place = |origins: &mut Origins| {
                if let (Some(tracer), Some(positions)) = (tracer, &positions) {
                    place_vertices(tracer, positions, count, origins);
                }
            };
            // Shadow rays start at the vertices in world space.
            let shadows = tracer.map(|(tracer, _)| BatchShadows::new(tracer, scratch, &mut place));
            run(stages, terms, level, batch, shadows);
            let mut diffuse = [[T::default(); 4]; CHUNK];
            let mut specular = [[T::default(); 4]; CHUNK];
            let (tint, batch) = (self.tint, &*batch);
            T::run(level, Keep { batch, tint, to: [&mut diffuse, &mut specular] });
            if let Some(place) = self.specular.get(chunk) {
                // Only the thread that initialises diffuse light gets here.
                place.get_or_init(|| specular);
            }
            diffuse
        })
    }
}

/// Returns the number of lit vertices of a draw: its points or, with face normals, its corners.
fn place_count(draw: &Draw) -> usize {
    let mesh = &draw.model.mesh;
    match draw.normals {
        Normals::Vertex => mesh.draw_order().points(draw.normal_source).normals.len(),
        Normals::Face => mesh.corners().len(),
    }
}

/// Fills a batch with vertices of a draw, starting at `first`.
fn put_places<T: Number>(draw: &Draw, first: usize, batch: &mut Batch<T>) {
    let mesh = &draw.model.mesh;
    batch.len = (place_count(draw) - first).min(CHUNK);
    match draw.normals {
        Normals::Vertex => {
            let order = mesh.draw_order();
            let points = order.points(draw.normal_source);
            let own = first..first + batch.len;
            let normals = &points.normals[own.clone()];
            let number = |x: f32| T::from_f64(f64::from(x));
            for (to, from) in batch.position.iter_mut().zip([&order.x, &order.y, &order.z]) {
                // Without a table, points are vertices in draw order: a contiguous copy.
                if points.vertices.is_empty() {
                    to.iter_mut().zip(&from[own.clone()]).for_each(|(to, x)| *to = number(*x));
                } else {
                    let vertices = &points.vertices[own.clone()];
                    let places = to.iter_mut().zip(vertices);
                    places.for_each(|(to, vertex)| *to = number(from[*vertex as usize]));
                }
            }
            let [x, y, z] = &mut batch.normal;
            for (((x, y), z), normal) in x.iter_mut().zip(y).zip(z).zip(normals) {
                [*x, *y, *z] = each(*normal, |n| T::from_f64(f64::from(n)));
            }
        }
        Normals::Face => {
            // Corners are numbered polygon by polygon, so the polygon only moves forward.
            let mut polygon = polygon_of_corner(draw, first);
            for i in 0..batch.len {
                while !mesh.corners_of(polygon).contains(&(first + i)) {
                    polygon += 1;
                }
                let position = mesh.corners()[first + i].position as usize;
                put(batch, i, mesh.positions()[position], mesh.polygon_normals()[polygon as usize]);
            }
        }
    }
}

/// Returns the polygon of a corner, by binary search.
fn polygon_of_corner(draw: &Draw, corner: usize) -> u32 {
    let mesh = &draw.model.mesh;
    let (mut low, mut high) =
        (0, u32::try_from(mesh.polygon_count()).expect("polygons have 32-bit numbers"));
    while high - low > 1 {
        let middle = low.midpoint(high);
        if mesh.corners_of(middle).start <= corner { low = middle } else { high = middle }
    }
    low
}

/// Stores the light of a batch: D and S, or with a `tint` t the final colour t D + S in place of D.
struct Keep<'a, T> {
    batch: &'a Batch<T>,
    tint: Option<[T; 3]>,
    to: [&'a mut Lights<T>; 2],
}

impl<T: Number> Kernel<T> for Keep<'_, T> {
    #[inline(always)]
    fn run<M: Lanes<Number = T>>(self, lanes: M) {
        let Self { batch, tint, to: [diffuse, specular] } = self;
        let zero = lanes.lift(0.0);
        for at in (0..batch.len).step_by(M::LANES) {
            let Vec3([r, g, b]) = load(lanes, &batch.diffuse, at);
            let s = load(lanes, &batch.specular, at);
            if let Some(tint) = tint {
                let Vec3([tr, tg, tb]) = set(lanes, tint);
                let Vec3([r, g, b]) = Vec3([tr * r, tg * g, tb * b]).plus(s);
                lanes.store_four([r, g, b, zero], diffuse, at);
            } else {
                let Vec3([sr, sg, sb]) = s;
                lanes.store_four([r, g, b, zero], diffuse, at);
                lanes.store_four([sr, sg, sb, zero], specular, at);
            }
        }
    }
}

/// The largest distance at which a vertex is lit, in units of view space.
const FARTHEST: f64 = 1e15;

/// The transform from object space to view space. Positions are first moved near the origin, which
/// keeps their digits in f32.
#[derive(Clone, Copy, Debug)]
struct ToView<T> {
    middle: [T; 3],
    middle_in_view: [T; 3],
    linear: [[T; 3]; 3],
    normals: [[T; 3]; 3],
    eye: Eye,
}

impl<T: Number> ToView<T> {
    fn new(plan: &FramePlan, draw: &Draw) -> Self {
        let middle = near_observer(draw);
        let numbers = |v: DVec3| v.to_array().map(T::from_f64);
        Self {
            middle: numbers(middle),
            middle_in_view: numbers(draw.view_from_object.transform_point3(middle)),
            linear: columns(DMat3::from_mat4(draw.view_from_object)),
            normals: columns(draw.view_from_normal),
            eye: plan.eye,
        }
    }

    /// Returns the transform for one side of the surface.
    fn seen_from(self, back: bool) -> Self {
        let normals =
            if back { self.normals.map(|column| column.map(|x| -x)) } else { self.normals };
        Self { normals, ..self }
    }
}

/// Returns the point of a mesh's bounds nearest to the observer, in object space. Visible parts are
/// near it, for any origin and any size of the mesh.
///
/// Its coordinates are f32 numbers, so subtracting it is exact for positions near it.
fn near_observer(draw: &Draw) -> DVec3 {
    let Some(bounds) = draw.model.mesh.bounds() else { return DVec3::ZERO };
    let observer = draw.view_from_object.inverse().w_axis.truncate();
    // A transform without an inverse has no observer, and the centre must do.
    let near = if observer.is_finite() { bounds.nearest_to(observer) } else { bounds.centre() };
    dvec3(near.as_vec3().to_array())
}

/// Transforms a batch from object space to view space.
struct Place<'a, T> {
    batch: &'a mut Batch<T>,
    to_view: ToView<T>,
}

impl<T: Number> Kernel<T> for Place<'_, T> {
    #[inline(always)]
    fn run<M: Lanes<Number = T>>(self, lanes: M) {
        let Self { batch, to_view } = self;
        let (middle, origin) = (set(lanes, to_view.middle), set(lanes, to_view.middle_in_view));
        for at in (0..batch.len).step_by(M::LANES) {
            // Exact for positions near the middle, so f32 keeps the digits of large coordinates.
            let near = load(lanes, &batch.position, at).minus(middle);
            // Positions far beyond the view are clamped, to keep the square of their distance to a
            // light finite.
            let (low, high) = (lanes.lift(-FARTHEST), lanes.lift(FARTHEST));
            let clamped = |x: M::R| Real::min(Real::max(x, low), high);
            let [x, y, z] = turned(lanes, to_view.linear, near).plus(origin).0;
            let position = Vec3([clamped(x), clamped(y), clamped(z)]);
            let normal = turned(lanes, to_view.normals, load(lanes, &batch.normal, at)).unit();
            let zero = lanes.lift(0.0);
            let to_eye = match to_view.eye {
                Eye::Point => Vec3([zero, zero, zero]).minus(position).unit(),
                Eye::Parallel => Vec3([zero, zero, lanes.lift(1.0)]),
            };
            store(lanes, position, &mut batch.position, at);
            store(lanes, normal, &mut batch.normal, at);
            store(lanes, to_eye, &mut batch.to_eye, at);
        }
    }
}

/// Sets the light at every position of a batch to the sum of the stages visible from it.
pub(crate) fn run<T: ShadingNumber>(
    stages: &[Stage],
    terms: &[LightTerm<T>],
    level: Level,
    batch: &mut Batch<T>,
    shadows: Option<BatchShadows<'_>>,
) {
    TileLight { stages, kept: None, needs_positions: true }
        .light_batch(terms, level, batch, shadows);
}

impl TileLight<'_> {
    /// Sets the light at every position of a batch to the light that reaches the tile and the
    /// position.
    pub(crate) fn light_batch<T: ShadingNumber>(
        &self,
        terms: &[LightTerm<T>],
        level: Level,
        batch: &mut Batch<T>,
        shadows: Option<BatchShadows<'_>>,
    ) {
        let Some(mut shadows) = shadows else {
            return set_lights(level, batch, terms, self.kept);
        };
        // With shadows, lights are added one by one: each is blocked at other positions.
        batch.darken();
        let mut add = |at: usize| {
            shadows.add_light(&self.stages[at], &terms[at], level, batch);
        };
        match self.kept {
            None => (0..terms.len()).for_each(add),
            // Some lights do not reach this tile.
            Some(kept) => kept.iter().for_each(|at| add(*at as usize)),
        }
    }
}

//! Light that is evaluated at faces or at vertices, before any pixel.

use fearless_simd::Level;
use glam::{DMat3, DVec3};
use rayon::prelude::*;

use super::effects::{BATCH, Batch, Light, Rows, load, set, store};
use super::faces::Faces;
use super::plan::{Back, Draw, Eye, FramePlan, Pipeline, Shaded};
use super::real::{Kernel, Machine, Number, Real, Triple};
use super::shines::Shines;
use super::surface::run;
use crate::scene::{LightAt, Normalising, Normals, dvec3};

/// Places that a thread takes at a time.
const CHUNK: usize = 16 * BATCH;

/// Light at the vertices of a frame, and what it takes to light faces.
#[derive(Debug, Default)]
pub(super) struct Lit<T> {
    tables: Vec<Table<T>>,
    /// How many of the tables are of this frame.
    used: usize,
    /// For each draw the way to view space.
    to_view: Vec<ToView<T>>,
}

/// The light of one draw by one pipeline on one side, at its points or (with the normals of faces)
/// at its corners.
#[derive(Debug, Default)]
pub(super) struct Table<T> {
    draw: u32,
    pipeline: u32,
    back: bool,
    /// Diffuse light; where `specular` is empty, the colour that both give.
    pub(super) diffuse: Vec<[T; 4]>,
    pub(super) specular: Vec<[T; 4]>,
}

impl<T> Table<T> {
    /// Whether it has colours, ready to be mixed: t D + S with one t for all of the surface.
    pub(super) const fn is_colored(&self) -> bool {
        self.specular.is_empty()
    }
}

impl<T: Light> Lit<T> {
    /// Lights what the plan says is lit at vertices.
    pub(super) fn prepare(&mut self, plan: &FramePlan, shines: &Shines<T>, level: Level) {
        self.to_view.clear();
        self.to_view.extend(plan.draws.iter().map(|draw| ToView::new(plan, draw)));
        self.used = 0;
        if plan.light_at != LightAt::Vertex {
            return;
        }
        for (i, draw) in (0_u32..).zip(&plan.draws) {
            for pipeline in 0..u32::try_from(plan.pipelines.len()).unwrap_or(u32::MAX) {
                let Pipeline::Shaded(shaded) = &plan.pipelines[pipeline as usize] else { continue };
                if shaded.light.is_none() || !draw.part_pipelines.contains(&Some(pipeline)) {
                    continue;
                }
                for back in [false, true] {
                    if back && draw.back != Back::Lit {
                        continue;
                    }
                    if self.used == self.tables.len() {
                        self.tables.push(Table::default());
                    }
                    let table = &mut self.tables[self.used];
                    (table.draw, table.pipeline, table.back) = (i, pipeline, back);
                    self.used += 1;
                    let to_view = self.to_view[i as usize].seen_from(back);
                    table.fill(level, draw, shaded, (shines, to_view));
                }
            }
        }
    }

    /// The light of a draw by a pipeline, on the front and on the back; the same where only one side
    /// is lit.
    pub(super) fn tables(&self, draw: u32, pipeline: u32) -> [&Table<T>; 2] {
        let mut tables = self.tables[..self.used]
            .iter()
            .filter(|table| (table.draw, table.pipeline) == (draw, pipeline));
        let front = tables.next().expect("what is lit at vertices was lit before");
        [front, tables.next().unwrap_or(front)]
    }

    /// Puts the centres and the normals of some faces of a draw into a batch, in view space.
    pub(super) fn place_faces(
        &self,
        level: Level,
        (index, draw): (u32, &Draw),
        faces: &Faces<T>,
        batch: &mut Batch<T>,
    ) {
        let mesh = &draw.model.mesh;
        let (centres, normals) = (mesh.polygon_centres(), mesh.polygon_normals());
        for (slot, number) in faces.numbers[..faces.count].iter().enumerate() {
            let polygon = mesh.triangles()[*number as usize].polygon as usize;
            let turn =
                if faces.back >> slot & 1 == 1 && draw.back == Back::Lit { -1.0 } else { 1.0 };
            put(batch, slot, centres[polygon], normals[polygon].map(|x| x * turn));
        }
        let to_view = self.to_view[index as usize];
        T::run_by(level, to_view.way, Place { batch, to_view });
    }
}

/// Writes a place and a normal of object space into a batch.
#[inline(always)]
fn put<T: Number>(batch: &mut Batch<T>, i: usize, position: [f32; 3], normal: [f32; 3]) {
    for axis in 0..3 {
        batch.position[axis][i] = T::from_f64(f64::from(position[axis]));
        batch.normal[axis][i] = T::from_f64(f64::from(normal[axis]));
    }
}

impl<T: Light> Table<T> {
    /// Lights the places of a draw.
    fn fill(
        &mut self,
        level: Level,
        draw: &Draw,
        shaded: &Shaded,
        (shines, to_view): (&Shines<T>, ToView<T>),
    ) {
        let mesh = &draw.model.mesh;
        let order = mesh.draw_order();
        let points = order.points(draw.normal_source);
        let (count, polygons) = match draw.normals {
            Normals::Vertex => (points.normals.len(), Vec::new()),
            Normals::Face => (mesh.corners().len(), polygons_of_corners(draw)),
        };
        let place = |i: usize| match draw.normals {
            Normals::Vertex => {
                let vertex = points.vertices[i] as usize;
                ([order.x[vertex], order.y[vertex], order.z[vertex]], points.normals[i])
            }
            Normals::Face => {
                let position = mesh.corners()[i].position as usize;
                (mesh.positions()[position], mesh.polygon_normals()[polygons[i] as usize])
            }
        };
        let stages = shaded.light.as_deref().unwrap_or_default();
        let shines = shines.of(self.pipeline);
        let tint = shaded.tint.map(T::from_f64);
        let colored = shaded.texture.is_none() && !shaded.vertex_colors;
        self.diffuse.resize(count, [T::default(); 4]);
        self.specular.resize(if colored { 0 } else { count }, [T::default(); 4]);
        let light = |first: usize, diffuse: &mut [[T; 4]], specular: &mut [[T; 4]]| {
            let mut batch = Batch::<T>::default();
            for (i, diffuse) in diffuse.chunks_mut(BATCH).enumerate() {
                batch.len = diffuse.len();
                for lane in 0..batch.len {
                    let (position, normal) = place(first + i * BATCH + lane);
                    put(&mut batch, lane, position, normal);
                }
                T::run_by(level, to_view.way, Place { batch: &mut batch, to_view });
                batch.darken();
                run(stages, shines, level, &mut batch);
                if colored {
                    T::run(level, Color { batch: &mut batch, tint });
                } else {
                    let specular = &mut specular[i * BATCH..][..batch.len];
                    take_rows(&batch.specular, specular);
                }
                take_rows(&batch.diffuse, diffuse);
            }
        };
        let chunks = self.diffuse.par_chunks_mut(CHUNK);
        if colored {
            chunks.enumerate().for_each(|(i, diffuse)| light(i * CHUNK, diffuse, &mut []));
        } else {
            let both = chunks.zip(self.specular.par_chunks_mut(CHUNK)).enumerate();
            both.for_each(|(i, (diffuse, specular))| light(i * CHUNK, diffuse, specular));
        }
    }
}

/// Copies what stands in rows to where it is fetched from.
#[inline(always)]
fn take_rows<T: Number>([r, g, b]: &Rows<T>, to: &mut [[T; 4]]) {
    for (((to, r), g), b) in to.iter_mut().zip(r).zip(g).zip(b) {
        *to = [*r, *g, *b, T::default()];
    }
}

/// t D + S, in the place of D.
struct Color<'a, T> {
    batch: &'a mut Batch<T>,
    tint: [T; 3],
}

impl<T: Number> Kernel<T> for Color<'_, T> {
    #[inline(always)]
    fn run<M: Machine<Number = T>>(self, machine: M) {
        let Self { batch, tint } = self;
        let Triple([tr, tg, tb]) = set(machine, tint);
        for at in (0..batch.len).step_by(M::LANES) {
            let Triple([r, g, b]) = load(machine, &batch.diffuse, at);
            let color = Triple([tr * r, tg * g, tb * b]).plus(load(machine, &batch.specular, at));
            store(machine, color, &mut batch.diffuse, at);
        }
    }
}

/// The polygon of each corner.
fn polygons_of_corners(draw: &Draw) -> Vec<u32> {
    let mesh = &draw.model.mesh;
    let mut polygons = Vec::with_capacity(mesh.corners().len());
    for polygon in 0..u32::try_from(mesh.polygon_count()).expect("polygons have 32-bit numbers") {
        polygons.extend(mesh.corners_of(polygon).map(|_| polygon));
    }
    polygons
}

/// How far off a vertex is lit, in units of view space.
const FARTHEST: f64 = 1e15;

/// From object space to view space. What is far from the origin is first brought near it, so that
/// f32 keeps its digits.
#[derive(Clone, Copy, Debug)]
struct ToView<T> {
    middle: [T; 3],
    middle_in_view: [T; 3],
    linear: [[T; 3]; 3],
    normals: [[T; 3]; 3],
    eye: Eye,
    /// By which rare way, where it is one.
    way: Option<Normalising>,
}

impl<T: Number> ToView<T> {
    fn new(plan: &FramePlan, draw: &Draw) -> Self {
        let bounds = draw.model.mesh.bounds();
        // A number of f32, so that taking it away is exact where it matters.
        let middle =
            bounds.map_or(DVec3::ZERO, |bounds| dvec3(bounds.centre().as_vec3().to_array()));
        let numbers = |v: DVec3| v.to_array().map(T::from_f64);
        let columns = |m: DMat3| [m.x_axis, m.y_axis, m.z_axis].map(numbers);
        Self {
            middle: numbers(middle),
            middle_in_view: numbers(draw.view_from_object.transform_point3(middle)),
            linear: columns(DMat3::from_mat4(draw.view_from_object)),
            normals: columns(draw.view_from_normal),
            eye: plan.eye,
            way: plan.ways.rare_roots(),
        }
    }

    /// The same for one side of the surface.
    fn seen_from(self, back: bool) -> Self {
        let normals =
            if back { self.normals.map(|column| column.map(|x| -x)) } else { self.normals };
        Self { normals, ..self }
    }
}

/// Vectors times a matrix, which is given by its columns.
#[inline(always)]
fn turned<M: Machine>(
    machine: M,
    [a, b, c]: [[M::Number; 3]; 3],
    Triple([x, y, z]): Triple<M::R>,
) -> Triple<M::R> {
    let (a, b, c) = (set(machine, a), set(machine, b), set(machine, c));
    a.times(x).plus(b.times(y)).plus(c.times(z))
}

/// Brings the places of a batch from object space to view space.
struct Place<'a, T> {
    batch: &'a mut Batch<T>,
    to_view: ToView<T>,
}

impl<T: Number> Kernel<T> for Place<'_, T> {
    #[inline(always)]
    fn run<M: Machine<Number = T>>(self, machine: M) {
        let Self { batch, to_view } = self;
        let (middle, origin) = (set(machine, to_view.middle), set(machine, to_view.middle_in_view));
        for at in (0..batch.len).step_by(M::LANES) {
            let near = load(machine, &batch.position, at).minus(middle);
            // What lies beyond everything that can be seen is brought near enough for its distance to
            // a lamp to have a square.
            let (low, high) = (machine.lift(-FARTHEST), machine.lift(FARTHEST));
            let held = |x: M::R| Real::min(Real::max(x, low), high);
            let [x, y, z] = turned(machine, to_view.linear, near).plus(origin).0;
            let position = Triple([held(x), held(y), held(z)]);
            let normal = turned(machine, to_view.normals, load(machine, &batch.normal, at)).unit();
            let zero = machine.lift(0.0);
            let to_eye = match to_view.eye {
                Eye::Point => Triple([zero, zero, zero]).minus(position).unit(),
                Eye::Parallel => Triple([zero, zero, machine.lift(1.0)]),
            };
            store(machine, position, &mut batch.position, at);
            store(machine, normal, &mut batch.normal, at);
            store(machine, to_eye, &mut batch.to_eye, at);
        }
    }
}

//! Light that is evaluated at faces or at vertices, before any pixel.

use fearless_simd::Level;
use glam::{DMat3, DMat4, DVec3};
use rayon::prelude::*;

use super::effects::{BATCH, Batch, Light, Rows, load, store};
use super::plan::{Back, Draw, Eye, FramePlan, Pipeline};
use super::real::{Kernel, Machine, Real, Triple};
use super::surface::run;
use crate::scene::{LightAt, Normals, dvec3};

/// Places that a thread takes at a time.
const CHUNK: usize = 16 * BATCH;

/// Light at the faces or vertices of a frame: diffuse, then specular, each red, green and blue.
#[derive(Debug, Default)]
pub(super) struct Lit<T> {
    tables: Vec<Table<T>>,
}

/// The light of one draw by one pipeline on one side.
#[derive(Debug)]
struct Table<T> {
    draw: u32,
    pipeline: u32,
    back: bool,
    light: Vec<[T; 6]>,
}

impl<T: Light> Lit<T> {
    /// Lights what the plan says is lit at faces or vertices; nothing where it is lit per pixel.
    pub(super) fn new(plan: &FramePlan, level: Level) -> Self {
        let mut lit = Self { tables: Vec::new() };
        if plan.light_at == LightAt::Pixel {
            return lit;
        }
        for (i, draw) in (0_u32..).zip(&plan.draws) {
            let mut pipelines: Vec<u32> = draw.part_pipelines.iter().copied().flatten().collect();
            pipelines.sort_unstable();
            pipelines.dedup();
            for pipeline in pipelines {
                for back in [false, true] {
                    if !back || draw.back == Back::Lit {
                        let light = light_of(plan, level, draw, pipeline, back);
                        lit.tables.push(Table { draw: i, pipeline, back, light });
                    }
                }
            }
        }
        lit
    }

    /// The light of a draw by a pipeline: of its polygons, its points, or (with the normals of
    /// faces) its corners. Empty where the pipeline is not lit.
    pub(super) fn table(&self, draw: u32, pipeline: u32, back: bool) -> &[[T; 6]] {
        let found = |back: bool| {
            self.tables.iter().find(|t| (t.draw, t.pipeline, t.back) == (draw, pipeline, back))
        };
        found(back).or_else(|| found(false)).map_or(&[], |table| &table.light)
    }
}

/// Lights the places of a draw.
fn light_of<T: Light>(
    plan: &FramePlan,
    level: Level,
    draw: &Draw,
    pipeline: u32,
    back: bool,
) -> Vec<[T; 6]> {
    let Pipeline::Shaded(shaded) = &plan.pipelines[pipeline as usize] else { return Vec::new() };
    let Some(stages) = &shaded.light else { return Vec::new() };
    let mesh = &draw.model.mesh;
    let order = mesh.draw_order();
    let points = order.points(draw.normal_source);
    let count = match (plan.light_at, draw.normals) {
        (LightAt::Face, _) => mesh.polygon_count(),
        (_, Normals::Vertex) => points.normals.len(),
        (_, Normals::Face) => mesh.corners().len(),
    };
    let polygon_of = match (plan.light_at, draw.normals) {
        (LightAt::Vertex, Normals::Face) => polygons_of_corners(draw),
        _ => Vec::new(),
    };
    let place = |i: usize| -> [[f32; 3]; 2] {
        let number = u32::try_from(i).expect("a mesh's places have 32-bit numbers");
        match (plan.light_at, draw.normals) {
            (LightAt::Face, _) => {
                let centre = mesh.polygon_centre(number).as_vec3().to_array();
                [centre, mesh.polygon_normals()[i]]
            }
            (_, Normals::Vertex) => {
                let vertex = points.vertices[i] as usize;
                [[order.x[vertex], order.y[vertex], order.z[vertex]], points.normals[i]]
            }
            (_, Normals::Face) => {
                let position = mesh.corners()[i].position as usize;
                [mesh.positions()[position], mesh.polygon_normals()[polygon_of[i] as usize]]
            }
        }
    };
    let to_view = ToView::new(plan, draw, back);
    let mut light = vec![[T::default(); 6]; count];
    light.par_chunks_mut(CHUNK).enumerate().for_each(|(chunk, light)| {
        let mut batch = Box::<Batch<T>>::default();
        for (i, light) in light.chunks_mut(BATCH).enumerate() {
            batch.len = light.len();
            for (lane, number) in (chunk * CHUNK + i * BATCH..).take(light.len()).enumerate() {
                let [position, normal] = place(number);
                for axis in 0..3 {
                    batch.position[axis][lane] = T::from_f64(f64::from(position[axis]));
                    batch.normal[axis][lane] = T::from_f64(f64::from(normal[axis]));
                }
            }
            for row in batch.diffuse.iter_mut().chain(&mut batch.specular) {
                row.fill(T::default());
            }
            T::run(level, Place { batch: &mut batch, to_view });
            run(stages, shaded, plan, level, &mut batch);
            for (lane, light) in light.iter_mut().enumerate() {
                for axis in 0..3 {
                    light[axis] = batch.diffuse[axis][lane];
                    light[axis + 3] = batch.specular[axis][lane];
                }
            }
        }
    });
    light
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
struct ToView {
    middle: DVec3,
    middle_in_view: DVec3,
    linear: DMat3,
    normals: DMat3,
    eye: Eye,
}

impl ToView {
    fn new(plan: &FramePlan, draw: &Draw, back: bool) -> Self {
        let bounds = draw.model.mesh.bounds();
        // A number of f32, so that taking it away is exact where it matters.
        let middle =
            bounds.map_or(DVec3::ZERO, |bounds| dvec3(bounds.centre().as_vec3().to_array()));
        let view_from_object: DMat4 = draw.view_from_object;
        Self {
            middle,
            middle_in_view: view_from_object.transform_point3(middle),
            linear: DMat3::from_mat4(view_from_object),
            normals: draw.view_from_normal * if back { -1.0 } else { 1.0 },
            eye: plan.eye,
        }
    }
}

/// Brings the places of a batch from object space to view space.
struct Place<'a, T> {
    batch: &'a mut Batch<T>,
    to_view: ToView,
}

impl<T: Light> Kernel<T> for Place<'_, T> {
    #[inline(always)]
    fn run<M: Machine<Number = T>>(self, machine: M) {
        let Self { batch, to_view } = self;
        let zero = machine.lift(0.0);
        let lift = |v: DVec3| Triple::lift(zero, [v.x, v.y, v.z]);
        let (middle, origin) = (lift(to_view.middle), lift(to_view.middle_in_view));
        for at in (0..batch.len).step_by(M::LANES) {
            let turn = |m: DMat3, Triple([x, y, z]): Triple<M::R>| {
                let (a, b, c) = (lift(m.x_axis), lift(m.y_axis), lift(m.z_axis));
                a.times(x).plus(b.times(y)).plus(c.times(z))
            };
            let near = load(machine, &batch.position, at).minus(middle);
            // What lies beyond everything that can be seen is brought near enough for its distance to
            // a lamp to have a square.
            let (low, high) = (machine.lift(-FARTHEST), machine.lift(FARTHEST));
            let held = |x: M::R| Real::min(Real::max(x, low), high);
            let [x, y, z] = turn(to_view.linear, near).plus(origin).0;
            let position = Triple([held(x), held(y), held(z)]);
            let normal = turn(to_view.normals, load(machine, &batch.normal, at)).unit();
            let to_eye = match to_view.eye {
                Eye::Point => Triple([zero, zero, zero]).minus(position).unit(),
                Eye::Parallel => lift(DVec3::Z),
            };
            store_all(machine, batch, [position, normal, to_eye], at);
        }
    }
}

#[inline(always)]
fn store_all<M: Machine>(
    machine: M,
    batch: &mut Batch<M::Number>,
    [position, normal, to_eye]: [Triple<M::R>; 3],
    at: usize,
) {
    let rows: [&mut Rows<M::Number>; 3] =
        [&mut batch.position, &mut batch.normal, &mut batch.to_eye];
    for (rows, value) in rows.into_iter().zip([position, normal, to_eye]) {
        store(machine, value, rows, at);
    }
}

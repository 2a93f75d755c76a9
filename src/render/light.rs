//! Light that is evaluated at faces or at vertices, before any pixel.

use fearless_simd::Level;
use glam::DVec3;

use super::effects::{BATCH, Batch, Light as Number};
use super::geometry::{Geometry, Side};
use super::lines::point_of;
use super::plan::{Back, Draw, FramePlan, Pipeline};
use super::surface::run;
use crate::scene::{LightAt, NONE, Normals, dvec3};

/// Diffuse and specular light.
type Pair<T> = [[T; 3]; 2];

/// Light at the faces or vertices of a frame.
#[derive(Debug, Default)]
pub(super) struct Lit<T> {
    light: Vec<Pair<T>>,
    /// For each draw: where the light of each corner, or of each polygon, stands in `light`. A back
    /// that is lit stands one behind its front.
    places: Vec<Vec<u32>>,
}

/// A place that is to be lit.
#[derive(Clone, Copy, Debug)]
struct Place {
    position: DVec3,
    normal: DVec3,
}

impl<T: Number> Lit<T> {
    /// Lights what the plan says is lit at faces or vertices; nothing where it is lit per pixel.
    pub(super) fn new(plan: &FramePlan, geometry: &Geometry, level: Level) -> Self {
        let mut lit = Self { light: Vec::new(), places: Vec::new() };
        if plan.light_at == LightAt::Pixel {
            return lit;
        }
        for (i, draw) in plan.draws.iter().enumerate() {
            let mut places = vec![NONE; draw.model.mesh.corners().len()];
            for pipeline in 0..plan.pipelines.len() {
                lit.add(plan, geometry, (i, draw), pipeline, level, &mut places);
            }
            lit.places.push(places);
        }
        lit
    }

    /// Lights what one pipeline draws of one draw.
    fn add(
        &mut self,
        plan: &FramePlan,
        geometry: &Geometry,
        (index, draw): (usize, &Draw),
        pipeline: usize,
        level: Level,
        places: &mut [u32],
    ) {
        let Pipeline::Shaded(shaded) = &plan.pipelines[pipeline] else { return };
        let Some(stages) = &shaded.light else { return };
        let pending = pending(plan, geometry, (index, draw), pipeline, self.light.len(), places);
        let sides: &[f64] = if draw.back == Back::Lit { &[1.0, -1.0] } else { &[1.0] };
        let all: Vec<Place> = pending
            .into_iter()
            .flat_map(|place| sides.iter().map(move |side| (place, *side)))
            .map(|(place, side)| Place { normal: place.normal * side, ..place })
            .collect();
        let mut batch = Box::<Batch<T>>::default();
        for chunk in all.chunks(BATCH) {
            batch.len = chunk.len();
            for row in batch.diffuse.iter_mut().chain(&mut batch.specular) {
                row.fill(T::default());
            }
            for (i, place) in chunk.iter().enumerate() {
                batch.put(i, place.position, place.normal, plan.eye);
            }
            run(stages, shaded, plan, level, &mut batch);
            let pick = |i: usize| {
                [batch.diffuse.each_ref(), batch.specular.each_ref()].map(|rows| rows.map(|r| r[i]))
            };
            self.light.extend((0..chunk.len()).map(pick));
        }
    }

    /// The light of a corner of a draw's mesh.
    pub(super) fn of_corner(&self, draw: u32, corner: u32, side: Side) -> Pair<T> {
        let place = self.places[draw as usize][corner as usize];
        self.light[place as usize + usize::from(side == Side::Back)]
    }

    /// The light of a polygon of a draw's mesh.
    pub(super) fn of_polygon(&self, draw: u32, polygon: u32, side: Side) -> Pair<T> {
        self.of_corner(draw, polygon, side)
    }
}

/// The normal of a polygon in view space, of any length.
pub(super) fn face_normal(draw: &Draw, polygon: u32) -> DVec3 {
    draw.view_from_normal * dvec3(draw.model.mesh.polygon_normals()[polygon as usize])
}

/// The places of a draw that one pipeline lights, each once. Writes into `places` where the light of
/// each corner (or polygon) will stand, counting from `next`.
fn pending(
    plan: &FramePlan,
    geometry: &Geometry,
    (index, draw): (usize, &Draw),
    pipeline: usize,
    next: usize,
    places: &mut [u32],
) -> Vec<Place> {
    let mesh = &draw.model.mesh;
    let base = geometry.bases[index];
    let sides = if draw.back == Back::Lit { 2 } else { 1 };
    let mut seen = vec![NONE; mesh.points().len()];
    let mut pending: Vec<Place> = Vec::new();
    let mut add = |place: Place| {
        pending.push(place);
        u32::try_from(next + (pending.len() - 1) * sides).expect("fewer than 2^32 places")
    };
    for polygon in 0..u32::try_from(mesh.polygon_count()).expect("polygons have 32-bit numbers") {
        let part = mesh.polygon_parts()[polygon as usize] as usize;
        if draw.part_pipelines[part].map(|p| p as usize) != Some(pipeline) {
            continue;
        }
        let normal = face_normal(draw, polygon);
        if plan.light_at == LightAt::Face {
            let position = draw.view_from_object.transform_point3(mesh.polygon_centre(polygon));
            places[polygon as usize] = add(Place { position, normal });
            continue;
        }
        for i in mesh.corners_of(polygon) {
            let corner = mesh.corners()[i];
            let position = geometry.positions[base.position + corner.position as usize];
            places[i] = match draw.normals {
                Normals::Face => add(Place { position, normal }),
                Normals::Vertex => {
                    let point = point_of(draw, &corner) as usize;
                    if seen[point] == NONE {
                        let normal = geometry.normals[base.point + point];
                        seen[point] = add(Place { position, normal });
                    }
                    seen[point]
                }
            };
        }
    }
    pending
}

//! What rays can meet: the objects around the observer, whether they are in the picture or not.

use glam::DVec3;

use crate::accel::Accelerated as _;
use crate::frame::FramePlan;
use crate::frame::draw::{Back, Draw, Pipeline, Shaded};
use crate::frame::extras::SurfaceRays;
use crate::rays::{Corners, Hit, Thing, Things};
use crate::texture::sample::{opacity_of, sample};
use crate::texture::uv::{uv, uvs};
use marraztu_core::base::math::each;
use marraztu_core::scene::{Normals, dvec3};

/// The surfaces of a frame that rays can meet, in view space.
#[derive(Debug)]
pub(crate) struct Surroundings<'a> {
    pub(super) plan: &'a FramePlan,
    pub(super) things: Things<'a>,
    /// The draw of each thing.
    draws: Vec<u32>,
}

impl<'a> Surroundings<'a> {
    /// Prepares the filled draws of a plan.
    pub(crate) fn new(plan: &'a FramePlan) -> Self {
        let numbered = (0_u32..).zip(&plan.draws).filter(|(_, draw)| draw.filled);
        let placed = numbered.filter_map(|(index, draw)| {
            let mut thing = Thing::new(&draw.model.mesh, draw.view_from_object)?;
            thing.is_solid = is_solid(plan, draw);
            Some((thing, index))
        });
        let (things, draws): (Vec<_>, _) = placed.unzip();
        Self { plan, things: Things::new(things), draws }
    }

    /// Returns the draw of a thing, and its index.
    pub(super) fn draw(&self, thing: u32) -> (&'a Draw, u32) {
        let index = self.draws[thing as usize];
        (&self.plan.draws[index as usize], index)
    }

    /// Returns the thing of a draw.
    pub(super) fn thing_of(&self, draw: u32) -> Option<u32> {
        let place = self.draws.binary_search(&draw).ok()?;
        u32::try_from(place).ok()
    }

    /// Returns whether a point of a surface stops a ray: it is shown, its back is not culled, and
    /// it is not in a hole.
    pub(super) fn stops(&self, hit: &Hit) -> bool {
        let Self { plan, .. } = self;
        let (draw, _) = self.draw(hit.thing);
        if !draw.shows(draw.model.mesh.polygon_of(hit.triangle)) {
            return false;
        }
        let pipeline = &plan.pipelines[draw.pipeline_of(hit.triangle) as usize];
        if !hit.is_front && is_culled(draw, pipeline) {
            return false;
        }
        let Pipeline::Shaded(Shaded { cutout: Some(opacity), texture, opacity_map, .. }) = pipeline
        else {
            return true;
        };
        let Some(uvs) = uvs(draw, hit.triangle) else { return true };
        let at = uv(uvs, hit.weights);
        let alpha = texture.as_ref().map_or(1.0, |it| sample::<f64>(it, at, plan.filter)[3]);
        let mapped = opacity_map.as_ref().map_or(1.0, |it| opacity_of(it, at, plan.filter));
        alpha * mapped * opacity >= 0.5
    }
}

/// Returns whether all triangles of a draw stop every ray.
fn is_solid(plan: &FramePlan, draw: &Draw) -> bool {
    let solid = |part: &Option<u32>| {
        part.is_some_and(|pipeline| {
            let pipeline = &plan.pipelines[pipeline as usize];
            !is_culled(draw, pipeline) && !pipeline.is_cutout()
        })
    };
    draw.polygons.is_none() && draw.part_pipelines.iter().all(solid)
}

/// Returns whether the backs of faces stop no ray. Refraction needs the backs of closed bodies.
fn is_culled(draw: &Draw, pipeline: &Pipeline) -> bool {
    let refracts = match pipeline {
        Pipeline::Shaded(shaded) => shaded.extras.rays.as_ref().is_some_and(SurfaceRays::transmits),
        Pipeline::Flat(_) => false,
    };
    let opaque_culled = draw.culls_opaque && pipeline.opacity().is_none();
    (draw.back == Back::Culled || opaque_culled) && !refracts
}

/// Returns the corners of a triangle of a draw, in view space.
pub(super) fn corners_of(draw: &Draw, triangle: u32) -> Corners {
    let order = draw.model.mesh.draw_order();
    each(order.vertices_of(triangle), |vertex| {
        draw.view_from_object.transform_point3(DVec3::from_array(order.position(vertex)))
    })
}

/// Returns the normals at the corners of a triangle of a draw, transformed to view space: their
/// lengths are those of the transform.
pub(super) fn normals_of(draw: &Draw, triangle: u32) -> [DVec3; 3] {
    let mesh = &draw.model.mesh;
    let placed = |normal: [f32; 3]| draw.view_from_normal * dvec3(normal);
    match draw.normals {
        Normals::Face => [placed(mesh.polygon_normals()[mesh.polygon_of(triangle) as usize]); 3],
        Normals::Vertex => {
            let order = mesh.draw_order();
            let points = order.points(draw.normal_source);
            let own = points.of(order, triangle, order.vertices_of(triangle));
            each(own, |point| placed(points.normals[point as usize]))
        }
    }
}

//! What rays can meet: the objects around the observer, whether they are in the picture or not.

use glam::{DMat3, DMat4, DVec3};

use crate::accel::{Accelerated as _, Bvh, EightBoxes};
use crate::frame::FramePlan;
use crate::frame::draw::{Back, Draw, Pipeline, Shaded};
use crate::frame::extras::SurfaceRays;
use crate::shadow::triangle::{Corners, FLAT};
use crate::texture::sample::{opacity_of, sample};
use crate::texture::uv::{uv, uvs};
use marraztu_core::base::math::each;
use marraztu_core::scene::{Bounds, Normals, dvec3};

/// The surfaces of a frame that rays can meet, ready for ray tracing.
#[derive(Debug)]
pub(crate) struct Surroundings<'a> {
    pub(crate) plan: &'a FramePlan,
    pub(super) things: Vec<Thing<'a>>,
    /// The boxes of eight things each, in view space.
    pub(super) boxes: Vec<EightBoxes>,
    /// The largest coordinate of the boxes.
    pub(super) reach: f64,
}

/// A draw, ready for ray tracing.
#[derive(Debug)]
pub(super) struct Thing<'a> {
    /// The index of the draw in the plan.
    pub(super) index: u32,
    pub(super) draw: &'a Draw,
    pub(super) tree: &'a Bvh,
    pub(super) object_from_view: DMat4,
    /// The bounds in object space.
    pub(super) bounds: Bounds,
    /// The distance in view space within which its triangles lie in one plane.
    flat: f64,
    /// Whether all of its triangles stop every ray.
    pub(super) is_solid: bool,
}

/// The kind of part that a ray meets.
#[derive(Clone, Copy, Debug)]
struct PartKind<'a> {
    pipeline: &'a Pipeline,
    /// Whether the backs of its faces stop no ray.
    is_culled: bool,
}

impl<'a> Surroundings<'a> {
    /// Prepares the filled draws of a plan.
    pub(crate) fn new(plan: &'a FramePlan) -> Self {
        let numbered = (0_u32..).zip(&plan.draws);
        let things: Vec<Thing<'a>> =
            numbered.filter_map(|(index, draw)| Thing::new(plan, index, draw)).collect();
        let mut boxes = vec![EightBoxes::default(); things.len().div_ceil(EightBoxes::COUNT)];
        let mut reach = 0.0_f64;
        for (i, thing) in things.iter().enumerate() {
            let m = thing.draw.view_from_object;
            let corners = thing.bounds.corners().map(|corner| m.transform_point3(corner));
            let low = corners.iter().fold(DVec3::INFINITY, |low, corner| low.min(*corner));
            let high = corners.iter().fold(DVec3::NEG_INFINITY, |high, corner| high.max(*corner));
            reach = reach.max(low.abs().max(high.abs()).max_element());
            // Rounded outwards.
            let around = [
                low.as_vec3().to_array().map(f32::next_down),
                high.as_vec3().to_array().map(f32::next_up),
            ];
            boxes[i / EightBoxes::COUNT].set(i % EightBoxes::COUNT, around);
        }
        Self { plan, things, boxes, reach }
    }

    /// Returns the draw with this index.
    pub(crate) fn draw(&self, index: u32) -> &'a Draw {
        &self.plan.draws[index as usize]
    }

    /// Returns the corners of a triangle of a draw, in view space.
    pub(crate) fn corners(&self, draw: u32, triangle: u32) -> Corners {
        corners_of(self.draw(draw), triangle)
    }

    /// Returns the distance within which triangles of a draw lie in one plane.
    pub(super) fn flat(&self, draw: u32) -> f64 {
        self.things.iter().find(|thing| thing.index == draw).map_or(0.0, |thing| thing.flat)
    }
}

/// Returns the corners of a triangle of a draw, in view space.
pub(crate) fn corners_of(draw: &Draw, triangle: u32) -> Corners {
    let order = draw.model.mesh.draw_order();
    each(order.vertices_of(triangle), |vertex| {
        draw.view_from_object.transform_point3(DVec3::from_array(order.position(vertex)))
    })
}

/// Returns the normals at the corners of a triangle of a draw, transformed to view space: their
/// lengths are those of the transform.
pub(crate) fn normals_of(draw: &Draw, triangle: u32) -> [DVec3; 3] {
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

impl<'a> Thing<'a> {
    /// Returns the distance within which its triangles lie in one plane.
    pub(super) const fn flat(&self) -> f64 {
        self.flat
    }

    fn new(plan: &FramePlan, index: u32, draw: &'a Draw) -> Option<Self> {
        let mesh = &draw.model.mesh;
        let bounds = mesh.bounds().filter(|_| draw.filled && mesh.polygon_count() > 0)?;
        let m = draw.view_from_object;
        let object_from_view = m.inverse();
        // A flat placement has no inside and is not drawn either.
        let is_sound = m.is_finite() && object_from_view.is_finite();
        let scale = DMat3::from_mat4(m).to_cols_array_2d().map(|axis| DVec3::from(axis).length());
        let largest =
            bounds.corners().iter().fold(0.0, |most: f64, p| most.max(p.abs().max_element()));
        let thing = Self {
            index,
            draw,
            tree: mesh.bvh(),
            object_from_view,
            bounds,
            flat: FLAT * largest * scale.into_iter().fold(0.0, f64::max),
            is_solid: false,
        };
        let solid = |part: &Option<u32>| {
            part.is_some_and(|pipeline| {
                let kind = thing.kind(plan, pipeline);
                !kind.is_culled && !kind.pipeline.is_cutout()
            })
        };
        let is_solid = draw.polygons.is_none() && draw.part_pipelines.iter().all(solid);
        is_sound.then_some(Self { is_solid, ..thing })
    }

    fn kind<'b>(&self, plan: &'b FramePlan, pipeline: u32) -> PartKind<'b> {
        let pipeline = &plan.pipelines[pipeline as usize];
        let refracts = matches!(pipeline, Pipeline::Shaded(Shaded { extras, .. })
            if extras.rays.as_ref().is_some_and(SurfaceRays::transmits));
        let opaque_culled = self.draw.culls_opaque && pipeline.opacity().is_none();
        let is_culled = (self.draw.back == Back::Culled || opaque_culled) && !refracts;
        PartKind { pipeline, is_culled }
    }

    /// Returns whether a triangle stops a ray that meets its front or back at a point with these
    /// weights of the corners: it is shown, its back is not culled, and it has no hole there.
    pub(super) fn stops(
        &self,
        plan: &FramePlan,
        triangle: u32,
        (is_front, weights): (bool, DVec3),
    ) -> bool {
        if self.is_solid {
            return true;
        }
        let polygon = self.draw.model.mesh.polygon_of(triangle);
        if !self.draw.shows(polygon) {
            return false;
        }
        let kind = self.kind(plan, self.draw.pipeline_of(triangle));
        if kind.is_culled && !is_front {
            return false;
        }
        let Pipeline::Shaded(Shaded { cutout: Some(opacity), texture, opacity_map, .. }) =
            kind.pipeline
        else {
            return true;
        };
        let Some(uvs) = uvs(self.draw, triangle) else { return true };
        let at = uv(uvs, weights);
        let alpha = texture.as_ref().map_or(1.0, |it| sample::<f64>(it, at, plan.filter)[3]);
        let mapped = opacity_map.as_ref().map_or(1.0, |it| opacity_of(it, at, plan.filter));
        alpha * mapped * opacity >= 0.5
    }
}

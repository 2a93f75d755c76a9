//! Placed meshes, ready for ray tracing.

use glam::{DMat3, DMat4, DVec3};

use super::{Corners, FLAT};
use crate::accel::{Accelerated as _, Bvh, EightBoxes};
use marraztu_core::base::math::each;
use marraztu_core::scene::{Bounds, Mesh};

/// A placed mesh.
#[derive(Debug)]
pub(crate) struct Thing<'a> {
    mesh: &'a Mesh,
    pub(super) tree: &'a Bvh,
    /// The transform to the space of the rays.
    placement: DMat4,
    pub(super) object_from_rays: DMat4,
    /// The bounds in object space.
    pub(super) bounds: Bounds,
    /// The distance within which its triangles lie in one plane.
    pub(super) flat: f64,
    /// Whether all of its triangles stop every ray.
    pub(crate) is_solid: bool,
}

/// Placed meshes in the space of their rays.
#[derive(Debug, Default)]
pub(crate) struct Things<'a> {
    pub(crate) all: Vec<Thing<'a>>,
    /// The boxes of eight things each.
    pub(super) boxes: Vec<EightBoxes>,
    /// The largest coordinate of the boxes.
    pub(super) reach: f64,
}

impl<'a> Thing<'a> {
    /// Prepares a mesh. `None` if it has no polygons, or a placement without an inverse.
    pub(crate) fn new(mesh: &'a Mesh, placement: DMat4) -> Option<Self> {
        let bounds = mesh.bounds().filter(|_| mesh.polygon_count() > 0)?;
        let object_from_rays = placement.inverse();
        let is_sound = placement.is_finite() && object_from_rays.is_finite();
        let axes = DMat3::from_mat4(placement).to_cols_array_2d();
        let scale = axes.map(|axis| DVec3::from(axis).length()).into_iter().fold(0.0, f64::max);
        let corners = bounds.corners();
        let largest = corners.iter().fold(0.0, |most: f64, p| most.max(p.abs().max_element()));
        is_sound.then(|| Self {
            mesh,
            tree: mesh.bvh(),
            placement,
            object_from_rays,
            bounds,
            flat: FLAT * largest * scale,
            is_solid: false,
        })
    }

    /// Returns the corners of a triangle in the space of the rays.
    pub(crate) fn corners(&self, triangle: u32) -> Corners {
        let order = self.mesh.draw_order();
        each(order.vertices_of(triangle), |vertex| {
            self.placement.transform_point3(DVec3::from_array(order.position(vertex)))
        })
    }
}

impl<'a> Things<'a> {
    pub(crate) fn new(all: Vec<Thing<'a>>) -> Self {
        let mut boxes = vec![EightBoxes::default(); all.len().div_ceil(EightBoxes::COUNT)];
        let mut reach = 0.0_f64;
        for (i, thing) in all.iter().enumerate() {
            let corners = thing.bounds.corners().map(|p| thing.placement.transform_point3(p));
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
        Self { all, boxes, reach }
    }
}

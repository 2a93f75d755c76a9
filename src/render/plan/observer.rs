//! Who looks, and what is outside the view.

use glam::{DMat3, DMat4, DVec3};

use crate::base::image::Size;
use crate::base::math;
use crate::scene::{Scene, View};

/// The observer's spaces.
pub(in crate::render) struct ObserverSpace {
    pub(in crate::render) world_from_view: DMat4,
    pub(in crate::render) view_from_world: DMat4,
    pub(in crate::render) clip_from_view: DMat4,
    pub(in crate::render) size: Size,
}

impl ObserverSpace {
    pub(super) fn new(scene: &Scene, view: &View, size: Size) -> Self {
        let world_from_view = scene.observer_frame(view);
        // The axes are orthonormal, so the inverse turn is the transposed one.
        let turn = DMat3::from_mat4(world_from_view).transpose();
        let eye = world_from_view.w_axis.truncate();
        let lens = scene.selected_camera(view).lens;
        Self {
            world_from_view,
            view_from_world: math::placed(turn, DVec3::ZERO) * DMat4::from_translation(-eye),
            clip_from_view: lens.clip_from_view(view.projection, size),
            size,
        }
    }

    /// Whether a box lies wholly outside one of the planes of the view.
    pub(super) fn misses(&self, clip_from_object: DMat4, corners: [DVec3; 8]) -> bool {
        let clip = corners.map(|corner| clip_from_object * corner.extend(1.0));
        // A little is left for rounding, so that nothing is missed that geometry would keep.
        let beyond = |distance: fn(glam::DVec4) -> f64| {
            clip.iter().all(|p| distance(*p) < -1e-9 * (p.w.abs() + p.abs().max_element()))
        };
        beyond(|p| p.w + p.x)
            || beyond(|p| p.w - p.x)
            || beyond(|p| p.w + p.y)
            || beyond(|p| p.w - p.y)
            || beyond(|p| p.z)
            || beyond(|p| p.w - p.z)
    }
}

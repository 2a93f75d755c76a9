//! Decides whether the numbers of a frame fit f32.
//!
//! Lighting squares distances, and squares fit f32 only for numbers from 1e-19 to 1e19. In the unit
//! of view space the far plane is about a thousand units away, so distances fit, unless a lens has
//! an extreme range: near distances are then too small relative to the far plane. Such a frame is
//! planned in f64, so no pixel needs a check.

use glam::DVec3;

use crate::frame::{Eye, FramePlan};

/// The smallest and largest length in view space for which the square, and everything computed from
/// it, fits f32.
const ROOM: [f64; 2] = [1e-12, 1e15];

impl FramePlan {
    /// Returns whether all distances of the frame fit f32.
    pub(super) fn has_room(&self) -> bool {
        let m = &self.clip_from_view;
        let [low, high] = ROOM;
        match self.eye {
            Eye::Point => {
                // The depth is zw / w - zz: 1 at the near plane, 0 at the far plane.
                let (zz, zw) = (m.z_axis.z, m.w_axis.z);
                let (near, far) = (zw / (1.0 + zz), zw / zz);
                // A tiny near distance does no harm if every object is farther away.
                far <= high && (near >= low || self.ways_off().all(|off| off >= low))
            }
            Eye::Parallel => {
                let [x, y] = self.axis().map(|axis| 1.0 + axis.abs());
                let sides = [x / m.x_axis.x, y / m.y_axis.y];
                let depths = [(1.0 - m.w_axis.z) / m.z_axis.z, -m.w_axis.z / m.z_axis.z];
                // The distance of a pixel is interpolated from the corners of its triangle.
                sides.iter().all(|side| *side >= low)
                    && sides.iter().chain(&depths).all(|length| length.abs() <= high)
                    && self.ways_off().all(|off| off.abs() <= high)
            }
        }
    }

    /// Iterates over the distances along the view axis at which items begin and end.
    fn ways_off(&self) -> impl Iterator<Item = f64> {
        self.draws.iter().flat_map(|draw| {
            let corners = draw.model.mesh.bounds().map(|bounds| bounds.corners());
            let off = |corner: DVec3| -draw.view_from_object.transform_point3(corner).z;
            corners.into_iter().flatten().map(off)
        })
    }
}

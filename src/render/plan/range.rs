//! Whether 32 bits have room for the numbers of a frame.
//!
//! Light squares distances, and numbers of 32 bits have squares from 1e-19 to 1e19 only. View space
//! has a unit in which the observer sees some thousand units far, so what is seen has room, unless a
//! lens reaches beyond everything: then what is near is too small beside it. Such a frame is planned
//! in 64 bits. So no pixel has to ask.

use glam::DVec3;

use crate::render::frame::{Eye, FramePlan};

/// The least and the largest length in view space whose square, with all that is done to it, has room
/// in 32 bits.
const ROOM: [f64; 2] = [1e-12, 1e15];

impl FramePlan {
    /// Whether everything that is seen, and how far, has room in 32 bits.
    pub(super) fn has_room(&self) -> bool {
        let m = &self.clip_from_view;
        let [low, high] = ROOM;
        match self.eye {
            Eye::Point => {
                // The depth is zw / w - zz: 1 at the near plane, 0 at the far one.
                let (zz, zw) = (m.z_axis.z, m.w_axis.z);
                let (near, far) = (zw / (1.0 + zz), zw / zz);
                far <= high && (near >= low || self.ways_off().all(|off| off >= low))
            }
            Eye::Parallel => {
                let sides = [1.0 / m.x_axis.x, 1.0 / m.y_axis.y];
                let depths = [(1.0 - m.w_axis.z) / m.z_axis.z, -m.w_axis.z / m.z_axis.z];
                // How far off a pixel is, is mixed from the corners of what it shows.
                sides.iter().all(|side| *side >= low)
                    && sides.iter().chain(&depths).all(|length| length.abs() <= high)
                    && self.ways_off().all(|off| off.abs() <= high)
            }
        }
    }

    /// How far from the observer things begin and end, along the way that they look.
    fn ways_off(&self) -> impl Iterator<Item = f64> {
        self.draws.iter().flat_map(|draw| {
            let corners = draw.model.mesh.bounds().map(|bounds| bounds.corners());
            let off = |corner: DVec3| -draw.view_from_object.transform_point3(corner).z;
            corners.into_iter().flatten().map(off)
        })
    }
}

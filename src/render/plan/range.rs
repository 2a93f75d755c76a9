//! Whether 32 bits have room for the numbers of a frame.
//!
//! Light squares distances, and numbers of 32 bits have squares from 1e-19 to 1e19 only. View space
//! has a unit in which the observer sees some thousand units far, so what is seen has room, unless a
//! lens reaches beyond everything: then what is near is too small beside it. Such a frame is planned
//! in 64 bits. So no pixel has to ask.

use super::{Eye, FramePlan};

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
                far <= high && (near >= low || self.nearest() >= low)
            }
            Eye::Parallel => {
                let sides = [1.0 / m.x_axis.x, 1.0 / m.y_axis.y];
                let depths = [(1.0 - m.w_axis.z) / m.z_axis.z, -m.w_axis.z / m.z_axis.z];
                sides.iter().all(|side| *side >= low)
                    && sides.iter().chain(&depths).all(|length| length.abs() <= high)
            }
        }
    }

    /// How near to the observer anything may be, along the way that they look.
    fn nearest(&self) -> f64 {
        let corners = self.draws.iter().filter_map(|draw| {
            let bounds = draw.model.mesh.bounds()?;
            Some(bounds.corners().map(|corner| -draw.view_from_object.transform_point3(corner).z))
        });
        corners.flatten().fold(f64::INFINITY, f64::min)
    }
}

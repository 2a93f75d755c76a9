//! Normals as they are summed and shown.

use glam::DVec3;

/// The sum of unit normals that cancel out is shorter than this: only rounding errors.
const CANCELLED: f64 = 1e-9;

/// Whether the unit normals with this sum cancel out.
pub(crate) fn cancels(sum: DVec3) -> bool {
    sum.length() <= CANCELLED
}

/// A normal as it is shown: (0, 0, 1) if it has no length.
pub(crate) fn shown_normal(normal: Option<DVec3>) -> [f32; 3] {
    narrow(normal.unwrap_or(DVec3::Z))
}

pub(crate) fn narrow(v: DVec3) -> [f32; 3] {
    v.as_vec3().to_array()
}

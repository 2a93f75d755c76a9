//! Stored normals, and tests for sums that cancel out.

use glam::DVec3;

/// Unit normals cancel out if their sum is at most this long, since the rest is rounding error.
const CANCELLED: f64 = 1e-9;

/// Returns whether the unit normals with this sum cancel out.
pub(crate) fn cancels(sum: DVec3) -> bool {
    sum.length() <= CANCELLED
}

/// Rounds a normal to f32; `None` becomes (0, 0, 1).
pub(crate) fn shown_normal(normal: Option<DVec3>) -> [f32; 3] {
    narrow(normal.unwrap_or(DVec3::Z))
}

pub(crate) fn narrow(v: DVec3) -> [f32; 3] {
    v.as_vec3().to_array()
}

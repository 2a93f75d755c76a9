//! Texture coordinates of triangles.

use glam::DVec3;

use crate::frame::draw::Draw;
use marraztu_core::base::math::each;

/// The texture coordinates of a triangle's corners.
pub(crate) type Uvs = [[f64; 2]; 3];

/// Interpolates the texture coordinates of the corners.
#[inline(always)]
pub(crate) fn uv([a, b, c]: Uvs, weights: DVec3) -> [f64; 2] {
    let between = |axis: usize| {
        let (low, high) = (a[axis].min(b[axis]).min(c[axis]), a[axis].max(b[axis]).max(c[axis]));
        let value = a[axis] + (b[axis] - a[axis]) * weights.y + (c[axis] - a[axis]) * weights.z;
        // Rounded weights may leave the range of the corners.
        value.clamp(low, high)
    };
    [between(0), between(1)]
}

/// Returns the texture coordinates of a triangle's corners. `None` if a corner has no coordinates.
#[inline(always)]
pub(crate) fn uvs(draw: &Draw, number: u32) -> Option<Uvs> {
    let own = draw.model.mesh.triangle_uvs(number)?;
    Some(each(own, |[u, v]| [f64::from(u), f64::from(v)]))
}

//! A polygon as triangles.

use glam::DVec3;

/// Cuts a polygon into triangles, each as three places in `outline`, in its order of rotation.
///
/// `normal` is the polygon's normal; there are `outline.len() - 2` triangles.
#[must_use]
pub fn triangulate(outline: &[DVec3], normal: DVec3) -> Vec<[u32; 3]> {
    let _ = normal;
    let last = u32::try_from(outline.len().saturating_sub(1)).unwrap_or(0);
    (1..last).map(|i| [0, i, i + 1]).collect()
}

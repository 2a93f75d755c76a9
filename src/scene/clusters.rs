//! Bounds of triangles that lie side by side, so that many are left out at once.
//!
//! A cluster knows a ball about its corners and a cone about its normals: Shirman and Abi-Ezzi, "The Cone
//! of Normals Technique for Fast Processing of Curved Patches", Eurographics 1993. It also knows how thin
//! its triangles are, since one that is thinner than a part of a pixel may be turned round by snapping.
//! All bounds are rounded outwards.

use glam::DVec3;
use rayon::prelude::*;

use super::order::DrawTriangle;

/// Triangles of a cluster; the last has what is left.
pub const CLUSTER: usize = 64;

/// Some triangles of a [`DrawOrder`](super::DrawOrder), in object space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cluster {
    /// The middle of a ball about all corners.
    pub centre: [f32; 3],
    /// Its radius.
    pub radius: f32,
    /// The axis of a cone about the normals of all triangles, of no certain length.
    pub axis: [f32; 3],
    /// The cosine of its half-angle; -1 where a triangle has no normal.
    pub cosine: f32,
    /// The least height of a triangle over its longest side.
    pub least_height: f32,
    /// The least doubled area.
    pub least_area: f32,
}

/// More than what rounding to f32 takes from a number, as a part of it.
const ROUNDING: f64 = 1e-6;

impl Cluster {
    /// The bounds of triangles whose corners `place` knows.
    #[expect(clippy::cast_possible_truncation, reason = "rounded outwards")]
    fn of(triangles: &[DrawTriangle], place: impl Fn(u32) -> DVec3) -> Self {
        let corners = || triangles.iter().flat_map(|triangle| triangle.vertices).map(&place);
        let low = corners().fold(DVec3::INFINITY, DVec3::min);
        let high = corners().fold(DVec3::NEG_INFINITY, DVec3::max);
        let centre = ((low + high) / 2.0).as_vec3();
        let middle = centre.as_dvec3();
        let radius = corners().map(|corner| corner.distance(middle)).fold(0.0, f64::max);
        let (mut sum, mut least_height, mut least_area) = (DVec3::ZERO, f64::MAX, f64::MAX);
        let normal = |triangle: &DrawTriangle| {
            let [a, b, c] = triangle.vertices.map(&place);
            ((b - a).cross(c - a), [b - a, c - b, a - c])
        };
        for (across, sides) in triangles.iter().map(normal) {
            let area = across.length();
            let longest = sides.into_iter().map(DVec3::length).fold(0.0, f64::max);
            sum += across.normalize_or_zero();
            least_area = least_area.min(area);
            least_height = least_height.min(if longest > 0.0 { area / longest } else { 0.0 });
        }
        let axis = sum.normalize_or_zero().as_vec3();
        let own = axis.as_dvec3().normalize_or_zero();
        let cosines = triangles.iter().map(|of| own.dot(normal(of).0.normalize_or_zero()));
        let cosine = cosines.fold(1.0, f64::min) - ROUNDING;
        Self {
            centre: centre.to_array(),
            radius: (radius * (1.0 + ROUNDING)) as f32,
            axis: axis.to_array(),
            cosine: if least_area > 0.0 { cosine as f32 } else { -1.0 },
            least_height: (least_height.min(1e30) * (1.0 - ROUNDING)) as f32,
            least_area: (least_area.min(1e30) * (1.0 - ROUNDING)) as f32,
        }
    }
}

/// The clusters of some triangles, whose corners `place` knows.
pub(super) fn clusters(
    triangles: &[DrawTriangle],
    place: impl Fn(u32) -> DVec3 + Sync,
) -> Vec<Cluster> {
    triangles.par_chunks(CLUSTER).map(|some| Cluster::of(some, &place)).collect()
}

//! Bounds of groups of neighbouring triangles, for culling a whole group at once.
//!
//! A cluster has a bounding sphere of its corners and a cone of its normals: Shirman and Abi-Ezzi,
//! "The Cone of Normals Technique for Fast Processing of Curved Patches", Eurographics 1993. It
//! also has the thinness of its triangles, since snapping may flip a triangle that is thinner than
//! a fraction of a pixel. All bounds are rounded outwards.

use glam::DVec3;
use rayon::prelude::*;

/// A triangle in draw order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DrawTriangle {
    /// The vertices, as indices into [`DrawOrder::x`](super::DrawOrder::x).
    pub vertices: [u32; 3],
    /// The triangle's index in [`Mesh::triangles`](marraztu_core::scene::Mesh::triangles).
    pub number: u32,
}

impl DrawTriangle {
    /// Returns the vertices and the number as a row of four integers.
    #[inline(always)]
    #[must_use]
    pub const fn row(&self) -> [i32; 4] {
        let [a, b, c] = self.vertices;
        [a.cast_signed(), b.cast_signed(), c.cast_signed(), self.number.cast_signed()]
    }
}

/// The number of triangles in a cluster; the last cluster may have fewer.
pub const CLUSTER: usize = 64;

/// The bounds of some triangles of a [`DrawOrder`](super::DrawOrder), in object space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cluster {
    /// The centre of the bounding sphere.
    pub centre: [f32; 3],
    /// The radius of the bounding sphere.
    pub radius: f32,
    /// The axis of the cone of all normals, of any length.
    pub axis: [f32; 3],
    /// The cosine of the cone's half-angle; -1 if a triangle has no normal.
    pub cosine: f32,
    /// The smallest height of a triangle over its longest side.
    pub least_height: f32,
    /// The smallest doubled area of a triangle.
    pub least_area: f32,
}

/// An upper bound of the relative error of rounding to f32.
const ROUNDING: f64 = 1e-6;

impl Cluster {
    /// Computes the bounds of triangles; `place` gives the positions of their corners.
    #[expect(clippy::cast_possible_truncation, reason = "rounded outwards")]
    fn of(triangles: &[DrawTriangle], place: impl Fn(u32) -> DVec3) -> Self {
        let corners = || triangles.iter().flat_map(|triangle| triangle.vertices).map(&place);
        // The sphere is centred in the bounding box of the corners.
        let low = corners().fold(DVec3::INFINITY, DVec3::min);
        let high = corners().fold(DVec3::NEG_INFINITY, DVec3::max);
        let centre = ((low + high) / 2.0).as_vec3();
        let middle = centre.as_dvec3();
        let radius = corners().map(|corner| corner.distance(middle)).fold(0.0, f64::max);
        // The axis is the mean of unit normals, so a large triangle does not outweigh small ones.
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
        // The cone is measured from the axis as it is stored, after rounding.
        let own = axis.as_dvec3().normalize_or_zero();
        // The cone reaches to the normal that is farthest from the axis.
        let cosines = triangles.iter().map(|of| own.dot(normal(of).0.normalize_or_zero()));
        let cosine = cosines.fold(1.0, f64::min) - ROUNDING;
        Self {
            centre: centre.to_array(),
            radius: (radius * (1.0 + ROUNDING)) as f32,
            axis: axis.to_array(),
            cosine: if least_area > 0.0 { cosine as f32 } else { -1.0 },
            // Held to the range of f32.
            least_height: (least_height.min(1e30) * (1.0 - ROUNDING)) as f32,
            least_area: (least_area.min(1e30) * (1.0 - ROUNDING)) as f32,
        }
    }
}

/// Divides triangles into clusters; `place` gives the positions of their corners.
pub(crate) fn clusters(
    triangles: &[DrawTriangle],
    place: impl Fn(u32) -> DVec3 + Sync,
) -> Vec<Cluster> {
    triangles.par_chunks(CLUSTER).map(|some| Cluster::of(some, &place)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use marraztu_core::base::rng::Rng;

    #[test]
    fn every_corner_lies_in_the_sphere_and_every_normal_in_the_cone() {
        let mut rng = Rng::new(1);
        for round in 0..200 {
            // From nearly flat patches far from the origin to triangles in all directions.
            let rough = [1e-3, 0.1, 1.0][round % 3];
            let away = DVec3::splat([0.0, 5e3][round % 2]);
            let mut place =
                || (away + rng.vector(1.0) * DVec3::new(1.0, 1.0, rough)).as_vec3().as_dvec3();
            let places: Vec<DVec3> = (0..3 * CLUSTER).map(|_| place()).collect();
            let triangle = |number: usize| {
                let at = |i: usize| u32::try_from(3 * number + i).unwrap();
                DrawTriangle { vertices: [at(0), at(1), at(2)], number: at(0) / 3 }
            };
            let triangles: Vec<DrawTriangle> = (0..CLUSTER).map(triangle).collect();
            let [cluster] = clusters(&triangles, |i| places[i as usize])[..] else { panic!() };
            let centre = DVec3::from_array(cluster.centre.map(f64::from));
            for place in &places {
                assert!(place.distance(centre) <= f64::from(cluster.radius), "round {round}");
            }
            let axis = DVec3::from_array(cluster.axis.map(f64::from)).normalize_or_zero();
            for corners in places.as_chunks::<3>().0 {
                let [a, b, c] = *corners;
                let across = (b - a).cross(c - a);
                let cosine = axis.dot(across.normalize_or_zero());
                assert!(cosine >= f64::from(cluster.cosine), "round {round}");
                assert!(across.length() >= f64::from(cluster.least_area), "round {round}");
            }
        }
    }
}

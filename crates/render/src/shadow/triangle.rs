//! Ray-triangle intersection: decides whether a triangle lies between points and a light.
//!
//! With the corners A, B, C, a point P and the light L:
//!
//! ```text
//! s(P) = (B - A) x (C - A) . (P - A)        the side of the plane that P lies on; s(L) alike
//! e(P) = (A - L) x (B - A) . (P - A)        the side of the plane through L, A, B; others alike
//! ```
//!
//! The triangle blocks the ray if s(P) and s(L) have opposite signs and no e(P) has the sign of
//! s(L). Each function is a determinant of three differences. The two triangles of an edge get the
//! same number with opposite signs, so no ray passes between them.
//!
//! In f64, with u = 2^-53 and a, b, m the largest components of A - L, B - A and P - A, the error
//! of e(P) is below 48 u a b m: each difference has a relative error of u, each component of the
//! cross product is below 2 a b with an error of 8 u a b, and the dot product adds three of those
//! times m. The bounds in the code are 128 u a b m.

use glam::DVec3;
use robust::{Coord3D, orient3d};

use crate::rays::Corners;

/// The error factor 128 u: see the [module](self).
pub(super) const ERROR: f64 = 1.0 / (1_u64 << 46) as f64;

/// The error of a point's distance from the plane of its triangle, relative to the triangle's
/// largest coordinate: about ten times the rounding of three products and two sums.
pub(super) const OFF_PLANE: f64 = 1.0 / (1_u64 << 46) as f64;

fn place(p: DVec3) -> Coord3D<f64> {
    Coord3D { x: p.x, y: p.y, z: p.z }
}

/// Computes the sign of s(P), exactly.
pub(crate) fn side([a, b, c]: &Corners, p: DVec3) -> f64 {
    -orient3d(place(*a), place(*b), place(*c), place(p))
}

/// Computes the sign of e(P) for the edge from A to B, exactly.
fn edge_side(light: DVec3, a: DVec3, b: DVec3, p: DVec3) -> f64 {
    -orient3d(place(light), place(b), place(p), place(a))
}

/// Returns whether a triangle lies between a point and a light, exactly.
pub(crate) fn is_between(triangle: &Corners, light: DVec3, p: DVec3) -> bool {
    let of_light = side(triangle, light);
    let [a, b, c] = *triangle;
    opposite(side(triangle, p), of_light)
        && [(a, b), (b, c), (c, a)]
            .into_iter()
            .all(|(from, to)| !alike(edge_side(light, from, to, p), of_light))
}

fn opposite(a: f64, b: f64) -> bool {
    (a > 0.0 && b < 0.0) || (a < 0.0 && b > 0.0)
}

fn alike(a: f64, b: f64) -> bool {
    (a > 0.0 && b > 0.0) || (a < 0.0 && b < 0.0)
}

/// Returns whether any corner of a triangle lies behind the plane of another, seen from the light,
/// by more than `flat`. Triangles within that distance of one plane do not shade each other.
pub(crate) fn reaches_behind(own: &Corners, triangle: &Corners, light: DVec3, flat: f64) -> bool {
    let of_light = side(triangle, light);
    let [a, b, c] = *triangle;
    // The plane function is the distance from the plane times the length of this normal.
    let least = flat * (b - a).cross(c - a).length();
    own.iter().any(|corner| {
        let own = side(triangle, *corner);
        opposite(own, of_light) && own.abs() > least
    })
}

/// A triangle prepared for the rays to one light. It blocks a point if all edge functions are at
/// least 0 and the plane function is positive.
#[derive(Clone, Copy, Debug)]
pub(super) struct Prepared {
    pub(super) corners: Corners,
    /// The normals of the planes through the light and each edge.
    pub(super) normals: [DVec3; 3],
}

/// The triangles that block the ray, and the undecided ones, a bit for each.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Decided {
    pub(super) between: u64,
    pub(super) open: u64,
}

impl Prepared {
    /// Returns the barycentric coordinates at which a ray crosses the triangle.
    pub(super) fn parts(&self, p: DVec3) -> DVec3 {
        let value = |i: usize| self.normals[i].dot(p - self.corners[i]).max(0.0);
        // Edge functions are proportional to the weights of the opposite corners.
        let parts = DVec3::new(value(1), value(2), value(0));
        let sum = parts.element_sum();
        if sum > 0.0 { parts / sum } else { DVec3::splat(1.0 / 3.0) }
    }
}

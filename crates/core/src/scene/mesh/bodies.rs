//! Finds closed bodies that are inside out, and file normals that point against their faces.
//!
//! A body is a set of polygons that are connected by vertices. It is closed if the hashes of its
//! boundary sum to 0 ([`closed`](super::closed)). By the divergence theorem, the sum over its
//! triangles
//!
//! ```text
//!   V = sum  a . (b x c) / 6
//! ```
//!
//! is its volume. The volume is negative if the polygons run clockwise seen from outside.

use std::collections::HashMap;

use glam::DVec3;
use rayon::prelude::*;

use super::closed::{boundary, key};
use super::sets::Sets;
use super::{dvec3, index};
use crate::scene::{Bounds, Mesh, NONE};

/// A body with less volume than this fraction of its area times its length is a sheet.
const SHEET: f64 = 1e-5;

/// The most outer bodies that are searched for cavities: a file may have a hundred thousand.
const MOST_OUTER: usize = 64;

/// The closed bodies of a mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ClosedBodies {
    /// The number of closed bodies with a volume.
    pub all: usize,
    /// The number of bodies that are inside out. The inner surface of a hollow body does not count.
    pub inside_out: usize,
}

#[derive(Clone, Copy)]
struct Body {
    boundary: u64,
    volume: f64,
    area: f64,
    bounds: Option<Bounds>,
}

impl Body {
    const EMPTY: Self = Self { boundary: 0, volume: 0.0, area: 0.0, bounds: None };

    fn is_inside(&self, other: &Self) -> bool {
        let (Some(own), Some(outer)) = (self.bounds, other.bounds) else { return false };
        own.min.cmpgt(outer.min).all() && own.max.cmplt(outer.max).all()
    }

    fn has_volume(&self) -> bool {
        let length = self.bounds.map_or(0.0, |bounds| bounds.extent().length());
        self.boundary == 0 && self.volume.abs() > SHEET * self.area * length
    }
}

impl Mesh {
    /// Counts the closed bodies, and the bodies that are inside out.
    pub fn closed_bodies(&self) -> ClosedBodies {
        let keys: Vec<u64> = self.shape.positions.par_iter().map(|place| key(*place)).collect();
        let outlines = self.outlines();
        let mut sets = Sets::default();
        sets.reset(keys.len());
        for polygon in 0..self.polygon_count() {
            let vertices = outlines.vertices(polygon);
            vertices.windows(2).for_each(|pair| sets.join(pair[0], pair[1]));
        }
        let mut bodies = self.bodies(&mut sets, &keys);
        let boundary = bodies.iter().fold(0, |sum: u64, body| sum.wrapping_add(body.boundary));
        if boundary == 0 && bodies.iter().any(|body| body.boundary != 0) {
            // All surfaces together are closed, but single bodies are not: the file splits surfaces
            // at seams and has several vertices at one position. These are joined. If some surface
            // is open, they are not, and split bodies count as open.
            let mut first = HashMap::with_capacity(keys.len());
            for (vertex, key) in (0..).zip(&keys) {
                let other = *first.entry(*key).or_insert(vertex);
                sets.join(other, vertex);
            }
            bodies = self.bodies(&mut sets, &keys);
        }
        let solid: Vec<Body> = bodies.into_iter().filter(Body::has_volume).collect();
        // A cavity lies in one of the largest bodies, so only these are searched.
        let mut outer: Vec<&Body> = solid.iter().filter(|body| body.volume > 0.0).collect();
        outer.sort_unstable_by(|a, b| b.volume.total_cmp(&a.volume));
        outer.truncate(MOST_OUTER);
        let is_cavity = |body: &Body| outer.iter().any(|other| body.is_inside(other));
        let inside_out = solid.iter().filter(|body| body.volume < 0.0 && !is_cavity(body)).count();
        ClosedBodies { all: solid.len(), inside_out }
    }

    /// Collects the bodies of these sets of vertices.
    fn bodies(&self, sets: &mut Sets, keys: &[u64]) -> Vec<Body> {
        let outlines = self.outlines();
        let mut numbers = vec![NONE; keys.len()];
        let mut bodies: Vec<Body> = Vec::new();
        for polygon in 0..self.polygon_count() {
            let vertices = outlines.vertices(polygon);
            let number = &mut numbers[sets.first(vertices[0]) as usize];
            if *number == NONE {
                *number = index(bodies.len());
                bodies.push(Body::EMPTY);
            }
            let body = &mut bodies[*number as usize];
            body.boundary = body.boundary.wrapping_add(boundary(vertices, keys));
            body.add(outlines.of(polygon), self.shape.mean);
        }
        bodies
    }

    /// Finds the polygons with all of their file normals on the wrong side, in ascending order.
    pub fn polygons_against_normals(&self) -> Vec<u32> {
        if !self.has_file_normals() {
            return Vec::new();
        }
        let normals = self.polygon_normals();
        let is_against = |polygon: &u32| {
            let own = dvec3(normals[*polygon as usize]);
            self.corners_of(*polygon).all(|corner| {
                let point = self.corners.of_file(corner).map(|point| self.points[point as usize]);
                point.is_some_and(|point| dvec3(point.normal).dot(own) < -1e-6)
            })
        };
        let count = u32::try_from(normals.len()).unwrap_or(u32::MAX);
        let against: Vec<u32> = (0..count).into_par_iter().filter(is_against).collect();
        let has_area = |polygon: &u32| self.without_area().binary_search(polygon).is_err();
        against.into_iter().filter(has_area).collect()
    }
}

impl Body {
    fn add(&mut self, corners: impl Iterator<Item = DVec3> + Clone, about: DVec3) {
        let Some(first) = corners.clone().next() else { return };
        for (b, c) in corners.clone().skip(1).zip(corners.clone().skip(2)) {
            self.volume += (first - about).dot((b - about).cross(c - about)) / 6.0;
            self.area += (b - first).cross(c - first).length() / 2.0;
        }
        let own = Bounds::of(corners);
        self.bounds = match (self.bounds, own) {
            (Some(all), Some(own)) => Some(all.around(&own)),
            (all, own) => all.or(own),
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{MeshSource, Part, SourceCorner};

    const CUBE: [[u32; 4]; 6] =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];

    /// Quads under construction.
    #[derive(Default)]
    struct Quads(MeshSource);

    impl Quads {
        /// Adds a cube with this half-size, centred at `x`.
        fn with_cube(mut self, x: f32, half: f32, outwards: bool) -> Self {
            let before = index(self.0.positions.len());
            for i in 0..8 {
                let [a, b, c] = [0, 1, 2].map(|axis| if i >> axis & 1 == 1 { half } else { -half });
                self.0.positions.push([x + a, b, c]);
            }
            for mut face in CUBE {
                if !outwards {
                    face.reverse();
                }
                self.add_face(face.map(|vertex| vertex + before));
            }
            self
        }

        fn add_face(&mut self, face: [u32; 4]) {
            self.0.push_polygon(&face.map(SourceCorner::bare));
        }

        /// Returns the numbers of bodies, and of bodies inside out.
        fn bodies(mut self) -> [usize; 2] {
            self.0.parts = vec![Part { name: "it".to_owned(), material: None }];
            let ClosedBodies { all, inside_out } = Mesh::new(self.0).unwrap().closed_bodies();
            [all, inside_out]
        }
    }

    #[test]
    fn a_body_inside_out_is_told_from_a_cavity_and_from_an_open_surface() {
        let cube = |outwards| Quads::default().with_cube(0.0, 1.0, outwards);
        assert_eq!(cube(true).bodies(), [1, 0]);
        assert_eq!(cube(false).bodies(), [1, 1]);
        assert_eq!(Quads::default().with_cube(4096.0, 1.0, false).bodies(), [1, 1], "far away");
        assert_eq!(cube(true).with_cube(3.0, 1.0, false).bodies(), [2, 1]);
        assert_eq!(cube(true).with_cube(0.0, 0.5, false).bodies(), [2, 0], "a cavity");
        let mut open = cube(false);
        open.0.corners.truncate(20);
        open.0.arities.pop();
        open.0.polygon_parts.pop();
        assert_eq!(open.bodies(), [0, 0]);
        let mut sheet = Quads::default();
        sheet.0.positions = vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        sheet.add_face([0, 1, 2, 3]);
        sheet.add_face([3, 2, 1, 0]);
        assert_eq!(sheet.bodies(), [0, 0]);
    }

    #[test]
    fn a_body_without_shared_vertices_is_recognised() {
        let mut split = Quads::default();
        for (first, face) in (0..).step_by(4).zip(CUBE) {
            for vertex in face.into_iter().rev() {
                let place = [0, 1, 2].map(|axis| if vertex >> axis & 1 == 1 { 1.0 } else { 0.0 });
                split.0.positions.push(place);
            }
            split.add_face([first, first + 1, first + 2, first + 3]);
        }
        assert_eq!(split.bodies(), [1, 1]);
    }
}

//! Simple shapes, made here: ground, plane, cube, sphere, cylinder, torus.
//!
//! Each is one unit wide and stands around the origin, so that an object's scale is its size. Their
//! vertices lie on the surface that they stand for, and each corner has that surface's own normal,
//! rounded to single precision: flat faces are exact, and a round one lies inside its surface by at
//! most 1 - cos(pi / N) of its radius for N faces around.

use std::f64::consts::TAU;
use std::sync::OnceLock;

use glam::DVec3;

use super::{Crease, LoadOptions, Mesh, MeshSource, Model, Part, Smoothing, SourceCorner};
use crate::base::Shared;
use crate::base::once::get_or_compute;

mod ground;

/// A simple shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Shape {
    /// A disc of diameter 1 in the plane of X and Z, seen from above, which fades out towards its
    /// rim: see `ground`.
    Ground,
    /// A square of side 1 in the plane of X and Z, seen from above.
    Plane,
    /// A cube of side 1.
    Cube,
    /// A ball of diameter 1, its poles along Y.
    Sphere,
    /// A cylinder of diameter 1 and height 1, along Y.
    Cylinder,
    /// A ring about Y of outer diameter 1, whose tube has a diameter of 1/4.
    Torus,
}

/// The number of faces around a round shape.
const AROUND: u32 = 64;

/// The number of faces from pole to pole of a sphere, and around the tube of a torus.
const ALONG: u32 = 32;

/// The distance of the middle of a torus's tube from its axis, and the radius of the tube.
const TORUS: [f64; 2] = [0.375, 0.125];

impl Shape {
    /// All of them, in the order of the menu.
    pub const ALL: [Self; 6] =
        [Self::Ground, Self::Plane, Self::Cube, Self::Sphere, Self::Cylinder, Self::Torus];

    /// Whether it is what other objects stand on: it touches the lowest of them, and is as large as
    /// the scene, or larger.
    #[must_use]
    pub const fn is_ground(self) -> bool {
        match self {
            Self::Ground | Self::Plane => true,
            Self::Cube | Self::Sphere | Self::Cylinder | Self::Torus => false,
        }
    }

    /// Its name, also in scene files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Ground => "ground",
            Self::Plane => "plane",
            Self::Cube => "cube",
            Self::Sphere => "sphere",
            Self::Cylinder => "cylinder",
            Self::Torus => "torus",
        }
    }

    /// The shape with this name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|shape| shape.name() == name)
    }

    /// Its model, which all objects of this shape share.
    #[must_use]
    pub fn model(self) -> Shared<Model> {
        static MODELS: [OnceLock<Shared<Model>>; 6] = [const { OnceLock::new() }; 6];
        let make = || {
            Shared::new(Model {
                name: self.name().to_owned(),
                source: None,
                options: LoadOptions::default(),
                mesh: self.mesh(),
                materials: if self == Self::Ground { ground::materials() } else { Vec::new() },
                edge_color: None,
            })
        };
        get_or_compute(&MODELS[self as usize], make).clone()
    }

    fn mesh(self) -> Mesh {
        let mut builder = Builder::default();
        match self {
            Self::Ground => ground::build(&mut builder),
            Self::Plane => plane(&mut builder),
            Self::Cube => cube(&mut builder),
            Self::Sphere => sphere(&mut builder),
            Self::Cylinder => cylinder(&mut builder),
            Self::Torus => torus(&mut builder),
        }
        builder.mesh(self.name())
    }
}

/// Vertices, texture coordinates, normals and polygons as they are made.
#[derive(Default)]
struct Builder {
    source: MeshSource,
}

impl Builder {
    fn position(&mut self, p: DVec3) -> u32 {
        self.source.positions.push(p.as_vec3().to_array());
        last(self.source.positions.len())
    }

    fn uv(&mut self, u: f64, v: f64) -> u32 {
        self.source.uvs.push(glam::DVec2::new(u, v).as_vec2().to_array());
        last(self.source.uvs.len())
    }

    fn normal(&mut self, n: DVec3) -> u32 {
        self.source.normals.push(n.as_vec3().to_array());
        last(self.source.normals.len())
    }

    /// A polygon of corners (vertex, uv, normal), counter-clockwise as seen from outside.
    fn polygon(&mut self, corners: &[[u32; 3]]) {
        self.source.corners.extend(corners.iter().map(|&[position, uv, normal]| SourceCorner {
            position,
            uv,
            normal,
        }));
        self.source.arities.push(last(corners.len() + 1));
        self.source.polygon_parts.push(0);
    }

    fn mesh(mut self, name: &str) -> Mesh {
        if self.source.parts.is_empty() {
            self.source.parts = vec![Part { name: name.to_owned(), material: None }];
        }
        self.source.smoothing = Smoothing::Crease(Crease::default());
        Mesh::new(self.source).expect("every index of a shape is in range")
    }
}

/// The index of the last of `len` items.
fn last(len: usize) -> u32 {
    u32::try_from(len - 1).expect("a shape has few vertices")
}

/// Sine and cosine of `i` of `n` parts of a turn; exactly 0 where they are.
fn turn(i: u32, n: u32) -> [f64; 2] {
    let angle = TAU * f64::from(i) / f64::from(n);
    [libm::sin(angle), libm::cos(angle)].map(|x| if x.abs() < 1e-15 { 0.0 } else { x })
}

/// `i` of `n` as a fraction.
fn share(i: u32, n: u32) -> f64 {
    f64::from(i) / f64::from(n)
}

/// A square with this middle, whose sides lead from the middle to the right and up.
fn square(builder: &mut Builder, corners: [u32; 4], normal: DVec3) {
    let normal = builder.normal(normal);
    let uvs = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[u, v]| builder.uv(u, v));
    let corner = |i: usize| [corners[i], uvs[i], normal];
    builder.polygon(&[0, 1, 2, 3].map(corner));
}

fn plane(builder: &mut Builder) {
    let corners = [[-0.5, 0.5], [0.5, 0.5], [0.5, -0.5], [-0.5, -0.5]];
    let corners = corners.map(|[x, z]| builder.position(DVec3::new(x, 0.0, z)));
    square(builder, corners, DVec3::Y);
}

fn cube(builder: &mut Builder) {
    // Bit 0 is X, bit 1 is Y, bit 2 is Z.
    let side = |i: u32, bit: u32| f64::from(i >> bit & 1) - 0.5;
    for i in 0..8 {
        builder.position(DVec3::new(side(i, 0), side(i, 1), side(i, 2)));
    }
    for (corners, normal) in [
        ([4, 5, 7, 6], DVec3::Z),
        ([1, 0, 2, 3], DVec3::NEG_Z),
        ([5, 1, 3, 7], DVec3::X),
        ([0, 4, 6, 2], DVec3::NEG_X),
        ([6, 7, 3, 2], DVec3::Y),
        ([0, 1, 5, 4], DVec3::NEG_Y),
    ] {
        square(builder, corners, normal);
    }
}

/// The direction at this longitude and latitude, given by their sines and cosines.
fn direction([east_sin, east_cos]: [f64; 2], [up_sin, up_cos]: [f64; 2]) -> DVec3 {
    DVec3::new(up_cos * east_sin, up_sin, up_cos * east_cos)
}

fn sphere(builder: &mut Builder) {
    // Row 0 is the south pole. Half a turn leads from pole to pole.
    let latitude = |row: u32| {
        let [sin, cos] = turn(row, 2 * ALONG);
        [-cos, sin]
    };
    for row in 0..=ALONG {
        let around = if row == 0 || row == ALONG { 1 } else { AROUND };
        for column in 0..around {
            let normal = direction(turn(column, AROUND), latitude(row));
            builder.position(normal * 0.5);
            builder.normal(normal);
        }
    }
    let vertex = |row: u32, column: u32| match row {
        0 => 0,
        ALONG => 1 + (ALONG - 1) * AROUND,
        _ => 1 + (row - 1) * AROUND + column % AROUND,
    };
    for row in 0..ALONG {
        for column in 0..AROUND {
            let v = [share(row, ALONG), share(row + 1, ALONG)];
            let u = [share(column, AROUND), share(column + 1, AROUND)];
            let middle = f64::midpoint(u[0], u[1]);
            let mut corner = |row: u32, column: u32, u: f64, v: f64| {
                let vertex = vertex(row, column);
                [vertex, builder.uv(u, v), vertex]
            };
            let corners = match row {
                0 => vec![
                    corner(0, 0, middle, v[0]),
                    corner(1, column + 1, u[1], v[1]),
                    corner(1, column, u[0], v[1]),
                ],
                _ if row + 1 == ALONG => vec![
                    corner(row, column, u[0], v[0]),
                    corner(row, column + 1, u[1], v[0]),
                    corner(ALONG, 0, middle, v[1]),
                ],
                _ => vec![
                    corner(row, column, u[0], v[0]),
                    corner(row, column + 1, u[1], v[0]),
                    corner(row + 1, column + 1, u[1], v[1]),
                    corner(row + 1, column, u[0], v[1]),
                ],
            };
            builder.polygon(&corners);
        }
    }
}

fn cylinder(builder: &mut Builder) {
    for column in 0..AROUND {
        let out = direction(turn(column, AROUND), [0.0, 1.0]);
        builder.normal(out);
        builder.position(out * 0.5 - DVec3::Y * 0.5);
        builder.position(out * 0.5 + DVec3::Y * 0.5);
    }
    for column in 0..AROUND {
        let next = (column + 1) % AROUND;
        let u = [share(column, AROUND), share(column + 1, AROUND)];
        let corners = [
            [2 * column, builder.uv(u[0], 0.0), column],
            [2 * next, builder.uv(u[1], 0.0), next],
            [2 * next + 1, builder.uv(u[1], 1.0), next],
            [2 * column + 1, builder.uv(u[0], 1.0), column],
        ];
        builder.polygon(&corners);
    }
    for (top, normal) in [(1, DVec3::Y), (0, DVec3::NEG_Y)] {
        let normal = builder.normal(normal);
        let mut corners: Vec<[u32; 3]> = (0..AROUND)
            .map(|column| {
                // The disc as it is seen from outside, with +X to the right.
                let [x, z] = turn(column, AROUND).map(|x| x * 0.5);
                let up = if top == 1 { -z } else { z };
                [2 * column + top, builder.uv(0.5 + x, 0.5 + up), normal]
            })
            .collect();
        // From +Z towards +X is counter-clockwise as seen from above.
        if top == 0 {
            corners.reverse();
        }
        builder.polygon(&corners);
    }
}

fn torus(builder: &mut Builder) {
    let [middle, tube] = TORUS;
    for row in 0..ALONG {
        for column in 0..AROUND {
            let east = turn(column, AROUND);
            let normal = direction(east, turn(row, ALONG));
            builder.position(direction(east, [0.0, 1.0]) * middle + normal * tube);
            builder.normal(normal);
        }
    }
    for row in 0..ALONG {
        for column in 0..AROUND {
            let mut corner = |right: u32, up: u32| {
                let vertex = (row + up) % ALONG * AROUND + (column + right) % AROUND;
                [vertex, builder.uv(share(column + right, AROUND), share(row + up, ALONG)), vertex]
            };
            let corners = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
            builder.polygon(&corners);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::scene::{dvec3, newell};

    /// The corners of each polygon: positions and normals.
    fn polygons(mesh: &Mesh) -> Vec<Vec<(DVec3, DVec3)>> {
        let count = u32::try_from(mesh.polygon_count()).unwrap();
        let corners = |i: u32| {
            let corner = |c: &crate::scene::Corner| {
                let p = dvec3(mesh.positions()[c.position as usize]);
                (p, dvec3(mesh.points()[c.filed as usize].normal))
            };
            mesh.polygon(i).iter().map(corner).collect()
        };
        (0..count).map(corners).collect()
    }

    fn positions(polygon: &[(DVec3, DVec3)]) -> impl Iterator<Item = DVec3> + Clone {
        polygon.iter().map(|(p, _)| *p)
    }

    /// The volume, by the divergence theorem over fans, and the area.
    fn volume_and_area(mesh: &Mesh) -> (f64, f64) {
        let mut sums = (0.0, 0.0);
        for polygon in polygons(mesh) {
            for pair in polygon.windows(2).skip(1) {
                sums.0 += polygon[0].0.dot(pair[0].0.cross(pair[1].0)) / 6.0;
            }
            sums.1 += newell(positions(&polygon)).length() / 2.0;
        }
        sums
    }

    fn close(found: f64, wanted: f64, error: f64) {
        assert!((found / wanted - 1.0).abs() < error, "{found} instead of {wanted}");
    }

    #[test]
    fn every_shape_is_one_unit_wide_about_the_origin_and_closed_but_for_grounds() {
        for shape in Shape::ALL {
            let model = shape.model();
            let bounds = model.mesh.bounds().unwrap();
            let height = match shape {
                Shape::Ground | Shape::Plane => 0.0,
                Shape::Torus => 0.25,
                Shape::Cube | Shape::Sphere | Shape::Cylinder => 1.0,
            };
            assert_eq!(bounds.extent(), DVec3::new(1.0, height, 1.0), "{shape:?}");
            assert_eq!(bounds.centre(), DVec3::ZERO, "{shape:?}");
            assert_eq!(model.mesh.is_closed(), !shape.is_ground(), "{shape:?}");
            assert_eq!(Shape::named(shape.name()), Some(shape));
        }
    }

    #[test]
    fn volumes_and_areas_are_those_of_the_solids() {
        let of = |shape: Shape| volume_and_area(&shape.model().mesh);
        assert_eq!(of(Shape::Plane).1, 1.0);
        assert_eq!(of(Shape::Cube), (1.0, 6.0));
        // A regular polygon of N sides in a circle: N / 2 sin(2 pi / N) r^2, and 2 N sin(pi / N) r.
        let n = f64::from(AROUND);
        let base = n / 2.0 * (2.0 * PI / n).sin() / 4.0;
        let (volume, area) = of(Shape::Cylinder);
        close(volume, base, 1e-6);
        close(area, 2.0 * base + n * (PI / n).sin(), 1e-6);
        // What is inscribed is smaller, by about (pi / N)^2.
        let (volume, area) = of(Shape::Sphere);
        close(volume, PI / 6.0, 0.009);
        close(area, PI, 0.006);
        assert!(volume < PI / 6.0 && area < PI);
        let [middle, tube] = TORUS;
        let (volume, area) = of(Shape::Torus);
        close(volume, 2.0 * PI * PI * middle * tube * tube, 0.009);
        close(area, 4.0 * PI * PI * middle * tube, 0.006);
    }

    #[test]
    fn normals_are_those_of_the_surface_and_faces_look_outwards() {
        for shape in Shape::ALL {
            for polygon in polygons(&shape.model().mesh) {
                let facing = newell(positions(&polygon)).normalize_or_zero();
                for (p, n) in &polygon {
                    assert!((n.length() - 1.0).abs() < 1e-6, "{shape:?}");
                    assert!(facing.dot(*n) > 0.99, "{shape:?}: {facing} and {n} at {p}");
                    let ring = DVec3::new(p.x, 0.0, p.z).normalize_or_zero();
                    let exact = match shape {
                        Shape::Sphere => p.normalize_or_zero(),
                        Shape::Torus => (*p - ring * TORUS[0]).normalize_or_zero(),
                        Shape::Cylinder if n.y.abs() < 0.5 => ring,
                        Shape::Ground | Shape::Plane | Shape::Cube | Shape::Cylinder => facing,
                    };
                    assert!((exact - *n).length() < 1e-6, "{shape:?}: {n} instead of {exact}");
                }
            }
        }
    }

    #[test]
    fn texture_coordinates_run_once_over_every_shape() {
        for shape in Shape::ALL {
            let mesh = &shape.model().mesh;
            for axis in 0..2 {
                let all = mesh.uvs().iter().map(|uv| uv[axis]);
                assert_eq!(all.clone().fold(1.0, f32::min), 0.0, "{shape:?}");
                assert_eq!(all.fold(0.0, f32::max), 1.0, "{shape:?}");
            }
            // Seen from outside, the picture is not mirrored.
            let corners: Vec<[f64; 2]> = mesh
                .polygon(0)
                .iter()
                .map(|corner| mesh.uvs()[corner.uv as usize].map(f64::from))
                .collect();
            let flat = corners.iter().map(|[u, v]| DVec3::new(*u, *v, 0.0));
            assert!(newell(flat).z > 0.0, "{shape:?}");
        }
    }
}

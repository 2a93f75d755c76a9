//! The polygons of plane, cube, sphere, cylinder and torus.
//!
//! Polygons are counter-clockwise as seen from outside. The texture wraps once around each round
//! shape.

use std::f64::consts::TAU;

use glam::DVec3;

use crate::scene::{Crease, Mesh, MeshSource, Part, Smoothing, SourceCorner};

/// The number of faces around a round shape.
pub(super) const AROUND: u32 = 64;

/// The number of faces from pole to pole of a sphere, and around the tube of a torus.
const ALONG: u32 = 32;

/// The distance from a torus's axis to the centre of its tube, and the radius of the tube.
pub(super) const TORUS: [f64; 2] = [0.375, 0.125];

/// Vertices, texture coordinates, normals and polygons under construction.
pub(super) struct Builder {
    pub(super) source: MeshSource,
    /// The width of the shape.
    size: f64,
}

impl Builder {
    pub(super) fn new(size: f64) -> Self {
        Self { source: MeshSource::default(), size }
    }

    /// Adds a vertex of the shape that is one unit wide.
    pub(super) fn position(&mut self, p: DVec3) -> u32 {
        self.source.positions.push((p * self.size).as_vec3().to_array());
        last(self.source.positions.len())
    }

    pub(super) fn uv(&mut self, u: f64, v: f64) -> u32 {
        self.source.uvs.push(glam::DVec2::new(u, v).as_vec2().to_array());
        last(self.source.uvs.len())
    }

    pub(super) fn normal(&mut self, n: DVec3) -> u32 {
        self.source.normals.push(n.as_vec3().to_array());
        last(self.source.normals.len())
    }

    /// Adds a polygon of corners (vertex, uv, normal), counter-clockwise as seen from outside.
    pub(super) fn polygon(&mut self, corners: &[[u32; 3]]) {
        let corner = |&[position, uv, normal]: &[u32; 3]| SourceCorner { position, uv, normal };
        self.source.push_polygon(&corners.iter().map(corner).collect::<Vec<_>>());
    }

    pub(super) fn mesh(mut self, name: &str) -> Mesh {
        if self.source.parts.is_empty() {
            self.source.parts = vec![Part { name: name.to_owned(), material: None }];
        }
        self.source.smoothing = Smoothing::Crease(Crease::default());
        Mesh::new(self.source).expect("every index of a shape is in range")
    }
}

/// Returns the index of the last of `len` items.
fn last(len: usize) -> u32 {
    u32::try_from(len - 1).expect("a shape has few vertices")
}

/// Returns sine and cosine of `i` / `n` of a turn; zeros are exact.
pub(super) fn turn(i: u32, n: u32) -> [f64; 2] {
    let angle = TAU * f64::from(i) / f64::from(n);
    [libm::sin(angle), libm::cos(angle)].map(|x| if x.abs() < 1e-15 { 0.0 } else { x })
}

/// Returns `i` / `n` as a number.
fn share(i: u32, n: u32) -> f64 {
    f64::from(i) / f64::from(n)
}

/// Adds a square; `corners` run counter-clockwise from the lower left corner of the texture.
fn square(builder: &mut Builder, corners: [u32; 4], normal: DVec3) {
    let normal = builder.normal(normal);
    let uvs = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[u, v]| builder.uv(u, v));
    let corner = |i: usize| [corners[i], uvs[i], normal];
    builder.polygon(&[0, 1, 2, 3].map(corner));
}

pub(super) fn plane(builder: &mut Builder) {
    let corners = [[-0.5, 0.5], [0.5, 0.5], [0.5, -0.5], [-0.5, -0.5]];
    let corners = corners.map(|[x, z]| builder.position(DVec3::new(x, 0.0, z)));
    square(builder, corners, DVec3::Y);
}

pub(super) fn cube(builder: &mut Builder) {
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

/// Returns the direction at a longitude and a latitude, given by their sines and cosines.
fn direction([east_sin, east_cos]: [f64; 2], [up_sin, up_cos]: [f64; 2]) -> DVec3 {
    DVec3::new(up_cos * east_sin, up_sin, up_cos * east_cos)
}

pub(super) fn sphere(builder: &mut Builder) {
    // Row 0 is the south pole; half a turn leads to the north pole.
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
    // A pole is one vertex, shared by all columns.
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
            // The rows at the poles are triangles, with u at the middle of the column.
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

pub(super) fn cylinder(builder: &mut Builder) {
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
                // The disc seen from outside, with +X to the right.
                let [x, z] = turn(column, AROUND).map(|x| x * 0.5);
                let up = if top == 1 { -z } else { z };
                [2 * column + top, builder.uv(0.5 + x, 0.5 + up), normal]
            })
            .collect();
        // From +Z towards +X is counter-clockwise seen from above.
        if top == 0 {
            corners.reverse();
        }
        builder.polygon(&corners);
    }
}

pub(super) fn torus(builder: &mut Builder) {
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

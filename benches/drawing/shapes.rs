//! The meshes of the benchmarks: each stresses a different part of the renderer.

use std::f64::consts::TAU;

use glam::DVec3;
use marraztu_core::base::{Shared, math};
use marraztu_core::scene::{Mesh, MeshSource, Model, NONE, Part, SourceCorner};

/// A mesh with a name.
pub(crate) struct Shape {
    pub(crate) name: &'static str,
    pub(crate) model: Shared<Model>,
}

/// Returns one triangle over the whole view; few triangles of about a hundred pixels; many of a few
/// pixels; many smaller than a pixel; slivers; and large triangles that overlap back to front.
pub(crate) fn all() -> Vec<Shape> {
    let shape = |name, model| Shape { name, model };
    vec![
        shape("one", sheet(1)),
        shape("sheet-2k", sheet(2_000)),
        shape("knot-70k", knot(70_000)),
        shape("knot-1m", knot(1_000_000)),
        shape("slivers-1k", slivers(1_000)),
        shape("layers-64", layers(64)),
    ]
}

/// Builds a wavy sheet of `count` triangles that covers the square from -1 to 1, facing +Z. A
/// single triangle covers the whole square and extends beyond it.
pub(crate) fn sheet(count: u32) -> Shared<Model> {
    if count == 1 {
        return model(vec![[-3.0, -1.0, 0.0], [3.0, -1.0, 0.0], [0.0, 5.0, 0.0]], &[[0, 1, 2]]);
    }
    let side = f64::from(count.div_ceil(2)).sqrt().ceil();
    let wave = |x: f64, y: f64| 0.05 * (7.0 * x).sin() * (5.0 * y).cos();
    let at = |u: f64, v: f64| DVec3::new(2.0 * u - 1.0, 2.0 * v - 1.0, wave(u, v));
    let mut grid = grid([side, side], at);
    grid.1.truncate(count as usize);
    model(grid.0, &grid.1)
}

/// Builds the (2, 3) torus knot as a tube of about `count` triangles, as wide as the square from -1
/// to 1.
pub(crate) fn knot(count: u32) -> Shared<Model> {
    let around = (f64::from(count) / 40.0).sqrt().ceil();
    let along = (f64::from(count) / (2.0 * around)).ceil();
    let unit = |v| math::unit(v).expect("the knot is never steep");
    let curve = |t: f64| {
        let r = 2.0 + (3.0 * t).cos();
        DVec3::new(r * (2.0 * t).cos(), r * (2.0 * t).sin(), (3.0 * t).sin()) / 3.6
    };
    let at = |u: f64, v: f64| {
        let (t, angle) = (TAU * u, TAU * v);
        let tangent = unit(curve(t + 1e-4) - curve(t - 1e-4));
        let side = unit(tangent.cross(DVec3::Z));
        let up = side.cross(tangent);
        curve(t) + 0.12 * (side * angle.cos() + up * angle.sin())
    };
    let (positions, triangles) = grid([along, around], at);
    model(positions, &triangles)
}

/// Builds `count` triangles that share a corner, each 1 / `count` of a turn wide.
fn slivers(count: u32) -> Shared<Model> {
    let rim = |i: u32| {
        let angle = TAU * f64::from(i) / f64::from(count);
        narrow(DVec3::new(angle.cos(), angle.sin(), 0.0))
    };
    let positions = std::iter::once([0.0; 3]).chain((0..count).map(rim)).collect();
    let triangles: Vec<_> = (0..count).map(|i| [0, 1 + i, 1 + (i + 1) % count]).collect();
    model(positions, &triangles)
}

/// Builds `count` triangles over the whole view, the farthest first: only the last is visible.
pub(crate) fn layers(count: u32) -> Shared<Model> {
    let depth = |i: u32| f64::from(i) / f64::from(count) - 1.0;
    let corners = [DVec3::new(-3.0, -1.0, 0.0), DVec3::new(3.0, -1.0, 0.0), DVec3::Y * 5.0];
    let layer = |i: u32| corners.map(|corner| narrow(corner + DVec3::Z * depth(i)));
    let positions = (0..count).flat_map(layer).collect();
    let triangles: Vec<_> = (0..count).map(|i| [0, 1, 2].map(|corner| 3 * i + corner)).collect();
    model(positions, &triangles)
}

/// Builds a sheet of `count` triangles with texture coordinates and vertex colours.
pub(crate) fn painted(count: u32) -> Shared<Model> {
    placed(count, |[u, v]| Some([u, v, 1.0]))
}

/// Builds a sheet of `count` triangles with texture coordinates.
pub(crate) fn textured(count: u32) -> Shared<Model> {
    placed(count, |_| None)
}

fn placed(count: u32, color: impl Fn([f32; 2]) -> Option<[f32; 3]>) -> Shared<Model> {
    let plain = sheet(count);
    let mesh = &plain.mesh;
    let across = |place: &[f32; 3]| [place[0], place[1]].map(|x| x / 2.0 + 0.5);
    let (positions, corners) = (mesh.positions(), mesh.corners());
    build(MeshSource {
        uvs: positions.iter().map(across).collect(),
        colors: positions.iter().filter_map(|place| color(across(place))).collect(),
        corners: corners
            .iter()
            .map(|corner| SourceCorner { uv: corner.position, ..plainly(corner.position) })
            .collect(),
        positions: positions.to_vec(),
        ..faces(mesh.triangles().len())
    })
}

type Triangles = (Vec<[f32; 3]>, Vec<[u32; 3]>);

/// Builds a surface over the unit square from cells of two triangles.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "small whole numbers")]
fn grid([columns, rows]: [f64; 2], at: impl Fn(f64, f64) -> DVec3) -> Triangles {
    let [width, height] = [columns, rows].map(|n| n as u32);
    let place = |i: u32| {
        let (u, v) = (f64::from(i % (width + 1)) / columns, f64::from(i / (width + 1)) / rows);
        narrow(at(u, v))
    };
    let cell = |i: u32| {
        let a = i / width * (width + 1) + i % width;
        let (b, c, d) = (a + 1, a + width + 2, a + width + 1);
        [[a, b, c], [a, c, d]]
    };
    let positions = (0..(width + 1) * (height + 1)).map(place).collect();
    (positions, (0..width * height).flat_map(cell).collect())
}

fn narrow(place: DVec3) -> [f32; 3] {
    place.as_vec3().to_array()
}

fn model(positions: Vec<[f32; 3]>, triangles: &[[u32; 3]]) -> Shared<Model> {
    let corners = triangles.as_flattened().iter().copied().map(plainly).collect();
    build(MeshSource { positions, corners, ..faces(triangles.len()) })
}

fn plainly(position: u32) -> SourceCorner {
    SourceCorner { position, uv: NONE, normal: NONE }
}

/// Returns the faces of `count` triangles, all in one part.
fn faces(count: usize) -> MeshSource {
    MeshSource {
        arities: vec![3; count],
        polygon_parts: vec![0; count],
        parts: vec![Part { name: "all".to_owned(), material: None }],
        ..MeshSource::default()
    }
}

fn build(source: MeshSource) -> Shared<Model> {
    Shared::new(Model::of_mesh("shape", Mesh::new(source).expect("shapes are meshes")))
}

//! The models of a BOP data set: `models/obj_000001.ply` in millimetres and `models_info.json`.
//!
//! Source: `bop_datasets_format.md` of bop_toolkit.

use std::fmt::Write as _;

use glam::{DMat3, DVec3};
use marraztu_core::scene::{Mesh, Model};
use serde_json::{Value, json};

use super::dataset::upright;

/// Millimetres per unit.
pub(super) const MILLIMETRES: f64 = 1000.0;

/// A model with the axes of its file, in millimetres.
pub(super) struct BopModel {
    /// The vertices that its triangles use.
    points: Vec<DVec3>,
    /// Red, green and blue of these vertices; empty if the file has no colours.
    colors: Vec<[f32; 3]>,
    triangles: Vec<[u32; 3]>,
}

impl BopModel {
    pub(super) fn new(model: &Model) -> Self {
        let mesh: &Mesh = &model.mesh;
        let file_from_object = DMat3::from_mat4(upright(model.options.up)).transpose();
        let mut numbers = vec![u32::MAX; mesh.positions().len()];
        let (mut used, mut triangles) = (Vec::new(), Vec::new());
        for triangle in 0..mesh.triangle_count() {
            triangles.push(mesh.triangle(triangle).map(|corner| {
                let vertex = mesh.vertex_of(corner) as usize;
                if numbers[vertex] == u32::MAX {
                    numbers[vertex] = u32::try_from(used.len()).unwrap_or(u32::MAX);
                    used.push(vertex);
                }
                numbers[vertex]
            }));
        }
        let point = |vertex: &usize| {
            let place = DVec3::from_array(mesh.positions()[*vertex].map(f64::from));
            file_from_object * (place + mesh.offset()) * MILLIMETRES
        };
        let points = used.iter().map(point).collect();
        let color = |vertex: &usize| mesh.colors().get(*vertex).copied();
        Self { points, colors: used.iter().filter_map(color).collect(), triangles }
    }

    /// Encodes the model as binary PLY.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "PLY has f32, and bytes of colours from 0 to 1"
    )]
    pub(super) fn ply(&self) -> Vec<u8> {
        let mut head = "ply\nformat binary_little_endian 1.0\n".to_owned();
        // Writing to a string cannot fail.
        let _ = writeln!(head, "element vertex {}", self.points.len());
        head += "property float x\nproperty float y\nproperty float z\n";
        if !self.colors.is_empty() {
            head += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
        }
        let _ = writeln!(head, "element face {}", self.triangles.len());
        head += "property list uchar int vertex_indices\nend_header\n";
        let mut bytes = head.into_bytes();
        for (i, point) in self.points.iter().enumerate() {
            let place = point.to_array().map(|x| (x as f32).to_le_bytes());
            bytes.extend_from_slice(place.as_flattened());
            let color = self.colors.get(i);
            bytes.extend(color.into_iter().flatten().map(|it| (it * 255.0).round() as u8));
        }
        for triangle in &self.triangles {
            bytes.push(3);
            bytes.extend_from_slice(triangle.map(u32::to_le_bytes).as_flattened());
        }
        bytes
    }

    /// Returns the entry of `models_info.json`: the box and the diameter, in millimetres.
    pub(super) fn info(&self) -> Value {
        let low = self.points.iter().fold(DVec3::INFINITY, |low, point| low.min(*point));
        let high = self.points.iter().fold(DVec3::NEG_INFINITY, |high, point| high.max(*point));
        let (low, size) = match self.points.is_empty() {
            true => (DVec3::ZERO, DVec3::ZERO),
            false => (low, high - low),
        };
        json!({
            "diameter": diameter(&self.points),
            "min_x": low.x, "min_y": low.y, "min_z": low.z,
            "size_x": size.x, "size_y": size.y, "size_z": size.z,
        })
    }
}

/// The most points that are compared pair by pair.
const MOST: usize = 4096;

/// The directions in which more points are searched for the farthest ones. They are at most 0.08
/// radians from any direction, so a diameter is at most 0.3% too small.
const DIRECTIONS: u32 = 1024;

/// Returns the largest distance of two points. It is exact unless thousands of points could be the
/// farthest ones, as on a ball.
fn diameter(points: &[DVec3]) -> f64 {
    let Some(first) = points.first() else { return 0.0 };
    let farthest_from = |from: DVec3| {
        let distance = |point: &&DVec3| from.distance_squared(**point);
        points.iter().max_by(|a, b| distance(a).total_cmp(&distance(b))).copied().unwrap_or(from)
    };
    // Two sweeps find a long distance.
    let one = farthest_from(*first);
    let mut best = one.distance(farthest_from(one));
    let centre = points.iter().sum::<DVec3>() / points.len() as f64;
    let radius = farthest_from(centre).distance(centre);
    // Points near the centre are no ends of a longer one.
    let is_far = |point: &&DVec3| point.distance(centre) + radius >= best;
    let mut far: Vec<DVec3> = points.iter().filter(is_far).copied().collect();
    if far.len() > MOST {
        far = (0..DIRECTIONS)
            .flat_map(|i| {
                let along = direction(i);
                let by = |a: &&DVec3, b: &&DVec3| along.dot(**a).total_cmp(&along.dot(**b));
                [far.iter().min_by(by), far.iter().max_by(by)]
            })
            .flatten()
            .copied()
            .collect();
    }
    for (i, a) in far.iter().enumerate() {
        for b in &far[..i] {
            best = best.max(a.distance(*b));
        }
    }
    best
}

/// Returns a direction of a spiral that fills the half of the sphere above 0 evenly.
fn direction(i: u32) -> DVec3 {
    let z = (f64::from(i) + 0.5) / f64::from(DIRECTIONS);
    let golden = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    let (sin, cos) = libm::sincos(golden * f64::from(i));
    let across = (1.0 - z * z).sqrt();
    DVec3::new(across * cos, across * sin, z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use marraztu_core::base::rng::Rng;

    #[test]
    fn the_diameter_is_the_largest_distance() {
        let mut rng = Rng::new(3);
        for round in 0..40 {
            let size = DVec3::new(1.0, rng.real(0.1, 2.0), rng.real(0.1, 2.0));
            let points: Vec<DVec3> = (0..round * 5).map(|_| rng.vector(10.0) * size).collect();
            let all = points.iter().flat_map(|a| points.iter().map(|b| a.distance(*b)));
            let most = all.fold(0.0, f64::max);
            assert_eq!(diameter(&points), most, "{round}");
        }
        // On a ball, any point could be an end.
        let ball: Vec<DVec3> = (0..20_000)
            .map(|_| rng.vector(1.0).try_normalize().unwrap_or(DVec3::X) * 50.0)
            .collect();
        let found = diameter(&ball);
        assert!((99.7..=100.0 + 1e-9).contains(&found), "{found}");
    }
}

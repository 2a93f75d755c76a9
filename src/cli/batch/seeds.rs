//! Seed points of a data set for Gaussian splatting: `points3d.ply`.
//!
//! Training starts with points on surfaces, which other pipelines take from structure from motion.
//! Here the surfaces are known: points are spread evenly over them. The reader of NeRF's synthetic
//! scenes in 3D Gaussian Splatting looks for a file of this name and these properties, and
//! nerfstudio reads the file that `ply_file_path` names.

use std::fs::File;
use std::io::Read as _;
use std::path::Path;

use glam::{DMat4, DVec3};
use marraztu_core::scene::{Object, Scene, Surface, Texture, Wrap};

/// The name of the file.
pub(super) const SEED_POINTS: &str = "points3d.ply";

/// The line that distinguishes the file from those of other programs.
const COMMENT: &str = "comment seed points of marraztu batch";

const HEAD: &str = "property float x\nproperty float y\nproperty float z\nproperty float nx\n\
    property float ny\nproperty float nz\nproperty uchar red\nproperty uchar green\n\
    property uchar blue\nend_header\n";

/// Encodes points on the shown surfaces of a scene as binary PLY, in world space, with the normals
/// of their faces and the colours of the surface: Kd times texel, tint and vertex colour. Surfaces
/// get points in proportion to their area, the same ones in every run.
pub(super) fn ply(scene: &Scene, time: f64, count: u32) -> Vec<u8> {
    let surfaces: Vec<SeedSurface<'_>> = scene
        .objects
        .iter()
        .filter(|(_, object)| object.visible)
        .map(|(_, object)| SeedSurface { object, world_from_mesh: object.world_from_mesh(time) })
        .collect();
    // The sums of the areas of all triangles up to each one.
    let (mut faces, mut sum) = (Vec::new(), 0.0);
    for (number, surface) in surfaces.iter().enumerate() {
        for triangle in surface.shown_triangles() {
            let [a, b, c] = surface.corners(triangle);
            let area = (b - a).cross(c - a).length();
            if area.is_finite() && area > 0.0 {
                sum += area;
                faces.push((sum, number, triangle));
            }
        }
    }
    let count = if faces.is_empty() { 0 } else { count };
    let begin = format!("ply\nformat binary_little_endian 1.0\n{COMMENT}\n");
    let mut bytes = format!("{begin}element vertex {count}\n{HEAD}").into_bytes();
    for i in 0..count {
        // One point in each of `count` parts of equal area.
        let at = (f64::from(i) + 0.5) / f64::from(count) * sum;
        let face = faces.partition_point(|(end, ..)| *end <= at).min(faces.len() - 1);
        let (_, surface, triangle) = faces[face];
        let point = surfaces[surface].point(triangle, weights(i));
        #[expect(clippy::cast_possible_truncation, reason = "PLY has f32")]
        let numbers = [point.at, point.normal].map(|v| v.to_array().map(|x| x as f32));
        bytes.extend(numbers.as_flattened().iter().flat_map(|x| x.to_le_bytes()));
        bytes.extend(point.color);
    }
    bytes
}

/// Returns whether a file is of another program, and must not be replaced.
pub(super) fn is_of_another(path: &Path) -> bool {
    let Ok(file) = File::open(path) else { return false };
    let mut begin = Vec::new();
    // A file that cannot be read is not known to be ours.
    let is_read = file.take(256).read_to_end(&mut begin).is_ok();
    !is_read || !begin.windows(COMMENT.len()).any(|part| part == COMMENT.as_bytes())
}

/// A point of a surface.
struct SeedPoint {
    at: DVec3,
    normal: DVec3,
    color: [u8; 3],
}

/// An object and its placement.
struct SeedSurface<'a> {
    object: &'a Object,
    world_from_mesh: DMat4,
}

impl SeedSurface<'_> {
    fn shown_triangles(&self) -> impl Iterator<Item = u32> {
        let mesh = &self.object.model.mesh;
        let count = u32::try_from(mesh.triangle_count()).unwrap_or(u32::MAX);
        (0..count).filter(|triangle| self.object.shows_part(self.part(*triangle)))
    }

    fn part(&self, triangle: u32) -> u32 {
        let mesh = &self.object.model.mesh;
        mesh.polygon_parts()[mesh.polygon_of(triangle) as usize]
    }

    fn corners(&self, triangle: u32) -> [DVec3; 3] {
        let mesh = &self.object.model.mesh;
        mesh.triangle(triangle as usize)
            .map(|corner| self.world_from_mesh.transform_point3(mesh.corner_position(corner)))
    }

    /// Returns the point of a triangle with these weights of its corners.
    fn point(&self, triangle: u32, weights: [f64; 3]) -> SeedPoint {
        let mesh = &self.object.model.mesh;
        let [a, b, c] = self.corners(triangle);
        // A mirrored object turns its triangles around.
        let side = self.world_from_mesh.determinant().signum();
        let normal = ((b - a).cross(c - a) * side).normalize_or_zero();
        let look = self.object.part_look(self.part(triangle));
        let mixed = |values: [[f32; 3]; 3]| -> [f64; 3] {
            std::array::from_fn(|i| (0..3).map(|k| f64::from(values[k][i]) * weights[k]).sum())
        };
        // The texture may replace the material, or the material the texture.
        let Object { surface, tint, .. } = self.object;
        let mut color = match surface {
            Surface::Texture => [1.0; 3],
            Surface::Material | Surface::TextureAndLight => look.material.diffuse,
        };
        let is_tinted = *surface != Surface::Material;
        let tint = if is_tinted { tint.factors() } else { [1.0; 3] };
        let uvs = mesh.triangle_uvs(triangle).map(|uvs| mixed(uvs.map(|[u, v]| [u, v, 0.0])));
        let texel = uvs.and_then(|[u, v, _]| texel(look.texture?, [u, v]));
        let shows_colors = look.shows_colors_with(look.texture.filter(|_| uvs.is_some()));
        let own = match is_tinted && shows_colors && !mesh.colors().is_empty() {
            true => mixed(mesh.triangle_colors(triangle)),
            false => [1.0; 3],
        };
        for i in 0..3 {
            color[i] *= tint[i] * own[i] * texel.map_or(1.0, |texel| texel[i]);
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 255")]
        let color = color.map(|part| (part.clamp(0.0, 1.0) * 255.0).round() as u8);
        SeedPoint { at: a * weights[0] + b * weights[1] + c * weights[2], normal, color }
    }
}

/// Returns the texel of a texture at a uv, as factors; `None` without texels.
fn texel(texture: &Texture, uv: [f64; 2]) -> Option<[f64; 3]> {
    let size = texture.picture.size();
    let place = |axis: usize, side: usize| -> Option<usize> {
        let own = uv[axis] * texture.scale[axis] + texture.offset[axis];
        let own = match texture.wrap {
            Wrap::Repeat => own - own.floor(),
            Wrap::Clamp => own.clamp(0.0, 1.0),
        };
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            clippy::cast_precision_loss,
            reason = "up to the side of a picture; NaN is 0"
        )]
        let at = (own * side as f64) as usize;
        Some(at.min(side.checked_sub(1)?))
    };
    let (column, row) = (place(0, size.width)?, place(1, size.height)?);
    let [r, g, b, _] = texture.picture.pixel(column, size.height - 1 - row);
    Some([r, g, b].map(|byte| f64::from(byte) / 255.0))
}

/// Returns the weights of a point in its triangle, of an evenly spread sequence: Roberts, "The
/// Unreasonable Effectiveness of Quasirandom Sequences", 2018.
fn weights(i: u32) -> [f64; 3] {
    // The powers of 1 / 1.3247..., the plastic number.
    let [u, v] = [0.754_877_666_246_692_8, 0.569_840_290_998_053_3]
        .map(|step| (0.5 + step * f64::from(i)).fract());
    // The far half of the square is folded onto the near one.
    let [u, v] = if u + v > 1.0 { [1.0 - u, 1.0 - v] } else { [u, v] };
    [1.0 - u - v, u, v]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_fill_the_triangle_evenly() {
        let mut quarters = [0; 4];
        for i in 0..4000 {
            let all = weights(i);
            assert!(all.iter().all(|weight| (0.0..=1.0).contains(weight)), "{all:?}");
            // The corner quarters, and the middle one.
            quarters[all.iter().position(|weight| *weight > 0.5).unwrap_or(3)] += 1;
        }
        assert!(quarters.iter().all(|count| (990..=1010).contains(count)), "{quarters:?}");
    }
}

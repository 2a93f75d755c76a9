//! The surfaces in front of the observer: the first one along a ray, and the nearest depth in view.
//!
//! Both count the faces that the picture shows, without hidden parts and culled back faces. A
//! picture knows the same, but it may be older than the camera's pose.

use glam::{DMat4, DVec2, DVec3};
use rayon::prelude::*;

use crate::base::image::Size;
use crate::scene::{Fill, MapKind, Object, ObjectId, Scene, Texture, Triangle, View, Wrap, dvec3};

/// A place where a ray meets a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Meeting {
    /// The distance from the start of the ray, as a multiple of its direction.
    pub(super) way: f64,
    /// The largest extent of the object.
    pub(super) extent: f64,
}

/// A ray in the world.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ray {
    pub(super) from: DVec3,
    pub(super) along: DVec3,
}

/// Returns the first filled and opaque surface along a ray, at least `least` times its direction
/// away.
pub(super) fn first_along(scene: &Scene, view: &View, ray: Ray, least: f64) -> Option<Meeting> {
    let shown = shown(scene, view).filter(|_| view.fill == Fill::Filled);
    let met = shown.filter_map(|(id, object)| {
        let way = first_of(object, view, id, ray, least)?;
        Some(Meeting { way, extent: object.largest_extent() })
    });
    met.min_by(|a, b| a.way.total_cmp(&b.way))
}

/// Returns the depth of the nearest point that a picture of this size shows or would show without
/// its near plane, if it is below `below`. Otherwise returns a depth that is at most the nearest,
/// and at least `below`. Infinite if nothing is in view.
pub(super) fn nearest_depth(scene: &Scene, view: &View, size: Size, below: f64) -> f64 {
    let frame = scene.observer_frame(view);
    let lens = scene.selected_camera(view).lens;
    let [width, height] = [size.width, size.height].map(|side| side.max(1));
    #[expect(clippy::cast_precision_loss, reason = "pictures have fewer than 2^53 pixels a side")]
    let sides = DVec2::new(width as f64, height as f64) / width.min(height) as f64;
    let frustum = Frustum {
        view_from_world: frame.inverse(),
        slopes: sides * libm::tan(lens.half_angle.to_radians()),
    };
    let depths = shown(scene, view).map(|(id, object)| {
        let box_depth = frustum.depth_of_box(object, view.time);
        if box_depth >= below { box_depth } else { frustum.depth_of(object, view, id).max(0.0) }
    });
    depths.fold(f64::INFINITY, f64::min)
}

/// Lists the objects that the view shows.
fn shown<'a>(scene: &'a Scene, view: &'a View) -> impl Iterator<Item = (ObjectId, &'a Object)> {
    scene.objects.iter().filter(|(id, object)| view.shows(*id, object))
}

/// Returns whether the view draws a triangle of an object.
fn draws(view: &View, id: ObjectId, object: &Object, triangle: &Triangle) -> bool {
    let in_mode = match view.polygons.as_ref().filter(|_| view.object == Some(id)) {
        None => true,
        Some(mode) if view.polygons_stay => mode.shown.contains(&triangle.polygon),
        Some(mode) => mode.current == triangle.polygon,
    };
    in_mode && object.shows_part(part_of(object, triangle))
}

fn part_of(object: &Object, triangle: &Triangle) -> u32 {
    object.model.mesh.polygon_parts().get(triangle.polygon as usize).copied().unwrap_or(0)
}

/// Returns the corners of a triangle in the space of the mesh.
fn corners_of(object: &Object, triangle: &Triangle) -> [DVec3; 3] {
    let mesh = &object.model.mesh;
    let position = |corner: u32| mesh.corners()[corner as usize].position as usize;
    triangle.corners.map(|corner| dvec3(mesh.positions()[position(corner)]))
}

fn first_of(object: &Object, view: &View, id: ObjectId, ray: Ray, least: f64) -> Option<f64> {
    let mesh = &object.model.mesh;
    let mesh_from_world = object.world_from_mesh(view.time).inverse();
    let from = mesh_from_world.transform_point3(ray.from);
    let along = mesh_from_world.transform_vector3(ray.along);
    let bounds = mesh.bounds().filter(|_| from.is_finite() && along.is_finite())?;
    // The ray misses the box if it leaves one pair of sides before it enters another.
    let (a, b) = ((bounds.min - from) / along, (bounds.max - from) / along);
    if a.min(b).max_element().max(least) > a.max(b).min_element() {
        return None;
    }
    let shows_back = object.is_two_sided() || view.back_faces;
    let meet = |triangle: &Triangle| {
        let [p, q, r] = corners_of(object, triangle);
        let (way, weights) = meeting([from, along], [p, q, r], shows_back)?;
        let is_met = way >= least && draws(view, id, object, triangle);
        (is_met && is_opaque(object, triangle, weights)).then_some(way)
    };
    let ways = mesh.triangles().par_iter().filter_map(meet);
    ways.min_by(f64::total_cmp)
}

/// Intersects a ray, given by its start and direction, with a triangle. Returns the distance and
/// the barycentric weights of the point. Back faces count if `shows_back`.
///
/// The method is from Moller and Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection", 1997.
fn meeting(
    [from, along]: [DVec3; 2],
    [p, q, r]: [DVec3; 3],
    shows_back: bool,
) -> Option<(f64, DVec3)> {
    let (a, b) = (q - p, r - p);
    let across = along.cross(b);
    let volume = a.dot(across);
    if volume == 0.0 || (volume < 0.0 && !shows_back) {
        return None;
    }
    let to = from - p;
    let u = to.dot(across) / volume;
    let turned = to.cross(a);
    let v = along.dot(turned) / volume;
    let weights = DVec3::new(1.0 - u - v, u, v);
    (weights.min_element() >= 0.0).then(|| (b.dot(turned) / volume, weights))
}

/// Returns whether an object is opaque at a point of a triangle, given by its weights. A part with
/// an opacity map does not count as opaque.
fn is_opaque(object: &Object, triangle: &Triangle, weights: DVec3) -> bool {
    let look = object.part_look(part_of(object, triangle));
    if look.opacity < 1.0 || look.map(MapKind::Opacity).is_some() {
        return false;
    }
    let mesh = &object.model.mesh;
    let uvs = mesh.uvs_at(triangle.corners.map(|corner| mesh.corners()[corner as usize].uv));
    let (Some(texture), Some(uvs)) = (look.texture, uvs) else { return true };
    let [a, b, c] = uvs.map(|uv| DVec2::from_array(uv.map(f64::from)));
    alpha_at(texture, a * weights.x + b * weights.y + c * weights.z) >= 128
}

/// Returns the alpha of the texel at a texture coordinate.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_precision_loss,
    reason = "brought to the picture's borders"
)]
fn alpha_at(texture: &Texture, uv: DVec2) -> u8 {
    let uv = uv * DVec2::from_array(texture.scale) + DVec2::from_array(texture.offset);
    let uv = match texture.wrap {
        Wrap::Repeat => uv - uv.floor(),
        Wrap::Clamp => uv.clamp(DVec2::ZERO, DVec2::ONE),
    };
    let Size { width, height } = texture.picture.size();
    let texel = |part: f64, count: usize| ((part * count as f64) as usize).min(count - 1);
    if width == 0 || height == 0 {
        return u8::MAX;
    }
    texture.picture.pixel(texel(uv.x, width), texel(1.0 - uv.y, height))[3]
}

/// The frustum of a perspective picture, without its near and far planes.
struct Frustum {
    view_from_world: DMat4,
    /// The slopes of the sides: half of the width and of the height at depth 1.
    slopes: DVec2,
}

impl Frustum {
    /// Returns a lower bound of the depths of an object in view; infinite if its box is out of
    /// view.
    fn depth_of_box(&self, object: &Object, time: f64) -> f64 {
        let Some(bounds) = object.model.mesh.bounds() else { return f64::INFINITY };
        let view_from_mesh = self.view_from_world * object.world_from_mesh(time);
        let corners = bounds.corners().map(|corner| view_from_mesh.transform_point3(corner));
        let misses =
            |outside: &dyn Fn(&DVec3) -> f64| corners.iter().all(|corner| outside(corner) > 0.0);
        let is_out = misses(&|p| p.z) || self.sides().iter().any(|side| misses(&|p| -side.dot(*p)));
        if is_out {
            return f64::INFINITY;
        }
        corners.iter().map(|corner| -corner.z).fold(f64::INFINITY, f64::min)
    }

    /// Returns the normals of the four sides, which point inwards. All sides contain the eye.
    fn sides(&self) -> [DVec3; 4] {
        let DVec2 { x, y } = self.slopes;
        [
            DVec3::new(1.0, 0.0, -x),
            DVec3::new(-1.0, 0.0, -x),
            DVec3::new(0.0, 1.0, -y),
            DVec3::new(0.0, -1.0, -y),
        ]
    }

    /// Returns the smallest depth of an object's drawn triangles in view.
    fn depth_of(&self, object: &Object, view: &View, id: ObjectId) -> f64 {
        let view_from_mesh = self.view_from_world * object.world_from_mesh(view.time);
        let sides = self.sides();
        let shows_back = object.is_two_sided() || view.back_faces;
        let is_mirrored = view_from_mesh.determinant() < 0.0;
        let depth = |triangle: &Triangle| {
            let [p, q, r] =
                corners_of(object, triangle).map(|corner| view_from_mesh.transform_point3(corner));
            // The eye is the origin: it sees the front if the volume with it is negative.
            let is_front = (p.dot(q.cross(r)) < 0.0) != is_mirrored;
            if (is_front || shows_back) && draws(view, id, object, triangle) {
                clipped_depth(&[p, q, r], &sides)
            } else {
                f64::INFINITY
            }
        };
        let depths = object.model.mesh.triangles().par_iter().map(depth);
        depths.reduce(|| f64::INFINITY, f64::min)
    }
}

/// Returns the smallest depth of the part of a triangle inside of planes through the eye, given by
/// their normals. Infinite if no part is inside and ahead.
fn clipped_depth(triangle: &[DVec3; 3], sides: &[DVec3; 4]) -> f64 {
    let misses = |side: &DVec3| triangle.iter().all(|p| side.dot(*p) < 0.0);
    if triangle.iter().all(|p| p.z >= 0.0) || sides.iter().any(misses) {
        return f64::INFINITY;
    }
    let mut polygon = triangle.to_vec();
    for side in sides {
        let mut kept = Vec::with_capacity(polygon.len() + 1);
        for (i, &to) in polygon.iter().enumerate() {
            let from = polygon[(i + polygon.len() - 1) % polygon.len()];
            let (before, after) = (side.dot(from), side.dot(to));
            if (before < 0.0) != (after < 0.0) {
                kept.push(from.lerp(to, before / (before - after)));
            }
            if after >= 0.0 {
                kept.push(to);
            }
        }
        polygon = kept;
    }
    // Inside of all sides, every point is ahead of the eye.
    polygon.iter().map(|p| -p.z).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: [DVec3; 4] = [
        DVec3::new(1.0, 0.0, -1.0),
        DVec3::new(-1.0, 0.0, -1.0),
        DVec3::new(0.0, 1.0, -1.0),
        DVec3::new(0.0, -1.0, -1.0),
    ];

    #[test]
    fn the_nearest_point_of_a_floor_in_view_is_where_the_lower_side_meets_it() {
        // The floor is 2 below the eye and reaches behind it; the side has slope 1.
        let floor = [
            DVec3::new(-900.0, -2.0, 900.0),
            DVec3::new(900.0, -2.0, 900.0),
            DVec3::new(0.0, -2.0, -900.0),
        ];
        assert!((clipped_depth(&floor, &SQUARE) - 2.0).abs() < 1e-9);
        let behind = floor.map(|p| p + DVec3::Z * 2000.0);
        assert_eq!(clipped_depth(&behind, &SQUARE), f64::INFINITY);
        let aside = floor.map(|p| p + DVec3::X * 3000.0);
        assert_eq!(clipped_depth(&aside, &SQUARE), f64::INFINITY);
    }

    #[test]
    fn a_ray_meets_the_front_of_a_triangle_and_its_back_only_if_that_is_shown() {
        let triangle = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let ray = |z: f64| [DVec3::new(0.25, 0.25, z), DVec3::Z * -z.signum() * 0.5];
        let (way, weights) = meeting(ray(4.0), triangle, false).unwrap();
        assert_eq!((way, weights), (8.0, DVec3::new(0.5, 0.25, 0.25)));
        assert_eq!(meeting(ray(-4.0), triangle, false), None);
        assert_eq!(meeting(ray(-4.0), triangle, true).map(|(way, _)| way), Some(8.0));
        let aside = [DVec3::new(0.8, 0.8, 4.0), DVec3::NEG_Z];
        assert_eq!(meeting(aside, triangle, true), None);
    }
}

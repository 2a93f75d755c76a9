//! Finds small meshes with all faces turned away from the observer or from a light: a wall, a
//! floor, a leaf. A closed shape never qualifies, so larger meshes are not examined.

use crate::accel::Accelerated as _;
use glam::{DMat3, DVec3};

use crate::frame::Viewport;
use crate::frame::draw::{Back, Draw};
use crate::screen::clip::{Screen, ScreenVertex};
use crate::screen::coverage::doubled_area;
use marraztu_core::accuracy::LightAt;
use marraztu_core::base::math;
use marraztu_core::scene::{Normals, Projection, dvec3};

/// The largest number of triangles or normals of an examined mesh.
const FEW: usize = 64;

/// Returns the normals of a draw. `None` if there are many, if back faces are lit, or if the
/// placement stretches some normals so much more than others that interpolated ones are uncertain.
pub(super) fn turning_of(draw: &Draw, light_at: LightAt) -> Option<Vec<DVec3>> {
    let mesh = &draw.model.mesh;
    let normals = match (light_at, draw.normals) {
        (LightAt::Face, _) | (_, Normals::Face) => mesh.polygon_normals(),
        (_, Normals::Vertex) => &mesh.draw_order().points(draw.normal_source).normals,
    };
    if normals.len() > FEW || draw.back == Back::Lit {
        return None;
    }
    let placed: Vec<DVec3> =
        normals.iter().map(|normal| draw.view_from_normal * dvec3(*normal)).collect();
    let lengths = || placed.iter().map(|normal| normal.length());
    let (least, most) = (lengths().fold(f64::INFINITY, f64::min), lengths().fold(0.0, f64::max));
    if least * 10.0 < most {
        return None;
    }
    placed.into_iter().map(math::unit).collect()
}

/// Returns whether the observer is in front of all polygons of a small mesh, and all are flat.
///
/// A polygon with many corners is cut into slivers. Snapping to the screen grid turns some of them
/// over, and with both sides lit they would show the light of the back. If no back can be visible,
/// they are culled.
pub(super) fn shows_fronts_only(draw: &Draw, projection: Projection) -> bool {
    let mesh = &draw.model.mesh;
    let count = u32::try_from(mesh.polygon_count()).unwrap_or(u32::MAX);
    let is_few = (1..=FEW).contains(&mesh.polygon_count());
    is_few && (0..count).all(|polygon| shows_front(draw, polygon, projection))
}

fn shows_front(draw: &Draw, polygon: u32, projection: Projection) -> bool {
    let mesh = &draw.model.mesh;
    let normal = dvec3(mesh.polygon_normals()[polygon as usize]);
    let middle = mesh.polygon_centre(polygon);
    let offsets = mesh.corners_of(polygon).map(|corner| mesh.corner_position(corner) - middle);
    let (mut size, mut height) = (0.0_f64, 0.0_f64);
    for offset in offsets {
        size = size.max(offset.length_squared());
        height = height.max(offset.dot(normal).abs());
    }
    // Corners of a flat polygon leave its plane only by rounding.
    let is_flat = height <= 1e-6 * size.sqrt();
    // Not the normals of light, which lean if they are transformed like the surface.
    let normal = math::normal_matrix(DMat3::from_mat4(draw.view_from_object)) * normal;
    let to_observer = match projection {
        Projection::Perspective => -draw.view_from_object.transform_point3(middle),
        Projection::Orthographic => DVec3::Z,
    };
    // Farther in front than a nearly flat polygon can reach.
    is_flat && normal.dot(to_observer) > 1e-4 * normal.length() * to_observer.length()
}

/// Returns whether all triangles of a small mesh are culled as back faces, with corners snapped as
/// in the rasteriser.
pub(super) fn is_turned_away(draw: &Draw, viewport: Viewport) -> bool {
    let order = draw.model.mesh.draw_order();
    if draw.back != Back::Culled || order.triangles.len() > FEW {
        return false;
    }
    let screen = Screen::new(draw.clip_from_object, viewport);
    order.triangles.iter().all(|triangle| {
        let place = |vertex: u32| screen.vertex(screen.clip(order.position(vertex)));
        let corners = triangle.vertices.map(place);
        // Clipped triangles are undecided.
        corners.iter().all(ScreenVertex::is_inside) && {
            // A triangle without an area covers no pixel, so 0 counts as turned away.
            let area = doubled_area(corners.map(|corner| corner.at()));
            if draw.mirrored { area <= 0 } else { area >= 0 }
        }
    })
}

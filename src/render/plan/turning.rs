//! Finds small meshes whose faces are all turned away from the observer or from a light: a wall, a
//! floor, a leaf. A closed shape never is, so larger meshes are not examined.

use glam::DVec3;

use crate::accuracy::LightAt;
use crate::base::image::Size;
use crate::base::math;
use crate::render::frame::draw::{Back, Draw};
use crate::render::lights::turning::Turning;
use crate::render::screen::clip::{Screen, ScreenVertex};
use crate::render::screen::coverage::doubled_area;
use crate::scene::{Normals, dvec3};

/// The most triangles or normals of a mesh that is examined.
const FEW: usize = 64;

/// The normals of a draw. `None` if there are many, if back faces are lit, or if the placement
/// stretches some so much more than others that interpolated normals are uncertain.
pub(super) fn turning_of(draw: &Draw, light_at: LightAt) -> Option<Turning> {
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
    placed.into_iter().map(math::unit).collect::<Option<_>>().map(Turning)
}

/// Whether all triangles of a small mesh are culled as back faces, with corners snapped as in the
/// rasterizer.
pub(super) fn is_turned_away(draw: &Draw, size: Size) -> bool {
    let order = draw.model.mesh.draw_order();
    if draw.back != Back::Culled || order.triangles.len() > FEW {
        return false;
    }
    let screen = Screen::new(draw.clip_from_object, size);
    order.triangles.iter().all(|triangle| {
        let place = |vertex: u32| screen.vertex(screen.clip(order.position(vertex)));
        let corners = triangle.vertices.map(place);
        // Clipped triangles are undecided.
        corners.iter().all(ScreenVertex::is_inside) && {
            let area = doubled_area(corners.map(|corner| corner.at()));
            if draw.mirrored { area <= 0 } else { area >= 0 }
        }
    })
}

//! The automatic near plane: it moves towards the eye where it would cut a surface in view.
//!
//! If a surface in view comes nearer than twice the distance of the plane, the plane moves to the
//! largest power of ten below a hundredth of the depth of that surface. It returns once everything
//! in view is far enough away. Depths are stored reversed, in floating point, so a near plane close
//! to the eye costs no precision.

use super::{set_transform, surfaces};
use crate::base::image::Size;
use crate::scene::{
    Camera, CameraId, Command, Item, ItemId, Lens, Observer, Projection, Scene, View,
};

/// A near plane that was moved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MovedNear {
    camera: CameraId,
    /// The distance that it returns to.
    usual: f64,
    /// The present distance. Another distance in the lens means that the lens was set since.
    now: f64,
}

/// Returns the command that moves the near plane of the selected camera; `None` if the plane stays.
/// Also updates the record of the plane's usual distance.
#[must_use]
pub fn adapted(
    scene: &Scene,
    view: &View,
    size: Size,
    moved: &mut Option<MovedNear>,
) -> Option<Command> {
    let camera = scene.selected_camera(view);
    let lens = camera.lens;
    let is_seen_through = view.observer == Observer::Camera
        && view.projection == Projection::Perspective
        && set_transform::unlocked(scene, ItemId::Camera(view.camera)).is_ok();
    if !(lens.automatic_near && is_seen_through) {
        return None;
    }
    let is_own = |it: &MovedNear| it.camera == view.camera && it.now == lens.near;
    *moved = moved.filter(is_own);
    let usual = moved.map_or(lens.near, |it| it.usual);
    let nearest = surfaces::nearest_depth(scene, view, size, 2.0 * lens.near);
    let near = distance(lens.near, usual, nearest);
    if near == lens.near {
        return None;
    }
    *moved = (near < usual).then_some(MovedNear { camera: view.camera, usual, now: near });
    let camera = Camera { lens: Lens { near, ..lens }, ..camera.clone() };
    Some(Command::Replace(Item::Camera(view.camera, Box::new(camera))))
}

/// Returns the new distance of the near plane, from its present distance, its usual distance, and
/// the depth of the nearest surface in view.
fn distance(near: f64, usual: f64, nearest: f64) -> f64 {
    if nearest >= 200.0 * usual {
        return usual;
    }
    if nearest.is_nan() || nearest <= 0.0 || (2.0 * near..=1000.0 * near).contains(&nearest) {
        return near;
    }
    // As if parsed from text, so the number has one digit in files and fields.
    let exponent = libm::floor(libm::log10(nearest / 100.0));
    let fitting = format!("1e{exponent}").parse().unwrap_or(near);
    fitting.clamp(f64::MIN_POSITIVE, usual)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_near_plane_is_well_before_the_nearest_surface_and_returns_to_its_usual_place() {
        for (near, usual, nearest, expected) in [
            (1.0, 1.0, 300.0, 1.0),
            (1.0, 1.0, 1e9, 1.0),
            (1.0, 1.0, 2.1, 1.0),
            (1.0, 1.0, 1.9, 0.01),
            (1.0, 1.0, 0.5, 0.001),
            (0.01, 1.0, 2e-4, 1e-6),
            (0.01, 1.0, 9.0, 0.01),
            (0.01, 1.0, 11.0, 0.1),
            (0.01, 1.0, 300.0, 1.0),
            (0.01, 0.113, 88.0, 0.113),
            (0.1, 0.113, 88.0, 0.113),
            (10.0, 10.0, 15.0, 0.1),
            (0.1, 10.0, 5000.0, 10.0),
            (1.0, 1.0, 0.0, 1.0),
            (0.01, 1.0, f64::INFINITY, 1.0),
        ] {
            let found = distance(near, usual, nearest);
            assert_eq!(found, expected, "{near}, {usual}: a surface at {nearest}");
        }
    }
}

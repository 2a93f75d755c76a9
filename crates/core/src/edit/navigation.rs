//! Navigation: orbit, pan, zoom, look and fly with the selected camera.
//!
//! Drags yaw about the world's Y and pitch about the camera's X. Pixels are converted to world
//! units at the depth of the hit, so the hit stays under the pointer.

use glam::{DVec2, DVec3};

use super::surfaces::{self, Ray};
use super::transform::{effective_pose, moved, moved_about, orbited};
use super::{Change, GesturePhase, Refusal, set_transform};
use crate::base::image::Size;
use crate::scene::{CameraMode, Lens, Observer, Pose, Projection, Scene, View};

/// The factor that each notch of the wheel applies to the distance.
pub const NOTCH: f64 = 0.9;

/// How near the eye may come to a surface, as a part of the extent of the object.
const CLEARANCE: f64 = 1e-5;

/// The same in analysis, where the camera orbits the object as a whole.
const ORBIT_CLEARANCE: f64 = 2.5e-4;

/// A point of the picture to zoom to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pointer {
    /// The position, in pixels from the upper left.
    pub at: DVec2,
    /// The depth of the hit there in units along the view axis, if known.
    pub depth: Option<f64>,
}

/// Turns the camera in place: `yaw` to the left, `pitch` upwards, in radians. In analysis, the
/// camera orbits in the opposite direction instead.
///
/// # Errors
/// If the observer is an object.
pub fn look(scene: &Scene, view: &View, yaw: f64, pitch: f64, phase: GesturePhase) -> Change {
    let pose = looking_pose(scene, view)?;
    if pose.mode != CameraMode::Fly {
        return orbit(scene, view, yaw, pitch, phase);
    }
    let turn = set_transform::turn(DVec3::Y, yaw)? * set_transform::turn(pose.axes.x_axis, pitch)?;
    set_transform::pose(scene, view.camera, Pose { axes: turn * pose.axes, ..pose }, phase)
}

/// Orbits the camera around the centre of the selected object (or the origin without an object), by
/// `yaw` about the world's Y and `pitch` about the camera's X, in radians.
///
/// # Errors
/// If the observer is an object.
pub fn orbit(scene: &Scene, view: &View, yaw: f64, pitch: f64, phase: GesturePhase) -> Change {
    let pose = looking_pose(scene, view)?;
    let turn = set_transform::turn(DVec3::Y, yaw)? * set_transform::turn(pose.axes.x_axis, pitch)?;
    let pose = match set_transform::analysis_centre(scene, view) {
        // In fly, the axes turn along with the eye, so the centre keeps its place in the picture.
        Some(centre) => orbited(&pose, turn, centre),
        None => {
            let centre = pivot(scene, view);
            let eye = centre + turn * (pose.eye - centre);
            Pose { eye, axes: turn * pose.axes, ..pose }
        }
    };
    set_transform::pose(scene, view.camera, pose, phase)
}

/// Pans the camera for a pointer that has moved by `pixels` (x to the right, y down). Points at the
/// depth of the selected object follow the pointer. Returns to fly.
///
/// # Errors
/// If the observer is an object.
pub fn pan(scene: &Scene, view: &View, pixels: DVec2, size: Size, phase: GesturePhase) -> Change {
    let pose = looking_pose(scene, view)?;
    let aspect = DVec2::new(scene.selected_camera(view).lens.pixel_aspect, 1.0);
    let depth = depth_of_pivot(scene, view, &pose);
    let units = pixels * aspect * units_per_pixel(scene, view, size, depth);
    let pose = moved(&pose, DVec3::new(-units.x, units.y, 0.0));
    set_transform::pose(scene, view.camera, Pose { mode: CameraMode::Fly, ..pose }, phase)
}

/// Moves the camera in its frame, for the keys that fly while the right button is held. Returns to
/// fly.
///
/// # Errors
/// If the observer is an object.
pub fn fly(scene: &Scene, view: &View, delta: DVec3, phase: GesturePhase) -> Change {
    let pose = moved(&looking_pose(scene, view)?, delta);
    set_transform::pose(scene, view.camera, Pose { mode: CameraMode::Fly, ..pose }, phase)
}

/// Zooms in by this number of notches of the wheel (out if negative).
///
/// In perspective the eye moves along the ray through the pointer; in orthographic projection the
/// half-size changes. In both cases the hit stays under the pointer. In analysis the camera moves
/// along its axis, and stops at the distance of the near plane from the centre.
///
/// Towards a surface, each notch takes a part of the distance that is left, so the eye slows down
/// and never passes the surface: neither the one under the pointer nor one on the way.
///
/// # Errors
/// If the observer is an object, or the camera is at its nearest distance.
pub fn zoom(
    scene: &Scene,
    view: &View,
    notches: f64,
    pointer: Pointer,
    size: Size,
    phase: GesturePhase,
) -> Change {
    let pose = looking_pose(scene, view)?;
    // The factor of the distance. Clamping the notches keeps it within the range of f64.
    let left = libm::pow(NOTCH, notches.clamp(-200.0, 200.0));
    let centre = set_transform::analysis_centre(scene, view);
    match (view.projection, centre) {
        (Projection::Orthographic, _) => {
            let camera = scene.selected_camera(view);
            let lens = Lens { half_size: camera.lens.half_size * left, ..camera.lens };
            // Moving aside by the change of the picture's size keeps the point under the pointer.
            let aside = from_axis(pointer.at, &camera.lens, size)
                * shown_per_pixel(camera.lens.half_size, size);
            let aside = if centre.is_some() { DVec2::ZERO } else { aside * (1.0 - left) };
            let pose = moved(&pose, aside.extend(0.0));
            set_transform::pose_and_lens(scene, view.camera, pose, lens, phase)
        }
        (Projection::Perspective, Some(centre)) => {
            let ray = ray_through(scene, view, pointer.at, size);
            let away = away_from(scene, view, &pose, [centre, pose.axes * ray], left)?;
            let pose = moved_about(scene, view, centre, DVec3::Z * away)?;
            set_transform::pose(scene, view.camera, pose, phase)
        }
        (Projection::Perspective, None) => {
            let ray = ray_through(scene, view, pointer.at, size);
            let step = step_along(scene, view, &pose, ray, pointer.depth, left)?;
            set_transform::pose(scene, view.camera, moved(&pose, ray * step), phase)
        }
    }
}

/// Returns the movement in analysis along the camera's axis, away from the centre that is orbited,
/// if `left` of the distance is to remain. `under` is the direction through the pointer.
fn away_from(
    scene: &Scene,
    view: &View,
    pose: &Pose,
    [centre, under]: [DVec3; 2],
    left: f64,
) -> Result<f64, Refusal> {
    let distance = pose.eye.distance(centre);
    if left >= 1.0 {
        return Ok(distance * (left - 1.0));
    }
    let axis = (centre - pose.eye) / distance.max(f64::MIN_POSITIVE);
    let before = |along| Approach::new(scene, view, pose, along, ORBIT_CLEARANCE);
    let steps = [axis, under].into_iter().filter_map(before).map(|surface| surface.step(left));
    let step = steps.fold(distance * (1.0 - left), f64::min);
    if step > 0.0 { Ok(-step) } else { Err(Refusal::Nearest) }
}

/// Returns the movement in fly along a direction of the camera's frame, at depth 1, if `left` of
/// the distance is to remain. `shown` is the depth in the picture, which counts if no surface is on
/// the way: it may be older than the pose.
fn step_along(
    scene: &Scene,
    view: &View,
    pose: &Pose,
    ray: DVec3,
    shown: Option<f64>,
    left: f64,
) -> Result<f64, Refusal> {
    let surface = Approach::new(scene, view, pose, pose.axes * ray, CLEARANCE);
    let shown = shown.filter(|depth| *depth > 0.0 && depth.is_finite());
    let depth = surface.map(|it| it.depth).or(shown);
    let step = depth.unwrap_or_else(|| depth_of_pivot(scene, view, pose)) * (1.0 - left);
    if left >= 1.0 {
        return Ok(step);
    }
    let step = surface.map_or(step, |surface| step.min(surface.step(left)));
    if step > 0.0 { Ok(step) } else { Err(Refusal::NearestToSurface) }
}

/// Returns the direction through a point of the picture in the camera's frame, at depth 1.
fn ray_through(scene: &Scene, view: &View, at: DVec2, size: Size) -> DVec3 {
    let lens = scene.selected_camera(view).lens;
    let slope = libm::tan(lens.half_angle.to_radians());
    (from_axis(at, &lens, size) * shown_per_pixel(slope, size)).extend(-1.0)
}

/// A surface that the eye approaches.
#[derive(Clone, Copy, Debug)]
struct Approach {
    /// Its distance along the ray.
    depth: f64,
    /// The least distance to keep.
    least: f64,
}

impl Approach {
    /// Finds the first visible surface along a ray from the eye. `clearance` is a part of the
    /// extent of the object; a fixed near plane must not reach the surface either.
    fn new(scene: &Scene, view: &View, pose: &Pose, along: DVec3, clearance: f64) -> Option<Self> {
        let lens = scene.selected_camera(view).lens;
        let ray = Ray { from: pose.eye, along };
        let cut = if lens.automatic_near { 0.0 } else { lens.near };
        let met = surfaces::first_along(scene, view, ray, cut)?;
        Some(Self { depth: met.way, least: (met.extent * clearance).max(cut) })
    }

    /// Returns the step that leaves this part of the distance, but at least the clearance.
    fn step(self, left: f64) -> f64 {
        (self.depth * (1.0 - left)).min(self.depth - self.least)
    }
}

/// Returns the world units per pixel, from top to bottom, at `depth` in front of the camera.
pub fn units_per_pixel(scene: &Scene, view: &View, size: Size, depth: f64) -> f64 {
    let lens = scene.selected_camera(view).lens;
    match view.projection {
        Projection::Orthographic => shown_per_pixel(lens.half_size, size),
        Projection::Perspective => {
            shown_per_pixel(depth * libm::tan(lens.half_angle.to_radians()), size)
        }
    }
}

/// Returns the pose of the selected camera, if it is the observer.
fn looking_pose(scene: &Scene, view: &View) -> Result<Pose, Refusal> {
    if view.observer == Observer::Object && view.object.is_some() {
        return Err(Refusal::ObjectLooks);
    }
    Ok(effective_pose(scene, view))
}

/// Returns the pivot of drags: the centre of the selected object, otherwise the origin.
fn pivot(scene: &Scene, view: &View) -> DVec3 {
    let object = view.object.and_then(|id| scene.objects.get(id));
    object.map_or(DVec3::ZERO, |object| object.centre(view.time))
}

/// Returns the depth of the pivot if it is in front of the camera, otherwise its distance, and at
/// least the near plane. Thus a drag always moves the view, and the wheel passes through the pivot.
fn depth_of_pivot(scene: &Scene, view: &View, pose: &Pose) -> f64 {
    let away = pose.eye - pivot(scene, view);
    let ahead = away.dot(pose.axes.z_axis);
    let near = scene.selected_camera(view).lens.near;
    if ahead > near { ahead } else { away.length().max(near) }
}

/// Returns the units per pixel if `half` units are on each side of the axis across the shorter
/// side.
#[expect(clippy::cast_precision_loss, reason = "pictures have fewer than 2^53 pixels a side")]
fn shown_per_pixel(half: f64, size: Size) -> f64 {
    2.0 * half / size.width.min(size.height).max(1) as f64
}

/// Returns a position relative to the axis of the lens, x to the right and y up, in heights of a
/// pixel.
fn from_axis(at: DVec2, lens: &Lens, size: Size) -> DVec2 {
    let axis = lens.principal_point(size);
    DVec2::new((at.x - axis.x) * lens.pixel_aspect, axis.y - at.y)
}

//! Placements as numbers: position, rotation, scale.
//!
//! An object's placement is a matrix, which may not be a product of one translation, rotation and
//! scale. Setting one of these keeps the others: a new rotation replaces the old one in the matrix,
//! and a shear is kept.
//!
//! Angles are in degrees here. Objects have angles about X, Y and Z with `R = Rx Ry Rz`; cameras
//! have yaw, pitch and roll with `R = Ry Rx Rz`.

use glam::{DMat3, DMat4, DVec3};

use super::angles;
use super::transform::effective_pose;
use super::{Change, GesturePhase, Refusal, set_transform};
use crate::base::math::{self, Axis};
use crate::scene::{CameraId, CameraMode, LightId, LightOrigin, ObjectId, Pose, Scene, View};

/// Returns the position of an object's origin.
pub fn translation(placement: &DMat4) -> DVec3 {
    placement.w_axis.truncate()
}

/// Returns an object's rotation as degrees about X, Y and Z, `R = Rx Ry Rz`. Of the equivalent
/// angles, these have the smallest X and Z.
pub fn turn_degrees(placement: &DMat4) -> DVec3 {
    let turn = turn(placement);
    let [x, y, z] = [turn.x_axis, turn.y_axis, turn.z_axis];
    // R = | cy cz,  -cy sz,   sy    |
    //     |  ...      ...   -sx cy  |
    //     |  ...      ...    cx cy  |
    let about_y = libm::asin(z.x.clamp(-1.0, 1.0));
    let (about_x, about_z) = if z.x.abs() < 1.0 - 1e-12 {
        (libm::atan2(-z.y, z.z), libm::atan2(-y.x, x.x))
    } else {
        // X and Z turn about the same axis (gimbal lock), so X gets the whole angle.
        (libm::atan2(y.z, y.y), 0.0)
    };
    angles::plainest(DVec3::new(about_x, about_y, about_z).map(f64::to_degrees))
}

/// Returns the scale of an object along its axes; X is negative if the object is mirrored.
pub fn scale(placement: &DMat4) -> DVec3 {
    let m = DMat3::from_mat4(*placement);
    let x = m.x_axis.length() * if m.determinant() < 0.0 { -1.0 } else { 1.0 };
    DVec3::new(x, m.y_axis.length(), m.z_axis.length())
}

/// Returns a camera's yaw, pitch and roll in degrees, `R = Ry Rx Rz`.
pub fn camera_degrees(pose: &Pose) -> DVec3 {
    let [x, y, z] = [pose.axes.x_axis, pose.axes.y_axis, pose.axes.z_axis];
    // R = |  ...     ...   sy cp |
    //     | cp sr   cp cr   -sp  |
    //     |  ...     ...   cy cp |
    let pitch = libm::asin((-z.y).clamp(-1.0, 1.0));
    let (yaw, roll) = if z.y.abs() < 1.0 - 1e-12 {
        (libm::atan2(z.x, z.z), libm::atan2(x.y, y.y))
    } else {
        (libm::atan2(-x.z, x.x), 0.0)
    };
    DVec3::new(yaw, pitch, roll).map(f64::to_degrees)
}

/// Sets the position of an object's origin.
///
/// # Errors
/// If the numbers are not finite, or the object is gone.
pub fn object_translation(
    scene: &Scene,
    view: &View,
    id: ObjectId,
    to: DVec3,
    phase: GesturePhase,
) -> Change {
    let m = placement(scene, id)?;
    set_transform::object(scene, view, id, DMat4 { w_axis: to.extend(1.0), ..m }, phase)
}

/// Sets the rotation of an object, in degrees as in [`turn_degrees`].
///
/// # Errors
/// If the numbers are not finite, or the object is gone.
pub fn object_turn(
    scene: &Scene,
    view: &View,
    id: ObjectId,
    degrees: DVec3,
    phase: GesturePhase,
) -> Change {
    let m = placement(scene, id)?;
    let [x, y, z] = turns(degrees)?;
    let linear = x * y * z * turn(&m).transpose() * DMat3::from_mat4(m);
    set_transform::object(scene, view, id, math::placed(linear, translation(&m)), phase)
}

/// Sets the scale of an object, as in [`scale`]. Negative factors mirror.
///
/// # Errors
/// If the object would become flat, a number is not finite, or the object is gone.
pub fn object_scale(
    scene: &Scene,
    view: &View,
    id: ObjectId,
    to: DVec3,
    phase: GesturePhase,
) -> Change {
    let m = placement(scene, id)?;
    let (old, turn) = (scale(&m), turn(&m));
    let linear = DMat3::from_mat4(m);
    let column = |axis: Axis| {
        let i = axis.index();
        // A column of length 0, from a file, takes its direction from the rotation.
        if old[i] == 0.0 { turn * axis.unit() * to[i] } else { linear.col(i) * (to[i] / old[i]) }
    };
    let [x, y, z] = Axis::ALL.map(column);
    let linear = DMat3::from_cols(x, y, z);
    if !linear.is_finite() {
        return Err(Refusal::TooLarge);
    }
    if !math::has_full_rank(linear) {
        return Err(Refusal::Flat);
    }
    set_transform::object(scene, view, id, math::placed(linear, translation(&m)), phase)
}

/// Sets the whole placement of an object.
///
/// # Errors
/// If the placement is flat or not finite, or the object is gone.
pub fn object(scene: &Scene, view: &View, id: ObjectId, to: DMat4, phase: GesturePhase) -> Change {
    if to.is_finite() && !math::has_full_rank(DMat3::from_mat4(to)) {
        return Err(Refusal::Flat);
    }
    set_transform::object(scene, view, id, to, phase)
}

/// Sets the eye of a camera. In analysis the camera keeps looking at its centre.
///
/// # Errors
/// If the numbers are not finite, or the camera is gone.
pub fn camera_eye(
    scene: &Scene,
    view: &View,
    id: CameraId,
    to: DVec3,
    phase: GesturePhase,
) -> Change {
    let view = &View { camera: id, ..view.clone() };
    let pose = effective_pose(scene, view);
    let axes = match set_transform::analysis_centre(scene, view) {
        Some(centre) => math::look_at(to, centre, pose.axes.y_axis, pose.axes),
        None => pose.axes,
    };
    set_transform::pose(scene, id, Pose { eye: to, axes, ..pose }, phase)
}

/// Sets yaw, pitch and roll of a camera, in degrees as in [`camera_degrees`]. In analysis the
/// camera orbits its centre at the same distance.
///
/// # Errors
/// If the numbers are not finite, or the camera is gone.
pub fn camera_turn(
    scene: &Scene,
    view: &View,
    id: CameraId,
    degrees: DVec3,
    phase: GesturePhase,
) -> Change {
    let view = &View { camera: id, ..view.clone() };
    let [pitch, yaw, roll] = turns(DVec3::new(degrees.y, degrees.x, degrees.z))?;
    let axes = yaw * pitch * roll;
    let pose = effective_pose(scene, view);
    let eye = match set_transform::analysis_centre(scene, view) {
        Some(centre) => centre + axes.z_axis * pose.eye.distance(centre),
        None => pose.eye,
    };
    set_transform::pose(scene, id, Pose { eye, axes, ..pose }, phase)
}

/// Sets the whole pose of a camera, and returns it to fly.
///
/// # Errors
/// If the numbers are not finite, or the camera is gone.
pub fn camera(scene: &Scene, id: CameraId, eye: DVec3, axes: DMat3, phase: GesturePhase) -> Change {
    set_transform::pose(scene, id, Pose { eye, axes, mode: CameraMode::Fly }, phase)
}

/// Sets the position of a bulb or a free spot.
///
/// # Errors
/// If the light's position cannot be set, or the numbers are not finite.
pub fn light_position(scene: &Scene, id: LightId, to: DVec3, phase: GesturePhase) -> Change {
    let light = scene.lights.get(id).ok_or(Refusal::Gone)?;
    let place = LightOrigin { position: Some(to), ..set_transform::place_of(light)? };
    set_transform::light(scene, id, place, phase)
}

/// Sets the direction of a sun or a free spot. `to` may have any length except 0.
///
/// # Errors
/// If the light's direction cannot be set, or `to` has length 0.
pub fn light_direction(scene: &Scene, id: LightId, to: DVec3, phase: GesturePhase) -> Change {
    let light = scene.lights.get(id).ok_or(Refusal::Gone)?;
    if to == DVec3::ZERO {
        return Err(Refusal::NoDirection);
    }
    let place = LightOrigin { direction: Some(to), ..set_transform::place_of(light)? };
    set_transform::light(scene, id, place, phase)
}

fn placement(scene: &Scene, id: ObjectId) -> Result<DMat4, Refusal> {
    Ok(*scene.objects.get(id).ok_or(Refusal::Gone)?.placement.now())
}

/// Returns the rotation of a placement, without scale, shear and mirroring.
fn turn(placement: &DMat4) -> DMat3 {
    math::frame(placement.z_axis.truncate(), placement.y_axis.truncate(), DMat3::IDENTITY)
}

/// Returns the rotations about X, Y and Z by these degrees.
fn turns(degrees: DVec3) -> Result<[DMat3; 3], Refusal> {
    let [x, y, z] = Axis::ALL
        .map(|axis| set_transform::turn(axis.unit(), (degrees[axis.index()] % 360.0).to_radians()));
    Ok([x?, y?, z?])
}

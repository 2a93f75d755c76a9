//! Transforms the selected item by a step or an amount, and undoes its last transformation.
//!
//! * An object with placement M: M := M T in the local frame, M := T M in the global frame.
//! * A camera in fly moves and turns in its own frame. X yaws about its Y and Y pitches about its
//!   X, for translation and for rotation; Z moves along its Z, or rolls about it.
//! * A camera in analysis does the same about the centre that it looks at: it orbits, approaches or
//!   moves away but never past the centre, and rolls.
//! * A sun turns about the world's axes, a bulb moves along them, and a fixed spot does both.

use glam::{DMat3, DMat4, DVec3};

use super::set_transform;
pub use super::set_transform::{aimed_again, transformation_of};
use super::{Change, GesturePhase, Refusal, steps};
use crate::base::math::{self, Axis};
use crate::scene::{
    AnchorMut, CameraMode, Command, Frame, Item, ItemId, Orbit, Pose, Scene, SpotOwner, Subject,
    Transformation, View,
};

/// The direction of a step along or about an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Sign {
    /// The lower-case key.
    Positive,
    /// The upper-case key.
    Negative,
}

impl Sign {
    /// Applies this sign to an amount.
    pub const fn of(self, amount: f64) -> f64 {
        match self {
            Self::Positive => amount,
            Self::Negative => -amount,
        }
    }
}

/// Transforms the selected item of the subject by one step (keys x, y and z).
///
/// # Errors
/// If the item cannot be transformed in this way.
pub fn step(scene: &Scene, view: &View, axis: Axis, sign: Sign, phase: GesturePhase) -> Change {
    let along = || axis.unit() * sign.of(distance(scene, view, axis));
    let radians = sign.of(view.steps.rotation.to_radians());
    match view.subject {
        Subject::Object => match view.transformation {
            Transformation::Translation => translate(scene, view, along(), phase),
            Transformation::Rotation => rotate(scene, view, axis.unit(), radians, phase),
            Transformation::Scaling => {
                let up = view.steps.scaling;
                let factor = if sign == Sign::Positive { up } else { 1.0 / up };
                scale(scene, view, factor, phase)
            }
        },
        Subject::Camera => match (axis, view.transformation) {
            (_, Transformation::Scaling) => Err(Refusal::CameraScaled),
            (Axis::X, _) => rotate(scene, view, DVec3::Y, radians, phase),
            (Axis::Y, _) => rotate(scene, view, DVec3::X, radians, phase),
            (Axis::Z, Transformation::Translation) => translate(scene, view, along(), phase),
            (Axis::Z, Transformation::Rotation) => rotate(scene, view, DVec3::Z, radians, phase),
        },
        Subject::Light => {
            let (_, light) = set_transform::selected_light(scene, view)?;
            match transformation_of(light, view.transformation)? {
                Transformation::Translation => translate(scene, view, along(), phase),
                Transformation::Rotation => rotate(scene, view, axis.unit(), radians, phase),
                Transformation::Scaling => Err(Refusal::LightScaled),
            }
        }
    }
}

/// Returns the distance of one step along `axis` for the selected item of the subject, in the units
/// of the item's frame.
pub fn distance(scene: &Scene, view: &View, axis: Axis) -> f64 {
    let length = steps::length(scene, view);
    match view.object.and_then(|id| scene.objects.get(id)) {
        // In the local frame, the units are as long as the object's scaled axes.
        Some(object)
            if view.steps.by_size
                && view.subject == Subject::Object
                && view.frame == Frame::Local =>
        {
            let unit = object.placement.now().transform_vector3(axis.unit()).length();
            if unit > 0.0 { length / unit } else { view.steps.translation }
        }
        _ => length,
    }
}

/// Moves the selected item of the subject by `delta`: an object in the frame of the view, a camera
/// in its frame, a light in the world's frame.
///
/// # Errors
/// If the item cannot be moved.
pub fn translate(scene: &Scene, view: &View, delta: DVec3, phase: GesturePhase) -> Change {
    match view.subject {
        Subject::Object => transform(scene, view, DMat4::from_translation(delta), phase),
        Subject::Camera => {
            let pose = match set_transform::analysis_centre(scene, view) {
                None => moved(&effective_pose(scene, view), delta),
                Some(centre) => moved_about(scene, view, centre, delta)?,
            };
            set_transform::pose(scene, view.camera, pose, phase)
        }
        Subject::Light => {
            let (id, light) = set_transform::selected_light(scene, view)?;
            // The orbit turns a bulb's position before it is shown, so `delta` is turned back.
            let delta = light.kind.orbit().map_or(delta, |orbit| {
                Orbit { speed: -orbit.speed, ..*orbit }.at(delta, view.time)
            });
            let mut place = set_transform::place_of(light)?;
            place.position = Some(place.position.ok_or(Refusal::SunMoved)? + delta);
            set_transform::light(scene, id, place, phase)
        }
    }
}

/// Rotates the selected item of the subject about `axis` by the right-hand rule. An object turns in
/// the frame of the view (about the origin in the global frame). A camera turns in its frame, about
/// its eye in fly and about its centre in analysis. A light turns in the world's frame.
///
/// # Errors
/// If the item cannot be rotated.
pub fn rotate(
    scene: &Scene,
    view: &View,
    axis: DVec3,
    radians: f64,
    phase: GesturePhase,
) -> Change {
    let turn = |axis| set_transform::turn(axis, radians);
    match view.subject {
        Subject::Object => transform(scene, view, DMat4::from_mat3(turn(axis)?), phase),
        Subject::Camera => {
            let pose = effective_pose(scene, view);
            let pose = match set_transform::analysis_centre(scene, view) {
                None => Pose { axes: pose.axes * turn(axis)?, ..pose },
                Some(centre) => orbited(&pose, turn(pose.axes * axis)?, centre),
            };
            set_transform::pose(scene, view.camera, pose, phase)
        }
        Subject::Light => {
            let (id, light) = set_transform::selected_light(scene, view)?;
            let mut place = set_transform::place_of(light)?;
            let direction = place.direction.ok_or(Refusal::BulbTurned)?;
            place.direction = Some(turn(axis)? * direction);
            set_transform::light(scene, id, place, phase)
        }
    }
}

/// Scales the selected object uniformly by `factor`.
///
/// # Errors
/// If the subject is not objects, or the object would become flat.
pub fn scale(scene: &Scene, view: &View, factor: f64, phase: GesturePhase) -> Change {
    stretch(scene, view, DVec3::splat(factor), phase)
}

/// Scales the selected object by a factor for each axis of the view's frame. Negative factors
/// mirror the object.
///
/// # Errors
/// If the subject is not objects, or the object would become flat.
pub fn stretch(scene: &Scene, view: &View, factors: DVec3, phase: GesturePhase) -> Change {
    match view.subject {
        Subject::Object => transform(scene, view, DMat4::from_scale(factors), phase),
        Subject::Camera => Err(Refusal::CameraScaled),
        Subject::Light => Err(Refusal::LightScaled),
    }
}

/// Undoes the last transformation of the selected item of the subject (key `u`).
///
/// # Errors
/// If the item was never transformed.
pub fn take_back(scene: &Scene, view: &View) -> Change {
    let nothing = Refusal::NothingToTakeBack;
    match view.subject {
        Subject::Object => {
            let (id, object) = set_transform::selected_object(scene, view)?;
            set_transform::object_placed(scene, view, id, object.placement.undone().ok_or(nothing)?)
        }
        Subject::Camera => {
            set_transform::unlocked(scene, ItemId::Camera(view.camera))?;
            let mut camera = scene.selected_camera(view).clone();
            camera.pose = camera.pose.undone().ok_or(nothing)?;
            Ok(Command::Replace(Item::Camera(view.camera, Box::new(camera))))
        }
        Subject::Light => {
            let (id, light) = set_transform::selected_light(scene, view)?;
            set_transform::place_of(light)?;
            set_transform::unlocked(scene, ItemId::Light(id))?;
            let mut light = light.clone();
            match light.kind.anchor_mut() {
                AnchorMut::Direction(v) | AnchorMut::Position(v) => {
                    *v = v.undone().ok_or(nothing)?;
                }
                AnchorMut::Owner(SpotOwner::Fixed(aim)) => *aim = aim.undone().ok_or(nothing)?,
                AnchorMut::Everywhere | AnchorMut::Owner(_) => return Err(nothing),
            }
            Ok(Command::Replace(Item::Light(id, Box::new(light))))
        }
    }
}

/// Switches the selected camera between fly and analysis (key `g`). Analysis aims it at the centre
/// of the selected object. Returning to fly does not move it and pushes nothing.
///
/// # Errors
/// If no object is selected.
pub fn toggle_analysis(scene: &Scene, view: &View) -> Change {
    let pose = effective_pose(scene, view);
    match pose.mode {
        CameraMode::Analysis { .. } => {
            let pose = Pose { mode: CameraMode::Fly, ..pose };
            set_transform::pose(scene, view.camera, pose, GesturePhase::Continued)
        }
        CameraMode::Fly => {
            let (id, object) = set_transform::selected_object(scene, view)?;
            let pose = set_transform::aimed(&pose, id, object.centre(view.time));
            set_transform::pose(scene, view.camera, pose, GesturePhase::First)
        }
    }
}

/// Multiplies the placement of the selected object by `t`, on the side that the frame requires.
fn transform(scene: &Scene, view: &View, t: DMat4, phase: GesturePhase) -> Change {
    let (id, object) = set_transform::selected_object(scene, view)?;
    let m = *object.placement.now();
    let placement = match view.frame {
        Frame::Local => m * t,
        Frame::Global => t * m,
    };
    if !placement.is_finite() {
        return Err(Refusal::TooLarge);
    }
    // Objects from a file that are already flat may be moved and turned.
    let linear = |m: DMat4| DMat3::from_mat4(m);
    let was_whole = math::has_full_rank(linear(m));
    let is_whole = math::has_full_rank(linear(placement)) && math::has_full_rank(linear(t));
    if was_whole && !is_whole {
        return Err(Refusal::Flat);
    }
    set_transform::object(scene, view, id, placement, phase)
}

/// Returns the selected camera's pose, with its current mode.
pub(super) fn effective_pose(scene: &Scene, view: &View) -> Pose {
    let pose = scene.selected_camera(view).pose.now();
    Pose { mode: pose.mode_with(view.object), ..*pose }
}

/// Moves a pose in its frame.
pub(super) fn moved(pose: &Pose, delta: DVec3) -> Pose {
    Pose { eye: pose.eye + pose.axes * delta, ..*pose }
}

/// Turns a pose about a centre. The axes are aimed again, which keeps rounding errors from adding
/// up.
pub(super) fn orbited(pose: &Pose, turn: DMat3, centre: DVec3) -> Pose {
    let eye = centre + turn * (pose.eye - centre);
    let axes = aimed_as(pose, eye, turn * pose.axes, centre);
    Pose { eye, axes, mode: pose.mode }
}

/// Returns the axes of a camera that has moved from `before` to `eye`, with the same deviation from
/// the centre as before. The deviation is zero, unless the camera was framed before it began to
/// orbit.
fn aimed_as(before: &Pose, eye: DVec3, axes: DMat3, centre: DVec3) -> DMat3 {
    let aimed = |eye: DVec3, axes: DMat3| math::look_at(eye, centre, axes.y_axis, axes);
    let aside = aimed(before.eye, before.axes).transpose() * before.axes;
    let difference = (aside - DMat3::IDENTITY).to_cols_array();
    let is_aimed = difference.iter().all(|x| x.abs() < 1e-9);
    if is_aimed { aimed(eye, axes) } else { aimed(eye, axes) * aside }
}

/// Moves the selected camera in analysis in its frame. It is aimed again, and never passes the
/// centre.
///
/// Towards the centre it stops at the near plane, where the object would vanish.
pub(super) fn moved_about(
    scene: &Scene,
    view: &View,
    centre: DVec3,
    delta: DVec3,
) -> Result<Pose, Refusal> {
    let pose = effective_pose(scene, view);
    let from_centre = pose.eye - centre;
    let distance = from_centre.length();
    let nearest = distance.min(scene.selected_camera(view).lens.near);
    if delta.z < 0.0 && distance <= nearest {
        return Err(Refusal::Nearest);
    }
    let z = math::unit(from_centre).unwrap_or(pose.axes.z_axis);
    let sideways = pose.axes * DVec3::new(delta.x, delta.y, 0.0);
    let eye = centre + z * (distance + delta.z).max(nearest) + sideways;
    let axes = aimed_as(&pose, eye, pose.axes, centre);
    Ok(Pose { eye, axes, mode: pose.mode })
}

//! Handles for the mouse: the point and the axes for moving, rotating or scaling the selected item,
//! and the meaning of an amount there.
//!
//! An amount is relative to the scene at the start of a drag, so rounding errors do not add up.
//!
//! Amounts count in units of the world, along or about the axes of the frame. The keys differ: in
//! the local frame, `M := M T` counts in the units of the object, which its scale stretches.

use glam::{DMat3, DMat4, DVec3};

use super::{Change, GesturePhase, Refusal, aiming, set_transform, steps, transform};
use crate::base::math::{self, Axis};
use crate::scene::{Frame, ItemId, Observer, Scene, Subject, Transformation, View};

/// The position and the axes of the selected item's handles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pivot {
    /// The transformation that the handles apply.
    pub kind: Transformation,
    /// The position of the handles in the world.
    pub origin: DVec3,
    /// The frame's axes in the world, of length 1; 0 for an axis along which the object is flat.
    pub axes: DMat3,
}

/// The amount of a transformation, in the frame of a [`Pivot`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Amount {
    /// A translation along each axis, in units of the world.
    Move(DVec3),
    /// A rotation in radians about an axis, by the right-hand rule.
    Turn(DVec3, f64),
    /// A scale factor for each axis.
    Scale(DVec3),
}

impl Pivot {
    /// Returns the direction of an axis in the world; `None` if the axis has length 0.
    pub fn direction(&self, axis: Axis) -> Option<DVec3> {
        math::unit(self.axes.col(axis.index()))
    }

    /// Transforms a world vector into the frame; `None` if the frame is flat.
    pub fn in_frame(&self, v: DVec3) -> Option<DVec3> {
        let inside = self.axes.inverse() * v;
        (math::has_full_rank(self.axes) && inside.is_finite()).then_some(inside)
    }

    /// Returns the handedness: -1 if the frame is mirrored and turns therefore run the other way in
    /// the world, else 1.
    pub fn hand(&self) -> f64 {
        if self.axes.determinant() < 0.0 { -1.0 } else { 1.0 }
    }
}

/// Returns the pivot for transforming the selected item of the subject.
///
/// In the global frame an object is rotated and scaled about the world's origin, so the handles are
/// there.
///
/// # Errors
/// If the item cannot be transformed, or is the camera through which the picture is seen.
pub fn pivot(scene: &Scene, view: &View) -> Result<Pivot, Refusal> {
    let kind = view.transformation;
    match view.subject {
        Subject::Object => {
            let (id, object) = set_transform::selected_object(scene, view)?;
            set_transform::unlocked(scene, ItemId::Object(id))?;
            let m = *object.placement.now();
            let origin = m.w_axis.truncate();
            Ok(match (view.frame, kind) {
                (Frame::Local, _) => Pivot { kind, origin, axes: own_axes(&m) },
                (Frame::Global, Transformation::Translation) => {
                    Pivot { kind, origin, axes: DMat3::IDENTITY }
                }
                (Frame::Global, Transformation::Rotation | Transformation::Scaling) => {
                    Pivot { kind, origin: DVec3::ZERO, axes: DMat3::IDENTITY }
                }
            })
        }
        Subject::Camera if kind == Transformation::Scaling => Err(Refusal::CameraScaled),
        Subject::Camera if view.observer == Observer::Camera => Err(Refusal::SeenThrough),
        Subject::Camera => {
            set_transform::unlocked(scene, ItemId::Camera(view.camera))?;
            let pose = transform::effective_pose(scene, view);
            let centre = set_transform::analysis_centre(scene, view);
            let origin = match kind {
                Transformation::Rotation => centre.unwrap_or(pose.eye),
                Transformation::Translation | Transformation::Scaling => pose.eye,
            };
            Ok(Pivot { kind, origin, axes: pose.axes })
        }
        Subject::Light => {
            let (id, light) = set_transform::selected_light(scene, view)?;
            set_transform::unlocked(scene, ItemId::Light(id))?;
            let kind = set_transform::transformation_of(light, kind)?;
            if kind == Transformation::Scaling {
                return Err(Refusal::LightScaled);
            }
            let origin = aiming::stands(scene, view, id).ok_or(Refusal::Ambient)?.position;
            Ok(Pivot { kind, origin, axes: DMat3::IDENTITY })
        }
    }
}

/// Returns the directions of an object's axes in the world.
fn own_axes(placement: &DMat4) -> DMat3 {
    let direction = |axis: Axis| {
        let column = DMat3::from_mat4(*placement).col(axis.index());
        math::unit(column).unwrap_or(DVec3::ZERO)
    };
    let [x, y, z] = Axis::ALL.map(direction);
    DMat3::from_cols(x, y, z)
}

/// Transforms the selected item of the subject by an amount.
///
/// # Errors
/// If the item cannot be transformed in this way.
pub fn transform(scene: &Scene, view: &View, amount: Amount, phase: GesturePhase) -> Change {
    let is_own = view.subject == Subject::Object && view.frame == Frame::Local;
    match amount {
        Amount::Move(delta) if is_own => {
            change_own(scene, view, phase, |m, axes| Ok(translated(m, axes * delta)))
        }
        Amount::Turn(axis, radians) if is_own => change_own(scene, view, phase, |m, axes| {
            // In a mirrored frame, turns run the other way in the world, as with the keys.
            let hand = if axes.determinant() < 0.0 { -1.0 } else { 1.0 };
            let turn = set_transform::turn(axes * axis, radians * hand)?;
            Ok(math::placed(turn * DMat3::from_mat4(*m), m.w_axis.truncate()))
        }),
        Amount::Move(delta) => transform::translate(scene, view, delta, phase),
        Amount::Turn(axis, radians) => transform::rotate(scene, view, axis, radians, phase),
        Amount::Scale(factors) => transform::stretch(scene, view, factors, phase),
    }
}

/// Changes the placement of the selected object; `to` also gets the directions of its axes.
fn change_own(
    scene: &Scene,
    view: &View,
    phase: GesturePhase,
    to: impl FnOnce(&DMat4, DMat3) -> Result<DMat4, Refusal>,
) -> Change {
    let (id, object) = set_transform::selected_object(scene, view)?;
    let m = object.placement.now();
    set_transform::object(scene, view, id, to(m, own_axes(m))?, phase)
}

fn translated(m: &DMat4, by: DVec3) -> DMat4 {
    DMat4 { w_axis: m.w_axis + by.extend(0.0), ..*m }
}

/// Rounds an amount to whole steps. A step of translation has its length in the world.
pub fn snapped(scene: &Scene, view: &View, amount: Amount) -> Amount {
    match amount {
        Amount::Move(delta) => {
            let step = steps::length(scene, view);
            Amount::Move(delta.map(|along| to_multiple(along, step)))
        }
        Amount::Turn(axis, radians) => {
            let degrees = to_multiple(radians.to_degrees(), view.steps.rotation);
            Amount::Turn(axis, degrees.to_radians())
        }
        Amount::Scale(factors) => Amount::Scale(factors.map(|factor| {
            // Scale steps multiply, so a factor snaps to a power of the step.
            let step = libm::log(view.steps.scaling);
            let count = libm::log(libm::fabs(factor)) / step;
            if factor == 0.0 || !count.is_finite() {
                return factor;
            }
            libm::copysign(libm::pow(view.steps.scaling, count.round()), factor)
        })),
    }
}

fn to_multiple(x: f64, step: f64) -> f64 {
    let rounded = (x / step).round() * step;
    if step > 0.0 && rounded.is_finite() { rounded } else { x }
}

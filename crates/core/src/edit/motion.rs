//! Motion: the spin of objects and the orbit of bulbs.
//!
//! Before a motion changes, the rotation so far is applied to the placement, and the motion
//! restarts from there. Thus nothing jumps on the screen.

use super::items::{change_object, try_change_light};
use super::{Change, GesturePhase, Refusal};
use crate::base::math::Axis;
use crate::scene::{AnchorMut, LightId, ObjectId, Orbit, Scene, Spin};

/// Starts or stops the spin of an object about one of its axes.
///
/// # Errors
/// If the object is gone.
pub fn toggle_spin(scene: &Scene, id: ObjectId, axis: Axis, time: f64) -> Change {
    let mut spin = scene.objects.get(id).ok_or(Refusal::Gone)?.spin;
    spin.axes[axis.index()] = !spin.axes[axis.index()];
    set_spin(scene, id, spin, time, GesturePhase::First)
}

/// Sets the spin of an object from `time` on, keeping the rotation so far.
///
/// # Errors
/// If the speed is not finite, or the object is gone.
pub fn set_spin(scene: &Scene, id: ObjectId, spin: Spin, time: f64, phase: GesturePhase) -> Change {
    let object = scene.objects.get(id).ok_or(Refusal::Gone)?;
    if !(spin.speed.is_finite() && time.is_finite()) {
        return Err(Refusal::TooLarge);
    }
    let turned = object.world_from_object(time);
    if !turned.is_finite() {
        return Err(Refusal::TooLarge);
    }
    change_object(scene, id, |object| {
        if object.spin.is_on() {
            object.placement = phase.apply(&object.placement, turned);
        }
        object.spin = Spin { since: time, ..spin };
    })
}

/// Applies the rotation of a spinning object to its placement. The object keeps spinning.
///
/// # Errors
/// If the object does not spin, or is gone.
pub fn apply_spin(scene: &Scene, id: ObjectId, time: f64) -> Change {
    let object = scene.objects.get(id).ok_or(Refusal::Gone)?;
    if !object.spin.is_on() {
        return Err(Refusal::NotSpinning);
    }
    set_spin(scene, id, object.spin, time, GesturePhase::First)
}

/// Starts or stops the orbit of a bulb about the world's Y.
///
/// # Errors
/// If the light is not a bulb, or is gone.
pub fn toggle_orbit(scene: &Scene, id: LightId, time: f64) -> Change {
    let light = scene.lights.get(id).ok_or(Refusal::Gone)?;
    let orbit = light.kind.orbit().ok_or(Refusal::NotABulb)?;
    set_orbit(scene, id, Orbit { on: !orbit.on, ..*orbit }, time, GesturePhase::First)
}

/// Sets the orbit of a bulb from `time` on, keeping its current position.
///
/// # Errors
/// If the speed is not finite, or the light is not a bulb or is gone.
pub fn set_orbit(scene: &Scene, id: LightId, to: Orbit, time: f64, phase: GesturePhase) -> Change {
    if !(to.speed.is_finite() && time.is_finite()) {
        return Err(Refusal::TooLarge);
    }
    try_change_light(scene, id, |light| {
        let orbit = light.kind.orbit_mut().ok_or(Refusal::NotABulb)?;
        let before = std::mem::replace(orbit, Orbit { since: time, ..to });
        if let (true, AnchorMut::Position(position)) = (before.on, light.kind.anchor_mut()) {
            *position = phase.apply(position, before.at(*position.now(), time));
        }
        Ok(())
    })
}

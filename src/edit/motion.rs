//! Motion: the spin of objects and the orbit of bulbs.
//!
//! Whatever of a motion is changed, what has been turned so far goes into the placement first, and
//! the motion begins anew from there: nothing jumps on the screen.

use super::items::change_object;
use super::{GesturePhase, Refusal};
use crate::base::math::Axis;
use crate::scene::{Command, Item, LightId, LightKind, ObjectId, Orbit, Scene, Spin};

/// Lets an object turn about one of its axes, or no longer.
///
/// # Errors
/// If the object is gone.
pub fn toggle_spin(scene: &Scene, id: ObjectId, axis: Axis, time: f64) -> Result<Command, Refusal> {
    let mut spin = scene.objects.get(id).ok_or(Refusal::Gone)?.spin;
    spin.axes[axis.index()] = !spin.axes[axis.index()];
    set_spin(scene, id, spin, time, GesturePhase::First)
}

/// Gives an object another spin, which begins at `time`; what it has turned so far stays.
///
/// # Errors
/// If the speed is not finite, or the object is gone.
pub fn set_spin(
    scene: &Scene,
    id: ObjectId,
    spin: Spin,
    time: f64,
    phase: GesturePhase,
) -> Result<Command, Refusal> {
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

/// Makes what an object has turned so far its placement; it goes on turning.
///
/// # Errors
/// If it does not turn by itself, or is gone.
pub fn apply_spin(scene: &Scene, id: ObjectId, time: f64) -> Result<Command, Refusal> {
    let object = scene.objects.get(id).ok_or(Refusal::Gone)?;
    if !object.spin.is_on() {
        return Err(Refusal::NotSpinning);
    }
    set_spin(scene, id, object.spin, time, GesturePhase::First)
}

/// Lets a bulb circle the world's Y, or no longer.
///
/// # Errors
/// If the light is no bulb, or is gone.
pub fn toggle_orbit(scene: &Scene, id: LightId, time: f64) -> Result<Command, Refusal> {
    let light = scene.lights.get(id).ok_or(Refusal::Gone)?;
    let LightKind::Bulb { orbit, .. } = &light.kind else { return Err(Refusal::NotABulb) };
    set_orbit(scene, id, Orbit { on: !orbit.on, ..*orbit }, time, GesturePhase::First)
}

/// Gives a bulb another orbit, which begins at `time`; it stays where it has come to.
///
/// # Errors
/// If the speed is not finite, the light is no bulb, or is gone.
pub fn set_orbit(
    scene: &Scene,
    id: LightId,
    to: Orbit,
    time: f64,
    phase: GesturePhase,
) -> Result<Command, Refusal> {
    if !(to.speed.is_finite() && time.is_finite()) {
        return Err(Refusal::TooLarge);
    }
    let mut light = scene.lights.get(id).ok_or(Refusal::Gone)?.clone();
    let LightKind::Bulb { position, orbit } = &mut light.kind else {
        return Err(Refusal::NotABulb);
    };
    if orbit.on {
        *position = phase.apply(position, orbit.at(*position.now(), time));
    }
    *orbit = Orbit { since: time, ..to };
    Ok(Command::Replace(Item::Light(id, Box::new(light))))
}

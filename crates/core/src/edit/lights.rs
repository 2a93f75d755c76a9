//! Changes lights: switch, colour, aperture, slot, owner.

use std::collections::BTreeSet;

use glam::DVec3;

use super::items::{change_light, check_owner, try_change_light};
use super::{Change, Refusal, set_transform};
use crate::base::color::Color;
use crate::scene::{
    Aim, AnchorMut, Attenuation, Command, CommandError, HALF_APERTURE, ItemId, LightId, LightKind,
    LightNumber, Orbit, Scene, SpotOwner, Subject, Tracked, View,
};

/// The change of a spot's aperture for a press of `+` or `-`, in degrees.
pub const APERTURE_STEP: f64 = 5.0;

/// A colour channel of a light.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Channel {
    /// The keys q and Q.
    Red,
    /// The keys v and V.
    Green,
    /// The keys a and A.
    Blue,
}

impl Channel {
    const fn name(self) -> &'static str {
        match self {
            Self::Red => "red",
            Self::Green => "green",
            Self::Blue => "blue",
        }
    }
}

/// Returns the kind of a sun that shines straight down.
pub const fn sun() -> LightKind {
    LightKind::Sun { direction: Tracked::new(DVec3::NEG_Y) }
}

/// Returns the kind of a blue sky over a brown ground.
pub const fn sky() -> LightKind {
    LightKind::Sky { ground: Color([92, 84, 76]), panorama: None }
}

/// Returns the kind of a bulb at the origin.
pub fn bulb() -> LightKind {
    LightKind::Bulb { position: Tracked::new(DVec3::ZERO), orbit: Orbit::default() }
}

/// Returns the kind of a spot with default aperture and concentration.
pub const fn spot(owner: SpotOwner) -> LightKind {
    LightKind::Spot { owner, half_aperture: 22.5, exponent: 5.0 }
}

/// Returns the owner of a free spot at the origin that shines along -Z.
pub const fn fixed() -> SpotOwner {
    SpotOwner::Fixed(Tracked::new(Aim { position: DVec3::ZERO, direction: DVec3::NEG_Z }))
}

/// Switches the light in a slot on or off (keys 0 to 9).
///
/// # Errors
/// If the slot is empty.
pub fn toggle_slot(scene: &Scene, slot: u32) -> Change {
    let in_slot = scene.lights.iter().find(|(_, light)| light.slot == slot);
    let (id, _) = in_slot.ok_or(Refusal::EmptySlot(slot))?;
    change_light(scene, id, |light| light.on = !light.on)
}

/// Switches all lights off except the selected one. If it is already alone, switches the lights of
/// `before` back on, or all lights if `before` has no other remaining light.
///
/// # Errors
/// If no light is selected, or it is the only light.
pub fn solo(scene: &Scene, view: &View, before: &BTreeSet<LightId>) -> Change {
    let (own, _) = set_transform::selected_light(scene, view)?;
    if scene.lights.len() < 2 {
        return Err(Refusal::OnlyOne);
    }
    let restores = is_solo(scene, own);
    let some = before.iter().any(|id| *id != own && scene.lights.contains(*id));
    let to = |id: LightId| match restores {
        true => !some || before.contains(&id),
        false => id == own,
    };
    let changed = scene.lights.iter().filter(|(id, light)| light.on != to(*id));
    let commands = changed.map(|(id, _)| change_light(scene, id, |light| light.on = !light.on));
    commands.collect::<Result<_, _>>().map(Command::Batch)
}

/// Returns whether a light is on and all others are off.
pub fn is_solo(scene: &Scene, id: LightId) -> bool {
    scene.lights.len() > 1 && scene.lights.iter().all(|(other, light)| light.on == (other == id))
}

/// Returns the lights that are on.
pub fn lit(scene: &Scene) -> BTreeSet<LightId> {
    scene.lights.iter().filter(|(_, light)| light.on).map(|(id, _)| id).collect()
}

/// Changes one channel of the selected light, within 0 to 255 (keys q Q, v V, a A).
///
/// # Errors
/// At the end of the range, or if the subject is not lights.
pub fn step_color(scene: &Scene, view: &View, channel: Channel, by: i16) -> Change {
    let (id, light) = subject_light(scene, view)?;
    let index = channel as usize;
    let old = light.color.0[index];
    let wish = i16::from(old).saturating_add(by).clamp(0, 255);
    let new = u8::try_from(wish).unwrap_or(old);
    if new == old {
        return Err(Refusal::Limit(channel.name(), u32::from(old)));
    }
    change_light(scene, id, |light| light.color.0[index] = new)
}

/// Changes the aperture of the selected spot by an angle in degrees, within 0 to 90 (+ and -).
///
/// # Errors
/// At the end of the range, for other lights, or if the subject is not lights.
pub fn step_aperture(scene: &Scene, view: &View, degrees: f64) -> Change {
    let (id, light) = subject_light(scene, view)?;
    let old = (HALF_APERTURE.get)(&light.kind).ok_or(Refusal::NotASpot)?;
    let new = (old + degrees).clamp(0.0, HALF_APERTURE.largest);
    if new == old {
        let limit = if degrees < 0.0 { 0 } else { 90 };
        return Err(Refusal::Limit("the half-aperture", limit));
    }
    set_number(scene, id, &HALF_APERTURE, new)
}

/// Sets a number of a light, clamped to its valid range.
///
/// # Errors
/// If the light has no such number, or the number is not finite.
pub fn set_number(scene: &Scene, id: LightId, number: &LightNumber, to: f64) -> Change {
    if !to.is_finite() {
        return Err(Refusal::TooLarge);
    }
    try_change_light(scene, id, |light| {
        let own = (number.get_mut)(&mut light.kind).ok_or(Refusal::NotASpot)?;
        *own = to.clamp(0.0, number.largest);
        Ok(())
    })
}

/// Attaches a spot to another owner.
///
/// # Errors
/// If the light is not a spot, or the owner is not in the scene.
pub fn set_owner(scene: &Scene, id: LightId, to: SpotOwner) -> Change {
    check_owner(scene, &to)?;
    set_transform::unlocked(scene, ItemId::Light(id))?;
    try_change_light(scene, id, |light| match light.kind.anchor_mut() {
        AnchorMut::Owner(owner) => {
            *owner = to;
            Ok(())
        }
        AnchorMut::Everywhere | AnchorMut::Direction(_) | AnchorMut::Position(_) => {
            Err(Refusal::NotASpot)
        }
    })
}

/// Sets the key of a light.
///
/// # Errors
/// If another light has this key.
pub fn set_slot(scene: &Scene, id: LightId, slot: u32) -> Change {
    if scene.lights.iter().any(|(other, light)| other != id && light.slot == slot) {
        return Err(Refusal::SlotTaken(slot));
    }
    change_light(scene, id, |light| light.slot = slot)
}

/// Sets the attenuation of a light with distance.
///
/// # Errors
/// If the light would become infinite or negative.
pub fn set_attenuation(scene: &Scene, id: LightId, to: Attenuation) -> Change {
    if !to.is_valid() {
        return Err(CommandError::Attenuation.into());
    }
    change_light(scene, id, |light| light.attenuation = to)
}

/// Switches the shadows of a light on if they are off, else off.
///
/// # Errors
/// If the light is ambient, or gone.
pub fn toggle_shadows(scene: &Scene, id: LightId) -> Change {
    let light = scene.lights.get(id).ok_or(Refusal::Gone)?;
    set_shadows(scene, id, !light.shadows)
}

/// Sets whether a light casts shadows.
///
/// # Errors
/// If the light is ambient, or gone.
pub fn set_shadows(scene: &Scene, id: LightId, to: bool) -> Change {
    let light = scene.lights.get(id).ok_or(Refusal::Gone)?;
    if !light.can_cast_shadows() {
        return Err(Refusal::NoShadows);
    }
    change_light(scene, id, |light| light.shadows = to)
}

/// Sets the size of a light, within the sizes that its kind allows.
///
/// # Errors
/// If the light is ambient, or gone.
pub fn set_size(scene: &Scene, id: LightId, to: f64) -> Change {
    let light = scene.lights.get(id).ok_or(Refusal::Gone)?;
    if !light.can_cast_shadows() {
        return Err(Refusal::NoShadows);
    }
    let size = if to.is_nan() { 0.0 } else { to.clamp(0.0, light.largest_size()) };
    change_light(scene, id, |light| light.size = size)
}

/// Switches the shadows of the selected light on or off.
///
/// # Errors
/// If no light is selected, or it is ambient.
pub fn toggle_selected_shadows(scene: &Scene, view: &View) -> Change {
    let (id, _) = set_transform::selected_light(scene, view)?;
    toggle_shadows(scene, id)
}

/// Switches the shadows of all lights off if any light casts shadows, else on.
///
/// # Errors
/// If no light can cast shadows.
pub fn toggle_all_shadows(scene: &Scene) -> Change {
    let to = !casts_shadows(scene);
    let able = scene.lights.iter().filter(|(_, light)| light.can_cast_shadows());
    let changed: Vec<Command> = able
        .filter(|(_, light)| light.shadows != to)
        .map(|(id, _)| change_light(scene, id, |light| light.shadows = to))
        .collect::<Result<_, _>>()?;
    if changed.is_empty() { Err(Refusal::NoLight) } else { Ok(Command::Batch(changed)) }
}

/// Returns whether any light of a scene casts shadows.
pub fn casts_shadows(scene: &Scene) -> bool {
    scene.lights.iter().any(|(_, light)| light.can_cast_shadows() && light.shadows)
}

/// Returns the selected light, if the subject is lights.
fn subject_light<'a>(
    scene: &'a Scene,
    view: &View,
) -> Result<(LightId, &'a crate::scene::Light), Refusal> {
    if view.subject != Subject::Light {
        return Err(Refusal::OnlyLights);
    }
    set_transform::selected_light(scene, view)
}

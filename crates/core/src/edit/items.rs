//! Adds, duplicates, renames and removes items, and changes their properties.

use std::collections::BTreeSet;

use glam::{DMat4, DVec3};

use super::names::Names;
use super::{Change, Refusal, set_transform};
use crate::base::Shared;
use crate::scene::{
    AnchorMut, Camera, CameraId, CameraMode, Command, CommandError, Crease, Item, ItemId, Lens,
    Light, LightId, LightKind, MaterialChoice, Model, Object, ObjectId, Pose, Scene, Shape,
    Smoothing, SpotOwner, Tracked,
};

/// The largest number of parts to split at once, which keeps the outline readable.
pub const MOST_PARTS: usize = 1000;

/// Adds an object at the front of the list.
#[must_use]
pub fn insert_object(scene: &Scene, object: Object) -> Command {
    insert_objects(scene, vec![object])
}

/// Adds objects, each at the front of the list, so the last one comes first.
#[must_use]
pub fn insert_objects(scene: &Scene, objects: Vec<Object>) -> Command {
    let mut names: Names<'_> = scene.objects.iter().map(|(_, other)| &*other.name).collect();
    let mut commands = vec![Command::NextId(scene.next_id)];
    let mut next_id = scene.next_id;
    for mut object in objects {
        object.name = names.take(&object.name);
        let item = Item::Object(ObjectId(next_id), Box::new(object));
        commands.push(Command::Insert { at: 0, item });
        next_id += 1;
    }
    commands[0] = Command::NextId(next_id);
    Command::Batch(commands)
}

/// Adds a camera at the origin, looking along -Z, with its model and material (key `F`).
#[must_use]
pub fn insert_camera(scene: &Scene, model: Shared<Model>, material: MaterialChoice) -> Command {
    let number = scene.cameras.len() + 1;
    put_camera(scene, Camera::new(&format!("camera {number}"), model, material, DVec3::ZERO))
}

/// Adds a white light in the lowest free slot.
///
/// # Errors
/// If it is a spot, and the owner is not in the scene.
pub fn insert_light(scene: &Scene, kind: LightKind) -> Change {
    put_light(scene, Light::new(&light_name(&kind), 0, kind))
}

/// Adds a copy of an item, without its stack of transformations. Moves copies of objects by `by`.
///
/// # Errors
/// If the item is gone.
pub fn duplicate(scene: &Scene, id: ItemId, by: DVec3) -> Change {
    match id {
        ItemId::Object(id) => {
            let mut object = scene.objects.get(id).ok_or(Refusal::Gone)?.clone();
            let placement = DMat4::from_translation(by) * *object.placement.now();
            object.placement = Tracked::new(placement);
            Ok(insert_object(scene, object))
        }
        ItemId::Camera(id) => {
            let mut camera = scene.cameras.get(id).ok_or(Refusal::Gone)?.clone();
            camera.pose = Tracked::new(*camera.pose.now());
            Ok(put_camera(scene, camera))
        }
        ItemId::Light(id) => {
            let mut light = scene.lights.get(id).ok_or(Refusal::Gone)?.clone();
            match light.kind.anchor_mut() {
                AnchorMut::Direction(v) | AnchorMut::Position(v) => *v = Tracked::new(*v.now()),
                AnchorMut::Owner(SpotOwner::Fixed(aim)) => *aim = Tracked::new(*aim.now()),
                AnchorMut::Everywhere | AnchorMut::Owner(_) => {}
            }
            put_light(scene, light)
        }
    }
}

/// Removes an item and the spots attached to it.
///
/// # Errors
/// If the item is gone or locked, or is the last camera.
pub fn remove(scene: &Scene, id: ItemId) -> Change {
    if !scene.contains(id) {
        return Err(Refusal::Gone);
    }
    set_transform::unlocked(scene, id)?;
    if matches!(id, ItemId::Camera(_)) && scene.cameras.len() == 1 {
        return Err(CommandError::LastCamera.into());
    }
    // Spots that are attached to the item are removed first, so undo restores the item before them.
    let attached = |light: &Light| {
        let Some(owner) = light.kind.owner() else { return false };
        match owner {
            SpotOwner::Object(owner) => id == ItemId::Object(*owner),
            SpotOwner::Camera(owner) => id == ItemId::Camera(*owner),
            SpotOwner::SelectedObject | SpotOwner::SelectedCamera | SpotOwner::Fixed(_) => false,
        }
    };
    let spots = scene.lights.iter().filter(|(_, light)| attached(light));
    let spots = spots.map(|(spot, _)| Command::Remove(ItemId::Light(spot)));
    let commands: Vec<Command> = spots.chain([Command::Remove(id)]).collect();
    Ok(one_or_batch(commands))
}

/// Renames an item.
///
/// # Errors
/// If the name is empty, or the item is gone.
pub fn rename(scene: &Scene, id: ItemId, name: &str) -> Change {
    let name = name.trim();
    if name.is_empty() {
        return Err(Refusal::NoName);
    }
    let name = name.to_owned();
    match id {
        ItemId::Object(id) => change_object(scene, id, |object| object.name = name),
        ItemId::Camera(id) => change_camera(scene, id, |camera| camera.name = name),
        ItemId::Light(id) => change_light(scene, id, |light| light.name = name),
    }
}

/// Moves an item to another place in its list.
///
/// # Errors
/// If the item is gone.
pub fn reorder(scene: &Scene, id: ItemId, to: usize) -> Change {
    if scene.contains(id) { Ok(Command::Reorder { id, to }) } else { Err(Refusal::Gone) }
}

/// Shows or hides an object or a camera; switches a light on or off.
///
/// # Errors
/// If the item is gone.
pub fn toggle_shown(scene: &Scene, id: ItemId) -> Change {
    match id {
        ItemId::Object(id) => change_object(scene, id, |object| object.visible = !object.visible),
        ItemId::Camera(id) => change_camera(scene, id, |camera| camera.visible = !camera.visible),
        ItemId::Light(id) => change_light(scene, id, |light| light.on = !light.on),
    }
}

/// Locks an item, or unlocks it.
///
/// # Errors
/// If the item is gone.
pub fn toggle_locked(scene: &Scene, id: ItemId) -> Change {
    let locked = !scene.locked.contains(&id);
    if scene.contains(id) { Ok(Command::Lock { id, locked }) } else { Err(Refusal::Gone) }
}

/// Shows or hides one part of an object.
///
/// # Errors
/// If the object is gone, or does not have this part.
pub fn toggle_part(scene: &Scene, id: ObjectId, part: u32) -> Change {
    let object = scene.objects.get(id).ok_or(Refusal::Gone)?;
    if part as usize >= object.model.mesh.parts().len() {
        return Err(Refusal::Gone);
    }
    change_object(scene, id, |object| {
        if !object.hidden_parts.remove(&part) {
            object.hidden_parts.insert(part);
        }
    })
}

/// Splits an object into one object for each part. The object itself keeps the first part, and the
/// others follow it in the list. All share the model.
///
/// # Errors
/// If the object is gone, or has only one part or too many parts.
pub fn split(scene: &Scene, id: ObjectId) -> Change {
    let object = scene.objects.get(id).ok_or(Refusal::Gone)?;
    let at = scene.objects.position(id).ok_or(Refusal::Gone)?;
    let mesh = &object.model.mesh;
    let used: BTreeSet<u32> = mesh.polygon_parts().iter().copied().collect();
    if used.len() < 2 {
        return Err(Refusal::OnePart);
    }
    if used.len() > MOST_PARTS {
        return Err(Refusal::TooManyParts(used.len(), MOST_PARTS));
    }
    let all = 0..u32::try_from(mesh.parts().len()).unwrap_or(u32::MAX);
    let names = part_names(scene, object, &used);
    let mut commands = Vec::with_capacity(used.len() + 1);
    let mut next_id = scene.next_id;
    // Each piece hides all parts but one.
    for (i, (part, name)) in used.iter().zip(names).enumerate() {
        let mut piece = object.clone();
        piece.name = name;
        piece.visible = object.visible && !object.hidden_parts.contains(part);
        piece.hidden_parts = all.clone().filter(|other| other != part).collect();
        if i == 0 {
            commands.push(Command::Replace(Item::Object(id, Box::new(piece))));
        } else {
            piece.placement = Tracked::new(*piece.placement.now());
            let item = Item::Object(ObjectId(next_id), Box::new(piece));
            commands.push(Command::Insert { at: at + i, item });
            next_id += 1;
        }
    }
    commands.push(Command::NextId(next_id));
    Ok(Command::Batch(commands))
}

/// Chooses names for the objects that an object is split into.
fn part_names(scene: &Scene, object: &Object, parts: &BTreeSet<u32>) -> Vec<String> {
    let others = scene.objects.iter().filter(|(_, other)| !std::ptr::eq(*other, object));
    let mut names: Names<'_> = others.map(|(_, other)| &*other.name).collect();
    let name = |part: &u32| names.take(&object.model.mesh.parts()[*part as usize].name);
    parts.iter().map(name).collect()
}

/// Sets the lens of a camera.
///
/// # Errors
/// If the lens is invalid, or the camera is gone.
pub fn set_lens(scene: &Scene, id: CameraId, lens: Lens) -> Change {
    if !lens.is_valid() {
        return Err(CommandError::Lens.into());
    }
    change_camera(scene, id, |camera| camera.lens = lens)
}

/// Returns the reason why a crease angle has no effect on a model; `None` if it has.
pub fn why_no_crease(model: &Model, file_normals: bool) -> Option<&'static str> {
    if Shape::of(model).is_some() {
        Some("the shape has exact normals")
    } else if model.source.is_none() {
        Some("built-in models are always smooth")
    } else if matches!(model.mesh.smoothing(), Smoothing::Groups(_)) {
        Some("the file has smoothing groups, which are used instead")
    } else if file_normals && model.mesh.has_file_normals_only() {
        Some("the file has normals, which are used instead")
    } else {
        None
    }
}

/// Sets the crease angle of an object's model. If another object of the same file already has this
/// angle, its model is shared.
///
/// # Errors
/// If the object is gone, or the angle has no effect on it.
pub fn set_crease(scene: &Scene, id: ObjectId, crease: Crease) -> Change {
    let object = scene.objects.get(id).ok_or(Refusal::Gone)?;
    if let Some(reason) = why_no_crease(&object.model, object.file_normals) {
        return Err(Refusal::NoCrease(reason));
    }
    let now = &object.model;
    let is_wanted =
        |other: &&Shared<Model>| other.options.crease == crease && other.shares_file_with(now);
    let mut others = scene.objects.iter().map(|(_, object)| &object.model);
    let found = others.find(is_wanted).cloned();
    let model = found.unwrap_or_else(|| Shared::new(now.with_crease(crease)));
    change_object(scene, id, |object| object.model = model)
}

/// Changes properties of an object, except its placement and its spin.
///
/// # Errors
/// If the object is gone.
pub fn change_object(scene: &Scene, id: ObjectId, change: impl FnOnce(&mut Object)) -> Change {
    let mut object = scene.objects.get(id).ok_or(Refusal::Gone)?.clone();
    change(&mut object);
    Ok(Command::Replace(Item::Object(id, Box::new(object))))
}

/// Changes properties of all objects in one step, except their placements and spins.
#[must_use]
pub fn change_all_objects(scene: &Scene, change: impl Fn(&mut Object)) -> Command {
    let changed = |id| change_object(scene, id, &change).ok();
    Command::Batch(scene.objects.ids().filter_map(changed).collect())
}

/// Changes properties of a camera, except its pose.
///
/// # Errors
/// If the camera is gone.
pub fn change_camera(scene: &Scene, id: CameraId, change: impl FnOnce(&mut Camera)) -> Change {
    let mut camera = scene.cameras.get(id).ok_or(Refusal::Gone)?.clone();
    change(&mut camera);
    Ok(Command::Replace(Item::Camera(id, Box::new(camera))))
}

/// Sets whether a camera flies or orbits an object, without turning it.
pub(super) fn set_mode(scene: &Scene, id: CameraId, mode: CameraMode) -> Change {
    change_camera(scene, id, |camera| {
        camera.pose = camera.pose.replaced(Pose { mode, ..*camera.pose.now() });
    })
}

/// Changes properties of a light, except its position and direction.
///
/// # Errors
/// If the light is gone.
pub fn change_light(scene: &Scene, id: LightId, change: impl FnOnce(&mut Light)) -> Change {
    try_change_light(scene, id, |light| {
        change(light);
        Ok(())
    })
}

/// Changes a light, unless `change` refuses.
pub(super) fn try_change_light(
    scene: &Scene,
    id: LightId,
    change: impl FnOnce(&mut Light) -> Result<(), Refusal>,
) -> Change {
    let mut light = scene.lights.get(id).ok_or(Refusal::Gone)?.clone();
    change(&mut light)?;
    Ok(Command::Replace(Item::Light(id, Box::new(light))))
}

/// Adds a camera at the end of the list.
pub(super) fn put_camera(scene: &Scene, mut camera: Camera) -> Command {
    let mut names: Names<'_> = scene.cameras.iter().map(|(_, other)| &*other.name).collect();
    camera.name = names.take(&camera.name);
    let id = CameraId(scene.next_id);
    inserted(scene, scene.cameras.len(), Item::Camera(id, Box::new(camera)))
}

/// Adds a light at the end of the list, in the lowest free slot.
pub(super) fn put_light(scene: &Scene, mut light: Light) -> Change {
    if let Some(owner) = light.kind.owner() {
        check_owner(scene, owner)?;
    }
    let mut names: Names<'_> = scene.lights.iter().map(|(_, other)| &*other.name).collect();
    light.name = names.take(&light.name);
    light.slot = scene.free_slot();
    let id = LightId(scene.next_id);
    Ok(inserted(scene, scene.lights.len(), Item::Light(id, Box::new(light))))
}

fn inserted(scene: &Scene, at: usize, item: Item) -> Command {
    Command::Batch(vec![Command::NextId(scene.next_id + 1), Command::Insert { at, item }])
}

/// Returns a single command itself, and a batch of several.
pub(super) fn one_or_batch(mut commands: Vec<Command>) -> Command {
    if commands.len() == 1 { commands.remove(0) } else { Command::Batch(commands) }
}

/// Returns the name of a new light: its kind, after the kind of its owner.
fn light_name(kind: &LightKind) -> String {
    let name = kind.info().name;
    match kind.owner() {
        Some(SpotOwner::SelectedObject | SpotOwner::Object(_)) => format!("object {name}"),
        Some(SpotOwner::SelectedCamera | SpotOwner::Camera(_)) => format!("camera {name}"),
        Some(SpotOwner::Fixed(_)) | None => name.to_owned(),
    }
}

/// Checks that the owner of a spot exists.
pub(super) fn check_owner(scene: &Scene, owner: &SpotOwner) -> Result<(), Refusal> {
    let there = match owner {
        SpotOwner::Object(id) => scene.objects.get(*id).is_some(),
        SpotOwner::Camera(id) => scene.cameras.get(*id).is_some(),
        SpotOwner::SelectedObject | SpotOwner::SelectedCamera | SpotOwner::Fixed(_) => true,
    };
    if there { Ok(()) } else { Err(Refusal::Gone) }
}

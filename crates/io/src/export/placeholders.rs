//! Leaves out the placeholders of missing files: their boxes are not part of the scene.

use marraztu_core::scene::{Command, Item, Object, ObjectId, Scene};

/// Returns the scene without its placeholders, with a note about each. Fails with the reason if the
/// scene is not valid.
pub(super) fn without(scene: &Scene) -> Result<(Scene, Vec<String>), String> {
    let (mut scene, mut notes) = (scene.clone(), Vec::new());
    let lost = |object: &Object| object.missing_files().next().is_some();
    let ids: Vec<ObjectId> =
        scene.objects.iter().filter(|(_, object)| lost(object)).map(|(id, _)| id).collect();
    for id in ids {
        let Some(mut object) = scene.objects.get(id).cloned() else { continue };
        note(&object, &mut notes);
        // It is hidden rather than removed: a spot attached to it keeps its position.
        object.visible &= !object.model.is_placeholder();
        object.texture = object.texture.filter(|texture| !texture.is_placeholder());
        let command = Command::Replace(Item::Object(id, Box::new(object)));
        command.apply(&mut scene).map_err(|error| error.to_string())?;
    }
    Ok((scene, notes))
}

/// Notes which parts of a visible object are left out.
fn note(object: &Object, notes: &mut Vec<String>) {
    if !object.visible {
        return;
    }
    let name = &object.name;
    if let (true, Some(file)) = (object.model.is_placeholder(), &object.model.source) {
        notes.push(format!("{name} is left out: its model {} is missing", file.display()));
    } else if let Some(texture) = &object.texture {
        let file = texture.source.display();
        notes.push(format!("{name} is exported without its texture {file}, which is missing"));
    }
}

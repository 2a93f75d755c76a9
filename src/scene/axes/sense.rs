//! Where an axis means something.

use crate::scene::{Object, Scene, Surface, View};

/// Whether one of the parts that are shown has it; else the reason that is given.
pub(super) fn if_any(
    scene: &Scene,
    view: &View,
    has: fn(&Object, u32) -> bool,
    reason: &'static str,
) -> Result<(), &'static str> {
    let alone = |id| view.object == Some(id);
    let all = !view.only_selected && view.polygons.is_none();
    let shown = scene.objects.iter().filter(|(id, object)| object.visible && (all || alone(*id)));
    let mut parts = shown.flat_map(|(_, object)| {
        let count = u32::try_from(object.model.mesh.parts().len()).unwrap_or(u32::MAX);
        (0..count).filter(|part| !object.hidden_parts.contains(part)).map(move |i| (object, i))
    });
    if parts.any(|(object, part)| has(object, part)) { Ok(()) } else { Err(reason) }
}

pub(super) const fn is_there(_: &Object, _: u32) -> bool {
    true
}

pub(super) fn is_lit(object: &Object, _: u32) -> bool {
    object.surface != Surface::Texture
}

pub(super) fn is_textured(object: &Object, part: u32) -> bool {
    !object.model.mesh.uvs().is_empty() && object.part_look(part).texture.is_some()
}

pub(super) fn is_mirroring(object: &Object, part: u32) -> bool {
    is_lit(object, part) && object.part_look(part).material.specular.iter().any(|ks| *ks > 0.0)
}

//! In which scenes an axis or a choice changes the picture.

use glam::{DMat3, DVec3};

use crate::accuracy::{Samples, Settings};
use crate::scene::{MapKind, Object, Scene, Surface, View};

/// The visible objects.
fn shown<'a>(scene: &'a Scene, view: &'a View) -> impl Iterator<Item = &'a Object> {
    scene.objects.iter().filter(|(id, object)| view.shows(*id, object)).map(|(_, object)| object)
}

/// Checks that a visible part has a property; otherwise returns the given reason.
pub(super) fn if_any(
    scene: &Scene,
    view: &View,
    has: fn(&Object, u32) -> bool,
    reason: &'static str,
) -> Result<(), &'static str> {
    let mut parts =
        shown(scene, view).flat_map(|object| object.shown_parts().map(move |part| (object, part)));
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

/// Whether it may be transparent.
pub(super) fn is_transparent(object: &Object, part: u32) -> bool {
    let look = object.part_look(part);
    let mapped = !object.model.mesh.uvs().is_empty();
    let map = look.map(MapKind::Opacity).filter(|_| mapped);
    let texture = look.texture.filter(|_| mapped);
    let fades = texture.is_some_and(|texture| texture.picture.has_partial_alpha())
        || map.is_some_and(|map| map.texture.picture.fades());
    look.opacity > 0.0 && (look.opacity < 1.0 || fades)
}

/// Whether it is lit and has a height or normal map.
pub(super) fn has_bumps(object: &Object, part: u32) -> bool {
    let look = object.part_look(part);
    let mapped = [MapKind::Bump, MapKind::Normal].iter().any(|kind| look.map(*kind).is_some());
    is_lit(object, part) && mapped && !object.model.mesh.uvs().is_empty()
}

pub(super) fn is_mirroring(object: &Object, part: u32) -> bool {
    is_lit(object, part) && object.part_look(part).material.specular.iter().any(|ks| *ks > 0.0)
}

/// Whether it is lit, and mirrors or refracts.
pub(super) fn asks_for_rays(object: &Object, part: u32) -> bool {
    let look = object.part_look(part);
    is_lit(object, part) && !look.unlit && !look.material.optics.is_none()
}

/// Checks that a visible object has a property; otherwise returns the given reason.
pub(super) fn if_any_object(
    scene: &Scene,
    view: &View,
    is: fn(&Object) -> bool,
    reason: &'static str,
) -> Result<(), &'static str> {
    if shown(scene, view).any(is) { Ok(()) } else { Err(reason) }
}

/// Whether pixels have several samples.
pub(super) fn has_several_samples(settings: &Settings) -> Result<(), &'static str> {
    if settings.samples == Samples::One { Err("a pixel has one sample") } else { Ok(()) }
}

/// Holds for any object.
pub(super) const fn is_any(_: &Object) -> bool {
    true
}

/// Whether it is lit, and transformed by more than rotation, translation and uniform scale.
pub(super) fn is_stretched(object: &Object) -> bool {
    let m = DMat3::from_mat4(*object.placement.now());
    let gram = m.transpose() * m;
    let most = gram.x_axis.x.max(gram.y_axis.y).max(gram.z_axis.z);
    let even = DMat3::from_diagonal(DVec3::splat(gram.x_axis.x));
    object.surface != Surface::Texture && !(gram - even).abs_diff_eq(DMat3::ZERO, 1e-9 * most)
}

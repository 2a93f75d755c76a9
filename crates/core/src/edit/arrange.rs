//! Arranges objects: on the ground, in line with another object, or back at the place in the file.

use glam::{DMat4, DVec3};

use super::{Change, GesturePhase, Refusal, set_transform, steps};
use crate::base::math::Axis;
use crate::scene::{Bounds, Command, ItemId, Object, ObjectId, Scene, View};

/// Returns the bounding box of an object in the world.
pub fn world_box(object: &Object, time: f64) -> Option<Bounds> {
    Bounds::of(object.placed_vertices(time))
}

/// Returns the height of the ground: of the highest visible and level ground or plane shape, else
/// 0. Excludes `id`.
pub fn ground(scene: &Scene, id: ObjectId) -> f64 {
    let planes = scene
        .objects
        .iter()
        .filter(|(other, object)| *other != id && object.visible && is_level_ground(object));
    planes.map(|(_, plane)| plane.placement.now().w_axis.y).reduce(f64::max).unwrap_or(0.0)
}

/// Returns whether an object is a level ground or plane shape.
pub(super) fn is_level_ground(object: &Object) -> bool {
    let up = object.placement.now().y_axis.truncate();
    steps::is_ground(object) && up.x.abs().max(up.z.abs()) <= 1e-9 * up.y.abs()
}

/// Moves the selected object up or down until its lowest point is at the height of the ground.
///
/// # Errors
/// If no object is selected, or it is empty, locked, or already on the ground.
pub fn drop_to_ground(scene: &Scene, view: &View, phase: GesturePhase) -> Change {
    let (id, object) = set_transform::selected_object(scene, view)?;
    let bounds = world_box(object, view.time).ok_or(Refusal::NoPolygons)?;
    let by = ground(scene, id) - bounds.min.y;
    if by.abs() <= rounding(&bounds) {
        return Err(Refusal::OnGround);
    }
    moved(scene, view, id, DVec3::Y * by, phase)
}

/// Resets the selected object to the placement of its file.
///
/// # Errors
/// If no object is selected, or it is locked or has not been moved.
pub fn reset(scene: &Scene, view: &View, phase: GesturePhase) -> Change {
    let (id, object) = set_transform::selected_object(scene, view)?;
    if *object.placement.now() == DMat4::IDENTITY {
        return Err(Refusal::NotTransformed);
    }
    set_transform::object(scene, view, id, DMat4::IDENTITY, phase)
}

/// Moves the objects among `others` along an axis of the world until the centres of their boxes are
/// in line with the centre of the selected object's box.
///
/// # Errors
/// If the list has no such objects, or all of them are locked or already in line.
pub fn align(
    scene: &Scene,
    view: &View,
    others: &[ItemId],
    axis: Axis,
    phase: GesturePhase,
) -> Change {
    let (_, object) = set_transform::selected_object(scene, view)?;
    let to = world_box(object, view.time).ok_or(Refusal::NoPolygons)?;
    let (mut commands, mut refused) = (Vec::new(), Refusal::NothingToAlign);
    for other in others {
        let ItemId::Object(id) = *other else { continue };
        let object = scene.objects.get(id);
        let Some(from) = object.and_then(|object| world_box(object, view.time)) else { continue };
        let by = (to.centre() - from.centre())[axis.index()];
        if by.abs() <= rounding(&to).max(rounding(&from)) {
            continue;
        }
        match moved(scene, view, id, axis.unit() * by, phase) {
            Ok(command) => commands.push(command),
            Err(why) => refused = why,
        }
    }
    if commands.is_empty() { Err(refused) } else { Ok(Command::Batch(commands)) }
}

/// Returns a distance that may be due to the rounding of a box's coordinates.
fn rounding(bounds: &Bounds) -> f64 {
    1e-12 * bounds.max.abs().max(bounds.min.abs()).max_element()
}

/// Moves an object along the world's axes.
fn moved(scene: &Scene, view: &View, id: ObjectId, by: DVec3, phase: GesturePhase) -> Change {
    let placement = *scene.objects.get(id).ok_or(Refusal::Gone)?.placement.now();
    let to = DMat4::from_translation(by) * placement;
    set_transform::object(scene, view, id, to, phase)
}

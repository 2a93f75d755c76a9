//! The selection and the subject, and how they follow changes of the scene.
//!
//! Selections are not undo steps, with one exception: while the selected camera is in analysis,
//! selecting another object aims the camera at it. A selection is therefore a view and sometimes a
//! command.

use std::hash::Hash;

use super::items::{one_or_batch, set_mode};
use super::{GesturePhase, Refusal, set_transform};
use crate::scene::{
    CameraMode, Command, Item, ItemId, List, ObjectId, Observer, PolygonMode, Scene, Subject,
    Transformation, View,
};

/// A view after a selection, with the command that belongs to it.
#[derive(Clone, Debug, PartialEq)]
pub struct Selection {
    /// The new view.
    pub view: View,
    /// Aims the selected camera at the newly selected object, if it is in analysis.
    pub command: Option<Command>,
}

/// Selects an item in its list. The subject stays.
///
/// # Errors
/// If the item is gone.
pub fn select(scene: &Scene, view: &View, id: ItemId) -> Result<Selection, Refusal> {
    select_in(scene, view, id, GesturePhase::First)
}

/// Selects an item as part of a gesture: a held key pushes the camera's pose only once.
fn select_in(
    scene: &Scene,
    view: &View,
    id: ItemId,
    phase: GesturePhase,
) -> Result<Selection, Refusal> {
    if !scene.contains(id) {
        return Err(Refusal::Gone);
    }
    let mut next = view.clone();
    let mut commands = Vec::new();
    match id {
        ItemId::Camera(id) => next.camera = id,
        ItemId::Light(id) => next.light = Some(id),
        ItemId::Object(id) if view.object == Some(id) => {}
        ItemId::Object(id) => {
            next.object = Some(id);
            next.polygons = view.polygons.as_ref().map(|_| PolygonMode::begin());
            // A camera in analysis turns to the new object, unless the camera is locked.
            let camera = scene.selected_camera(view);
            let mode = camera.pose.now().mode_with(view.object);
            let locked = scene.locked.contains(&ItemId::Camera(view.camera));
            if let (CameraMode::Analysis { .. }, Some(object), false) =
                (mode, scene.objects.get(id), locked)
            {
                let aimed = set_transform::aimed(camera.pose.now(), id, object.centre(view.time));
                let mut camera = camera.clone();
                camera.pose = phase.apply(&camera.pose, aimed);
                commands.push(Command::Replace(Item::Camera(view.camera, Box::new(camera))));
            } else {
                commands.extend(left_in_fly(scene, id));
            }
        }
    }
    keep_polygons(scene, &mut next);
    let command = (!commands.is_empty()).then(|| one_or_batch(commands));
    Ok(Selection { view: next, command })
}

/// Switches cameras to fly if their analysis of an object ended when another object was selected.
/// Selecting the object again must not resume the analysis, since the cameras have not been aimed
/// at it.
fn left_in_fly(scene: &Scene, id: ObjectId) -> Vec<Command> {
    let fallen = scene
        .cameras
        .iter()
        .filter(|(_, camera)| camera.pose.now().mode == CameraMode::Analysis { target: id });
    fallen.filter_map(|(id, _)| set_mode(scene, id, CameraMode::Fly).ok()).collect()
}

/// Selects an item and makes its kind the subject, as a click in the outline does.
///
/// # Errors
/// If the item is gone.
pub fn pick(scene: &Scene, view: &View, id: ItemId) -> Result<Selection, Refusal> {
    let mut selection = select(scene, view, id)?;
    set_subject(&mut selection.view, subject_of(id));
    Ok(selection)
}

/// Selects the next item of the subject, cyclically (key Tab).
///
/// # Errors
/// If the list has no other item.
pub fn next(scene: &Scene, view: &View, phase: GesturePhase) -> Result<Selection, Refusal> {
    fn after<K: Copy + Eq + Hash, T, D>(list: &List<K, T, D>, id: Option<K>) -> Option<K> {
        list.after(id).filter(|next| Some(*next) != id)
    }
    let id = match view.subject {
        Subject::Camera => after(&scene.cameras, Some(view.camera)).map(ItemId::Camera),
        Subject::Object if scene.objects.is_empty() => return Err(Refusal::NoObject),
        Subject::Object => after(&scene.objects, view.object).map(ItemId::Object),
        Subject::Light if scene.lights.is_empty() => return Err(Refusal::NoLight),
        Subject::Light => after(&scene.lights, view.light).map(ItemId::Light),
    };
    select_in(scene, view, id.ok_or(Refusal::OnlyOne)?, phase)
}

/// Returns the item that the subject's keys act on.
pub fn selected(view: &View) -> Option<ItemId> {
    match view.subject {
        Subject::Camera => Some(ItemId::Camera(view.camera)),
        Subject::Object => view.object.map(ItemId::Object),
        Subject::Light => view.light.map(ItemId::Light),
    }
}

/// Returns the subject for items of this kind.
pub const fn subject_of(id: ItemId) -> Subject {
    match id {
        ItemId::Object(_) => Subject::Object,
        ItemId::Camera(_) => Subject::Camera,
        ItemId::Light(_) => Subject::Light,
    }
}

/// Changes the subject: camera, object, light, camera ... (key `c`).
pub const fn cycle_subject(view: &mut View) {
    let next = match view.subject {
        Subject::Camera => Subject::Object,
        Subject::Object => Subject::Light,
        Subject::Light => Subject::Camera,
    };
    set_subject(view, next);
}

/// Sets the subject of the keys. If scaling was chosen, leaving objects returns to translation.
pub const fn set_subject(view: &mut View, subject: Subject) {
    view.subject = subject;
    if !matches!(subject, Subject::Object) && matches!(view.transformation, Transformation::Scaling)
    {
        view.transformation = Transformation::Translation;
    }
}

/// Sets the transformation (keys `t`, `r` and `s`).
///
/// # Errors
/// If `to` is scaling and the subject is not objects.
pub fn set_transformation(view: &mut View, to: Transformation) -> Result<(), Refusal> {
    if to == Transformation::Scaling && view.subject != Subject::Object {
        return Err(Refusal::OnlyObjectsScale);
    }
    view.transformation = to;
    Ok(())
}

/// Switches the observer between the selected camera and the selected object (key `C`).
///
/// # Errors
/// If the scene has no object.
pub fn toggle_observer(scene: &Scene, view: &mut View) -> Result<(), Refusal> {
    view.observer = match view.observer {
        Observer::Object => Observer::Camera,
        Observer::Camera => {
            set_transform::selected_object(scene, view)?;
            Observer::Object
        }
    };
    Ok(())
}

/// Switches polygon mode on, from polygon 0, or off (key `o`).
///
/// # Errors
/// If no object is selected, or it has no polygons.
pub fn toggle_polygons(scene: &Scene, view: &mut View) -> Result<(), Refusal> {
    view.polygons = match view.polygons {
        Some(_) => None,
        None => {
            polygon_count(scene, view)?;
            Some(PolygonMode::begin())
        }
    };
    Ok(())
}

/// Selects the next polygon of the selected object, cyclically (key Enter).
///
/// # Errors
/// Outside polygon mode.
pub fn next_polygon(scene: &Scene, view: &mut View) -> Result<(), Refusal> {
    let count = polygon_count(scene, view)?;
    let mode = view.polygons.as_mut().ok_or(Refusal::NotInPolygonMode)?;
    mode.go_to(if mode.current < count - 1 { mode.current + 1 } else { 0 });
    Ok(())
}

/// Selects a polygon of the selected object, as a click on it does.
///
/// # Errors
/// Outside polygon mode, and if the object has no such polygon.
pub fn go_to_polygon(scene: &Scene, view: &mut View, polygon: u32) -> Result<(), Refusal> {
    let count = polygon_count(scene, view)?;
    let mode = view.polygons.as_mut().ok_or(Refusal::NotInPolygonMode)?;
    if polygon >= count {
        return Err(Refusal::Gone);
    }
    mode.go_to(polygon);
    Ok(())
}

/// Adapts the view to a scene that has changed from `before`, after each command. New items are
/// selected. If the selected item is gone, the next one in its list is selected, or else the one
/// before.
pub fn follow(before: &Scene, scene: &Scene, view: &mut View) {
    view.light = scene.lights.first_since(&before.lights).or(view.light);
    view.camera = scene.cameras.first_since(&before.cameras).unwrap_or(view.camera);
    let object = scene.objects.first_since(&before.objects).or(view.object);
    select_object(view, object);
    remain(before, scene, view);
}

/// Adapts the view to a scene that has changed from `before`, and keeps the selection. If the
/// selected item is gone, the next one in its list is selected, or else the one before.
pub(super) fn remain(before: &Scene, scene: &Scene, view: &mut View) {
    select_object(view, remaining(&before.objects, &scene.objects, view.object));
    view.light = remaining(&before.lights, &scene.lights, view.light);
    let camera = remaining(&before.cameras, &scene.cameras, Some(view.camera));
    view.camera = camera.unwrap_or(view.camera);
    settle(scene, view);
}

/// Selects an object or no object. Polygon mode restarts if the object changes.
pub(super) fn select_object(view: &mut View, object: Option<ObjectId>) {
    if object != view.object {
        view.object = object;
        view.polygons = view.polygons.as_ref().map(|_| PolygonMode::begin());
    }
}

/// Adapts the view to the scene: selected items and polygons must exist.
pub fn settle(scene: &Scene, view: &mut View) {
    if scene.cameras.get(view.camera).is_none() {
        view.camera = scene.cameras.first().unwrap_or(view.camera);
    }
    if view.object.is_none_or(|id| !scene.objects.contains(id)) {
        view.object = scene.objects.first();
        view.polygons = view.polygons.as_ref().map(|_| PolygonMode::begin());
    }
    if view.light.is_none_or(|id| !scene.lights.contains(id)) {
        view.light = scene.lights.first();
    }
    if view.object.is_none() {
        view.observer = Observer::Camera;
    }
    // A view from a file may have scaling chosen for a camera or a light.
    set_subject(view, view.subject);
    keep_polygons(scene, view);
}

/// Returns the selected item of a list after a change: the same item, or the nearest remaining one.
fn remaining<K: Copy + Eq + Hash, T, D>(
    before: &List<K, T, D>,
    after: &List<K, T, D>,
    selected: Option<K>,
) -> Option<K> {
    let is_there = |id: &K| after.contains(*id);
    if let Some(kept) = selected.filter(is_there) {
        return Some(kept);
    }
    let Some(at) = selected.and_then(|id| before.position(id)) else { return after.first() };
    // Search the items after it, then the items before it from near to far.
    let onwards = (at + 1..before.len()).map_while(|at| before.id_at(at));
    let back = (0..at).rev().map_while(|at| before.id_at(at));
    onwards.chain(back).find(is_there)
}

fn polygon_count(scene: &Scene, view: &View) -> Result<u32, Refusal> {
    let (_, object) = set_transform::selected_object(scene, view)?;
    match u32::try_from(object.model.mesh.polygon_count()) {
        Ok(0) | Err(_) => Err(Refusal::NoPolygons),
        Ok(count) => Ok(count),
    }
}

/// Ends polygon mode if the object has no polygons, and restarts it if the polygon is out of range.
fn keep_polygons(scene: &Scene, view: &mut View) {
    let count = polygon_count(scene, view).unwrap_or(0);
    match &mut view.polygons {
        Some(_) if count == 0 => view.polygons = None,
        Some(mode) => {
            mode.shown.retain(|polygon| *polygon < count);
            if mode.current >= count {
                *mode = PolygonMode::begin();
            }
        }
        None => {}
    }
}

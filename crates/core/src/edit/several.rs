//! Applies an action to all selected items.
//!
//! The action is applied to each item in turn, as if it were the selected one, in the scene that
//! the earlier items have left. If some items refuse the action, it is done for the others; only if
//! all refuse, the action is refused.

use std::collections::BTreeSet;

use super::{Change, Refusal, items, selection};
use crate::scene::{
    CameraId, Command, ItemId, Light, LightId, Object, ObjectId, Scene, Subject, View,
};

/// The items that are selected in addition to the one that the keys act on.
///
/// They belong to that item: once another item is selected alone, they are no longer selected.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Others {
    with: Option<ItemId>,
    items: BTreeSet<ItemId>,
}

impl Others {
    /// Selects these items in addition to `with`.
    pub fn new(with: ItemId, items: impl IntoIterator<Item = ItemId>) -> Self {
        let items = items.into_iter().filter(|item| *item != with).collect();
        Self { with: Some(with), items }
    }

    /// Returns the items that are now selected in addition to the one that the keys act on.
    pub fn of<'a>(
        &'a self,
        scene: &'a Scene,
        view: &View,
    ) -> impl Iterator<Item = ItemId> + use<'a> {
        let valid = self.with.is_some() && self.with == selection::selected(view);
        self.items.iter().copied().filter(move |item| valid && scene.contains(*item))
    }
}

/// Combines the commands that `act` returns for the selected item and for each of the others.
///
/// # Errors
/// The refusal for the selected item, if all items refuse.
pub fn each(
    scene: &Scene,
    view: &View,
    others: &[ItemId],
    act: impl Fn(&Scene, &View) -> Change,
) -> Change {
    if others.is_empty() {
        return act(scene, view);
    }
    let mut after = scene.clone();
    let (mut commands, mut refused) = (Vec::new(), None);
    for id in selection::selected(view).into_iter().chain(others.iter().copied()) {
        // An earlier command may have removed this item, too.
        if !after.contains(id) {
            continue;
        }
        match act(&after, &as_if_selected(view, id)) {
            Ok(command) => {
                command.clone().apply(&mut after)?;
                commands.push(command);
            }
            Err(why) => refused = refused.or(Some(why)),
        }
    }
    match (commands.is_empty(), refused) {
        (true, refused) => Err(refused.unwrap_or(Refusal::Gone)),
        (false, _) => Ok(Command::Batch(commands)),
    }
}

/// Returns the view with this item as the selected one.
fn as_if_selected(view: &View, id: ItemId) -> View {
    let mut view = view.clone();
    view.subject = selection::subject_of(id);
    match id {
        ItemId::Object(id) => view.object = Some(id),
        ItemId::Camera(id) => view.camera = id,
        ItemId::Light(id) => view.light = Some(id),
    }
    view
}

/// Shows or hides all of these items, whichever the selected one does.
///
/// # Errors
/// If the selected item is gone.
pub fn toggle_shown(scene: &Scene, view: &View, others: &[ItemId]) -> Change {
    let shown = |scene: &Scene, id| match id {
        ItemId::Object(id) => scene.objects.get(id).is_some_and(|object| object.visible),
        ItemId::Camera(id) => scene.cameras.get(id).is_some_and(|camera| camera.visible),
        ItemId::Light(id) => scene.lights.get(id).is_some_and(|light| light.on),
    };
    let first = selection::selected(view).ok_or(Refusal::Gone)?;
    let before = shown(scene, first);
    let others: Vec<ItemId> =
        others.iter().copied().filter(|id| shown(scene, *id) == before).collect();
    each(scene, view, &others, |scene, view| {
        items::toggle_shown(scene, selection::selected(view).ok_or(Refusal::Gone)?)
    })
}

/// Locks or unlocks all of these items, whichever the selected one does.
///
/// # Errors
/// If the selected item is gone.
pub fn toggle_locked(scene: &Scene, view: &View, others: &[ItemId]) -> Change {
    let first = selection::selected(view).ok_or(Refusal::Gone)?;
    let before = scene.locked.contains(&first);
    let alike = |id: &ItemId| scene.locked.contains(id) == before;
    let others: Vec<ItemId> = others.iter().copied().filter(alike).collect();
    each(scene, view, &others, |scene, view| {
        items::toggle_locked(scene, selection::selected(view).ok_or(Refusal::Gone)?)
    })
}

/// Applies `act` to each selected object, as [`each`] does to each item.
///
/// # Errors
/// If no object is selected, or all refuse.
pub fn each_object(
    scene: &Scene,
    view: &View,
    others: &[ItemId],
    act: impl Fn(&Scene, &View, ObjectId) -> Change,
) -> Change {
    each(scene, view, others, |scene, view| match selection::selected(view) {
        Some(ItemId::Object(id)) => act(scene, view, id),
        Some(ItemId::Camera(_) | ItemId::Light(_)) | None => Err(Refusal::NoObject),
    })
}

/// Applies `act` to each selected camera, as [`each`] does to each item.
///
/// # Errors
/// If no camera is selected, or all refuse.
pub fn each_camera(
    scene: &Scene,
    view: &View,
    others: &[ItemId],
    act: impl Fn(&Scene, &View, CameraId) -> Change,
) -> Change {
    each(scene, view, others, |scene, view| match selection::selected(view) {
        Some(ItemId::Camera(id)) => act(scene, view, id),
        Some(ItemId::Object(_) | ItemId::Light(_)) | None => Err(Refusal::Gone),
    })
}

/// Applies `act` to each selected light, as [`each`] does to each item.
///
/// # Errors
/// If no light is selected, or all refuse.
pub fn each_light(
    scene: &Scene,
    view: &View,
    others: &[ItemId],
    act: impl Fn(&Scene, &View, LightId) -> Change,
) -> Change {
    each(scene, view, others, |scene, view| match selection::selected(view) {
        Some(ItemId::Light(id)) => act(scene, view, id),
        Some(ItemId::Object(_) | ItemId::Camera(_)) | None => Err(Refusal::NoLight),
    })
}

/// Changes all selected objects, even if the first one has the new value already.
///
/// # Errors
/// If no object is selected.
pub fn change_objects(
    scene: &Scene,
    view: &View,
    others: &[ItemId],
    change: impl Fn(&mut Object),
) -> Change {
    each_object(scene, view, others, |scene, _, id| items::change_object(scene, id, &change))
}

/// Changes all selected lights, even if the first one has the new value already.
///
/// # Errors
/// If no light is selected.
pub fn change_lights(
    scene: &Scene,
    view: &View,
    others: &[ItemId],
    change: impl Fn(&mut Light),
) -> Change {
    each_light(scene, view, others, |scene, _, id| items::change_light(scene, id, &change))
}

/// Returns all listed items of the subject's list. If all of these are already selected, the listed
/// items of all lists.
pub fn all(
    scene: &Scene,
    view: &View,
    others: &[ItemId],
    listed: impl Fn(ItemId) -> bool,
) -> Vec<ItemId> {
    let listed = |id: &ItemId| listed(*id);
    let objects = || scene.objects.ids().map(ItemId::Object).filter(listed);
    let cameras = || scene.cameras.ids().map(ItemId::Camera).filter(listed);
    let lights = || scene.lights.ids().map(ItemId::Light).filter(listed);
    let own: Vec<ItemId> = match view.subject {
        Subject::Object => objects().collect(),
        Subject::Camera => cameras().collect(),
        Subject::Light => lights().collect(),
    };
    let is_selected = |id: &ItemId| others.contains(id) || selection::selected(view) == Some(*id);
    match own.iter().all(is_selected) {
        true => objects().chain(cameras()).chain(lights()).collect(),
        false => own,
    }
}

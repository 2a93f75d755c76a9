//! The selection before and after a step of the history.
//!
//! The view is not part of a step, so undo and redo keep the selection. The exception is an item
//! that they bring back: it is selected again if it was selected when it left.

use super::selection::{self, remain, select_object, set_subject};
use super::several::Others;
use crate::scene::{CameraId, ItemId, LightId, ObjectId, Scene, Subject, View};

/// The selection before or after a step.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Selected {
    subject: Subject,
    object: Option<ObjectId>,
    camera: CameraId,
    light: Option<LightId>,
    others: Others,
}

impl Selected {
    /// Records the selection of a view, with the other selected items.
    pub fn of(view: &View, others: &Others) -> Self {
        let View { subject, object, camera, light, .. } = *view;
        Self { subject, object, camera, light, others: others.clone() }
    }

    /// Returns the item that the keys acted on.
    fn item(&self) -> Option<ItemId> {
        match self.subject {
            Subject::Camera => Some(ItemId::Camera(self.camera)),
            Subject::Object => self.object.map(ItemId::Object),
            Subject::Light => self.light.map(ItemId::Light),
        }
    }

    /// Adapts the view to a scene that undo or redo has changed from `before`. The selection stays,
    /// except that items that came back are selected as recorded here. If the selected item has
    /// left, the recorded item takes its place.
    pub fn restore(&self, before: &Scene, scene: &Scene, view: &mut View, others: &mut Others) {
        let came_back = |id: ItemId| scene.contains(id) && !before.contains(id);
        let has_left = |id: ItemId| !scene.contains(id);
        let takes = |here: Option<ItemId>, now: Option<ItemId>| {
            let is_free = now.is_none_or(has_left);
            here.is_some_and(|here| came_back(here) || (is_free && scene.contains(here)))
        };
        let acts_again = self.item().is_some_and(came_back);
        let acted_on_left = selection::selected(view).is_some_and(has_left);
        if takes(self.object.map(ItemId::Object), view.object.map(ItemId::Object)) {
            select_object(view, self.object);
        }
        if takes(Some(ItemId::Camera(self.camera)), Some(ItemId::Camera(view.camera))) {
            view.camera = self.camera;
        }
        if takes(self.light.map(ItemId::Light), view.light.map(ItemId::Light)) {
            view.light = self.light;
        }
        if acts_again || (acted_on_left && self.item().is_some_and(|id| scene.contains(id))) {
            set_subject(view, self.subject);
            *others = self.others.clone();
        }
        remain(before, scene, view);
    }
}

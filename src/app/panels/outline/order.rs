//! Reorders items in the lists of the outline, by buttons or by dragging.

use egui::Ui;

use crate::app::actions::{Requests, change};
use crate::app::state::State;
use crate::app::theme;
use marraztu_core::edit::{Gesture, items, selection};
use marraztu_core::scene::ItemId;

/// Returns the index of an item in its list, and the length of the list.
pub(crate) fn place(state: &State, id: ItemId) -> Option<(usize, usize)> {
    let scene = &state.scene;
    Some(match id {
        ItemId::Object(id) => (scene.objects.position(id)?, scene.objects.len()),
        ItemId::Camera(id) => (scene.cameras.position(id)?, scene.cameras.len()),
        ItemId::Light(id) => (scene.lights.position(id)?, scene.lights.len()),
    })
}

/// Moves an item to another index in its list.
pub(super) fn reorder(state: &State, requests: &mut Requests, id: ItemId, to: usize) {
    let label = format!("Move {} in the list", state.name(id).unwrap_or_default());
    change(requests, label, Gesture::Whole, items::reorder(&state.scene, id, to));
}

/// Lets the line of `onto` accept an item of its kind that is dragged there.
pub(super) fn take_dragged(
    ui: &Ui,
    state: &State,
    requests: &mut Requests,
    response: &egui::Response,
    onto: ItemId,
) {
    let Some(dragged) = response.dnd_hover_payload::<ItemId>() else { return };
    let same_list = selection::subject_of(*dragged) == selection::subject_of(onto);
    let (Some((from, _)), Some((at, _))) = (place(state, *dragged), place(state, onto)) else {
        return;
    };
    let pointer = ui.input(|input| input.pointer.hover_pos());
    let below = pointer.is_some_and(|pointer| pointer.y > response.rect.center().y);
    if !same_list || *dragged == onto {
        return;
    }
    let y = if below { response.rect.bottom() } else { response.rect.top() };
    ui.painter().hline(response.rect.x_range(), y, theme::ring(ui.visuals()));
    if response.dnd_release_payload::<ItemId>().is_some() {
        // The item is removed first, which moves the items after it up by one.
        let before = at + usize::from(below);
        let to = if from < before { before - 1 } else { before };
        if to != from {
            reorder(state, requests, *dragged, to);
        }
    }
}

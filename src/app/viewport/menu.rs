//! The context menu of the item under the pointer.

use egui::{Id, Ui};

use super::Viewport;
use crate::app::actions::{ADD_LIGHTS, ADD_OBJECTS, Action, Request, Requests};
use crate::app::state::State;
use marraztu_core::scene::ItemId;

impl Viewport {
    /// Shows the menu while it is open.
    pub(super) fn menu_ui(&self, ui: &Ui, state: &State, requests: &mut Requests) {
        let Some(menu) = self.menu else { return };
        let popup = egui::Popup::new(id(), ui.ctx().clone(), menu.at, ui.layer_id())
            .kind(egui::PopupKind::Menu)
            .layout(egui::Layout::top_down_justified(egui::Align::Min))
            .style(egui::containers::menu::menu_style)
            .accessible_name("Viewport menu")
            .open_memory(None);
        popup.show(|ui| {
            let (actions, others): (_, [&[Action]; 2]) =
                match menu.item.filter(|item| state.scene.contains(*item)) {
                    Some(item) => {
                        // The actions of one of several selected items act on all of them.
                        match state.is_selected(item) {
                            true => ui.weak(state.acted_on_name()),
                            false => ui.weak(state.name(item).unwrap_or_default()),
                        };
                        ui.separator();
                        (actions_on(item), [&[]; 2])
                    }
                    None => (ON_NOTHING, [&ADD_OBJECTS, &ADD_LIGHTS]),
                };
            for action in actions.iter().chain(others.into_iter().flatten()) {
                requests.extend(action.menu_item(ui, state).map(Request::Do));
            }
        });
    }
}

/// The menu of the background; the objects and lights to add follow it.
const ON_NOTHING: &[Action] = &[Action::FrameAll, Action::Paste, Action::AddCamera];

const fn actions_on(item: ItemId) -> &'static [Action] {
    match item {
        ItemId::Object(_) => &[
            Action::FrameSelection,
            Action::WhyUnseen,
            Action::TogglePolygons,
            Action::ToggleOthers,
            Action::ToggleVisible,
            Action::ToggleLocked,
            Action::Rename,
            Action::Duplicate,
            Action::Split,
            Action::ChooseTexture,
            Action::DropToGround,
            Action::AddObjectSpot,
            Action::TakeBack,
            Action::Delete,
        ],
        ItemId::Camera(_) => &[
            Action::ToggleVisible,
            Action::ToggleLocked,
            Action::Rename,
            Action::Duplicate,
            Action::AddCameraSpot,
            Action::TakeBack,
            Action::Delete,
        ],
        ItemId::Light(_) => &[
            Action::ToggleShadows,
            Action::AimAtSelection,
            Action::AimByClick,
            Action::SoloLight,
            Action::ToggleVisible,
            Action::ToggleLocked,
            Action::Rename,
            Action::Duplicate,
            Action::TakeBack,
            Action::Delete,
        ],
    }
}

pub(super) fn id() -> Id {
    Id::unique("viewport menu")
}

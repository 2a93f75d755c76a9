//! A line of the outline: an item, or a part of one.

use egui::{
    Color32, Id, Key, Popup, Pos2, Rect, Response, Role, Sense, TextEdit, TextStyle, Ui,
    WidgetInfo, pos2, text::CCursorRange, vec2,
};

use super::order::take_dragged;
use crate::app::actions::{Action, Also, Request, Requests, change};
use crate::app::state::State;
use crate::app::theme;
use crate::app::widgets::controls::{self, icon_at};
use crate::app::widgets::icons::Icon;
use crate::app::widgets::regions;
use marraztu_core::edit::{Gesture, items};
use marraztu_core::scene::{ItemId, ObjectId, Scene};

/// The distance of the icons from the left end of the line.
const INDENT: f32 = 20.0;

/// A line with an item.
pub(crate) struct Row {
    pub(crate) item: ItemId,
    pub(crate) rect: Rect,
    /// Whether Tab stops at the line and its buttons.
    pub(crate) is_stop: bool,
    /// Whether its parts are listed.
    pub(crate) unfolded: bool,
}

/// Returns the id of an item's line.
pub(crate) fn id(ui: &Ui, item: ItemId) -> Id {
    ui.scope_id().with(("item", item))
}

/// Returns the index of the item with a focused button in its line.
pub(crate) fn busy(ui: &Ui, items: &[ItemId]) -> Option<usize> {
    let focused = ui.memory(egui::Memory::focused)?;
    let scope = ui.scope_id();
    let buttons =
        |item: &ItemId| ["shown", "parts", "locked"].map(|button| scope.with((button, *item)));
    items.iter().position(|item| buttons(item).contains(&focused))
}

/// Shows an item. Returns whether the user folds or unfolds its parts.
pub(crate) fn item_ui(ui: &mut Ui, state: &State, requests: &mut Requests, row: &Row) -> bool {
    let Row { item, rect, is_stop, unfolded } = *row;
    let name = state.name(item).unwrap_or_default();
    let response =
        ui.interact(rect, id(ui, item), regions::sense(Sense::click_and_drag(), is_stop));
    let is_subject = state.is_selected(item);
    response.widget_info(|| WidgetInfo::selected(Role::ListBoxOption, true, is_subject, name));
    ground(ui, state, item, rect, &response);
    response.dnd_set_drag_payload(item);
    take_dragged(ui, state, requests, &response, item);
    let shown = state.is_shown(item).unwrap_or_default();
    let color = ground_color(ui, is_subject, shown);
    let icon = Rect::from_min_size(rect.min + vec2(INDENT, 0.0), vec2(16.0, rect.height()));
    Icon::of(&state.scene, item).paint(ui.painter(), icon, 13.0, color);
    // Buttons are placed from the right, and the name takes the rest.
    let mut right = shown_ui(ui, state, requests, row, shown);
    right = lock_ui(ui, state, requests, row, (right, response.hovered()));
    if let ItemId::Light(id) = item
        && let Some(light) = state.scene.lights.get(id)
    {
        right = light_ui(ui, light.color.opaque(), light.slot, pos2(right, rect.center().y));
    }
    let text = Rect::from_x_y_ranges(icon.right() + 5.0..=right - theme::GAP, rect.y_range());
    if state.renaming == Some(item) {
        rename_ui(ui, requests, text, name);
    } else {
        let missing = is_missing(&state.scene, item);
        let color = if missing { ui.visuals().warn_fg_color } else { color };
        let name = if missing { format!("{name} (missing)") } else { name.to_owned() };
        let galley = controls::text(ui, &name, TextStyle::Body, text.width());
        controls::put_text(ui, text, galley, color);
    }
    controls::focus_ring(ui, rect, &response);
    clicks(state, requests, item, &response);
    fold_ui(ui, state, row, unfolded, color)
}

fn is_missing(scene: &Scene, item: ItemId) -> bool {
    match item {
        ItemId::Object(id) => {
            scene.objects.get(id).is_some_and(|object| object.missing_files().next().is_some())
        }
        ItemId::Camera(id) => {
            scene.cameras.get(id).is_some_and(|camera| camera.missing_file().is_some())
        }
        ItemId::Light(id) => {
            scene.lights.get(id).is_some_and(|light| light.missing_file().is_some())
        }
    }
}

/// Draws the background of the line: filled for the item that the keys act on, marked at the left
/// for the selected item of each list.
fn ground(ui: &Ui, state: &State, item: ItemId, rect: Rect, response: &Response) {
    let view = &state.view;
    let selected = match item {
        ItemId::Object(id) => view.object == Some(id),
        ItemId::Camera(id) => view.camera == id,
        ItemId::Light(id) => view.light == Some(id),
    };
    let visuals = ui.visuals();
    if state.selected() == Some(item) {
        ui.painter().rect_filled(rect, 4.0, visuals.selection.bg_fill);
    } else if state.is_selected(item) {
        // Other selected items have a frame and a weaker fill.
        ui.painter().rect_filled(rect, 4.0, visuals.selection.bg_fill.gamma_multiply(0.55));
        let edge = egui::Stroke::new(1.0, theme::accent(visuals));
        ui.painter().rect_stroke(rect, 4.0, edge, egui::StrokeKind::Inside);
    } else if response.hovered() {
        ui.painter().rect_filled(rect, 4.0, visuals.widgets.inactive.bg_fill);
    }
    if selected {
        let bar = Rect::from_min_size(rect.min + vec2(0.0, 3.0), vec2(3.0, rect.height() - 6.0));
        ui.painter().rect_filled(bar, 1.5, theme::accent(visuals));
    }
}

fn ground_color(ui: &Ui, selected: bool, shown: bool) -> Color32 {
    let visuals = ui.visuals();
    match (selected, shown) {
        (true, _) => visuals.selection.stroke.color,
        (false, true) => visuals.text_color(),
        (false, false) => visuals.weak_text_color(),
    }
}

/// Shows the eye, or the switch of a light. Returns the x position of its left end.
fn shown_ui(ui: &Ui, state: &State, requests: &mut Requests, row: &Row, shown: bool) -> f32 {
    let Row { item, rect, is_stop, .. } = *row;
    let (icon, verb) = match (item, shown) {
        (ItemId::Light(_), true) => (Icon::ON, "Switch off"),
        (ItemId::Light(_), false) => (Icon::OFF, "Switch on"),
        (_, true) => (Icon::EYE, "Hide"),
        (_, false) => (Icon::EYE_CLOSED, "Show"),
    };
    let label = format!("{verb} {}", state.name(item).unwrap_or_default());
    let rect = Rect::from_min_max(pos2(rect.right() - theme::ROW, rect.top()), rect.max);
    let sense = regions::sense(Sense::click(), is_stop);
    let response = ui.interact(rect, ui.scope_id().with(("shown", item)), sense);
    icon_at(ui, rect, &response, icon, &label, true);
    let key = match item {
        ItemId::Light(id) => state.scene.lights.get(id).map(|light| light.slot),
        ItemId::Object(_) | ItemId::Camera(_) => None,
    };
    let clicked = response.clicked();
    // With Alt, a click isolates the item.
    let alone = clicked && response.ctx.input(|input| input.modifiers.alt);
    response.on_hover_ui(|ui| {
        ui.label(&label);
        match item {
            ItemId::Light(_) => drop(ui.weak("Alt + click: only this light, or all again")),
            ItemId::Object(_) => drop(ui.weak("Alt + click: only this object, or all again")),
            ItemId::Camera(_) => {}
        }
        if let Some(key) = key.filter(|key| *key < 10) {
            ui.weak(format!("Key: {key}"));
        }
    });
    match item {
        ItemId::Light(_) if alone => {
            requests.extend([Request::Select(item), Request::Do(Action::SoloLight)]);
        }
        ItemId::Object(_) if alone => {
            requests.extend([Request::Select(item), Request::Do(Action::ToggleOthers)]);
        }
        ItemId::Object(_) | ItemId::Camera(_) | ItemId::Light(_) if clicked => {
            change(requests, label, Gesture::Whole, items::toggle_shown(&state.scene, item));
        }
        ItemId::Object(_) | ItemId::Camera(_) | ItemId::Light(_) => {}
    }
    rect.left()
}

/// The width of the lock.
const LOCK: f32 = 16.0;

/// Shows the lock with its right end at `right`. A closed lock is always visible, an open one while
/// the pointer or the focus is on the line. Returns the x position of its left end.
fn lock_ui(
    ui: &Ui,
    state: &State,
    requests: &mut Requests,
    row: &Row,
    (right, hovered): (f32, bool),
) -> f32 {
    let Row { item, rect, is_stop, .. } = *row;
    let locked = state.scene.locked.contains(&item);
    let verb = if locked { "Unlock" } else { "Lock" };
    let label = format!("{verb} {}", state.name(item).unwrap_or_default());
    let rect = Rect::from_x_y_ranges(right - LOCK..=right, rect.y_range());
    let sense = regions::sense(Sense::click(), is_stop);
    let response = ui.interact(rect, ui.scope_id().with(("locked", item)), sense);
    if locked || hovered || response.hovered() || response.has_focus() {
        let icon = if locked { Icon::LOCK } else { Icon::LOCK_OPEN };
        icon_at(ui, rect, &response, icon, &label, true);
    } else {
        response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &label));
    }
    let hint = "Locked: cannot be clicked in the picture, moved or deleted";
    if response.on_hover_text(format!("{label}\n{hint}")).clicked() {
        change(requests, label, Gesture::Whole, items::toggle_locked(&state.scene, item));
    }
    rect.left()
}

/// Shows the colour and the key of a light with their right end at `at`. Returns the x position of
/// their left end.
fn light_ui(ui: &Ui, color: [u8; 4], slot: u32, at: Pos2) -> f32 {
    let left = controls::key_cap(ui, at, &slot.to_string(), true) - theme::GAP;
    let rect = Rect::from_center_size(pos2(left - 6.0, at.y), vec2(12.0, 12.0));
    let [r, g, b, _] = color;
    // A disk, since a white square would look like a checkbox.
    let line = egui::Stroke::new(1.0, ui.visuals().weak_text_color());
    ui.painter().circle(rect.center(), 5.5, Color32::from_rgb(r, g, b), line);
    rect.left()
}

/// Returns the id of the name being typed.
fn new_name() -> Id {
    Id::unique("new name")
}

/// Forgets a name that was typed but not confirmed.
pub(crate) fn forget_new_name(ui: &Ui) {
    ui.data_mut(|data| data.remove_temp::<String>(new_name()));
}

/// Shows a field for a new name. Enter or a click outside confirms the name, Esc cancels.
fn rename_ui(ui: &mut Ui, requests: &mut Requests, rect: Rect, name: &str) {
    let id = new_name();
    let begun: Option<String> = ui.data(|data| data.get_temp(id));
    let mut text = begun.clone().unwrap_or_else(|| name.to_owned());
    let field = TextEdit::singleline(&mut text)
        .id(id)
        .align(egui::Align2::LEFT_CENTER)
        .margin(vec2(3.0, 1.0));
    let response = ui.put(rect.shrink2(vec2(0.0, 1.0)), field).accessible_name("New name");
    // At first the whole name is selected, so typing replaces it.
    if begun.is_none() {
        response.request_focus();
        let mut state = TextEdit::load_state(ui.ctx(), id).unwrap_or_default();
        state.cursor.set_char_range(Some(CCursorRange::select_all_str(&text)));
        state.store(ui.ctx(), id);
    } else if !response.has_focus() {
        let given_up = ui.input(|input| input.key_pressed(Key::Escape));
        ui.data_mut(|data| data.remove_temp::<String>(id));
        requests.push(Request::EndRename((!given_up).then_some(text)));
        return;
    }
    ui.data_mut(|data| data.insert_temp(id, text));
}

/// Lists the items from the selected one to another. If they are in different lists, only the other
/// one is listed.
fn range_to(state: &State, item: ItemId) -> Vec<ItemId> {
    let scene = &state.scene;
    let list: Vec<ItemId> = match item {
        ItemId::Object(_) => scene.objects.ids().map(ItemId::Object).collect(),
        ItemId::Camera(_) => scene.cameras.ids().map(ItemId::Camera).collect(),
        ItemId::Light(_) => scene.lights.ids().map(ItemId::Light).collect(),
    };
    let place = |of: Option<ItemId>| list.iter().position(|other| Some(*other) == of);
    match (place(state.selected()), place(Some(item))) {
        (Some(from), Some(to)) => list[from.min(to)..=from.max(to)].to_vec(),
        _ => vec![item],
    }
}

/// Handles clicks on the line.
fn clicks(state: &State, requests: &mut Requests, item: ItemId, response: &Response) {
    if response.double_clicked() {
        requests.push(Request::BeginRename(item));
    } else if response.clicked() {
        // As in file managers, Ctrl toggles an item and Shift selects a range.
        let (also, range) =
            response.ctx.input(|input| (input.modifiers.command, input.modifiers.shift));
        requests.push(match (also, range) {
            (true, _) => Request::SelectAlso(vec![item], Also::Toggle),
            (false, true) => Request::SelectAlso(range_to(state, item), Also::Only),
            (false, false) => Request::Select(item),
        });
    } else if response.secondary_clicked() && !state.is_selected(item) {
        requests.push(Request::Select(item));
    }
    Popup::context_menu(response).show(|ui| {
        ui.set_min_width(160.0);
        let mut actions =
            vec![Action::Rename, Action::Duplicate, Action::Delete, Action::ToggleLocked];
        match item {
            ItemId::Object(_) => actions.extend([
                Action::ToggleVisible,
                Action::FrameSelection,
                Action::ToggleOthers,
                Action::WhyUnseen,
                Action::DropToGround,
                Action::Split,
                Action::ChooseTexture,
            ]),
            ItemId::Camera(_) => actions.push(Action::ToggleVisible),
            ItemId::Light(_) => actions.extend([
                Action::SoloLight,
                Action::ToggleShadows,
                Action::AimAtSelection,
                Action::AimByClick,
            ]),
        }
        if is_missing(&state.scene, item) {
            actions.insert(0, Action::FindMissing);
        }
        for action in actions {
            requests.extend(action.menu_item(ui, state).map(Request::from));
        }
    });
}

/// Shows the arrow of an object with several parts. Returns whether it was clicked.
fn fold_ui(ui: &Ui, state: &State, row: &Row, unfolded: bool, color: Color32) -> bool {
    let Row { item, rect, is_stop, .. } = *row;
    let ItemId::Object(id) = item else { return false };
    let Some(object) = state.scene.objects.get(id) else { return false };
    if object.model.mesh.parts().len() < 2 {
        return false;
    }
    let rect = Rect::from_min_size(rect.min + vec2(4.0, 0.0), vec2(15.0, rect.height()));
    let sense = regions::sense(Sense::click(), is_stop);
    let response = ui.interact(rect, ui.scope_id().with(("parts", item)), sense);
    let label = format!("Parts of {}", object.name);
    response.widget_info(|| WidgetInfo::selected(Role::DisclosureTriangle, true, unfolded, &label));
    let icon = if unfolded { Icon::DOWN } else { Icon::RIGHT };
    icon.paint(ui.painter(), rect, 8.0, color);
    controls::focus_ring(ui, rect, &response);
    response.on_hover_text("Lists the parts of the model, to hide or show each").clicked()
}

/// Shows a part of an object in `rect`.
pub(crate) fn part_ui(
    ui: &Ui,
    state: &State,
    requests: &mut Requests,
    id: ObjectId,
    part: u32,
    rect: Rect,
) {
    let Some(object) = state.scene.objects.get(id) else { return };
    let parts = object.model.mesh.parts();
    let Some(name) = usize::try_from(part).ok().and_then(|part| parts.get(part)) else { return };
    let name = if name.name.is_empty() { "(unnamed)" } else { &name.name };
    let shown = !object.hidden_parts.contains(&part);
    let (icon, verb) = if shown { (Icon::EYE, "Hide") } else { (Icon::EYE_CLOSED, "Show") };
    let label = format!("{verb} part {name}");
    let button = Rect::from_min_max(pos2(rect.right() - theme::ROW, rect.top()), rect.max);
    let response = ui.interact(button, ui.scope_id().with(("part", id, part)), Sense::click());
    icon_at(ui, button, &response, icon, &label, true);
    let color = ground_color(ui, false, shown && object.visible);
    let mark = Rect::from_min_size(rect.min + vec2(INDENT + 16.0, 0.0), vec2(12.0, rect.height()));
    Icon::PART.paint(ui.painter(), mark, 9.0, color);
    let text = Rect::from_x_y_ranges(mark.right() + 5.0..=button.left(), rect.y_range());
    controls::put_text(ui, text, controls::text(ui, name, TextStyle::Body, text.width()), color);
    if response.on_hover_text(&label).clicked() {
        change(requests, label, Gesture::Whole, items::toggle_part(&state.scene, id, part));
    }
}

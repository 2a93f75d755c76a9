//! The cheat sheet: mouse input, and every key with its current effect. It also changes keys.

use egui::{Id, Key, RichText, ScrollArea, TextStyle, Ui, Window, vec2};

use crate::app::actions::search::{Search, Texts};
use crate::app::actions::{Action, Group, KeyRequest, MouseInfo, Request, Requests};
use crate::app::input::keyboard::Keyboard;
use crate::app::input::keymap::Keymap;
use crate::app::panels::Panel;
use crate::app::state::State;
use crate::app::theme;
use crate::app::widgets::controls;

const WIDTH: f32 = 900.0;
const KEYS: f32 = 170.0;
const LABEL: f32 = 150.0;
const NOW: f32 = 36.0;

pub(crate) fn show(ui: &mut Ui, state: &State, requests: &mut Requests) {
    let mut open = true;
    let room = ui.ctx().content_rect().size() - vec2(80.0, 120.0);
    Window::new("Keys")
        .open(&mut open)
        .collapsible(false)
        .resizable(false)
        .default_pos(ui.ctx().content_rect().center() - vec2(WIDTH.min(room.x), room.y) / 2.0)
        .fixed_size(vec2(WIDTH.min(room.x), room.y.min(520.0)))
        .show(ui.ctx(), |ui| contents(ui, state, requests));
    if !open {
        requests.push(Request::Keys(KeyRequest::Cancel));
        requests.push(Action::Panel(Panel::CheatSheet).into());
    }
}

fn contents(ui: &mut Ui, state: &State, requests: &mut Requests) {
    let id = Id::unique("search among the keys");
    // If the previous pass did not show the panel, it was just opened: the old search is cleared.
    let pass = ui.ctx().cumulative_pass_nr();
    let last = ui.data_mut(|data| {
        let last = data.get_temp::<u64>(id);
        data.insert_temp(id, pass);
        last
    });
    let just_opened = last.is_none_or(|last| last + 1 < pass);
    let mut wanted: String = ui.data(|data| data.get_temp(id)).unwrap_or_default();
    if just_opened {
        wanted.clear();
    }
    let field = egui::TextEdit::singleline(&mut wanted)
        .hint_text("Search actions and keys")
        .align(egui::Align2::LEFT_CENTER)
        .min_size(vec2(0.0, theme::ROW))
        .desired_width(f32::INFINITY);
    let response = ui.add(field).accessible_name("Search among the keys");
    if just_opened {
        response.request_focus();
    }
    if response.lost_focus() && ui.input(|input| input.key_pressed(Key::Escape)) {
        requests.push(Action::Panel(Panel::CheatSheet).into());
    }
    ui.data_mut(|data| data.insert_temp(id, wanted.clone()));
    let keymap = Keyboard::keymap(ui.ctx());
    let changes = changes_ui(ui, &keymap, requests);
    if ui.data_mut(|data| data.remove_temp::<bool>(switched_id())).is_some() {
        // The switch returns the focus to the search, where typed letters trigger no actions.
        response.request_focus();
    }
    choosing_ui(ui, &keymap, requests);
    ui.add_space(theme::GAP);
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        let mut search = Search::new(&wanted);
        // Mouse input cannot be changed.
        let mut found = !changes && mouse_ui(ui, &mut search);
        for group in Group::ALL {
            let actions: Vec<Action> = group
                .actions()
                .filter(|it| it.score(keymap.keys(*it), &mut search, &wanted).is_some())
                .collect();
            if actions.is_empty() {
                continue;
            }
            found = true;
            ui.add_space(theme::GAP);
            ui.label(RichText::new(group.label()).strong());
            for action in actions {
                if changes {
                    change_ui(ui, &keymap, requests, action);
                } else {
                    line(ui, state, requests, action);
                }
            }
        }
        if !found {
            ui.weak("No action or key matches.");
        }
    });
}

/// Returns the id of the flag for a click on the switch in this frame.
fn switched_id() -> Id {
    Id::unique("changing keys was switched")
}

/// Shows the switch between using and changing keys. Returns whether keys are being changed.
fn changes_ui(ui: &mut Ui, keymap: &Keymap, requests: &mut Requests) -> bool {
    let id = Id::unique("keys are changed");
    let mut changes = ui.data(|data| data.get_temp(id)).unwrap_or(false);
    ui.horizontal(|ui| {
        let size = vec2(KEYS, theme::ROW);
        let switch = |ui: &mut Ui| controls::Switch::new("Change keys", changes).ui(ui);
        let layout = egui::Layout::left_to_right(egui::Align::Center);
        if ui.allocate_ui_with_layout(size, layout, switch).inner.clicked() {
            changes ^= true;
            ui.data_mut(|data| data.insert_temp(switched_id(), true));
            ui.data_mut(|data| data.insert_temp(id, changes));
            requests.push(Request::Keys(KeyRequest::Cancel));
        }
        let any = *keymap != Keymap::default();
        if changes && ui.add_enabled(any, egui::Button::new("Reset all keys")).clicked() {
            requests.push(Request::Keys(KeyRequest::ResetAll));
        }
    });
    changes
}

/// Asks for a key, or reports that another action has the chosen key.
fn choosing_ui(ui: &mut Ui, keymap: &Keymap, requests: &mut Requests) {
    let Some((action, chord)) = Keyboard::choosing(ui.ctx()) else { return };
    let label = action.info().label;
    let Some(chord) = chord else {
        ui.label(format!("Press a key for \"{label}\"; Esc cancels."));
        return;
    };
    let Some(other) = keymap.clash(action, chord) else {
        requests.push(Request::Keys(KeyRequest::Take(action, chord)));
        return;
    };
    ui.horizontal_wrapped(|ui| {
        let has = other.info().label;
        let text = format!("{chord} is already the key of \"{has}\".");
        ui.colored_label(theme::error(ui.visuals()), text);
        if ui.button(format!("Use it for \"{label}\"")).clicked() {
            requests.push(Request::Keys(KeyRequest::Take(action, chord)));
        }
        if ui.button("Keep it").clicked() {
            requests.push(Request::Keys(KeyRequest::Cancel));
        }
    });
}

/// Shows an action with a button that changes its key.
fn change_ui(ui: &mut Ui, keymap: &Keymap, requests: &mut Requests, action: Action) {
    let label = action.info().label;
    ui.horizontal(|ui| {
        let keys: Vec<String> = keymap.keys(action).iter().map(|key| key.name()).collect();
        let text = if keys.is_empty() { "none".to_owned() } else { keys.join(", ") };
        let button = egui::Button::new(text).min_size(vec2(KEYS - theme::GAP, theme::ROW));
        let button = ui.add(button).accessible_name(format!("Key of {label}"));
        if button.on_hover_text("Chooses another key").clicked() {
            requests.push(Request::Keys(KeyRequest::Choose(action)));
        }
        ui.label(label);
        if keymap.is_chosen(action) {
            let reset = ui.small_button("Reset").accessible_name(format!("Reset key of {label}"));
            if reset.clicked() {
                requests.push(Request::Keys(KeyRequest::Reset(action)));
            }
        }
    });
}

/// Lists the mouse input that matches the search. Returns whether any matches.
fn mouse_ui(ui: &mut Ui, search: &mut Search) -> bool {
    let mut fits = |mouse: &&MouseInfo| {
        let words = format!("{} {}", mouse.words, mouse.inputs.join(" ").to_lowercase());
        search.score(Texts { label: mouse.label, words: &words, hint: mouse.hint }).is_some()
    };
    let all: Vec<&MouseInfo> = MouseInfo::ALL.iter().filter(&mut fits).collect();
    if all.is_empty() {
        return false;
    }
    ui.add_space(theme::GAP);
    ui.label(RichText::new(MouseInfo::HEADING).strong());
    for mouse in &all {
        let size = vec2(ui.available_width(), theme::ROW);
        let (rect, response) = ui.allocate_exact_size(size, egui::Sense::hover());
        let said = format!("{}: {}", mouse.inputs.join(" or "), mouse.hint);
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, &said));
        let inputs = mouse.inputs.iter().map(|input| (*input).to_owned());
        let columns = Columns { label: mouse.label, now: "", hint: mouse.hint, enabled: true };
        columns.show(ui, rect, inputs);
        if rect.width() < WIDTH / 2.0 {
            response.on_hover_text(mouse.hint);
        }
    }
    true
}

/// The texts of a line after its keys.
struct Columns<'a> {
    label: &'a str,
    now: &'a str,
    hint: &'a str,
    enabled: bool,
}

impl Columns<'_> {
    fn show(&self, ui: &Ui, rect: egui::Rect, keys: impl IntoIterator<Item = String>) {
        let Self { label, now, hint, enabled } = *self;
        let mut left = rect.left() + theme::GAP;
        for key in keys {
            let width = controls::key_width(ui, &key);
            let at = egui::pos2(left + width, rect.center().y);
            controls::key_cap(ui, at, &key, enabled);
            left += width + theme::GAP;
        }
        let color = controls::text_color(ui, enabled);
        let text = |text: &str, width| controls::text(ui, text, TextStyle::Body, width);
        let name = rect.with_min_x(rect.left() + KEYS).with_max_x(rect.left() + KEYS + LABEL);
        controls::put_text(ui, name, text(label, name.width()), color);
        let now_rect = rect.with_min_x(name.right() + theme::GAP);
        controls::put_text(ui, now_rect, text(now, NOW), color);
        let rest = rect.with_min_x(name.right() + NOW).with_max_x(rect.right() - theme::GAP);
        let weak = ui.visuals().weak_text_color();
        controls::put_text(ui, rest, text(hint, rest.width()), weak);
    }
}

/// Shows an action; a click performs it.
fn line(ui: &mut Ui, state: &State, requests: &mut Requests, action: Action) {
    let info = action.info();
    let available = action.availability(state);
    let enabled = available.is_ok();
    let size = vec2(ui.available_width(), theme::ROW);
    let sense = if enabled { egui::Sense::click() } else { egui::Sense::hover() };
    let (rect, response) = ui.allocate_exact_size(size, sense);
    let on = action.is_on(state);
    response.widget_info(|| match on {
        Some(on) => {
            egui::WidgetInfo::selected(egui::Role::MenuItemCheckBox, enabled, on, info.label)
        }
        None => egui::WidgetInfo::labeled(egui::Role::MenuItem, enabled, info.label),
    });
    if enabled && response.hovered() {
        ui.painter().rect_filled(rect, 4.0, ui.visuals().widgets.inactive.bg_fill);
    }
    let now = match on {
        Some(true) => "on",
        Some(false) => "off",
        None => "",
    };
    let hint =
        available.as_ref().err().map_or(info.hint.to_owned(), |why| format!("Unavailable: {why}."));
    let keymap = Keyboard::keymap(ui.ctx());
    let keys = keymap.keys(action).iter().flat_map(|key| key.names());
    Columns { label: info.label, now, hint: &hint, enabled }.show(ui, rect, keys);
    controls::focus_ring(ui, rect, &response);
    if action.explain(response, state).clicked() {
        requests.push(action.into());
    }
}

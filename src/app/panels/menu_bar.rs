//! The menus, generated from the table of actions, and the buttons next to them.

use egui::{
    Align, Atom, IdSalt, Layout, MenuBar, Rect, Role, ScrollArea, Sense, Stroke, StrokeKind,
    TextStyle, Ui, WidgetInfo, pos2, vec2,
};

use super::{history, undo_buttons};
use crate::app::actions::{Action, Group, LabRequest, Request, Requests};
use crate::app::input::buttons::first_key;
use crate::app::panels::Panel;
use crate::app::state::State;
use crate::app::theme;
use crate::app::widgets::controls;
use crate::app::widgets::icons::Icon;
use crate::app::widgets::text::file_name;
use marraztu_io::{EXAMPLES, lessons};

/// The actions of [`Group::Window`] in the submenu for themes.
const THEMES: [Action; 3] = [Action::ThemeSystem, Action::ThemeLight, Action::ThemeDark];

const HELP: [Action; 4] = [
    Action::Palette,
    Action::Panel(Panel::CheatSheet),
    Action::ToPanels,
    Action::Panel(Panel::About),
];

/// The action of another group in the Edit menu.
const PREFERENCES: [Action; 1] = [Action::Panel(Panel::Preferences)];

/// Actions that begin a new section of a menu: a separator precedes each of them.
const PARTS: [Action; 23] = [
    Action::Load,
    Action::Save,
    Action::SavePicture,
    Action::ExportModels,
    Action::Quit,
    Action::Rename,
    Action::Cut,
    Action::SelectAll,
    Action::ToggleVisible,
    Action::SubjectCamera,
    Action::ToggleFrame,
    Action::DropToGround,
    Action::StepXUp,
    Action::AddCamera,
    Action::AddSky,
    Action::ToggleBackFaces,
    Action::ExplainPixel,
    Action::PreviousView,
    Action::LookFront,
    Action::WhyUnseen,
    Action::SoloLight,
    Action::AimAtSelection,
    Action::RedUp,
];

/// The actions of File that begin a scene or add to it.
const OPENS: [Action; 4] = [Action::New, Action::NewAncestor, Action::Open, Action::Load];

/// The actions that scale the interface.
const SIZES: [Action; 3] = [Action::LargerText, Action::SmallerText, Action::NormalText];

pub(crate) fn show(ui: &mut Ui, state: &State, requests: &mut Requests) {
    MenuBar::new().ui(ui, |ui| {
        ui.spacing_mut().button_padding.x = 8.0;
        menu(ui, "File", |ui| {
            // Recent files and examples follow the actions that open files; Quit is last.
            let (begin, rest): (Vec<Action>, Vec<Action>) =
                Group::File.actions().partition(|action| OPENS.contains(action));
            items(ui, state, requests, begin);
            submenu(ui, "Recent files", |ui| recent_ui(ui, state, requests));
            submenu(ui, "Examples", |ui| examples_ui(ui, requests));
            ui.separator();
            items(ui, state, requests, rest);
        });
        menu(ui, "Edit", |ui| {
            group_ui(ui, state, requests, Group::Edit);
            ui.separator();
            submenu(ui, "History", |ui| {
                ui.set_min_width(200.0);
                if history::list_ui(ui, state, f32::INFINITY, requests) {
                    ui.close();
                }
            });
            submenu(ui, "Select", |ui| group_ui(ui, state, requests, Group::Select));
            submenu(ui, "Transform", |ui| group_ui(ui, state, requests, Group::Transform));
            ui.separator();
            items(ui, state, requests, PREFERENCES);
        });
        menu(ui, "Add", |ui| group_ui(ui, state, requests, Group::Add));
        menu(ui, "View", |ui| {
            items(
                ui,
                state,
                requests,
                Group::Show.actions().filter(|it| !Group::OVER_PICTURE.contains(it)),
            );
            ui.separator();
            submenu(ui, "Over the picture", |ui| items(ui, state, requests, Group::OVER_PICTURE));
            submenu(ui, "Camera", |ui| group_ui(ui, state, requests, Group::Camera));
            // The ten lights with keys would fill the menu, so they have a submenu.
            let has_slot = |action: &Action| action.slot().is_some();
            let (slots, rest): (Vec<Action>, Vec<Action>) =
                Group::Light.actions().partition(has_slot);
            submenu(ui, "Light", |ui| items(ui, state, requests, rest));
            submenu(ui, "Lights on and off", |ui| items(ui, state, requests, slots));
        });
        menu(ui, "Window", |ui| {
            // The Window menu has the actions of its group that no other menu shows.
            let elsewhere = [&THEMES[..], &HELP, &PREFERENCES, &SIZES].concat();
            let own = Group::Window.actions().filter(|action| !elsewhere.contains(action));
            items(ui, state, requests, own);
            ui.separator();
            submenu(ui, "Size", |ui| items(ui, state, requests, SIZES));
            submenu(ui, "Theme", |ui| items(ui, state, requests, THEMES));
        });
        menu(ui, "Help", |ui| {
            items(ui, state, requests, HELP);
            ui.separator();
            submenu(ui, "Lessons", |ui| lessons_ui(ui, requests));
        });
        ui.add_space(theme::GAP);
        // In a very narrow window, the menus take all of the width.
        if ui.available_width() >= 2.0 * theme::ROW + theme::GAP {
            undo_buttons::show(ui, state, requests);
        }
        if ui.available_width() >= SEARCH + theme::GAP {
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                search_ui(ui, state, requests);
            });
        }
    });
}

/// The width of the button that opens the palette.
const SEARCH: f32 = 170.0;

/// Shows a button that opens the palette and looks like its search field.
fn search_ui(ui: &mut Ui, state: &State, requests: &mut Requests) {
    let action = Action::Palette;
    let (rect, response) = ui.allocate_exact_size(vec2(SEARCH, theme::ROW), Sense::click());
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, action.info().label));
    let visuals = ui.visuals();
    let hovered = response.hovered();
    let (field, weak) = (visuals.extreme_bg_color, visuals.weak_text_color());
    let line = Stroke::new(1.0, if hovered { weak } else { theme::line(visuals) });
    ui.painter().rect(rect.shrink(0.5), 4.0, field, line, StrokeKind::Inside);
    let icon = Rect::from_min_size(rect.min, vec2(theme::ROW, rect.height()));
    Icon::SEARCH.paint(ui.painter(), icon, 12.0, weak);
    let key = first_key(ui, action).unwrap_or_default();
    let end = pos2(rect.right() - theme::GAP, rect.center().y);
    let right = controls::key_cap(ui, end, &key, true) - theme::GAP;
    let room = rect.with_min_x(icon.right()).with_max_x(right);
    let name = controls::text(ui, "Search", TextStyle::Body, room.width());
    controls::put_text(ui, room, name, weak);
    controls::focus_ring(ui, rect, &response);
    if action.explain(response, state).clicked() {
        requests.push(action.into());
    }
}

fn menu(ui: &mut Ui, name: &str, add: impl FnOnce(&mut Ui)) {
    ui.menu_button(name, |ui| within_window(ui, add));
}

/// Shows the entries of a menu; in a low window they scroll.
fn within_window(ui: &mut Ui, add: impl FnOnce(&mut Ui)) {
    ui.set_min_width(200.0);
    let most = (ui.ctx().content_rect().height() - 2.0 * theme::ROW - 16.0).max(80.0);
    // A menu that would leave the window moves up before it scrolls.
    let area = ScrollArea::vertical().max_height(most).min_scrolled_height(most);
    // The scroll bar lies next to the entries, not over their keys.
    area.content_margin(theme::SCROLL_MARGIN).show(ui, |ui| {
        ui.set_min_width(200.0);
        add(ui);
    });
}

/// Shows a submenu. Its name is aligned with the names of actions, after the column of ticks.
fn submenu(ui: &mut Ui, name: &str, add: impl FnOnce(&mut Ui)) {
    let ticks = Atom::custom(IdSalt::new("tick"), vec2(12.0, 12.0));
    let shown = ui.menu_button((ticks, name), |ui| within_window(ui, add));
    shown.response.widget_info(|| WidgetInfo::labeled(Role::MenuItem, true, name));
}

fn group_ui(ui: &mut Ui, state: &State, requests: &mut Requests, group: Group) {
    items(ui, state, requests, group.actions());
}

fn items(
    ui: &mut Ui,
    state: &State,
    requests: &mut Requests,
    actions: impl IntoIterator<Item = Action>,
) {
    for (i, action) in actions.into_iter().enumerate() {
        if i > 0 && PARTS.contains(&action) {
            ui.separator();
        }
        requests.extend(action.menu_item(ui, state).map(Request::from));
    }
}

/// Lists the built-in scenes; a click opens one in place of this scene.
fn examples_ui(ui: &mut Ui, requests: &mut Requests) {
    for example in EXAMPLES {
        let response = ui.button(example.title);
        response.widget_info(|| WidgetInfo::labeled(Role::MenuItem, true, example.title));
        if response.clicked() {
            requests.push(Request::LoadFiles(vec![example.path.into()]));
            ui.close();
        }
    }
}

/// Lists the files opened or saved last; a click loads a model or opens a scene.
fn recent_ui(ui: &mut Ui, state: &State, requests: &mut Requests) {
    if state.recent.is_empty() {
        ui.weak("No files yet");
    }
    for path in &state.recent {
        let name = file_name(path);
        let response = ui.button(&name);
        response.widget_info(|| WidgetInfo::labeled(Role::MenuItem, true, &name));
        if response.on_hover_text(path.display().to_string()).clicked() {
            requests.push(Request::LoadFiles(vec![path.clone()]));
            ui.close();
        }
    }
}

/// Lists the lessons; a click shows one in its scene.
fn lessons_ui(ui: &mut Ui, requests: &mut Requests) {
    for lesson in lessons() {
        let response = ui.button(&lesson.title);
        response.widget_info(|| WidgetInfo::labeled(Role::MenuItem, true, &lesson.title));
        if response.on_hover_text(&lesson.why).clicked() {
            requests.push(Request::Lab(LabRequest::ShowLesson(&lesson.axis)));
            ui.close();
        }
    }
}

//! The outline: the list of objects, cameras and lights.
//!
//! All lines have the same height, so only the visible ones are created, no matter how many parts a
//! model has. The selection in the list is the one that the keys act on.

mod order;
mod row;

use std::collections::BTreeSet;

use egui::{
    Id, Popup, Rect, Role, ScrollArea, Sense, TextStyle, Ui, UiBuilder, WidgetInfo, pos2, vec2,
};

use crate::app::actions::{ADD_LIGHTS, ADD_OBJECTS, Action, Request, Requests};
use crate::app::input::buttons::action_icon;
use crate::app::state::State;
use crate::app::theme;
use crate::app::widgets::controls::{self, icon_button};
use crate::app::widgets::icons::Icon;
use crate::app::widgets::regions;
use marraztu_core::scene::{ItemId, ObjectId, Subject};
pub(super) use order::place;
use order::reorder;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Line {
    /// The heading of a list.
    Header(Subject),
    /// An item.
    Item(ItemId),
    /// A part of an object.
    Part(ObjectId, u32),
}

pub(crate) fn show(ui: &mut Ui, state: &State, requests: &mut Requests) {
    let all = ui.available_rect_before_wrap();
    let tools = all.with_min_y((all.bottom() - theme::ROW).max(all.top()));
    let tools = tools.with_max_x(all.right() - f32::from(theme::MARGIN));
    let list = all.with_max_y((tools.top() - theme::GAP).max(all.top()));
    let mut child = ui.new_child(UiBuilder::new().id_salt("list").max_rect(list));
    child.set_clip_rect(list.intersect(ui.clip_rect()));
    list_ui(&mut child, state, requests);
    let mut child = ui.new_child(UiBuilder::new().id_salt("tools").max_rect(tools));
    tools_ui(&mut child, state, requests);
}

fn list_ui(ui: &mut Ui, state: &State, requests: &mut Requests) {
    if state.renaming.is_none() {
        row::forget_new_name(ui);
    }
    let id = Id::unique("unfolded objects");
    let mut unfolded: BTreeSet<ObjectId> = ui.data(|data| data.get_temp(id)).unwrap_or_default();
    filter_ui(ui, state, requests);
    let lines = lines(state, &unfolded);
    ui.spacing_mut().item_spacing.y = 0.0;
    let area = ScrollArea::vertical().auto_shrink(false).content_margin(theme::SCROLL_MARGIN);
    area.show_viewport(ui, |ui, seen| {
        let count = u16::try_from(lines.len()).unwrap_or(u16::MAX);
        let size = vec2(ui.available_width(), f32::from(count) * theme::ROW);
        let (all, _) = ui.allocate_exact_size(size, Sense::hover());
        // After scrolling or unfolding, other lines have the same places.
        ui.ctx().allow_widget_id_changes_in(all);
        // The list is one stop of Tab: the arrow keys move between its items.
        let items: Vec<ItemId> = lines.iter().filter_map(|line| line.item()).collect();
        let ids: Vec<Id> = items.iter().map(|item| row::id(ui, *item)).collect();
        let chosen = items.iter().position(|item| state.selected() == Some(*item));
        let chosen = row::busy(ui, &items).or(chosen);
        let stop = items.get(regions::stop(ui, &ids, chosen, 1)).copied();
        for (i, line) in (0..count).zip(&lines) {
            let top = all.top() + f32::from(i) * theme::ROW;
            let rect = Rect::from_min_size(pos2(all.left(), top), vec2(all.width(), theme::ROW));
            follow_selection(ui, state, *line, rect);
            let (y, bottom) = (rect.top() - all.top(), rect.bottom() - all.top());
            let is_stop = stop.is_some() && line.item() == stop;
            // The line at which Tab stops is created even out of sight, so it keeps the focus.
            if is_stop || (bottom >= seen.top() && y <= seen.bottom()) {
                line_ui(ui, state, requests, *line, rect, (&mut unfolded, is_stop));
            }
        }
        regions::follow_focus(ui);
    });
    ui.data_mut(|data| data.insert_temp(id, unfolded));
}

impl Line {
    fn item(&self) -> Option<ItemId> {
        match self {
            Self::Item(item) => Some(*item),
            Self::Header(_) | Self::Part(..) => None,
        }
    }
}

/// Lists the lines from top to bottom.
fn lines(state: &State, unfolded: &BTreeSet<ObjectId>) -> Vec<Line> {
    let scene = &state.scene;
    let fitting = |line: &Line| line.item().is_none_or(|item| state.is_listed(item));
    let mut lines = vec![Line::Header(Subject::Object)];
    for (id, object) in scene.objects.iter().filter(|(id, _)| state.is_listed(ItemId::Object(*id)))
    {
        lines.push(Line::Item(ItemId::Object(id)));
        if unfolded.contains(&id) {
            let parts = object.model.mesh.parts().len();
            lines.extend((0..u32::try_from(parts).unwrap_or(0)).map(|part| Line::Part(id, part)));
        }
    }
    lines.push(Line::Header(Subject::Camera));
    let cameras = scene.cameras.ids().map(|id| Line::Item(ItemId::Camera(id)));
    lines.extend(cameras.filter(fitting));
    lines.push(Line::Header(Subject::Light));
    let lights = scene.lights.ids().map(|id| Line::Item(ItemId::Light(id)));
    lines.extend(lights.filter(fitting));
    lines
}

/// Shows a filter for names, if there are many items.
fn filter_ui(ui: &mut Ui, state: &State, requests: &mut Requests) {
    if !state.has_filter() {
        return;
    }
    let mut query = state.filter.clone();
    let width = ui.available_width() - f32::from(theme::MARGIN);
    let field = egui::TextEdit::singleline(&mut query)
        .hint_text("Filter by name")
        .align(egui::Align2::LEFT_CENTER);
    let response = ui.add_sized(vec2(width, theme::ROW), field);
    if response.accessible_name("Filter by name").changed() {
        requests.push(Request::Filter(query));
    }
    ui.add_space(2.0);
}

/// Scrolls to the selected item once, when it becomes selected.
fn follow_selection(ui: &Ui, state: &State, line: Line, rect: Rect) {
    let Line::Item(item) = line else { return };
    if state.selected() != Some(item) {
        return;
    }
    let id = Id::unique("selected in the outline");
    if ui.data(|data| data.get_temp(id)) != Some(item) {
        ui.data_mut(|data| data.insert_temp(id, item));
        ui.scroll_to_rect(rect, None);
    }
}

fn line_ui(
    ui: &mut Ui,
    state: &State,
    requests: &mut Requests,
    line: Line,
    rect: Rect,
    (unfolded, is_stop): (&mut BTreeSet<ObjectId>, bool),
) {
    match line {
        Line::Header(subject) => header_ui(ui, state, requests, subject, rect),
        Line::Item(item) => {
            let row = row::Row { item, rect, is_stop, unfolded: unfolded_of(unfolded, item) };
            if row::item_ui(ui, state, requests, &row)
                && let ItemId::Object(id) = item
                && !unfolded.remove(&id)
            {
                unfolded.insert(id);
            }
        }
        Line::Part(id, part) => row::part_ui(ui, state, requests, id, part, rect),
    }
}

fn unfolded_of(unfolded: &BTreeSet<ObjectId>, item: ItemId) -> bool {
    matches!(item, ItemId::Object(id) if unfolded.contains(&id))
}

fn header_ui(ui: &mut Ui, state: &State, requests: &mut Requests, subject: Subject, rect: Rect) {
    let scene = &state.scene;
    let (action, name, count) = match subject {
        Subject::Object => (Action::SubjectObject, "Objects", scene.objects.len()),
        Subject::Camera => (Action::SubjectCamera, "Cameras", scene.cameras.len()),
        Subject::Light => (Action::SubjectLight, "Lights", scene.lights.len()),
    };
    let is_subject = state.view.subject == subject;
    let response = ui.interact(rect, ui.scope_id().with(("list", name)), Sense::click());
    response.widget_info(|| WidgetInfo::selected(Role::Button, true, is_subject, name));
    let weak = ui.visuals().weak_text_color();
    let color = if is_subject { ui.visuals().strong_text_color() } else { weak };
    let left = rect.with_min_x(rect.left() + 6.0);
    let title = controls::text(ui, name, TextStyle::Body, left.width());
    let end = left.left() + title.size().x + 8.0;
    controls::put_text(ui, left, title, color);
    let count = controls::text(ui, count.to_string(), TextStyle::Small, 60.0);
    controls::put_text(ui, rect.with_min_x(end), count, weak);
    if is_subject {
        // An underline as well as a colour marks the list that the keys act on.
        let line = Rect::from_min_max(
            pos2(left.left(), rect.bottom() - 3.0),
            pos2(end - 8.0, rect.bottom() - 1.5),
        );
        ui.painter().rect_filled(line, 1.0, theme::accent(ui.visuals()));
    }
    controls::focus_ring(ui, rect, &response);
    if action.explain(response, state).clicked() && !is_subject {
        requests.push(action.into());
    }
    let button = Rect::from_min_max(pos2(rect.right() - theme::ROW, rect.top()), rect.max);
    ui.scope_builder(UiBuilder::new().max_rect(button), |ui| {
        add_ui(ui, state, requests, subject);
    });
}

/// Shows the button that adds an item to a list.
fn add_ui(ui: &mut Ui, state: &State, requests: &mut Requests, subject: Subject) {
    match subject {
        Subject::Object => {
            let response = icon_button(ui, Icon::PLUS, "Add an object", true);
            Popup::menu(&response).show(|ui| {
                ui.set_min_width(160.0);
                for action in ADD_OBJECTS {
                    requests.extend(action.menu_item(ui, state).map(Request::from));
                }
            });
            response.on_hover_text("Adds a model or a shape");
        }
        Subject::Camera => action_icon(ui, state, requests, Icon::PLUS, Action::AddCamera),
        Subject::Light => {
            let response = icon_button(ui, Icon::PLUS, "Add a light", true);
            Popup::menu(&response).show(|ui| {
                ui.set_min_width(160.0);
                let attached = [Action::AddObjectSpot, Action::AddCameraSpot];
                for action in ADD_LIGHTS.into_iter().chain(attached) {
                    requests.extend(action.menu_item(ui, state).map(Request::from));
                }
            });
            response.on_hover_text("Adds a light");
        }
    }
}

/// Shows the actions on the selected item below the list.
fn tools_ui(ui: &mut Ui, state: &State, requests: &mut Requests) {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 2.0;
        move_ui(ui, state, requests, Icon::UP, "Move up the list");
        move_ui(ui, state, requests, Icon::DOWN, "Move down the list");
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            action_icon(ui, state, requests, Icon::BIN, Action::Delete);
            action_icon(ui, state, requests, Icon::COPY, Action::Duplicate);
            action_icon(ui, state, requests, Icon::PEN, Action::Rename);
        });
    });
}

fn move_ui(ui: &mut Ui, state: &State, requests: &mut Requests, icon: Icon, name: &str) {
    let place = state.selected().and_then(|id| Some((id, place(state, id)?)));
    let to = place.and_then(|(id, (at, count))| {
        let to = if icon == Icon::UP { at.checked_sub(1)? } else { at + 1 };
        (to < count).then_some((id, to))
    });
    let response = icon_button(ui, icon, name, to.is_some());
    let response = response.on_hover_text(format!("{name}, or drag the row"));
    if let Some((id, to)) = to.filter(|_| response.clicked()) {
        reorder(state, requests, id, to);
    }
}

//! Undo and Redo in the menu bar.
//!
//! A click undoes or redoes one step. A held button, a drag downwards or a right click lists the
//! steps, as the Back button of a browser lists pages. Releasing the mouse button on a step undoes
//! or redoes all steps up to it.

use std::time::Duration;

use egui::{
    Margin, Popup, PopupCloseBehavior, Rect, Response, Role, ScrollArea, Sense, SetOpenCommand,
    TextStyle, Ui, WidgetInfo, vec2,
};

use crate::app::actions::{Action, Request, Requests};
use crate::app::state::State;
use crate::app::theme;
use crate::app::widgets::controls::{focus_ring, icon_at, put_text, text};
use crate::app::widgets::icons::Icon;
use crate::app::widgets::text::counted;

/// The seconds after which a held button lists its steps.
const HOLD: f64 = 0.35;

/// The number of visible steps; the others are scrolled to.
const ROWS: f32 = 14.0;

const WIDTH: f32 = 240.0;

/// A step of the list: its index in the history, and the position of the history after undoing or
/// redoing this step and all nearer ones.
type Step = (usize, usize);

/// Shows both buttons; their requests are added to `requests`.
pub(super) fn show(ui: &mut Ui, state: &State, requests: &mut Requests) {
    let history = &state.history;
    let here = history.position();
    let done = (0..here).rev().map(|at| (at, at));
    let undone = (here..history.steps().len()).map(|at| (at, at + 1));
    button_ui(ui, state, requests, (Action::Undo, Icon::UNDO), done);
    button_ui(ui, state, requests, (Action::Redo, Icon::REDO), undone);
}

/// Shows a button with its steps, the nearest first.
fn button_ui(
    ui: &mut Ui,
    state: &State,
    requests: &mut Requests,
    (action, icon): (Action, Icon),
    steps: impl ExactSizeIterator<Item = Step>,
) {
    let name = action.info().label;
    let enabled = steps.len() > 0;
    let sense = if enabled { Sense::click_and_drag() } else { Sense::hover() };
    let (rect, response) = ui.allocate_exact_size(vec2(theme::ROW, theme::ROW), sense);
    icon_at(ui, rect, &response, icon, name, enabled);
    let id = Popup::default_response_id(&response);
    let pulled: bool = ui.data(|data| data.get_temp(id)).unwrap_or(false);
    // A release after pulling the list down is not a click on the button.
    if response.clicked() && !pulled {
        requests.push(action.into());
    }
    let pulls = pulled || is_pulled(ui, &response);
    let let_go = pulls && !ui.input(|input| input.pointer.primary_down());
    let opens = response.secondary_clicked() || (pulls && !pulled);
    // A right click or a pull opens the list.
    let popup = Popup::from_response(&response)
        .open_memory(opens.then_some(SetOpenCommand::Bool(true)))
        .close_behavior(PopupCloseBehavior::CloseOnClickOutside);
    let shown = popup.show(|ui| list_ui(ui, state, name, steps, let_go));
    let at = ui.input(|input| input.pointer.interact_pos());
    let over = |rect: Rect| at.is_some_and(|at| rect.contains(at));
    let over_list = shown.as_ref().is_some_and(|shown| over(shown.response.rect));
    if let Some(chosen) = shown.and_then(|shown| shown.inner) {
        requests.push(Request::GoTo(chosen));
        Popup::close_id(ui.ctx(), id);
    } else if let_go && !over(rect) && !over_list {
        Popup::close_id(ui.ctx(), id);
    }
    ui.data_mut(|data| data.insert_temp(id, pulls && !let_go));
    action.explain_also(response, state, "Hold or pull down to list the steps.");
}

/// Returns whether the button was held long enough, or pressed and dragged downwards.
fn is_pulled(ui: &Ui, response: &Response) -> bool {
    let (held, since, now, at) = ui.input(|input| {
        let pointer = &input.pointer;
        (pointer.primary_down(), pointer.press_start_time(), input.time, pointer.interact_pos())
    });
    if !held || !response.is_pointer_button_down_on() {
        return false;
    }
    let held = since.map_or(0.0, |since| now - since);
    ui.ctx().request_repaint_after(Duration::from_secs_f64((HOLD - held).max(0.0)));
    held >= HOLD || at.is_some_and(|at| at.y > response.rect.bottom())
}

/// Shows the list. Returns the history position of the step that was clicked, or on which the mouse
/// button was released after pulling the list down.
fn list_ui(
    ui: &mut Ui,
    state: &State,
    name: &str,
    steps: impl ExactSizeIterator<Item = Step>,
    let_go: bool,
) -> Option<usize> {
    let labels: Vec<&str> = state.history.steps().collect();
    let (mut pointed, mut chosen) = (0, None);
    ui.set_width(WIDTH);
    ui.spacing_mut().item_spacing.y = 0.0;
    let count = u16::try_from(steps.len()).unwrap_or(u16::MAX);
    let scrolls = f32::from(count) > ROWS;
    let margin = if scrolls { theme::SCROLL_MARGIN } else { Margin::ZERO };
    let list = ScrollArea::vertical().max_height(ROWS * theme::ROW).auto_shrink([false, true]);
    list.content_margin(margin).show(ui, |ui| {
        let row = vec2(ui.available_width(), theme::ROW);
        let (all, _) = ui.allocate_exact_size(row * vec2(1.0, count.into()), Sense::hover());
        let seen = all.intersect(ui.clip_rect());
        let at = ui.input(|input| input.pointer.interact_pos()).filter(|at| seen.contains(*at));
        for (i, (place, position)) in (0..count).zip(steps) {
            let rect = Rect::from_min_size(all.min + vec2(0.0, f32::from(i) * row.y), row);
            if !rect.intersects(seen) {
                continue;
            }
            // All nearer steps are included.
            let goes = at.is_some_and(|at| at.y >= rect.top());
            let said = format!("{name} {}: {}", i + 1, labels[place]);
            let clicked = row_ui(ui, rect, labels[place], &said, goes);
            if clicked || (let_go && at.is_some_and(|at| rect.contains(at))) {
                chosen = Some(position);
            }
            pointed = if goes { i + 1 } else { pointed };
        }
    });
    ui.separator();
    ui.weak(match pointed {
        0 => format!("{name} how many steps?"),
        _ => format!("{name} {}", counted(pointed.into(), "step", "steps")),
    });
    chosen
}

/// Shows a row, marked if its step is included in the one under the pointer. Returns whether it was
/// clicked.
fn row_ui(ui: &Ui, rect: Rect, label: &str, said: &str, goes: bool) -> bool {
    let response = ui.interact(rect, ui.scope_id().with(said), Sense::click());
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, said));
    let mut color = ui.visuals().text_color();
    if goes {
        ui.painter().rect_filled(rect, 0.0, ui.visuals().selection.bg_fill);
        color = ui.visuals().selection.stroke.color;
    }
    let room = rect.shrink2(vec2(6.0, 0.0));
    put_text(ui, room, text(ui, label, TextStyle::Body, room.width()), color);
    focus_ring(ui, rect, &response);
    response.clicked()
}

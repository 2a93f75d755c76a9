//! The history of changes: every step, the current position, and a click to go to any other.

use egui::{Atom, Button, Pos2, ScrollArea, Ui, Window};

use crate::app::actions::{Action, Request, Requests};
use crate::app::panels::{Panel, dial, statistics};
use crate::app::state::State;

const WIDTH: f32 = 240.0;

/// The height of the window's title and borders, and the distance from the edge of the picture.
const FRAME: f32 = 60.0;

/// The number of visible steps; the others are scrolled to.
const ROWS: f32 = 14.0;

pub(crate) fn show(ui: &mut Ui, state: &State, requests: &mut Requests) {
    let mut open = true;
    let picture = ui.max_rect();
    // It opens to the right of the dial, and leaves the statistics below it free.
    let at = Pos2::new(picture.left() + dial::RIGHT, picture.top() + 12.0);
    let most =
        (picture.height() - FRAME - statistics::HEIGHT).max(4.0 * ui.spacing().interact_size.y);
    Window::new(Panel::History.info().label)
        .open(&mut open)
        .collapsible(false)
        .default_pos(at)
        .default_width(WIDTH)
        .constrain_to(picture)
        .show(ui.ctx(), |ui| list_ui(ui, state, most, requests));
    if !open {
        requests.push(Action::Panel(Panel::History).into());
    }
}

/// Lists the steps, in at most this height; a click goes to the state after a step. Returns whether
/// one was clicked.
pub(super) fn list_ui(ui: &mut Ui, state: &State, most: f32, requests: &mut Requests) -> bool {
    let history = &state.history;
    let labels: Vec<&str> = std::iter::once("Beginning").chain(history.steps()).collect();
    let row = ui.spacing().interact_size.y;
    let mut clicked = false;
    let most = most.min(ROWS * (row + ui.spacing().item_spacing.y));
    let list = ScrollArea::vertical().max_height(most).auto_shrink([false, true]);
    // New steps scroll into view.
    list.stick_to_bottom(true).show_rows(ui, row, labels.len(), |ui, range| {
        for position in range {
            let here = position == history.position();
            let text = format!("{position}  {}", labels[position]);
            // A growing atom behind the text keeps the text left-aligned.
            let button = Button::selectable(here, (text, Atom::grow())).truncate();
            let response = ui.add_sized([ui.available_width(), row], button);
            if response.on_hover_text("Restores the state just after this step").clicked() {
                requests.push(Request::GoTo(position));
                clicked = true;
            }
        }
    });
    clicked
}

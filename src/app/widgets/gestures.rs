//! Assigns changes to gestures: one drag is one step of undo.
//!
//! A gesture of the mouse lasts from the press of a button to its release. It includes the frame of
//! the release, since a slider's value may change once more there.

use std::hash::{DefaultHasher, Hash, Hasher as _};

use egui::{Context, Id, Response};

use marraztu_core::edit::Gesture;

/// Returns the gesture of a change to this widget's value: part of a drag while a mouse button is
/// down, whole for a typed value or an arrow key.
pub fn of(response: &Response) -> Gesture {
    let pressing = |pointer: &egui::PointerState| pointer.any_down() || pointer.any_released();
    if response.ctx.input(|input| pressing(&input.pointer)) {
        numbered(presses(&response.ctx), response.id)
    } else {
        Gesture::Whole
    }
}

/// Creates gesture number `number` of the source called `salt`.
pub(crate) fn numbered(number: u64, salt: impl Hash) -> Gesture {
    let mut hasher = DefaultHasher::new();
    (number, salt).hash(&mut hasher);
    Gesture::Part(hasher.finish())
}

/// Counts a press of a mouse button.
pub(crate) fn count_press(ctx: &Context) {
    ctx.data_mut(|data| *data.get_temp_mut_or_default::<u64>(id()) += 1);
}

fn presses(ctx: &Context) -> u64 {
    ctx.data(|data| data.get_temp(id()).unwrap_or(0))
}

fn id() -> Id {
    Id::unique("presses of the mouse")
}

//! Hides tooltips when a key is pressed.
//!
//! egui keeps a tooltip for as long as the pointer rests, even if what it belongs to has gone or
//! lies under a dialog by then. It hides them while something scrolls; so a key is given as a turn
//! of the wheel by nothing. Afterwards only what the pointer is really over has its tooltip again.

use egui::{Context, Event, Modifiers, MouseWheelUnit, Plugin, RawInput, TouchPhase, Vec2};

/// Adds what hides tooltips.
pub(crate) fn install(ctx: &Context) {
    ctx.add_plugin(HiddenByKeys);
}

struct HiddenByKeys;

impl Plugin for HiddenByKeys {
    fn debug_name(&self) -> &'static str {
        "tooltips hidden by keys"
    }

    fn input_hook(&mut self, _: &Context, input: &mut RawInput) {
        let is_key = |event: &Event| matches!(event, Event::Key { pressed: true, .. });
        if input.events.iter().any(is_key) {
            input.events.push(Event::MouseWheel {
                unit: MouseWheelUnit::Point,
                delta: Vec2::ZERO,
                phase: TouchPhase::Move,
                source: egui::MouseWheelSource::Unknown,
                modifiers: Modifiers::NONE,
            });
        }
    }
}

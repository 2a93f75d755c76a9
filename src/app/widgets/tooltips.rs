//! Hides tooltips when a key is pressed.
//!
//! egui keeps a tooltip while the pointer rests, even if its widget has gone or is covered by a
//! dialog. egui also hides tooltips while something scrolls, so each key press sends a wheel event
//! with a distance of zero. Afterwards only the widget under the pointer shows its tooltip again.

use egui::{Context, Event, Modifiers, MouseWheelUnit, Plugin, RawInput, TouchPhase, Vec2};

/// Installs the plugin that hides tooltips.
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

//! Hides tooltips while keys are pressed.
//!
//! egui keeps a tooltip for as long as the pointer rests, even if what it belongs to has gone or
//! lies under a dialog by then. So a key hides all of them until the pointer moves again.

use egui::{Context, Event, Id};

use crate::app::theme;

/// A tooltip that waits this long is never shown.
const NEVER: f32 = 1e6;

/// Looks at the keys and the pointer of this frame.
pub(crate) fn hide_by_keys(ctx: &Context) {
    let id = Id::unique("tooltips are hidden");
    let (key, moved) = ctx.input(|input| {
        let is_key = |event: &Event| match event {
            Event::Key { pressed, .. } => *pressed,
            _ => matches!(event, Event::Text(_)),
        };
        let is_move = |event: &Event| matches!(event, Event::PointerMoved(_));
        (input.events.iter().any(is_key), input.events.iter().any(is_move))
    });
    let were = ctx.data(|data| data.get_temp(id)).unwrap_or(false);
    let are = key || (were && !moved);
    if are != were {
        ctx.data_mut(|data| data.insert_temp(id, are));
        let delay = if are { NEVER } else { theme::TOOLTIP_DELAY };
        ctx.all_styles_mut(|style| style.interaction.tooltip_delay = delay);
    }
}

//! Events of the page, and egui's events for them.

use egui::{Event, ImeEvent, Key, Modifiers, MouseWheelUnit, PointerButton, TouchPhase};
use egui::{pos2, vec2};
use serde::Deserialize;

/// An event of the page. Positions and distances are in CSS pixels; modifier keys are the sum of
/// 1 (Alt), 2 (Ctrl), 4 (Shift) and 8 (Cmd of a Mac).
#[derive(Debug, Deserialize)]
#[serde(tag = "kind", rename_all = "camelCase")]
pub(crate) enum PageEvent {
    /// The pointer has moved.
    Moved { x: f32, y: f32, modifiers: u8 },
    /// A button was pressed or released; buttons are numbered as in `MouseEvent.button`.
    Button { x: f32, y: f32, button: u8, pressed: bool, modifiers: u8 },
    /// The pointer has left the canvas.
    Gone,
    /// The wheel was turned, by an amount as in `WheelEvent`: `mode` 0 is pixels, 1 lines, 2 pages.
    Wheel { x: f32, y: f32, mode: u8, modifiers: u8 },
    /// Two fingers have moved apart by this factor.
    Zoom { factor: f32 },
    /// A key was pressed or released, with its names as in `KeyboardEvent`.
    Key { key: String, code: String, pressed: bool, repeat: bool, modifiers: u8 },
    /// Text was typed.
    Text { text: String },
    /// An input method shows preliminary text.
    Preedit { text: String },
    /// An input method has finished a text.
    Commit { text: String },
    /// The user copies.
    Copy,
    /// The user cuts.
    Cut,
    /// The user pastes this text.
    Paste { text: String },
    /// The page has got or lost the keyboard.
    Focus { focused: bool },
}

impl PageEvent {
    /// Translates the event. `zoom` is the number of CSS pixels per point of egui.
    pub(crate) fn into_events(self, zoom: f32) -> Vec<Event> {
        let at = |x: f32, y: f32| pos2(x / zoom, y / zoom);
        match self {
            Self::Moved { x, y, modifiers } => {
                vec![Event::ModifiersChanged(keys(modifiers)), Event::PointerMoved(at(x, y))]
            }
            Self::Button { x, y, button, pressed, modifiers } => {
                let Some(button) = button_of(button) else { return Vec::new() };
                let (pos, modifiers) = (at(x, y), keys(modifiers));
                vec![
                    Event::ModifiersChanged(modifiers),
                    Event::PointerMoved(pos),
                    Event::PointerButton { pos, button, pressed, modifiers },
                ]
            }
            Self::Gone => vec![Event::PointerGone],
            Self::Wheel { x, y, mode, modifiers } => {
                let (unit, scale) = match mode {
                    0 => (MouseWheelUnit::Point, zoom),
                    1 => (MouseWheelUnit::Line, 1.0),
                    _ => (MouseWheelUnit::Page, 1.0),
                };
                // The page scrolls down by positive amounts, egui up.
                let delta = -vec2(x, y) / scale;
                let (phase, modifiers) = (TouchPhase::Move, keys(modifiers));
                let source = egui::MouseWheelSource::Unknown;
                vec![Event::MouseWheel { unit, delta, phase, source, modifiers }]
            }
            Self::Zoom { factor } => vec![Event::Zoom(factor)],
            Self::Key { key, code, pressed, repeat, modifiers } => {
                let modifiers = keys(modifiers);
                let mut events = vec![Event::ModifiersChanged(modifiers)];
                let physical_key = physical(&code);
                // Layouts without Latin letters act by the places of the keys, as in a window.
                if let Some(key) = Key::from_name(&key).or(physical_key) {
                    events.push(Event::Key { key, physical_key, pressed, repeat, modifiers });
                }
                events
            }
            Self::Text { text } => vec![Event::Text(text)],
            Self::Preedit { text } => {
                vec![Event::Ime(ImeEvent::Preedit { text, active_range_chars: None })]
            }
            Self::Commit { text } => vec![Event::Ime(ImeEvent::Commit(text))],
            Self::Copy => vec![Event::Copy],
            Self::Cut => vec![Event::Cut],
            Self::Paste { text } => vec![Event::Paste(text.replace("\r\n", "\n"))],
            Self::Focus { focused } => vec![Event::WindowFocused(focused)],
        }
    }
}

fn keys(bits: u8) -> Modifiers {
    let [alt, ctrl, shift, mac_cmd] = [1, 2, 4, 8].map(|bit| bits & bit != 0);
    Modifiers { alt, ctrl, shift, mac_cmd, command: ctrl || mac_cmd }
}

fn button_of(number: u8) -> Option<PointerButton> {
    Some(match number {
        0 => PointerButton::Primary,
        1 => PointerButton::Middle,
        2 => PointerButton::Secondary,
        3 => PointerButton::Extra1,
        4 => PointerButton::Extra2,
        _ => return None,
    })
}

/// Returns the key at the place of a keyboard that `KeyboardEvent.code` names.
fn physical(code: &str) -> Option<Key> {
    let name = code.strip_prefix("Key").or_else(|| code.strip_prefix("Digit")).unwrap_or(code);
    Key::from_name(name)
}

//! Descriptions of mouse input over the picture, for the cheat sheet, the status line and the list
//! of keys. `app/viewport/mouse` implements it.

use crate::app::chord::command_key;

/// A description of one kind of mouse input over the picture.
#[derive(Clone, Copy, Debug)]
pub struct MouseInfo {
    /// All inputs for it; the first one is shown.
    pub inputs: &'static [&'static str],
    /// The name: one to three words.
    pub label: &'static str,
    /// The description: one sentence.
    pub hint: &'static str,
    /// Synonyms to search for.
    pub words: &'static str,
}

impl MouseInfo {
    /// The heading of the list.
    pub const HEADING: &'static str = "Mouse over the picture";

    /// All kinds of mouse input, the most important first.
    pub const ALL: [Self; 12] = [
        Self {
            inputs: &["Click"],
            label: "Select",
            hint: "Selects the item under the pointer; another click selects the one behind it.",
            words: "mouse pick choose left",
        },
        Self {
            inputs: &["Double click"],
            label: "Frame",
            hint: "Frames the object under the pointer; on the background, frames all.",
            words: "mouse zoom fit focus left",
        },
        Self {
            inputs: &["Drag"],
            label: "Look around",
            hint: "Turns the camera; in analysis, orbits the selected object.",
            words: "mouse orbit turn rotate view left",
        },
        Self {
            inputs: &["Alt+drag"],
            label: "Orbit",
            hint: "Orbits the selected object, in fly as well.",
            words: "mouse turn rotate around view left",
        },
        Self {
            inputs: &["Shift+drag", "Middle drag"],
            label: "Pan",
            hint: "Moves the camera sideways.",
            words: "mouse shift move view left",
        },
        Self {
            inputs: &["Wheel", "Pinch"],
            label: "Zoom",
            hint: "Zooms towards the pointer, or away from it.",
            words: "mouse scroll near closer far dolly",
        },
        Self {
            inputs: &["Right click"],
            label: "Menu",
            hint: "Opens the menu of the item under the pointer.",
            words: "mouse context",
        },
        Self {
            inputs: &["Right held"],
            label: "Fly",
            hint: "Flies with W A S D Q E; Shift is fast, Alt is slow, the wheel changes the \
                speed.",
            words: "mouse walk game first person wasd",
        },
        Self {
            inputs: &["Drag a handle"],
            label: "Use the gizmo",
            hint: concat!(
                "Moves, rotates or scales the selection; hold ",
                command_key!(),
                " to snap, or type x 12 Enter."
            ),
            words: "mouse move rotate scale handle",
        },
        Self {
            inputs: &["Shift+click"],
            label: "Extend selection",
            hint: "Adds the item to the selection, or removes it.",
            words: "mouse several multiple add left",
        },
        Self {
            inputs: &[concat!(command_key!(), "+drag")],
            label: "Box select",
            hint: "Selects everything in a box.",
            words: "mouse several multiple rectangle marquee left",
        },
        Self {
            inputs: &["Esc", "Right click"],
            label: "Cancel a drag",
            hint: "Restores the state before the drag.",
            words: "mouse abort stop undo",
        },
    ];
}

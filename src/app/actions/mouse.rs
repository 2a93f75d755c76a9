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

/// Makes the table from rows of inputs, label, hint and words.
macro_rules! mouse {
    ($([$($input:expr),+] $label:literal $hint:expr => $words:literal;)+) => {
        [$(MouseInfo { inputs: &[$($input),+], label: $label, hint: $hint, words: $words }),+]
    };
}

impl MouseInfo {
    /// The heading of the list.
    pub const HEADING: &'static str = "Mouse over the picture";

    /// All kinds of mouse input, the most important first.
    pub const ALL: [Self; 12] = mouse! {
        ["Click"] "Select"
            "Selects the item under the pointer; another click selects the one behind it."
            => "mouse pick choose left";
        ["Double click"] "Frame"
            "Frames the object under the pointer; on the background, frames all."
            => "mouse zoom fit focus left";
        ["Drag"] "Look around" "Turns the camera; in analysis, orbits the selected object."
            => "mouse orbit turn rotate view left";
        ["Alt+drag", "Drag the axes"] "Orbit" "Orbits the selected object, in fly as well."
            => "mouse turn rotate around view left";
        ["Shift+drag", "Middle drag"] "Pan" "Moves the camera sideways."
            => "mouse shift move view left";
        ["Wheel", "Pinch"] "Zoom"
            "Zooms towards the pointer; in analysis, towards the selected object."
            => "mouse scroll near closer far dolly";
        ["Right click"] "Menu" "Opens the menu of the item under the pointer."
            => "mouse context";
        ["Right held"] "Fly"
            "Flies with W A S D Q E; Shift is fast, Alt is slow, the wheel changes the speed."
            => "mouse walk game first person wasd";
        ["Drag a handle"] "Use the gizmo"
            concat!("Moves, rotates or scales the selection; hold ", command_key!(),
                " to snap, or type x 12 Enter.")
            => "mouse move rotate scale handle";
        ["Shift+click"] "Extend selection" "Adds the item to the selection, or removes it."
            => "mouse several multiple add left";
        [concat!(command_key!(), "+drag")] "Box select" "Selects everything in a box."
            => "mouse several multiple rectangle marquee left";
        ["Esc", "Right click"] "Cancel a drag" "Restores the state before the drag."
            => "mouse abort stop undo";
    };
}

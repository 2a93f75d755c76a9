//! The window's behaviour without a display: keys, mouse and dialogs, event by event.
//!
//! The top of each file says which faults it catches.

#![allow(clippy::unwrap_used, reason = "a test fails where there is nothing")]

mod clipboard;
mod dial;
mod dialogs;
mod editor;
mod escaping;
mod examples;
mod first_models;
mod folders;
mod gizmo;
mod greeting;
mod helpers;
mod keeping;
mod keymap;
mod keys_and_clicks;
mod laboratory;
mod layout;
mod locking;
mod looking;
mod missing;
mod mouse;
mod notices;
mod outputs;
mod palette;
mod panels;
mod plan;
mod preferences;
mod properties;
mod refining;
mod regions;
mod saving;
mod several;
mod shapes;
mod tasks;
mod undo_buttons;
mod undoing;
mod viewing;
mod ways;

//! The window: the only floor that knows of egui.
//!
//! ```text
//! keys, menus, buttons, mouse  ->  Ask  ->  App::answer  ->  Command or View  ->  the scene
//! ```
//!
//! Panels and the viewport read the [`State`](state::State) and give back what is asked for; they
//! change nothing. [`App`] answers at the end of the frame.

pub mod action;
pub mod ask;
mod browser;
mod buttons;
pub mod chord;
pub mod comparison;
mod decide;
mod dialogs;
mod editor;
mod files;
pub mod gestures;
mod keyboard;
pub mod laboratory;
mod material_dialog;
mod measuring;
mod mouse;
mod notices;
mod overlay;
mod pace;
mod painter;
pub mod panels;
mod scene_files;
mod start;
pub mod state;
mod tasks;
pub mod theme;
mod trace;
mod viewport;
mod visibility;
mod worker;

pub use editor::App;
pub use start::{StartError, run};

//! The window. Besides `marraztu-painter`, only this floor uses egui.
//!
//! ```text
//! keys, menus, buttons, mouse  ->  Request  ->  App::answer  ->  Command or View  ->  the scene
//! ```
//!
//! Panels and the viewport read the [`State`](state::State) and return requests; they change
//! nothing. [`App`] answers the requests at the end of the frame.
//!
//! The rooms of this floor, lowest first. A room uses only the rooms below it:
//!
//! ```text
//! theme      colours, sizes, spacing
//! fonts      fonts of the system, for letters that the built-in fonts lack
//! tasks      work on background threads
//! widgets    controls, independent of scenes: numbers, switches, colours, icons
//! drawing    the thread that draws the viewport's pictures, with adaptive quality
//! chord      key chords
//! panels/mod the table of panels: names, keys, places
//! state      all input of the panels
//! actions    the table of actions, their keys, their effects; requests
//! input      keys and buttons that return actions
//! documents  dialogs: files, materials, unsaved work
//! panels     the contents of the panels around the viewport
//! viewport   the picture, with the mouse and everything shown over it
//! editor     the app: it answers requests, and is the only writer of the scene
//! shell      the window of the editor, painted with OpenGL or without
//! start      opens the window
//! ```

pub mod actions;
mod chord;
mod documents;
mod drawing;
mod editor;
mod fonts;
mod input;
pub mod panels;
mod shell;
#[cfg(feature = "desktop")]
mod start;
pub mod state;
mod tasks;
pub mod theme;
mod viewport;
pub mod widgets;

pub use drawing::worker::server::DrawingServer;
pub use editor::App;
pub use editor::jobs::{JobKind, do_job};
pub use shell::{CanvasShell, Painted};
#[cfg(feature = "desktop")]
pub use shell::{Shell, StartError};
#[cfg(feature = "desktop")]
pub use start::run;

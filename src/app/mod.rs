//! The window: the only floor that uses egui.
//!
//! ```text
//! keys, menus, buttons, mouse  ->  Request  ->  App::answer  ->  Command or View  ->  the scene
//! ```
//!
//! Panels and the viewport read the [`State`](state::State) and return requests; they change
//! nothing. [`App`] answers the requests at the end of the frame.
//!
//! The rooms of this floor, lowest first; a room uses only those below it (`tests/floors`):
//!
//! ```text
//! theme      colours, sizes, spacing
//! fonts      fonts of the system, for letters that the built-in ones do not have
//! tasks      work on threads of its own
//! painter    paints what egui shows into memory, without a graphics card
//! shell      windows of the system: what the editor is shown in, with OpenGL or without
//! widgets    controls that know nothing of scenes being edited: numbers, switches, colours, icons
//! drawing    the thread that draws the viewport's pictures, and how it keeps up with the user
//! chord      keys that are pressed together
//! panels/mod the table of panels: names, keys, places
//! state      everything that panels read
//! actions    the table of actions, their keys, what each means now; requests
//! input      keys and buttons that give actions
//! documents  dialogs: files, materials, unsaved work
//! panels     what the panels show, around the viewport
//! viewport   the picture, with the mouse and everything shown over it
//! editor     the app: it answers requests, and is the only writer of the scene
//! start      opens the window
//! ```

pub mod actions;
mod chord;
mod documents;
mod drawing;
mod editor;
mod fonts;
mod input;
mod painter;
pub mod panels;
mod shell;
mod start;
pub mod state;
mod tasks;
pub mod theme;
mod viewport;
pub mod widgets;

pub use editor::App;
pub use shell::{Shell, StartError};
pub use start::run;

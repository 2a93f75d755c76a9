//! What a user can ask for: the table of actions, their keys, and what each means for the scene.

mod chord;
mod request;
mod resolve;
mod table;

pub use chord::Chord;
pub use request::{LabRequest, Request};
pub(crate) use request::{change, change_view};
pub(crate) use resolve::{FileIntent, Intent, resolve};
pub use table::{Action, ActionInfo, Group};

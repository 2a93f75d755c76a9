//! Actions: everything a user can ask for by a key, a menu or a button.

mod chord;
mod labels;
mod request;
mod resolve;
pub mod search;
mod table;

pub use chord::Chord;
pub use request::{Also, KeyRequest, LabRequest, Request};
pub(crate) use request::{change, change_view};
pub(crate) use resolve::{ADD_LIGHTS, FileIntent, Intent, resolve};
pub use table::{Action, ActionInfo, Group};

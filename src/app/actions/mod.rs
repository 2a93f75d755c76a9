//! Actions: everything that a key, a menu or a button can do.

mod info;
mod intent;
mod labels;
mod lists;
mod mouse;
mod request;
mod resolve;
pub mod search;
mod switches;
mod table;

pub use crate::app::chord::Chord;
pub use info::{ActionInfo, Group};
pub(crate) use intent::{ClipboardIntent, FileIntent, Intent};
pub use mouse::MouseInfo;
pub use request::{Also, KeyRequest, LabRequest, MissingRequest, Request};
pub(crate) use request::{Requests, change, change_view};
pub(crate) use resolve::{ADD_LIGHTS, ADD_OBJECTS, resolve};
pub use table::Action;

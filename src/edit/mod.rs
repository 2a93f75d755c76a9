//! Decides commands: what a change of the scene consists of, and the history of changes.
//!
//! Everything here but [`History`] only decides: it reads a scene and a view, and gives back the
//! [`Command`](crate::scene::Command) or the view that is meant, or a [`Refusal`] for the status
//! line. [`History`] is the one that writes a scene.

pub mod framing;
mod gesture;
mod history;
pub mod items;
pub mod lights;
pub mod motion;
mod names;
pub mod navigation;
pub mod placement;
mod refusal;
pub mod selection;
mod set_transform;
pub mod transform;

pub use gesture::{Gesture, GesturePhase};
pub use history::History;
pub use refusal::Refusal;

//! Which command a key means, and the history of commands.
//!
//! Everything here but [`History`] only decides: it reads a scene and a view, and gives back the
//! [`Command`](crate::scene::Command) or the view that is meant, or a [`Refusal`] for the status
//! line. [`History`] is the one that writes a scene.

pub mod frame;
mod history;
pub mod items;
pub mod lights;
pub mod look;
pub mod motion;
mod names;
pub mod place;
mod put;
mod refusal;
pub mod selection;
pub mod transform;

pub use history::{Gesture, History};
pub use refusal::Refusal;

/// Where in a gesture (a drag, a held key) a change stands: what the item was before the gesture is
/// pushed once, so that `u` takes the whole gesture back.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Stroke {
    /// Its first change, or its only one: what the item was goes onto its stack.
    First,
    /// A later one: the stack stays as it is.
    Continued,
}

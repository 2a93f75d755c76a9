//! Which command a key means, and the history of commands.

mod history;

pub use history::{Gesture, History};

/// Where in a gesture (a drag, a held key) a change stands: what the item was before the gesture is
/// pushed once, so that `u` takes the whole gesture back.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Stroke {
    /// Its first change, or its only one: what the item was goes onto its stack.
    First,
    /// A later one: the stack stays as it is.
    Continued,
}

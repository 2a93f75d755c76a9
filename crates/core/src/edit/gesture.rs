//! Gestures, such as a drag or a held key: changes that are undone together.

use crate::scene::Tracked;

/// Whether a change is separate, or part of a drag or a held key.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Gesture {
    /// A key, a click or a typed number: undone separately.
    #[default]
    Whole,
    /// Part of the gesture with this number, which is undone as a whole.
    Part(u64),
}

/// The phase of a change in a gesture. The first change pushes the old transform, so `u` undoes the
/// whole gesture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum GesturePhase {
    /// The first change, or the only one: pushes the old transform.
    First,
    /// A later change: pushes nothing.
    Continued,
}

impl GesturePhase {
    /// Returns `placed` after this change of a gesture.
    pub(super) fn apply<T: Clone>(self, placed: &Tracked<T>, now: T) -> Tracked<T> {
        match self {
            Self::First => placed.moved(now),
            Self::Continued => placed.replaced(now),
        }
    }
}

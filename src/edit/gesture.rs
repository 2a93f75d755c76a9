//! Which changes belong to one gesture, such as a drag or a held key.

use crate::scene::Tracked;

/// Whether a change stands alone, or is one of many that a single drag or held key makes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Gesture {
    /// A key, a click, a typed number: undone by itself.
    #[default]
    Whole,
    /// Part of the gesture with this number: the gesture is undone as a whole.
    Part(u64),
}

/// Where in a gesture (a drag, a held key) a change stands: what the item was before the gesture is
/// pushed once, so that `u` takes the whole gesture back.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum GesturePhase {
    /// Its first change, or its only one: what the item was goes onto its stack.
    First,
    /// A later one: the stack stays as it is.
    Continued,
}

impl GesturePhase {
    /// `placed` after this change of a gesture.
    pub(super) fn apply<T: Clone>(self, placed: &Tracked<T>, now: T) -> Tracked<T> {
        match self {
            Self::First => placed.moved(now),
            Self::Continued => placed.replaced(now),
        }
    }
}

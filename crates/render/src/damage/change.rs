//! The kinds of change in the drawing of an item.

use serde::{Deserialize, Serialize};

/// The change in the drawing of an item.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Change {
    /// The item was not drawn before.
    Came,
    /// The item is no longer drawn.
    Went,
    /// The item moved.
    Moved,
    /// Other polygons or lines of the item are drawn.
    Shape,
    /// The item's colours, texture or light changed.
    Look,
}

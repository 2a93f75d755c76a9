//! What panels, menus, keys and the viewport give back: wishes, which only the app fulfils.

use std::path::PathBuf;

use super::action::Action;
use super::laboratory::LabAsk;
use crate::edit::Gesture;
use crate::scene::{Command, ItemId, ObjectId, Settings, View};

/// Something that is asked for.
#[derive(Clone, Debug, PartialEq)]
pub enum Ask {
    /// What stands in the table of actions.
    Do(Action),
    /// A change of the scene.
    Change {
        /// The change.
        command: Command,
        /// What it is part of.
        gesture: Gesture,
        /// As the history calls it: "Move teapot".
        label: String,
    },
    /// A change of the view that selects nothing else.
    Look(Box<View>),
    /// A change of how exactly pictures are drawn.
    Settings(Settings),
    /// Something of the laboratory.
    Lab(LabAsk),
    /// Selects an item, and makes its kind the subject.
    Select(ItemId),
    /// Selects a polygon of the selected object while polygons are shown one at a time.
    SelectPolygon(u32),
    /// Goes to where this many steps of the history are done.
    GoTo(usize),
    /// Asks for a name of this item.
    BeginRename(ItemId),
    /// Ends that: with a name, or without.
    EndRename(Option<String>),
    /// Asks for a picture file to lay over this object.
    ChooseTexture(ObjectId),
    /// Loads these files, or opens the scene among them.
    LoadFiles(Vec<PathBuf>),
    /// Lists all that the notice at this place has to say.
    Details(usize),
    /// Gives up loading the file that stands at this place.
    CancelLoading(usize),
    /// Puts away the notice that stands at this place.
    PutAway(usize),
    /// Takes a gesture back while it lasts, as if it had never begun.
    Abandon(Gesture),
    /// Says in the status line why something that was asked for is not done.
    Refuse(String),
}

impl From<Action> for Ask {
    fn from(action: Action) -> Self {
        Self::Do(action)
    }
}

//! Requests: what panels, menus, keys and the viewport return. Only the app answers them.

use std::path::PathBuf;

use glam::DVec3;

use super::table::Action;
use crate::app::chord::Chord;
use crate::app::state::laboratory::{Compare, Side};
use crate::app::state::layout::Layout;
use crate::app::state::{DrawingChoices, State};
use marraztu_core::accuracy::Settings;
use marraztu_core::edit::several::Others;
use marraztu_core::edit::{Gesture, Refusal};
use marraztu_core::scene::{Command, ItemId, ObjectId, UpAxis, View};
use marraztu_io::Preferences;
use marraztu_lab::candidates::Thoroughness;
use marraztu_lab::error::{Measure, Region};
use marraztu_lab::report::Budgets;
use marraztu_lab::suite::SuiteDetail;

/// A request to the app.
#[derive(Clone, Debug, PartialEq)]
pub enum Request {
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
    /// A movement of the view: it is no step of the history.
    Navigate {
        /// The change of the camera.
        command: Command,
        /// What it is part of.
        gesture: Gesture,
    },
    /// A change of the view that selects nothing else.
    View(Box<View>),
    /// A change of how exactly pictures are drawn.
    Settings(Settings),
    /// A change of how the window draws beyond that.
    Drawing(DrawingChoices),
    /// Something of the laboratory.
    Lab(LabRequest),
    /// Selects an item, and makes its kind the subject.
    Select(ItemId),
    /// Selects these items too, or no longer; the last of them becomes the one that keys act on.
    SelectAlso(Vec<ItemId>, Also),
    /// Selects these items beside the one that the keys act on.
    Others(Others),
    /// Explains this pixel of the picture.
    Explain([usize; 2]),
    /// Closes the explanation of a pixel.
    EndExplaining,
    /// Aims the selected light at a point of the world.
    AimAt(DVec3),
    /// Selects a polygon of the selected object while polygons are shown one at a time.
    SelectPolygon(u32),
    /// The outline lists only items with this in their names.
    Filter(String),
    /// Goes to the point in the history after this number of steps.
    GoTo(usize),
    /// Asks for a name of this item.
    BeginRename(ItemId),
    /// Ends that: with a name, or without.
    EndRename(Option<String>),
    /// Asks for a picture file to lay over this object.
    ChooseTexture(ObjectId),
    /// Loads these files, or opens the scene among them.
    LoadFiles(Vec<PathBuf>),
    /// Opens these files as if they were dropped: on the untouched first scene, models take its
    /// place.
    OpenFiles(Vec<PathBuf>),
    /// Asks for models, and opens them as if they were dropped.
    AskModels,
    /// Lists all that the notice at this place has to say.
    Details(usize),
    /// Gives up loading the file that stands at this place.
    CancelLoading(usize),
    /// Gives up making the file that stands at this place.
    CancelMaking(usize),
    /// Puts away the notice that stands at this place.
    PutAway(usize),
    /// Moves the notice at this place to the status line.
    Settle(usize),
    /// Forgets the notices of the status line.
    ClearNotices,
    /// Reads the model of an object again, with this axis of its file pointing up.
    TurnUp(ObjectId, UpAxis),
    /// Shows the unsaved work that is offered at this place.
    Recover(usize),
    /// Moves the unsaved work that is offered at this place aside.
    DiscardWork(usize),
    /// Takes a gesture back while it lasts, as if it had never begun.
    Abandon(Gesture),
    /// Divides the window differently among its panels.
    Layout(Layout),
    /// Something about missing files.
    Missing(MissingRequest),
    /// Something about the keys of actions.
    Keys(KeyRequest),
    /// The strip of the first minute is put away.
    EndGreeting,
    /// Other preferences.
    Preferences(Box<Preferences>),
    /// Says in the status line why a request was refused.
    Refuse(String),
}

/// How items are added to the selection.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Also {
    /// One that is selected is selected no longer.
    Toggle,
    /// They alone are selected.
    Only,
    /// They are selected too.
    Add,
}

impl From<Action> for Request {
    fn from(action: Action) -> Self {
        Self::Do(action)
    }
}

/// A request about missing files of the scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum MissingRequest {
    /// Asks where this file is, or which of the missing files to find.
    Find(Option<PathBuf>),
    /// Puts the notice about them away.
    Dismiss,
    /// Uses the missing files in the folder of a found one.
    UseNearby,
    /// Does not use them.
    DismissNearby,
}

/// A request about the keys of actions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KeyRequest {
    /// The next key is chosen for this action.
    Choose(Action),
    /// The key that was pressed becomes this action's, and is taken from any other.
    Take(Action, Chord),
    /// No key is chosen.
    Cancel,
    /// The action has the keys of the table again.
    Reset(Action),
    /// All actions have.
    ResetAll,
}

/// A request to the laboratory.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LabRequest {
    /// Measure the picture in the viewport.
    Measure(Thoroughness),
    /// Measure this axis alone, by its key.
    MeasureAxis(&'static str),
    /// Measure the suite.
    Suite(SuiteDetail),
    /// Show this report of the suite; `None` for that of the scene on screen.
    ShowSuite(Option<usize>),
    /// Cancel measuring.
    Cancel,
    /// Use this error metric.
    Judge(Measure),
    /// Take it over these pixels.
    Over(Region),
    /// Show the plot of this axis, by its key; `None` for the overview.
    Panel(Option<&'static str>),
    /// Keep to these budgets.
    Budgets(Budgets),
    /// Compare the picture with the exact one in this way.
    Compare(Compare),
    /// Compare with 256 samples per pixel, or with one.
    Sampled(bool),
    /// The next click picks a pixel, or does not.
    Pick(bool),
    /// Attribute the error of this pixel.
    Attribute([usize; 2]),
    /// Show this beside the plots.
    Side(Side),
    /// Show the lesson of this axis, by its key; opens the laboratory if needed.
    Lesson(&'static str),
    /// Open the scene of this lesson.
    ShowLesson(&'static str),
    /// Go back from the scene of a lesson to the user's own.
    Back,
}

/// Asks for a change of the scene, or says why it is refused.
pub(crate) fn change(
    requests: &mut Vec<Request>,
    label: impl Into<String>,
    gesture: Gesture,
    command: Result<Command, Refusal>,
) {
    requests.push(match command {
        Ok(command) => Request::Change { command, gesture, label: label.into() },
        Err(refusal) => Request::Refuse(refusal.to_string()),
    });
}

/// Asks for a change of the view.
pub(crate) fn change_view(
    requests: &mut Vec<Request>,
    state: &State,
    change: impl FnOnce(&mut View),
) {
    let mut view = state.view.clone();
    change(&mut view);
    requests.push(Request::View(Box::new(view)));
}

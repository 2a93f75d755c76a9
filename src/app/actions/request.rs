//! Requests: the return values of panels, menus, keys and the viewport. Only the app answers them.

use std::path::PathBuf;

use glam::DVec3;

use super::table::Action;
use crate::app::chord::Chord;
use crate::app::state::laboratory::Compare;
use crate::app::state::layout::Layout;
use crate::app::state::{DrawingChoices, NoticeKind, State};
use marraztu_core::accuracy::Settings;
use marraztu_core::edit::several::Others;
use marraztu_core::edit::{Gesture, Refusal};
use marraztu_core::scene::{Command, ItemId, ObjectId, UpAxis, View};
use marraztu_io::Preferences;
use marraztu_lab::candidates::Thoroughness;
use marraztu_lab::error::{Measure, Region};
use marraztu_lab::picture_source::Reference;
use marraztu_lab::report::Budgets;
use marraztu_lab::suite::SuiteDetail;

/// A request to the app.
#[derive(Clone, Debug, PartialEq)]
pub enum Request {
    /// Performs an action of the table.
    Do(Action),
    /// Changes the scene.
    Change {
        /// The change.
        command: Command,
        /// The gesture that it is part of.
        gesture: Gesture,
        /// The label in the history: "Move teapot".
        label: String,
    },
    /// Moves the view, which is not a step of the history.
    Navigate {
        /// The change of the camera.
        command: Command,
        /// The gesture that it is part of.
        gesture: Gesture,
    },
    /// Changes the view but not the selection.
    View(Box<View>),
    /// Changes the settings of accuracy.
    Settings(Settings),
    /// Changes the preferences for drawing in the window.
    Drawing(DrawingChoices),
    /// A request to the laboratory.
    Lab(LabRequest),
    /// Selects an item, and makes its kind the subject.
    Select(ItemId),
    /// Adds these items to the selection or removes them. The keys then act on the last one.
    SelectAlso(Vec<ItemId>, Also),
    /// Selects these items in addition to the one that the keys act on.
    Others(Others),
    /// Explains this pixel of the picture.
    Explain([usize; 2]),
    /// Closes the explanation of a pixel.
    EndExplaining,
    /// Aims the selected light at a point of the world.
    AimAt(DVec3),
    /// Selects a polygon of the selected object, in polygon mode.
    SelectPolygon(u32),
    /// Sets the filter of the outline, a part of the names.
    Filter(String),
    /// Goes to the state after this number of steps of the history.
    GoTo(usize),
    /// Begins to rename this item.
    BeginRename(ItemId),
    /// Ends renaming, with a new name or without.
    EndRename(Option<String>),
    /// Asks for a picture file as the texture of these objects.
    ChooseTexture(Vec<ObjectId>),
    /// Loads these files, or opens the scene among them.
    LoadFiles(Vec<PathBuf>),
    /// Opens these files as if they were dropped on the window: if the first scene is untouched,
    /// models replace it.
    OpenFiles(Vec<PathBuf>),
    /// Asks for models, and opens them as if they were dropped.
    AskModels,
    /// Does what the notices of this kind offer.
    Accept(NoticeKind),
    /// Lists all details of the notices of this kind.
    Details(NoticeKind),
    /// Cancels loading the file at this index.
    CancelLoading(usize),
    /// Cancels making the file at this index.
    CancelMaking(usize),
    /// Moves the notices of this kind to the status line.
    Settle(NoticeKind),
    /// Dismisses all notices.
    DismissNotices,
    /// Removes all notices from the status line.
    ClearNotices,
    /// Reads the models of objects again, with this axis of their files as the up axis.
    TurnUp(Vec<ObjectId>, UpAxis),
    /// Uses this up axis for all models from now on, unless their files state one.
    UpByDefault(UpAxis),
    /// Shows the unsaved work at this index.
    Recover(usize),
    /// Discards the unsaved work at this index.
    DiscardWork(usize),
    /// Undoes a gesture in progress, as if it had never begun.
    Abandon(Gesture),
    /// Divides the window differently among its panels.
    Layout(Layout),
    /// A request about missing files.
    Missing(MissingRequest),
    /// A request about the keys of actions.
    Keys(KeyRequest),
    /// Dismisses the greeting.
    EndGreeting,
    /// Changes the preferences.
    Preferences(Box<Preferences>),
    /// Shows in the status line why a request was refused.
    Refuse(String),
}

/// Requests, in the order in which they are answered.
pub(crate) type Requests = Vec<Request>;

/// How items are added to the selection.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Also {
    /// Toggle the selection of these items.
    Toggle,
    /// Select only these items.
    Only,
    /// Add these items to the selection.
    Add,
}

impl Request {
    /// Requests a change of the scene, or reports why it is refused.
    pub(crate) fn change(
        label: impl Into<String>,
        gesture: Gesture,
        command: Result<Command, Refusal>,
    ) -> Self {
        match command {
            Ok(command) => Self::Change { command, gesture, label: label.into() },
            Err(refusal) => Self::Refuse(refusal.to_string()),
        }
    }
}

impl From<Action> for Request {
    fn from(action: Action) -> Self {
        Self::Do(action)
    }
}

/// A request about missing files of the scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum MissingRequest {
    /// Asks for the location of this file, or which of the missing files to find.
    Find(Option<PathBuf>),
    /// Dismisses the notice about missing files.
    Dismiss,
    /// Uses the missing files in the folder of a found one.
    UseNearby,
    /// Ignores the missing files in the folder of a found one.
    DismissNearby,
}

/// A request about the keys of actions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KeyRequest {
    /// Waits for a key for this action.
    Choose(Action),
    /// Gives the key that was pressed to this action and takes it from any other.
    Take(Action, Chord),
    /// Stops waiting for a key.
    Cancel,
    /// Restores the keys of this action from the table.
    Reset(Action),
    /// Restores the keys of all actions.
    ResetAll,
}

/// A request to the laboratory.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LabRequest {
    /// Measure the picture in the viewport.
    Measure(Thoroughness),
    /// Measure only this axis, given by its key.
    MeasureAxis(&'static str),
    /// Measure the suite.
    Suite(SuiteDetail),
    /// Show this report of the suite; `None` shows the report of the scene on screen.
    ShowSuite(Option<usize>),
    /// Cancel measuring.
    Cancel,
    /// Use this error metric.
    Judge(Measure),
    /// Compute the metric over these pixels.
    Over(Region),
    /// Show the plot of this axis, given by its key; `None` shows the overview.
    Panel(Option<&'static str>),
    /// Use these budgets.
    Budgets(Budgets),
    /// Compare the picture with the exact one in this way.
    Compare(Compare),
    /// Compare with this picture.
    Against(Reference),
    /// Start or stop picking a pixel with the next click.
    Pick(bool),
    /// Attribute the error of this pixel.
    Attribute([usize; 2]),
    /// Open the scene of the lesson on this axis, given by its key, and show the lesson.
    ShowLesson(&'static str),
    /// Return from the scene of a lesson to the user's scene.
    Back,
}

/// Requests a change of the scene, or reports why it is refused.
pub(crate) fn change(
    requests: &mut Requests,
    label: impl Into<String>,
    gesture: Gesture,
    command: Result<Command, Refusal>,
) {
    requests.push(Request::change(label, gesture, command));
}

pub(crate) fn change_view(requests: &mut Requests, state: &State, change: impl FnOnce(&mut View)) {
    let mut view = state.view.clone();
    change(&mut view);
    requests.push(Request::View(Box::new(view)));
}

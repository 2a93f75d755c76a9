//! The effects that actions can have.

use egui::ThemePreference;

use crate::app::state::{State, ViewStep};
use crate::app::widgets::regions::Way;
use marraztu_core::edit::selection::Selection;
use marraztu_core::scene::{Command, ItemId, ObjectId, Subject, View};
use marraztu_io::ExportOptions;

/// The effect of an action.
pub(crate) enum Intent {
    /// Change the scene.
    Change(Command),
    /// Change the scene; the kind of the new item becomes the subject.
    Add(Command, Subject),
    /// Move the view.
    Navigate(Command),
    /// Go to an earlier or later viewpoint, or to the saved one.
    ToViewpoint(ViewStep),
    /// Change the view.
    View(Box<View>),
    /// Change the selection.
    Select(Box<Selection>),
    /// Change what the window shows, and how.
    Show(Box<dyn FnOnce(&mut State)>),
    /// Make the window light or dark.
    Theme(ThemePreference),
    /// Ask for a new name.
    Rename(ItemId),
    /// Go back one step in the history.
    Undo,
    /// Go forward one step in the history.
    Redo,
    /// Dismiss, cancel or deselect; then quit.
    Escape,
    /// Use files.
    File(FileIntent),
    /// Add a camera after asking for its material.
    AskCamera,
    /// Start or stop measuring the effects of the picture.
    Measure,
    /// Choose a picture as the texture of objects.
    ChooseTexture(Vec<ObjectId>),
    /// Choose a picture as the light of the sky.
    ChoosePanorama,
    /// Find out why an object cannot be seen.
    WhyUnseen(ObjectId),
    /// Begin or end a presentation.
    Present,
    /// Scale the interface.
    Zoom(f32),
    /// Show or hide the loupe.
    Loupe,
    /// Fit the exposure to the picture.
    FitExposure,
    /// Take an axis and a number from the keyboard.
    TypeAmount,
    /// List the notices so far.
    PastNotices,
    /// Use the clipboard.
    Clipboard(ClipboardIntent),
    /// Move the keyboard focus to the panels or back to the viewport.
    ChangeKeyboardOwner(Way),
}

/// The use of the clipboard by an action.
pub(crate) enum ClipboardIntent {
    /// Copy the selected items.
    Copy,
    /// Copy the selected items, then delete them with this command.
    Cut(Command),
    /// Add the content of the clipboard to the scene.
    Paste,
    /// Copy the material of an object.
    CopyMaterial(ObjectId),
}

/// The use of files by an action. Most uses begin with a file dialog.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FileIntent {
    New,
    Open,
    Load,
    Save,
    SaveAs,
    SavePicture,
    PictureOptions,
    Turntable,
    Export(ExportOptions),
    CopyPicture,
    NewAncestor,
    Reload,
    Recover,
    RecoverDiscarded,
    FindMissing,
    Quit,
}

//! The effects that actions can have.

use egui::ThemePreference;

use crate::app::panels::OpenPanels;
use crate::app::state::DrawingChoices;
use crate::app::state::layout::Layout;
use crate::app::widgets::regions::Way;
use marraztu_core::accuracy::Settings;
use marraztu_core::edit::selection::Selection;
use marraztu_core::edit::several::Others;
use marraztu_core::scene::{Command, ItemId, ObjectId, Subject, View};
use marraztu_io::Helpers;

/// The effect of an action.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Intent {
    /// Change the scene.
    Change(Command),
    /// Change the scene; the kind of the new item becomes the subject.
    Add(Command, Subject),
    /// Move the view.
    Navigate(Command),
    /// Change the view.
    View(Box<View>),
    /// Change the selection.
    Select(Box<Selection>),
    /// Change the preferences for drawing in the window.
    Drawing(DrawingChoices),
    /// Show other panels.
    Panels(OpenPanels),
    /// Divide the window differently among its panels.
    Layout(Layout),
    /// Make the window light or dark.
    Theme(ThemePreference),
    /// Ask for a new name.
    Rename(ItemId),
    /// Go back one step in the history.
    Undo,
    /// Go forward one step in the history.
    Redo,
    /// Use files.
    File(FileIntent),
    /// Add a camera after asking for its material.
    AskCamera,
    /// Start or stop measuring the effects of the picture.
    Measure,
    /// Choose a picture as the texture of an object.
    ChooseTexture(ObjectId),
    /// Find out why an object cannot be seen.
    WhyUnseen(ObjectId),
    /// Open or close the command palette.
    Palette,
    /// Scale the interface.
    Zoom(f32),
    /// Show or hide everything drawn over the picture.
    Overlays,
    /// Show or hide the gizmo.
    Gizmo,
    /// Show or hide the dial.
    Dial,
    /// Show or hide the loupe.
    Loupe,
    /// Draw with these settings.
    Settings(Settings),
    /// Allow or forbid reduced quality while something moves.
    Coarse,
    /// Start or stop watching files.
    Watch,
    /// Fit the exposure to the picture.
    FitExposure,
    /// Show other helpers.
    Helpers(Helpers),
    /// Take an axis and a number from the keyboard.
    TypeAmount,
    /// Select these items in addition to the one that the keys act on.
    Others(Others),
    /// Use the clipboard.
    Clipboard(ClipboardIntent),
    /// Explain the pixel of the next click into the picture.
    Explain,
    /// Aim the selected light at the next click into the picture.
    AimByClick,
    /// Move the keyboard focus to the panels or back to the viewport.
    ChangeKeyboardOwner(Way),
}

/// The use of the clipboard by an action.
#[derive(Clone, Debug, PartialEq)]
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
    Export,
    CopyPicture,
    NewAncestor,
    Reload,
    Recover,
    RecoverDiscarded,
    FindMissing,
    Quit,
}

//! What an action can mean.

use egui::ThemePreference;

use crate::app::panels::OpenPanels;
use crate::app::state::DrawingChoices;
use crate::app::state::layout::Layout;
use crate::app::widgets::regions::Way;
use marraztu_core::edit::selection::Selection;
use marraztu_core::edit::several::Others;
use marraztu_core::scene::{Command, ItemId, ObjectId, Subject, View};
use marraztu_io::Helpers;

/// What an action means.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Intent {
    /// A change of the scene.
    Change(Command),
    /// A change of the scene whose new item becomes the subject.
    Add(Command, Subject),
    /// A movement of the view.
    Navigate(Command),
    /// A change of the view.
    View(Box<View>),
    /// Another selection.
    Select(Box<Selection>),
    /// The window draws in another way beyond the settings.
    Drawing(DrawingChoices),
    /// Other panels are shown.
    Panels(OpenPanels),
    /// The window is divided differently among its panels.
    Layout(Layout),
    /// The window becomes light or dark.
    Theme(ThemePreference),
    /// Asks for a new name.
    Rename(ItemId),
    /// One step back in the history.
    Undo,
    /// One step forward in the history.
    Redo,
    /// Something with files.
    File(FileIntent),
    /// A camera is added once its material is chosen.
    AskCamera,
    /// The effects of the picture are measured, or no longer.
    Measure,
    /// A picture is chosen as the texture of an object.
    ChooseTexture(ObjectId),
    /// The reason why nothing of an object is seen is looked for.
    WhyUnseen(ObjectId),
    /// The list of everything that can be asked for opens or closes.
    Palette,
    /// The interface becomes this large.
    Zoom(f32),
    /// What is drawn over the picture is shown or hidden.
    Overlays,
    /// Handles over the picture are shown or hidden.
    Gizmo,
    /// Pictures may be coarser while something moves, or not.
    Coarse,
    /// Files are looked at, or no longer.
    Watch,
    /// The exposure follows the picture.
    FitExposure,
    /// Other helpers are shown.
    Helpers(Helpers),
    /// An axis and a number are taken from the keyboard.
    TypeAmount,
    /// These are selected beside the selected item.
    Others(Others),
    /// Something with the clipboard.
    Clipboard(ClipboardIntent),
    /// The next click into the picture explains a pixel.
    Explain,
    /// The next click into the picture aims the selected light.
    AimByClick,
    /// The keyboard goes to the panels, or back to the viewport.
    ChangeKeyboardOwner(Way),
}

/// The use of the clipboard by an action.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum ClipboardIntent {
    /// The selected items are copied.
    Copy,
    /// The same, and this command deletes them.
    Cut(Command),
    /// Adds the content of the clipboard to the scene.
    Paste,
    /// The material of an object is copied.
    CopyMaterial(ObjectId),
}

/// What an action does with files, most of it by asking for one.
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

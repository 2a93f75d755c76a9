//! The appearance of actions, and their groups in menus and in the cheat sheet.

use crate::app::chord::Chord;
use crate::app::panels::PanelInfo;
use marraztu_core::base::math::Axis;
use marraztu_core::edit::transform::Sign;

/// The appearance of an action.
#[derive(Clone, Copy, Debug)]
pub struct ActionInfo {
    /// The text on menu entries and buttons.
    pub label: &'static str,
    /// The tooltip: one sentence.
    pub hint: &'static str,
    /// Synonyms to search for.
    pub words: &'static str,
    /// All chords that trigger it; the first one is shown.
    pub keys: &'static [Chord],
    /// Its group in menus and in the cheat sheet.
    pub group: Group,
    /// Whether holding the key repeats it.
    pub repeats: bool,
    /// The naming of its steps in the history.
    pub step: StepName,
}

/// How the history names the steps of an action.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StepName {
    /// The action's label, with "Add" in front for new items.
    Label,
    /// Words before and after the name of the item: "Drop", "to the ground".
    Around(&'static str, &'static str),
    /// One of two words before the name of the item; the first if the switch was on.
    Switched(&'static str, &'static str),
    /// The distance of the step: "Move ship 10 along x".
    Amount(Axis, Sign),
}

/// Whether holding the key of an action repeats it.
pub(super) const ONCE: bool = false;
pub(super) const REPEATS: bool = true;

impl ActionInfo {
    /// Describes the action that shows and hides a panel.
    pub(super) const fn of_panel(panel: PanelInfo) -> Self {
        let PanelInfo { label, hint, words, keys, .. } = panel;
        Self {
            label,
            hint,
            words,
            keys,
            group: Group::Window,
            repeats: ONCE,
            step: StepName::Label,
        }
    }
}

/// A group of actions in menus and in the cheat sheet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Group {
    /// Files and the program itself.
    File,
    /// Changes to the selection, undo and redo.
    Edit,
    /// New items.
    Add,
    /// The selection and the subject.
    Select,
    /// Moving, rotating, scaling.
    Transform,
    /// Visibility and display.
    Show,
    /// The observer and the direction of view.
    Camera,
    /// Lights on and off, colours, apertures.
    Light,
    /// Panels and help.
    Window,
}

impl Group {
    /// All groups, in the order of menus and of the cheat sheet.
    pub const ALL: [Self; 9] = [
        Self::File,
        Self::Edit,
        Self::Add,
        Self::Select,
        Self::Transform,
        Self::Show,
        Self::Camera,
        Self::Light,
        Self::Window,
    ];

    /// Returns its heading.
    pub const fn label(self) -> &'static str {
        match self {
            Self::File => "File",
            Self::Edit => "Edit",
            Self::Add => "Add",
            Self::Select => "Select",
            Self::Transform => "Transform",
            Self::Show => "Show",
            Self::Camera => "Camera",
            Self::Light => "Light",
            Self::Window => "Window",
        }
    }
}

/// Defines the actions from the rows of the table.
macro_rules! actions {
    ($(
        $name:ident $group:ident $repeats:ident [$($key:expr),*]
            $label:literal $hint:literal $words:literal $(=> $step:expr)?;
    )+) => {
        /// An action of the user that needs no arguments.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum Action {
            $(#[doc = $hint] $name,)+
            /// Shows or hides a panel.
            Panel(Panel),
        }

        impl Action {
            /// All actions except the panels' actions.
            pub(super) const ROWS: &'static [Self] = &[$(Self::$name),+];

            /// Returns the appearance of the action.
            pub const fn info(self) -> ActionInfo {
                match self {
                    $(Self::$name => ActionInfo {
                        label: $label,
                        hint: $hint,
                        words: $words,
                        keys: &[$($key),*],
                        group: Group::$group,
                        repeats: $repeats,
                        step: [$($step,)? StepName::Label][0],
                    },)+
                    Self::Panel(panel) => ActionInfo::of_panel(panel.info()),
                }
            }
        }
    };
}
pub(super) use actions;

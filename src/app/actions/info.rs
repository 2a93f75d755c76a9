//! How actions appear, and the groups in which menus and the cheat sheet show them.

use crate::app::chord::Chord;
use crate::app::panels::PanelInfo;
use marraztu_core::base::math::Axis;
use marraztu_core::edit::transform::Sign;

/// How an action appears.
#[derive(Clone, Copy, Debug)]
pub struct ActionInfo {
    /// On menus and buttons.
    pub label: &'static str,
    /// Over them: one sentence.
    pub hint: &'static str,
    /// Other words that people use for it, for searches.
    pub words: &'static str,
    /// Every way to press it; the first is the one that is shown.
    pub keys: &'static [Chord],
    /// Its group in menus and in the cheat sheet.
    pub group: Group,
    /// Whether a held key asks for it again and again.
    pub repeats: bool,
    /// How the history names it.
    pub step: StepName,
}

/// How the history names what an action did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StepName {
    /// By the action's label, with "Add" before those of new things.
    Label,
    /// By words before and after the name of the item: "Drop", "to the ground".
    Around(&'static str, &'static str),
    /// By one of two words before the name of the item; the first if the switch was on.
    Switched(&'static str, &'static str),
    /// By how far the item goes: "Move ship 10 along x".
    Amount(Axis, Sign),
}

/// What a held key does: it asks once, or again and again.
pub(super) const ONCE: bool = false;
pub(super) const REPEATS: bool = true;

impl ActionInfo {
    /// How the action that shows and hides a panel appears.
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

/// Actions that stand together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Group {
    /// Files and the program itself.
    File,
    /// Changes to the selection, undo and redo.
    Edit,
    /// New things.
    Add,
    /// What the keys act on.
    Select,
    /// Moving, turning, scaling.
    Transform,
    /// What is shown, and how.
    Show,
    /// Who looks, and from where.
    Camera,
    /// Lights on and off, colours, apertures.
    Light,
    /// Panels and help.
    Window,
}

impl Group {
    /// All of them, in the order of menus and cheat sheet.
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

    /// Its heading.
    #[must_use]
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

/// Makes the actions of the rows.
macro_rules! actions {
    ($(
        $name:ident $group:ident $repeats:ident [$($key:expr),*]
            $label:literal $hint:literal $words:literal $(=> $step:expr)?;
    )+) => {
        /// Something a user can ask for that needs no further words.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum Action {
            $(#[doc = $hint] $name,)+
            /// Shows or hides a panel.
            Panel(Panel),
        }

        impl Action {
            /// Every action but those of panels.
            pub(super) const ROWS: &'static [Self] = &[$(Self::$name),+];

            /// How the action appears.
            #[must_use]
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

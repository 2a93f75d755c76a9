//! The table of panels: their names, places and files.
//!
//! Actions, menus, scene files and preferences read the table; `arrange` shows its panels. The
//! table is plain data and independent of the panels themselves, so the table of actions can read
//! it. Panels read the state and return requests; they change nothing.

mod about;
pub(crate) mod arrange;
mod cheat_sheet;
mod dial;
pub(crate) mod greeting;
mod history;
mod lab;
mod lesson_card;
mod menu_bar;
pub(crate) mod notices;
mod outline;
mod palette;
pub(crate) mod pixel;
mod plan;
pub(crate) mod preferences;
mod properties;
mod splitters;
mod statistics;
mod status_line;
mod undo_buttons;
mod view_switches;

use egui::Key;

use crate::app::chord::Chord;
use crate::app::chord::Chord::{Command, Either, Named, Text};
use marraztu_io as io;

/// The place of a panel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Dock {
    /// At a side of the picture; in a narrow window, one at a time.
    Beside(Side),
    /// At the bottom of the window.
    Bottom,
    /// Below the picture.
    UnderPicture,
    /// Over the picture, wherever the panel chooses.
    Floating,
}

impl Dock {
    /// Returns the side of the picture, if the panel is at one.
    pub const fn side(self) -> Option<Side> {
        match self {
            Self::Beside(side) => Some(side),
            Self::Bottom | Self::UnderPicture | Self::Floating => None,
        }
    }
}

/// A place at a side of the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Side {
    /// At the left: the list of objects, cameras and lights.
    Outline,
    /// At the left, below the outline: the switches of the view.
    Switches,
    /// At the right: the properties of the selected item.
    Properties,
}

/// The appearance of a panel.
#[derive(Clone, Copy, Debug)]
pub struct PanelInfo {
    /// The name in files.
    pub name: &'static str,
    /// Its place.
    pub dock: Dock,
    /// Whether it is open at the first start.
    pub open: bool,
    /// The keys that show and hide it.
    pub keys: &'static [Chord],
    /// The text on menus and buttons.
    pub label: &'static str,
    /// The tooltip: one sentence.
    pub hint: &'static str,
    /// Synonyms to search for.
    pub words: &'static str,
}

/// Passes the rows of the table to a macro: variant, file, name in files, dock, whether it is open
/// at the first start, keys, label, hint and words.
macro_rules! each_panel {
    ($then:ident) => {
        $then! {
            CheatSheet cheat_sheet "cheat_sheet" [Dock::Floating] false
                [Either(Key::H), Text("?"), Named(Key::F1)]
                "Keys" "Lists every key and mouse action, with its effect and its current value."
                "shortcuts help hotkeys keyboard mouse bindings";
            Outline outline "outline" [Dock::Beside(Side::Outline)] true []
                "Outline" "Shows or hides the list of objects, cameras and lights."
                "tree hierarchy list scene layers";
            Properties properties "properties" [Dock::Beside(Side::Properties)] true []
                "Properties" "Shows or hides the properties of the selected item."
                "inspector details material attributes";
            View view_switches "view" [Dock::Beside(Side::Switches)] true []
                "View switches" "Shows or hides the switches of the view."
                "display accuracy";
            Statistics statistics "statistics" [Dock::Floating] false []
                "Statistics" "Shows or hides the counts and times of the picture."
                "fps frames speed performance triangles count";
            Plan plan "plan" [Dock::UnderPicture] false [Named(Key::F3)]
                "Plan" "Shows or hides the effects of the picture, with reasons and costs."
                "effects explain cost why";
            History history "history" [Dock::Floating] false []
                "History" "Shows or hides the steps that can be undone and redone."
                "undo redo steps back list changes";
            Laboratory lab "laboratory" [Dock::Bottom] false [Named(Key::F5)]
                "Laboratory"
                "Shows or hides the laboratory, which measures what accuracy costs in time."
                "accuracy measure benchmark time error compare experiment";
            Preferences preferences "preferences" [Dock::Floating] false [Command(Key::Comma)]
                "Preferences" "Shows or hides the settings that the program remembers, with resets."
                "settings options configuration defaults reset remembered theme recent";
            About about "about" [Dock::Floating] false []
                "About" "Shows or hides version, commit, instructions in use, and licences."
                "version licence license copyright credits commit build info packages";
        }
    };
}
pub(crate) use each_panel;

macro_rules! table {
    ($(
        $panel:ident $file:ident $name:literal [$dock:expr] $open:literal [$($key:expr),*]
            $label:literal $hint:literal $words:literal;
    )+) => {
        /// A panel that can be shown and hidden.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum Panel {
            $(#[doc = $hint] $panel,)+
        }

        impl Panel {
            /// Every panel, in the order of menus.
            pub const ALL: &'static [Self] = &[$(Self::$panel),+];

            /// Returns the appearance of the panel.
            pub const fn info(self) -> PanelInfo {
                match self {
                    $(Self::$panel => PanelInfo {
                        name: $name,
                        dock: $dock,
                        open: $open,
                        keys: &[$($key),*],
                        label: $label,
                        hint: $hint,
                        words: $words,
                    },)+
                }
            }
        }
    };
}

each_panel!(table);

impl Panel {
    /// The panels that Esc closes first. Files and preferences do not keep them open.
    pub const MOMENTARY: [Self; 3] = [Self::CheatSheet, Self::Preferences, Self::About];
}

/// The set of open panels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OpenPanels([bool; Panel::ALL.len()]);

impl OpenPanels {
    /// The panels open at the first start.
    pub const DEFAULT: Self = {
        let mut open = [false; Panel::ALL.len()];
        let mut i = 0;
        while i < open.len() {
            open[i] = Panel::ALL[i].info().open;
            i += 1;
        }
        Self(open)
    };

    /// No panels.
    pub const NONE: Self = Self([false; Panel::ALL.len()]);

    /// Returns whether a panel is open.
    pub const fn has(self, panel: Panel) -> bool {
        self.0[panel as usize]
    }

    /// Returns these panels with one of them opened or closed.
    #[must_use]
    pub const fn with(mut self, panel: Panel, open: bool) -> Self {
        self.0[panel as usize] = open;
        self
    }

    /// Returns these panels with one of them toggled.
    #[must_use]
    pub const fn toggled(self, panel: Panel) -> Self {
        self.with(panel, !self.has(panel))
    }

    /// Returns these panels without the momentary ones, and without the laboratory, which
    /// would take half of the next start.
    #[must_use]
    pub const fn lasting(self) -> Self {
        let [a, b, c] = Panel::MOMENTARY;
        let without = self.with(a, false).with(b, false).with(c, false);
        without.with(Panel::Laboratory, false)
    }

    /// Converts the set to the form in files.
    pub fn kept(self) -> io::Panels {
        Panel::ALL.iter().map(|panel| (panel.info().name, self.has(*panel))).collect()
    }

    /// Reads the set from a file. Panels that the file does not mention are as at the first start.
    pub fn of_kept(kept: &io::Panels) -> Self {
        let is_open = |panel: &Panel| kept.is_open(panel.info().name);
        Panel::ALL.iter().fold(Self::DEFAULT, |panels, panel| match is_open(panel) {
            Some(open) => panels.with(*panel, open),
            None => panels,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_two_docked_panels_share_a_place_and_none_a_name() {
        for (i, panel) in Panel::ALL.iter().enumerate() {
            for other in &Panel::ALL[i + 1..] {
                let (a, b) = (panel.info(), other.info());
                assert_ne!(a.name, b.name);
                assert!(a.dock != b.dock || a.dock == Dock::Floating, "{panel:?} and {other:?}");
            }
        }
    }

    #[test]
    fn open_panels_survive_saving_and_default_to_the_first_start() {
        for panel in Panel::ALL {
            let toggled = OpenPanels::DEFAULT.toggled(*panel);
            assert_ne!(toggled, OpenPanels::DEFAULT);
            assert_eq!(OpenPanels::of_kept(&toggled.kept()), toggled);
        }
        assert_eq!(OpenPanels::of_kept(&io::Panels::default()), OpenPanels::DEFAULT);
    }
}

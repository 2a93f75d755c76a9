//! Lists of actions: all actions, the actions of a group, and their names in preferences.

use super::info::Group;
use super::table::Action;
use crate::app::panels::Panel;

impl Action {
    /// Every action, in the order of menus and of the cheat sheet. The actions of panels come
    /// before [`Self::MeasurePlan`].
    pub const ALL: &'static [Self] = &{
        let mut all = [Self::New; Self::ROWS.len() + Panel::ALL.len()];
        let (mut from, mut to) = (0, 0);
        while from < Self::ROWS.len() {
            if matches!(Self::ROWS[from], Self::MeasurePlan) {
                let mut panel = 0;
                while panel < Panel::ALL.len() {
                    all[to] = Self::Panel(Panel::ALL[panel]);
                    (panel, to) = (panel + 1, to + 1);
                }
            }
            all[to] = Self::ROWS[from];
            (from, to) = (from + 1, to + 1);
        }
        all
    };

    /// Returns its name in preferences.
    pub fn name(self) -> String {
        match self {
            Self::Panel(panel) => format!("{panel:?}"),
            row => format!("{row:?}"),
        }
    }

    /// Finds the action with this name in preferences. Older versions called the actions of panels
    /// `TogglePlan` or `ToggleViewPanel`.
    pub fn named(name: &str) -> Option<Self> {
        let panel = name.strip_prefix("Toggle").map(|name| name.trim_end_matches("Panel"));
        let find = |name: &str| Self::ALL.iter().copied().find(|action| action.name() == name);
        find(name).or_else(|| find(panel?))
    }
}

impl Group {
    /// The actions of [`Self::Show`] for things drawn over the picture, not in it.
    pub const OVER_PICTURE: [Action; 8] = [
        Action::ToggleDial,
        Action::ToggleLoupe,
        Action::ToggleOverlays,
        Action::ToggleMarks,
        Action::ToggleGizmo,
        Action::ToggleGrid,
        Action::ToggleDimensions,
        Action::ToggleDirections,
    ];

    /// Lists its actions in order.
    pub fn actions(self) -> impl Iterator<Item = Action> {
        Action::ALL.iter().copied().filter(move |action| action.info().group == self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::chord::Chord;

    #[test]
    fn no_two_actions_share_a_key() {
        let all: Vec<(Action, Chord)> = Action::ALL
            .iter()
            .flat_map(|action| action.info().keys.iter().map(|key| (*action, *key)))
            .collect();
        for (i, (a, key)) in all.iter().enumerate() {
            for (b, other) in &all[i + 1..] {
                assert!(!key.clashes_with(*other), "{a:?} and {b:?} are both on {key}");
            }
        }
    }

    #[test]
    fn every_key_of_the_specification_has_an_action() {
        let letters = "f F l L o O d D t T r R s S g G x X y Y z Z u U c C p P b B n N m M i I \
                       q Q v V a A 0 1 2 3 4 5 6 7 8 9 + - . ? h Tab Enter Esc Home Delete F1 F2 \
                       F12 Ctrl+Z Ctrl+Shift+Z Ctrl+Y Ctrl+S Ctrl+Shift+S Ctrl+O Ctrl+N Ctrl+D \
                       Ctrl+Q Ctrl+1 Ctrl+3 Ctrl+7 Ctrl+K Ctrl+P";
        for name in letters.split_whitespace() {
            let named = |action: &&Action| {
                action.info().keys.iter().any(|key| key.names().iter().any(|text| text == name))
            };
            assert!(Action::ALL.iter().any(|action| named(&action)), "nothing is on {name}");
        }
    }

    #[test]
    fn only_the_keys_of_the_specification_repeat() {
        let repeating: Vec<String> = Action::ALL
            .iter()
            .filter(|action| action.info().repeats)
            .flat_map(|action| action.info().keys.iter().flat_map(|key| key.names()))
            .collect();
        let expected = "Ctrl+Z Ctrl+Shift+Z Ctrl+Y Tab Enter x X y Y z Z + - q Q v V a A";
        assert_eq!(repeating.join(" "), expected);
    }

    #[test]
    fn every_hint_is_a_sentence_and_no_two_labels_are_alike_in_a_group() {
        for (i, action) in Action::ALL.iter().enumerate() {
            let info = action.info();
            assert!(info.hint.ends_with('.'), "{action:?}");
            for other in &Action::ALL[i + 1..] {
                let same = other.info().label == info.label;
                assert!(!same, "{action:?} and {other:?} are both called {}", info.label);
            }
        }
    }
}

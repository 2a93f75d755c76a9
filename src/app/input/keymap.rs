//! The keys of actions: the user's choices, and the table for all others.

use std::collections::BTreeMap;

use egui::Key;

use crate::app::actions::{Action, Chord};

/// The keys that the user has chosen, by the index of the action in the table.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Keymap {
    chosen: BTreeMap<usize, Vec<Chord>>,
}

fn place(action: Action) -> usize {
    Action::ALL.iter().position(|other| *other == action).unwrap_or(usize::MAX)
}

impl Keymap {
    pub(crate) fn keys(&self, action: Action) -> &[Chord] {
        self.chosen.get(&place(action)).map_or(action.info().keys, Vec::as_slice)
    }

    /// Returns whether the user has chosen its keys.
    pub(crate) fn is_chosen(&self, action: Action) -> bool {
        self.chosen.contains_key(&place(action))
    }

    /// Finds another action that the chord would trigger.
    pub(crate) fn clash(&self, action: Action, chord: Chord) -> Option<Action> {
        let others = Action::ALL.iter().copied().filter(|other| *other != action);
        others.into_iter().find(|other| self.keys(*other).iter().any(|it| it.clashes_with(chord)))
    }

    /// Makes this the key of an action and takes it from all others.
    pub(crate) fn set(&mut self, action: Action, chord: Chord) {
        while let Some(other) = self.clash(action, chord) {
            self.take(other, chord);
        }
        self.choose(action, vec![chord]);
    }

    fn take(&mut self, from: Action, chord: Chord) {
        let keys = self.keys(from).iter().copied().filter(|it| !it.clashes_with(chord));
        self.choose(from, keys.collect());
    }

    fn choose(&mut self, action: Action, keys: Vec<Chord>) {
        if keys == action.info().keys {
            self.chosen.remove(&place(action));
        } else {
            self.chosen.insert(place(action), keys);
        }
    }

    /// Restores the keys of an action from the table and takes them from all others.
    pub(crate) fn reset(&mut self, action: Action) {
        self.chosen.remove(&place(action));
        for chord in action.info().keys {
            while let Some(other) = self.clash(action, *chord) {
                self.take(other, *chord);
            }
        }
    }

    /// Converts the choices to text: the names of the keys, by the names of the actions.
    pub(crate) fn names(&self) -> BTreeMap<String, Vec<String>> {
        let named = |(place, keys): (&usize, &Vec<Chord>)| {
            let keys = keys.iter().flat_map(|key| key.names()).collect();
            Some((Action::ALL.get(*place)?.name(), keys))
        };
        self.chosen.iter().filter_map(named).collect()
    }

    /// Reads keys from their names. Also returns sentences about keys that this version does not
    /// know or gives to other actions. An action without any known key keeps the keys of the table.
    pub(crate) fn of_names(names: &BTreeMap<String, Vec<String>>) -> (Self, Vec<String>) {
        let (mut keymap, mut said) = (Self::default(), Vec::new());
        for (name, keys) in names {
            let Some(action) = Action::named(name) else {
                said.push(format!("This version has no action {name:?}."));
                continue;
            };
            let (known, unknown): (Vec<_>, Vec<_>) =
                keys.iter().map(|key| chord_named(key).ok_or(key)).partition(Result::is_ok);
            for key in unknown.into_iter().filter_map(Result::err) {
                said.push(format!("{key:?} cannot be a key of \"{}\".", action.info().label));
            }
            // Older versions had Esc among the keys that quit; it has another action now.
            let is_free =
                |key: &Chord| action == Action::Escape || *key != Chord::Named(Key::Escape);
            let known: Vec<Chord> = known.into_iter().flatten().filter(is_free).collect();
            if keys.is_empty() || !known.is_empty() {
                keymap.choose(action, known);
            }
        }
        keymap.settle(&mut said);
        (keymap, said)
    }

    /// Takes the user's keys from all other actions. An older version may have allowed a key that
    /// the table has given to another action since.
    fn settle(&mut self, said: &mut Vec<String>) {
        for action in Action::ALL.iter().copied() {
            let chosen = self.chosen.get(&place(action)).cloned();
            for chord in chosen.into_iter().flatten() {
                while let Some(other) = self.clash(action, chord) {
                    self.take(other, chord);
                    let [own, other] = [action, other].map(|action| action.info().label);
                    let key = chord.name();
                    said.push(format!(
                        "{key} is your key for \"{own}\"; \"{other}\" no longer has it."
                    ));
                }
            }
        }
    }
}

fn chord_named(name: &str) -> Option<Chord> {
    if let Some(key) = name.strip_prefix("Ctrl+Shift+").or_else(|| name.strip_prefix("Cmd+Shift+"))
    {
        return Key::from_name(key).map(Chord::CommandShift);
    }
    if let Some(key) = name.strip_prefix("Ctrl+").or_else(|| name.strip_prefix("Cmd+")) {
        return Key::from_name(key).map(Chord::Command);
    }
    if let Some(key) = name.strip_prefix("Alt+") {
        return Key::from_name(key).map(Chord::Alt);
    }
    if let Some(key) = name.strip_prefix("Shift+") {
        return Key::from_name(key).map(Chord::Shifted);
    }
    if let Some(sign) = ["+", "-", ".", "?"].into_iter().find(|sign| *sign == name) {
        return Some(Chord::Text(sign));
    }
    let mut letters = name.chars();
    match (letters.next()?, letters.next()) {
        (letter, None) if letter.is_ascii_uppercase() => Key::from_name(name).map(Chord::Upper),
        (letter, None) if letter.is_ascii_alphanumeric() => {
            Key::from_name(&name.to_uppercase()).map(Chord::Lower)
        }
        _ if name == "Esc" => Some(Chord::Named(Key::Escape)),
        _ => Key::from_name(name).map(Chord::Named),
    }
}

/// Converts a key press to a chord, if possible.
pub(crate) fn chord_of(key: Key, modifiers: egui::Modifiers) -> Option<Chord> {
    let is_letter = key.name().len() == 1 && key.name().chars().all(char::is_alphanumeric);
    let is_digit = key.name().chars().all(|letter| letter.is_ascii_digit());
    if modifiers.alt {
        // With Alt, letters may belong to another layer of the layout.
        let types = is_letter || modifiers.command || modifiers.shift;
        return (!types).then_some(Chord::Alt(key));
    }
    Some(match (modifiers.command, modifiers.shift) {
        (true, false) => Chord::Command(key),
        (true, true) => Chord::CommandShift(key),
        (false, true) if is_letter && !is_digit => Chord::Upper(key),
        (false, _) if is_letter => Chord::Lower(key),
        (false, true) => Chord::Shifted(key),
        (false, false) => Chord::Named(key),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::panels::Panel;

    #[test]
    fn every_key_of_the_table_comes_back_from_its_name() {
        for chord in Action::ALL.iter().flat_map(|action| action.info().keys) {
            for name in chord.names() {
                let read = chord_named(&name).unwrap_or_else(|| panic!("{name} is no key"));
                assert!(chord.clashes_with(read), "{name} is {chord:?}, not {read:?}");
            }
        }
    }

    #[test]
    fn a_chosen_key_is_taken_from_who_had_it_and_given_back() {
        let mut keymap = Keymap::default();
        let key = Chord::Lower(Key::X);
        assert_eq!(keymap.clash(Action::Rename, key), Some(Action::StepXUp));
        keymap.set(Action::Rename, key);
        assert_eq!(keymap.keys(Action::Rename), [key]);
        assert!(keymap.keys(Action::StepXUp).is_empty());
        assert_eq!(keymap.clash(Action::Rename, key), None);
        assert_eq!(Keymap::of_names(&keymap.names()), (keymap.clone(), Vec::new()));
        keymap.reset(Action::StepXUp);
        assert_eq!(keymap.keys(Action::StepXUp), [key]);
        assert!(keymap.keys(Action::Rename).is_empty(), "no key is pressed for two actions");
        keymap.reset(Action::Rename);
        assert_eq!(keymap, Keymap::default());
    }

    fn read(names: &[(&str, &str)]) -> (Keymap, Vec<String>) {
        let keys = |keys: &str| keys.split_whitespace().map(str::to_owned).collect();
        let names = names.iter().map(|(action, names)| ((*action).to_owned(), keys(names)));
        Keymap::of_names(&names.collect())
    }

    #[test]
    fn names_that_mean_nothing_are_said_and_change_nothing() {
        let (keymap, said) =
            read(&[("Rename", "Hyper+Q"), ("Undo", "j Hyper+Z"), ("Nothing", "x")]);
        assert_eq!(keymap.keys(Action::Rename), Action::Rename.info().keys);
        assert_eq!(keymap.keys(Action::Undo), [Chord::Lower(Key::J)]);
        let expected = [
            "This version has no action \"Nothing\".",
            "\"Hyper+Q\" cannot be a key of \"Rename\".",
            "\"Hyper+Z\" cannot be a key of \"Undo\".",
        ];
        assert_eq!(said, expected);
    }

    #[test]
    fn the_names_that_actions_had_in_older_versions_are_known() {
        let older = [
            ("CheatSheet", Panel::CheatSheet),
            ("ToggleProperties", Panel::Properties),
            ("ToggleOutline", Panel::Outline),
            ("ToggleLaboratory", Panel::Laboratory),
            ("TogglePlan", Panel::Plan),
            ("ToggleStatistics", Panel::Statistics),
            ("ToggleViewPanel", Panel::View),
        ];
        for (name, panel) in older {
            let (keymap, said) = read(&[(name, "j")]);
            assert_eq!(keymap.keys(Action::Panel(panel)), [Chord::Lower(Key::J)], "{name}");
            assert!(said.is_empty(), "{said:?}");
        }
    }

    #[test]
    fn esc_cancels_even_if_it_quit_in_an_older_version() {
        for (keys, quits) in [("Esc w", Chord::Lower(Key::W)), ("Esc", Chord::Command(Key::Q))] {
            let (keymap, said) = read(&[("Quit", keys)]);
            assert_eq!(keymap.keys(Action::Quit), [quits]);
            assert_eq!(keymap.keys(Action::Escape), [Chord::Named(Key::Escape)]);
            assert!(!said.iter().any(|said| said.contains("Esc")), "{said:?}");
        }
    }

    #[test]
    fn a_key_that_a_newer_version_uses_stays_the_users() {
        let (keymap, said) = read(&[("Duplicate", "w")]);
        assert_eq!(keymap.keys(Action::Duplicate), [Chord::Lower(Key::W)]);
        assert!(keymap.keys(Action::WhyUnseen).is_empty(), "no key is pressed for two actions");
        assert_eq!(
            said,
            ["w is your key for \"Duplicate\"; \"Why can't I see it?\" no longer has it."]
        );
        assert_eq!(Keymap::of_names(&keymap.names()), (keymap, Vec::new()), "it is said once");
        // If the user has given two actions the same key, the first one in the table keeps it.
        let (keymap, said) = read(&[("Redo", "j"), ("Undo", "j x")]);
        assert!(keymap.keys(Action::Redo).is_empty() && keymap.keys(Action::StepXUp).is_empty());
        assert_eq!((keymap.keys(Action::Undo).len(), said.len()), (2, 2));
    }
}

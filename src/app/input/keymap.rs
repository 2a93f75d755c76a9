//! The keys of actions: those of the table, unless the user has chosen others.

use std::collections::BTreeMap;

use egui::Key;

use crate::app::actions::{Action, Chord};

/// The keys that the user has chosen, by the action's place in the table.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Keymap {
    chosen: BTreeMap<usize, Vec<Chord>>,
}

fn place(action: Action) -> usize {
    Action::ALL.iter().position(|other| *other == action).unwrap_or(usize::MAX)
}

impl Keymap {
    /// The keys of an action.
    pub(crate) fn keys(&self, action: Action) -> &[Chord] {
        self.chosen.get(&place(action)).map_or(action.info().keys, Vec::as_slice)
    }

    /// Whether the user has chosen its keys.
    pub(crate) fn is_chosen(&self, action: Action) -> bool {
        self.chosen.contains_key(&place(action))
    }

    /// Another action that the chord would press.
    pub(crate) fn clash(&self, action: Action, chord: Chord) -> Option<Action> {
        let others = Action::ALL.iter().copied().filter(|other| *other != action);
        others.into_iter().find(|other| self.keys(*other).iter().any(|it| it.clashes_with(chord)))
    }

    /// Makes this the key of an action, and takes it from all others.
    pub(crate) fn set(&mut self, action: Action, chord: Chord) {
        while let Some(other) = self.clash(action, chord) {
            let keys = self.keys(other).iter().copied().filter(|it| !it.clashes_with(chord));
            self.choose(other, keys.collect());
        }
        self.choose(action, vec![chord]);
    }

    fn choose(&mut self, action: Action, keys: Vec<Chord>) {
        if keys == action.info().keys {
            self.chosen.remove(&place(action));
        } else {
            self.chosen.insert(place(action), keys);
        }
    }

    /// Gives an action the keys of the table again, and takes them from all others.
    pub(crate) fn reset(&mut self, action: Action) {
        self.chosen.remove(&place(action));
        for chord in action.info().keys {
            while let Some(other) = self.clash(action, *chord) {
                let keys = self.keys(other).iter().copied().filter(|it| !it.clashes_with(*chord));
                self.choose(other, keys.collect());
            }
        }
    }

    /// As text: the names of the keys, by the names of the actions.
    pub(crate) fn names(&self) -> BTreeMap<String, Vec<String>> {
        let named = |(place, keys): (&usize, &Vec<Chord>)| {
            let keys = keys.iter().flat_map(|key| key.names()).collect();
            Some((Action::ALL.get(*place)?.name(), keys))
        };
        self.chosen.iter().filter_map(named).collect()
    }

    /// The keys that these names say; what is not understood is left out.
    pub(crate) fn of_names(names: &BTreeMap<String, Vec<String>>) -> Self {
        let mut keymap = Self::default();
        for (action, keys) in names {
            let Some(action) = Action::named(action) else { continue };
            let keys = keys.iter().filter_map(|key| chord_named(key)).collect();
            keymap.choose(action, keys);
        }
        keymap
    }
}

/// The chord with this name.
fn chord_named(name: &str) -> Option<Chord> {
    if let Some(key) = name.strip_prefix("Ctrl+Shift+").or_else(|| name.strip_prefix("Cmd+Shift+"))
    {
        return Key::from_name(key).map(Chord::CommandShift);
    }
    if let Some(key) = name.strip_prefix("Ctrl+").or_else(|| name.strip_prefix("Cmd+")) {
        return Key::from_name(key).map(Chord::Command);
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

/// The chord that a press of a key is, if it can be one.
pub(crate) fn chord_of(key: Key, modifiers: egui::Modifiers) -> Option<Chord> {
    let is_letter = key.name().len() == 1 && key.name().chars().all(char::is_alphanumeric);
    let is_digit = key.name().chars().all(|letter| letter.is_ascii_digit());
    if modifiers.alt {
        return None;
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
        let kept = Keymap::of_names(&keymap.names());
        assert_eq!(kept, keymap);
        keymap.reset(Action::StepXUp);
        assert_eq!(keymap.keys(Action::StepXUp), [key]);
        assert!(keymap.keys(Action::Rename).is_empty(), "no key is pressed for two actions");
        keymap.reset(Action::Rename);
        assert_eq!(keymap, Keymap::default());
    }

    #[test]
    fn names_that_mean_nothing_are_left_out() {
        let names = [("Rename", "Hyper+Q"), ("Nothing", "x")];
        let names = names.map(|(action, key)| (action.to_owned(), vec![key.to_owned()]));
        let keymap = Keymap::of_names(&names.into());
        assert!(keymap.keys(Action::Rename).is_empty() && keymap.names().len() == 1);
    }
}

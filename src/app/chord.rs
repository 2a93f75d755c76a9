//! Key chords: the ways to trigger an action from the keyboard.
//!
//! Letters and digits are matched by key, with Shift for upper case, so Caps Lock is ignored. Signs
//! are matched by the typed text, since their keys depend on the layout.

use egui::{Key, Modifiers};

/// One way to trigger an action.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Chord {
    /// A letter without Shift, or a digit.
    Lower(Key),
    /// A letter with Shift.
    Upper(Key),
    /// A letter with or without Shift.
    Either(Key),
    /// A key that types no text.
    Named(Key),
    /// A key that types no text, with Shift.
    Shifted(Key),
    /// A key that types no text, with Alt.
    Alt(Key),
    /// A sign, matched by the typed text.
    Text(&'static str),
    /// With Ctrl (Cmd on a Mac).
    Command(Key),
    /// With Ctrl (Cmd on a Mac) and Shift.
    CommandShift(Key),
}

impl Chord {
    /// Returns whether pressing `key` under `modifiers` triggers it.
    pub fn is_pressed_by(self, key: Key, modifiers: Modifiers) -> bool {
        let Modifiers { alt, shift, command, ctrl, mac_cmd } = modifiers;
        let plain = !alt && !command && !ctrl && !mac_cmd;
        match self {
            Self::Lower(wanted) => {
                // On some layouts, digits require Shift.
                wanted == key && plain && (!shift || is_digit(key))
            }
            Self::Upper(wanted) => wanted == key && plain && shift,
            Self::Either(wanted) => wanted == key && plain,
            Self::Named(wanted) => wanted == key && plain && !shift,
            Self::Shifted(wanted) => wanted == key && plain && shift,
            Self::Alt(wanted) => wanted == key && alt && !command && !ctrl && !mac_cmd && !shift,
            Self::Text(_) => false,
            Self::Command(wanted) => {
                // On most layouts, plus requires Shift.
                wanted == key && command && !alt && (!shift || wanted == Key::Plus)
            }
            Self::CommandShift(wanted) => wanted == key && command && !alt && shift,
        }
    }

    /// Returns whether it works without keyboard focus on the viewport.
    pub const fn is_global(self) -> bool {
        match self {
            Self::Command(_) | Self::CommandShift(_) => true,
            Self::Named(key) | Self::Shifted(key) => matches!(key, Key::F1 | Key::F6 | Key::F12),
            Self::Lower(_) | Self::Upper(_) | Self::Either(_) | Self::Alt(_) | Self::Text(_) => {
                false
            }
        }
    }

    /// Returns whether one press could mean both.
    pub fn clashes_with(self, other: Self) -> bool {
        use Chord::{Either, Lower, Upper};
        if let (Either(a), Lower(b) | Upper(b)) | (Lower(a) | Upper(a), Either(b)) = (self, other) {
            a == b
        } else {
            self == other
        }
    }

    /// Returns its name; letters have their typed case.
    pub fn name(self) -> String {
        let letter = |key: Key| key.symbol_or_name().to_owned();
        match self {
            Self::Lower(key) | Self::Either(key) => letter(key).to_lowercase(),
            Self::Upper(key) => letter(key),
            Self::Named(Key::Escape) => "Esc".to_owned(),
            Self::Named(key) => key.name().to_owned(),
            Self::Shifted(key) => format!("Shift+{}", key.name()),
            Self::Alt(key) => format!("Alt+{}", key.name()),
            Self::Text(sign) => sign.to_owned(),
            Self::Command(key) => format!("{}+{}", command_key!(), key.name()),
            Self::CommandShift(key) => format!("{}+Shift+{}", command_key!(), key.name()),
        }
    }

    /// Returns the names of all chords that trigger it.
    pub fn names(self) -> Vec<String> {
        if let Self::Either(key) = self {
            vec![Self::Lower(key).name(), Self::Upper(key).name()]
        } else {
            vec![self.name()]
        }
    }
}

impl std::fmt::Display for Chord {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.name())
    }
}

/// The name of the key for commands, a literal for `concat!`.
#[cfg(target_os = "macos")]
macro_rules! command_key {
    () => {
        "Cmd"
    };
}
#[cfg(not(target_os = "macos"))]
macro_rules! command_key {
    () => {
        "Ctrl"
    };
}
pub(crate) use command_key;

const fn is_digit(key: Key) -> bool {
    use Key::{Num0, Num1, Num2, Num3, Num4, Num5, Num6, Num7, Num8, Num9};
    matches!(key, Num0 | Num1 | Num2 | Num3 | Num4 | Num5 | Num6 | Num7 | Num8 | Num9)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shift_chooses_the_case_and_ctrl_and_alt_choose_nothing() {
        let pressed = |chord: Chord, modifiers| chord.is_pressed_by(Key::X, modifiers);
        let (lower, upper) = (Chord::Lower(Key::X), Chord::Upper(Key::X));
        assert!(pressed(lower, Modifiers::NONE) && !pressed(upper, Modifiers::NONE));
        assert!(pressed(upper, Modifiers::SHIFT) && !pressed(lower, Modifiers::SHIFT));
        for modifiers in [Modifiers::ALT, Modifiers::CTRL, Modifiers::COMMAND] {
            assert!(!pressed(lower, modifiers) && !pressed(upper, modifiers | Modifiers::SHIFT));
            assert_eq!(pressed(Chord::Alt(Key::X), modifiers), modifiers == Modifiers::ALT);
        }
    }

    #[test]
    fn a_plus_that_the_layout_has_with_shift_is_a_plus() {
        let command = Modifiers { ctrl: true, command: true, ..Modifiers::NONE };
        let plus = Chord::Command(Key::Plus);
        assert!(plus.is_pressed_by(Key::Plus, command));
        assert!(plus.is_pressed_by(Key::Plus, command | Modifiers::SHIFT));
        assert!(!Chord::Command(Key::Z).is_pressed_by(Key::Z, command | Modifiers::SHIFT));
    }

    #[test]
    fn a_digit_that_the_layout_has_with_shift_is_a_digit() {
        assert!(Chord::Lower(Key::Num4).is_pressed_by(Key::Num4, Modifiers::SHIFT));
    }
}

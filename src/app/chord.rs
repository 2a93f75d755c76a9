//! Key chords: how an action is pressed on the keyboard.
//!
//! Letters and digits go by the key, with Shift for the upper case, so that Caps Lock has no say.
//! Signs go by the text typed, since every layout has them elsewhere.

use egui::{Key, Modifiers};

/// One way of pressing an action.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Chord {
    /// A letter without Shift, or a digit.
    Lower(Key),
    /// A letter with Shift.
    Upper(Key),
    /// A letter with or without Shift.
    Either(Key),
    /// A key that types nothing.
    Named(Key),
    /// A key that types nothing, with Shift.
    Shifted(Key),
    /// A sign, by the text typed.
    Text(&'static str),
    /// With Ctrl (Cmd on a Mac).
    Command(Key),
    /// With Ctrl (Cmd on a Mac) and Shift.
    CommandShift(Key),
}

impl Chord {
    /// Whether pressing `key` under `modifiers` presses this.
    #[must_use]
    pub fn is_pressed_by(self, key: Key, modifiers: Modifiers) -> bool {
        let Modifiers { alt, shift, command, ctrl, mac_cmd } = modifiers;
        let plain = !alt && !command && !ctrl && !mac_cmd;
        match self {
            Self::Lower(wanted) => {
                // Some layouts have digits only with Shift.
                wanted == key && plain && (!shift || is_digit(key))
            }
            Self::Upper(wanted) => wanted == key && plain && shift,
            Self::Either(wanted) => wanted == key && plain,
            Self::Named(wanted) => wanted == key && plain && !shift,
            Self::Shifted(wanted) => wanted == key && plain && shift,
            Self::Text(_) => false,
            Self::Command(wanted) => {
                // Most layouts have the plus only with Shift.
                wanted == key && command && !alt && (!shift || wanted == Key::Plus)
            }
            Self::CommandShift(wanted) => wanted == key && command && !alt && shift,
        }
    }

    /// Whether it acts although the viewport has not got the keyboard.
    #[must_use]
    pub const fn is_global(self) -> bool {
        match self {
            Self::Command(_) | Self::CommandShift(_) => true,
            Self::Named(key) | Self::Shifted(key) => matches!(key, Key::F1 | Key::F6 | Key::F12),
            Self::Lower(_) | Self::Upper(_) | Self::Either(_) | Self::Text(_) => false,
        }
    }

    /// Whether one press could mean both.
    #[must_use]
    pub fn clashes_with(self, other: Self) -> bool {
        use Chord::{Either, Lower, Upper};
        if let (Either(a), Lower(b) | Upper(b)) | (Lower(a) | Upper(a), Either(b)) = (self, other) {
            a == b
        } else {
            self == other
        }
    }

    /// As it is written: a letter in its own case.
    #[must_use]
    pub fn name(self) -> String {
        let letter = |key: Key| key.symbol_or_name().to_owned();
        match self {
            Self::Lower(key) | Self::Either(key) => letter(key).to_lowercase(),
            Self::Upper(key) => letter(key),
            Self::Named(Key::Escape) => "Esc".to_owned(),
            Self::Named(key) => key.name().to_owned(),
            Self::Shifted(key) => format!("Shift+{}", key.name()),
            Self::Text(sign) => sign.to_owned(),
            Self::Command(key) => format!("{}+{}", command_key(), key.name()),
            Self::CommandShift(key) => format!("{}+Shift+{}", command_key(), key.name()),
        }
    }

    /// Everything that can be pressed for it.
    #[must_use]
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

const fn command_key() -> &'static str {
    if cfg!(target_os = "macos") { "Cmd" } else { "Ctrl" }
}

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

//! Amounts typed on the keyboard: an axis, and a number or an expression.

use marraztu_core::base::math::Axis;

/// The typed input: an axis, and a number.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Typed {
    axis: Option<usize>,
    pub(super) text: String,
}

impl Typed {
    /// Adds typed characters. Returns whether Enter ended the input.
    pub(super) fn take(&mut self, text: &str) -> bool {
        for sign in text.chars() {
            match sign {
                '\n' => return true,
                '\u{8}' if self.text.pop().is_none() => self.axis = None,
                'x' | 'X' => self.axis = Some(0),
                'y' | 'Y' => self.axis = Some(1),
                'z' | 'Z' => self.axis = Some(2),
                ',' => self.text.push('.'),
                '0'..='9' | '.' | '+' | '-' | '*' | '/' | '(' | ')' => self.text.push(sign),
                _ => {}
            }
        }
        false
    }

    pub(super) fn axis(&self) -> Option<Axis> {
        self.axis.map(|axis| Axis::ALL[axis])
    }
}

//! Keyboard and buttons, which both return actions.

pub(crate) mod buttons;
pub(crate) mod keyboard;
pub(crate) mod keymap;

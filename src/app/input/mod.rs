//! Keys and buttons: both give an action.

pub(crate) mod buttons;
pub(crate) mod keyboard;

//! The window without a window: keys, mouse and dialogs, event by event.
//!
//! What each file catches is said at its top.

mod dialogs;
mod editor;
mod keys_and_clicks;
mod mouse;

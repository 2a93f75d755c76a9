//! The window: the only floor that knows of egui.

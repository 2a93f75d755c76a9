//! Dialogs over the window: files, materials, unsaved work.

pub(crate) mod answer;
pub(crate) mod browser;
pub(crate) mod dialogs;
pub(crate) mod folders;
pub(crate) mod loading;
pub(crate) mod material_dialog;
pub(crate) mod picture_dialog;
mod questions;
pub(crate) mod wanted;

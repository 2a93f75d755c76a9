//! Scenes, to and from the disk.

use std::path::{Path, PathBuf};

use egui::Context;

use super::dialogs::{After, Wanted};
use super::editor::App;

/// A scene that was read.
#[derive(Debug)]
pub(super) struct Opening {
    path: PathBuf,
}

/// Whether a path names a scene.
pub(super) fn is_scene(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("marraztu"))
}

impl App {
    pub(super) fn save(&mut self, ctx: &Context, after: Option<After>) {
        match self.state.path.clone() {
            Some(path) => self.save_to(ctx, path, after),
            None => self.save_as(ctx, after),
        }
    }

    pub(super) fn save_as(&mut self, ctx: &Context, after: Option<After>) {
        self.dialogs.ask_file(ctx, Wanted::SceneTo(after), "scene.marraztu");
    }

    pub(super) fn save_to(&mut self, ctx: &Context, path: PathBuf, after: Option<After>) {
        self.state.history.mark_saved();
        self.state.path = Some(path);
        if let Some(after) = after {
            self.after(ctx, after);
        }
    }

    pub(super) fn open_scene(&mut self, _ctx: &Context, path: PathBuf) {
        let _ = Opening { path };
    }

    pub(super) fn take_scene(&mut self, _ctx: &Context, opening: Opening) {
        let _ = opening.path;
    }

    pub(super) fn found_missing(&mut self, _ctx: &Context, _old: PathBuf, _path: PathBuf) {}
}

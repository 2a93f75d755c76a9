//! Opens and saves scenes.
//!
//! A scene opens with placeholders for missing files, which can be found later.

use std::path::{Path, PathBuf};

use egui::Context;

use super::App;
use crate::app::documents::dialogs::Dialog;
use crate::app::documents::loading::{Fetched, Opening};
use crate::app::documents::material_dialog::{details, short};
use crate::app::documents::wanted::{After, ChangedFile, Wanted};
use crate::app::state::{Notice, NoticeKind, State};
use crate::app::widgets::text::file_name;
use marraztu_core::edit::{Viewpoint, selection};
use marraztu_io::{
    self as io, Finding, FindingKind, LoadError, Opened, SCENE_ENDING, SceneFileError,
};

impl App {
    /// Saves the scene to its file, or asks for a file; then continues with `after`.
    pub(crate) fn save(&mut self, ctx: &Context, after: Option<After>) {
        match self.state.path.clone() {
            Some(path) => self.save_to(ctx, path, after),
            None => self.save_as(ctx, after),
        }
    }

    /// Asks for a file, and saves the scene there.
    pub(crate) fn save_as(&mut self, ctx: &Context, after: Option<After>) {
        let name = match &self.state.path {
            Some(path) => file_name(path),
            None => format!("{}.{SCENE_ENDING}", self.state.proposed_name()),
        };
        self.ask_file(ctx, Wanted::SceneTo(after), &name);
    }

    /// Saves the scene to `path`. Asks first if `path` is the scene's file and another program has
    /// changed it.
    pub(crate) fn save_to(&mut self, ctx: &Context, path: PathBuf, after: Option<After>) {
        let is_own = self.state.path.as_deref().is_some_and(|own| is_same(own, &path));
        let has_changed = match self.state.content {
            Some(content) => content.differs_from(&path),
            None => path.exists(),
        };
        if is_own && has_changed {
            return self.dialogs.show(Dialog::Changed(path, after));
        }
        self.write_scene(ctx, path, after);
    }

    /// Handles the user's decision about a file that has changed.
    pub(crate) fn take_changed(
        &mut self,
        ctx: &Context,
        choice: ChangedFile,
        path: PathBuf,
        after: Option<After>,
    ) {
        match choice {
            ChangedFile::SaveElsewhere => self.save_as(ctx, after),
            ChangedFile::Overwrite => self.write_scene(ctx, path, after),
            ChangedFile::Reload => self.open_scene(ctx, path),
        }
    }

    fn write_scene(&mut self, ctx: &Context, path: PathBuf, after: Option<After>) {
        let State { scene, view, settings, .. } = &self.state;
        let window = self.state.window();
        let content = match io::save_with_window(&path, scene, view, settings, &window) {
            Ok(content) => content,
            Err(error) => return self.dialogs.tell_fault(format!("{error}.")),
        };
        self.state.tell_saved(&path);
        self.note_recent(&path);
        if self.waiting_scene.is_some() {
            // A lesson's scene is dropped with its later changes, so it has no file of its own.
            let text = format!("Saved a copy of this lesson's scene: {}", path.display());
            self.state.tell(Some(text));
        } else {
            self.state.history.mark_saved();
            self.state.viewpoints.saved = Viewpoint::of(&self.state.scene, &self.state.view);
            self.state.content = Some(content);
            self.state.path = Some(path);
        }
        if let Some(after) = after {
            self.after(ctx, after);
        }
    }

    /// Opens a scene in place of this one. The caller has asked about unsaved changes.
    pub(crate) fn open_scene(&mut self, ctx: &Context, path: PathBuf) {
        self.read_scene(ctx, format!("Opening {}", file_name(&path)), path);
    }

    /// Reads a scene, to show it in place of this one.
    pub(crate) fn read_scene(&mut self, ctx: &Context, label: String, path: PathBuf) {
        // A host that has to provide the scene's files first is told.
        if cfg!(target_family = "wasm") {
            self.opening.push(path.clone());
        }
        let changes = self.changes;
        self.begin_loading(ctx, label, false, move |progress| {
            let result = io::open(&path, progress);
            Fetched::Scene(Box::new(Opening { path, changes, result }))
        });
    }

    pub(crate) fn take_scene(&mut self, ctx: &Context, opening: Opening) {
        let Opening { path, changes, result } = opening;
        if self.is_settled(&path) {
            return;
        }
        match result {
            // The user has gone on working while the scene was read, and has not been asked.
            Ok(_) if changes != self.changes && !self.is_all_saved() => {
                self.unless_unsaved(ctx, After::Open(Some(path)));
            }
            Ok(opened) => self.show_scene(ctx, &path, opened),
            Err(SceneFileError::Model(LoadError::Cancelled)) => {
                self.state.tell(Some("Opening was cancelled".to_owned()));
            }
            Err(error) => self.dialogs.tell_fault(format!("{error}.")),
        }
    }

    fn show_scene(&mut self, ctx: &Context, path: &Path, opened: Opened) {
        let Opened { scene, view, window, settings, findings, content } = opened;
        let mut state = State { settings, ..State::new(scene, view) };
        selection::settle(&state.scene, &mut state.view);
        state.tell(Some(format!("Opened {}", file_name(path))));
        // Missing files have a separate notice.
        let others: Vec<Finding> =
            findings.into_iter().filter(|finding| !is_missing_file(finding.kind)).collect();
        if !others.is_empty() {
            let name = file_name(path);
            let text = match others.iter().find(|finding| finding.kind.is_loss()) {
                Some(lost) => format!("{name}: {}", short(lost)),
                None => format!("Opened {name}"),
            };
            let details = details(&others);
            state.notices.push(Notice::new(NoticeKind::Opened, text).with(details));
        }
        // An example has no path, so saving it asks for a name.
        if !io::is_example(path) {
            (state.path, state.content) = (Some(path.to_owned()), Some(content));
        }
        self.replace(state);
        self.state.set_window(&window);
        if !self.settle_recovered(path) {
            self.note_recent(path);
        }
        let objects: Vec<_> = self.state.scene.objects.ids().collect();
        self.look_for_unseen(ctx, objects);
    }
}

/// Returns whether two paths lead to the same file.
fn is_same(a: &Path, b: &Path) -> bool {
    a == b || matches!((a.canonicalize(), b.canonicalize()), (Ok(a), Ok(b)) if a == b)
}

const fn is_missing_file(kind: FindingKind) -> bool {
    matches!(kind, FindingKind::ModelMissing | FindingKind::TextureMissing)
}

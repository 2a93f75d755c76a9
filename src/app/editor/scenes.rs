//! Opens and saves scenes.
//!
//! If models of a scene are missing, it is opened once the user has located them; until then the
//! current scene stays.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use egui::Context;

use super::App;
use crate::app::documents::dialogs::{After, Wanted};
use crate::app::documents::loading::{Fetched, Opening, Waiting, is_scene};
use crate::app::documents::material_dialog::{details, short};
use crate::app::state::{Notice, State};
use crate::app::widgets::text::file_name;
use crate::edit::selection;
use crate::io::{self, LoadError, Opened, SCENE_ENDING, SceneFileError};

impl App {
    /// Saves the scene to its file, or asks for a file; then does `after`.
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

    /// Saves the scene to `path`.
    pub(crate) fn save_to(&mut self, ctx: &Context, path: PathBuf, after: Option<After>) {
        let path = if is_scene(&path) { path } else { with_ending(path) };
        let State { scene, view, settings, .. } = &self.state;
        let window = self.state.window();
        if let Err(error) = io::save_with_window(&path, scene, view, settings, &window) {
            self.dialogs.tell_fault(format!("{error}."));
            return;
        }
        self.state.history.mark_saved();
        self.state.tell(Some(format!("Saved {}", path.display())));
        self.note_recent(&path);
        self.state.path = Some(path);
        if let Some(after) = after {
            self.after(ctx, after);
        }
    }

    /// Opens a scene instead of this one. Unsaved changes have been asked about.
    pub(crate) fn open_scene(&mut self, ctx: &Context, path: PathBuf) {
        self.read_scene(ctx, path, BTreeMap::new());
    }

    fn read_scene(&mut self, ctx: &Context, path: PathBuf, relocated: BTreeMap<PathBuf, PathBuf>) {
        let label = format!("Opening {}", file_name(&path));
        self.begin_loading(ctx, label, false, move |progress| {
            let result = io::open_with(&path, &relocated, progress);
            Fetched::Scene(Box::new(Opening { path, relocated, result }))
        });
    }

    /// Takes an opened scene, or asks for its missing models.
    pub(crate) fn take_scene(&mut self, ctx: &Context, opening: Opening) {
        let Opening { path, relocated, result } = opening;
        match result {
            Ok(opened) => self.show_scene(ctx, &path, opened),
            Err(SceneFileError::Model(LoadError::Cancelled)) => {
                self.state.tell(Some("Opening was cancelled".to_owned()));
            }
            Err(SceneFileError::Missing { missing, .. }) if !missing.is_empty() => {
                self.look_for(ctx, Waiting { path, relocated }, &missing);
            }
            Err(error) => self.dialogs.tell_fault(format!("{error}.")),
        }
    }

    /// Looks for missing models beside those already found; asks for the first that is not there.
    fn look_for(&mut self, ctx: &Context, mut waiting: Waiting, missing: &[PathBuf]) {
        let known = waiting.relocated.len();
        for old in missing {
            let beside = waiting.relocated.values().find_map(|found| {
                let path = found.parent()?.join(old.file_name()?);
                path.is_file().then_some(path)
            });
            if let Some(path) = beside.filter(|_| !waiting.relocated.contains_key(old)) {
                waiting.relocated.insert(old.clone(), path);
            }
        }
        if waiting.relocated.len() > known {
            self.read_scene(ctx, waiting.path, waiting.relocated);
            return;
        }
        let first = missing[0].clone();
        self.state.tell(Some(format!("{} is missing", first.display())));
        self.waiting = Some(waiting);
        let name = file_name(&first);
        self.ask_file(ctx, Wanted::Missing(first), &name);
    }

    /// Opens the waiting scene with a missing model found at `path`.
    pub(crate) fn found_missing(&mut self, ctx: &Context, old: PathBuf, path: PathBuf) {
        if let Some(Waiting { path: scene, mut relocated }) = self.waiting.take() {
            relocated.insert(old, path);
            self.read_scene(ctx, scene, relocated);
        }
    }

    /// Gives up opening the waiting scene: the current scene stays.
    pub(crate) fn give_up_missing(&mut self, old: &Path) {
        self.waiting = None;
        self.dialogs.tell_fault(format!(
            "The scene was not opened: its model {} is missing.",
            old.display()
        ));
    }

    fn show_scene(&mut self, ctx: &Context, path: &Path, opened: Opened) {
        let Opened { scene, view, window, settings, findings } = opened;
        let mut state = State { settings, ..State::new(scene, view) };
        selection::settle(&state.scene, &mut state.view);
        state.tell(Some(format!("Opened {}", file_name(path))));
        if !findings.is_empty() {
            let name = file_name(path);
            let text = match findings.iter().find(|finding| finding.kind.is_loss()) {
                Some(lost) => format!("{name}: {}", short(lost)),
                None => format!("Opened {name}"),
            };
            let details = details(&findings);
            state.notices.push(Notice { text, details, offer: None });
        }
        // An example is saved under a name of its own.
        state.path = (!io::is_example(path)).then(|| path.to_owned());
        self.replace(state);
        self.state.set_window(&window);
        if !self.settle_recovered(path) {
            self.note_recent(path);
        }
        let objects = self.state.scene.objects.ids().collect();
        self.look_for_unseen(ctx, objects);
    }
}

/// The path with the file ending of scenes appended.
fn with_ending(path: PathBuf) -> PathBuf {
    let mut text = path.into_os_string();
    text.push(".");
    text.push(SCENE_ENDING);
    PathBuf::from(text)
}

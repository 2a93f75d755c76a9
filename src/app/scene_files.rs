//! Scenes, to and from the disk.
//!
//! A scene whose models are not where it says is opened all the same once the user has shown where
//! they are; until then the present scene stays.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use egui::Context;

use super::dialogs::{After, Wanted};
use super::editor::App;
use super::files::Fetched;
use super::material_dialog::file_name;
use super::state::{Notice, Shown, State};
use crate::edit::selection;
use crate::io::{self, LoadError, Opened, SCENE_ENDING, SceneFileError};
use crate::scene::View;

/// A scene that was read, or could not be.
#[derive(Debug)]
pub(super) struct Opening {
    path: PathBuf,
    relocated: BTreeMap<PathBuf, PathBuf>,
    result: Result<Opened, SceneFileError>,
}

/// A scene that waits for the user to show where its models are.
#[derive(Debug)]
pub(super) struct Waiting {
    path: PathBuf,
    relocated: BTreeMap<PathBuf, PathBuf>,
}

/// Whether a path names a scene.
pub(super) fn is_scene(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case(SCENE_ENDING))
}

impl App {
    /// Saves the scene, to its file or to one that is asked for; then does what was to be done.
    pub(super) fn save(&mut self, ctx: &Context, after: Option<After>) {
        match self.state.path.clone() {
            Some(path) => self.save_to(ctx, path, after),
            None => self.save_as(ctx, after),
        }
    }

    /// Asks for a file, and saves the scene there.
    pub(super) fn save_as(&mut self, ctx: &Context, after: Option<After>) {
        let name = match &self.state.path {
            Some(path) => file_name(path),
            None => format!("scene.{SCENE_ENDING}"),
        };
        self.dialogs.ask_file(ctx, Wanted::SceneTo(after), &name);
    }

    /// Saves the scene to `path`.
    pub(super) fn save_to(&mut self, ctx: &Context, path: PathBuf, after: Option<After>) {
        let path = if is_scene(&path) { path } else { with_ending(path) };
        let State { scene, view, settings, shown, .. } = &self.state;
        let view = View { panels: shown.panels(), ..view.clone() };
        if let Err(error) = io::save(&path, scene, &view, settings) {
            self.dialogs.tell_fault(format!("{error}."));
            return;
        }
        self.state.history.mark_saved();
        self.state.tell(Some(format!("Saved {}", path.display())));
        self.state.path = Some(path);
        if let Some(after) = after {
            self.after(ctx, after);
        }
    }

    /// Opens a scene in place of this one. What is unsaved has been asked about.
    pub(super) fn open_scene(&mut self, ctx: &Context, path: PathBuf) {
        self.read_scene(ctx, path, BTreeMap::new());
    }

    fn read_scene(&mut self, ctx: &Context, path: PathBuf, relocated: BTreeMap<PathBuf, PathBuf>) {
        let label = format!("Opening {}", file_name(&path));
        self.begin_loading(ctx, label, false, move |progress| {
            let result = io::open_with(&path, &relocated, progress);
            Fetched::Scene(Box::new(Opening { path, relocated, result }))
        });
    }

    /// What became of opening a scene.
    pub(super) fn take_scene(&mut self, ctx: &Context, opening: Opening) {
        let Opening { path, relocated, result } = opening;
        match result {
            Ok(opened) => self.show_scene(ctx, path, opened),
            Err(SceneFileError::Model(LoadError::Cancelled)) => {
                self.state.tell(Some("Opening was cancelled".to_owned()));
            }
            Err(SceneFileError::Missing { missing, .. }) if !missing.is_empty() => {
                self.look_for(ctx, Waiting { path, relocated }, &missing);
            }
            Err(error) => self.dialogs.tell_fault(format!("{error}.")),
        }
    }

    /// Takes missing models from where others were found; asks for the first that is not there.
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
        self.dialogs.ask_file(ctx, Wanted::Missing(first), &name);
    }

    /// The user has shown where a missing model is.
    pub(super) fn found_missing(&mut self, ctx: &Context, old: PathBuf, path: PathBuf) {
        if let Some(Waiting { path: scene, mut relocated }) = self.waiting.take() {
            relocated.insert(old, path);
            self.read_scene(ctx, scene, relocated);
        }
    }

    /// The user does not know where a missing model is: the present scene stays.
    pub(super) fn give_up_missing(&mut self, old: &Path) {
        self.waiting = None;
        self.dialogs.tell_fault(format!(
            "The scene was not opened: {} is missing, which it is made of.",
            old.display()
        ));
    }

    fn show_scene(&mut self, ctx: &Context, path: PathBuf, opened: Opened) {
        let Opened { scene, view, settings, findings } = opened;
        let shown = Shown::of(view.panels, self.state.shown.theme);
        let mut state = State { settings, ..State::new(scene, view) };
        selection::settle(&state.scene, &mut state.view);
        state.tell(Some(format!("Opened {}", path.display())));
        if !findings.is_empty() {
            let text = format!("{}: {} things to know", file_name(&path), findings.len());
            let details = findings.iter().map(ToString::to_string).collect();
            state.notices.push(Notice { text, details, offer: None });
        }
        // An example is saved under a name of its own.
        state.path = (!io::is_example(&path)).then_some(path);
        self.replace(state);
        self.state.shown = shown;
        let objects = self.state.scene.objects.ids().collect();
        self.look_for_unseen(ctx, objects);
    }
}

/// The path with a scene's ending behind whatever it has.
fn with_ending(path: PathBuf) -> PathBuf {
    let mut text = path.into_os_string();
    text.push(".");
    text.push(SCENE_ENDING);
    PathBuf::from(text)
}

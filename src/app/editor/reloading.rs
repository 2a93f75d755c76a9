//! Reads models again, on request or when their files have changed.
//!
//! A thread checks the files twice a second and wakes the window if one has changed. A file counts
//! as changed after it has stayed the same from one check to the next, since other programs write
//! files in pieces. It is read again at once if the user has enabled that; otherwise a notice
//! offers it.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};
use std::time::{Duration, SystemTime};

use egui::Context;

use super::App;
use super::missing::Replacements;
use crate::app::documents::loading::{Fetched, Reread};
use crate::app::state::{Notice, NoticeKind, Offer};
use crate::app::widgets::text::{file_name, one_or_count};
use marraztu_core::base::Shared;
use marraztu_core::edit::Gesture;
use marraztu_core::scene::{Command, LoadOptions, Model, Scene};
use marraztu_io::{self as io, LoadError, is_example};

/// The time between two checks of the files.
const PAUSE: Duration = Duration::from_millis(500);

impl App {
    /// Reads the models of the scene again: all of them, or only those of these files.
    pub(crate) fn reload_models(&mut self, ctx: &Context, only: Option<&BTreeSet<PathBuf>>) {
        let mut wanted: Vec<(PathBuf, LoadOptions)> = Vec::new();
        // A file is read once for all objects with the same options.
        for (path, model) in models(&self.state.scene) {
            let file = (path.clone(), model.options);
            let is_meant = only.is_none_or(|only| files(path, model).any(|it| only.contains(it)));
            if is_meant && let Some(watch) = &self.watch {
                watch.note_read(files(path, model));
            }
            if is_meant && !wanted.contains(&file) {
                wanted.push(file);
            }
        }
        if wanted.is_empty() {
            if only.is_none() {
                self.refuse("no object was loaded from a file".to_owned());
            }
            return;
        }
        let what = one_or_count(&wanted, "models", |(path, _)| file_name(path));
        let label = format!("Reloading {what}");
        self.begin_loading(ctx, label, false, move |progress| {
            let read = |(path, options): (PathBuf, LoadOptions)| Reread {
                result: io::load(&path, &options, progress),
                path,
                options,
            };
            Fetched::Again(wanted.into_iter().map(read).collect())
        });
    }

    /// Replaces models by those read again, in one step of undo.
    pub(crate) fn take_again(&mut self, ctx: &Context, all: Vec<Reread>) {
        let (mut replacements, mut names) = (Replacements::default(), Vec::new());
        let mut read: Vec<(PathBuf, LoadOptions, Option<Shared<Model>>)> = Vec::new();
        for Reread { path, options, result } in all {
            let model = match result {
                Ok(loaded) => {
                    names.push(loaded.model.name.clone());
                    Some(Shared::new(loaded.model))
                }
                Err(LoadError::Cancelled) => None,
                Err(error) => {
                    let text = format!("{error}. The model is unchanged.");
                    self.state.notices.push(Notice::new(NoticeKind::Opened, text));
                    None
                }
            };
            if model.is_some() {
                let reload = Some(Offer::Reload(path.clone()));
                self.state.notices.retain(|notice| notice.offer != reload);
            }
            read.push((path, options, model));
        }
        // The models to replace are those of now: the user, or another reload, may have replaced
        // the former ones while the file was read.
        let mut outdated = BTreeSet::new();
        for (path, now) in models(&self.state.scene) {
            let mut of_file = read.iter().filter(|(file, ..)| file == path);
            match of_file.clone().find(|(_, options, _)| *options == now.options) {
                Some((.., model)) => {
                    replacements.models.extend(model.clone().map(|model| (now.clone(), model)));
                }
                None if of_file.any(|(.., model)| model.is_some()) => {
                    outdated.insert(path.clone());
                }
                None => {}
            }
        }
        let commands: Vec<Command> = replacements.of_objects(&self.state.scene).collect();
        if !commands.is_empty() {
            let label = format!("Reload {}", one_or_count(&names, "models", String::clone));
            self.change(Command::Batch(commands), Gesture::Whole, &label);
            self.state.tell(Some(label));
        }
        if !outdated.is_empty() {
            self.reload_models(ctx, Some(&outdated));
        }
    }

    /// Watches the files of models. Changed files are read again if the user wants that; otherwise
    /// a notice offers it.
    pub(crate) fn watch_files(&mut self, ctx: &Context) {
        if self.watch.is_none() && models(&self.state.scene).next().is_none() {
            return;
        }
        let watch = self.watch.get_or_insert_with(|| Watch::begin(ctx));
        watch.look_at(&self.state.scene);
        let changed = watch.take_changed();
        if !changed.is_empty() {
            self.tell_changed(&changed);
        }
        if self.state.watches {
            self.accept(ctx, NoticeKind::Changed);
        }
    }

    /// Adds a notice for each model that has changed on disk, or that uses a changed file.
    fn tell_changed(&mut self, changed: &BTreeSet<PathBuf>) {
        let mut new = Vec::new();
        for (path, model) in models(&self.state.scene) {
            let Some(file) = files(path, model).find(|file| changed.contains(*file)) else {
                continue;
            };
            let notice = Notice::new(
                NoticeKind::Changed,
                format!("{} has changed on disk", file_name(file)),
            )
            .offering(Some(Offer::Reload(path.clone())));
            let is_told = |other: &Notice| other.offer == notice.offer;
            if !self.state.notices.iter().chain(&new).any(is_told) {
                new.push(notice);
            }
        }
        self.state.notices.extend(new);
    }
}

/// Lists the models of objects that were read from files, with these files.
fn models(scene: &Scene) -> impl Iterator<Item = (&PathBuf, &Shared<Model>)> {
    let models = scene.objects.iter().map(|(_, object)| &object.model);
    models.filter_map(|model| {
        let path = model.source.as_ref().filter(|path| !is_example(path))?;
        Some((path, model))
    })
}

/// Lists the file of a model, and its MTL files and textures.
fn files<'a>(path: &'a PathBuf, model: &'a Model) -> impl Iterator<Item = &'a PathBuf> {
    std::iter::once(path).chain(&model.companions)
}

/// Watched files.
#[derive(Debug)]
pub(crate) struct Watch {
    files: Arc<Mutex<Files>>,
    /// The scene that the files belong to.
    of: Option<Scene>,
}

#[derive(Debug, Default)]
struct Files {
    /// The time and the length of each file: as last read, and at the last check.
    seen: BTreeMap<PathBuf, [Option<Stamp>; 2]>,
    changed: BTreeSet<PathBuf>,
}

type Stamp = (SystemTime, u64);

fn stamp(path: &Path) -> Option<Stamp> {
    let data = std::fs::metadata(path).ok()?;
    Some((data.modified().ok()?, data.len()))
}

impl Watch {
    fn begin(ctx: &Context) -> Self {
        let files = Arc::new(Mutex::new(Files::default()));
        let (theirs, ctx) = (Arc::downgrade(&files), ctx.clone());
        let thread = std::thread::Builder::new().name("files".to_owned());
        // Without a thread, files are read again only on request.
        let _ = thread.spawn(move || look(&theirs, &ctx));
        Self { files, of: None }
    }

    /// Watches the files of this scene.
    fn look_at(&mut self, scene: &Scene) {
        if self.of.as_ref() == Some(scene) {
            return;
        }
        let paths: BTreeSet<&PathBuf> =
            models(scene).flat_map(|(path, model)| files(path, model)).collect();
        let mut files = lock(&self.files);
        // Known files keep their stamps, so a change between two scenes is not missed.
        files.seen.retain(|path, _| paths.contains(path));
        for path in paths {
            files.seen.entry(path.clone()).or_insert_with(|| [stamp(path); 2]);
        }
        drop(files);
        self.of = Some(scene.clone());
    }

    /// Records that files are read now: a change up to now is not reported.
    fn note_read<'a>(&self, paths: impl Iterator<Item = &'a PathBuf>) {
        let mut files = lock(&self.files);
        for path in paths {
            files.changed.remove(path);
            if let Some(seen) = files.seen.get_mut(path) {
                *seen = [stamp(path); 2];
            }
        }
    }

    fn take_changed(&self) -> BTreeSet<PathBuf> {
        std::mem::take(&mut lock(&self.files).changed)
    }
}

fn lock(files: &Mutex<Files>) -> MutexGuard<'_, Files> {
    files.lock().unwrap_or_else(PoisonError::into_inner)
}

fn look(files: &Weak<Mutex<Files>>, ctx: &Context) {
    loop {
        std::thread::sleep(PAUSE);
        let Some(files) = files.upgrade() else { return };
        if lock(&files).look() {
            ctx.request_repaint();
        }
    }
}

impl Files {
    /// Checks all files. Returns whether one has changed and then stayed the same.
    fn look(&mut self) -> bool {
        let before = self.changed.len();
        for (path, [read, last]) in &mut self.seen {
            let now = stamp(path);
            if now.is_some() && now == *last && now != *read {
                *read = now;
                self.changed.insert(path.clone());
            }
            *last = now;
        }
        self.changed.len() > before
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_has_changed_once_it_rests_and_only_once() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("model.obj");
        std::fs::write(&path, "v 0 0 0\n").unwrap();
        let mut files = Files::default();
        files.seen.insert(path.clone(), [stamp(&path); 2]);
        assert!(!files.look());
        std::fs::write(&path, "v 0 0 0\nv 1 0 0\n").unwrap();
        assert!(!files.look(), "it may still be written");
        assert!(files.look());
        assert_eq!(files.changed, BTreeSet::from([path.clone()]));
        assert!(!files.look());
        std::fs::remove_file(&path).unwrap();
        assert!(!files.look() && !files.look(), "a file that is gone is not read");
    }
}

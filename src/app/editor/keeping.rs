//! Keeps unsaved work and preferences in the program's files.
//!
//! The scene goes to the journal as soon as it changes. The journal's thread writes it to the disk,
//! so the window never waits. Work that another program has left behind is offered in a notice,
//! which blocks nothing.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, SystemTime};

use egui::Context;

use super::App;
use crate::app::panels::preferences;
use crate::app::state::{Notice, NoticeKind, State};
use crate::app::widgets::text::file_name;
use marraztu_core::scene::Scene;
use marraztu_io::{
    self as io, Abandoned, Discarded, Fingerprint, Journal, JournalNews, OwnFolders, Preferences,
    Unsaved,
};

/// The seconds without a change after which preferences are written.
const QUIET: f64 = 1.0;

/// The program's files.
#[derive(Debug)]
pub(crate) struct Keeping {
    folders: OwnFolders,
    journal: Option<Journal>,
    /// The unsaved scene that is in the journal.
    kept: Option<Scene>,
    /// Work that other programs have left behind, in the order of [`State::recoverable`].
    offered: Vec<Abandoned>,
    /// The files of work that is not offered any more, because it was recovered or discarded.
    settled: Vec<PathBuf>,
    /// Discarded work, in the order of [`State::discarded`].
    discarded: Vec<Discarded>,
    /// The preferences that were last handed to be written.
    preferences: Preferences,
    /// The preferences that were last read or written.
    written: Arc<Mutex<Preferences>>,
    /// The current preferences if they differ from `preferences`, and the time since then.
    changed: Option<(Preferences, f64)>,
}

impl App {
    /// Starts to keep unsaved work and preferences in these folders, and offers the work that was
    /// left there. `said` is shown in a notice.
    pub fn keep_in(
        &mut self,
        ctx: &Context,
        folders: OwnFolders,
        preferences: Preferences,
        said: Option<String>,
    ) {
        let changed_keys = self.use_preferences(ctx, &preferences);
        self.state.notices.extend(said.map(|text| Notice::new(NoticeKind::Program, text)));
        if !changed_keys.is_empty() {
            let text = "Some of your custom keys could not be restored.".to_owned();
            self.state.notices.push(Notice::new(NoticeKind::Program, text).with(changed_keys));
        }
        // Work of programs that ended without saving is offered, not opened.
        let offered = Abandoned::all(&folders);
        let now = SystemTime::now();
        self.state.recoverable = offered.iter().map(|work| described(work, now)).collect();
        // Without a journal the program works, but a crash loses unsaved work.
        let journal = match Journal::begin(&folders) {
            Ok(journal) => Some(journal),
            Err(why) => {
                let text = format!("Unsaved work cannot be kept for recovery: {why}.");
                self.state.notices.push(Notice::new(NoticeKind::Program, text));
                None
            }
        };
        self.keeping = Some(Keeping {
            folders,
            journal,
            kept: None,
            offered,
            settled: Vec::new(),
            discarded: Vec::new(),
            written: Arc::new(Mutex::new(preferences.clone())),
            preferences,
            changed: None,
        });
        self.list_discarded();
    }

    /// Hands changes to the journal, and writes preferences after they have settled.
    pub(crate) fn keep(&mut self, ctx: &Context) {
        let Self { keeping: Some(keeping), waiting_scene, state, .. } = self else { return };
        // During a lesson, the user's scene is the one to protect.
        let own = waiting_scene.as_deref().unwrap_or(state);
        let State { scene, view, settings, history, path, content, .. } = own;
        // The journal gets the scene only when it has changed, or learns that all is saved.
        if let Some(journal) = &keeping.journal {
            if history.is_saved() {
                if keeping.kept.take().is_some() {
                    journal.all_saved();
                }
            } else if keeping.kept.as_ref() != Some(scene) {
                keeping.kept = Some(scene.clone());
                let (scene, view, file) = (scene.clone(), view.clone(), path.clone());
                let (window, settings, content) = (own.window(), *settings, *content);
                journal.keep(Unsaved { scene, view, settings, window, file, content });
            }
            if let Some(news) = journal.news() {
                state.notices.retain(|notice| !notice.text.starts_with(NOT_KEPT));
                if let JournalNews::Failed(fault) = news {
                    let text = format!("{NOT_KEPT}{fault}. The program keeps trying.");
                    state.notices.push(Notice::new(NoticeKind::Program, text));
                }
            }
        }
        let Some(keeping) = &mut self.keeping else { return };
        let now = preferences::now(ctx, &self.state, keeping.preferences.window);
        let time = ctx.input(|input| input.time);
        if now == keeping.preferences {
            keeping.changed = None;
            return;
        }
        // Preferences are written once, after a drag or a series of changes has ended.
        match &keeping.changed {
            Some((before, since)) if *before == now => {
                let rest = QUIET - (time - since);
                if rest > 0.0 {
                    // Asked for in every frame: a frame takes back the wishes of the one before.
                    ctx.request_repaint_after(Duration::from_secs_f64(rest + 0.05));
                } else {
                    keeping.preferences = now;
                    keeping.changed = None;
                    keeping.write_preferences();
                }
            }
            Some(_) | None => {
                keeping.changed = Some((now, time));
                ctx.request_repaint_after(Duration::from_secs_f64(QUIET + 0.05));
            }
        }
    }

    /// Ends keeping as the program quits: writes the preferences, and removes the journal if the
    /// user has saved or discarded everything.
    pub fn end_keeping(&mut self) {
        let Some(mut keeping) = self.keeping.take() else { return };
        if let Some((changed, _)) = keeping.changed.take() {
            keeping.preferences = changed;
        }
        // Failure cannot be reported, as the window is gone.
        let before = keeping.written.lock().unwrap_or_else(PoisonError::into_inner).clone();
        let _ = keeping.preferences.save(&keeping.folders, &before);
        if (self.leaving || self.is_all_saved())
            && let Some(journal) = keeping.journal
        {
            journal.end();
        }
    }

    /// Waits until the journal is on the disk.
    pub fn wait_for_journal(&self) {
        if let Some(journal) = self.keeping.as_ref().and_then(|keeping| keeping.journal.as_ref()) {
            journal.wait();
        }
    }

    /// Reads the offered work at this index, to show it in place of the scene.
    pub(crate) fn recover(&mut self, ctx: &Context, at: usize) {
        let work = self.keeping.as_ref().and_then(|keeping| keeping.offered.get(at));
        if let Some(path) = work.map(|work| work.path().to_owned()) {
            self.read_scene(ctx, RECOVERING.to_owned(), path);
        }
    }

    /// Reads the discarded work at this index, to show it in place of the scene.
    pub(crate) fn recover_discarded(&mut self, ctx: &Context, at: usize) {
        let work = self.keeping.as_ref().and_then(|keeping| keeping.discarded.get(at));
        if let Some(path) = work.map(|work| work.path().to_owned()) {
            self.read_scene(ctx, RECOVERING.to_owned(), path);
        }
    }

    /// Moves the offered work at this index to the discarded work.
    pub(crate) fn discard_work(&mut self, at: usize) {
        let work = self.keeping.as_ref().and_then(|keeping| keeping.offered.get(at));
        let Some(work) = work else { return };
        if let Err(why) = work.set_aside() {
            return self.refuse(format!("the unsaved work cannot be discarded: {why}"));
        }
        self.take_offered(at).into_iter().for_each(Abandoned::remove);
        self.list_discarded();
        let text = "Discarded: \"Recover discarded work\" can restore it for 30 days";
        self.state.tell(Some(text.to_owned()));
    }

    /// Lists the discarded work that can be restored.
    fn list_discarded(&mut self) {
        let Some(keeping) = &mut self.keeping else { return };
        keeping.discarded = Discarded::all(&keeping.folders);
        let now = SystemTime::now();
        let described = |work: &Discarded| {
            let name = scene_name(work.scene_file.as_deref());
            format!("{name}, from {}", age(work.written, now))
        };
        self.state.discarded = keeping.discarded.iter().map(described).collect();
    }

    fn take_offered(&mut self, at: usize) -> Option<Abandoned> {
        let keeping = self.keeping.as_mut()?;
        if at >= keeping.offered.len() {
            return None;
        }
        self.state.recoverable.remove(at);
        let work = keeping.offered.remove(at);
        keeping.settled.push(work.path().to_owned());
        Some(work)
    }

    /// Returns whether a file belonged to work that was recovered or discarded, perhaps while it
    /// was being read.
    pub(crate) fn is_settled(&self, path: &Path) -> bool {
        self.keeping.as_ref().is_some_and(|keeping| keeping.settled.iter().any(|it| it == path))
    }

    /// Marks the opened scene as unsaved if it is offered or discarded work, and assigns it to the
    /// file that it was once saved to. Returns whether it is such work.
    pub(crate) fn settle_recovered(&mut self, opened: &Path) -> bool {
        let Some(keeping) = &self.keeping else { return false };
        let offered = keeping.offered.iter().position(|work| work.path() == opened);
        // Discarded work stays in its place until it expires.
        let discarded = keeping.discarded.iter().find(|work| work.path() == opened).cloned();
        if let Some(work) = offered.and_then(|at| self.take_offered(at)) {
            self.name_recovered(opened, work.scene_file.clone(), work.content);
            // Without a journal, the next program offers it again.
            if let Some(journal) =
                self.keeping.as_ref().and_then(|keeping| keeping.journal.as_ref())
            {
                journal.replace(work);
            }
            return true;
        }
        let Some(work) = discarded else { return false };
        self.name_recovered(opened, work.scene_file, work.content);
        true
    }

    /// Assigns the opened scene to this file, which had this content, as an unsaved scene.
    fn name_recovered(
        &mut self,
        opened: &Path,
        file: Option<PathBuf>,
        content: Option<Fingerprint>,
    ) {
        let name = scene_name(file.as_deref());
        (self.state.path, self.state.content) = (file, content);
        self.state.history.mark_unsaved();
        // Scenes that are being read must not replace the work without a question.
        self.changes += 1;
        self.state.tell(Some(format!("Recovered unsaved changes to {name}")));
        // The user does not know the name of the journal's file.
        let own_name = file_name(opened);
        for notice in &mut self.state.notices {
            if let Some(rest) = notice.text.strip_prefix(&own_name) {
                notice.text = format!("Recovered work{rest}");
            }
        }
        if let Some(keeping) = &mut self.keeping {
            keeping.kept = None;
        }
    }

    /// Adds a file to the recent ones.
    pub(crate) fn note_recent(&mut self, path: &Path) {
        if io::is_example(path) {
            return;
        }
        let recent = std::mem::take(&mut self.state.recent);
        let mut preferences = Preferences { recent, ..Preferences::default() };
        preferences.note_recent(path);
        self.state.recent = preferences.recent;
    }
}

impl Keeping {
    /// Writes the preferences on a thread, so the window does not wait.
    fn write_preferences(&self) {
        let (preferences, folders) = (self.preferences.clone(), self.folders.clone());
        let written = self.written.clone();
        let write = move || {
            let mut written = written.lock().unwrap_or_else(PoisonError::into_inner);
            // A failure here is repaired by writing the preferences at the end.
            if preferences.save(&folders, &written).is_ok() {
                *written = preferences;
            }
        };
        if cfg!(target_family = "wasm") {
            return write();
        }
        // So is the lack of a thread.
        let _ = std::thread::Builder::new().name("preferences".to_owned()).spawn(write);
    }
}

const RECOVERING: &str = "Recovering unsaved work";

const NOT_KEPT: &str = "Unsaved changes could not be kept for recovery: ";

/// Names a scene: "harbour.marraztu", or "a new scene".
fn scene_name(file: Option<&Path>) -> String {
    file.map_or_else(|| "a new scene".to_owned(), file_name)
}

/// Describes offered work: "The program ended with unsaved changes to harbour.marraztu, from 3
/// minutes ago."
fn described(work: &Abandoned, now: SystemTime) -> String {
    let name = scene_name(work.scene_file.as_deref());
    // The files of a page have no times.
    if work.written == SystemTime::UNIX_EPOCH {
        return format!("The program ended with unsaved changes to {name}.");
    }
    let age = age(work.written, now);
    format!("The program ended with unsaved changes to {name}, from {age}.")
}

/// Formats an age: "3 minutes ago".
fn age(written: SystemTime, now: SystemTime) -> String {
    let minutes = now.duration_since(written).unwrap_or_default().as_secs() / 60;
    match minutes {
        0 => "less than a minute ago".to_owned(),
        1 => "a minute ago".to_owned(),
        2..120 => format!("{minutes} minutes ago"),
        120..2880 => format!("{} hours ago", minutes / 60),
        _ => format!("{} days ago", minutes / 1440),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_is_described_by_its_file_and_its_age() {
        let folder = tempfile::tempdir().unwrap();
        let folders = OwnFolders::within(folder.path());
        let (scene, view) = io::default_scene();
        let file = Some(PathBuf::from("/somewhere/harbour.marraztu"));
        let journal = Journal::begin(&folders).unwrap();
        let settings = marraztu_core::accuracy::Settings::default();
        let window = io::WindowState::DEFAULT;
        journal.keep(Unsaved { scene, view, settings, window, file, content: None });
        journal.wait();
        drop(journal);
        let all = Abandoned::all(&folders);
        let at = |seconds| described(&all[0], all[0].written + Duration::from_secs(seconds));
        let start = "The program ended with unsaved changes to harbour.marraztu, from ";
        assert_eq!(at(5), format!("{start}less than a minute ago."));
        assert_eq!(at(400), format!("{start}6 minutes ago."));
        assert_eq!(at(8000), format!("{start}2 hours ago."));
    }
}

//! Saves unsaved work to disk while the scene is edited.
//!
//! A thread writes the latest state as a scene file that refers to the models' files, and flushes
//! it to disk. It writes at most once per [`PAUSE`], so a crash loses at most the last second of
//! work. The file is replaced atomically: it always holds a complete scene.
//!
//! A state that cannot be written, for example because the disk is full, is tried again after
//! [`RETRY`], unless a later state replaces it.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use super::abandoned::{Abandoned, PREFIX};
use super::origin::head;
use super::slots::{Lock, OwnFolders, Slot, list_lock, made};
use crate::error::reason;
use crate::fingerprint::Fingerprint;
use crate::part::own_process;
use crate::replace::{Worth, replace};
use crate::scene_file::text_with_window;
use crate::window_state::WindowState;
use marraztu_core::accuracy::Settings;
use marraztu_core::scene::{Scene, View};

/// The minimum time between two writes.
const PAUSE: Duration = Duration::from_millis(200);

/// The time after which a failed write is repeated.
const RETRY: Duration = Duration::from_secs(if cfg!(test) { 1 } else { 5 });

/// A state with unsaved changes. Clones share all large data.
#[derive(Clone, Debug)]
pub struct Unsaved {
    /// The scene.
    pub scene: Scene,
    /// Its view.
    pub view: View,
    /// Its settings.
    pub settings: Settings,
    /// The state of the window.
    pub window: WindowState,
    /// The file that the scene was last saved to, if any.
    pub file: Option<PathBuf>,
    /// The content of that file when it was last read or written.
    pub content: Option<Fingerprint>,
}

/// The next task of the thread.
#[derive(Debug, Default)]
enum Next {
    #[default]
    Nothing,
    Write(Box<Unsaved>),
    /// Delete the work, because everything is saved.
    Remove,
}

#[derive(Debug, Default)]
struct Desk {
    next: Next,
    /// Work taken over from other programs. It is deleted when this program has written its own.
    replaced: Vec<Abandoned>,
    busy: bool,
    ended: bool,
    /// The last state if it could not be written, to try again.
    failed: Option<Box<Unsaved>>,
    /// Whether the last write failed, which was reported.
    failing: bool,
    news: Option<JournalNews>,
}

/// What the user should know about the journal.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum JournalNews {
    /// The state cannot be written, for this reason. Further failures are not reported until a
    /// state was written.
    Failed(String),
    /// The journal is up to date again after a failure.
    Restored,
}

impl Desk {
    fn succeeded(&mut self) {
        if std::mem::replace(&mut self.failing, false) {
            self.news = Some(JournalNews::Restored);
        }
    }
}

#[derive(Debug)]
struct Shared {
    desk: Mutex<Desk>,
    changed: Condvar,
    slot: Slot,
}

impl Shared {
    fn desk(&self) -> MutexGuard<'_, Desk> {
        self.desk.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Does what the desk asks for.
    fn follow(&self, mut desk: MutexGuard<'_, Desk>) {
        let next = std::mem::take(&mut desk.next);
        // Every later task replaces the state that failed.
        desk.failed = None;
        desk.busy = true;
        drop(desk);
        let replaced = match next {
            Next::Nothing => Vec::new(),
            Next::Write(state) => self.write(state),
            Next::Remove => {
                // The file may not exist.
                let _ = std::fs::remove_file(&self.slot.work);
                self.desk().succeeded();
                Vec::new()
            }
        };
        self.desk().busy = false;
        self.changed.notify_all();
        replaced.into_iter().for_each(Abandoned::remove);
    }

    /// Writes a state. Returns the work to delete: deleting work taken over is only safe after a
    /// successful write.
    fn write(&self, state: Box<Unsaved>) -> Vec<Abandoned> {
        let result = write(&self.slot.work, &state);
        let mut desk = self.desk();
        match result {
            Ok(()) => {
                desk.succeeded();
                std::mem::take(&mut desk.replaced)
            }
            Err(fault) => {
                if !std::mem::replace(&mut desk.failing, true) {
                    desk.news = Some(JournalNews::Failed(fault));
                }
                desk.failed = Some(state);
                Vec::new()
            }
        }
    }
}

/// The unsaved work of this program, on disk. Dropping this value keeps the file; only
/// [`Journal::end`] deletes it.
#[derive(Debug)]
pub struct Journal {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
    /// Held while the program runs.
    _lock: Lock,
}

impl Journal {
    /// Starts saving the work of this program.
    ///
    /// # Errors
    /// The reason, if the folder cannot be written.
    pub fn begin(folders: &OwnFolders) -> Result<Self, String> {
        let folder = &folders.state;
        made(folder)?;
        let fail = |error: std::io::Error| format!("{}: {}", folder.display(), reason(&error));
        // The lock on the list keeps other programs from taking the same slot.
        let list = list_lock(folder).map_err(fail)?;
        let process = own_process();
        let taken = |number: &u32| {
            let slot = Slot::named(folder, &format!("{PREFIX}{process}-{number}"));
            let free = !slot.lock.exists() && !slot.work.exists();
            let lock = if free { Lock::try_take(&slot.lock) } else { None };
            lock.map(|lock| (slot, lock))
        };
        let found = (1..1000).find_map(|number| taken(&number));
        let (slot, lock) = found.ok_or_else(|| format!("{}: cannot lock it", folder.display()))?;
        // The slot's own lock protects it from here on.
        drop(list);
        let desk = Mutex::new(Desk::default());
        let shared = Arc::new(Shared { desk, changed: Condvar::new(), slot });
        // WebAssembly has no threads, and its files are in memory.
        let thread = if cfg!(target_family = "wasm") {
            None
        } else {
            let theirs = Arc::clone(&shared);
            let thread = std::thread::Builder::new().name("journal".to_owned());
            Some(thread.spawn(move || keep(&theirs)).map_err(fail)?)
        };
        Ok(Self { shared, thread, _lock: lock })
    }

    /// Replaces the state to be written.
    pub fn keep(&self, state: Unsaved) {
        self.shared.desk().next = Next::Write(Box::new(state));
        self.tell();
    }

    /// Reports that all changes are saved.
    pub fn all_saved(&self) {
        self.shared.desk().next = Next::Remove;
        self.tell();
    }

    /// Wakes the thread, or does its work without one.
    fn tell(&self) {
        match &self.thread {
            Some(_) => self.shared.changed.notify_all(),
            None => self.shared.follow(self.shared.desk()),
        }
    }

    /// Registers work taken over from another program, now part of the state to be written. It is
    /// deleted when that state is on disk.
    pub fn replace(&self, taken_over: Abandoned) {
        self.shared.desk().replaced.push(taken_over);
    }

    /// Returns news about writing, each once.
    pub fn news(&self) -> Option<JournalNews> {
        self.shared.desk().news.take()
    }

    /// Waits until the last state was written, or has failed for now.
    pub fn wait(&self) {
        let mut desk = self.shared.desk();
        while desk.busy || !matches!(desk.next, Next::Nothing) {
            desk = self.shared.changed.wait(desk).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Ends the journal at a regular exit, leaving nothing to recover.
    pub fn end(mut self) {
        self.stop();
        for taken_over in std::mem::take(&mut self.shared.desk().replaced) {
            taken_over.remove();
        }
        self.shared.slot.remove();
    }

    fn stop(&mut self) {
        self.shared.desk().ended = true;
        self.shared.changed.notify_all();
        if let Some(thread) = self.thread.take() {
            // A thread that panicked has nothing more to write.
            let _ = thread.join();
        }
    }
}

impl Drop for Journal {
    fn drop(&mut self) {
        self.stop();
    }
}

/// Runs the thread: writes the latest state, pauses, and repeats.
fn keep(shared: &Shared) {
    let mut rested = Instant::now();
    loop {
        let mut desk = shared.desk();
        let retry = Instant::now() + RETRY;
        while matches!(desk.next, Next::Nothing) && !desk.ended {
            if desk.failed.is_some() && Instant::now() >= retry {
                break;
            }
            desk = if desk.failed.is_some() {
                wait_until(shared, desk, retry)
            } else {
                shared.changed.wait(desk).unwrap_or_else(PoisonError::into_inner)
            };
        }
        // States that arrive during the pause replace older ones.
        while !desk.ended && Instant::now() < rested {
            desk = wait_until(shared, desk, rested);
        }
        let failed = desk.failed.take().filter(|_| matches!(desk.next, Next::Nothing));
        if let Some(state) = failed {
            desk.next = Next::Write(state);
        }
        let ended = desk.ended;
        shared.follow(desk);
        if ended {
            return;
        }
        rested = Instant::now() + PAUSE;
    }
}

/// Waits until the desk changes, at most until this time.
fn wait_until<'a>(
    shared: &'a Shared,
    desk: MutexGuard<'a, Desk>,
    time: Instant,
) -> MutexGuard<'a, Desk> {
    let rest = time.saturating_duration_since(Instant::now());
    let waited = shared.changed.wait_timeout(desk, rest);
    waited.unwrap_or_else(PoisonError::into_inner).0
}

fn write(path: &Path, state: &Unsaved) -> Result<(), String> {
    let Unsaved { scene, view, settings, window, file, content } = state;
    let text = text_with_window(path, scene, view, settings, window);
    let text = text.map_err(|error| error.to_string())?;
    let text = head(file.as_deref(), *content) + &text;
    replace(path, text.as_bytes(), Worth::Journal).map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::default_scene;

    fn unsaved() -> Unsaved {
        let (scene, view) = default_scene();
        let (settings, window) = (Settings::default(), WindowState::DEFAULT);
        Unsaved { scene, view, settings, window, file: None, content: None }
    }

    #[test]
    fn a_failed_write_is_reported_once_and_repeated_until_it_succeeds() {
        let folder = tempfile::tempdir().unwrap();
        let folders = OwnFolders::within(folder.path());
        let journal = Journal::begin(&folders).unwrap();
        let work = journal.shared.slot.work.clone();
        // No file can replace a folder.
        std::fs::create_dir(&work).unwrap();
        std::fs::write(work.join("stranger"), "").unwrap();
        for attempt in 0..3 {
            journal.keep(unsaved());
            journal.wait();
            let told = matches!(journal.news(), Some(JournalNews::Failed(_)));
            assert_eq!(told, attempt == 0, "{attempt}");
        }
        std::fs::remove_dir_all(&work).unwrap();
        // Nothing changes any more, and the state is written all the same.
        let late = Instant::now() + Duration::from_secs(60);
        while !work.is_file() && Instant::now() < late {
            std::thread::sleep(Duration::from_millis(20));
        }
        assert!(work.is_file());
        journal.wait();
        assert_eq!(journal.news(), Some(JournalNews::Restored));
        assert_eq!(journal.news(), None);
        journal.end();
    }

    #[test]
    fn a_state_that_failed_is_not_written_after_everything_was_saved() {
        let folder = tempfile::tempdir().unwrap();
        let folders = OwnFolders::within(folder.path());
        let journal = Journal::begin(&folders).unwrap();
        let work = journal.shared.slot.work.clone();
        std::fs::create_dir(&work).unwrap();
        std::fs::write(work.join("stranger"), "").unwrap();
        journal.keep(unsaved());
        journal.wait();
        journal.all_saved();
        journal.wait();
        std::fs::remove_dir_all(&work).unwrap();
        let shared = Arc::clone(&journal.shared);
        drop(journal);
        assert!(shared.desk().failed.is_none() && !work.exists());
    }
}

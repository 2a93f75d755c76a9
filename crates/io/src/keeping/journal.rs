//! Keeps the unsaved scene on the disk while it is edited.
//!
//! A thread writes the latest state of the scene, as a scene file that names the models' files, and
//! flushes it to the disk. It takes a state at most every [`PAUSE`], so that what a crash can lose
//! was done in the last second. The file is replaced in one step: at any moment it holds a whole
//! scene.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use super::abandoned::{Abandoned, PREFIX};
use super::origin::head;
use super::{Lock, OwnFolders, Slot, list_lock, made};
use crate::error::reason;
use crate::fingerprint::Fingerprint;
use crate::replace::{Worth, replace};
use crate::scene_file::text_with_window;
use crate::window_state::WindowState;
use marraztu_core::accuracy::Settings;
use marraztu_core::scene::{Scene, View};

/// The time between two states that are written.
const PAUSE: Duration = Duration::from_millis(200);

/// A state with unsaved changes. Clones share everything large.
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
    /// The file in which it was saved before, if it was.
    pub file: Option<PathBuf>,
    /// The content of that file as it was read or written last.
    pub content: Option<Fingerprint>,
}

/// What the thread is to write next.
#[derive(Debug, Default)]
enum Next {
    #[default]
    Nothing,
    Write(Box<Unsaved>),
    /// Everything is saved: there is no work to keep.
    Remove,
}

#[derive(Debug, Default)]
struct Desk {
    next: Next,
    /// Work that has been taken over, and is removed once this program has written it.
    replaced: Vec<Abandoned>,
    busy: bool,
    ended: bool,
    /// Why the last state could not be written.
    fault: Option<String>,
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
}

/// The unsaved work of this program, on the disk. It stays there if this value is dropped; only
/// [`Journal::end`] removes it.
#[derive(Debug)]
pub struct Journal {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
    /// Held while the program runs.
    _lock: Lock,
}

impl Journal {
    /// Begins to keep the work of this program.
    ///
    /// # Errors
    /// The reason, if the folder cannot be written.
    pub fn begin(folders: &OwnFolders) -> Result<Self, String> {
        let folder = &folders.state;
        made(folder)?;
        let fail = |error: std::io::Error| format!("{}: {}", folder.display(), reason(&error));
        let list = list_lock(folder).map_err(fail)?;
        let process = std::process::id();
        let taken = |number: &u32| {
            let slot = Slot::named(folder, &format!("{PREFIX}{process}-{number}"));
            let free = !slot.lock.exists() && !slot.work.exists();
            let lock = if free { Lock::try_take(&slot.lock) } else { None };
            lock.map(|lock| (slot, lock))
        };
        let found = (1..1000).find_map(|number| taken(&number));
        let (slot, lock) = found.ok_or_else(|| format!("{}: cannot lock it", folder.display()))?;
        drop(list);
        let desk = Mutex::new(Desk::default());
        let shared = Arc::new(Shared { desk, changed: Condvar::new(), slot });
        let theirs = Arc::clone(&shared);
        let thread = std::thread::Builder::new()
            .name("journal".to_owned())
            .spawn(move || keep(&theirs))
            .map_err(fail)?;
        Ok(Self { shared, thread: Some(thread), _lock: lock })
    }

    /// Keeps this state instead of the one before.
    pub fn keep(&self, state: Unsaved) {
        self.shared.desk().next = Next::Write(Box::new(state));
        self.shared.changed.notify_all();
    }

    /// There are no unsaved changes any more.
    pub fn all_saved(&self) {
        self.shared.desk().next = Next::Remove;
        self.shared.changed.notify_all();
    }

    /// The work of another program is part of the state that is kept next; it is removed once that
    /// state is on the disk.
    pub fn replace(&self, taken_over: Abandoned) {
        self.shared.desk().replaced.push(taken_over);
    }

    /// Why the last state could not be written; told once.
    #[must_use]
    pub fn fault(&self) -> Option<String> {
        self.shared.desk().fault.take()
    }

    /// Waits until everything is on the disk.
    pub fn wait(&self) {
        let mut desk = self.shared.desk();
        while desk.busy || !matches!(desk.next, Next::Nothing) {
            desk = self.shared.changed.wait(desk).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// The program is left properly: nothing is left to recover.
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
            // A thread that failed has nothing more to write.
            let _ = thread.join();
        }
    }
}

impl Drop for Journal {
    fn drop(&mut self) {
        self.stop();
    }
}

/// The thread: writes the latest state, rests, and begins again.
fn keep(shared: &Shared) {
    let mut rested = Instant::now();
    loop {
        let mut desk = shared.desk();
        while matches!(desk.next, Next::Nothing) && !desk.ended {
            desk = shared.changed.wait(desk).unwrap_or_else(PoisonError::into_inner);
        }
        // What comes meanwhile is newer.
        while !desk.ended && Instant::now() < rested {
            let rest = rested.saturating_duration_since(Instant::now());
            let waited = shared.changed.wait_timeout(desk, rest);
            desk = waited.unwrap_or_else(PoisonError::into_inner).0;
        }
        let next = std::mem::take(&mut desk.next);
        let ended = desk.ended;
        desk.busy = true;
        drop(desk);
        let result = match next {
            Next::Nothing => Ok(false),
            Next::Write(state) => write(&shared.slot.work, &state).map(|()| true),
            Next::Remove => {
                // It may not be there.
                let _ = std::fs::remove_file(&shared.slot.work);
                Ok(false)
            }
        };
        rested = Instant::now() + PAUSE;
        let mut desk = shared.desk();
        let replaced = match result {
            Ok(true) => std::mem::take(&mut desk.replaced),
            Ok(false) => Vec::new(),
            Err(fault) => {
                desk.fault = Some(fault);
                Vec::new()
            }
        };
        desk.busy = false;
        drop(desk);
        shared.changed.notify_all();
        replaced.into_iter().for_each(Abandoned::remove);
        if ended {
            return;
        }
    }
}

fn write(path: &Path, state: &Unsaved) -> Result<(), String> {
    let Unsaved { scene, view, settings, window, file, content } = state;
    let text = text_with_window(path, scene, view, settings, window);
    let text = text.map_err(|error| error.to_string())?;
    let text = head(file.as_deref(), *content) + &text;
    replace(path, text.as_bytes(), Worth::Journal).map_err(|error| error.to_string())
}

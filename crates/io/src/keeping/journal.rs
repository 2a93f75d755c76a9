//! Saves unsaved work to disk while the scene is edited.
//!
//! A thread writes the latest state as a scene file that refers to the models' files, and flushes
//! it to disk. It writes at most once per [`PAUSE`], so a crash loses at most the last second of
//! work. The file is replaced atomically: it always holds a complete scene.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use super::abandoned::{Abandoned, PREFIX};
use super::origin::head;
use super::{Lock, OwnFolders, Slot, list_lock, made};
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
    /// The reason why the last state could not be written.
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

    /// Does what the desk asks for.
    fn follow(&self, mut desk: MutexGuard<'_, Desk>) {
        let next = std::mem::take(&mut desk.next);
        desk.busy = true;
        drop(desk);
        let result = match next {
            Next::Nothing => Ok(false),
            Next::Write(state) => write(&self.slot.work, &state).map(|()| true),
            Next::Remove => {
                // The file may not exist.
                let _ = std::fs::remove_file(&self.slot.work);
                Ok(false)
            }
        };
        let mut desk = self.desk();
        // Deleting work taken over is only safe after a successful write.
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
        self.changed.notify_all();
        replaced.into_iter().for_each(Abandoned::remove);
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

    /// Returns the reason why the last state could not be written, once.
    pub fn fault(&self) -> Option<String> {
        self.shared.desk().fault.take()
    }

    /// Waits until everything is on disk.
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
        while matches!(desk.next, Next::Nothing) && !desk.ended {
            desk = shared.changed.wait(desk).unwrap_or_else(PoisonError::into_inner);
        }
        // States that arrive during the pause replace older ones.
        while !desk.ended && Instant::now() < rested {
            let rest = rested.saturating_duration_since(Instant::now());
            let waited = shared.changed.wait_timeout(desk, rest);
            desk = waited.unwrap_or_else(PoisonError::into_inner).0;
        }
        let ended = desk.ended;
        shared.follow(desk);
        if ended {
            return;
        }
        rested = Instant::now() + PAUSE;
    }
}

fn write(path: &Path, state: &Unsaved) -> Result<(), String> {
    let Unsaved { scene, view, settings, window, file, content } = state;
    let text = text_with_window(path, scene, view, settings, window);
    let text = text.map_err(|error| error.to_string())?;
    let text = head(file.as_deref(), *content) + &text;
    replace(path, text.as_bytes(), Worth::Journal).map_err(|error| error.to_string())
}

//! Draws the jobs of a batch.
//!
//! Small pictures cannot be split between threads without loss, so each thread draws its own: it is
//! the only thread of a rayon pool. Pictures of more than a megapixel are drawn one after the other
//! by all threads. A further thread reads models ahead, so reading, drawing and encoding overlap.
//! Pixels depend on none of this.

mod attempt;

use std::cell::RefCell;
use std::collections::BTreeSet;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::SyncSender;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use marraztu_core::base::image::Size;
use marraztu_core::base::threads::{self, Caller};
use marraztu_io::{self as io, Progress};
use marraztu_render::Renderer;
use rayon::ThreadPool;

use self::attempt::Attempt;
use super::Batch;
use super::cache::{LoadedStage, StageCache};
use super::digest::Stamper;
use super::estimate::Rehearsed;
use super::jobs::{Job, Plan};
use super::outcome::{Fault, Outcome, Spent};
use super::rows::Row;
use super::tars::EarlierTars;
use crate::cli::budget::{Budget, chosen};
use crate::cli::failure::Failure;

/// Pictures with more pixels are drawn by all threads.
const LARGE: usize = 1 << 20;

/// The number of models that are read ahead.
const AHEAD: usize = 2;

/// The state that the threads of a batch share.
#[derive(Debug)]
pub(super) struct Studio {
    plan: Plan,
    arguments: Arc<Batch>,
    /// The position of the next job.
    next: AtomicUsize,
    stopped: AtomicBool,
    cache: StageCache,
    stamper: Stamper,
    /// The pool for large pictures.
    large: Mutex<Option<ThreadPool>>,
    /// The folders that exist and are free of leftovers.
    folders: Mutex<BTreeSet<PathBuf>>,
    /// The files being read, with their time limits.
    reading: Mutex<Vec<(Option<Instant>, Progress)>>,
    /// The archives of an earlier run, if pictures are written to archives.
    earlier_tars: Option<Arc<EarlierTars>>,
}

impl Studio {
    pub(super) fn new(plan: Plan, arguments: Arc<Batch>) -> Self {
        let earlier_tars = plan.tars().map(|names| Arc::new(EarlierTars::new(Arc::clone(names))));
        Self {
            plan,
            earlier_tars,
            next: AtomicUsize::new(0),
            stopped: AtomicBool::new(false),
            cache: StageCache::new(arguments.memory),
            stamper: Stamper::new(arguments.has_fixed_lights()),
            arguments,
            large: Mutex::default(),
            folders: Mutex::default(),
            reading: Mutex::default(),
        }
    }

    /// Returns the pictures to draw.
    pub(super) const fn plan(&self) -> &Plan {
        &self.plan
    }

    /// Returns the archives of an earlier run, if pictures are written to archives.
    pub(super) const fn earlier_tars(&self) -> Option<&Arc<EarlierTars>> {
        self.earlier_tars.as_ref()
    }

    /// Returns whether a report needs hashes and findings.
    fn reports(&self) -> bool {
        self.arguments.report.is_some()
    }

    /// Returns the time at which a picture that is begun now is given up.
    fn end(&self) -> Option<Instant> {
        self.arguments.timeout.map(|limit| Instant::now() + limit)
    }

    /// Ends the batch: pictures that are being drawn are given up.
    pub(super) fn stop(&self) {
        self.stopped.store(true, Ordering::Relaxed);
        for (_, progress) in self.reading.lock().unwrap_or_else(PoisonError::into_inner).iter() {
            progress.cancel();
        }
    }

    /// Gives up files that are being read beyond their time limit.
    pub(super) fn enforce_limits(&self) {
        let now = Instant::now();
        let reading = self.reading.lock().unwrap_or_else(PoisonError::into_inner);
        for (until, progress) in reading.iter() {
            if until.is_some_and(|until| until < now) {
                progress.cancel();
            }
        }
    }

    fn is_stopped(&self) -> bool {
        self.stopped.load(Ordering::Relaxed)
    }

    /// Draws jobs on this thread until none is left, and sends their results.
    pub(super) fn work(&self, results: &SyncSender<Outcome>) {
        // A pool of this thread alone: it is in no other, so it can join.
        let _pool = threads::pool(1, Caller::Joins, "draw");
        let mut renderer = Renderer::default();
        while !self.is_stopped() {
            let number = self.next.fetch_add(1, Ordering::Relaxed);
            let Some(job) = self.plan.job(number) else { return };
            let (until, spent) = (self.end(), Spent::default());
            let mut attempt = Attempt { studio: self, job: &job, until, source: None, spent };
            let result = guarded(|| attempt.picture(&mut renderer)).unwrap_or_else(|panic| {
                renderer = Renderer::default();
                Err(Fault::Program(panic))
            });
            let Attempt { source, spent, .. } = attempt;
            if self.plan.is_last_of_model(number) {
                self.cache.forget(&job.row.file);
            }
            if result.as_ref().is_err_and(|fault| *fault != Fault::Cancelled) {
                self.remove_earlier(&job);
            }
            let known = || guarded(|| self.stamper.known(&job.row)).ok().flatten();
            let wanted = self.reports() && result != Err(Fault::Cancelled);
            let source = if wanted { source.or_else(known) } else { None };
            let in_sha256 = source.map(|source| source.file);
            if results.send(Outcome { job, result, in_sha256, spent }).is_err() {
                return;
            }
        }
    }

    /// Draws and encodes the picture of a job, without writing it.
    pub(super) fn rehearse(&self, job: &Job, renderer: &mut Renderer) -> Rehearsed {
        let (until, spent) = (self.end(), Spent::default());
        let mut attempt = Attempt { studio: self, job, until, source: None, spent };
        let bytes = guarded(|| attempt.rehearsed(renderer)).unwrap_or_else(|panic| {
            *renderer = Renderer::default();
            Err(Fault::Program(panic))
        });
        Rehearsed { bytes, spent: attempt.spent, is_large: self.is_large(job.size()) }
    }

    /// Finds settings for the first picture that can be read, drawn as the batch draws it. Returns
    /// the options that choose them, each with its value.
    pub(super) fn within_budget(
        &self,
        budget: &Budget,
    ) -> Result<Vec<(&'static str, &'static str)>, Failure> {
        let read = |job: Job| {
            let spent = Spent::default();
            let mut attempt = Attempt { studio: self, job: &job, until: None, source: None, spent };
            let stage = attempt.stage().ok()?.0;
            Some((job, stage))
        };
        let Some((job, stage)) = self.plan.jobs().find_map(read) else { return Ok(Vec::new()) };
        let (shot, accuracy) = (stage.shot(job.size()), &job.options().accuracy);
        let search = || budget.settings(&shot, accuracy);
        let alone = || threads::pool(1, Caller::Waits, "search").ok();
        let settings = match (!self.is_large(job.size())).then(alone).flatten() {
            Some(pool) => pool.install(search),
            None => search(),
        };
        Ok(chosen(&settings?, &shot.settings, &accuracy.fixed()))
    }

    /// Removes the files of an earlier run for a picture of a data set that could not be drawn: its
    /// tables do not describe them.
    fn remove_earlier(&self, job: &Job) {
        if self.arguments.dataset.is_some() {
            let own = job.files.iter().filter(|file| io::read_stamp(&file.path).is_some());
            own.for_each(|file| _ = std::fs::remove_file(&file.path));
        }
    }

    /// Reads the models of the next jobs until none is left.
    pub(super) fn read_ahead(&self) {
        let mut at = 0;
        // The ends of the models that are read and not drawn.
        let mut ahead: Vec<usize> = Vec::new();
        while let (Some(job), false) = (self.plan.job(at), self.is_stopped()) {
            let (file, end) = (&job.row.file, self.plan.end_of_model(at));
            // Wait until the jobs before are nearly done.
            loop {
                let next = self.next.load(Ordering::Relaxed);
                ahead.retain(|end| *end > next);
                let is_full = at > next && !self.cache.has_room_for(file, AHEAD + 1);
                if ahead.len() < AHEAD && !is_full {
                    break;
                }
                if self.is_stopped() {
                    return;
                }
                std::thread::sleep(Duration::from_millis(2));
            }
            if self.next.load(Ordering::Relaxed) < end && !self.is_up_to_date(&job) {
                // A panic is reported by the job that meets it again.
                let _ = guarded(|| self.scene(&job.row, self.end()));
            }
            ahead.push(end);
            at = end;
        }
    }

    /// Returns the scene of a row, without a camera.
    fn scene(&self, row: &Row, until: Option<Instant>) -> Result<Arc<LoadedStage>, Fault> {
        let progress = Progress::new();
        let lock = || self.reading.lock().unwrap_or_else(PoisonError::into_inner);
        lock().push((until, progress.clone()));
        if self.is_stopped() {
            progress.cancel();
        }
        let loaded = self.cache.get(row, &progress, &self.stopped);
        // Whatever the position, one finished entry is removed for each one added.
        progress.cancel();
        lock().retain(|(_, other)| !other.is_cancelled());
        loaded
    }

    /// Returns whether an earlier run has drawn the picture of a job.
    fn is_up_to_date(&self, job: &Job) -> bool {
        self.arguments.resume && self.finished(job).is_some()
    }

    /// Returns the stamp of an earlier run, if it is right.
    fn finished(&self, job: &Job) -> Option<String> {
        let stamp = |path: &Path| match &self.earlier_tars {
            Some(tars) => io::stamp_of(&tars.member(job, path)?.1),
            None => io::read_stamp(path),
        };
        let found = stamp(job.out())?;
        let hash = found.split(' ').next()?.to_owned();
        let layers = &job.files[1..];
        let is_whole = layers.iter().all(|file| stamp(&file.path).as_ref() == Some(&found));
        let source = if is_whole { self.stamper.known(&job.row) } else { None };
        let stamp = source.map(|source| self.stamper.stamp(job, &source));
        (Some(hash) == stamp).then_some(found)
    }

    /// Returns whether all threads draw a picture of this size together.
    fn is_large(&self, size: Size) -> bool {
        size.area() > LARGE && self.arguments.threads() > 1
    }

    /// Returns the pool for a large picture, as soon as it is free; `None` for a small one.
    fn pool_for(&self, size: Size) -> Option<MutexGuard<'_, Option<ThreadPool>>> {
        if !self.is_large(size) {
            return None;
        }
        let mut large = self.large.lock().unwrap_or_else(PoisonError::into_inner);
        if large.is_none() {
            // Without a further thread, this one draws.
            *large = threads::pool(self.arguments.threads(), Caller::Waits, "large").ok();
        }
        Some(large)
    }

    /// Creates a folder, and removes the leftovers of killed processes from it.
    fn prepare_folder(&self, folder: &Path) -> Result<(), Fault> {
        let lock = || self.folders.lock().unwrap_or_else(PoisonError::into_inner);
        if lock().contains(folder) {
            return Ok(());
        }
        let created =
            if folder.as_os_str().is_empty() { Ok(()) } else { std::fs::create_dir_all(folder) };
        created.map_err(|error| {
            Fault::Output(format!("the folder {} cannot be created: {error}", folder.display()))
        })?;
        io::sweep_once(if folder.as_os_str().is_empty() { Path::new(".") } else { folder });
        lock().insert(folder.to_owned());
        Ok(())
    }
}

thread_local! {
    /// The place of the last panic on this thread.
    static PLACE: RefCell<String> = const { RefCell::new(String::new()) };
}

/// Replaces the message that a panic prints: a batch reports it.
pub(super) fn silence_panics() {
    std::panic::set_hook(Box::new(|panic| {
        let place = panic.location().map(|place| format!(" ({}:{})", place.file(), place.line()));
        PLACE.replace(place.unwrap_or_default());
    }));
}

/// Runs a part of a job. A panic is an error, with its message.
fn guarded<T>(work: impl FnOnce() -> T) -> Result<T, String> {
    catch_unwind(AssertUnwindSafe(work)).map_err(|panic| {
        let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
        let text = text.or_else(|| panic.downcast_ref::<String>().cloned());
        let place = PLACE.take();
        format!("{}{place}", text.as_deref().unwrap_or("a panic without a message"))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_is_one_error_with_its_message() {
        assert_eq!(guarded(|| 7), Ok(7));
        let error = guarded(|| -> u8 { panic!("index {}", 9) }).unwrap_err();
        assert!(error.starts_with("index 9"), "{error}");
        assert!(
            guarded(|| std::panic::panic_any(7_u8)).unwrap_err().starts_with("a panic without")
        );
    }
}

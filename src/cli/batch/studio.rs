//! Draws the jobs of a batch.
//!
//! Small pictures cannot be split between threads without loss, so each thread draws its own: it is
//! the only thread of a rayon pool. Pictures of more than a megapixel are drawn one after the other
//! by all threads. A further thread reads models ahead, so reading, drawing and encoding overlap.
//! Pixels depend on none of this.

use std::borrow::Cow;
use std::cell::RefCell;
use std::collections::BTreeSet;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::SyncSender;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use marraztu_core::accuracy::Shot;
use marraztu_core::base::image::{Picture, Size};
use marraztu_core::base::threads::{self, Caller};
use marraztu_io::{self as io, Progress};
use marraztu_render::{LayerNames, Layers, Renderer, plan_frame, without_ground_while};
use rayon::ThreadPool;

use super::Batch;
use super::cache::{LoadedStage, StageCache};
use super::dataset::{self, Dataset, DatasetImage};
use super::digest::{SourceHash, Stamper, hash_of, hash_of_file};
use super::estimate::Rehearsed;
use super::jobs::{Job, Plan};
use super::options::PictureOptions;
use super::outcome::{Drawn, Fault, FileSum, Outcome, Spent};
use super::report::shown;
use super::rows::Row;
use crate::cli::cameras::CameraFrame;
use crate::cli::failure::Failure;
use crate::cli::fixed_lights::look_with_fixed_lights;
use crate::cli::layers::{LayerContent, LayerFile};
use crate::cli::render::NO_MEMORY;
use crate::cli::render::look;
use crate::cli::stage::Stage;

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
}

/// A picture that is being drawn.
struct Attempt<'a> {
    studio: &'a Studio,
    job: &'a Job,
    until: Option<Instant>,
    /// The hashes of the loaded files.
    source: Option<SourceHash>,
    spent: Spent,
}

impl Studio {
    pub(super) fn new(plan: Plan, arguments: Arc<Batch>) -> Self {
        Self {
            plan,
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
            // All pictures of a model follow each other, so no other one needs it.
            if self.plan.end_of_model(number) == number + 1 {
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
        let found = io::read_stamp(job.out())?;
        let hash = found.split(' ').next()?.to_owned();
        let layers = &job.files[1..];
        let is_whole =
            layers.iter().all(|file| io::read_stamp(&file.path).as_ref() == Some(&found));
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

impl Attempt<'_> {
    /// Draws and writes the picture, unless it is up to date.
    fn picture(&mut self, renderer: &mut Renderer) -> Result<Drawn, Fault> {
        let (studio, job) = (self.studio, self.job);
        let folders = job.files.iter().map(|file| file.path.parent().unwrap_or(Path::new("")));
        if studio.arguments.resume
            && let Some(stamp) = studio.finished(job)
        {
            // Whole files are read, and models with findings loaded, only for a report.
            folders.clone().try_for_each(|folder| studio.prepare_folder(folder))?;
            let has_findings = !stamp.ends_with(" 0");
            return self.unchanged(has_findings);
        }
        let (stage, findings) = self.stage()?;
        let sources = stage.sources(std::slice::from_ref(&job.row.file));
        for file in &job.files {
            sources.spare(&file.path).map_err(|error| output(&error))?;
        }
        folders.clone().try_for_each(|folder| studio.prepare_folder(folder))?;
        for file in &job.files {
            io::check_replaced(&file.path).map_err(|error| output(&error))?;
        }
        let contents = self.contents(renderer, &stage, findings.len())?;
        let image = self.dataset_image(renderer, &stage)?;
        let begin = Instant::now();
        for (file, content) in job.files.iter().zip(&contents) {
            io::save_encoded(&file.path, content).map_err(|error| output(&error))?;
        }
        self.spent.encode += begin.elapsed();
        let sum = |(file, content): (&LayerFile, &Vec<u8>)| FileSum {
            out: shown(&file.path),
            sha256: studio.reports().then(|| hash_of(content)),
            bytes: content.len() as u64,
        };
        let files = job.files.iter().zip(&contents).map(sum).collect();
        let camera = self.camera(&stage);
        Ok(Drawn { files, camera, image, findings, unchanged: false })
    }

    /// Draws and encodes the picture, unless it is up to date. Returns the bytes of its files.
    fn rehearsed(&mut self, renderer: &mut Renderer) -> Result<u64, Fault> {
        if self.studio.is_up_to_date(self.job) {
            return Ok(0);
        }
        let (stage, findings) = self.stage()?;
        let contents = self.contents(renderer, &stage, findings.len())?;
        let begin = Instant::now();
        let masks = self.masks(renderer, &stage)?.map(|(files, _)| files);
        self.spent.draw += begin.elapsed();
        let masks = masks.iter().flatten().map(|(_, content)| content);
        Ok(contents.iter().chain(masks).map(|content| content.len() as u64).sum())
    }

    /// Draws the masks of a data set, and describes the picture for its tables.
    fn masks(
        &self,
        renderer: &mut Renderer,
        stage: &Stage,
    ) -> Result<Option<(Vec<dataset::File>, DatasetImage)>, Fault> {
        let (studio, job) = (self.studio, self.job);
        let Some(dataset @ (Dataset::Bop | Dataset::Coco)) = studio.arguments.dataset else {
            return Ok(None);
        };
        let wanted = || !studio.is_stopped();
        let shot = stage.shot(job.size());
        dataset::image(dataset, renderer, (job, &shot), &wanted).map(Some)
    }

    /// Writes the masks of a data set, and describes the picture for its tables.
    fn dataset_image(
        &self,
        renderer: &mut Renderer,
        stage: &Stage,
    ) -> Result<Option<Box<DatasetImage>>, Fault> {
        let (studio, job) = (self.studio, self.job);
        let Some((files, image)) = self.masks(renderer, stage)? else { return Ok(None) };
        for (path, content) in files {
            studio.prepare_folder(path.parent().unwrap_or(Path::new("")))?;
            io::check_replaced(&path).map_err(|error| output(&error))?;
            io::save_encoded(&path, &content).map_err(|error| output(&error))?;
        }
        if studio.arguments.dataset == Some(Dataset::Bop) {
            dataset::remove_masks(job, image.objects.len());
        }
        Ok(Some(Box::new(image)))
    }

    /// Describes the camera, if the picture has layers.
    fn camera(&self, stage: &Stage) -> Option<Box<CameraFrame>> {
        let job = self.job;
        let options = &job.options().layers;
        if !options.are_given() {
            return None;
        }
        let names = options.has_ids().then(|| LayerNames::of(&stage.scene));
        let scene = (shown(&job.row.file), &*job.camera().name);
        let shot = stage.shot(job.size());
        let folder = job.cameras_folder(self.studio.arguments.dataset);
        let frame = CameraFrame::new(&shot, (folder, &job.files), scene, (options, names.as_ref()));
        Some(Box::new(frame))
    }

    /// Returns the result of a picture that an earlier run has drawn.
    fn unchanged(&mut self, has_findings: bool) -> Result<Drawn, Fault> {
        let mut drawn = Drawn { unchanged: true, ..Drawn::default() };
        let reports = self.studio.reports();
        if reports {
            let sum = |file: &LayerFile| -> std::io::Result<FileSum> {
                let (out, bytes) = (shown(&file.path), file.path.metadata()?.len());
                Ok(FileSum { out, sha256: Some(hash_of_file(&file.path)?), bytes })
            };
            let sums = self.job.files.iter().map(|file| {
                let shown = file.path.display();
                sum(file).map_err(|error| Fault::Output(format!("{shown}: {error}")))
            });
            drawn.files = sums.collect::<Result<_, _>>()?;
        }
        // The cameras of a picture with layers are written again: another shard may have drawn it.
        let has_layers = self.job.options().layers.are_given();
        if (reports && has_findings) || has_layers {
            let (stage, findings) = self.stage()?;
            drawn.camera = self.camera(&stage);
            drawn.findings = if reports { findings } else { Vec::new() };
        }
        Ok(drawn)
    }

    /// Returns the scene with its camera, and the findings.
    fn stage(&mut self) -> Result<(Stage, Vec<String>), Fault> {
        let begin = Instant::now();
        let (row, job) = (&self.job.row, self.job);
        let loaded = self.studio.scene(row, self.until);
        self.spent.load += begin.elapsed();
        let loaded = loaded?;
        self.source = Some(loaded.source.clone());
        let mut stage = loaded.stage.clone();
        let options = job.options();
        let failed = |failure: Failure| Fault::of(&failure);
        let aim = job.camera().aim.at(job.size());
        let look = match self.studio.arguments.has_fixed_lights() {
            true => look_with_fixed_lights,
            false => look,
        };
        look(&mut stage, &options.scene.seeing, &aim).map_err(failed)?;
        if let Some(dataset) = self.studio.arguments.dataset {
            dataset.check_projection(stage.view.projection)?;
        }
        stage.settings = options.accuracy.of_file(&stage.settings);
        let findings = stage.findings.iter().map(ToString::to_string);
        let findings = findings.chain(stage.notes.iter().cloned()).collect();
        Ok((stage, findings))
    }

    /// Draws the picture and its layers, and encodes its files.
    fn contents(
        &mut self,
        renderer: &mut Renderer,
        stage: &Stage,
        findings: usize,
    ) -> Result<Vec<Vec<u8>>, Fault> {
        let (studio, job) = (self.studio, self.job);
        let begin = Instant::now();
        let pool = studio.pool_for(job.size());
        // Waiting for other pictures does not count.
        let until = self.until.map(|until| until + begin.elapsed());
        let begin = Instant::now();
        let shot = stage.shot(job.size());
        let options = &job.options();
        let layers = options.layers.set();
        if !layers.is_empty() {
            layers.check_memory(shot.size).map_err(|_full| Fault::Program(NO_MEMORY.to_owned()))?;
        }
        let stopped = &studio.stopped;
        let is_late = || until.is_some_and(|until| until < Instant::now());
        let wanted = || !stopped.load(Ordering::Relaxed) && !is_late();
        let picture = match pool.as_ref().and_then(|pool| pool.as_ref()) {
            Some(pool) => pool.install(|| draw(renderer, &shot, options, &wanted)),
            None => draw(renderer, &shot, options, &wanted),
        };
        drop(pool);
        self.spent.draw += begin.elapsed();
        let stopped = || match studio.is_stopped() {
            true => Fault::Cancelled,
            false => Fault::Timeout(shown(&job.row.file)),
        };
        let (color, numbers) = picture.filter(|_| !is_late()).ok_or_else(stopped)?;
        let begin = Instant::now();
        let source = self.source.as_ref().expect("the files are hashed before they are loaded");
        let hash = studio.stamper.stamp(job, source);
        // The number of findings tells a later run whether its report needs the model.
        let stamp = format!("{hash} {findings}");
        let content =
            LayerContent::new(&shot, color.as_deref(), numbers.as_ref(), options.transparent);
        let contents = job.files.iter().map(|file| {
            let encoded = file.encode(&content, &options.layers.png(), Some(&stamp));
            encoded.map_err(|reason| Fault::Input(format!("{}: {reason}", file.path.display())))
        });
        let contents = contents.collect();
        self.spent.encode += begin.elapsed();
        contents
    }
}

fn output(error: &io::SaveError) -> Fault {
    Fault::Output(error.to_string())
}

/// Draws a picture and its layers, unless they are no longer wanted.
fn draw<'a>(
    renderer: &'a mut Renderer,
    shot: &Shot,
    options: &PictureOptions,
    wanted: &(dyn Fn() -> bool + Sync),
) -> Option<(Option<Cow<'a, Picture>>, Option<Layers>)> {
    let PictureOptions { layers, transparent, .. } = options;
    let numbers = match layers.set() {
        set if set.is_empty() => None,
        set => Some(renderer.layers_while(shot, set, layers.normal_space(), wanted).ok()?),
    };
    let color = match (layers.has_color(), transparent) {
        (false, _) => None,
        (true, true) => Some(Cow::Owned(without_ground_while(renderer, shot, wanted).ok()?)),
        (true, false) => {
            Some(Cow::Borrowed(renderer.render_while(&plan_frame(shot), wanted).ok()?))
        }
    };
    Some((color, numbers))
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

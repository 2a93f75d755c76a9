//! Draws and writes one picture of a batch, unless it is up to date.

use std::borrow::Cow;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;
use std::time::Instant;

use marraztu_core::accuracy::Shot;
use marraztu_core::base::image::Picture;
use marraztu_io as io;
use marraztu_render::{LayerNames, Layers, Renderer, plan_frame, without_ground_while};

use super::Studio;
use crate::cli::batch::dataset::{self, Dataset, DatasetImage};
use crate::cli::batch::digest::{SourceHash, hash_of, hash_of_file};
use crate::cli::batch::jobs::Job;
use crate::cli::batch::options::PictureOptions;
use crate::cli::batch::outcome::{Drawn, Fault, FileSum, Spent};
use crate::cli::batch::report::shown;
use crate::cli::batch::seeds::{self, SEED_POINTS};
use crate::cli::batch::tars::{Content, EarlierTars, Member, member_size};
use crate::cli::cameras::CameraFrame;
use crate::cli::failure::Failure;
use crate::cli::fixed_lights::look_with_fixed_lights;
use crate::cli::layers::{LayerContent, LayerFile};
use crate::cli::render::{NO_MEMORY, look};
use crate::cli::stage::Stage;

/// A picture that is being drawn.
pub(super) struct Attempt<'a> {
    pub(super) studio: &'a Studio,
    pub(super) job: &'a Job,
    pub(super) until: Option<Instant>,
    /// The hashes of the loaded files.
    pub(super) source: Option<SourceHash>,
    pub(super) spent: Spent,
}

impl Attempt<'_> {
    /// Draws the picture, unless it is up to date, and writes it, unless it goes into an archive.
    pub(super) fn picture(&mut self, renderer: &mut Renderer) -> Result<Drawn, Fault> {
        match &self.studio.earlier_tars {
            Some(tars) => self.picture_in_tar(renderer, tars),
            None => self.picture_in_files(renderer),
        }
    }

    fn picture_in_files(&mut self, renderer: &mut Renderer) -> Result<Drawn, Fault> {
        let (studio, job) = (self.studio, self.job);
        let folders = job.files.iter().map(|file| file.path.parent().unwrap_or(Path::new("")));
        if studio.arguments.resume
            && let Some(stamp) = studio.finished(job)
        {
            // Whole files are read, and models with findings loaded, only for a report.
            folders.clone().try_for_each(|folder| studio.prepare_folder(folder))?;
            self.seed_points(true)?;
            let drawn = self.unchanged(has_findings(&stamp))?;
            // Tables describe all pictures, also those of an earlier run.
            let image = match studio.arguments.dataset {
                Some(Dataset::Bop | Dataset::Coco) => {
                    let (stage, _) = self.stage()?;
                    self.dataset_image(renderer, &stage)?
                }
                Some(Dataset::Nerf) | None => None,
            };
            return Ok(Drawn { image, ..drawn });
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
        self.seed_points(false)?;
        let files = job.files.iter().zip(&contents);
        let files = files.map(|(file, content)| file_sum(file, content, studio.reports()));
        let (files, camera) = (files.collect(), self.camera(&stage));
        Ok(Drawn { files, camera, image, findings, ..Drawn::default() })
    }

    /// Draws and encodes the picture, unless it is up to date. Returns the bytes of its files.
    pub(super) fn rehearsed(&mut self, renderer: &mut Renderer) -> Result<u64, Fault> {
        if self.studio.is_up_to_date(self.job) {
            return Ok(0);
        }
        let (stage, findings) = self.stage()?;
        let contents = self.contents(renderer, &stage, findings.len())?;
        let begin = Instant::now();
        let masks = self.masks(renderer, &stage)?.map(|(files, _)| files);
        self.spent.draw += begin.elapsed();
        let masks = masks.into_iter().flatten().map(|(_, content)| content);
        let mut sizes: Vec<usize> = contents.into_iter().chain(masks).map(|it| it.len()).collect();
        if self.studio.earlier_tars.is_some() {
            sizes.push(self.frame(&stage).json().len());
            sizes.iter_mut().for_each(|size| *size = member_size(*size));
        }
        Ok(sizes.into_iter().map(|size| size as u64).sum())
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

    /// Writes the seed points of a data set with the first view of a model, or only if they are
    /// `missing`.
    fn seed_points(&mut self, missing: bool) -> Result<(), Fault> {
        let (studio, job) = (self.studio, self.job);
        let Some(count) = studio.arguments.seed_points.filter(|_| job.view() == 0) else {
            return Ok(());
        };
        let path = job.cameras_folder(studio.arguments.dataset).join(SEED_POINTS);
        if missing && path.exists() {
            return Ok(());
        }
        if seeds::is_of_another(&path) {
            let shown = path.display();
            return Err(Fault::Output(format!("{shown} is of another program: remove it first")));
        }
        let (stage, _) = self.stage()?;
        let points = seeds::ply(&stage.scene, stage.view.time, count);
        io::save_encoded(&path, &points).map_err(|error| output(&error))
    }

    /// Describes the camera, if the picture has layers.
    fn camera(&self, stage: &Stage) -> Option<Box<CameraFrame>> {
        self.job.options().layers.are_given().then(|| Box::new(self.frame(stage)))
    }

    /// Describes the camera.
    fn frame(&self, stage: &Stage) -> CameraFrame {
        let job = self.job;
        let options = &job.options().layers;
        let names = options.has_ids().then(|| LayerNames::of(&stage.scene));
        let scene = (shown(&job.row.file), &*job.camera().name);
        let shot = stage.shot(job.size());
        let folder = job.cameras_folder(self.studio.arguments.dataset);
        CameraFrame::new(&shot, (folder, &job.files), scene, (options, names.as_ref()))
    }

    /// Draws the picture for an archive, unless it is in that of an earlier run.
    fn picture_in_tar(
        &mut self,
        renderer: &mut Renderer,
        tars: &EarlierTars,
    ) -> Result<Drawn, Fault> {
        let (studio, job) = (self.studio, self.job);
        if studio.arguments.resume
            && let Some(stamp) = studio.finished(job)
            && let Some(drawn) = self.unchanged_in_tar(tars, has_findings(&stamp))?
        {
            return Ok(drawn);
        }
        let (stage, findings) = self.stage()?;
        let contents = self.contents(renderer, &stage, findings.len())?;
        let files = job.files.iter().zip(&contents);
        let files = files.map(|(file, content)| file_sum(file, content, studio.reports()));
        let (files, camera) = (files.collect(), self.frame(&stage).json());
        let contents = contents.into_iter().chain([camera]).map(Content::New);
        let members = member_paths(job).zip(contents);
        let members = members.map(|(path, content)| Member { path, content }).collect();
        Ok(Drawn { files, findings, members, ..Drawn::default() })
    }

    /// Returns the result of a picture in the archive of an earlier run. `None` if a file of it is
    /// missing.
    fn unchanged_in_tar(
        &mut self,
        tars: &EarlierTars,
        has_findings: bool,
    ) -> Result<Option<Drawn>, Fault> {
        let (reports, job) = (self.studio.reports(), self.job);
        let (mut members, mut files) = (Vec::new(), Vec::new());
        for path in member_paths(job) {
            let Some((place, content)) = tars.member(job, &path) else { return Ok(None) };
            if let Some(file) = job.files.get(files.len()).filter(|_| reports) {
                files.push(file_sum(file, &content, reports));
            }
            members.push(Member { path, content: Content::Earlier(place) });
        }
        let findings = if reports && has_findings { self.stage()?.1 } else { Vec::new() };
        Ok(Some(Drawn { files, findings, members, unchanged: true, ..Drawn::default() }))
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
    pub(super) fn stage(&mut self) -> Result<(Stage, Vec<String>), Fault> {
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

/// Returns whether the model of a picture has findings, by the stamp of the picture.
fn has_findings(stamp: &str) -> bool {
    !stamp.ends_with(" 0")
}

/// Describes a file. `is_hashed` says whether a report needs its hash.
fn file_sum(file: &LayerFile, content: &[u8], is_hashed: bool) -> FileSum {
    FileSum {
        out: shown(&file.path),
        sha256: is_hashed.then(|| hash_of(content)),
        bytes: content.len() as u64,
    }
}

/// Iterates over the files of a picture in an archive: its layers, and its description.
fn member_paths(job: &Job) -> impl Iterator<Item = PathBuf> {
    let description = job.row.description(job.view());
    job.files.iter().map(|file| file.path.clone()).chain(description)
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

//! Makes files that take time: pictures with options, turntables, exports. A background thread
//! makes each file from a snapshot of the scene, with a progress bar and a way to cancel it.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use egui::{ColorImage, Context, Rect};

use super::App;
use crate::app::documents::picture_dialog::{PictureChoices, Purpose};
use crate::app::documents::wanted::Wanted;
use crate::app::drawing::images;
use crate::app::state::{Notice, State};
use crate::app::tasks::{Outcome, Task};
use crate::app::widgets::text::file_name;
use crate::picture_file::draw_into;
use marraztu_core::accuracy::{Settings, Shot};
use marraztu_core::edit::turntable::turned;
use marraztu_core::scene::View;
use marraztu_io::{self as io, Animation, AnimationWriter, Progress, Sources};
use marraztu_render::{Renderer, plan_frame, without_ground_while};

/// The outcome of making a file.
#[derive(Debug)]
pub(crate) enum Made {
    /// The file was written; with notes about it.
    Done(PathBuf, Vec<String>),
    Cancelled,
    /// The reason, as a sentence.
    Failed(String),
}

/// Files being made.
#[derive(Debug, Default)]
pub(crate) struct Making {
    pub(crate) tasks: Vec<Task<Made>>,
    /// The options of the picture, while the file is being chosen.
    choices: Option<PictureChoices>,
    /// A requested picture of the window.
    screenshot: Option<Screenshot>,
}

/// A picture of the window, and the file to save it to.
#[derive(Debug)]
struct Screenshot {
    path: PathBuf,
    /// Whether the picture was requested: not before all dialogs over the picture are closed.
    asked: bool,
    image: Arc<Mutex<Option<Arc<ColorImage>>>>,
}

impl App {
    /// Draws the picture as the still window shows it.
    pub(crate) fn draw_as_shown(&mut self, ctx: &Context, path: PathBuf) {
        let Some(size) = self.viewport.size() else { return };
        let samples = self.state.refined_to().unwrap_or(self.state.settings.samples);
        self.making.choices = Some(PictureChoices::new(Purpose::Picture, size, samples));
        self.make_picture(ctx, path);
    }

    /// Begins to make a picture with these options. Without a path, asks for the file.
    pub(crate) fn take_picture(
        &mut self,
        ctx: &Context,
        choices: PictureChoices,
        file: Option<PathBuf>,
    ) {
        self.making.choices = Some(choices);
        if let Some(path) = file {
            return self.make_picture(ctx, path);
        }
        match choices.purpose {
            Purpose::Picture => self.ask_file(ctx, Wanted::PictureWithOptionsTo, "picture.png"),
            Purpose::Turntable => self.ask_file(ctx, Wanted::TurntableTo, "turntable.gif"),
        }
    }

    /// Begins to make the picture or the turntable with the chosen options.
    pub(crate) fn make_picture(&mut self, ctx: &Context, path: PathBuf) {
        let Some(choices) = self.making.choices.take() else { return };
        let sources = self.state.sources();
        let may_save = sources.spare(&path).and_then(|()| match choices.purpose {
            Purpose::Picture if choices.transparent => io::check_alpha(&path),
            _ => Ok(()),
        });
        if let Err(error) = may_save {
            return self.dialogs.tell_fault(format!("{error}."));
        }
        // Overlays exist only in the window, so a picture of the window is saved.
        if choices.overlays {
            let image = Arc::default();
            self.making.screenshot = Some(Screenshot { path, asked: false, image });
            ctx.request_repaint();
            return;
        }
        let State { scene, view, settings, .. } = &self.state;
        let settings = Settings { samples: choices.samples, ..*settings };
        let shot = Shot::new(scene, view, &settings, choices.whole());
        let label = format!("Drawing {}", file_name(&path));
        self.make(ctx, label, move |progress| match choices.purpose {
            Purpose::Picture => picture(&path, &shot, choices.transparent, progress),
            Purpose::Turntable => turntable(&path, &shot, &choices, &sources, progress),
        });
    }

    /// Begins to export the scene.
    pub(crate) fn export_scene(&mut self, ctx: &Context, path: PathBuf) {
        let State { scene, view, .. } = &self.state;
        let (scene, view) = (scene.clone(), view.clone());
        let label = format!("Exporting {}", file_name(&path));
        let sources = self.state.sources();
        self.make(ctx, label, move |_| match io::export(&path, &scene, &view, &sources) {
            Ok(exported) => Made::Done(path, exported.notes),
            Err(error) => Made::Failed(error.to_string()),
        });
    }

    fn make(
        &mut self,
        ctx: &Context,
        label: String,
        work: impl FnOnce(&Progress) -> Made + Send + 'static,
    ) {
        match Task::start(ctx, label, work) {
            Ok(task) => self.making.tasks.push(task),
            Err(error) => self.refuse(format!("cannot start a thread to write files: {error}")),
        }
    }

    /// Reports finished files.
    pub(crate) fn hear_making(&mut self, ctx: &Context) {
        self.hear_screenshot(ctx);
        let mut made = Vec::new();
        self.making.tasks.retain(|task| match task.outcome() {
            Outcome::Running => true,
            Outcome::Done(outcome) => {
                made.push(outcome);
                false
            }
            Outcome::Lost => {
                let text = format!("{} failed because of a bug in the program", task.label);
                made.push(Made::Failed(text));
                false
            }
        });
        for outcome in made {
            match outcome {
                Made::Done(path, notes) => {
                    self.state.tell_saved(&path);
                    if !notes.is_empty() {
                        let text = format!("{} does not hold the whole scene", file_name(&path));
                        self.state.notices.push(Notice { text, details: notes, offer: None });
                    }
                }
                Made::Cancelled => self.state.tell(Some("Cancelled: no file was written".into())),
                Made::Failed(why) => self.dialogs.tell_fault(format!("{why}.")),
            }
        }
    }

    /// Requests a picture of the window, and saves it when it arrives.
    fn hear_screenshot(&mut self, ctx: &Context) {
        let Some(screenshot) = &mut self.making.screenshot else { return };
        if !screenshot.asked {
            if self.dialogs.is_open() {
                return;
            }
            screenshot.asked = true;
            let image = Arc::clone(&screenshot.image);
            let wake = ctx.clone();
            ctx.request_screenshot(move |shown| {
                *image.lock().unwrap_or_else(PoisonError::into_inner) = Some(shown);
                wake.request_repaint();
            });
            ctx.request_repaint();
            return;
        }
        let shown = screenshot.image.lock().unwrap_or_else(PoisonError::into_inner).take();
        let (Some(shown), Some(rect)) = (shown, self.viewport.rect()) else { return };
        let path = screenshot.path.clone();
        self.making.screenshot = None;
        match part_of(&shown, rect, ctx.pixels_per_point()) {
            Some(part) => self.save_these(&path, &part),
            None => self.refuse("the window could not be captured".to_owned()),
        }
    }

    fn save_these(&mut self, path: &Path, image: &ColorImage) {
        let saved = images::picture(image).map(|it| {
            self.state.sources().spare(path)?;
            io::save_picture(path, &it)
        });
        match saved {
            Some(Ok(())) => self.state.tell_saved(path),
            Some(Err(error)) => self.dialogs.tell_fault(format!("{error}.")),
            None => self.refuse("the window could not be captured".to_owned()),
        }
    }
}

/// Cuts the viewport out of a picture of the window.
fn part_of(shown: &ColorImage, rect: Rect, scale: f32) -> Option<ColorImage> {
    let inside = Rect::from_min_size(egui::Pos2::ZERO, shown.source_size);
    let whole = [shown.size[0], shown.size[1]].iter().all(|side| *side > 0);
    let fits = inside.width() <= 0.0 || inside.expand(1.0).contains_rect(rect);
    (whole && fits).then(|| shown.region(&rect, Some(scale)))
}

/// Draws a picture into a file.
fn picture(path: &Path, shot: &Shot, transparent: bool, progress: &Progress) -> Made {
    let save = |size, next: &mut io::NextBand<'_>| io::save_bands(path, size, transparent, next);
    match draw_into(shot, transparent, progress, save) {
        Ok((Ok(()), _)) => Made::Done(path.to_owned(), Vec::new()),
        Ok((Err(why), _)) => Made::Failed(why.to_string()),
        Err(io::Cancelled) => Made::Cancelled,
    }
}

/// Draws a turntable into a file.
fn turntable(
    path: &Path,
    shot: &Shot,
    choices: &PictureChoices,
    sources: &Sources,
    progress: &Progress,
) -> Made {
    match turn_into(path, shot, choices, sources, progress) {
        Ok(Some(notes)) => Made::Done(path.to_owned(), notes),
        Ok(None) => Made::Cancelled,
        Err(why) => Made::Failed(why),
    }
}

/// Does the work of [`turntable`]. Returns the notes about the file, or `None` if it was cancelled.
fn turn_into(
    path: &Path,
    shot: &Shot,
    choices: &PictureChoices,
    sources: &Sources,
    progress: &Progress,
) -> Result<Option<Vec<String>>, String> {
    let PictureChoices { frames, seconds, transparent, turn, .. } = *choices;
    let fail = |error: &dyn std::fmt::Display| error.to_string();
    let animation = Animation { size: shot.size, frames, seconds, transparent };
    let mut writer = AnimationWriter::begin(path, animation, sources).map_err(|it| fail(&it))?;
    let notes = writer.notes().to_vec();
    let mut renderer = Renderer::default();
    // Frames are written one by one, so memory holds a single picture.
    for i in 0..frames {
        let part = f64::from(i) / f64::from(frames);
        let scene = turned(&shot.scene, &shot.view, turn, part).map_err(|it| fail(&it))?;
        let view = View { time: shot.view.time + seconds * part, ..shot.view.clone() };
        let shot = Shot { scene, view, ..shot.clone() };
        let wanted = || !progress.is_cancelled();
        let drawn = if transparent {
            without_ground_while(&mut renderer, &shot, &wanted)
        } else {
            renderer.redraw(&plan_frame(&shot), &wanted).map(|_| renderer.picture().clone())
        };
        let Ok(picture) = drawn else { return Ok(None) };
        writer.push(&picture).map_err(|it| fail(&it))?;
        if progress.reached(i as usize + 1, frames as usize).is_err() {
            return Ok(None);
        }
    }
    writer.finish().map_err(|it| fail(&it))?;
    Ok(Some(notes))
}

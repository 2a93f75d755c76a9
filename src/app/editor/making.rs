//! Makes files that take time: pictures with options, turntables, exports. A background thread, or
//! another instance of the program where there are no threads, makes each file from a snapshot of
//! the scene, with a progress bar and a way to cancel it.

use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use egui::{ColorImage, Context, Rect};

use super::App;
use super::jobs::{Answers, Elsewhere, Job, so_far};
use super::orders::{Content, Made, Order};
use crate::app::documents::picture_dialog::{PictureChoices, Purpose};
use crate::app::documents::wanted::Wanted;
use crate::app::drawing::images;
use crate::app::state::{Notice, NoticeKind, State};
use crate::app::tasks::{Outcome, Task};
use crate::app::widgets::text::file_name;
use marraztu_io::{self as io, ExportOptions, Progress};

/// Files being made.
#[derive(Debug, Default)]
pub(crate) struct Making {
    pub(crate) tasks: Vec<Task<Made>>,
    /// The options of the picture, while the file is being chosen.
    choices: Option<PictureChoices>,
    /// A requested picture of the window.
    screenshot: Option<Screenshot>,
    /// The jobs for another instance, in order, with their progress. It does the first one.
    errands: VecDeque<(Elsewhere, Progress)>,
}

impl Making {
    /// Returns the next job for another instance, unless one is being done.
    pub(crate) fn take_job(&mut self) -> Option<Vec<u8>> {
        self.errands.front_mut()?.0.take_job()
    }

    /// Returns whether another instance makes a file.
    pub(crate) fn is_elsewhere(&self) -> bool {
        self.errands.front().is_some_and(|(job, _)| job.is_taken())
    }

    /// Takes what another instance tells.
    pub(crate) fn hear(&self, told: &str) {
        if let (Some((_, progress)), Some((fraction, _))) = (self.errands.front(), so_far(told)) {
            progress.set(fraction);
        }
    }

    /// Takes the end of the job of another instance.
    pub(crate) fn end_elsewhere(&mut self, end: &[u8]) {
        // The end of a cancelled job may come late.
        if self.is_elsewhere()
            && let Some((mut job, _)) = self.errands.pop_front()
        {
            job.end(end);
        }
    }

    /// Ends the jobs that were cancelled.
    fn drop_cancelled(&mut self) {
        self.errands.retain_mut(|(job, progress)| {
            if progress.is_cancelled() {
                job.cancel();
            }
            !progress.is_cancelled()
        });
    }
}

/// A picture of the window, and the file to save it to.
#[derive(Debug)]
struct Screenshot {
    path: PathBuf,
    /// Whether no dialog was open at the end of the last frame: such a frame may still show the
    /// dialog that it has closed.
    clear: bool,
    /// Whether the picture was requested: only in a frame that shows no dialog.
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
        let path = choices.target(path);
        let sources = self.state.sources();
        let may_save = sources.spare(&path).and_then(|()| match choices.purpose {
            Purpose::Picture if choices.transparent && !choices.overlays => io::check_alpha(&path),
            _ => Ok(()),
        });
        if let Err(error) = may_save {
            return self.dialogs.tell_fault(format!("{error}."));
        }
        // Overlays exist only in the window, so a picture of the window is saved.
        if choices.overlays {
            let image = Arc::default();
            self.making.screenshot = Some(Screenshot { path, clear: false, asked: false, image });
            ctx.request_repaint();
            return;
        }
        self.make(ctx, Order { path, content: Content::Drawn(choices) });
    }

    pub(crate) fn export(&mut self, ctx: &Context, path: PathBuf, options: ExportOptions) {
        self.make(ctx, Order { path, content: Content::Exported(options) });
    }

    fn make(&mut self, ctx: &Context, order: Order) {
        let State { scene, view, settings, .. } = &self.state;
        if self.draws_elsewhere
            && let Some(job) = Job::make((scene, view, settings), &order)
        {
            let (task, sender) = Task::promised(order.label());
            let progress = task.progress.clone();
            self.making.tasks.push(task);
            let job = Elsewhere::new(job, Answers::Made(sender));
            self.making.errands.push_back((job, progress));
            ctx.request_repaint();
            return;
        }
        let (of, sources) = ((scene.clone(), view.clone(), *settings), self.state.sources());
        let label = order.label();
        let work = move |progress: &Progress| order.fulfil(of, &sources, progress);
        match Task::start(ctx, label, work) {
            Ok(task) => self.making.tasks.push(task),
            Err(error) => self.refuse(format!("cannot start a thread to write files: {error}")),
        }
    }

    /// Reports finished files.
    pub(crate) fn hear_making(&mut self, ctx: &Context) {
        self.hear_screenshot(ctx);
        self.making.drop_cancelled();
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
                        self.state.notices.push(Notice::new(NoticeKind::Written, text).with(notes));
                    }
                }
                Made::Cancelled => self.state.tell(Some("Cancelled: no file was written".into())),
                Made::Partial(folder) => {
                    let folder = file_name(&folder);
                    self.state.tell(Some(format!("Cancelled: {folder} has the pictures so far")));
                }
                Made::Failed(why) => self.dialogs.tell_fault(format!("{why}.")),
            }
        }
    }

    /// Requests a picture of the window, and saves it when it arrives.
    fn hear_screenshot(&mut self, ctx: &Context) {
        let Some(screenshot) = &mut self.making.screenshot else { return };
        if !screenshot.asked {
            let is_clear = !self.dialogs.is_open();
            let was_clear = std::mem::replace(&mut screenshot.clear, is_clear);
            if !is_clear {
                return;
            }
            if !was_clear {
                return ctx.request_repaint();
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

#[cfg(test)]
mod tests {
    use super::*;
    use marraztu_core::accuracy::Settings;

    fn begin(making: &mut Making, name: &str) {
        let order =
            Order { path: PathBuf::from(name), content: Content::Exported(ExportOptions::SCENE) };
        let (scene, view) = marraztu_io::default_scene();
        let job = Job::make((&scene, &view, &Settings::default()), &order).unwrap();
        let (task, sender) = Task::promised(order.label());
        let progress = task.progress.clone();
        making.tasks.push(task);
        making.errands.push_back((Elsewhere::new(job, Answers::Made(sender)), progress));
    }

    #[test]
    fn files_are_made_elsewhere_one_after_the_other_and_cancelled_ones_not_at_all() {
        let mut making = Making::default();
        for name in ["a", "b", "c"] {
            begin(&mut making, name);
        }
        let is_of = |job: Option<Vec<u8>>, name: &str| {
            let job = job.map(|job| String::from_utf8(job).unwrap()).unwrap_or_default();
            job.contains(&format!("\"path\":\"{name}\""))
        };
        assert!(is_of(making.take_job(), "a") && making.is_elsewhere());
        assert_eq!(making.take_job(), None);
        // The next one waits, and is cancelled before its turn.
        making.tasks[1].progress.cancel();
        making.drop_cancelled();
        assert!(making.is_elsewhere() && making.take_job().is_none());
        assert!(matches!(making.tasks[1].outcome(), Outcome::Done(Made::Cancelled)));
        // The first one is lost.
        making.end_elsewhere(b"");
        assert!(matches!(making.tasks[0].outcome(), Outcome::Lost) && !making.is_elsewhere());
        assert!(is_of(making.take_job(), "c"));
        // The one that is being made is cancelled: the host stops it.
        making.tasks[2].progress.cancel();
        making.drop_cancelled();
        assert!(!making.is_elsewhere() && making.take_job().is_none());
        begin(&mut making, "d");
        making.end_elsewhere(b"");
        assert!(is_of(making.take_job(), "d"), "the end of the cancelled one is not its end");
    }
}

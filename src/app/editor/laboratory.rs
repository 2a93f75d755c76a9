//! Answers requests to the laboratory and runs its measurements on background threads. Without
//! threads, another instance of the program measures (see
//! [`jobs`](super::jobs)).
//!
//! During a measurement, the window is drawn at most four times a second, except right after keys
//! and clicks. Pairs of pictures that were timed while it was drawn are discarded.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use egui::Context;

use super::App;
use super::jobs::{Answers, Elsewhere, Job, so_far};
use crate::app::actions::LabRequest;
use crate::app::state::laboratory::Compare;
use crate::app::state::{DrawingChoices, State};
use crate::app::tasks::{Outcome, Task};
use marraztu_core::accuracy::{AXES, Axis, Settings};
use marraztu_core::base::image::Size;
use marraztu_core::edit::selection;
use marraztu_io as io;
use marraztu_lab::attribution::{Attribution, attribute};
use marraztu_lab::candidates::{Thoroughness, all_axes};
use marraztu_lab::pairs::{Touch, Unmeasured, Watch};
use marraztu_lab::picture_source::{PictureSource as _, Reference, Studio};
use marraztu_lab::report::Report;
use marraztu_lab::suite::{self, SUITE, SuiteDetail, SuiteScene};
use marraztu_lab::sweep::{Findings, Question, sweep};
use marraztu_lab::timing::WallClock;

/// The background work of the laboratory.
#[derive(Debug, Default)]
pub(crate) struct Work {
    watch: Watch,
    sweep: Option<Task<Result<Findings, Unmeasured>>>,
    suite: Option<Task<Result<Vec<Report>, Unmeasured>>>,
    /// When the first choice of the running measurement was done, and the progress then. What comes
    /// before takes another time.
    paced: Option<(Instant, f64)>,
    /// When the user last pressed something.
    pressed_at: Option<Instant>,
    /// The latest intermediate findings.
    so_far: Arc<Mutex<Option<Findings>>>,
    blame: Option<Task<Option<Explained>>>,
    /// The axis of a new lesson, and the size of the picture in the last frame: the axis is
    /// measured once the lesson's card has given the picture its final size.
    lesson: Option<(&'static Axis, Option<Size>)>,
    /// The command that repeats the measurement.
    command: String,
    /// When the window was last drawn.
    drawn_at: Option<Instant>,
    /// The measurement by another instance.
    pub(crate) elsewhere: Elsewhere,
}

/// The attributed error of a pixel, and the item at that pixel; `None` for the background.
type Explained = (Attribution, Option<String>);

/// The minimum time between two drawings of the window during a measurement. It is longer if a pair
/// of pictures takes longer.
const REST: Duration = Duration::from_millis(250);

/// The time after a press in which the window is not made to wait.
const USED: Duration = Duration::from_secs(1);

/// The number of pairs between two drawings of the window.
const PAIRS_BETWEEN: u32 = 3;

impl Work {
    /// Returns the time between two drawings of the window.
    fn rest_now(&self) -> Duration {
        REST.max(PAIRS_BETWEEN * self.watch.pair())
    }

    /// Returns the seconds that the running measurement will still take; `None` in the beginning.
    fn left(&mut self, fraction: f64) -> Option<f64> {
        if fraction <= 0.0 {
            self.paced = None;
            return None;
        }
        let (since, from) = *self.paced.get_or_insert_with(|| (Instant::now(), fraction));
        let (spent, done) = (since.elapsed().as_secs_f64(), fraction - from);
        (done > 0.0 && spent > 1.0).then(|| spent * (1.0 - fraction) / done)
    }

    /// Returns the progress of the running measurement.
    fn progress(&self) -> Option<&io::Progress> {
        let sweep = self.sweep.as_ref().map(|task| &task.progress);
        sweep.or_else(|| self.suite.as_ref().map(|task| &task.progress))
    }

    fn is_measuring(&self) -> bool {
        self.progress().is_some()
    }

    /// Cancels the running measurement.
    fn cancel(&mut self) {
        self.elsewhere.cancel();
        if let Some(progress) = self.progress() {
            progress.cancel();
        }
    }

    /// Returns a guard for drawing the window. Measurements made while it exists are invalid.
    pub(crate) fn touch(&self) -> Touch {
        self.watch.touch()
    }

    /// Returns the watch. Other threads report to it when they have drawn.
    pub(crate) fn watch(&self) -> Watch {
        self.watch.clone()
    }

    /// Waits until the window may be drawn again without disturbing a measurement. A window that is
    /// used answers at once, and the measurement takes longer.
    pub(crate) fn rest(&mut self, is_pressed: bool) {
        if is_pressed {
            self.pressed_at = Some(Instant::now());
        }
        let is_used = self.pressed_at.is_some_and(|at| at.elapsed() < USED);
        if self.is_measuring()
            && !self.elsewhere.is_awaited()
            && !is_used
            && let Some(rest) = self.drawn_at.and_then(|at| REST.checked_sub(at.elapsed()))
        {
            std::thread::sleep(rest);
        }
        self.drawn_at = Some(Instant::now());
    }

    /// Takes what another instance tells.
    pub(crate) fn hear(&self, told: &str) {
        let Some((fraction, findings)) = so_far(told) else { return };
        if let Some(progress) = self.progress() {
            progress.set(fraction);
        }
        if findings.is_some() {
            *self.so_far.lock().unwrap_or_else(PoisonError::into_inner) = findings;
        }
    }
}

/// Returns the command that repeats the measurement on the command line.
fn command(state: &State, size: Size, thoroughness: &Thoroughness) -> String {
    let file = match (&state.path, state.history.is_saved()) {
        (Some(path), true) => format!(" '{}'", path.display()),
        // The first scene, if unchanged, needs no file.
        (None, true) => String::new(),
        _ => " SCENE.marraztu".to_owned(),
    };
    let mut command = format!("marraztu lab{file} --size {}x{}", size.width, size.height);
    if thoroughness.word == Thoroughness::QUICK.word {
        command += " --quick";
    }
    for axis in AXES {
        let chosen = axis.chosen(&state.settings).word;
        if chosen != axis.default_choice().word {
            command += &format!(" --{} {chosen}", axis.key);
        }
    }
    command
}

impl App {
    pub(crate) fn answer_lab(&mut self, ctx: &Context, ask: LabRequest) {
        let lab = &mut self.state.lab;
        match ask {
            LabRequest::Measure(thoroughness) => self.sweep(ctx, thoroughness, all_axes()),
            LabRequest::MeasureAxis(key) => {
                let axes = Axis::named(key).into_iter().collect();
                self.sweep(ctx, Thoroughness::AXIS, axes);
            }
            LabRequest::Suite(detail) => self.measure_suite(ctx, detail),
            LabRequest::ShowSuite(place) => lab.shown_suite = place,
            LabRequest::Cancel => self.lab.cancel(),
            LabRequest::Judge(measure) => {
                lab.measure = measure;
                lab.budgets.error = None;
                self.tell_report();
            }
            LabRequest::Over(region) => {
                lab.region = region;
                self.tell_report();
            }
            LabRequest::Panel(key) => lab.panel = key,
            LabRequest::Budgets(budgets) => {
                lab.budgets = budgets;
                self.tell_report();
            }
            LabRequest::Compare(compare) => lab.compare = compare,
            LabRequest::Against(reference) => lab.reference = reference,
            LabRequest::Pick(picking) => lab.picking = picking,
            LabRequest::Attribute(at) => self.explain(ctx, at),
            LabRequest::ShowLesson(key) => self.show_lesson(key),
            LabRequest::Back => self.back_to_scene(),
        }
    }

    /// Starts to measure the picture in the viewport.
    fn sweep(&mut self, ctx: &Context, thoroughness: Thoroughness, axes: Vec<&'static Axis>) {
        let Some(size) = self.viewport.size().filter(|_| !self.lab.is_measuring()) else { return };
        let shot = self.state.shot(size);
        // The scene is kept to detect later that the results are out of date.
        let measured = Some(shot.clone());
        let only = (axes.len() == 1).then(|| axes[0].key);
        let DrawingChoices { refines, refined, .. } = self.state.drawing;
        let refined = refines.then_some(refined);
        let question = Question { current: shot.settings, axes, thoroughness, refined };
        let job = if self.draws_elsewhere { Job::sweep(&shot, &question) } else { None };
        // A cancelled sweep may still report findings, so each sweep has a separate cell.
        self.lab.so_far = Arc::default();
        let (watch, so_far) = (self.lab.watch(), Arc::clone(&self.lab.so_far));
        // Intermediate findings are shown while the sweep continues.
        let work = move |progress: &io::Progress| {
            let watch = watch.with(progress);
            let mut studio = Studio::watched(shot, progress.clone());
            let mut tell = |findings: &Findings| {
                *so_far.lock().unwrap_or_else(PoisonError::into_inner) = Some(findings.clone());
            };
            sweep(&mut studio, &question, &mut WallClock::default(), &watch, &mut tell)
        };
        let label = "Measuring".to_owned();
        let started = if let Some(job) = job {
            let (task, sender) = Task::promised(label);
            self.lab.elsewhere = Elsewhere::new(job, Answers::Sweep(sender));
            Ok(task)
        } else {
            Task::start(ctx, label, work)
        };
        match started {
            Ok(task) => {
                self.lab.sweep = Some(task);
                let mut command = command(&self.state, size, &thoroughness);
                if let Some(key) = only {
                    command += &format!(" --axes {key}");
                    self.state.lab.panel = Some(key);
                }
                self.state.tell(None);
                let lab = &mut self.state.lab;
                (lab.running, lab.failed, lab.report) = (Some(0.0), None, None);
                lab.is_rough = false;
                lab.shown_suite = None;
                lab.measured = measured;
                self.lab.command = command;
            }
            Err(error) => self.refuse(format!("cannot start a thread to measure: {error}")),
        }
    }

    fn measure_suite(&mut self, ctx: &Context, detail: SuiteDetail) {
        if self.lab.is_measuring() {
            return;
        }
        let watch = self.lab.watch();
        let work = move |progress: &io::Progress| {
            let scenes: Vec<&SuiteScene> = SUITE.iter().collect();
            let watch = watch.with(progress);
            suite::run(&scenes, &detail, &mut WallClock::default(), &watch, &mut |_| {})
        };
        let label = "Measuring the suite".to_owned();
        let started = if self.draws_elsewhere {
            let (task, sender) = Task::promised(label);
            self.lab.elsewhere = Elsewhere::new(Job::Suite, Answers::Suite(sender));
            Ok(task)
        } else {
            Task::start(ctx, label, work)
        };
        match started {
            Ok(task) => {
                self.lab.suite = Some(task);
                let lab = &mut self.state.lab;
                (lab.running, lab.failed) = (Some(0.0), None);
            }
            Err(error) => self.refuse(format!("cannot start a thread to measure: {error}")),
        }
    }

    /// Shows the progress of the running measurement.
    fn tell_progress(&mut self) {
        if let Some(fraction) = self.lab.progress().map(io::Progress::fraction) {
            let left = self.lab.left(fraction);
            (self.state.lab.running, self.state.lab.left) = (Some(fraction), left);
        }
    }

    fn hear_suite(&mut self, ctx: &Context) {
        let Some(task) = &self.lab.suite else { return };
        match task.outcome() {
            Outcome::Running => return ctx.request_repaint_after(self.lab.rest_now()),
            Outcome::Done(Ok(reports)) => {
                let lab = &mut self.state.lab;
                lab.shown_suite = (!reports.is_empty()).then_some(0);
                lab.suite = reports;
                self.tell_report();
            }
            Outcome::Done(Err(Unmeasured::Cancelled)) => {
                self.state.tell(Some("Measuring was cancelled".to_owned()));
            }
            Outcome::Done(Err(why)) => self.state.lab.failed = Some(why.to_string()),
            Outcome::Lost => {
                self.state.lab.failed = Some("this is a bug in the program".to_owned());
            }
        }
        self.lab.suite = None;
        self.state.lab.running = None;
    }

    /// Cancels all measurements of a scene that is replaced, perhaps only for a lesson.
    pub(crate) fn end_measuring(&mut self) {
        self.lab.cancel();
        let State { lab, plan, .. } = &mut self.state;
        if self.lab.sweep.is_some() {
            lab.is_rough = lab.report.is_some();
        }
        (lab.running, plan.measuring) = (None, false);
        (self.lab.sweep, self.lab.suite, self.lab.blame) = (None, None, None);
        self.lab.lesson = None;
        self.measuring = None;
    }

    /// Attributes the error at a pixel of the current picture.
    fn explain(&mut self, ctx: &Context, at: [usize; 2]) {
        self.state.lab.picking = false;
        let Some(size) = self.viewport.size() else { return };
        // The picture at rest, as it is compared and shown.
        let samples = self.state.refined_to().unwrap_or(self.state.settings.samples);
        let settings = Settings { samples, ..self.state.settings };
        let mut studio = Studio::new(self.state.shot(size));
        // The renderer draws the picture again to name the item at the pixel.
        let work = move |_: &io::Progress| {
            let blame = attribute(&mut studio, &settings, at)?;
            studio.draw(&settings);
            Some((blame, studio.seen(at)))
        };
        match Task::start(ctx, "Explaining a pixel".to_owned(), work) {
            Ok(task) => self.lab.blame = Some(task),
            Err(error) => self.refuse(format!("cannot start a thread to draw: {error}")),
        }
    }

    /// Handles the results of background work.
    pub(crate) fn hear_laboratory(&mut self, ctx: &Context) {
        self.measure_lesson(ctx);
        self.tell_progress();
        self.hear_blame();
        self.hear_suite(ctx);
        let Some(task) = &self.lab.sweep else { return };
        let outcome = task.outcome();
        let so_far = self.lab.so_far.lock().unwrap_or_else(PoisonError::into_inner).take();
        if let Some(findings) = so_far {
            self.show_findings(findings);
        }
        match outcome {
            Outcome::Running => return ctx.request_repaint_after(self.lab.rest_now()),
            Outcome::Done(Ok(findings)) => self.show_findings(findings),
            Outcome::Done(Err(Unmeasured::Cancelled)) => {
                self.state.tell(Some("Measuring was cancelled".to_owned()));
                self.state.lab.is_rough = self.state.lab.report.is_some();
            }
            Outcome::Done(Err(why)) => self.state.lab.failed = Some(why.to_string()),
            Outcome::Lost => {
                self.state.lab.failed = Some("this is a bug in the program".to_owned());
            }
        }
        self.lab.sweep = None;
        self.state.lab.running = None;
    }

    /// Starts to measure the axis of a new lesson if the size of the picture rests.
    fn measure_lesson(&mut self, ctx: &Context) {
        let size = self.viewport.size();
        match &mut self.lab.lesson {
            Some((axis, last)) if last.is_some() && *last == size => {
                let axes = vec![*axis];
                self.lab.lesson = None;
                self.sweep(ctx, Thoroughness::AXIS, axes);
            }
            Some((_, last)) => {
                *last = size;
                ctx.request_repaint();
            }
            None => {}
        }
    }

    fn hear_blame(&mut self) {
        let Some(task) = &self.lab.blame else { return };
        match task.outcome() {
            Outcome::Running => return,
            Outcome::Done(Some((blame, seen))) => {
                let mut lines = blame.lines();
                lines
                    .insert(1, format!("  shows  {}", seen.as_deref().unwrap_or("the background")));
                self.state.lab.attribution = Some(lines);
            }
            Outcome::Done(None) | Outcome::Lost => {
                self.refuse("the error of this pixel could not be attributed".to_owned());
            }
        }
        self.lab.blame = None;
    }

    fn show_findings(&mut self, findings: Findings) {
        let unnamed = if self.state.lab.away { "the scene of a lesson" } else { "this scene" };
        let scene = self.state.file_name().unwrap_or_else(|| unnamed.to_owned());
        let lab = &mut self.state.lab;
        let report = Report {
            scene,
            command: self.lab.command.clone(),
            measure: lab.measure,
            region: lab.region,
            budgets: lab.budgets,
            findings,
        };
        // A lesson quotes figures of its own scene.
        if lab.away {
            lab.note_costs(&report);
        }
        lab.report = Some(report);
    }

    /// Updates the report to the chosen error metric and budgets.
    fn tell_report(&mut self) {
        let lab = &mut self.state.lab;
        if let Some(report) = &mut lab.report {
            report.measure = lab.measure;
            (report.region, report.budgets) = (lab.region, lab.budgets);
        }
    }

    /// Shows the lesson on an axis in its scene, with the settings that show its effect best, and
    /// sets the user's scene aside. The choices of the axis are measured, for the lesson to quote.
    pub(crate) fn show_lesson(&mut self, key: &str) {
        let Some(axis) = Axis::named(key) else { return };
        let lesson = io::lesson_on(axis);
        match io::lesson_scene(&lesson.scene) {
            Ok(opened) => {
                let settings = lesson.settings();
                let mut state = State { settings, ..State::new(opened.scene, opened.view) };
                selection::settle(&state.scene, &mut state.view);
                state.lab.lesson = Some(lesson);
                state.lab.compare = compare_of(axis);
                state.lab.reference = Reference::Alone(axis);
                state.lab.away = true;
                state.lab.costs.clone_from(&self.state.lab.costs);
                // A lesson opened from a lesson keeps the user's scene, not the lesson's.
                let own = self.replace(state);
                if !own.lab.away {
                    self.waiting_scene = Some(Box::new(own));
                }
                if !self.state.lab.costs.contains_key(axis.key) {
                    self.lab.lesson = Some((axis, None));
                }
            }
            Err(error) => self.dialogs.tell_fault(format!("{error}.")),
        }
    }

    /// Returns from the scene of a lesson to the user's scene, with its complete state.
    pub(crate) fn back_to_scene(&mut self) {
        let Some(mut own) = self.waiting_scene.take() else { return };
        own.lab.costs = std::mem::take(&mut self.state.lab.costs);
        own.tell(Some("Back in your scene".to_owned()));
        self.replace(*own);
    }
}

/// Returns the comparison for a lesson: an error of one step is visible only if amplified.
fn compare_of(axis: &Axis) -> Compare {
    match axis.key {
        "rounding" => Compare::Error(256),
        // The edge of the shadow lies in the left half of the picture.
        "terminator" => Compare::Split(0.2),
        _ => Compare::Split(0.5),
    }
}

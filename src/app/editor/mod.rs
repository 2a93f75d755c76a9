//! The editor: shows everything, and answers all requests at the end of the frame.
//!
//! Only [`App::perform`] turns an action into a command or another view. Only [`App::change`] and
//! [`App::navigate`] write the scene.

mod clipboard;
mod comparing;
mod dialling;
mod escaping;
mod explaining;
mod exposing;
mod files;
mod first_models;
pub(crate) mod jobs;
mod keeping;
mod laboratory;
mod making;
mod measuring;
mod missing;
mod noticing;
mod orders;
mod preferences;
mod presenting;
mod reloading;
mod requests;
mod scenes;
mod selecting;
mod turning;
mod unseen;
mod viewing;
mod walking;

use std::collections::VecDeque;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use egui::{Context, Event, UiBuilder, ViewportCommand};

use crate::app::actions::Requests;
use crate::app::documents::dialogs::Dialogs;
#[cfg(feature = "desktop")]
use crate::app::documents::dialogs::Parent;
use crate::app::documents::loading::{Loading, Queued};
use crate::app::documents::wanted::After;
use crate::app::drawing::motion::{Happening, Motion};
use crate::app::drawing::snapshot::{DrawOptions, Snapshot};
use crate::app::drawing::worker::Worker;
use crate::app::fonts;
use crate::app::input::keyboard::{Keyboard, Press};
use crate::app::panels::{Panel, arrange, notices, pixel};
use crate::app::state::layout::NARROW;
use crate::app::state::{Late, Notice, NoticeKind, State};
use crate::app::theme;
use crate::app::viewport::comparison::Comparison;
use crate::app::viewport::{Purpose, Viewport};
use crate::app::widgets::number::take_bad_text;
use crate::app::widgets::tooltips;
use explaining::Explaining;
use jobs::Elsewhere;
use keeping::Keeping;
use laboratory::Work;
use making::Making;
use marraztu_core::accuracy::AccuracyPreset;
use marraztu_core::scene::{Scene, Steps, View};
use marraztu_io::{OwnFolders, Preferences, default_scene};
use measuring::Measuring;
use reloading::Watch;
use unseen::Searches;

/// The preferences, a notice about reading them, and the folders of the program's files.
pub(crate) type Kept = ((Preferences, Option<String>), OwnFolders);

/// The editor.
#[derive(Debug)]
pub struct App {
    pub(crate) state: State,
    pub(crate) dialogs: Dialogs,
    pub(crate) loading: Vec<Loading>,
    pub(crate) searches: Searches,
    /// Files being made.
    pub(crate) making: Making,
    /// The comparison by another instance.
    pub(crate) comparing: Elsewhere,
    /// Files waiting to be read.
    pub(crate) queued: VecDeque<Queued>,
    /// The scenes that are read after this frame, for a host that has to provide their files.
    pub(crate) opening: Vec<PathBuf>,
    /// The view of models that open alone: degrees to the right of the front, and up.
    pub(crate) models_from: Option<[f64; 2]>,
    pub(crate) viewport: Viewport,
    /// The number of changes so far, with those undone and redone.
    pub(crate) changes: u64,
    /// The user's scene, while the scene of a lesson is shown.
    pub(crate) waiting_scene: Option<Box<State>>,
    pub(crate) lab: Work,
    pub(crate) comparison: Comparison,
    /// Draws the viewport; started by the first frame.
    pub(crate) worker: Option<Worker<Purpose>>,
    /// Whether another instance of the program draws the viewport.
    pub(crate) draws_elsewhere: bool,
    /// Key presses that wait for the answer to a click.
    pub(crate) pressed: Vec<Press>,
    /// The running measurement of effects.
    pub(crate) measuring: Option<Measuring>,
    /// The pixel being explained.
    pub(crate) explaining: Option<Explaining>,
    /// The time until which another Esc quits the program.
    quits_until: Option<f64>,
    /// Whether the window is closing.
    leaving: bool,
    /// Whether the picture is changing.
    motion: Motion,
    /// The time of the last frame with an animated scene.
    moved_at: Option<f64>,
    /// When the key of the loupe was pressed, while it is held.
    loupe_held: Option<f64>,
    /// The times of the pictures of the last second.
    shown_at: VecDeque<f64>,
    title: String,
    /// The step sizes of the first scene, after models have replaced it.
    first_steps: Option<Steps>,
    /// The program's files, if it keeps any.
    keeping: Option<Keeping>,
    /// The files that are read again when they change.
    watch: Option<Watch>,
    /// The number of consecutive failed frames.
    faults: u32,
}

impl App {
    /// Creates an editor of this scene.
    pub fn new(scene: Scene, view: View) -> Self {
        Self {
            state: State::new(scene, view),
            dialogs: Dialogs::default(),
            loading: Vec::new(),
            searches: Searches::default(),
            making: Making::default(),
            comparing: Elsewhere::default(),
            queued: VecDeque::new(),
            opening: Vec::new(),
            models_from: None,
            viewport: Viewport::default(),
            changes: 0,
            waiting_scene: None,
            lab: Work::default(),
            comparison: Comparison::default(),
            worker: None,
            draws_elsewhere: false,
            pressed: Vec::new(),
            measuring: None,
            explaining: None,
            quits_until: None,
            leaving: false,
            motion: Motion::default(),
            moved_at: None,
            loupe_held: None,
            shown_at: VecDeque::new(),
            title: String::new(),
            first_steps: None,
            keeping: None,
            watch: None,
            faults: 0,
        }
    }

    /// Creates the editor of the first scene in a window that has shown no frame yet. It uses the
    /// system's file dialogs, and keeps its own files in folders, if there are any.
    pub(crate) fn start(ctx: &Context, own: Option<Kept>) -> Self {
        // The theme and the fonts are needed for the first frame.
        theme::install(ctx);
        // A page has no fonts of the system.
        if !cfg!(target_family = "wasm") {
            fonts::install(ctx);
        }
        let (scene, view) = default_scene();
        let mut app = Self::new(scene, view);
        app.dialogs.native = true;
        if let Some(((preferences, said), folders)) = own {
            app.keep_in(ctx, folders, preferences, said);
        }
        app
    }

    /// Loads files, or shows the greeting without any.
    pub(crate) fn open_at_start(&mut self, ctx: &Context, files: Vec<PathBuf>) {
        if files.is_empty() {
            self.greet();
        }
        self.load_at_start(ctx, files);
    }

    /// Returns the scene being edited, and everything shown about it.
    pub const fn state(&self) -> &State {
        &self.state
    }

    /// Draws with the accuracy of a preset.
    pub fn use_preset(&mut self, preset: &AccuracyPreset) {
        self.state.settings = preset.of(&self.state.settings);
    }

    /// Shows the greeting until the first change.
    pub const fn greet(&mut self) {
        self.state.greeting = true;
    }

    /// Hides the greeting after the first action.
    fn end_greeting(&mut self) {
        let State { history, path, lab, panels, .. } = &self.state;
        // A lesson keeps it for the time after.
        let has_begun = history.position() > 0 || path.is_some() || panels.has(Panel::Laboratory);
        if !lab.away && has_begun || !self.loading.is_empty() {
            self.state.greeting = false;
        }
    }

    /// Shows the editor, and answers all requests.
    pub fn editor_ui(&mut self, ui: &mut egui::Ui) {
        let ctx = ui.ctx().clone();
        let mut requests = Vec::new();
        self.note_dial();
        let now = ctx.input(|input| input.time);
        let clicked = self.viewport.click_wait(now).is_some();
        // Without threads, no measurement runs while the window is drawn.
        let _touch = (!cfg!(target_family = "wasm")).then(|| self.lab.touch());
        self.begin(&ctx, &mut requests);
        self.state.zoom = ctx.zoom_factor();
        self.state.asking = self.dialogs.system_title();
        self.state.narrow = ui.available_width() < NARROW;
        // Panels and the viewport read the state and collect requests; they change nothing.
        let arrangement = arrange::show(ui, &self.state, &mut requests);
        let place = arrangement.picture();
        if let Some(worker) = &self.worker {
            let mut ui = ui.new_child(UiBuilder::new().id_salt("picture").max_rect(place));
            ui.set_clip_rect(place.intersect(ui.clip_rect()));
            self.viewport.ui(&ui, &self.state, worker, &mut requests);
            if let Some(rect) = self.viewport.rect() {
                self.comparison.ui(&ui, rect, &self.state, &mut requests);
            }
        }
        self.start_searches(&ctx);
        arrangement.over_picture_ui(ui, &self.state, &mut requests);
        if !self.state.picture_only {
            let (state, loading) = (&self.state, &self.loading);
            notices::show((&ctx, place), state, loading, &self.making.tasks, &mut requests);
            pixel::show(&ctx, state, place, &mut requests);
        }
        // The dialogs come last, over everything else. A page that shows only the picture reports
        // errors itself.
        let answer = if self.state.picture_only { None } else { self.dialogs.ui(&ctx) };
        let pressed = Keyboard::take(&ctx);
        if Keyboard::take_escaped(&ctx) {
            self.forget_quitting();
        }

        // Requests are answered last, so everything in a frame shows the same scene.
        if !requests.is_empty() || !pressed.is_empty() || answer.is_some() {
            ctx.request_repaint();
        }
        if let Some(text) = take_bad_text(&ctx) {
            self.refuse(format!("\"{text}\" is not valid here: the field keeps its value"));
        }
        if let Some(text) = fonts::take_missing(&ctx) {
            self.state.notices.push(Notice::new(NoticeKind::Program, text));
        }
        // Keys after a click wait until the click has selected something.
        let waits = clicked || self.viewport.click_wait(now).is_some();
        self.pressed.extend(pressed);
        if !waits {
            self.press_all(&ctx);
        }
        for request in requests {
            self.answer(&ctx, request);
        }
        match self.viewport.click_wait(now) {
            None => self.press_all(&ctx),
            Some(rest) => ctx.request_repaint_after(Duration::from_secs_f64(rest)),
        }
        if let Some(answer) = answer {
            self.take_answer(&ctx, answer);
        }
        // Then the results of background work arrive, and new work begins.
        self.end_quitting(&ctx);
        self.end_greeting();
        self.hear_loading(&ctx);
        self.hear_making(&ctx);
        self.withdraw_notices();
        self.hear_searches();
        self.hear_measuring();
        self.hear_explaining(&ctx);
        self.hear_laboratory(&ctx);
        self.compare(&ctx);
        self.take_dropped(&ctx);
        self.watch_files(&ctx);
        self.close_requested(&ctx);
        self.keep(&ctx);
        self.draw(&ctx);
        self.name_window(&ctx);
    }

    /// Waits until the picture of the current scene is drawn and all its picks are answered.
    /// The next frame shows it.
    pub fn wait_for_picture(&self) {
        if let Some(worker) = &self.worker {
            worker.wait();
        }
    }

    /// Returns whether objects that are not visible are being searched for.
    pub fn is_searching(&self) -> bool {
        self.searches.are_running()
    }

    /// Waits until the picture is refined as far as it will be.
    /// The next frame shows it.
    pub fn wait_until_refined(&self) {
        if let Some(worker) = &self.worker {
            worker.wait_until_refined();
        }
    }

    /// Prepares a frame: takes the worker's results, advances the clock, reads the screen.
    fn begin(&mut self, ctx: &Context, requests: &mut Requests) {
        if self.worker.is_none() {
            Keyboard::install(ctx);
            tooltips::install(ctx);
            // Quitting and zooming are actions of the table, so egui's shortcuts are disabled.
            ctx.options_mut(|options| {
                options.quit_shortcuts.clear();
                options.zoom_with_keyboard = false;
            });
            let waker = ctx.clone();
            let watch = self.lab.watch();
            let wake = move || {
                // A picture was drawn, so measurements made meanwhile are discarded.
                drop(watch.touch());
                waker.request_repaint();
            };
            let started = if self.draws_elsewhere {
                Ok(Worker::elsewhere(wake))
            } else {
                Worker::start(wake)
            };
            match started {
                Ok(worker) => self.worker = Some(worker),
                Err(error) => self.refuse(format!("cannot start a thread to draw: {error}")),
            }
        }
        if let Some(worker) = &self.worker {
            let news = worker.news();
            // The rate counts the pictures of the last second.
            if let Some(drawn) = &news.drawn {
                let now = ctx.input(|input| input.time);
                self.shown_at.push_back(now);
                self.shown_at.retain(|then| now - then < 1.0);
                let rate = u32::try_from(self.shown_at.len()).unwrap_or(u32::MAX);
                self.state.statistics.note(drawn, rate);
            }
            if let Some(figures) = &news.dial {
                self.state.dial.last = Some(figures.clone());
            }
            if let Some(explained) = &news.explained {
                self.state.plan.explained = Some(Arc::clone(explained));
            }
            if let Some(refined) = &news.refined {
                self.state.statistics.refined = refined.refined;
            }
            if news.drawn.is_some() {
                self.state.dial.drawn = worker.last().map(|last| last.shot.settings);
            }
            let late = worker.drawing_for().filter(|time| *time >= LATE);
            let late = late.filter(|_| !self.state.is_animated());
            let fraction = worker.painted();
            self.state.statistics.late = late.map(|spent| Late { spent, fraction });
            if late.is_some() {
                ctx.request_repaint_after(LATE);
            }
            let failed = news.failed;
            self.viewport.hear(ctx, &self.state, news, requests);
            if failed {
                self.refuse("the picture could not be drawn: this is a bug in the program".into());
            }
        }
        self.tick(ctx);
        self.release_loupe(ctx);
        // On a high-density screen, a line of one pixel is hardly visible.
        self.state.view.wide_lines = ctx.pixels_per_point() >= 1.5;
    }

    /// Advances the clock of an animated scene. Each new picture wakes the window, so the clock
    /// runs no faster than pictures are drawn.
    fn tick(&mut self, ctx: &Context) {
        let now = ctx.input(|input| input.time);
        let last = self.moved_at.take();
        if self.state.is_animated() {
            self.state.view.time += last.map_or(0.0, |last| (now - last).max(0.0));
            self.moved_at = Some(now);
        }
    }

    /// Requests the picture of the current scene, at reduced quality while it moves.
    fn draw(&mut self, ctx: &Context) {
        let (Some(worker), Some(size)) = (&mut self.worker, self.viewport.size()) else { return };
        let coarse = self.state.coarse_while_moving;
        let options = DrawOptions {
            moving: false,
            coarse,
            budget: Duration::from_millis(self.state.drawing.budget_ms.into()),
            refined: self.state.refined_to(),
            dial: self.state.wanted_dial(),
            explain: self.state.panels.has(Panel::Plan),
            outlined: self.state.outlined(),
        };
        let mut wanted = Snapshot { shot: self.state.shot(size), options };
        // Input interrupts the refinement, even if the picture does not change.
        let (now, held) = ctx.input(|input| (input.time, input.pointer.any_down()));
        if held || ctx.input(|input| !input.events.is_empty()) {
            worker.stir();
        }
        let changed = worker.last().is_none_or(|last| wanted.differs_from(last));
        // An animated scene is always being drawn.
        let drawing = worker.is_drawing() && !self.state.is_animated();
        let happening = Happening { changed, held, drawing };
        let moving = self.motion.notice(now, happening);
        wanted.options.moving = moving && coarse;
        if let Some(rest) = self.motion.rest(now) {
            ctx.request_repaint_after(Duration::from_secs_f64(rest));
        }
        // If drawing takes long, a repaint shows that in the status line.
        worker.draw(wanted);
        if worker.is_drawing() {
            let rest = LATE.saturating_sub(worker.drawing_for().unwrap_or_default());
            if !rest.is_zero() {
                ctx.request_repaint_after(rest);
            }
        }
    }

    /// Returns whether the picture of the scene is drawn, and nothing moves.
    fn is_at_rest(&self, ctx: &Context) -> bool {
        let (now, held) = ctx.input(|input| (input.time, input.pointer.any_down()));
        let drawing = self.worker.as_ref().is_some_and(Worker::is_drawing);
        !held && !drawing && self.motion.rest(now).is_none()
    }

    fn name_window(&mut self, ctx: &Context) {
        let mark = if self.state.history.is_saved() { "" } else { "*" };
        let name = self.state.file_name();
        let title = format!("{}{mark} - Marraztu", name.as_deref().unwrap_or("new scene"));
        if title != self.title {
            ctx.send_viewport_cmd(ViewportCommand::Title(title.clone()));
            self.title = title;
        }
    }

    /// Continues with `after`, or asks first if there are unsaved changes. The user's scene
    /// replaces the scene of a lesson first.
    pub(crate) fn unless_unsaved(&mut self, ctx: &Context, after: After) {
        self.back_to_scene();
        if self.state.history.is_saved() {
            self.after(ctx, after);
        } else {
            self.dialogs.ask_unsaved(after);
        }
    }

    /// Returns whether the user's scene is saved, even while the scene of a lesson is shown.
    pub(crate) fn is_all_saved(&self) -> bool {
        let own = self.waiting_scene.as_deref().unwrap_or(&self.state);
        own.history.is_saved()
    }

    /// Closes the program.
    pub(crate) fn leave(&mut self, ctx: &Context) {
        self.leaving = true;
        ctx.send_viewport_cmd(ViewportCommand::Close);
    }

    /// Handles the close button of the window.
    fn close_requested(&mut self, ctx: &Context) {
        if ctx.input(|input| input.viewport().close_requested())
            && !self.leaving
            && !self.is_all_saved()
        {
            self.back_to_scene();
            ctx.send_viewport_cmd(ViewportCommand::CancelClose);
            self.dialogs.ask_unsaved(After::Quit);
        }
    }
}

impl App {
    /// Shows a frame. A panic costs one frame, not the user's work, unless every frame panics.
    pub(crate) fn frame(&mut self, ui: &mut egui::Ui) {
        let is_press =
            |event: &Event| matches!(event, Event::Key { .. } | Event::PointerButton { .. });
        self.lab.rest(ui.input(|input| input.events.iter().any(is_press)));
        match catch_unwind(AssertUnwindSafe(|| self.editor_ui(ui))) {
            Ok(()) => self.faults = 0,
            Err(fault) if self.faults >= MOST_FAULTS => resume_unwind(fault),
            Err(_) => {
                self.faults += 1;
                self.dialogs.tell_fault(FAULT.to_owned());
                ui.ctx().request_repaint();
            }
        }
    }

    /// Shows a frame in a window that is the parent of system dialogs.
    #[cfg(feature = "desktop")]
    pub(crate) fn frame_within(&mut self, ui: &mut egui::Ui, parent: &dyn Parent) {
        self.frame(ui);
        self.dialogs.open_system(ui.ctx(), parent);
    }

    /// Ends after the window was asked to close and the editor did not object. Not called if the
    /// window is lost with its display or by a fault.
    #[cfg(feature = "desktop")]
    pub(crate) fn end(&mut self) {
        self.end_keeping();
        // Dropping the worker waits for its thread, which must not run while the program ends.
        self.worker = None;
    }
}

/// The number of consecutive failed frames after which the program gives up.
const MOST_FAULTS: u32 = 10;

/// The time after which the status line reports that a picture is being drawn.
const LATE: Duration = Duration::from_millis(300);

const FAULT: &str = "This is a bug in the program. Your last action may not have been done; \
    everything else is unchanged. Save the scene now.";

//! The editor: it shows everything, and at the end of the frame does what was asked for.
//!
//! [`App::perform`] alone makes of an action a command or another view, and [`App::change`] alone
//! writes the scene.

use std::collections::VecDeque;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::Arc;
use std::time::Duration;

use egui::{CentralPanel, Context, Frame, Key, ThemePreference, ViewportCommand};

use super::action::Action;
use super::ask::Ask;
use super::chord::Chord;
use super::comparison::Comparison;
use super::decide::{Meaning, decide};
use super::dialogs::{After, Dialogs, Wanted};
use super::files::{Loading, Queued};
use super::keyboard::{Keyboard, Press};
use super::laboratory::Work;
use super::material_dialog::MaterialDialog;
use super::measuring::Measuring;
use super::pace::{Happening, Motion};
use super::painter::Snapshot;
use super::scene_files::Waiting;
use super::state::{Message, Offer, Shown, State, Tone};
use super::viewport::{Purpose, Viewport};
use super::visibility::Search;
use super::worker::Worker;
use super::{notices, panels};
use crate::edit::selection::{self, Selection};
use crate::edit::{Gesture, items};
use crate::scene::{Command, LeaveOut, Scene, Subject, View};

/// The editor.
#[derive(Debug)]
pub struct App {
    pub(super) state: State,
    pub(super) dialogs: Dialogs,
    pub(super) loading: Vec<Loading>,
    pub(super) searches: Vec<Search>,
    /// Files that are read after these.
    pub(super) queued: VecDeque<Queued>,
    /// A scene whose models are not where it says.
    pub(super) waiting: Option<Waiting>,
    pub(super) viewport: Viewport,
    pub(super) lab: Work,
    pub(super) comparison: Comparison,
    worker: Option<Worker<Purpose>>,
    /// The measuring of effects that goes on.
    pub(super) measuring: Option<Measuring>,
    /// It was decided to leave: nothing more is asked.
    leaving: bool,
    /// Whether what is shown is on the move.
    motion: Motion,
    /// When the last frame was shown in which something moved by itself.
    moved_at: Option<f64>,
    /// When the pictures of the last second were shown.
    shown_at: VecDeque<f64>,
    title: String,
    /// How many frames failed one after the other.
    faults: u32,
}

impl App {
    /// An editor of this scene.
    #[must_use]
    pub fn new(scene: Scene, view: View) -> Self {
        Self {
            state: State::new(scene, view),
            dialogs: Dialogs::default(),
            loading: Vec::new(),
            searches: Vec::new(),
            queued: VecDeque::new(),
            waiting: None,
            viewport: Viewport::default(),
            lab: Work::default(),
            comparison: Comparison::default(),
            worker: None,
            measuring: None,
            leaving: false,
            motion: Motion::default(),
            moved_at: None,
            shown_at: VecDeque::new(),
            title: String::new(),
            faults: 0,
        }
    }

    /// What is edited and shown.
    #[must_use]
    pub const fn state(&self) -> &State {
        &self.state
    }

    /// Files are asked for with the system's own dialogs, where it has any.
    pub(super) const fn use_system_dialogs(&mut self) {
        self.dialogs.native = true;
    }

    /// Shows the editor, and does what the user asks of it.
    pub fn editor_ui(&mut self, ui: &mut egui::Ui) {
        let ctx = ui.ctx().clone();
        let mut asks = Vec::new();
        let _touch = self.lab.touch();
        Keyboard::begin(&ctx);
        self.begin(&ctx, &mut asks);
        panels::show(ui, &self.state, &mut asks);
        if let Some(worker) = &self.worker {
            CentralPanel::default().frame(Frame::NONE).show(ui, |ui| {
                self.viewport.ui(ui, &self.state, worker, &mut asks);
                if let Some(rect) = self.viewport.rect() {
                    self.comparison.ui(ui, rect, &self.state, &mut asks);
                }
            });
        }
        notices::show(&ctx, &self.state, &self.loading, &mut asks);
        let answer = self.dialogs.ui(&ctx);
        let pressed = Action::pressed(&ctx);

        // Last, so that everything that is shown in a frame shows the same scene.
        if !asks.is_empty() || !pressed.is_empty() || answer.is_some() {
            ctx.request_repaint();
        }
        for press in pressed {
            self.press(&ctx, press);
        }
        for ask in asks {
            self.answer_ask(&ctx, ask);
        }
        if let Some(answer) = answer {
            self.take_answer(&ctx, answer);
        }
        self.hear_loading(&ctx);
        self.hear_searches();
        self.hear_measuring();
        self.hear_laboratory(&ctx);
        self.compare(&ctx);
        self.take_dropped(&ctx);
        self.close_requested(&ctx);
        self.draw(&ctx);
        self.name_window(&ctx);
    }

    /// Waits until the picture of what is edited now is drawn, and everything asked of it answered.
    /// The next frame shows it.
    pub fn wait_for_picture(&self) {
        if let Some(worker) = &self.worker {
            worker.wait();
        }
    }

    /// What comes before anything is shown: the thread's news, the clock, the screen.
    fn begin(&mut self, ctx: &Context, asks: &mut Vec<Ask>) {
        if self.worker.is_none() {
            Keyboard::install(ctx);
            // Leaving is an action like the others.
            ctx.options_mut(|options| options.quit_shortcuts.clear());
            let waker = ctx.clone();
            let watch = self.lab.watch();
            let wake = move || {
                // A picture was drawn: what was measured meanwhile means nothing.
                drop(watch.touch());
                waker.request_repaint();
            };
            match Worker::start(wake) {
                Ok(worker) => self.worker = Some(worker),
                Err(error) => self.refuse(format!("no thread to draw with: {error}")),
            }
        }
        if let Some(worker) = &self.worker {
            let news = worker.news();
            if let Some(drawn) = &news.drawn {
                let now = ctx.input(|input| input.time);
                self.shown_at.push_back(now);
                self.shown_at.retain(|then| now - then < 1.0);
                let rate = u32::try_from(self.shown_at.len()).unwrap_or(u32::MAX);
                self.state.statistics.note(drawn, rate);
            }
            if let Some(explained) = &news.explained {
                self.state.plan.explained = Some(Arc::clone(explained));
            }
            let failed = news.failed;
            self.viewport.hear(ctx, &self.state, news, asks);
            if failed {
                self.refuse(
                    "the picture could not be drawn: this is a fault of the program".into(),
                );
            }
        }
        self.tick(ctx);
        // On a screen of high density a line of one pixel can hardly be seen.
        self.state.view.wide_lines = ctx.pixels_per_point() >= 1.5;
    }

    /// Lets the scene's clock go on while anything moves by itself. The next picture wakes the
    /// window again, so that it runs no faster than pictures can be drawn.
    fn tick(&mut self, ctx: &Context) {
        let now = ctx.input(|input| input.time);
        let last = self.moved_at.take();
        if self.state.is_animated() {
            self.state.view.time += last.map_or(0.0, |last| (now - last).max(0.0));
            self.moved_at = Some(now);
        }
    }

    /// Wants the picture of what there is now; while it moves, and soon after, a coarser one will do.
    fn draw(&mut self, ctx: &Context) {
        let (Some(worker), Some(size)) = (&mut self.worker, self.viewport.size()) else { return };
        let State { scene, view, settings, .. } = &self.state;
        let (scene, view, settings) = (scene.clone(), view.clone(), *settings);
        let mut wanted =
            Snapshot { scene, view, settings, size, moving: false, explain: self.state.shown.plan };
        let (now, held) = ctx.input(|input| (input.time, input.pointer.any_down()));
        let changed = worker.last().is_none_or(|last| wanted.differs_from(last));
        // What moves by itself is always being drawn.
        let drawing = worker.is_drawing() && !self.state.is_animated();
        let happening = Happening { changed, held, drawing };
        let moving = self.motion.notice(now, happening);
        wanted.moving = moving && wanted.view.coarse_while_moving;
        if let Some(rest) = self.motion.rest(now) {
            ctx.request_repaint_after(Duration::from_secs_f64(rest));
        }
        worker.draw(wanted);
    }

    fn name_window(&mut self, ctx: &Context) {
        let mark = if self.state.history.is_saved() { "" } else { "*" };
        let title = format!("{}{mark} - Marraztu", self.state.file_name());
        if title != self.title {
            ctx.send_viewport_cmd(ViewportCommand::Title(title.clone()));
            self.title = title;
        }
    }

    /// A key. Esc puts away what is open before it leaves.
    fn press(&mut self, ctx: &Context, press: Press) {
        if press.chord == Chord::Named(Key::Escape) {
            let mut asks = Vec::new();
            if self.viewport.cancel_drag(&mut asks) {
                return asks.into_iter().for_each(|ask| self.answer_ask(ctx, ask));
            }
            if std::mem::take(&mut self.state.shown.cheat_sheet)
                || self.state.renaming.take().is_some()
            {
                return;
            }
        }
        self.perform(ctx, press.action, press.gesture);
    }

    /// Does what a panel asks for.
    pub fn answer_ask(&mut self, ctx: &Context, ask: Ask) {
        let state = &mut self.state;
        match ask {
            Ask::Do(action) => self.perform(ctx, action, Gesture::Whole),
            Ask::Change { command, gesture, label } => self.change(command, gesture, &label),
            Ask::Look(view) => self.look(*view),
            Ask::Settings(settings) => state.settings = settings,
            Ask::Lab(ask) => self.answer_lab(ctx, ask),
            Ask::Select(id) => match selection::pick(&state.scene, &state.view, id) {
                Ok(selection) => self.select(selection, Gesture::Whole),
                Err(refusal) => self.refuse(refusal.to_string()),
            },
            Ask::SelectPolygon(polygon) => {
                let mut view = state.view.clone();
                match selection::go_to_polygon(&state.scene, &mut view, polygon) {
                    Ok(()) => self.look(view),
                    Err(refusal) => self.refuse(refusal.to_string()),
                }
            }
            Ask::GoTo(position) => {
                self.walk(|state| state.history.go_to(&mut state.scene, position));
            }
            Ask::Abandon(gesture) => {
                self.walk(|state| {
                    state.history.abandon(&mut state.scene, gesture);
                });
            }
            Ask::BeginRename(id) => state.renaming = Some(id),
            Ask::EndRename(name) => self.end_rename(name),
            Ask::ChooseTexture(id) => self.dialogs.ask_file(ctx, Wanted::Texture(id), ""),
            Ask::LoadFiles(paths) => self.load_files(ctx, paths),
            Ask::Details(at) => {
                if let Some(notice) = state.notices.get(at) {
                    self.dialogs.tell_details(notice.text.clone(), notice.details.clone());
                }
            }
            Ask::PutAway(at) => {
                if at < state.notices.len() {
                    state.notices.remove(at);
                }
            }
            Ask::CancelLoading(at) => {
                if let Some(loading) = self.loading.get(at) {
                    loading.task.progress.cancel();
                }
            }
            Ask::Refuse(why) => self.refuse(why),
        }
    }

    /// Does what stands in the table of actions. Every key, menu entry and button ends here.
    pub fn perform(&mut self, ctx: &Context, action: Action, gesture: Gesture) {
        let label = action.step_label(&self.state);
        // What a notice offers is done by any key or button, and then there is no more to offer.
        if action == Action::FrameSelection {
            let framed = self.state.view.object.map(Offer::Frame);
            self.state.notices.retain(|notice| notice.offer.is_none() || notice.offer != framed);
        }
        match decide(action, &self.state, self.state.stroke(gesture)) {
            Err(refusal) => self.refuse(refusal.to_string()),
            Ok(Meaning::Change(command)) => self.change(command, gesture, &label),
            Ok(Meaning::Add(command, subject)) => self.add(command, subject, &label),
            Ok(Meaning::Look(view)) => self.look(*view),
            Ok(Meaning::Select(selection)) => self.select(*selection, gesture),
            Ok(Meaning::Window) => self.window(ctx, action),
        }
    }

    /// Does what is not the scene's or the view's.
    fn window(&mut self, ctx: &Context, action: Action) {
        let state = &mut self.state;
        let shown = &mut state.shown;
        match action {
            Action::New => self.unless_unsaved(ctx, After::New),
            Action::Open => self.unless_unsaved(ctx, After::Open(None)),
            Action::Quit => self.unless_unsaved(ctx, After::Quit),
            Action::Load => self.dialogs.ask_file(ctx, Wanted::Model, ""),
            Action::Save => self.save(ctx, None),
            Action::SaveAs => self.save_as(ctx, None),
            Action::SavePicture => self.dialogs.ask_file(ctx, Wanted::PictureTo, "picture.png"),
            Action::AddCamera => self.dialogs.ask_material(MaterialDialog::of_camera()),
            Action::Undo => {
                self.walk(|state| {
                    let label = state.history.undo(&mut state.scene);
                    state.tell(label.map(|label| format!("Taken back: {label}")));
                });
            }
            Action::Redo => {
                self.walk(|state| {
                    let label = state.history.redo(&mut state.scene);
                    state.tell(label.map(|label| format!("Made again: {label}")));
                });
            }
            Action::Rename => {
                shown.outline = true;
                state.renaming = state.selected();
            }
            Action::CheatSheet => shown.cheat_sheet ^= true,
            Action::ToggleOutline => shown.outline ^= true,
            Action::ToggleProperties => shown.properties ^= true,
            Action::ToggleViewPanel => shown.view ^= true,
            Action::ToggleStatistics => shown.statistics ^= true,
            Action::TogglePlan => shown.plan ^= true,
            Action::MeasurePlan => self.measure(ctx),
            Action::ToggleLeaveOut => {
                state.settings.leave_out = match state.settings.leave_out {
                    LeaveOut::Unseen => LeaveOut::HalfStep,
                    LeaveOut::HalfStep => LeaveOut::Unseen,
                };
            }
            Action::ToggleLaboratory => shown.laboratory ^= true,
            Action::ThemeSystem => set_theme(ctx, shown, ThemePreference::System),
            Action::ThemeLight => set_theme(ctx, shown, ThemePreference::Light),
            Action::ThemeDark => set_theme(ctx, shown, ThemePreference::Dark),
            Action::ToPanels => Keyboard::change_owner(ctx),
            // What is left is decided, and never comes here.
            _ => {}
        }
    }

    /// Does it, after asking where work is not saved.
    pub(super) fn unless_unsaved(&mut self, ctx: &Context, after: After) {
        if self.state.history.is_saved() {
            self.after(ctx, after);
        } else {
            self.dialogs.ask_unsaved(after);
        }
    }

    /// Leaves the program.
    pub(super) fn leave(&mut self, ctx: &Context) {
        self.leaving = true;
        ctx.send_viewport_cmd(ViewportCommand::Close);
    }

    /// The window's cross.
    fn close_requested(&mut self, ctx: &Context) {
        if ctx.input(|input| input.viewport().close_requested())
            && !self.leaving
            && !self.state.history.is_saved()
        {
            ctx.send_viewport_cmd(ViewportCommand::CancelClose);
            self.dialogs.ask_unsaved(After::Quit);
        }
    }

    fn end_rename(&mut self, name: Option<String>) {
        let Some(id) = self.state.renaming.take() else { return };
        let Some(name) = name else { return };
        if self.state.name(id) == Some(name.trim()) {
            return;
        }
        match items::rename(&self.state.scene, id, &name) {
            Ok(command) => self.change(command, Gesture::Whole, "Rename"),
            Err(refusal) => self.refuse(refusal.to_string()),
        }
    }

    /// Shows the scene otherwise.
    fn look(&mut self, view: View) {
        self.state.message = None;
        self.state.view = view;
        selection::settle(&self.state.scene, &mut self.state.view);
    }

    fn select(&mut self, selection: Selection, gesture: Gesture) {
        if let Some(command) = selection.command {
            self.change(command, gesture, "Aim the camera");
        }
        self.look(selection.view);
    }

    /// Adds an item, which becomes the subject.
    pub(super) fn add(&mut self, command: Command, subject: Subject, label: &str) {
        self.change(command, Gesture::Whole, label);
        selection::set_subject(&mut self.state.view, subject);
    }

    /// Changes the scene. Every change of it but walking through the history ends here.
    pub(super) fn change(&mut self, command: Command, gesture: Gesture, label: &str) {
        let state = &mut self.state;
        let before = state.scene.clone();
        match state.history.perform(&mut state.scene, command, gesture, label) {
            Ok(()) => {
                state.gesture = gesture;
                state.message = None;
                selection::follow(&before, &state.scene, &mut state.view);
            }
            Err(error) => self.refuse(error.to_string()),
        }
    }

    /// Walks through the history.
    fn walk(&mut self, steps: impl FnOnce(&mut State)) {
        let before = self.state.scene.clone();
        self.state.message = None;
        steps(&mut self.state);
        self.state.gesture = Gesture::Whole;
        selection::follow(&before, &self.state.scene, &mut self.state.view);
    }

    /// Says in the status line why something is not done.
    pub(super) fn refuse(&mut self, why: String) {
        self.state.message = Some(Message { text: why, tone: Tone::Refused });
    }
}

fn set_theme(ctx: &Context, shown: &mut Shown, theme: ThemePreference) {
    shown.theme = theme;
    ctx.set_theme(theme);
}

impl eframe::App for App {
    fn ui(&mut self, ui: &mut egui::Ui, _frame: &mut eframe::Frame) {
        self.lab.rest();
        // A fault of the program costs a frame, not the user's work. One that comes in every frame
        // cannot be lived with.
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
}

/// After so many frames that failed one after the other the program gives up.
const MOST_FAULTS: u32 = 10;

const FAULT: &str = "This is a fault of the program. What you asked for last may not have been \
    done; everything else is as it was. It is wise to save the scene now.";

//! Esc: dismisses, then cancels, then deselects; with nothing left, twice quits.
//!
//! One press has one effect, from the innermost thing outwards. Dialogs, menus and text fields take
//! Esc before it gets here.

use egui::Context;

use super::App;
use crate::app::actions::{FileIntent, LabRequest};
use crate::app::panels::{Panel, greeting};
use marraztu_core::edit::several::Others;

/// The time, in seconds, within which a second Esc quits.
const TWICE: f64 = 2.0;

/// The message after an Esc that found nothing to end.
const AGAIN: &str = "Esc again quits";

impl App {
    /// Performs Esc.
    pub(super) fn escape(&mut self, ctx: &Context) {
        let now = ctx.input(|input| input.time);
        if self.dismisses(ctx) || self.cancels(ctx) || self.ends_presenting(ctx) || self.deselects()
        {
            self.forget_quitting();
        } else if cfg!(target_family = "wasm") {
            self.state.tell(Some("There is nothing to cancel".to_owned()));
        } else if self.quits_until.take().is_some_and(|until| now <= until) {
            self.file(ctx, FileIntent::Quit);
        } else {
            self.quits_until = Some(now + TWICE);
            self.state.tell(Some(AGAIN.to_owned()));
            // A frame at exactly that time might still count as within it.
            ctx.request_repaint_after(std::time::Duration::from_secs_f64(TWICE + 0.05));
        }
    }

    /// Removes the message about a second Esc once that no longer quits.
    pub(super) fn end_quitting(&mut self, ctx: &Context) {
        let now = ctx.input(|input| input.time);
        if self.quits_until.is_some_and(|until| until < now) {
            self.forget_quitting();
        }
    }

    /// Hides the greeting for good, if it is shown.
    fn dismisses_greeting(&mut self) -> bool {
        let is_shown = self.viewport.rect().is_some_and(|it| greeting::is_shown(&self.state, it));
        self.state.greeting &= !is_shown;
        is_shown
    }

    /// Lets the next Esc be a first one.
    pub(super) fn forget_quitting(&mut self) {
        if self.quits_until.take().is_some() {
            self.state.message.take_if(|message| message.text == AGAIN);
        }
    }

    /// Ends a drag, or else dismisses the innermost thing over the picture. Returns whether there
    /// was one.
    fn dismisses(&mut self, ctx: &Context) -> bool {
        let mut requests = Vec::new();
        if self.viewport.cancel_drag(&mut requests) {
            requests.into_iter().for_each(|request| self.answer(ctx, request));
            return true;
        }
        let state = &mut self.state;
        if std::mem::take(&mut state.aiming)
            || std::mem::take(&mut state.explaining)
            || std::mem::take(&mut state.loupe)
            || std::mem::take(&mut state.lab.picking)
            || Panel::MOMENTARY.into_iter().any(|panel| self.closes(panel))
            || self.state.renaming.take().is_some()
        {
            return true;
        }
        if self.state.explained.take().is_some() {
            self.explaining = None;
            return true;
        }
        // Files keep the history open, so it closes after the modes.
        if self.dismisses_greeting() || self.dismiss_notices() || self.closes(Panel::History) {
            return true;
        }
        let is_away = self.state.lab.away;
        if is_away {
            self.back_to_scene();
        }
        is_away
    }

    /// Cancels the work in progress. Returns whether there was some.
    fn cancels(&mut self, ctx: &Context) -> bool {
        let loading = self.loading.iter().map(|loading| &loading.task.progress);
        let making = self.making.tasks.iter().map(|task| &task.progress);
        let running: Vec<_> =
            loading.chain(making).filter(|progress| !progress.is_cancelled()).cloned().collect();
        if !running.is_empty() {
            self.queued.clear();
            running.iter().for_each(marraztu_io::Progress::cancel);
            return true;
        }
        if self.state.plan.measuring {
            self.measure(ctx);
            return true;
        }
        let is_measuring = self.state.lab.running.is_some();
        if is_measuring {
            self.answer_lab(ctx, LabRequest::Cancel);
        }
        is_measuring
    }

    /// Selects one item if several are selected. Returns whether several were.
    fn deselects(&mut self) -> bool {
        let several = !self.state.others().is_empty();
        if several {
            self.state.several = Others::default();
        }
        several
    }
}

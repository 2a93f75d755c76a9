//! Draws the picture and the exact one for comparison, on a background thread, or by another
//! instance of the program where there are no threads.
//!
//! Pictures that are out of date are cancelled immediately, which takes effect between two tiles.
//! The next ones begin only after that.

use egui::Context;

use super::App;
use super::jobs::{Answers, Elsewhere, Job};
use crate::app::state::laboratory::{Compare, Judged};
use crate::app::tasks::{Outcome, Task};
use crate::app::viewport::comparison::{Compared, Drawing, draw};
use marraztu_core::accuracy::Settings;
use marraztu_io as io;

impl App {
    /// Shows finished pictures, and starts new ones if the comparison is out of date.
    pub(crate) fn compare(&mut self, ctx: &Context) {
        let wanted = self.compared_now();
        let animated = self.state.is_animated();
        self.hear_comparison(ctx, wanted.as_ref());
        let comparison = &mut self.comparison;
        if let Some(drawing) = &comparison.drawing {
            // An animated scene changes in every frame, so a comparison with an earlier time still
            // counts.
            let is_wanted = wanted.as_ref().is_some_and(|wanted| match animated {
                true => at_one_time(wanted, &drawing.of),
                false => *wanted == drawing.of,
            });
            if !is_wanted {
                drawing.task.progress.cancel();
                self.comparing.cancel();
            }
        }
        let is_drawn = wanted.as_ref() == comparison.drawn.as_deref().map(|pair| &pair.of);
        if comparison.current != is_drawn {
            comparison.current = is_drawn;
            ctx.request_repaint();
        }
        // While the view moves, no drawing begins, since the next frame would cancel it.
        let rests = animated || comparison.wanted == wanted;
        comparison.wanted.clone_from(&wanted);
        if !rests {
            return ctx.request_repaint();
        }
        let Some(of) = wanted.filter(|_| !is_drawn && comparison.drawing.is_none()) else { return };
        let theirs = of.clone();
        let label = "Comparing".to_owned();
        if self.draws_elsewhere
            && let Some(job) = Job::compare(&of)
        {
            let (task, sender) = Task::promised(label);
            self.comparing = Elsewhere::new(job, Answers::Compared(sender, Box::new(theirs)));
            comparison.drawing = Some(Drawing { of, task });
            return;
        }
        let work = move |progress: &io::Progress| draw(theirs, progress).map(Box::new);
        // Without a thread, there is no comparison.
        let task = Task::start(ctx, label, work).ok();
        comparison.drawing = task.map(|task| Drawing { of, task });
    }

    /// Returns the inputs of the comparison; `None` if there is no comparison.
    fn compared_now(&self) -> Option<Compared> {
        let lab = &self.state.lab;
        let size = self.viewport.size().filter(|_| lab.compare != Compare::Off)?;
        let shot = self.state.shot(size);
        // The picture at rest is compared, which the window shows, too.
        let samples = self.state.refined_to().unwrap_or(shot.settings.samples);
        let settings = Settings { samples, ..shot.settings };
        Some(Compared { shot: shot.with(settings), against: lab.reference })
    }

    /// Shows a finished pair, unless it belongs to another scene.
    fn hear_comparison(&mut self, ctx: &Context, wanted: Option<&Compared>) {
        let Some(drawing) = &self.comparison.drawing else { return };
        match drawing.task.outcome() {
            Outcome::Running => return,
            Outcome::Done(Some(drawn)) => {
                let settings = drawn.of.shot.settings;
                let judged = Judged { error: drawn.error, settings };
                let is_now = wanted.is_some_and(|wanted| at_one_time(wanted, &drawn.of));
                self.state.lab.judged = is_now.then_some(judged);
                if is_now {
                    self.comparison.take(ctx, drawn);
                }
            }
            Outcome::Done(None) => {}
            Outcome::Lost => self.state.lab.compare = Compare::Off,
        }
        self.comparison.drawing = None;
        ctx.request_repaint();
    }
}

/// Returns whether both have the same inputs, except for the time.
fn at_one_time(a: &Compared, b: &Compared) -> bool {
    let mut b = b.clone();
    b.shot.view.time = a.shot.view.time;
    *a == b
}

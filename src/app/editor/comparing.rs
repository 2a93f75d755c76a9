//! Draws the picture and the exact one for comparison, on a thread of its own.

use egui::Context;

use super::App;
use crate::app::state::State;
use crate::app::state::laboratory::{Compare, Judged};
use crate::app::tasks::{Outcome, Task};
use crate::app::viewport::comparison::{Compared, Pair, draw};
use crate::io;

impl App {
    /// Takes finished pictures, and starts to draw new ones if the comparison is out of date.
    pub(crate) fn compare(&mut self, ctx: &Context) {
        let comparison = &mut self.comparison;
        if let Some(task) = &comparison.task {
            match task.outcome() {
                Outcome::Running => return,
                Outcome::Done(drawn) => {
                    let settings = drawn.of.settings;
                    let judged = Judged { error: drawn.error, settings };
                    let is_now = drawn.of.scene == self.state.scene;
                    self.state.lab.judged = is_now.then_some(judged);
                    comparison.take(ctx, drawn);
                }
                Outcome::Lost => self.state.lab.compare = Compare::Off,
            }
            comparison.task = None;
            ctx.request_repaint();
        }
        let (Some(size), true) = (self.viewport.size(), self.state.lab.compare != Compare::Off)
        else {
            return;
        };
        let State { scene, view, settings, .. } = &self.state;
        let against = self.state.lab.against(settings);
        let same = |pair: &Pair| {
            let Compared { scene: s, view: v, settings: t, size: z, against: a } = &pair.of;
            s == scene && v == view && t == settings && *z == size && *a == against
        };
        if self.comparison.drawn.as_deref().is_some_and(same) {
            return;
        }
        let (scene, view) = (scene.clone(), view.clone());
        let of = Compared { scene, view, settings: *settings, size, against };
        let work = move |_: &io::Progress| Box::new(draw(of));
        // Without a thread there is no comparison.
        self.comparison.task = Task::start(ctx, "Comparing".to_owned(), work).ok();
    }
}

//! Measures the cost of effects on a background thread, so the window stays responsive.

use std::sync::Arc;
use std::time::Duration;

use egui::Context;

use super::App;
use crate::app::panels::Panel;
use crate::app::state::Measured;
use crate::app::tasks::{Outcome, Task};
use marraztu_core::accuracy::Shot;
use marraztu_lab::cost::{self, Costs};

/// The approximate time of a measurement.
const BUDGET: Duration = Duration::from_secs(3);

/// A measurement of effects in progress, and its picture.
#[derive(Debug)]
pub(crate) struct Measuring {
    task: Task<Costs>,
    of: Shot,
}

impl Drop for Measuring {
    fn drop(&mut self) {
        self.task.progress.cancel();
    }
}

impl App {
    /// Starts to measure the cost of each effect, or cancels a measurement in progress.
    pub(crate) fn measure(&mut self, ctx: &Context) {
        self.state.panels = self.state.panels.with(Panel::Plan, true);
        if let Some(measuring) = &self.measuring {
            return measuring.task.progress.cancel();
        }
        let Some(size) = self.viewport.size() else { return };
        let of = self.state.shot(size);
        let theirs = of.clone();
        let task = Task::start(ctx, "measure effects".to_owned(), move |progress| {
            cost::measure(&theirs, BUDGET, || progress.is_cancelled())
        });
        match task {
            Ok(task) => {
                self.state.plan.measuring = true;
                self.measuring = Some(Measuring { task, of });
            }
            Err(error) => self.refuse(format!("cannot start a thread to measure: {error}")),
        }
    }

    /// Shows the finished measurement.
    pub(crate) fn hear_measuring(&mut self) {
        let Some(Measuring { task, .. }) = &self.measuring else { return };
        let cancelled = task.progress.is_cancelled();
        let costs = match task.outcome() {
            Outcome::Running => return,
            Outcome::Done(costs) => Some(costs),
            Outcome::Lost => None,
        };
        self.state.plan.measuring = false;
        let Some(of) = self.measuring.take().map(|measuring| measuring.of.clone()) else { return };
        match costs {
            Some(_) if cancelled => {}
            Some(costs) => {
                self.state.plan.costs = Some(Arc::new(Measured { costs, of }));
            }
            None => self
                .refuse("the effects could not be measured: this is a bug in the program".into()),
        }
    }
}

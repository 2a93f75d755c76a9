//! The progress of a batch on standard error: a bar on a terminal, else a line every ten seconds.

use std::collections::BTreeSet;
use std::io::IsTerminal;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::outcome::{Fault, Outcome};
use crate::cli::say;
use crate::cli::talk;

/// The time between two lines.
const PERIOD: Duration = Duration::from_secs(10);

/// The most distinct errors that are printed.
const MOST_ERRORS: usize = 20;

/// Shows the progress of a batch.
#[derive(Debug)]
pub(super) struct Meter {
    all: usize,
    done: usize,
    missing: usize,
    /// The pictures of earlier runs.
    unchanged: usize,
    begin: Instant,
    /// The time of the next line.
    next: Instant,
    /// The bar, on a terminal.
    bar: Option<ProgressBar>,
    /// The errors that were printed.
    errors: BTreeSet<String>,
}

impl Meter {
    /// Begins to show the progress of `all` jobs.
    pub(super) fn of(all: usize) -> Self {
        let is_lines = talk::is_quiet() || talk::tells_progress();
        let is_wanted = !is_lines && std::io::stderr().is_terminal();
        let bar = is_wanted.then(|| {
            let target = ProgressDrawTarget::stderr();
            let bar = ProgressBar::with_draw_target(u64::try_from(all).ok(), target);
            let style = "{bar:30} {pos} of {len} pictures, {per_sec}, {eta} left";
            match ProgressStyle::with_template(style) {
                Ok(style) => bar.with_style(style),
                Err(_) => bar,
            }
        });
        let begin = Instant::now();
        let errors = BTreeSet::new();
        Self { all, done: 0, missing: 0, unchanged: 0, begin, next: begin + PERIOD, bar, errors }
    }

    /// Counts a result, and prints its error if it is a new one.
    pub(super) fn add(&mut self, outcome: &Outcome) {
        self.done += 1;
        if let Some(bar) = &self.bar {
            bar.inc(1);
        }
        let fault = match &outcome.result {
            Err(Fault::Cancelled) => return,
            Err(fault) => fault,
            Ok(drawn) => {
                self.unchanged += usize::from(drawn.unchanged);
                return;
            }
        };
        self.missing += 1;
        if self.errors.len() > MOST_ERRORS || !self.errors.insert(fault.reason()) {
            return;
        }
        let text = match self.errors.len() {
            count if count > MOST_ERRORS => "there are more errors; --report lists all".to_owned(),
            _ => fault.reason(),
        };
        match &self.bar {
            Some(bar) => bar.suspend(|| say("error", &text)),
            None => say("error", &text),
        }
    }

    /// Prints a line if it is time for one.
    pub(super) fn tick(&mut self) {
        if self.bar.is_some() || talk::is_quiet() || Instant::now() < self.next {
            return;
        }
        self.next += PERIOD;
        let Self { done, all, missing, .. } = *self;
        let rate = self.rate();
        let text = format!("{done} of {all} pictures, {missing} missing, {rate:.1} a second");
        say("progress", &text);
    }

    /// Removes the bar.
    pub(super) fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }

    /// Returns the number of pictures of earlier runs.
    pub(super) const fn unchanged(&self) -> usize {
        self.unchanged
    }

    /// Returns the pictures per second.
    #[expect(clippy::cast_precision_loss, reason = "for the eye")]
    pub(super) fn rate(&self) -> f64 {
        self.done as f64 / self.begin.elapsed().as_secs_f64().max(1e-9)
    }
}

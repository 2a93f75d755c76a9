//! The progress of a batch on standard error: a bar on a terminal, else a line every ten seconds.

use std::collections::BTreeSet;
use std::io::IsTerminal;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::outcome::{Fault, Outcome};
use crate::cli::say;
use crate::cli::talk;

/// The time between two lines, and the one with `--progress`.
const PERIODS: [Duration; 2] = [Duration::from_secs(10), Duration::from_secs(1)];

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
    /// The time of the next line, and between two lines.
    next: Instant,
    period: Duration,
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
            let style = "{bar:30} {percent}%: {pos} of {len} pictures, {msg}{per_sec}, {eta} left";
            match ProgressStyle::with_template(style) {
                Ok(style) => bar.with_style(style),
                Err(_) => bar,
            }
        });
        let (begin, errors) = (Instant::now(), BTreeSet::new());
        let period = PERIODS[usize::from(talk::tells_progress())];
        let next = begin + period;
        Self { all, done: 0, missing: 0, unchanged: 0, begin, next, period, bar, errors }
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
        if let Some(bar) = &self.bar {
            bar.set_message(format!("{} missing, ", self.missing));
        }
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
        self.next += self.period;
        self.tell();
    }

    fn tell(&self) {
        let Self { done, all, missing, .. } = *self;
        let rate = self.rate();
        let left = time_left(all - done, rate);
        let percent = 100 * done / all.max(1);
        let text = format!(
            "{percent}%: {done} of {all} pictures, {missing} missing, {rate:.1} a second, {left} \
             left"
        );
        say("progress", &text);
    }

    /// Removes the bar, or prints a last line with `--progress`.
    pub(super) fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        } else if talk::tells_progress() {
            self.tell();
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

/// Returns the time for this number of pictures.
#[expect(clippy::cast_precision_loss, reason = "for the eye")]
fn time_left(pictures: usize, rate: f64) -> String {
    // Longer times are a guess of the first seconds.
    time_text((pictures as f64 / rate).min(1e8))
}

/// Formats a time in seconds: "35 s", "12 min", "3 h 20 min".
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates")]
pub(super) fn time_text(seconds: f64) -> String {
    match seconds {
        0.0..99.5 => format!("{seconds:.0} s"),
        0.0..5970.0 => format!("{:.0} min", seconds / 60.0),
        0.0.. => {
            let minutes = (seconds / 60.0).round() as u64;
            format!("{} h {} min", minutes / 60, minutes % 60)
        }
        _ => "an unknown time".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_left_has_a_unit_that_suits_it() {
        for (pictures, rate, text) in [
            (0, 5.0, "0 s"),
            (175, 5.0, "35 s"),
            (3600, 5.0, "12 min"),
            (60_000, 5.0, "3 h 20 min"),
            (5, 0.0, "27777 h 47 min"),
        ] {
            assert_eq!(time_left(pictures, rate), text);
        }
    }
}

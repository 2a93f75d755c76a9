//! Shows progress on standard error: as a bar on a terminal, or as lines on request.

use std::io::IsTerminal;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{Builder, JoinHandle};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use marraztu_io::Progress;

use super::say;
use super::talk;

/// Shorter work has no bar.
const PATIENCE: Duration = Duration::from_millis(700);

/// The time between two updates.
const PERIOD: Duration = Duration::from_millis(60);

/// The step between two lines, in per cent.
const STEP: u64 = 10;

/// Shows the progress of work until it is dropped.
#[derive(Debug)]
pub(crate) struct Bar {
    done: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Bar {
    /// Starts a bar for work with known progress.
    pub(crate) fn of(what: &str, progress: &Progress) -> Self {
        let style = ProgressStyle::with_template("{msg} [{bar:30}] {percent}%");
        let progress = progress.clone();
        Self::start(what, style.ok(), move || Some(thousandths(&progress)))
    }

    /// Starts a spinner for work with unknown progress.
    pub(crate) fn unmeasured(what: &str) -> Self {
        let style = ProgressStyle::with_template("{msg} {spinner} {elapsed}");
        Self::start(what, style.ok(), || None)
    }

    fn start(
        what: &str,
        style: Option<ProgressStyle>,
        thousandths: impl Fn() -> Option<u64> + Send + 'static,
    ) -> Self {
        let done = Arc::new(AtomicBool::new(false));
        let (watched, what) = (Arc::clone(&done), what.to_owned());
        let builder = || Builder::new().name("bar".to_owned());
        // If the thread cannot be started, no bar is shown.
        let thread = if talk::is_quiet() {
            None
        } else if std::io::stderr().is_terminal() {
            builder().spawn(move || show(&what, style, &thousandths, &watched)).ok()
        } else if talk::tells_progress() {
            builder().spawn(move || tell(&what, &thousandths, &watched)).ok()
        } else {
            None
        };
        Self { done, thread }
    }
}

/// Draws a bar when the work takes long.
fn show(
    what: &str,
    style: Option<ProgressStyle>,
    thousandths: &dyn Fn() -> Option<u64>,
    done: &AtomicBool,
) {
    let begin = Instant::now();
    let bar = ProgressBar::with_draw_target(Some(1000), ProgressDrawTarget::hidden());
    if let Some(style) = style {
        bar.set_style(style);
    }
    bar.set_message(what.to_owned());
    while !done.load(Ordering::Relaxed) {
        // Short work should not flash a bar.
        if bar.is_hidden() && begin.elapsed() > PATIENCE {
            bar.set_draw_target(ProgressDrawTarget::stderr());
        }
        match thousandths() {
            Some(thousandths) => bar.set_position(thousandths),
            None => bar.tick(),
        }
        std::thread::park_timeout(PERIOD);
    }
    bar.finish_and_clear();
}

/// Prints lines such as "drawing: 40%", from the first step to the end.
fn tell(what: &str, thousandths: &dyn Fn() -> Option<u64>, done: &AtomicBool) {
    let mut told = 0;
    while !done.load(Ordering::Relaxed) {
        let percent = thousandths().unwrap_or(0) / 10 / STEP * STEP;
        if percent > told && percent < 100 {
            say("progress", &format_args!("{what}: {percent}%"));
            told = percent;
        }
        std::thread::park_timeout(PERIOD);
    }
    say("progress", &format_args!("{what}: 100%"));
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.done.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            thread.thread().unpark();
            // A panic of the bar does not affect the work.
            let _ = thread.join();
        }
    }
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped just before")]
fn thousandths(progress: &Progress) -> u64 {
    (progress.fraction().clamp(0.0, 1.0) * 1000.0) as u64
}

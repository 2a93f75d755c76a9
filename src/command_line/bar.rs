//! A bar for work that takes long, on standard error, where that is a terminal.

use std::io::IsTerminal;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{Builder, JoinHandle};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use marraztu::io::Progress;

/// Work that takes less is not worth a bar.
const PATIENCE: Duration = Duration::from_millis(700);

/// Shows a bar for as long as it lives, once the work takes long.
#[derive(Debug)]
pub(crate) struct Bar {
    done: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Bar {
    /// Watches work whose progress is known.
    pub(crate) fn of(what: &str, progress: &Progress) -> Self {
        let style = ProgressStyle::with_template("{msg} [{bar:30}] {percent}%");
        let progress = progress.clone();
        Self::start(what, style.ok(), move |bar| bar.set_position(thousandths(&progress)))
    }

    /// Watches work of which only the end is known.
    pub(crate) fn unmeasured(what: &str) -> Self {
        let style = ProgressStyle::with_template("{msg} {spinner} {elapsed}");
        Self::start(what, style.ok(), ProgressBar::tick)
    }

    fn start(
        what: &str,
        style: Option<ProgressStyle>,
        show: impl Fn(&ProgressBar) + Send + 'static,
    ) -> Self {
        let done = Arc::new(AtomicBool::new(false));
        if !std::io::stderr().is_terminal() {
            return Self { done, thread: None };
        }
        let (watched, what) = (Arc::clone(&done), what.to_owned());
        let watch = move || {
            let begin = Instant::now();
            let bar = ProgressBar::with_draw_target(Some(1000), ProgressDrawTarget::hidden());
            if let Some(style) = style {
                bar.set_style(style);
            }
            bar.set_message(what);
            while !watched.load(Ordering::Relaxed) {
                if bar.is_hidden() && begin.elapsed() > PATIENCE {
                    bar.set_draw_target(ProgressDrawTarget::stderr());
                }
                show(&bar);
                std::thread::park_timeout(Duration::from_millis(60));
            }
            bar.finish_and_clear();
        };
        // Without a thread there is no bar, and the work is done all the same.
        Self { done, thread: Builder::new().name("bar".to_owned()).spawn(watch).ok() }
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.done.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            thread.thread().unpark();
            // A bar that broke down takes nothing with it.
            let _ = thread.join();
        }
    }
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped just before")]
fn thousandths(progress: &Progress) -> u64 {
    (progress.fraction().clamp(0.0, 1.0) * 1000.0) as u64
}

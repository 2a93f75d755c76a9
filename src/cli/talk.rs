//! Notes and progress on standard error.

use std::sync::atomic::{AtomicBool, Ordering};

use clap::Args;

use super::say;

static QUIET: AtomicBool = AtomicBool::new(false);
static PROGRESS: AtomicBool = AtomicBool::new(false);

/// The options for messages.
#[derive(Debug, Default, Args)]
#[command(next_help_heading = "Messages")]
pub(crate) struct Talk {
    /// Print errors only: no notes on files, no progress
    #[arg(short, long, conflicts_with = "progress")]
    quiet: bool,
    /// Print progress as lines of per cent, even if standard error is not a terminal
    #[arg(long)]
    progress: bool,
}

impl Talk {
    /// Applies the options to all later messages.
    pub(crate) fn apply(&self) {
        QUIET.store(self.quiet, Ordering::Relaxed);
        PROGRESS.store(self.progress, Ordering::Relaxed);
    }
}

/// Prints a note, unless only errors are wanted.
pub(crate) fn note(what: &dyn std::fmt::Display) {
    if !is_quiet() {
        say("note", what);
    }
}

/// Returns whether only errors are printed.
pub(super) fn is_quiet() -> bool {
    QUIET.load(Ordering::Relaxed)
}

/// Returns whether progress is printed in lines.
pub(super) fn tells_progress() -> bool {
    PROGRESS.load(Ordering::Relaxed)
}

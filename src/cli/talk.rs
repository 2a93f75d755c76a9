//! Results on standard output, notes and progress on standard error.

use std::fmt::Display;
use std::io::{ErrorKind, Write as _};
use std::sync::atomic::{AtomicBool, Ordering};

use clap::Args;
use serde::Serialize;

use super::failure::Failure;

static QUIET: AtomicBool = AtomicBool::new(false);
static PROGRESS: AtomicBool = AtomicBool::new(false);

/// The options for messages.
#[derive(Debug, Default, Args)]
#[command(next_help_heading = "Messages")]
pub(crate) struct Talk {
    /// Print errors only: no notes on files, no progress
    #[arg(short, long, conflicts_with = "progress")]
    quiet: bool,
    /// Print progress as lines, even if standard error is not a terminal: per cent, or pictures,
    /// their rate and the time left
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

/// Prints a text to standard output.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    write_out(without_controls(text).as_bytes())
}

/// Formats a value as indented JSON, with a line end.
pub(crate) fn json(value: &impl Serialize) -> String {
    let text = serde_json::to_string_pretty(value).expect("all keys are texts");
    text + "\n"
}

/// Writes bytes to standard output.
pub(crate) fn write_out(bytes: &[u8]) -> Result<(), Failure> {
    match std::io::stdout().lock().write_all(bytes) {
        // The reader has closed the pipe, like `head`.
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        written => written.map_err(Failure::Output),
    }
}

/// Prints a line to standard error, in the style of clap's errors.
pub(crate) fn say(kind: &str, what: &dyn Display) {
    let text = without_controls(&what.to_string());
    let _ = writeln!(std::io::stderr().lock(), "{kind}: {text}");
}

/// Replaces control characters: in the name of a file or an object, they could hide text, or make a
/// terminal do something.
fn without_controls(text: &str) -> String {
    text.replace(|sign: char| sign.is_control() && sign != '\n' && sign != '\t', "\u{FFFD}")
}

/// Prints a note, unless only errors are wanted.
pub(crate) fn note(what: &dyn Display) {
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

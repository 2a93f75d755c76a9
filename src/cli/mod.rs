//! From arguments to the editor, a picture or a description, and back with an exit status.
//!
//! 0 on success, 1 if something failed, 2 for invalid arguments. What was asked for goes to standard
//! output, everything said about it to standard error.

mod accuracy;
mod arguments;
mod bar;
mod failure;
mod info;
mod keys;
mod lab;
mod open;
mod plan;
mod render;
mod stage;
mod talk;
mod target;
mod values;
mod verify;

use std::io::Write;
use std::process::ExitCode;

use clap::Parser;

use self::arguments::{Arguments, Headless};
use self::failure::Failure;

/// Does what the arguments of this process ask for.
pub(crate) fn run() -> ExitCode {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(wrong) => return usage(&open::misspelt().unwrap_or(wrong)),
    };
    let done = match arguments.command {
        Some(Headless::Render(arguments)) => render::render(&arguments),
        Some(Headless::Info(arguments)) => info::info(&arguments),
        Some(Headless::Keys(arguments)) => keys::keys(&arguments),
        Some(Headless::Plan(arguments)) => plan::plan(&arguments),
        Some(Headless::Lab(arguments)) => lab::lab(&arguments),
        Some(Headless::Verify(arguments)) => verify::verify(&arguments),
        None => open::open(arguments.files),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(Failure::Usage(wrong)) => usage(&wrong),
        Err(Failure::Told) => ExitCode::FAILURE,
        Err(failure) => {
            say("error", &failure);
            ExitCode::FAILURE
        }
    }
}

/// Has this thread draw, together with others: so many in all, or as many as there are cores. It has nothing
/// else to do, and no time is lost with waking it when they are done.
fn draw_along(threads: Option<usize>) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0));
    // Fails only where the threads are there already, and this comes first.
    let _ = pool.use_current_thread().build_global();
}

/// Shows clap's message: help and version too come this way, with exit status 0.
fn usage(wrong: &clap::Error) -> ExitCode {
    // Nobody is left to be told where this fails.
    let _ = wrong.print();
    ExitCode::from(u8::try_from(wrong.exit_code()).unwrap_or(2))
}

/// A line on standard error, in the form that clap's own errors have.
fn say(kind: &str, what: &dyn std::fmt::Display) {
    let _ = writeln!(std::io::stderr().lock(), "{kind}: {what}");
}

//! The command line: one file for each command.
//!
//! The exit status is 0 on success, 1 on failure, and 2 for invalid arguments. Results go to
//! standard output, notes and errors to standard error.

mod accuracy;
mod arguments;
mod bar;
#[cfg(not(target_family = "wasm"))]
mod batch;
mod budget;
mod cameras;
mod commands;
#[cfg(not(target_family = "wasm"))]
mod compare;
mod explain;
mod export;
mod failure;
mod fixed_lights;
mod info;
#[cfg(feature = "desktop")]
mod keys;
#[cfg(not(target_family = "wasm"))]
mod lab;
mod layers;
#[cfg(not(target_family = "wasm"))]
mod manuals;
#[cfg(not(target_family = "wasm"))]
mod merge;
#[cfg(feature = "desktop")]
mod open;
#[cfg(not(target_family = "wasm"))]
mod page;
mod plan;
mod render;
mod sky;
mod split;
mod stage;
mod talk;
mod target;
mod terminal;
mod thumbnail;
mod turntable;
mod values;
mod verify;
#[cfg(not(target_family = "wasm"))]
mod views;

use std::process::ExitCode;

use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{CommandFactory, FromArgMatches as _};
use marraztu_core::base::threads::{self, Caller};

use self::commands::{Arguments, Headless};
use self::failure::Failure;
use self::talk::say;

/// Runs the command given by the arguments of this process.
pub(crate) fn run() -> ExitCode {
    // WASI has no current folder, but programs are told the one of the shell.
    if cfg!(target_family = "wasm")
        && let Some(folder) = std::env::var_os("PWD")
    {
        // The runtime may not grant access to it; paths then begin at a folder that it grants.
        let _ = std::env::set_current_dir(folder);
    }
    let mut command = Arguments::command();
    let parsed = command.try_get_matches_from_mut(std::env::args_os()).and_then(|matches| {
        let name = matches.subcommand_name().map(str::to_owned);
        let arguments = Arguments::from_arg_matches(&matches);
        let arguments = arguments.map_err(|wrong| wrong.format(&mut command))?;
        Ok((arguments, name))
    });
    let (arguments, name) = match parsed {
        Ok(parsed) => parsed,
        Err(wrong) => return usage(&with_usage(corrected(wrong), &mut command)),
    };
    if marraztu_render::simd::levels().is_empty() {
        say("error", &"drawing needs a processor with SSE4.2 (x86-64-v2)");
        return ExitCode::FAILURE;
    }
    if let Some(command) = &arguments.command {
        start_threads(command);
    }
    let done = match arguments.command {
        Some(Headless::Render(arguments)) => render::render(&arguments),
        #[cfg(not(target_family = "wasm"))]
        Some(Headless::Batch(arguments)) => batch::batch(arguments),
        Some(Headless::Turntable(arguments)) => turntable::turntable(&arguments),
        #[cfg(not(target_family = "wasm"))]
        Some(Headless::Merge(arguments)) => merge::merge(&arguments),
        #[cfg(not(target_family = "wasm"))]
        Some(Headless::Compare(arguments)) => compare::compare(&arguments),
        #[cfg(not(target_family = "wasm"))]
        Some(Headless::Views(arguments)) => views::views(&arguments),
        Some(Headless::Thumbnail(arguments)) => thumbnail::thumbnail(&arguments),
        Some(Headless::Export(arguments)) => export::export(&arguments),
        Some(Headless::Info(arguments)) => info::info(&arguments),
        #[cfg(feature = "desktop")]
        Some(Headless::Keys(arguments)) => keys::keys(&arguments),
        Some(Headless::Plan(arguments)) => plan::plan(&arguments),
        Some(Headless::Explain(arguments)) => explain::explain(&arguments),
        #[cfg(not(target_family = "wasm"))]
        Some(Headless::Lab(arguments)) => lab::lab(&arguments),
        Some(Headless::Verify(arguments)) => verify::verify(&arguments),
        #[cfg(not(target_family = "wasm"))]
        Some(Headless::Completions(arguments)) => manuals::completions(&arguments),
        #[cfg(not(target_family = "wasm"))]
        Some(Headless::Man(arguments)) => manuals::man(&arguments),
        #[cfg(feature = "desktop")]
        None => open::open(&arguments.files, arguments.shell, arguments.preset),
        #[cfg(not(feature = "desktop"))]
        None => unreachable!("clap demands a command"),
    };
    // Usage errors are printed like clap's own, with exit status 2.
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(Failure::Usage(reason)) => {
            let own = name.and_then(|name| command.find_subcommand(name)).unwrap_or(&command);
            usage(&own.clone().error(ErrorKind::ArgumentConflict, reason))
        }
        #[cfg(feature = "desktop")]
        Err(Failure::Unparsed(wrong)) => usage(&wrong),
        Err(Failure::Told) => ExitCode::FAILURE,
        Err(Failure::Status(status)) => ExitCode::from(status),
        Err(failure) => {
            say("error", &failure);
            ExitCode::FAILURE
        }
    }
}

/// Adds the usage of the command in the first argument, which clap leaves out for invalid values.
fn with_usage(mut wrong: clap::Error, command: &mut clap::Command) -> clap::Error {
    let name = std::env::args_os().nth(1).and_then(|name| name.into_string().ok());
    let own = name.and_then(|name| command.find_subcommand_mut(name));
    if let (true, Some(own)) = (wrong.use_stderr() && wrong.get(ContextKind::Usage).is_none(), own)
    {
        wrong.insert(ContextKind::Usage, ContextValue::StyledStr(own.render_usage()));
    }
    wrong
}

/// Suggests the command that the first argument is close to.
#[cfg(feature = "desktop")]
fn corrected(wrong: clap::Error) -> clap::Error {
    open::misspelt().unwrap_or(wrong)
}

/// Without the editor, the first argument cannot be a file, and clap suggests the command itself.
#[cfg(not(feature = "desktop"))]
const fn corrected(wrong: clap::Error) -> clap::Error {
    wrong
}

/// Starts the threads of a command: fewer than wanted if the system limits them, and at least this
/// one.
fn start_threads(command: &Headless) {
    let (threads, caller) = command.threads();
    let started = threads::start(threads, caller);
    // This fails only if the pool exists already, and nothing has started it.
    let _ = started.or_else(|_limit| threads::start(Some(1), Caller::Joins));
}

/// Prints clap's message. This includes help and version, with exit status 0.
fn usage(wrong: &clap::Error) -> ExitCode {
    // If standard error is closed, the message is lost.
    let _ = wrong.print();
    ExitCode::from(u8::try_from(wrong.exit_code()).unwrap_or(2))
}

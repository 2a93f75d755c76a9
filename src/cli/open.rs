//! `marraztu FILES`: opens the editor.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use clap::CommandFactory;
use clap::error::ErrorKind;
use marraztu::app::Shell;
use marraztu_core::accuracy::AccuracyPreset;
use marraztu_io as io;

use super::commands::Arguments;
use super::failure::{Failure, usage};
use super::values::is_standard;

/// Opens the editor with these files, which must exist.
pub(crate) fn open(
    files: &[PathBuf],
    shell: Option<Shell>,
    preset: Option<&'static AccuracyPreset>,
) -> Result<(), Failure> {
    if let Some(wrong) = misspelt() {
        return Err(Failure::Unparsed(Box::new(wrong)));
    }
    if files.iter().any(|file| is_standard(file)) {
        return Err(usage("the editor opens files; `marraztu render -` reads standard input"));
    }
    for file in files {
        io::check_file(file)?;
    }
    Ok(marraztu::app::run(files, shell.unwrap_or_default(), preset)?)
}

/// Returns an error if the first argument is not a file, but close to the name of a command.
pub(super) fn misspelt() -> Option<clap::Error> {
    misspelt_in(std::env::args_os().nth(1)?)
}

fn misspelt_in(word: OsString) -> Option<clap::Error> {
    let word = word.into_string().ok()?;
    if word.contains(['.', '/', '\\', '-']) || Path::new(&word).exists() {
        return None;
    }
    let command = Arguments::command();
    let names = command.get_subcommands().map(clap::Command::get_name);
    // The distance counts wrong, missing, extra and swapped letters. Short names allow only one.
    let slips = |name: &&str| strsim::osa_distance(name, &word);
    let most = |name: &str| if name.len() <= 4 { 1 } else { 2 };
    let nearest = names.min_by_key(slips).filter(|name| slips(name) <= most(name))?;
    // clap has already handled exact names.
    if *nearest == *word {
        return None;
    }
    let reason = format!("there is no file {word}; did you mean `marraztu {nearest}`?");
    Some(Arguments::command().error(ErrorKind::InvalidSubcommand, reason))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_word_that_is_nearly_a_command_is_taken_for_one_misspelt() {
        for word in ["rendr", "redner", "render2", "inof", "plna", "keyss"] {
            assert!(misspelt_in(word.into()).is_some(), "{word}");
        }
        for word in ["render", "teapot", "rendr.obj", "./rendr", "--rendr", "nosuch", "cat", ""] {
            assert!(misspelt_in(word.into()).is_none(), "{word}");
        }
    }
}

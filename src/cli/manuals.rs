//! `marraztu completions` and `marraztu man`: what shells and `man` need to know about the
//! arguments.
//!
//! Both are made from the definitions of the arguments, so they cannot be out of date. Packages
//! contain them: `tools/ports/common` writes them with the program.

use std::path::PathBuf;

use clap::{Args, Command, CommandFactory as _};
use clap_complete::Shell;
use clap_mangen::Man;
use marraztu_io::NewFile;
use roff::{Roff, roman};

use super::commands::Arguments;
use super::failure::Failure;
use super::talk::write_out;

/// The name of the program in shells.
const PROGRAM: &str = "marraztu";

/// The first letters of a page that `clap_mangen` writes.
const BEGIN: &[u8] = b".ie \\n(.g";

/// The shell to complete in.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  marraztu completions bash > ~/.local/share/bash-completion/completions/marraztu
  marraztu completions zsh > ~/.zfunc/_marraztu      (with fpath+=~/.zfunc before compinit)
  marraztu completions fish > ~/.config/fish/completions/marraztu.fish")]
pub(crate) struct Completions {
    /// The shell
    #[arg(value_enum)]
    shell: Shell,
}

/// The folder of manual pages.
#[derive(Debug, Args)]
#[command(after_help = "\
Writes marraztu.1 and a page for each command, such as marraztu-render.1.

Examples:
  marraztu man ~/.local/share/man/man1")]
pub(crate) struct Manuals {
    /// The folder to write to; it is created
    folder: PathBuf,
}

/// Prints a script for a shell.
pub(super) fn completions(arguments: &Completions) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut Arguments::command(), PROGRAM, &mut script);
    write_out(&script)
}

/// Writes a page for the program and for each command.
pub(super) fn man(arguments: &Manuals) -> Result<(), Failure> {
    let folder = &arguments.folder;
    std::fs::create_dir_all(folder).map_err(|error| Failure::Write(folder.clone(), error))?;
    let mut program = Arguments::command().disable_help_subcommand(true);
    program.build();
    let pages: Vec<(PathBuf, Vec<u8>)> = std::iter::once(&program)
        .chain(program.get_subcommands())
        .map(|command| Ok((folder.join(Man::new(command.clone()).get_filename()), page(command)?)))
        .collect::<std::io::Result<_>>()
        .map_err(Failure::Output)?;
    for (path, _) in &pages {
        let is_free = std::fs::read(path).is_ok_and(|page| page.starts_with(BEGIN));
        if path.exists() && !is_free {
            return Err(Failure::Absent(format!(
                "{}: a file with this name exists and is not a manual page of this program",
                path.display()
            )));
        }
    }
    for (path, page) in pages {
        let mut file = NewFile::begin(&path)?;
        file.push(&page)?;
        file.finish()?;
    }
    Ok(())
}

/// Formats the page of a command: the sections of `clap_mangen`, and the text below the help.
fn page(command: &Command) -> std::io::Result<Vec<u8>> {
    // Pages of one version are equal, so they have no date; `clap_mangen` loses an empty one.
    let source = concat!("marraztu ", env!("CARGO_PKG_VERSION"));
    let man = Man::new(command.clone()).date(" ").source(source).manual("User Commands");
    let mut page = Vec::new();
    man.render_title(&mut page)?;
    man.render_name_section(&mut page)?;
    man.render_synopsis_section(&mut page)?;
    man.render_description_section(&mut page)?;
    man.render_options_section(&mut page)?;
    if command.has_subcommands() {
        man.render_subcommands_section(&mut page)?;
    }
    if let Some(text) = command.get_after_help() {
        details(&text.to_string()).to_writer(&mut page)?;
    }
    Ok(page)
}

/// Formats the text below the help. Paragraphs that begin with "Examples:" and "Exit status:" are
/// sections of their own, and indented lines are kept as they are.
fn details(text: &str) -> Roff {
    let mut roff = Roff::new();
    let mut section = "";
    for paragraph in text.split("\n\n") {
        let (name, paragraph) = match paragraph.split_once(':') {
            Some(("Examples", rest)) => ("EXAMPLES", rest),
            Some(("Exit status", rest)) => ("EXIT STATUS", rest),
            _ => ("DETAILS", paragraph),
        };
        if name == section {
            roff.control("PP", []);
        } else {
            roff.control("SH", [name]);
            section = name;
        }
        let mut is_kept = false;
        for line in paragraph.trim_start_matches(['\n', ' ']).lines() {
            let is_indented = line.starts_with(' ') || section == "EXAMPLES";
            if is_indented != is_kept {
                roff.control(if is_indented { "nf" } else { "fi" }, []);
                is_kept = is_indented;
            }
            roff.text([roman(line.trim_start())]);
        }
        if is_kept {
            roff.control("fi", []);
        }
    }
    roff
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_text_below_the_help_has_sections_and_keeps_the_lines_of_examples() {
        let text = "First line\nof two.\n\nMore.\n\nExamples:\n  a -b\n  c\n\nExit status: 0 or 1.";
        let page = details(text).to_roff();
        let lines: Vec<&str> = page.lines().collect();
        let expected = [
            ".SH DETAILS",
            "First line",
            "of two.",
            ".PP",
            "More.",
            ".SH EXAMPLES",
            ".nf",
            "a \\-b",
            "c",
            ".fi",
            ".SH \"EXIT STATUS\"",
            "0 or 1.",
        ];
        assert_eq!(lines, expected);
    }

    #[test]
    fn every_command_and_every_option_is_on_its_page() {
        let mut program = Arguments::command();
        program.build();
        for command in std::iter::once(&program).chain(program.get_subcommands()) {
            let page = String::from_utf8(page(command).unwrap()).unwrap();
            assert!(page.as_bytes().starts_with(BEGIN), "{page}");
            for name in command.get_arguments().filter_map(clap::Arg::get_long) {
                let option = format!("\\-\\-{}", name.replace('-', "\\-"));
                assert!(page.contains(&option), "{}: --{name}", command.get_name());
            }
        }
    }
}

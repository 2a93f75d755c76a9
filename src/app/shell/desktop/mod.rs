//! The windows of desktops.
//!
//! `gl` is eframe, which paints with OpenGL. `software` paints on the CPU, directly into the memory
//! of the window, without OpenGL. Both show the same bytes. If OpenGL is itself implemented in
//! software, `software` is several times as fast.

mod gl;
mod software;
mod surface;
mod window;

use std::panic::{AssertUnwindSafe, catch_unwind};

use crate::app::editor::App;
use egui::{Context, ViewportBuilder};

/// The way to paint the window.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Shell {
    /// OpenGL if there is a graphics card, else the CPU.
    #[default]
    Automatic,
    /// OpenGL.
    Gl,
    /// The CPU, without OpenGL.
    Software,
}

/// Creates the editor after the window was opened.
pub(crate) type Make = Box<dyn FnOnce(&Context) -> App>;

/// The reason why no window could be opened, or why it was lost.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum StartError {
    /// There is no display.
    #[error("no display to open a window on: neither DISPLAY nor WAYLAND_DISPLAY is set")]
    NoDisplay,
    /// The display does not respond.
    #[error("the display cannot be reached: {0}")]
    Display(String),
    /// A library of the system is missing.
    #[error("the system lacks a library that windows need: {0}")]
    Library(String),
    /// There is no OpenGL, not even in software.
    #[error("OpenGL was not found: install a graphics driver, or use --shell software")]
    NoGl,
    /// The window is gone without having been closed.
    #[error("the window was lost: {0}")]
    Lost(String),
    /// The system limits the number of threads.
    #[error("the window needs more threads than this system allows (ulimit -u)")]
    Threads,
    /// Another error.
    #[error("the window could not be opened: {0}")]
    Other(String),
}

/// The facts that decide between the shells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Facts {
    /// Whether a graphics card can be opened.
    has_card: bool,
    /// Whether the environment asks for OpenGL in software.
    gl_is_software: bool,
}

/// Shows the editor in a window and returns when the window is closed.
///
/// # Errors
/// If no window can be opened, or if it is lost.
pub(crate) fn run(shell: Shell, window: ViewportBuilder, make: Make) -> Result<(), StartError> {
    // Until the window is open, libraries of the system report missing parts by panics. Panics are
    // silenced, and their text is returned as an error of one sentence.
    let earlier = std::panic::take_hook();
    std::panic::set_hook(Box::new(|_| {}));
    let make: Make = Box::new(|ctx| {
        std::panic::set_hook(earlier);
        make(ctx)
    });
    let run = match chosen(shell, Facts::of_this_machine()) {
        Shell::Software => software::run,
        Shell::Gl | Shell::Automatic => gl::run,
    };
    catch_unwind(AssertUnwindSafe(|| run(window, make))).unwrap_or_else(|panic| {
        let text = panic.downcast_ref::<String>().map(String::as_str);
        let text = text.or_else(|| panic.downcast_ref::<&str>().copied());
        Err(explained(text.unwrap_or("for an unknown reason")))
    })
}

/// Chooses the shell; never returns [`Shell::Automatic`].
const fn chosen(shell: Shell, facts: Facts) -> Shell {
    match shell {
        Shell::Automatic if facts.has_card && !facts.gl_is_software => Shell::Gl,
        Shell::Automatic => Shell::Software,
        Shell::Gl | Shell::Software => shell,
    }
}

impl Facts {
    fn of_this_machine() -> Self {
        let told = std::env::var("LIBGL_ALWAYS_SOFTWARE").unwrap_or_default();
        Self { has_card: has_card(), gl_is_software: is_yes(&told) }
    }
}

/// Returns whether Mesa interprets the value of a variable as true.
fn is_yes(value: &str) -> bool {
    !matches!(value.to_ascii_lowercase().as_str(), "" | "0" | "n" | "no" | "f" | "false" | "off")
}

/// Returns whether a graphics card can be opened for drawing.
fn has_card() -> bool {
    if !cfg!(target_os = "linux") {
        return true;
    }
    let devices = std::fs::read_dir("/dev/dri").into_iter().flatten().flatten();
    let mut cards =
        devices.filter(|entry| entry.file_name().to_string_lossy().starts_with("renderD"));
    cards.any(|card| std::fs::File::options().read(true).write(true).open(card.path()).is_ok())
}

/// Checks that there is a display.
///
/// # Errors
/// If there is no display.
pub(crate) fn find_display() -> Result<(), StartError> {
    match cfg!(target_os = "linux") && !has_display() {
        true => Err(StartError::NoDisplay),
        false => Ok(()),
    }
}

fn has_display() -> bool {
    ["WAYLAND_DISPLAY", "WAYLAND_SOCKET", "DISPLAY"]
        .into_iter()
        .any(|name| std::env::var_os(name).is_some_and(|value| !value.is_empty()))
}

/// Interprets the text of a library's panic.
fn explained(text: &str) -> StartError {
    if text.contains("failed to find a matching configuration") {
        StartError::NoGl
    } else if text.contains("could not be loaded") || text.contains(".so") {
        // "Library libxkbcommon-x11.so could not be loaded."
        StartError::Library(text.to_owned())
    } else {
        StartError::Other(text.to_owned())
    }
}

/// Interprets an error of the display: "os error at FILE OF THE LIBRARY:LINE: REASON".
fn display_error(error: &dyn std::error::Error) -> StartError {
    let text = error.to_string();
    let reason = text.rsplit(": ").next().unwrap_or(&text).to_owned();
    match reason.contains("shared librar") {
        true => StartError::Library(reason),
        false => StartError::Display(reason),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn opengl_is_chosen_only_where_a_graphics_card_does_it_and_never_against_the_user() {
        for (has_card, gl_is_software) in
            [(false, false), (false, true), (true, false), (true, true)]
        {
            let facts = Facts { has_card, gl_is_software };
            let expected = if facts == (Facts { has_card: true, gl_is_software: false }) {
                Shell::Gl
            } else {
                Shell::Software
            };
            assert_eq!(chosen(Shell::Automatic, facts), expected, "{facts:?}");
            assert_eq!(chosen(Shell::Gl, facts), Shell::Gl);
            assert_eq!(chosen(Shell::Software, facts), Shell::Software);
        }
        assert!(is_yes("1") && is_yes("true") && is_yes("Y"));
        assert!(!is_yes("") && !is_yes("0") && !is_yes("False"));
    }

    #[test]
    fn panics_of_libraries_become_sentences() {
        let missing = "Library libxkbcommon-x11.so could not be loaded.";
        assert_eq!(explained(missing), StartError::Library(missing.to_owned()));
        let no_gl = "failed to find a matching configuration for creating glutin config";
        assert_eq!(explained(no_gl), StartError::NoGl);
        assert_eq!(explained("else"), StartError::Other("else".to_owned()));
    }
}

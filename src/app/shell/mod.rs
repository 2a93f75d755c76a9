//! The shells: what stands between the editor and the windows of the system.
//!
//! `gl` is eframe, which paints with OpenGL. `software` paints with the processor alone, straight
//! into the memory of the window, and needs no OpenGL: it shows the same bytes, and where OpenGL is
//! itself software it is several times as fast. The editor does not know which of them it is in.

mod gl;
mod software;
mod surface;
mod window;

use std::panic::{AssertUnwindSafe, catch_unwind};

use egui::{Context, Ui, ViewportBuilder};
use winit::raw_window_handle::{HasDisplayHandle, HasWindowHandle};

/// What paints the window.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Shell {
    /// OpenGL if there is a graphics card for it, otherwise the processor.
    #[default]
    Automatic,
    /// OpenGL.
    Gl,
    /// The processor, without OpenGL.
    Software,
}

/// The window, for dialogs of the system that stand over it.
pub(crate) trait Parent: HasWindowHandle + HasDisplayHandle {}

impl<T: HasWindowHandle + HasDisplayHandle> Parent for T {}

/// What a shell shows.
pub(crate) trait Editor {
    /// Shows a frame, and answers what the user did in it.
    fn frame(&mut self, ui: &mut Ui, parent: &dyn Parent);

    /// The user has left: the window was asked to close, and the editor did not object. A window
    /// that is lost, to a display that ends or by a fault, is not left.
    fn left(&mut self);
}

/// Makes the editor once the window stands.
pub(crate) type Make = Box<dyn FnOnce(&Context) -> Box<dyn Editor>>;

/// Why no window could be opened, or why it was lost.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum StartError {
    /// Nothing to show a window on.
    #[error("no display to open a window on: neither DISPLAY nor WAYLAND_DISPLAY is set")]
    NoDisplay,
    /// The display does not answer.
    #[error("the display cannot be reached: {0}")]
    Display(String),
    /// A library of the system is missing.
    #[error("the system lacks a library that windows need: {0}")]
    Library(String),
    /// No OpenGL, not even in software.
    #[error("OpenGL was not found: install a graphics driver, or use --shell software")]
    NoGl,
    /// The window is gone, though it was not closed.
    #[error("the window was lost: {0}")]
    Lost(String),
    /// Something else.
    #[error("the window could not be opened: {0}")]
    Other(String),
}

/// What the choice of a shell depends on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Facts {
    /// Whether a graphics card can be opened.
    has_card: bool,
    /// Whether OpenGL was told to be software.
    gl_is_software: bool,
}

/// Shows the editor in a window, and comes back when it is closed.
///
/// # Errors
/// If no window can be opened, or if it is lost.
pub(crate) fn run(shell: Shell, window: ViewportBuilder, make: Make) -> Result<(), StartError> {
    // Until the window stands, the system's libraries tell of their absence by panics. They are
    // told in one sentence instead of being printed.
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
        Err(explained(text.unwrap_or("for a reason it did not tell")))
    })
}

/// The shell that is used: never [`Shell::Automatic`].
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

/// Whether Mesa takes the value of a variable for a yes.
fn is_yes(value: &str) -> bool {
    !matches!(value.to_ascii_lowercase().as_str(), "" | "0" | "n" | "no" | "f" | "false" | "off")
}

/// Whether a graphics card can be opened to draw with.
fn has_card() -> bool {
    if !cfg!(target_os = "linux") {
        return true;
    }
    let devices = std::fs::read_dir("/dev/dri").into_iter().flatten().flatten();
    let mut cards =
        devices.filter(|entry| entry.file_name().to_string_lossy().starts_with("renderD"));
    cards.any(|card| std::fs::File::options().read(true).write(true).open(card.path()).is_ok())
}

/// Whether there is anything to show a window on.
///
/// # Errors
/// If there is nothing.
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

/// What the panic of a library means.
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

/// What an error of the display means: "os error at FILE OF THE LIBRARY:LINE: REASON".
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

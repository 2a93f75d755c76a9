//! Opens the window, or reports in one sentence why it cannot.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;

use eframe::NativeOptions;
use egui::ViewportBuilder;

use crate::app::editor::App;
use crate::app::theme;
use crate::io::{self, OwnFolders, Preferences};

/// Why no window could be opened.
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
    #[error("OpenGL was not found: install a graphics driver, or libgl1 for software rendering")]
    NoGl,
    /// Something else.
    #[error("the window could not be opened: {0}")]
    Other(String),
}

/// Opens the editor with these files, and comes back when it is left: models are shown
/// alone, framed and lit; a scene is opened in place of the first one.
///
/// # Errors
/// If no window can be opened.
pub fn run(files: Vec<PathBuf>) -> Result<(), StartError> {
    if cfg!(target_os = "linux") && !has_display() {
        return Err(StartError::NoDisplay);
    }
    // Until the window stands, the system's libraries tell of their absence by panics. They are
    // told in one sentence instead of being printed.
    let own = OwnFolders::of_user().map(|folders| (Preferences::load(&folders), folders));
    let options = options(own.as_ref().map(|((preferences, _), _)| preferences));
    let earlier = std::panic::take_hook();
    std::panic::set_hook(Box::new(|_| {}));
    let started = catch_unwind(AssertUnwindSafe(|| {
        eframe::run_native(
            "Marraztu",
            options,
            Box::new(move |creation| {
                std::panic::set_hook(earlier);
                theme::install(&creation.egui_ctx);
                let (scene, view) = io::default_scene();
                let mut app = App::new(scene, view);
                app.use_system_dialogs();
                if let Some(((preferences, said), folders)) = own {
                    app.keep_in(&creation.egui_ctx, folders, preferences, said);
                }
                app.load_at_start(&creation.egui_ctx, files);
                Ok(Box::new(app))
            }),
        )
    }));
    match started {
        Ok(Ok(())) => Ok(()),
        Ok(Err(error)) => Err(explained(&error)),
        Err(panic) => {
            let text = panic.downcast_ref::<String>().map(String::as_str);
            let text = text.or_else(|| panic.downcast_ref::<&str>().copied());
            let text = text.unwrap_or("for a reason it did not tell").to_owned();
            // "Library libxkbcommon-x11.so could not be loaded."
            Err(match text.contains("could not be loaded") || text.contains(".so") {
                true => StartError::Library(text),
                false => StartError::Other(text),
            })
        }
    }
}

fn has_display() -> bool {
    ["WAYLAND_DISPLAY", "WAYLAND_SOCKET", "DISPLAY"]
        .into_iter()
        .any(|name| std::env::var_os(name).is_some_and(|value| !value.is_empty()))
}

/// The window, as large as it was last time.
fn options(preferences: Option<&Preferences>) -> NativeOptions {
    let size = preferences.and_then(|preferences| preferences.window);
    NativeOptions {
        viewport: ViewportBuilder::default()
            .with_title("Marraztu")
            .with_app_id("marraztu")
            .with_inner_size(size.unwrap_or([1280.0, 800.0]))
            .with_maximized(preferences.is_some_and(|preferences| preferences.maximized))
            .with_min_inner_size([640.0, 400.0])
            .with_drag_and_drop(true),
        ..NativeOptions::default()
    }
}

fn explained(error: &eframe::Error) -> StartError {
    match error {
        eframe::Error::WinitEventLoop(error) => {
            // "os error at <a file of the library>:<line>: <what happened>"
            let text = error.to_string();
            let reason = text.rsplit(": ").next().unwrap_or(&text).to_owned();
            match reason.contains("shared librar") {
                true => StartError::Library(reason),
                false => StartError::Display(reason),
            }
        }
        eframe::Error::Glutin(_)
        | eframe::Error::NoGlutinConfigs(..)
        | eframe::Error::OpenGL(_) => StartError::NoGl,
        _ => StartError::Other(error.to_string()),
    }
}

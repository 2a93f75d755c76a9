//! Opens the window, or reports in one sentence why it cannot.

use std::path::PathBuf;
use std::process::Command;

use egui::{IconData, ViewportBuilder};

use crate::app::editor::App;
use crate::app::shell::{self, Shell, StartError};
use marraztu_core::accuracy::AccuracyPreset;
use marraztu_core::base::threads::{self, Caller};
use marraztu_io::{OwnFolders, Preferences};

/// The threads that libraries of the window start without looking at a limit, with those of the
/// editor.
const THREADS: usize = 16;

/// Opens the editor with these files and returns when the user leaves it. Models are shown alone,
/// framed and lit; a scene replaces the first one. A preset sets the accuracy of the first scene.
///
/// # Errors
/// If no window can be opened, or if it is lost.
pub fn run(
    files: &[PathBuf],
    shell: Shell,
    preset: Option<&'static AccuracyPreset>,
) -> Result<(), StartError> {
    shell::find_display()?;
    if !threads::are_available(THREADS) || threads::start(None, Caller::Waits).is_err() {
        return Err(StartError::Threads);
    }
    let named = files.to_vec();
    let own = OwnFolders::of_user().map(|folders| (Preferences::load(&folders), folders));
    let window = window(own.as_ref().map(|((preferences, _), _)| preferences));
    let opened = shell::run(
        shell,
        window,
        Box::new(move |ctx| {
            let mut app = App::start(ctx, own);
            if let Some(preset) = preset {
                app.use_preset(preset);
            }
            app.open_at_start(ctx, named);
            app
        }),
    );
    match opened {
        // A graphics card without usable OpenGL is noticed only here.
        Err(StartError::NoGl) if shell == Shell::Automatic => again_without_gl(files, preset),
        opened => opened,
    }
}

/// Restarts the program without OpenGL: a process can enter the event loop of its window only once.
fn again_without_gl(files: &[PathBuf], preset: Option<&AccuracyPreset>) -> Result<(), StartError> {
    let failed = |error: std::io::Error| StartError::Other(error.to_string());
    let mut program = Command::new(std::env::current_exe().map_err(failed)?);
    program.args(["--shell", "software"]);
    if let Some(preset) = preset {
        program.args(["--preset", preset.word]);
    }
    program.arg("--").args(files);
    become_it(program).map_err(failed)
}

/// Describes the window, with the size of the last session.
fn window(preferences: Option<&Preferences>) -> ViewportBuilder {
    let size = preferences.and_then(|preferences| preferences.window);
    ViewportBuilder::default()
        .with_title("Marraztu")
        .with_app_id("marraztu")
        // The system shows the icon of the program, and not egui's.
        .with_icon(IconData::default())
        .with_inner_size(size.unwrap_or(Preferences::WINDOW))
        .with_maximized(preferences.is_some_and(|preferences| preferences.maximized))
        .with_min_inner_size([640.0, 400.0])
        .with_drag_and_drop(true)
}

/// Replaces this process by another program. Returns only if that fails.
#[cfg(unix)]
fn become_it(mut program: Command) -> std::io::Result<()> {
    use std::os::unix::process::CommandExt;
    Err(program.exec())
}

/// Runs another program and exits with its status.
#[cfg(not(unix))]
fn become_it(mut program: Command) -> std::io::Result<()> {
    std::process::exit(program.status()?.code().unwrap_or(1))
}

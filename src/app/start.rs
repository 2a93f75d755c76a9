//! Opens the window, or reports in one sentence why it cannot.

use std::path::PathBuf;
use std::process::Command;

use crate::app::editor::App;
use crate::app::shell::{self, Editor, Shell, StartError};
use crate::app::theme;
use crate::io;

/// Opens the editor with these files, and comes back when it is left: models are put into the first
/// scene with their own materials, a scene is opened in its place.
///
/// # Errors
/// If no window can be opened, or if it is lost.
pub fn run(files: &[PathBuf], shell: Shell) -> Result<(), StartError> {
    let named = files.to_vec();
    let opened = shell::run(
        shell,
        Box::new(move |ctx| -> Box<dyn Editor> {
            theme::install(ctx);
            let (scene, view) = io::default_scene();
            let mut app = App::new(scene, view);
            app.use_system_dialogs();
            app.load_at_start(ctx, named);
            Box::new(app)
        }),
    );
    match opened {
        Err(StartError::NoGl) if shell == Shell::Automatic => again_without_gl(files),
        opened => opened,
    }
}

/// Runs the program again, without OpenGL: a process can enter the loop of its window only once.
fn again_without_gl(files: &[PathBuf]) -> Result<(), StartError> {
    let failed = |error: std::io::Error| StartError::Other(error.to_string());
    let mut program = Command::new(std::env::current_exe().map_err(failed)?);
    program.args(["--shell", "software", "--"]).args(files);
    become_it(program).map_err(failed)
}

/// Goes on as another program. Comes back only if that cannot be started.
#[cfg(unix)]
fn become_it(mut program: Command) -> std::io::Result<()> {
    use std::os::unix::process::CommandExt;
    Err(program.exec())
}

/// Runs another program in place of this one.
#[cfg(not(unix))]
fn become_it(mut program: Command) -> std::io::Result<()> {
    std::process::exit(program.status()?.code().unwrap_or(1))
}

//! Opens the editor on Windows without a console window, by starting marraztu.exe next to it.
//!
//! marraztu.exe itself belongs to the console, so its commands print where they were typed.
//! tools/ports/windows compiles this file.

#![windows_subsystem = "windows"]

use std::os::windows::process::CommandExt;
use std::process::{Command, ExitCode};

/// `CREATE_NO_WINDOW`: the started program gets no console window.
const NO_CONSOLE: u32 = 0x0800_0000;

fn main() -> ExitCode {
    let started = std::env::current_exe().and_then(|own| {
        let mut program = Command::new(own.with_file_name("marraztu.exe"));
        program.args(std::env::args_os().skip(1)).creation_flags(NO_CONSOLE).spawn()
    });
    ExitCode::from(u8::from(started.is_err()))
}

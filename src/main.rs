//! Arguments: the editor, or a headless command.

mod command_line;

fn main() -> std::process::ExitCode {
    command_line::run()
}

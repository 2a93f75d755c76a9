//! Arguments: the editor, or a headless command.

mod cli;

fn main() -> std::process::ExitCode {
    cli::run()
}

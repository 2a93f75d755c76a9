//! Arguments: the editor, or a headless command.

fn main() -> std::process::ExitCode {
    use std::io::Write as _;
    let files = std::env::args_os().skip(1).map(Into::into).collect();
    match marraztu::app::run(files) {
        Ok(()) => std::process::ExitCode::SUCCESS,
        Err(error) => {
            let _ = writeln!(std::io::stderr(), "marraztu: {error}");
            std::process::ExitCode::FAILURE
        }
    }
}

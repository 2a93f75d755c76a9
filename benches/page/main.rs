//! Writes `docs/speed.md` from the last run of `cargo bench --bench drawing` and, if there is one,
//! a table of other renderers' times. `tools/speed.sh` runs all steps.
//!
//! The text is `page.md` in this folder; names in double braces are filled in.

mod measured;
mod peers;
mod plots;
mod tables;

use std::error::Error;
use std::path::Path;
use std::process::Command;

use measured::Measured;

fn main() -> Result<(), Box<dyn Error>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let measured = Measured::read(&target(root).join("criterion"))?;
    let docs = root.join("docs");
    std::fs::create_dir_all(docs.join("speed"))?;
    for (name, svg) in plots::all(&measured)? {
        std::fs::write(docs.join("speed").join(name), svg)?;
    }
    let text = include_str!("page.md")
        .replace("{{machine}}", &machine())
        .replace("{{stages}}", &tables::stages(&measured)?)
        .replace("{{effects}}", &tables::effects(&measured)?)
        .replace("{{textures}}", &tables::textures(&measured)?)
        .replace("{{objects}}", &tables::objects(&measured)?)
        .replace("{{threads}}", &tables::threads(&measured)?)
        .replace("{{peers}}", &peers::table(&docs.join("speed/peers.csv"))?);
    let page = docs.join("speed.md");
    std::fs::write(&page, text)?;
    print(&format!("written: {}\n", page.display()));
    Ok(())
}

#[expect(clippy::print_stdout, reason = "a program's own words")]
fn print(text: &str) {
    print!("{text}");
}

/// Returns cargo's build folder.
fn target(root: &Path) -> std::path::PathBuf {
    std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), Into::into)
}

/// Lists the machine on which the figures were measured.
fn machine() -> String {
    let said = |program: &str, arguments: &[&str]| {
        let output = Command::new(program).args(arguments).output();
        output.map_or_else(
            |_| String::new(),
            |o| String::from_utf8_lossy(&o.stdout).trim().to_owned(),
        )
    };
    let processors = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model =
        processors.lines().find_map(|line| line.strip_prefix("model name")?.split_once(": "));
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    format!(
        "- {}, {}, {}\n- {}, {threads} threads, {} instructions",
        said("date", &["-u", "+%Y-%m-%d"]),
        said("git", &["describe", "--always", "--dirty", "--exclude", "*"]),
        said("rustc", &["--version"]).split(" (").next().unwrap_or_default(),
        model.map_or("a processor without a name", |(_, name)| name),
        level(),
    )
}

fn level() -> String {
    let all = format!("{:?}", fearless_simd::Level::new());
    all.split(['(', ' ']).next().unwrap_or_default().to_owned()
}

//! The script that builds the page, with Cargo, rustup and npm replaced by scripts that note what
//! they are asked for: nothing is compiled.
#![cfg(unix)]
#![expect(clippy::unwrap_used, reason = "a helper of tests that fails is a test that fails")]

use std::fs;
use std::os::unix::fs::PermissionsExt as _;
use std::path::Path;
use std::process::Command;

use tempfile::TempDir;

const ROOT: &str = env!("CARGO_MANIFEST_DIR");

/// The real Cargo answers questions; instead of a build, it puts a file where the output belongs.
const CARGO: &str = r#"#!/bin/sh
[ "$1" = build ] || exec "$REAL_CARGO" "$@"
echo "$@" >>"$NOTES"
mkdir -p "$OUTPUT/wasm32-wasip1/web" && echo module >"$OUTPUT/wasm32-wasip1/web/marraztu_web.wasm"
"#;

const NPM: &str = r"#!/bin/sh
mkdir -p package/dist && touch package/LICENSE-MIT
for name in index wasi wasi_defs fd fs_mem fs_opfs strace debug; do
  echo >package/dist/$name.js
done
tar czf shim.tgz package
";

/// Runs `tools/ports/web --quick`, with the folder of Cargo's output in a variable. Returns whether
/// it has succeeded, and the folder with the `page`, the `output` and the `notes`.
fn build(npm: &str, variable: &str) -> (bool, TempDir) {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    fs::create_dir(at("bin")).unwrap();
    for (name, text) in [("cargo", CARGO), ("npm", npm), ("rustup", "#!/bin/sh\n")] {
        let program = at("bin").join(name);
        fs::write(&program, text).unwrap();
        fs::set_permissions(&program, fs::Permissions::from_mode(0o755)).unwrap();
    }
    fs::write(at("notes"), "").unwrap();
    let path = format!("{}:{}", at("bin").display(), std::env::var("PATH").unwrap());
    let mut script = Command::new(Path::new(ROOT).join("tools/ports/web"));
    script.arg("--quick").arg(at("page")).env("PATH", path);
    script.env_remove("CARGO_TARGET_DIR").env_remove("CARGO_BUILD_TARGET_DIR");
    script.env(variable, at("output")).env("OUTPUT", at("output"));
    script.env("REAL_CARGO", env!("CARGO")).env("NOTES", at("notes"));
    let done = script.output().unwrap();
    (done.status.success(), folder)
}

#[test]
fn the_page_is_made_wherever_cargo_puts_its_output() {
    for variable in ["CARGO_TARGET_DIR", "CARGO_BUILD_TARGET_DIR"] {
        let (succeeded, folder) = build(NPM, variable);
        assert!(succeeded, "{variable}");
        for name in ["marraztu.wasm", "index.html", "wasi/index.js", "examples/chess"] {
            assert!(folder.path().join("page").join(name).exists(), "{variable}: {name}");
        }
    }
}

#[test]
fn nothing_is_compiled_if_the_page_cannot_be_finished() {
    let (succeeded, folder) = build("#!/bin/sh\nexit 1\n", "CARGO_TARGET_DIR");
    assert!(!succeeded);
    assert_eq!(fs::read_to_string(folder.path().join("notes")).unwrap(), "");
}

#[test]
fn a_quick_build_leaves_no_crate_in_one_unit() {
    let (_, folder) = build(NPM, "CARGO_TARGET_DIR");
    let notes = fs::read_to_string(folder.path().join("notes")).unwrap();
    let manifest = fs::read_to_string(Path::new(ROOT).join("Cargo.toml")).unwrap();
    let sections = manifest.split("\n[").filter_map(|section| section.split_once("]\n"));
    let whole: Vec<&str> = sections
        .filter(|(name, text)| {
            name.starts_with("profile.web") && text.contains("codegen-units = 1")
        })
        .map(|(name, _)| name)
        .collect();
    assert!(!whole.is_empty(), "the page is compiled in many units anyway");
    for name in whole {
        assert!(notes.contains(&format!("{name}.codegen-units=16")), "{name}: {notes}");
    }
}

//! Tells the program which commit it is built from, if git knows.
//!
//! The script runs again only if the sources change. A commit by itself causes no build, except of
//! a release: `tools/ports/common` sets its time. Sources that differ from the commit are marked as
//! changed. Development builds name no commit: a script that runs again compiles the whole library,
//! even if only the command line was edited.

use std::path::Path;
use std::process::Command;

fn main() {
    if std::env::var_os("PROFILE").is_none_or(|profile| profile != "release") {
        println!("cargo:rerun-if-changed=build.rs");
        return;
    }
    let sources = ["src", "crates", "build.rs", "Cargo.toml", "Cargo.lock"];
    for source in sources {
        println!("cargo:rerun-if-changed={source}");
    }
    println!("cargo:rerun-if-env-changed=SOURCE_DATE_EPOCH");
    // A copy of the sources within another repository is not of that repository's commit.
    if !Path::new(".git").exists() {
        return;
    }
    let Some(commit) = git(&["rev-parse", "--short=10", "HEAD"]) else { return };
    let changed = git(&[&["status", "--porcelain", "--"], &sources[..]].concat());
    let mark = if changed.is_some_and(|list| !list.is_empty()) { ", with changes" } else { "" };
    println!("cargo:rustc-env=MARRAZTU_COMMIT={commit}{mark}");
}

/// The output of a git command; `None` without git or if it fails.
fn git(arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").args(arguments).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    output.status.success().then(|| text.trim().to_owned())
}

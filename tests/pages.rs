//! Documentation is checked against the program: lists equal its tables, links lead to files, and
//! every command shown runs in a fresh clone.
//!
//! `tools/pages.sh` sets `MARRAZTU_WRITE_PAGES=1`, with which this test writes the lists.

#![expect(clippy::unwrap_used, reason = "a helper of tests that fails is a test that fails")]

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use marraztu_core::accuracy::AXES;
use marraztu_io as io;
use marraztu_lab::suite::SUITE;
use serde_json::Value as Json;
use tempfile::TempDir;

/// Pages for users and contributors.
const PAGES: &[&str] = &[
    "README.md",
    "ARCHITECTURE.md",
    "CONTRIBUTING.md",
    "CHANGELOG.md",
    "docs/accuracy.md",
    "docs/breakages.md",
    "docs/effects.md",
    "docs/engines.md",
    "docs/glossary.md",
    "docs/install.md",
    "docs/json.md",
    "docs/keys.md",
    "docs/many.md",
    "docs/python.md",
    "docs/speed.md",
    "docs/stability.md",
    "docs/tasks.md",
    "fuzz/README.md",
    "python/README.md",
];

/// Pages with measured figures.
const EVIDENCE: &[&str] =
    &["docs/accuracy.md", "docs/breakages.md", "docs/speed.md", "docs/stability.md"];

/// The most commits between the figures of a release and the release.
const STALE: usize = 150;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn page(name: &str) -> String {
    let text = std::fs::read_to_string(root().join(name));
    text.unwrap_or_else(|error| panic!("{name}: {error}")).replace("\r\n", "\n")
}

/// Compares a page with its expected text, or writes it if requested.
#[track_caller]
fn holds(name: &str, expected: &str) {
    if std::env::var_os("MARRAZTU_WRITE_PAGES").is_some() {
        std::fs::write(root().join(name), expected).unwrap();
    }
    assert!(page(name) == expected, "{name} is not current: run tools/pages.sh\n{expected}");
}

/// A folder with the part of a clone that the commands read.
fn clone() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    copy(&root().join("assets"), &folder.path().join("assets"));
    folder
}

fn copy(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).unwrap();
    for entry in std::fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        let to = to.join(entry.file_name());
        if entry.file_type().unwrap().is_dir() {
            copy(&entry.path(), &to);
        } else {
            std::fs::copy(entry.path(), to).unwrap();
        }
    }
}

/// Runs a shell command in `folder` with the program on the path.
fn shell(folder: &Path, line: &str) -> Output {
    let program = Path::new(env!("CARGO_BIN_EXE_marraztu"));
    let mut path = program.parent().unwrap().as_os_str().to_owned();
    path.push(":");
    path.push(std::env::var_os("PATH").unwrap_or_default());
    let mut command = Command::new("bash");
    command.args(["-euo", "pipefail", "-c", line]).current_dir(folder).env("PATH", path);
    for display in ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"] {
        command.env_remove(display);
    }
    command.stdin(Stdio::null()).output().unwrap()
}

/// The lines of all code blocks of a kind; lines that end in `\` are joined with the next one.
fn lines_of(kind: &str, text: &str) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    let mut inside = false;
    for line in text.lines() {
        if line.starts_with("```") {
            inside = line == format!("```{kind}");
            continue;
        }
        if !inside || line.trim().is_empty() || line.trim_start().starts_with('#') {
            continue;
        }
        match lines.last_mut().filter(|last| last.ends_with('\\')) {
            Some(last) => {
                last.pop();
                last.push_str(line.trim_start());
            }
            None => lines.push(line.to_owned()),
        }
    }
    lines
}

#[test]
fn the_page_of_keys_is_the_table_of_actions() {
    let output = shell(root(), "marraztu keys --markdown");
    let table = String::from_utf8(output.stdout).unwrap().replace("Cmd", "Ctrl");
    assert!(table.lines().count() > 50, "{table}");
    let text = page("docs/keys.md");
    let (head, _) = text.split_once("\n| ").unwrap_or((text.trim_end(), ""));
    holds("docs/keys.md", &format!("{}\n\n{table}", head.trim_end()));
}

#[test]
fn the_page_of_accuracy_lists_every_axis_with_every_choice() {
    let mut table = String::from("| axis | option | choices |\n|---|---|---|\n");
    for axis in AXES {
        let default = axis.default_choice().word;
        let words = axis.choices.iter().map(|choice| match choice.word == default {
            true => format!("**{}**", choice.word),
            false => choice.word.to_owned(),
        });
        let words: Vec<String> = words.collect();
        let _ = writeln!(table, "| {} | `--{}` | {} |", axis.what, axis.key, words.join(", "));
    }
    holds_part("axes", &table);
}

#[test]
fn the_page_of_accuracy_lists_every_scene_of_the_suite() {
    let mut table = String::from("| scene | shows | axes |\n|---|---|---|\n");
    for scene in SUITE {
        let _ = writeln!(table, "| {} | {} | {} |", scene.word, scene.what, scene.axes.join(", "));
    }
    holds_part("suite", &table);
}

/// Compares a generated part of docs/accuracy.md with its expected text, or writes it.
#[track_caller]
fn holds_part(part: &str, expected: &str) {
    let text = page("docs/accuracy.md");
    let [begin, end] =
        [": made by tools/pages.sh", ": end"].map(|it| format!("<!-- {part}{it} -->\n"));
    let (before, rest) = text.split_once(&begin).unwrap();
    let (_, after) = rest.split_once(&end).unwrap();
    holds("docs/accuracy.md", &format!("{before}{begin}\n{expected}\n{end}{after}"));
}

#[test]
fn every_command_of_the_program_on_a_page_runs_in_a_plain_clone() {
    let folder = clone();
    let mut run = 0;
    for name in PAGES {
        for line in lines_of("sh", &page(name)) {
            if !line.split(['|', ' ']).any(|word| word == "marraztu") {
                continue;
            }
            let output = shell(folder.path(), &line);
            let error = String::from_utf8_lossy(&output.stderr);
            assert!(output.status.success(), "{name}: {line}\n{error}");
            run += 1;
        }
    }
    assert!(run >= 10, "only {run} commands were found");
}

/// Checks that a JSON value has everything that an example shows; arrays of an example may be
/// shorter.
#[track_caller]
fn shows(example: &Json, real: &Json) {
    match (example, real) {
        (Json::Object(example), Json::Object(real)) => {
            let keys = |object: &serde_json::Map<String, Json>| {
                object.keys().cloned().collect::<BTreeSet<String>>()
            };
            assert_eq!(keys(example), keys(real));
            example.iter().for_each(|(key, value)| shows(value, &real[key]));
        }
        (Json::Array(example), Json::Array(real)) => {
            assert!(example.len() <= real.len() && example.is_empty() == real.is_empty());
            example.iter().zip(real).for_each(|(example, real)| shows(example, real));
        }
        _ => assert_eq!(example, real),
    }
}

/// Adds the keys of all objects in a JSON value.
fn add_keys(value: &Json, keys: &mut BTreeSet<String>) {
    match value {
        Json::Object(object) => object.iter().for_each(|(key, value)| {
            keys.insert(key.clone());
            add_keys(value, keys);
        }),
        Json::Array(items) => items.iter().for_each(|item| add_keys(item, keys)),
        _ => {}
    }
}

#[test]
fn the_page_of_json_shows_the_output_of_its_commands_and_describes_every_key() {
    let text = page("docs/json.md");
    let folder = clone();
    let (mut examples, mut keys) = (0, BTreeSet::new());
    // Each example follows its command.
    for part in text.split("```sh\n").skip(1) {
        let (command, rest) = part.split_once("\n```").unwrap();
        let output = shell(folder.path(), command);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let real: Json = serde_json::from_slice(&output.stdout).unwrap();
        let (_, example) = rest.split_once("```json\n").unwrap();
        let (example, _) = example.split_once("```").unwrap();
        shows(&serde_json::from_str(example).unwrap(), &real);
        add_keys(&real, &mut keys);
        examples += 1;
    }
    let tables: Vec<&str> = text.lines().filter(|line| line.starts_with('|')).collect();
    let described = |key: &String| tables.iter().any(|row| row.contains(&format!("`{key}`")));
    let missing: Vec<&String> = keys.iter().filter(|key| !described(key)).collect();
    assert!(missing.is_empty(), "docs/json.md does not describe {missing:?}");
    assert_eq!(examples, 3);
}

#[test]
fn every_script_test_bench_and_example_that_a_page_names_is_there() {
    let has = |folder: &str, name: &str| {
        ["", "crates/render"].iter().any(|package| {
            let folder = root().join(package).join(folder);
            folder.join(format!("{name}.rs")).is_file()
                || folder.join(name).join("main.rs").is_file()
        })
    };
    let mut found = 0;
    for name in PAGES {
        let text = page(name);
        let words: Vec<&str> = text.split([' ', '\n', '`', '(', ')', ',']).collect();
        for (i, word) in words.iter().enumerate() {
            let next = words.get(i + 1).unwrap_or(&"").trim_end_matches(['.', ':', ';']);
            let folder = match *word {
                "--test" => "tests",
                "--bench" => "benches",
                "--example" => "examples",
                script if script.starts_with(".ci/") || script.starts_with("tools/") => {
                    let script = script.trim_end_matches(['.', ':', ';']);
                    assert!(root().join(script).exists(), "{name} names {script}");
                    found += 1;
                    continue;
                }
                _ => continue,
            };
            assert!(has(folder, next), "{name} names {word} {next}");
            found += 1;
        }
    }
    assert!(found > 10, "only {found} names were found");
}

#[test]
fn every_link_of_a_page_leads_to_a_file() {
    for name in PAGES {
        let text = page(name);
        let folder = root().join(name).parent().map(PathBuf::from).unwrap();
        let links = text.match_indices("](").filter_map(|(at, _)| text[at + 2..].split(')').next());
        for link in links.filter(|link| !link.contains("://") && !link.starts_with('#')) {
            let file = link.split('#').next().unwrap();
            assert!(folder.join(file).exists(), "{name} links to {link}");
        }
    }
}

#[test]
fn the_readme_is_short_and_its_scene_can_be_drawn() {
    let readme = page("README.md");
    assert!(readme.lines().count() <= 180, "the README has {} lines", readme.lines().count());
    let folder = clone();
    let scene = lines_of("ron", &readme).join("\n");
    std::fs::write(folder.path().join("ship.marraztu"), scene).unwrap();
    let output = shell(folder.path(), "marraztu render ship.marraztu --size 160x120");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let picture = io::load_picture(&folder.path().join("ship.png")).unwrap();
    let seen = picture.pixels().iter().filter(|pixel| **pixel != picture.pixel(0, 0)).count();
    assert!(seen > 1000, "only {seen} pixels show the ship");
}

#[test]
fn every_mistake_of_the_mutation_tests_can_be_made_in_the_sources_as_they_are() {
    let table = page("tests/breakages/table.toml");
    let text = |row: &str, key: &str| {
        let line = row.lines().find_map(|line| line.strip_prefix(&format!("{key} = \"")));
        let text = line.and_then(|line| line.strip_suffix('"')).unwrap_or_else(|| panic!("{row}"));
        text.replace("\\n", "\n").replace("\\\"", "\"")
    };
    let rows: Vec<&str> = table.split("[[breakage]]").skip(1).collect();
    assert!(rows.len() > 100, "only {} rows were found", rows.len());
    for row in rows {
        let (file, from) = (text(row, "file"), text(row, "from"));
        let times = page(&file).matches(&from).count();
        assert_eq!(times, 1, "{file} has to hold once what a row of the table changes:\n{from}");
    }
}

#[test]
fn every_path_that_a_page_names_is_there() {
    let is_part = |letter: char| letter.is_alphanumeric() || "/._-".contains(letter);
    // Pages omit `crates/`, the `src` of a crate, and the crates that most paths are in.
    let roots = ["", "src/", "crates/", "crates/core/src/", "crates/render/src/"];
    let in_crate = |path: &str| {
        let (name, rest) = path.split_once('/').unwrap_or((path, ""));
        format!("crates/{name}/src/{rest}")
    };
    let mut found = 0;
    for name in PAGES {
        let text = page(name);
        for quoted in text.split('`').skip(1).step_by(2) {
            let is_path = quoted.contains('/') && quoted.chars().all(is_part);
            // Skips folders of the user, groups of benchmarks and placeholders, which are not paths
            // of the project, and build output, which may not exist yet.
            let is_made = quoted.starts_with("target/");
            if !is_path || is_made || quoted.contains("..") || quoted.contains("TARGET") {
                continue;
            }
            let is_there = |path: &String| {
                let path = root().join(path);
                path.exists() || path.with_extension("rs").exists()
            };
            let mut paths = roots.map(|root| format!("{root}{quoted}")).to_vec();
            paths.push(in_crate(quoted));
            assert!(paths.iter().any(is_there), "{name} names {quoted}");
            found += 1;
        }
    }
    assert!(found > 100, "only {found} paths were found");
}

/// The commits that a page names after a day, "2026-11-22, 757b107-dirty", with whether the tree
/// had other changes.
fn commits_of(text: &str) -> BTreeSet<(String, bool)> {
    let is_day = |word: &str| {
        let shape = |c: char| if c.is_ascii_digit() { '0' } else { c };
        word.chars().map(shape).eq("0000-00-00".chars())
    };
    let words: Vec<&str> = text.split_whitespace().map(|word| word.trim_matches(',')).collect();
    let commit = |pair: &[&str]| {
        let name = pair[1].trim_end_matches('.');
        let (hash, is_dirty) = name.strip_suffix("-dirty").map_or((name, false), |it| (it, true));
        let is_hash = (7..=40).contains(&hash.len()) && hash.chars().all(|c| c.is_ascii_hexdigit());
        (is_day(pair[0]) && is_hash).then(|| (hash.to_owned(), is_dirty))
    };
    words.windows(2).filter_map(commit).collect()
}

/// What is wrong with the commits of a page. `distance` counts the commits since one of them, if it
/// is an ancestor.
fn stale(
    commits: &BTreeSet<(String, bool)>,
    distance: &dyn Fn(&str) -> Option<usize>,
    is_release: bool,
) -> Vec<String> {
    let fault = |(hash, is_dirty): &(String, bool)| match distance(hash) {
        None => Some(format!("{hash} is not an ancestor of this commit")),
        Some(count) if is_release && count > STALE => {
            Some(format!("{hash} is {count} commits old: run tools/evidence"))
        }
        Some(_) if is_release && *is_dirty => {
            Some(format!("{hash} had uncommitted changes: run tools/evidence"))
        }
        Some(_) => None,
    };
    commits.iter().filter_map(fault).collect()
}

/// The output of a git command in this repository; `None` if git fails.
fn git(arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").arg("-C").arg(root()).args(arguments).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    output.status.success().then(|| text.trim().to_owned())
}

/// Whether this is a release: `tools/release --check` says so, or the commit has the tag of a
/// version.
fn is_release() -> bool {
    let is_version = |tag: &str| {
        let digits = tag.strip_prefix('v').unwrap_or(tag);
        digits.starts_with(|c: char| c.is_ascii_digit())
    };
    std::env::var_os("MARRAZTU_RELEASE").is_some()
        || git(&["tag", "--points-at", "HEAD"]).is_some_and(|tags| tags.lines().any(is_version))
}

#[test]
fn every_page_of_figures_names_the_commit_that_was_measured() {
    for name in EVIDENCE {
        assert!(!commits_of(&page(name)).is_empty(), "{name} names no commit after a day");
    }
}

/// Archives and shallow clones have no history to look at, except that a release needs it.
#[test]
#[expect(clippy::print_stderr, reason = "who runs the tests has to see what is left out")]
fn figures_come_from_ancestors_of_this_commit_and_those_of_a_release_are_fresh() {
    // A copy of the sources within another repository is not of that repository's commit.
    let is_own = root().join(".git").exists();
    let shallow = git(&["rev-parse", "--is-shallow-repository"]).filter(|_| is_own);
    if shallow.as_deref() != Some("false") {
        assert!(std::env::var_os("MARRAZTU_RELEASE").is_none(), "a release needs its history");
        eprintln!("LEFT OUT: the history of the project is not here, so figures may be stale");
        return;
    }
    let distance = |hash: &str| {
        git(&["merge-base", "--is-ancestor", hash, "HEAD"])?;
        git(&["rev-list", "--count", &format!("{hash}..HEAD")])?.parse().ok()
    };
    let faults = PAGES.iter().filter(|name| name.starts_with("docs/")).flat_map(|name| {
        let faults = stale(&commits_of(&page(name)), &distance, is_release());
        faults.into_iter().map(move |fault| format!("{name}: {fault}"))
    });
    let faults: Vec<String> = faults.collect();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn strange_old_and_dirty_commits_of_figures_are_found() {
    let text = "- 2026-11-22, 757b107, rustc\n| 2026-11-29 625bcf0a-dirty | 2026-11-30 is a day, \
                2026-11-30, facade0. and not 2026-11-1 abcdef1";
    let commits = commits_of(text);
    let names = [("625bcf0a", true), ("757b107", false), ("facade0", false)];
    assert!(commits.iter().map(|(hash, is_dirty)| (hash.as_str(), *is_dirty)).eq(names));
    let distance = |hash: &str| match hash {
        "757b107" => Some(STALE + 1),
        "625bcf0a" => Some(STALE),
        _ => None,
    };
    assert_eq!(stale(&commits, &distance, false), ["facade0 is not an ancestor of this commit"]);
    let faults = stale(&commits, &distance, true);
    assert_eq!(faults.len(), 3, "{faults:?}");
    assert!(faults[0].contains("uncommitted") && faults[1].contains("151 commits old"));
}

//! Preferences, About, and the search words for both in the palette.
//!
//! Catches: words without a result, a remembered value that cannot be reset, recent files that
//! return after being cleared, a package without its licence.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use egui::accesskit::Role;
use egui::{Key, ThemePreference};
use egui_kittest::kittest::NodeT as _;
use marraztu::app::actions::Action;
use marraztu::app::actions::Chord::{Command, Named};
use marraztu::app::panels::{OpenPanels, Panel};
use marraztu_core::scene::UpAxis;
use marraztu_io::{Helpers, OwnFolders, Preferences};

use crate::dialogs::{CUBE, folder_with};
use crate::editor::Editor;
use crate::palette::listed;
use crate::panels::{click, control, type_text};

#[test]
fn the_palette_knows_the_words_that_people_type() {
    let mut editor = Editor::new();
    for (query, label) in [
        ("preferences", "Preferences"),
        ("settings", "Preferences"),
        ("options", "Preferences"),
        ("about", "About"),
        ("version", "About"),
        ("licence", "About"),
        ("license", "About"),
        ("copy", "Copy"),
        ("cut", "Cut"),
        ("paste", "Paste"),
        ("copy material", "Copy material"),
        ("z-fighting", "Lesson: Why surfaces show through each other"),
        ("jagged edges", "Lesson: Why edges are staircases"),
    ] {
        editor.press(Command(Key::K));
        type_text(&mut editor, query);
        assert_eq!(listed(&editor)[0], label, "{query}");
        editor.press(Named(Key::Escape));
    }
}

#[test]
fn about_says_version_commit_instructions_and_licences() {
    let mut editor = Editor::of_size(1280.0, 800.0);
    editor.perform(Action::Panel(Panel::About));
    for text in [env!("CARGO_PKG_VERSION"), "Commit", "Instructions", "MIT or Apache 2.0"] {
        assert!(editor.shows(text), "{text}");
    }
    assert!(editor.shows("ab_glyph 0."), "the first package");
    editor.press(Named(Key::Escape));
    assert!(!editor.shows("Instructions"));
}

#[test]
fn each_preference_is_changed_and_reset_at_its_row() {
    let mut editor = Editor::of_size(1280.0, 800.0);
    editor.press(Command(Key::Comma));
    assert!(editor.state().panels.has(Panel::Preferences));
    click(&mut editor, Role::RadioButton, "Theme: Dark");
    assert_eq!(editor.state().theme, ThemePreference::Dark);
    assert!(editor.state().panels.has(Panel::Preferences), "it stays open");
    click(&mut editor, Role::Button, "Reset: Theme");
    assert_eq!(editor.state().theme, ThemePreference::System);
    click(&mut editor, Role::RadioButton, "Up axis: Z");
    assert_eq!(editor.state().up, UpAxis::Z);
    editor.perform_all(&[Action::ToggleGrid, Action::ToggleWatch, Action::ToggleGizmo]);
    editor.perform(Action::Panel(Panel::Plan));
    click(&mut editor, Role::Button, "Reset everything");
    let state = editor.state();
    assert_eq!((state.up, state.helpers), (UpAxis::Y, Helpers::default()));
    assert!(!state.watches && state.gizmo);
    assert_eq!(state.panels, OpenPanels::DEFAULT.with(Panel::Preferences, true));
    let all = control(&editor, Role::Button, "Reset everything");
    assert!(all.accesskit_node().is_disabled(), "there is nothing to reset any more");
    editor.press(Named(Key::Escape));
    assert!(!editor.state().panels.has(Panel::Preferences));
}

#[test]
fn recent_files_that_were_cleared_do_not_come_back_from_the_disk() {
    let own = tempfile::tempdir().unwrap();
    let folders = OwnFolders::within(own.path());
    let (_folder, path) = folder_with("cube.obj", CUBE);
    let mut first = Preferences::default();
    first.note_recent(&path);
    first.save(&folders, &Preferences::default()).unwrap();
    let mut editor = Editor::keeping(own.path());
    assert_eq!(editor.state().recent.len(), 1);
    let ask = Preferences { recent: Vec::new(), ..first };
    editor.ask(marraztu::app::actions::Request::Preferences(Box::new(ask)));
    editor.harness.state_mut().end_keeping();
    assert_eq!(Preferences::load(&folders).0.recent, Vec::<std::path::PathBuf>::new());
}

/// Parses Cargo.lock: packages with the names of their dependencies.
fn locked(text: &str) -> BTreeMap<String, (String, Vec<String>)> {
    let mut packages = BTreeMap::new();
    for package in text.split("[[package]]").skip(1) {
        let field = |name: &str| {
            let line = package.lines().find(|line| line.starts_with(&format!("{name} = ")))?;
            line.split('"').nth(1).map(str::to_owned)
        };
        let needs = package.split_once("dependencies = [").map_or("", |(_, rest)| rest);
        let needs = needs.split(']').next().unwrap_or_default();
        let needs = needs.split('"').skip(1).step_by(2).map(str::to_owned).collect();
        let (name, version) = (field("name").unwrap(), field("version").unwrap());
        packages.insert(format!("{name} {version}"), (name, needs));
    }
    packages
}

#[test]
fn every_package_that_the_program_is_built_from_is_listed_with_its_licence() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let read = |name: &str| std::fs::read_to_string(root.join(name)).unwrap();
    let packages = locked(&read("Cargo.lock"));
    // What the crates of this workspace need; Cargo.lock also lists what only their tests need.
    let mut waiting: Vec<String> = Vec::new();
    for manifest in ["", "crates/core/", "crates/io/", "crates/render/", "crates/lab/"] {
        let cargo = read(&format!("{manifest}Cargo.toml"));
        let own = cargo.split_once("[dependencies]").unwrap().1.split("\n[").next().unwrap();
        let names = own.lines().filter_map(|line| line.strip_suffix(".workspace = true"));
        let others = names.filter(|name| !name.starts_with("marraztu"));
        waiting.extend(others.map(str::to_owned));
    }
    // A dependency is named without its version if there is only one.
    let full = |wanted: &str| -> String {
        let found = packages.iter().find(|(full, (name, _))| *full == wanted || name == wanted);
        found.unwrap_or_else(|| panic!("{wanted} is not in Cargo.lock")).0.clone()
    };
    let mut linked = BTreeSet::new();
    while let Some(next) = waiting.pop() {
        let next = full(&next);
        if linked.insert(next.clone()) {
            waiting.extend(packages[&next].1.iter().cloned());
        }
    }
    let list = read("assets/licences.txt");
    let listed: BTreeSet<String> = list
        .lines()
        .map(|line| {
            let words: Vec<&str> = line.splitn(3, ' ').collect();
            assert!(words.len() == 3 && !words[2].is_empty(), "no licence: {line}");
            format!("{} {}", words[0], words[1])
        })
        .collect();
    assert!(linked.len() > 100);
    let missing: Vec<&String> = linked.difference(&listed).collect();
    assert!(missing.is_empty(), "run tools/licences.py: {missing:?}");
}

//! The menu of examples: each one opens complete, and is saved under a new name.
//!
//! Catches: an example with files that the program lacks, one that discards unsaved work, one that
//! Ctrl+S would overwrite.

use std::time::Duration;

use egui::accesskit::Role;
use marraztu::app::actions::Action;
use marraztu_io::{self as io, EXAMPLES, Progress};

use crate::editor::Editor;
use crate::panels::click;

/// Runs frames until the scene has been read.
#[track_caller]
fn until_opened(editor: &mut Editor, title: &str) {
    let path = EXAMPLES.iter().find(|example| example.title == title).unwrap().path;
    let scene = io::open(path.as_ref(), &Progress::new()).unwrap().scene;
    for _ in 0..300 {
        if editor.scene() == scene {
            return editor.settle();
        }
        std::thread::sleep(Duration::from_millis(100));
        editor.harness.step();
    }
    panic!("{title} was never shown");
}

fn choose(editor: &mut Editor, title: &str) {
    click(editor, Role::Button, "File");
    click(editor, Role::MenuItem, "Examples");
    editor.harness.run_steps(30);
    click(editor, Role::MenuItem, title);
}

#[test]
fn the_file_menu_opens_every_example_as_a_scene_without_a_file() {
    let mut editor = Editor::of_size(1300.0, 760.0);
    for example in EXAMPLES {
        choose(&mut editor, example.title);
        until_opened(&mut editor, example.title);
        assert_eq!(editor.state().path, None, "{}", example.title);
        assert!(editor.state().notices.is_empty(), "{}", example.title);
    }
}

#[test]
fn an_example_does_not_replace_unsaved_work_unasked() {
    let mut editor = Editor::of_size(1300.0, 760.0);
    editor.perform(Action::Duplicate);
    let before = editor.scene();
    choose(&mut editor, EXAMPLES[0].title);
    editor.harness.run_steps(30);
    assert!(editor.shows("Save the scene?"));
    assert_eq!(editor.scene(), before);
    editor.click_label("Discard");
    until_opened(&mut editor, EXAMPLES[0].title);
}

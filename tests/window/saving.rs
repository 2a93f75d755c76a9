//! Saving over existing files.
//!
//! Catches: work of another window or program overwritten without a question, a question although
//! nothing would be lost, a double Enter that replaces a file.

use std::path::{Path, PathBuf};

use egui::Key;
use marraztu::app::actions::Action;
use marraztu::app::actions::Chord::{Command, CommandShift, Lower, Named};
use marraztu::app::actions::{LabRequest, Request};

use crate::editor::Editor;

/// A scene file, opened in two editors.
fn two() -> (tempfile::TempDir, PathBuf, [Editor; 2]) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("shared.marraztu");
    let mut first = Editor::small();
    first.press(Command(Key::S));
    first.type_path(&file);
    first.wait_until(|_| file.is_file());
    let mut second = Editor::small();
    second.ask(Request::LoadFiles(vec![file.clone()]));
    second.wait_until(|editor| editor.state().path.is_some());
    (folder, file, [first, second])
}

const QUESTION: &str = "shared.marraztu has changed";

fn steps(editor: &Editor) -> f64 {
    let scene = editor.scene();
    scene.selected_camera(&editor.view()).pose.now().eye.z
}

#[test]
fn a_file_that_another_window_has_saved_is_not_overwritten_without_a_question() {
    let (_folder, file, [mut first, mut second]) = two();
    for _ in 0..2 {
        first.press(Lower(Key::Z));
        first.press(Command(Key::S));
        assert!(first.state().history.is_saved(), "its own file is no question");
    }
    let theirs = std::fs::read_to_string(&file).unwrap();
    second.press(Lower(Key::X));
    second.press(Command(Key::S));
    assert!(second.shows(QUESTION));
    second.press(Named(Key::Escape));
    assert!(!second.state().history.is_saved());
    assert_eq!(std::fs::read_to_string(&file).unwrap(), theirs);
    second.press(Command(Key::S));
    second.click_label("Overwrite");
    assert!(second.state().history.is_saved());
    assert_ne!(std::fs::read_to_string(&file).unwrap(), theirs);
    second.press(Lower(Key::X));
    second.press(Command(Key::S));
    assert!(second.state().history.is_saved(), "and now it is its own");
    // The same in the other direction.
    first.press(Lower(Key::Z));
    first.press(Command(Key::S));
    assert!(first.shows(QUESTION));
}

#[test]
fn a_changed_file_can_be_reloaded_or_left_alone() {
    let (folder, file, [mut first, mut second]) = two();
    first.press(Lower(Key::Z));
    first.press(Command(Key::S));
    let (z, theirs) = (steps(&first), std::fs::read_to_string(&file).unwrap());
    second.press(Lower(Key::X));
    second.press(Command(Key::S));
    second.click_label("Save as...");
    let other = folder.path().join("mine.marraztu");
    second.type_path(&other);
    second.wait_until(|_| other.is_file());
    assert_eq!(std::fs::read_to_string(&file).unwrap(), theirs);
    assert_eq!(second.state().path.as_deref(), Some(&*other));

    let mut third = Editor::small();
    third.ask(Request::LoadFiles(vec![file.clone()]));
    third.wait_until(|editor| editor.state().path.is_some());
    first.press(Lower(Key::Z));
    first.press(Command(Key::S));
    third.press(Lower(Key::X));
    third.press(Command(Key::S));
    third.click_label("Reload the file");
    third.wait_until(|editor| editor.state().history.is_saved());
    assert!((steps(&third) - steps(&first)).abs() < 1e-9 && (steps(&third) - z).abs() > 1.0);
    third.press(Lower(Key::X));
    third.press(Command(Key::S));
    assert!(third.state().history.is_saved(), "what was read is known");
}

#[test]
fn a_file_that_is_gone_is_written_again_and_quitting_waits_for_the_answer() {
    let (_folder, file, [mut first, mut second]) = two();
    std::fs::remove_file(&file).unwrap();
    first.press(Lower(Key::Z));
    first.press(Command(Key::S));
    assert!(first.state().history.is_saved() && file.is_file());
    second.press(Lower(Key::X));
    assert!(!second.leaves_by(Command(Key::Q)));
    second.click_label("Save");
    assert!(second.shows(QUESTION));
    second.press(Named(Key::Escape));
    assert!(!second.state().history.is_saved());
}

fn write_as(editor: &mut Editor, path: &Path) {
    editor.press(CommandShift(Key::S));
    editor.type_path(path);
}

#[test]
fn save_as_over_a_file_asks_and_enter_twice_keeps_it() {
    let folder = tempfile::tempdir().unwrap();
    let there = folder.path().join("there.marraztu");
    std::fs::write(&there, "precious").unwrap();
    let mut editor = Editor::small();
    editor.press(Lower(Key::Z));
    // With the extension added, this name belongs to an existing file.
    write_as(&mut editor, &folder.path().join("there"));
    assert!(editor.shows("Replace there.marraztu?"));
    editor.press(Named(Key::Enter));
    assert_eq!(std::fs::read_to_string(&there).unwrap(), "precious");
    assert!(editor.shows("Save the scene"), "another name can be typed");
    editor.type_path(&there);
    editor.click_label("Replace");
    assert!(editor.state().history.is_saved());
    assert_ne!(std::fs::read_to_string(&there).unwrap(), "precious");
    assert!(!editor.shows("Save the scene"));
}

#[test]
fn pictures_and_exports_over_files_ask_too() {
    let folder = tempfile::tempdir().unwrap();
    for (action, name) in [(Action::SavePicture, "a.png"), (Action::ExportScene, "a.glb")] {
        let path = folder.path().join(name);
        std::fs::write(&path, "precious").unwrap();
        let mut editor = Editor::small();
        editor.perform(action);
        editor.type_path(&path);
        assert!(editor.shows(&format!("Replace {name}?")));
        editor.press(Named(Key::Escape));
        editor.press(Named(Key::Escape));
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "precious");
        assert!(!editor.shows("Replace"));
    }
}

#[test]
fn esc_after_a_dialog_warns_before_it_leaves() {
    let mut editor = Editor::new();
    for open in [Action::Load, Action::SavePicture, Action::SaveAs, Action::PictureOptions] {
        editor.perform(open);
        assert!(!editor.leaves_by(Named(Key::Escape)), "{open:?}: it closes the dialog");
        assert!(!editor.leaves_by(Named(Key::Escape)), "{open:?}: the second one warns");
        assert!(editor.shows("Esc again quits"), "{open:?}");
    }
    editor.ask(Request::LoadFiles(vec!["nowhere.obj".into()]));
    editor.wait_until(|editor| editor.shows("The file was not loaded"));
    assert!(!editor.leaves_by(Named(Key::Escape)));
    assert!(!editor.leaves_by(Named(Key::Escape)), "after an error, too");
    assert!(editor.leaves_by(Named(Key::Escape)));
}

#[test]
fn esc_after_it_has_ended_something_over_the_picture_warns() {
    use marraztu::app::panels::Panel;
    for action in [Action::Panel(Panel::CheatSheet), Action::ExplainPixel, Action::SelectAll] {
        let mut editor = Editor::new();
        editor.perform(Action::SubjectObject);
        editor.perform(action);
        assert!(!editor.leaves_by(Named(Key::Escape)), "{action:?}");
        assert!(!editor.leaves_by(Named(Key::Escape)), "{action:?}: it warns");
        assert!(editor.leaves_by(Named(Key::Escape)), "{action:?}");
    }
}

#[test]
fn the_scene_of_a_lesson_is_saved_as_a_copy_and_the_users_scene_keeps_its_file() {
    let folder = tempfile::tempdir().unwrap();
    let [own, copy] = ["own", "copy"].map(|name| folder.path().join(format!("{name}.marraztu")));
    let mut editor = Editor::small();
    editor.press(Command(Key::S));
    editor.type_path(&own);
    editor.wait_until(|_| own.is_file());
    let before = std::fs::read_to_string(&own).unwrap();
    editor.ask(Request::Lab(LabRequest::ShowLesson("depth")));
    editor.press(Command(Key::S));
    editor.type_path(&copy);
    editor.wait_until(|_| copy.is_file());
    assert!(editor.shows("Saved a copy of this lesson's scene"));
    assert_eq!(editor.state().path, None);
    editor.ask(Request::Lab(LabRequest::Back));
    assert_eq!(editor.state().path.as_ref(), Some(&own));
    editor.press(Lower(Key::X));
    editor.press(Command(Key::S));
    assert!(editor.state().history.is_saved());
    assert_ne!(std::fs::read_to_string(&own).unwrap(), before);
}

//! Scenes with missing files.
//!
//! Catches: a rejected scene, a placeholder that looks like a model, a file found for one object
//! but not for another, a path lost by saving.

use std::path::{Path, PathBuf};

use egui::Key;
use marraztu::app::actions::Action;
use marraztu::app::actions::Chord::{Command, Named};
use marraztu::app::actions::{MissingRequest, Request};
use marraztu_core::scene::ObjectId;

use crate::dialogs::CUBE;
use crate::editor::Editor;
use crate::helpers::texts;

const SCENE: &str = r#"(
    version: 1,
    objects: [
        (id: 1, name: "bow", model: File(path: "models/bow.obj"), texture: Some((path: "t.png"))),
        (id: 2, name: "bow too", model: File(path: "models/bow.obj", scale: 2.0)),
        (id: 3, name: "sail", model: File(path: "models/sail.obj")),
    ],
    cameras: [(id: 4, name: "camera 1", eye: (0.0, 0.0, 30.0))],
    view: (subject: Object, object: Some(1), camera: 4),
)"#;

/// An editor with a scene that lacks its files, and the scene's folder.
fn opened() -> (Editor, tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("boat.marraztu");
    std::fs::write(&file, SCENE).unwrap();
    let mut editor = Editor::of_size(1300.0, 760.0);
    editor.ask(Request::LoadFiles(vec![file.clone()]));
    editor.wait_until(|editor| editor.state().path.is_some());
    (editor, folder, file)
}

fn is_box(editor: &Editor, id: u32) -> bool {
    editor.scene().objects.get(ObjectId(id)).unwrap().model.is_placeholder()
}

/// Another folder that has both models.
fn elsewhere() -> (tempfile::TempDir, [PathBuf; 2]) {
    let folder = tempfile::tempdir().unwrap();
    let paths = ["bow.obj", "sail.obj"].map(|name| folder.path().join(name));
    paths.iter().for_each(|path| std::fs::write(path, CUBE).unwrap());
    (folder, paths)
}

#[test]
fn esc_dismisses_the_notice_about_missing_files() {
    let (mut editor, ..) = opened();
    editor.wait_until(|editor| editor.shows("3 files of the scene are missing"));
    assert!(!editor.leaves_by(Named(Key::Escape)));
    assert!(!editor.shows("3 files of the scene are missing"));
}

#[test]
fn a_scene_opens_with_labelled_boxes_for_missing_files() {
    let (mut editor, ..) = opened();
    assert!([1, 2, 3].iter().all(|id| is_box(&editor, *id)));
    // On a busy machine the notice comes some frames after the scene.
    editor.wait_until(|editor| editor.shows("3 files of the scene are missing"));
    assert!(editor.shows("bow.obj is missing") && editor.shows("t.png is missing"), "properties");
    let shown = texts(&editor);
    for text in ["sail.obj is missing", "sail (missing)"] {
        assert!(shown.iter().any(|it| it == text), "{text}: {shown:?}");
    }
    assert!(editor.state().history.is_saved());
    assert!(!editor.shows("findings"), "one notice is enough");
}

#[test]
fn saving_keeps_the_paths() {
    let (mut editor, _folder, file) = opened();
    editor.perform(Action::StepXUp);
    editor.press(Command(Key::S));
    assert!(editor.state().history.is_saved());
    let text = std::fs::read_to_string(file).unwrap();
    for path in ["models/bow.obj", "models/sail.obj", "t.png"] {
        assert!(text.contains(&format!("\"{path}\"")), "{text}");
    }
}

#[test]
fn a_found_model_takes_the_place_of_its_boxes_in_one_step_and_offers_others_in_its_folder() {
    let (mut editor, _folder, file) = opened();
    let (_elsewhere, [bow, sail]) = elsewhere();
    editor.perform(Action::FindMissing);
    for name in ["Find bow.obj...", "Find sail.obj...", "Find t.png..."] {
        assert!(editor.shows(name), "{name}: all missing files are listed");
    }
    editor.click_label("Find bow.obj...");
    assert!(editor.shows("Where is the missing model?"));
    editor.type_path(&bow);
    editor.wait_until(|editor| !is_box(editor, 1));
    assert!(!is_box(&editor, 2) && is_box(&editor, 3));
    let scale = |id| editor.scene().objects.get(ObjectId(id)).unwrap().model.options.scale.get();
    assert_eq!([1, 2].map(scale), [1.0, 2.0], "each is read as its object says");
    assert_eq!(editor.steps(), 1);
    editor.settle();
    assert!(editor.shows("sail.obj was found there as well"));
    editor.click_label("Use all");
    editor.wait_until(|editor| !is_box(editor, 3));
    assert!(editor.shows("t.png is missing"), "the texture is still missed");
    editor.press(Command(Key::S));
    let text = std::fs::read_to_string(file).unwrap();
    let name = |path: &Path| path.file_name().unwrap().to_str().unwrap().to_owned();
    for path in [&bow, &sail] {
        assert!(!text.contains(&format!("models/{}", name(path))), "{text}");
    }
    editor.perform_all(&[Action::Undo, Action::Undo]);
    assert!([1, 2, 3].iter().all(|id| is_box(&editor, *id)));
}

#[test]
fn cancelling_and_a_bad_file_leave_the_box() {
    let (mut editor, folder, _) = opened();
    let before = editor.scene();
    let bad = folder.path().join("bad.obj");
    std::fs::write(&bad, "v 0 zero 0\n").unwrap();
    for path in [None, Some(&bad)] {
        editor.perform(Action::FindMissing);
        editor.click_label("Find sail.obj...");
        match path {
            None => editor.press(Named(Key::Escape)),
            Some(path) => {
                editor.type_path(path);
                editor.wait_until(|editor| editor.shows("The file was not loaded"));
            }
        }
        assert!(editor.scene() == before);
    }
    editor.press(Named(Key::Enter));
    editor.ask(Request::Missing(MissingRequest::Dismiss));
    assert!(!editor.shows("files of the scene are missing"));
    assert!(
        Action::FindMissing.availability(editor.state()).is_ok(),
        "the File menu shows it again"
    );
}

#[test]
fn the_question_for_a_model_lists_all_models_and_enter_takes_no_other() {
    let (mut editor, folder, _) = opened();
    std::fs::create_dir(folder.path().join("models")).unwrap();
    std::fs::write(folder.path().join("models/other.obj"), CUBE).unwrap();
    editor.perform(Action::FindMissing);
    editor.click_label("Find sail.obj...");
    assert!(editor.shows("other.obj"), "its own folder is listed");
    editor.press(Named(Key::Enter));
    assert!(editor.shows("There is no such file."));
    assert!(is_box(&editor, 3));
}

//! The program's own file dialog: its first folder, and its list.
//!
//! Catches: pictures saved in the folder of the last texture, textures not looked for next to the
//! model, a list out of reach of the keyboard.

use std::path::Path;

use egui::Key;
use egui::accesskit::Role;
use marraztu::app::actions::Action;
use marraztu::app::actions::Chord::{Lower, Named};

use crate::dialogs::{CUBE, folder_with};
use crate::editor::Editor;
use crate::panels::{click, control, type_text};

impl Editor {
    /// The path in the dialog's field.
    fn path(&self) -> String {
        control(self, Role::TextInput, "Path").value().unwrap_or_default()
    }

    fn begins_in(&self, folder: &Path) -> bool {
        Path::new(&self.path()).parent().is_some_and(|it| it == folder)
            || Path::new(&self.path()) == folder
    }
}

#[test]
fn textures_are_searched_and_pictures_saved_in_the_folder_of_the_model() {
    let (folder, path) = folder_with("cube.obj", CUBE);
    let elsewhere = tempfile::tempdir().unwrap();
    let texture = elsewhere.path().join("t.ppm");
    std::fs::write(&texture, "P3 1 1 255 9 9 9\n").unwrap();
    let mut editor = Editor::of_size(1280.0, 800.0);
    editor.drop_files(&[&path]);
    editor.wait_until(|editor| editor.scene().objects.len() == 1);
    editor.perform(Action::ChooseTexture);
    assert!(editor.begins_in(folder.path()), "{}", editor.path());
    editor.type_path(&texture);
    editor.wait_until(|editor| {
        editor.scene().objects.iter().all(|(_, object)| object.texture.is_some())
    });
    for action in [Action::SavePicture, Action::ExportScene, Action::SaveAs] {
        editor.perform(action);
        assert!(editor.begins_in(folder.path()), "{action:?}: {}", editor.path());
        editor.press(Named(Key::Escape));
    }
    editor.perform(Action::PictureOptions);
    let place = folder.path().display().to_string();
    assert!(editor.shows(&format!("in {place}")), "the options, too");
}

#[test]
fn the_arrow_keys_go_from_the_field_into_the_list() {
    let (folder, _) = folder_with("b.obj", CUBE);
    std::fs::write(folder.path().join("a.obj"), CUBE).unwrap();
    let mut editor = Editor::new();
    editor.press(Lower(Key::F));
    editor.type_path(folder.path());
    for name in ["a.obj", "b.obj"] {
        editor.press(Named(Key::ArrowDown));
        assert_eq!(Path::new(&editor.path()), folder.path().join(name));
    }
    editor.press(Named(Key::ArrowDown));
    editor.press(Named(Key::ArrowUp));
    assert_eq!(Path::new(&editor.path()), folder.path().join("a.obj"));
    editor.press(Named(Key::Enter));
    editor.wait_until(|editor| editor.shows("Material of a.obj"));
}

#[test]
fn the_arrow_keys_stay_within_the_files_that_match() {
    let (folder, _) = folder_with("teapot.obj", CUBE);
    for name in ["bunny.obj", "butter.obj"] {
        std::fs::write(folder.path().join(name), CUBE).unwrap();
    }
    let mut editor = Editor::new();
    editor.press(Lower(Key::F));
    editor.type_path(folder.path());
    type_text(&mut editor, "bu");
    for name in ["bunny.obj", "butter.obj", "butter.obj"] {
        editor.press(Named(Key::ArrowDown));
        assert_eq!(Path::new(&editor.path()), folder.path().join(name));
    }
}

#[test]
fn columns_sort_the_list_and_places_are_a_click_away() {
    let (folder, small) = folder_with("small.obj", CUBE);
    std::fs::write(folder.path().join("large.obj"), CUBE.repeat(2)).unwrap();
    let mut editor = Editor::of_size(1280.0, 800.0);
    editor.drop_files(&[&small]);
    editor.wait_until(|editor| editor.scene().objects.len() == 1);
    editor.perform(Action::Load);
    editor.type_path(folder.path());
    let tops = |editor: &Editor| {
        ["large.obj", "small.obj"].map(|name| control(editor, Role::Button, name).rect().top())
    };
    let [large, small] = tops(&editor);
    assert!(large < small, "by name");
    click(&mut editor, Role::Button, "Sort by name");
    let [large, small] = tops(&editor);
    assert!(small < large, "the other way round");
    click(&mut editor, Role::Button, "Sort by size");
    let [large, small] = tops(&editor);
    assert!(large < small, "the largest first");
    let name = folder.path().file_name().unwrap().to_string_lossy().into_owned();
    click(&mut editor, Role::Button, "Home");
    assert!(!editor.begins_in(folder.path()));
    click(&mut editor, Role::Button, &name);
    assert!(editor.path().ends_with(&format!("{name}/")), "{}", editor.path());
}

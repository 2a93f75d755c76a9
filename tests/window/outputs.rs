//! Pictures with options, turntables and exports, saved from the window.
//!
//! Catches: options that differ from the saved file, a file left behind by a cancelled export, a
//! window that blocks.

use std::path::{Path, PathBuf};

use egui::accesskit::{Role, Toggled};
use egui::{Key, Modifiers, ViewportCommand, ViewportId};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use marraztu::app::actions::Action;
use marraztu::app::actions::Chord::Shifted;
use marraztu_core::accuracy::{Samples, Settings, Shot};
use marraztu_core::base::image::Size;
use marraztu_io as io;
use marraztu_render::{Renderer, plan_frame, without_ground};

use crate::editor::Editor;
use crate::helpers::texts;
use crate::panels::{click, control};
use crate::properties::type_into;

fn says(editor: &Editor, text: &str) -> bool {
    editor.state().message.as_ref().is_some_and(|message| message.text.contains(text))
}

#[test]
fn a_picture_has_the_size_the_samples_and_the_ground_that_were_chosen() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("large.png");
    let mut editor = Editor::of_size(900.0, 500.0);
    editor.press(Shifted(Key::F12));
    click(&mut editor, Role::RadioButton, "Samples per pixel: 4");
    click(&mut editor, Role::CheckBox, "Transparent background");
    editor.click_label("Browse...");
    editor.type_path(&path);
    editor.wait_until(|editor| says(editor, "Saved"));
    let window = editor.state().statistics.size;
    let settings = Settings { samples: Samples::Four, ..editor.state().settings };
    let size = Size::new(window.width, window.height);
    let shot = Shot::new(&editor.scene(), &editor.view(), &settings, size);
    let expected = without_ground(&mut Renderer::default(), &shot);
    assert!(io::load_picture(&path).unwrap() == expected);
}

#[test]
fn a_picture_with_overlays_is_of_a_frame_without_the_dialog() {
    let mut editor = Editor::of_size(900.0, 500.0);
    editor.press(Shifted(Key::F12));
    click(&mut editor, Role::CheckBox, "Overlays");
    control(&editor, Role::Button, "Save").click_accesskit();
    // The software shell captures the frame that requests the picture, before the next one.
    for _ in 0..10 {
        editor.harness.step();
        let output = &editor.harness.output().viewport_output[&ViewportId::ROOT];
        let is_request = |command: &_| matches!(command, ViewportCommand::Screenshot(_));
        if output.commands.iter().any(is_request) {
            assert!(!texts(&editor).iter().any(|text| text == "Save picture"));
            return;
        }
    }
    panic!("no picture was requested");
}

#[test]
fn overlays_turn_off_the_options_that_a_picture_of_the_window_lacks() {
    let mut editor = Editor::of_size(900.0, 500.0);
    let Size { width, height } = editor.state().statistics.size;
    editor.press(Shifted(Key::F12));
    click(&mut editor, Role::CheckBox, "Transparent background");
    type_into(&mut editor, "Times", "2");
    assert!(editor.shows(&format!("{} x {} pixels", 2 * width, 2 * height)));
    click(&mut editor, Role::CheckBox, "Overlays");
    assert!(editor.shows(&format!("{width} x {height} pixels")));
    let transparent = control(&editor, Role::CheckBox, "Transparent background");
    assert_eq!(transparent.accesskit_node().toggled(), Some(Toggled::False));
    editor.harness.get_by_role_and_label(Role::TextInput, "File").focus();
    editor.settle();
    editor.type_path(Path::new("picture.jpg"));
    assert!(!editor.shows("JPEG has no transparent pixels"));
}

#[test]
fn a_turntable_of_numbered_pictures_is_a_folder() {
    let folder = tempfile::tempdir().unwrap();
    let mut editor = Editor::of_size(900.0, 600.0);
    editor.perform(Action::SaveTurntable);
    type_into(&mut editor, "Pictures", "3");
    click(&mut editor, Role::CheckBox, "Numbered files");
    editor.click_label("Browse...");
    // The browser adds an extension.
    editor.type_path(&folder.path().join("frames"));
    editor.wait_until(|editor| says(editor, "Saved"));
    let names = std::fs::read_dir(folder.path().join("frames")).unwrap();
    let mut names: Vec<_> = names.map(|entry| entry.unwrap().file_name()).collect();
    names.sort();
    assert_eq!(names, ["frame-001.png", "frame-002.png", "frame-003.png"]);
}

#[test]
fn a_turntable_is_drawn_while_the_window_answers_and_a_cancelled_one_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let mut editor = Editor::of_size(640.0, 480.0);
    editor.perform(Action::SaveTurntable);
    let ctx = editor.harness.ctx.clone();
    editor.click_label("Browse...");
    editor.type_path(&folder.path().join("turn.gif"));
    editor.wait_until(|editor| editor.shows("Drawing turn.gif") || says(editor, "Saved"));
    editor.click_label("Cancel");
    editor.wait_until(|editor| says(editor, "Cancelled") || says(editor, "Saved"));
    if says(&editor, "Cancelled") {
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }
    assert_eq!(editor.steps(), 0);
    drop(ctx);
    editor.perform(Action::SaveTurntable);
    editor.click_label("Browse...");
    editor.type_path(&folder.path().join("frames"));
    editor.wait_until(|editor| says(editor, "Saved"));
    let shot = Shot::new(
        &editor.scene(),
        &editor.view(),
        &editor.state().settings,
        editor.state().statistics.size,
    );
    // A name without an extension gets the first one, GIF.
    let gif = std::fs::read(folder.path().join("frames.gif")).unwrap();
    assert!(gif.starts_with(b"GIF89a"));
    assert!(Renderer::default().render(&plan_frame(&shot)).size() == shot.size);
}

#[test]
fn a_scene_is_exported_with_notes_on_omissions_of_the_format() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("first.glb");
    let mut editor = Editor::small();
    let proposed = |editor: &Editor| {
        let path = control(editor, Role::TextInput, "Path").accesskit_node().value();
        PathBuf::from(path.unwrap()).file_name().unwrap().to_owned()
    };
    editor.perform(Action::ExportScene);
    assert_eq!(proposed(&editor), "scene.glb");
    editor.type_path(&path);
    editor.wait_until(|editor| says(editor, "Saved"));
    assert!(std::fs::read(&path).unwrap().starts_with(b"glTF"));
    editor.wait_until(|editor| editor.shows("first.glb does not hold the whole scene"));
    editor.perform(Action::SaveAs);
    editor.type_path(&folder.path().join("mine.marraztu"));
    editor.perform(Action::ExportScene);
    assert_eq!(proposed(&editor), "mine.glb", "after the scene's file");
    let modifiers = Modifiers::NONE;
    editor.key(Key::Escape, true, modifiers);
    editor.settle();
}

#[test]
fn models_are_exported_without_the_cameras_and_lights_of_the_scene() {
    let folder = tempfile::tempdir().unwrap();
    let mut editor = Editor::small();
    let rows = [(Action::ExportModels, "models.gltf"), (Action::ExportScene, "scene.gltf")];
    for (action, name) in rows {
        let path = folder.path().join(name);
        editor.perform(action);
        editor.type_path(&path);
        editor.wait_until(|editor| says(editor, &format!("Saved {}", path.display())));
        let text = std::fs::read_to_string(&path).unwrap();
        let is_scene = action == Action::ExportScene;
        assert_eq!(text.contains("\"cameras\""), is_scene, "{name}");
        assert_eq!(text.contains("KHR_lights_punctual"), is_scene, "{name}");
        assert!(text.contains("\"x_wing\""), "{name}");
    }
}

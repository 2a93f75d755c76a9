//! The strip with suggestions over the first picture.
//!
//! Catches: a strip that stays, that takes keys, or that appears in saved pictures.

use egui::Key;
use marraztu::app::actions::Action;
use marraztu::app::actions::Chord::Lower;
use marraztu_core::scene::Scene;

use crate::dialogs::{CUBE, folder_with};
use crate::editor::Editor;

fn greeted() -> Editor {
    let mut editor = Editor::of_size(1280.0, 800.0);
    editor.harness.state_mut().greet();
    editor.settle();
    assert!(is_shown(&editor));
    editor
}

fn is_shown(editor: &Editor) -> bool {
    editor.shows("Drop a model here")
}

#[test]
fn the_strip_goes_with_the_first_change_and_takes_no_key_before() {
    let mut editor = greeted();
    editor.press(Lower(Key::O));
    assert!(editor.view().polygons.is_some() && is_shown(&editor), "a view is no change");
    editor.press(Lower(Key::O));
    editor.press(Lower(Key::Z));
    assert_eq!(editor.steps(), 1);
    assert!(!is_shown(&editor));
    editor.perform(Action::Undo);
    assert!(!is_shown(&editor), "it does not come back");
}

#[test]
fn the_strip_offers_lessons_and_is_dismissed() {
    let mut editor = greeted();
    editor.click_label("Jagged edges");
    assert!(editor.state().lab.away && !is_shown(&editor));
    let mut editor = greeted();
    editor.perform(Action::ToggleOverlays);
    assert!(!is_shown(&editor), "without overlays the picture is alone");
    editor.perform(Action::ToggleOverlays);
    editor.click_label("Dismiss");
    assert!(!is_shown(&editor));
}

#[test]
fn esc_dismisses_the_strip_only_where_it_is_shown() {
    let mut editor = greeted();
    editor.perform(Action::Escape);
    assert!(!is_shown(&editor) && !editor.shows("Esc again quits"));
    let mut editor = Editor::small();
    editor.harness.state_mut().greet();
    editor.settle();
    assert!(!is_shown(&editor), "there is no room");
    editor.perform(Action::Escape);
    assert!(editor.state().greeting && editor.shows("Esc again quits"));
}

#[test]
fn the_strip_opens_a_model_alone_as_a_drop_does() {
    let (_folder, path) = folder_with("cube.obj", CUBE);
    let mut editor = greeted();
    editor.click_label("Open model...");
    editor.type_path(&path);
    editor.wait_until(|editor| editor.scene().objects.len() == 1);
    assert_eq!(editor.scene().background, Scene::NEUTRAL);
    assert!(editor.view().steps.by_size && !is_shown(&editor));
}

#[test]
fn the_strip_opens_an_example() {
    let mut editor = greeted();
    editor.click_label("Chess");
    editor.wait_until(|editor| editor.scene().objects.len() > 20);
    assert!(!is_shown(&editor));
}

#[test]
fn a_small_picture_keeps_its_place_for_itself() {
    let mut editor = Editor::of_size(640.0, 240.0);
    editor.harness.state_mut().greet();
    editor.settle();
    assert!(!is_shown(&editor));
}

#[test]
fn the_strip_is_there_again_after_a_lesson() {
    let mut editor = greeted();
    editor.click_label("Jagged edges");
    assert!(editor.state().lab.away && !is_shown(&editor));
    editor.click_label("Close");
    assert!(!editor.state().lab.away && is_shown(&editor));
}

#[test]
fn looking_at_a_model_of_the_strip_is_no_unsaved_work() {
    let (_folder, path) = folder_with("cube.obj", CUBE);
    let mut editor = greeted();
    editor.click_label("Open model...");
    editor.type_path(&path);
    editor.wait_until(|editor| editor.scene().objects.len() == 1);
    assert!(editor.state().history.is_saved() && editor.steps() == 1);
    editor.perform(Action::Undo);
    assert!(editor.scene().objects.len() > 1, "the first scene is back");
}

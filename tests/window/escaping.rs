//! Esc: dismisses, then cancels, then deselects; with nothing left, twice quits.
//!
//! Catches: an Esc that quits at once, that loses a notice and the program together, or that leaves
//! a job running; a warning that outlives its effect.

use egui::{Key, PointerButton, vec2};
use marraztu::app::actions::Action;
use marraztu::app::actions::Chord::{Lower, Named};
use marraztu::app::actions::Request;

use crate::dialogs::{CUBE, folder_with};
use crate::editor::Editor;

const ESC: marraztu::app::actions::Chord = Named(Key::Escape);

fn message(editor: &Editor) -> Option<&str> {
    editor.state().message.as_ref().map(|message| &*message.text)
}

#[test]
fn esc_quits_only_if_a_second_one_follows_within_two_seconds() {
    let mut editor = Editor::new();
    for _ in 0..3 {
        assert!(!editor.leaves_by(ESC));
        assert_eq!(message(&editor), Some("Esc again quits"));
        editor.harness.run_steps(130);
        assert_eq!(message(&editor), None, "2.2 seconds later it does not");
    }
    assert!(!editor.leaves_by(ESC));
    editor.harness.run_steps(90);
    assert!(editor.leaves_by(ESC), "1.6 seconds later it does");
}

#[test]
fn an_action_between_two_presses_of_esc_starts_over() {
    let mut editor = Editor::new();
    assert!(!editor.leaves_by(ESC));
    editor.press(Lower(Key::C));
    assert!(!editor.leaves_by(ESC));
    assert!(editor.leaves_by(ESC));
}

#[test]
fn esc_dismisses_all_notices_first_and_keeps_them_in_the_status_line() {
    let (_folder, path) = folder_with("odd.obj", &format!("{CUBE}f 1 2\n"));
    let mut editor = Editor::of_size(1280.0, 800.0);
    editor.drop_files(&[&path]);
    editor.wait_until(|editor| !editor.state().notices.is_empty());
    editor.perform_all(&[Action::SubjectObject, Action::ToggleVisible, Action::WhyUnseen]);
    assert_eq!(editor.state().notices.len(), 2);
    assert!(!editor.leaves_by(ESC));
    assert!(editor.state().notices.is_empty());
    assert!(editor.shows("2 notices"));
    assert_ne!(message(&editor), Some("Esc again quits"));
}

#[test]
fn esc_during_a_drag_cancels_the_drag_and_no_notice() {
    let mut editor = Editor::of_size(1280.0, 800.0);
    editor.perform_all(&[Action::SubjectObject, Action::ToggleVisible, Action::WhyUnseen]);
    let (scene, at) = (editor.scene(), editor.at(0.5, 0.8));
    editor.hover(at);
    editor.button(at, PointerButton::Primary, true);
    editor.hover(at + vec2(60.0, 0.0));
    assert!(editor.scene() != scene);
    assert!(!editor.leaves_by(ESC));
    assert!(editor.scene() == scene && !editor.state().notices.is_empty());
    editor.button(at, PointerButton::Primary, false);
    assert!(!editor.leaves_by(ESC));
    assert!(editor.state().notices.is_empty());
}

#[test]
fn esc_cancels_what_is_being_loaded() {
    let (_folder, path) = folder_with("large.obj", &CUBE.repeat(20_000));
    let mut editor = Editor::new();
    let objects = editor.scene().objects.len();
    let ctx = editor.harness.ctx.clone();
    editor.harness.state_mut().answer(&ctx, Request::LoadFiles(vec![path]));
    assert!(!editor.leaves_by(ESC));
    editor.wait_until(|editor| message(editor) == Some("Loading was cancelled"));
    assert_eq!(editor.scene().objects.len(), objects);
}

#[test]
fn esc_selects_one_of_several_before_it_warns() {
    let mut editor = Editor::new();
    editor.perform_all(&[Action::SubjectObject, Action::SelectAll]);
    assert!(!editor.state().others().is_empty());
    assert!(!editor.leaves_by(ESC));
    assert!(editor.state().others().is_empty());
    assert_ne!(message(&editor), Some("Esc again quits"));
}

#[test]
fn esc_closes_the_strip_before_it_quits() {
    let mut editor = Editor::of_size(1280.0, 800.0);
    editor.harness.state_mut().greet();
    editor.settle();
    assert!(editor.shows("Drop a model here"));
    assert!(!editor.leaves_by(ESC));
    assert!(!editor.shows("Drop a model here"));
    assert_ne!(message(&editor), Some("Esc again quits"));
}

#[test]
fn the_warning_ends_with_what_it_warns_of() {
    let mut editor = Editor::new();
    assert!(!editor.leaves_by(ESC));
    // A switch says nothing of its own.
    editor.press(Lower(Key::L));
    assert_eq!(message(&editor), None);
}

#[test]
fn ctrl_q_leaves_while_an_error_is_shown() {
    let (_folder, path) = folder_with("bad.obj", "f 1 2 x\n");
    let mut editor = Editor::of_size(1280.0, 800.0);
    editor.drop_files(&[&path]);
    editor.wait_until(|editor| editor.shows("The file was not loaded"));
    assert!(editor.leaves_by(marraztu::app::actions::Chord::Command(Key::Q)));
}

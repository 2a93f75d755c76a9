//! The Undo and Redo buttons in the menu bar, and their lists of steps.
//!
//! Catches: a press that undoes a further step after a choice from the list, a list that undoes one
//! step too many, a list that stays open or undoes anything after the pointer has left.

use egui::accesskit::Role;
use egui::{PointerButton, Pos2, vec2};
use marraztu::app::actions::Action;

use crate::editor::Editor;
use crate::panels::{click, middle};

const LEFT: PointerButton = PointerButton::Primary;

fn moved(count: usize) -> Editor {
    let mut editor = Editor::of_size(1280.0, 800.0);
    editor.perform(Action::SubjectObject);
    for _ in 0..count {
        editor.perform(Action::StepXUp);
    }
    editor
}

/// Presses a button of the menu bar and pulls down until its list opens. The button stays held.
fn pull(editor: &mut Editor, name: &str) -> Pos2 {
    let at = middle(editor, Role::Button, name);
    editor.hover(at);
    editor.button(at, LEFT, true);
    editor.hover(at + vec2(0.0, 30.0));
    editor.harness.run_steps(10);
    at
}

/// Pulls the list down and releases the button over the step at this distance.
pub(crate) fn pull_to(editor: &mut Editor, name: &str, step: usize) {
    pull(editor, name);
    let row = editor.row(&format!("{name} {step}: "));
    editor.hover(row);
    editor.button(row, LEFT, false);
    editor.harness.run_steps(10);
}

impl Editor {
    /// The centre of the first button with a name that contains this text.
    fn row(&self, name: &str) -> Pos2 {
        use egui_kittest::kittest::Queryable as _;
        let found = self.harness.query_all_by_label_contains(name).next();
        found.unwrap_or_else(|| panic!("no {name} is listed")).rect().center()
    }
}

#[test]
fn a_click_is_one_step() {
    let mut editor = moved(3);
    click(&mut editor, Role::Button, "Undo");
    click(&mut editor, Role::Button, "Undo");
    assert_eq!(editor.steps(), 1);
    click(&mut editor, Role::Button, "Redo");
    assert_eq!(editor.steps(), 2);
    assert!(!editor.shows("Undo 1: "), "no list has opened");
}

#[test]
fn a_pull_undoes_up_to_the_step_on_which_the_button_is_let_go() {
    let mut editor = moved(6);
    pull_to(&mut editor, "Undo", 4);
    assert_eq!(editor.steps(), 2);
    assert!(!editor.shows("Undo 1: "), "the list has closed");
    pull_to(&mut editor, "Redo", 3);
    assert_eq!(editor.steps(), 5);
}

#[test]
fn a_pull_away_from_the_list_does_nothing() {
    let mut editor = moved(3);
    pull(&mut editor, "Undo");
    assert!(editor.shows("Undo 3: "));
    let away = editor.at(0.9, 0.9);
    editor.hover(away);
    editor.button(away, LEFT, false);
    editor.harness.run_steps(10);
    assert_eq!(editor.steps(), 3);
    assert!(!editor.shows("Undo 1: "));
}

#[test]
fn a_button_that_is_held_lists_its_steps_for_a_click() {
    let mut editor = moved(3);
    let at = middle(&editor, Role::Button, "Undo");
    editor.hover(at);
    editor.button(at, LEFT, true);
    editor.harness.run_steps(30);
    assert!(editor.shows("Undo 3: "));
    editor.button(at, LEFT, false);
    assert_eq!(editor.steps(), 3, "it only lists");
    let row = editor.row("Undo 2: ");
    editor.click(row, LEFT);
    assert_eq!(editor.steps(), 1);
    editor.harness.run_steps(10);
    let at = middle(&editor, Role::Button, "Redo");
    editor.click(at, PointerButton::Secondary);
    editor.harness.run_steps(10);
    let row = editor.row("Redo 2: ");
    editor.click(row, LEFT);
    assert_eq!(editor.steps(), 3, "the right button lists them, too");
}

//! Keys changed by the user.
//!
//! Catches: a key with two actions, a clash without a message, a forgotten choice.

use egui::Key;
use egui::accesskit::Role;
use marraztu::app::actions::Action;
use marraztu::app::actions::Chord::{Lower, Named};
use marraztu::app::panels::Panel;
use marraztu_io::{OwnFolders, Preferences};

use crate::editor::Editor;
use crate::panels::{click, type_text};

fn choose(editor: &mut Editor, action: &str, key: Key) {
    editor.press(Named(Key::F1));
    type_text(editor, action);
    if !editor.shows("Reset all keys") {
        click(editor, Role::CheckBox, "Change keys");
    }
    click(editor, Role::Button, &format!("Key of {action}"));
    assert!(editor.shows("Press a key for"));
    editor.press(Lower(key));
}

#[test]
fn a_clash_is_reported_before_a_key_changes_its_action() {
    let mut editor = Editor::tall();
    choose(&mut editor, "Undo", Key::Z);
    assert!(editor.shows("z is already the key of"), "nothing has changed yet");
    click(&mut editor, Role::Button, "Use it for \"Undo\"");
    editor.press(Named(Key::F1));
    editor.perform(Action::StepXUp);
    assert_eq!(editor.steps(), 1);
    let at = editor.at(0.5, 0.9);
    editor.click(at, egui::PointerButton::Primary);
    editor.press(Lower(Key::Z));
    assert_eq!(editor.steps(), 0, "z undoes");
    editor.press(Named(Key::F1));
    click(&mut editor, Role::Button, "Reset all keys");
    editor.press(Named(Key::F1));
    editor.click(at, egui::PointerButton::Primary);
    editor.press(Lower(Key::Z));
    assert_eq!(editor.steps(), 1, "z moves again");
}

#[test]
fn chosen_keys_are_kept() {
    let folder = tempfile::tempdir().unwrap();
    let folders = OwnFolders::within(folder.path());
    let keys = [("Redo".to_owned(), vec!["j".to_owned()])].into();
    Preferences { keys, ..Preferences::default() }.save(&folders, &Preferences::default()).unwrap();
    let mut editor = Editor::small();
    let (preferences, said) = Preferences::load(&folders);
    let ctx = editor.harness.ctx.clone();
    editor.harness.state_mut().keep_in(&ctx, folders.clone(), preferences.clone(), said);
    editor.settle();
    editor.perform(Action::StepXUp);
    editor.perform(Action::Undo);
    editor.press(Lower(Key::J));
    assert_eq!(editor.steps(), 1);
    editor.harness.state_mut().end_keeping();
    assert_eq!(Preferences::load(&folders).0.keys, preferences.keys);
}

#[test]
fn keys_of_an_older_version_are_read_and_changes_reported_once() {
    let folder = tempfile::tempdir().unwrap();
    let folders = OwnFolders::within(folder.path());
    let keys = [("ToggleStatistics", "j"), ("Duplicate", "w"), ("Gone", "k")];
    let keys = keys.map(|(action, key)| (action.to_owned(), vec![key.to_owned()])).into();
    Preferences { keys, ..Preferences::default() }.save(&folders, &Preferences::default()).unwrap();
    for is_first in [true, false] {
        let mut editor = Editor::small();
        let (preferences, said) = Preferences::load(&folders);
        let ctx = editor.harness.ctx.clone();
        editor.harness.state_mut().keep_in(&ctx, folders.clone(), preferences, said);
        editor.settle();
        let told = editor.state().notices.iter().flat_map(|notice| &notice.details);
        assert_eq!(told.count(), if is_first { 2 } else { 0 });
        assert_eq!(editor.shows("custom keys could not be restored"), is_first);
        editor.press(Lower(Key::J));
        assert!(editor.state().panels.has(Panel::Statistics), "k has opened the panel");
        editor.press(Lower(Key::J));
        let before = editor.scene().cameras.len();
        editor.press(Lower(Key::W));
        assert_eq!(editor.scene().cameras.len(), before + 1, "w has duplicated the camera");
        editor.perform(Action::Undo);
        editor.harness.state_mut().end_keeping();
    }
}

#[test]
fn after_switching_to_changing_keys_letters_are_still_searched_for() {
    let mut editor = Editor::tall();
    editor.press(Named(Key::F1));
    click(&mut editor, Role::CheckBox, "Change keys");
    let before = editor.view();
    for key in [Key::U, Key::N, Key::D, Key::O] {
        editor.press(Lower(key));
    }
    assert_eq!(editor.view(), before, "no letter acts on the scene");
    assert!(editor.shows("Key of Undo") && !editor.shows("Key of Save scene"));
}

//! The selection after undo and redo.
//!
//! Catches: an undo that switches to another camera or light, a restored item that is not selected,
//! a step that reverts a later selection by the user.

use marraztu::app::actions::{Action, Also, Request};
use marraztu_core::scene::{CameraId, ItemId, ObjectId, Subject};

use crate::editor::Editor;

fn add_camera(editor: &mut Editor) {
    editor.perform(Action::AddCamera);
    editor.click_label("Add");
}

#[test]
fn undoing_a_deletion_selects_the_object_and_leaves_camera_and_light() {
    let mut editor = Editor::new();
    let first = editor.view().light.unwrap();
    add_camera(&mut editor);
    editor.perform_all(&[Action::SubjectObject, Action::AddObjectSpot]);
    editor.ask(Request::Select(ItemId::Light(first)));
    let object = editor.view().object.unwrap();
    editor.ask(Request::Select(ItemId::Object(object)));
    let before = editor.view();
    // The spot attached to the object is removed and restored with it.
    let spots = editor.scene().lights.len();
    editor.perform(Action::Delete);
    assert_eq!(editor.scene().lights.len(), spots - 1);
    assert_ne!(editor.view().object, Some(object));
    let camera = CameraId(3);
    editor.ask(Request::Select(ItemId::Camera(camera)));
    editor.perform(Action::Undo);
    let view = editor.view();
    assert_eq!((view.subject, view.object), (Subject::Object, Some(object)));
    assert_eq!((view.camera, view.light), (camera, before.light));
    editor.perform(Action::Redo);
    assert_eq!(editor.view().camera, camera);
    assert_eq!(editor.view().light, before.light);
}

#[test]
fn undoing_the_deletion_of_several_selects_all_of_them_again() {
    let mut editor = Editor::new();
    let ids: Vec<ObjectId> = editor.scene().objects.ids().collect();
    let both = vec![ItemId::Object(ids[0]), ItemId::Object(ids[2])];
    editor.ask(Request::SelectAlso(both.clone(), Also::Only));
    assert!(both.iter().all(|id| editor.state().is_selected(*id)));
    editor.perform(Action::Delete);
    assert_eq!(editor.scene().objects.len(), 1);
    editor.perform(Action::Undo);
    assert!(both.iter().all(|id| editor.state().is_selected(*id)));
    assert!(!editor.state().is_selected(ItemId::Object(ids[1])));
}

#[test]
fn the_camera_that_was_looked_through_comes_back_with_its_deletion() {
    let mut editor = Editor::new();
    add_camera(&mut editor);
    let second = editor.view().camera;
    editor.perform(Action::Delete);
    assert_ne!(editor.view().camera, second);
    editor.perform(Action::Undo);
    assert_eq!((editor.view().camera, editor.view().subject), (second, Subject::Camera));
}

#[test]
fn a_newer_selection_stays_unless_undo_removes_the_item() {
    let mut editor = Editor::new();
    let before = editor.view();
    editor.perform_all(&[Action::AddCube, Action::AddBulb]);
    let (cube, bulb) = (editor.view().object, editor.view().light);
    assert_eq!(editor.view().subject, Subject::Light);
    editor.perform(Action::Undo);
    assert_eq!(editor.view().light, before.light, "as before the bulb");
    assert_eq!(editor.view().object, cube);
    editor.perform(Action::Redo);
    assert_eq!((editor.view().light, editor.view().subject), (bulb, Subject::Light));
    // Undoing a move does not change the selection.
    editor.perform_all(&[Action::SubjectObject, Action::StepXUp]);
    editor.ask(Request::Select(ItemId::Light(before.light.unwrap())));
    editor.perform(Action::Undo);
    assert_eq!((editor.view().light, editor.view().subject), (before.light, Subject::Light));
    // Going back many steps restores the selection of the beginning.
    editor.ask(Request::GoTo(0));
    assert_eq!(editor.view().object, before.object);
    assert_eq!(editor.view().light, before.light);
}

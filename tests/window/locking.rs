//! Locked items, and lights and objects that are shown alone.
//!
//! Catches: a locked item moved or removed by a key, a handle, a click or a change of several
//! items, a lock missing from the file, a light that stays off.

use egui::accesskit::Role;
use egui::{Key, Modifiers, PointerButton, vec2};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use marraztu::app::actions::Chord::{Command, Lower, Named};
use marraztu::app::actions::{Action, Also, Request};
use marraztu::app::state::Tone;
use marraztu_core::edit::items;
use marraztu_core::scene::{ItemId, LightKind};

use crate::editor::Editor;
use crate::panels::{click, middle};

const LEFT: PointerButton = PointerButton::Primary;

/// An editor with the left ship selected and locked.
fn locked() -> Editor {
    let mut editor = Editor::new();
    editor.perform(Action::SubjectObject);
    editor.press(Command(Key::L));
    assert_eq!(Action::ToggleLocked.is_on(editor.state()), Some(true));
    assert_eq!(editor.state().history.steps().last(), Some("Lock r_falke"));
    editor
}

fn refused(editor: &Editor) -> String {
    let message = editor.state().message.clone().expect("a reason is given");
    assert_eq!(message.tone, Tone::Refused);
    message.text
}

#[test]
fn a_locked_object_is_not_moved_and_not_deleted_and_undo_unlocks() {
    let mut editor = locked();
    let before = editor.scene();
    for key in [Lower(Key::X), Named(Key::Delete)] {
        editor.press(key);
        assert!(editor.scene() == before, "{key}");
        assert!(refused(&editor).starts_with("r_falke is locked"), "{key}");
    }
    for action in [Action::DropToGround, Action::ResetPlacement, Action::TypeAmount] {
        assert!(action.availability(editor.state()).is_err(), "{action:?}");
    }
    // Without handles, a drag there looks around.
    let steps = editor.steps();
    editor.press(Command(Key::Z));
    assert_eq!(editor.steps(), steps - 1);
    editor.press(Lower(Key::X));
    assert!(editor.scene() != before);
}

#[test]
fn a_locked_camera_keeps_its_view() {
    let mut editor = Editor::new();
    editor.press(Command(Key::L));
    let before = editor.scene();
    let at = editor.at(0.5, 0.8);
    editor.drag(LEFT, &[at, at + vec2(60.0, 10.0)]);
    assert!(editor.scene() == before);
    assert!(refused(&editor).starts_with("camera 1 is locked"));
    editor.perform(Action::FrameSelection);
    assert!(editor.scene() == before);
    // Objects can still be moved, even while the camera orbits one.
    editor.perform_all(&[Action::SubjectObject, Action::StepXUp]);
    assert!(editor.scene() != before);
}

#[test]
fn a_click_passes_a_locked_object_and_says_so_if_nothing_is_behind() {
    let mut editor = Editor::new();
    editor.perform(Action::SubjectObject);
    let rect = editor.picture();
    let half = rect.size().min_elem() / 2.0;
    let ship = rect.center() + vec2(0.6, 0.0) * half;
    let id = editor.scene().objects.iter().find(|(_, it)| it.name == "x_wing").unwrap().0;
    let command = items::toggle_locked(&editor.scene(), ItemId::Object(id)).unwrap();
    let (gesture, label) = (marraztu_core::edit::Gesture::Whole, "Lock".to_owned());
    editor.ask(Request::Change { command, gesture, label });
    editor.click(ship, LEFT);
    assert_eq!(editor.state().selected_name(), "r_falke");
    assert!(refused(&editor).starts_with("x_wing is locked"));
    editor.harness.run_steps(60);
    editor.set_modifiers(Modifiers { ctrl: true, command: true, ..Modifiers::NONE });
    let [from, to] = [(-0.95, -0.6), (0.95, 0.6)].map(|(x, y)| rect.center() + vec2(x, y) * half);
    editor.drag(LEFT, &[from, rect.center(), to]);
    editor.set_modifiers(Modifiers::NONE);
    assert!(!editor.state().is_selected(ItemId::Object(id)), "a box passes it, too");
}

#[test]
fn the_lock_in_the_outline_locks_its_own_row() {
    let mut editor = Editor::tall();
    click(&mut editor, Role::Button, "Lock x_wing");
    let id = editor.scene().objects.iter().find(|(_, it)| it.name == "x_wing").unwrap().0;
    assert!(editor.scene().locked.contains(&ItemId::Object(id)));
    assert_ne!(editor.state().selected(), Some(ItemId::Object(id)), "it selects nothing");
    click(&mut editor, Role::Button, "Unlock x_wing");
    assert!(editor.scene().locked.is_empty());
    assert_eq!(editor.steps(), 2);
}

#[test]
fn of_several_the_locked_ones_stay() {
    let mut editor = locked();
    let ids: Vec<ItemId> = editor.scene().objects.ids().map(ItemId::Object).collect();
    editor.ask(Request::SelectAlso(ids, Also::Only));
    let place = |editor: &Editor, name: &str| {
        let scene = editor.scene();
        let object = scene.objects.iter().find(|(_, it)| it.name == name).unwrap().1;
        object.placement.now().w_axis.x
    };
    let before = place(&editor, "x_wing");
    editor.perform(Action::StepXUp);
    assert_eq!(place(&editor, "x_wing"), before + 10.0);
    assert_eq!(place(&editor, "r_falke"), -100.0);
}

#[test]
fn a_saved_scene_keeps_its_locks() {
    let mut editor = locked();
    editor.perform_all(&[Action::SubjectLight, Action::ToggleLocked]);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.marraztu");
    let (scene, view) = (editor.scene(), editor.view());
    marraztu_io::save(&path, &scene, &view, &editor.state().settings).unwrap();
    let progress = marraztu_io::Progress::new();
    let opened = marraztu_io::open(&path, &progress).unwrap();
    assert_eq!(opened.scene.locked, scene.locked);
    assert_eq!(opened.scene.locked.len(), 2);
}

#[test]
fn solo_leaves_one_light_on_and_a_second_solo_restores_the_others() {
    let mut editor = Editor::new();
    editor.perform_all(&[Action::Light2, Action::SubjectLight]);
    let on = |editor: &Editor| -> Vec<u32> {
        let scene = editor.scene();
        scene.lights.iter().filter(|(_, it)| it.on).map(|(_, it)| it.slot).collect()
    };
    let before = on(&editor);
    assert_eq!(before.len(), 4);
    editor.perform(Action::SoloLight);
    assert_eq!(on(&editor), [1]);
    assert_eq!(Action::SoloLight.is_on(editor.state()), Some(true));
    editor.perform(Action::SoloLight);
    assert_eq!(on(&editor), before);
    // In the outline: Alt and a click on the switch.
    let mut editor = Editor::tall();
    let at = middle(&editor, Role::Button, "Switch off bulb");
    editor.set_modifiers(Modifiers::ALT);
    editor.click(at, LEFT);
    editor.set_modifiers(Modifiers::NONE);
    let scene = editor.scene();
    let lit: Vec<_> = scene.lights.iter().filter(|(_, it)| it.on).collect();
    assert!(lit.len() == 1 && matches!(lit[0].1.kind, LightKind::Bulb { .. }));
}

#[test]
fn an_open_lock_is_named_before_it_is_seen() {
    let editor = Editor::tall();
    let node = editor.harness.get_by_label("Lock sun");
    assert_eq!(node.accesskit_node().role(), Role::Button);
}

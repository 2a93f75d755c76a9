//! Several items selected at once.
//!
//! Catches: a command that acts on only one of the items, is several steps, or continues with an
//! outdated selection.

use egui::{Key, Modifiers, PointerButton, vec2};
use egui_kittest::kittest::Queryable as _;
use glam::DVec3;
use marraztu::app::actions::Action;
use marraztu::app::actions::Chord::{Command, Lower, Named, Upper};
use marraztu::app::actions::{Also, Request};
use marraztu_core::edit::{items, several};
use marraztu_core::scene::{ItemId, Sides};

use crate::editor::Editor;

const LEFT: PointerButton = PointerButton::Primary;
const RIGHT: PointerButton = PointerButton::Secondary;

fn names(editor: &Editor) -> Vec<String> {
    let state = editor.state();
    let all = state.selected().into_iter().chain(state.others());
    let mut names: Vec<String> =
        all.filter_map(|item| state.name(item)).map(str::to_owned).collect();
    names.sort();
    names
}

fn places(editor: &Editor) -> Vec<DVec3> {
    let scene = editor.scene();
    scene.objects.iter().map(|(_, object)| object.placement.now().w_axis.truncate()).collect()
}

fn object(editor: &Editor, name: &str) -> ItemId {
    let scene = editor.scene();
    let found = scene.objects.iter().find(|(_, object)| object.name == name);
    ItemId::Object(found.unwrap().0)
}

/// An editor with both ships selected.
fn with_both() -> Editor {
    let mut editor = Editor::new();
    let both = vec![object(&editor, "x_wing"), object(&editor, "r_falke")];
    editor.ask(Request::SelectAlso(both, Also::Only));
    assert_eq!(names(&editor), ["r_falke", "x_wing"]);
    editor
}

#[test]
fn every_command_acts_on_all_in_one_step() {
    let mut editor = with_both();
    let before = editor.scene();
    let acts = [
        Action::StepXUp,
        Action::StepYDown,
        Action::ToggleVisible,
        Action::Duplicate,
        Action::Delete,
    ];
    // Each action is one step for both ships, and one undo reverts it.
    for action in acts {
        editor.perform(action);
        assert!(editor.scene() != before, "{action:?}");
        assert_eq!(editor.steps(), 1, "{action:?}");
        let label = editor.state().history.steps().last().unwrap().to_owned();
        assert!(action == Action::ToggleVisible || label.contains("2 items"), "{label}");
        editor.press(Command(Key::Z));
        assert!(editor.scene() == before, "{action:?}");
        let both = vec![object(&editor, "x_wing"), object(&editor, "r_falke")];
        editor.ask(Request::SelectAlso(both, Also::Only));
    }
    // Both ships move, the third object stays.
    editor.press(Lower(Key::X));
    let moved: Vec<DVec3> = places(&editor);
    assert!(moved.contains(&DVec3::new(110.0, 0.0, 0.0)), "{moved:?}");
    assert!(moved.contains(&DVec3::new(-90.0, 0.0, 0.0)), "{moved:?}");
    assert!(moved.contains(&DVec3::new(0.0, 0.0, -400.0)), "what is not selected stays");
    editor.press(Upper(Key::U));
    let back = places(&editor);
    assert!(back.contains(&DVec3::new(100.0, 0.0, 0.0)), "{back:?}");
    assert!(back.contains(&DVec3::new(-100.0, 0.0, 0.0)), "{back:?}");
}

#[test]
fn duplicates_are_selected_and_removed_ones_no_longer() {
    let mut editor = with_both();
    editor.perform(Action::Duplicate);
    assert_eq!(editor.scene().objects.len(), 5);
    assert_eq!(names(&editor).len(), 2);
    assert!(!names(&editor).contains(&"x_wing".to_owned()));
    editor.perform(Action::Delete);
    assert_eq!(editor.scene().objects.len(), 3);
    assert_eq!(names(&editor).len(), 1);
}

#[test]
fn ctrl_a_selects_all_of_the_subject_and_once_more_everything_and_esc_one() {
    let mut editor = Editor::new();
    editor.perform(Action::SubjectObject);
    editor.press(Command(Key::A));
    assert_eq!(names(&editor), ["cam", "r_falke", "x_wing"]);
    editor.press(Command(Key::A));
    let scene = editor.scene();
    let all = scene.objects.len() + scene.cameras.len() + scene.lights.len();
    assert_eq!(names(&editor).len(), all);
    editor.press(Named(Key::Escape));
    assert_eq!(names(&editor), ["r_falke"]);
    // A new selection has a single item.
    editor.press(Command(Key::A));
    editor.press(Named(Key::Tab));
    assert_eq!(names(&editor).len(), 1);
}

#[test]
fn an_item_selected_alone_leaves_the_others_for_good() {
    // One selection later, the item that the keys acted on is selected again.
    let mut editor = with_both();
    let current = editor.state().selected().unwrap();
    let cam = object(&editor, "cam");
    editor.ask(Request::Select(cam));
    editor.ask(Request::Select(current));
    assert_eq!(names(&editor).len(), 1);
    // It is selected itself.
    let mut editor = with_both();
    editor.ask(Request::Select(current));
    assert_eq!(names(&editor).len(), 1);
    // A new item takes its place.
    let mut editor = with_both();
    editor.perform(Action::AddCube);
    assert_eq!(editor.state().several, several::Others::default());
}

#[test]
fn a_right_click_on_one_of_several_keeps_them() {
    let mut editor = with_both();
    let rect = editor.picture();
    let half = rect.size().min_elem() / 2.0;
    // The keys act on the x_wing.
    editor.click(rect.center() + vec2(-0.6, 0.0) * half, RIGHT);
    assert!(editor.shows("Split into parts"));
    assert_eq!(names(&editor), ["r_falke", "x_wing"]);
}

#[test]
fn shift_click_and_a_box_in_the_picture_select_several() {
    let mut editor = Editor::new();
    editor.perform(Action::SubjectObject);
    let rect = editor.picture();
    let half = rect.size().min_elem() / 2.0;
    let ship = rect.center() + vec2(0.6, 0.0) * half;
    editor.set_modifiers(Modifiers::SHIFT);
    editor.click(ship, LEFT);
    editor.set_modifiers(Modifiers::NONE);
    assert_eq!(names(&editor), ["r_falke", "x_wing"]);
    assert_eq!(editor.state().selected_name(), "x_wing");
    editor.harness.run_steps(30);
    editor.set_modifiers(Modifiers::SHIFT);
    editor.click(ship, LEFT);
    editor.set_modifiers(Modifiers::NONE);
    assert_eq!(names(&editor), ["r_falke"], "once more: no longer");
    let before = editor.scene();
    editor.set_modifiers(Modifiers { ctrl: true, command: true, ..Modifiers::NONE });
    let [from, to] = [(-0.95, -0.6), (0.95, 0.6)].map(|(x, y)| rect.center() + vec2(x, y) * half);
    editor.drag(LEFT, &[from, rect.center(), to]);
    editor.set_modifiers(Modifiers::NONE);
    assert!(names(&editor).contains(&"x_wing".to_owned()), "{:?}", names(&editor));
    assert!(names(&editor).contains(&"r_falke".to_owned()));
    assert_eq!(editor.state().selected_name(), "r_falke", "it stays the one that keys act on");
    assert!(editor.scene() == before);
}

#[test]
fn ctrl_and_shift_clicks_in_the_outline_select_several() {
    let mut editor = Editor::new();
    editor.perform(Action::SubjectObject);
    let row = |editor: &Editor, name: &str| {
        let all = editor.harness.query_all_by_label(name);
        all.map(|node| node.rect().center()).min_by(|a, b| a.x.total_cmp(&b.x)).unwrap()
    };
    let at = row(&editor, "cam");
    editor.set_modifiers(Modifiers { ctrl: true, command: true, ..Modifiers::NONE });
    editor.click(at, LEFT);
    editor.set_modifiers(Modifiers::NONE);
    assert_eq!(names(&editor), ["cam", "r_falke"]);
    editor.harness.run_steps(30);
    let at = row(&editor, "x_wing");
    editor.click(at, LEFT);
    assert_eq!(names(&editor), ["x_wing"]);
    editor.harness.run_steps(30);
    let at = row(&editor, "cam");
    editor.set_modifiers(Modifiers::SHIFT);
    editor.click(at, LEFT);
    editor.set_modifiers(Modifiers::NONE);
    assert!(names(&editor).len() >= 2 && names(&editor).contains(&"cam".to_owned()));
}

#[test]
fn a_change_in_the_properties_sets_all_items_and_keeps_other_properties() {
    let editor = with_both();
    assert!(editor.shows("2 objects: changes apply to all"));
    assert!(editor.shows("Mixed: position"));
    let (scene, view) = (editor.scene(), editor.view());
    let (Some(ItemId::Object(first)), others) =
        (editor.state().selected(), editor.state().others())
    else {
        panic!()
    };
    let two = items::change_object(&scene, first, |object| object.sides = Sides::Two).unwrap();
    let mut after = scene.clone();
    several::spread(&scene, two, &others).apply(&mut after).unwrap();
    let sides: Vec<Sides> = after.objects.iter().map(|(_, object)| object.sides).collect();
    assert_eq!(sides.iter().filter(|sides| **sides == Sides::Two).count(), 2);
    let materials =
        |scene: &marraztu_core::scene::Scene| -> Vec<marraztu_core::scene::MaterialChoice> {
            scene.objects.iter().map(|(_, object)| object.material.clone()).collect()
        };
    assert_eq!(materials(&after), materials(&scene), "the materials stay different");
    // Of a position, only the changed coordinate is copied to the others.
    let to = DVec3::new(-100.0, 33.0, 0.0);
    let phase = marraztu_core::edit::GesturePhase::First;
    let moved = marraztu_core::edit::placement::object_translation(&scene, &view, first, to, phase)
        .unwrap();
    let mut after = scene.clone();
    several::spread(&scene, moved, &others).apply(&mut after).unwrap();
    let found: Vec<DVec3> =
        after.objects.iter().map(|(_, object)| object.placement.now().w_axis.truncate()).collect();
    assert!(found.iter().filter(|at| at.y == 33.0).count() >= 2, "{found:?}");
}

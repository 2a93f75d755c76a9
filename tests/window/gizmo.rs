//! The handles over the picture, and the explanation of a pixel.
//!
//! Catches: a drag of a handle that becomes several steps, moves along another axis or takes a
//! click meant for the picture; numbers that act as steps instead of being typed; a handle that
//! cannot be released.

use egui::accesskit::Role;
use egui::{Event, Key, Modifiers, PointerButton, Pos2, vec2};
use glam::{DMat4, DVec3};
use marraztu::app::actions::Action;
use marraztu::app::actions::Chord::{Command, Lower, Named};
use marraztu::app::actions::Request;
use marraztu_core::edit::{Gesture, GesturePhase, items, placement};
use marraztu_core::scene::{Frame, ItemId, LightKind, Subject};

use crate::editor::Editor;
use crate::panels;

const LEFT: PointerButton = PointerButton::Primary;
const RIGHT: PointerButton = PointerButton::Secondary;

fn matrix(editor: &Editor) -> DMat4 {
    let id = editor.view().object.unwrap();
    *editor.scene().objects.get(id).unwrap().placement.now()
}

fn place(editor: &Editor) -> DVec3 {
    matrix(editor).w_axis.truncate()
}

/// The window position of the selected ship's origin: (-100, 0, 0) seen from (0, 0, 400).
fn middle(editor: &Editor) -> Pos2 {
    let rect = editor.picture();
    let half = rect.size().min_elem() / 2.0;
    rect.center() + vec2(-100.0 / 400.0 / 22.5_f32.to_radians().tan(), 0.0) * half
}

/// An editor with the keys set to act on the selected ship.
fn with_ship() -> Editor {
    let mut editor = Editor::new();
    editor.perform(Action::SubjectObject);
    assert_eq!(editor.state().selected_name(), "r_falke");
    editor
}

fn type_letters(editor: &mut Editor, text: &str) {
    for letter in text.chars() {
        editor.harness.event(Event::Text(letter.to_string()));
        editor.settle();
    }
}

/// Presses the handle of the X axis and pulls it to the right.
fn pull(editor: &mut Editor, by: f32) -> Pos2 {
    let from = middle(editor) + vec2(60.0, 0.0);
    editor.hover(from);
    editor.button(from, LEFT, true);
    editor.hover(from + vec2(by / 2.0, 9.0));
    editor.hover(from + vec2(by, 30.0));
    from + vec2(by, 30.0)
}

#[test]
fn dragging_a_handle_moves_along_its_axis_in_one_step_named_with_the_distance() {
    let mut editor = with_ship();
    let (before, steps) = (editor.scene(), editor.steps());
    let eye = editor.scene().selected_camera(&editor.view()).pose.now().eye;
    let at = pull(&mut editor, 50.0);
    editor.button(at, LEFT, false);
    let moved = place(&editor) - DVec3::new(-100.0, 0.0, 0.0);
    assert!(moved.x > 5.0 && moved.y == 0.0 && moved.z == 0.0, "{moved}");
    assert_eq!(editor.scene().selected_camera(&editor.view()).pose.now().eye, eye);
    assert_eq!(editor.steps(), steps + 1);
    let label = editor.state().history.steps().last().unwrap().to_owned();
    assert!(label.starts_with("Move r_falke ") && label.ends_with(" along x"), "{label}");
    editor.press(Command(Key::Z));
    assert!(editor.scene() == before);
    editor.press(Lower(Key::U));
    assert!(editor.state().message.is_some(), "there is nothing left to take back");
}

#[test]
fn the_letter_at_the_end_of_an_axis_is_part_of_its_handle() {
    let mut editor = with_ship();
    let eye = editor.scene().selected_camera(&editor.view()).pose.now().eye;
    let from = middle(&editor) + vec2(84.0 + 15.0, 0.0);
    editor.drag(LEFT, &[from, from + vec2(25.0, 9.0), from + vec2(50.0, 30.0)]);
    let moved = place(&editor) - DVec3::new(-100.0, 0.0, 0.0);
    assert!(moved.x > 5.0 && moved.y == 0.0 && moved.z == 0.0, "{moved}");
    assert_eq!(editor.scene().selected_camera(&editor.view()).pose.now().eye, eye);
}

#[test]
fn a_new_shape_moves_by_the_step_of_a_key_and_by_a_typed_number() {
    let mut editor = with_ship();
    editor.perform(Action::AddCube);
    let before = place(&editor);
    editor.press(Lower(Key::X));
    assert_eq!(place(&editor), before + DVec3::X * 10.0);
    editor.perform(Action::TypeAmount);
    type_letters(&mut editor, "y60");
    editor.press(Named(Key::Enter));
    assert_eq!(place(&editor), before + DVec3::new(10.0, 60.0, 0.0));
}

#[test]
fn numbers_are_typed_while_a_handle_is_held_and_enter_takes_them() {
    let mut editor = with_ship();
    let steps = editor.steps();
    let at = pull(&mut editor, 50.0);
    type_letters(&mut editor, "y12");
    assert_eq!(place(&editor), DVec3::new(-100.0, 12.0, 0.0));
    editor.press(Named(Key::Backspace));
    assert_eq!(place(&editor), DVec3::new(-100.0, 1.0, 0.0));
    type_letters(&mut editor, "7");
    editor.press(Named(Key::Enter));
    editor.hover(at + vec2(90.0, 90.0));
    editor.button(at, LEFT, false);
    assert_eq!(place(&editor), DVec3::new(-100.0, 17.0, 0.0));
    assert_eq!(editor.steps(), steps + 1);
    let label = editor.state().history.steps().last().unwrap().to_owned();
    assert_eq!(label, "Move r_falke 17 along y");
    // The keys trigger actions again.
    editor.press(Lower(Key::X));
    assert_eq!(place(&editor), DVec3::new(-90.0, 17.0, 0.0));
}

#[test]
fn an_amount_is_typed_without_the_mouse() {
    let mut editor = with_ship();
    editor.perform(Action::TypeAmount);
    type_letters(&mut editor, "z-5*4");
    editor.press(Named(Key::Enter));
    assert_eq!(place(&editor), DVec3::new(-100.0, 0.0, -20.0));
    editor.perform(Action::TypeAmount);
    type_letters(&mut editor, "3");
    editor.press(Named(Key::Escape));
    assert_eq!(place(&editor), DVec3::new(-100.0, 0.0, -20.0), "Esc takes it back");
    assert_eq!(editor.steps(), 1);
    editor.press(Lower(Key::X));
    assert_eq!(place(&editor), DVec3::new(-90.0, 0.0, -20.0));
}

#[test]
fn enter_held_after_an_amount_asks_for_no_polygon() {
    let mut editor = with_ship();
    editor.perform(Action::TypeAmount);
    type_letters(&mut editor, "z-20");
    editor.hold(Named(Key::Enter), 3);
    assert_eq!(place(&editor), DVec3::new(-100.0, 0.0, -20.0));
    assert!(editor.state().message.is_none(), "{:?}", editor.state().message);
}

#[test]
fn enter_after_the_release_of_a_handle_confirms_the_typed_amount() {
    let mut editor = with_ship();
    let at = pull(&mut editor, 50.0);
    type_letters(&mut editor, "y12");
    editor.button(at, LEFT, false);
    for (press, is_refused) in [(1, false), (2, true)] {
        editor.press(Named(Key::Enter));
        assert_eq!(place(&editor), DVec3::new(-100.0, 12.0, 0.0));
        let told = editor.state().message.is_some();
        assert_eq!(told, is_refused, "press {press}: there is no polygon mode");
    }
}

#[test]
fn an_amount_that_arrives_within_one_frame_is_typed_as_a_whole() {
    let mut editor = with_ship();
    let lights = editor.scene().lights;
    let ctx = editor.harness.ctx.clone();
    editor.harness.state_mut().perform(&ctx, Action::TypeAmount, Gesture::Whole);
    for (key, text) in [(Key::Z, "z"), (Key::Num2, "2"), (Key::Num0, "0")] {
        editor.key(key, true, Modifiers::NONE);
        editor.harness.event(Event::Text(text.to_owned()));
        editor.key(key, false, Modifiers::NONE);
    }
    editor.settle();
    editor.press(Named(Key::Enter));
    assert_eq!(place(&editor), DVec3::new(-100.0, 0.0, 20.0));
    assert!(editor.scene().lights == lights, "no digit has switched a light");
}

#[test]
fn digits_typed_with_the_pointer_over_the_picture_are_one_step_that_esc_takes_back() {
    let mut editor = with_ship();
    let before = editor.scene();
    let at = editor.at(0.5, 0.9);
    editor.hover(at);
    editor.perform(Action::TypeAmount);
    for digit in [Key::Num1, Key::Num2] {
        editor.press(Lower(digit));
        editor.hover(at + vec2(3.0, 0.0));
    }
    assert_eq!((place(&editor).x, editor.steps()), (-88.0, 1));
    editor.press(Named(Key::Escape));
    assert!(editor.scene() == before);
    assert_eq!(editor.steps(), 0);
}

#[test]
fn a_typed_amount_keeps_what_else_is_changed_meanwhile() {
    let mut editor = with_ship();
    let id = editor.view().object.unwrap();
    let opacity = |editor: &Editor| editor.scene().objects.get(id).unwrap().opacity;
    let change = |editor: &mut Editor, command| {
        let (gesture, label) = (Gesture::Whole, "Change".to_owned());
        editor.ask(Request::Change { command, gesture, label });
    };
    editor.perform(Action::TypeAmount);
    type_letters(&mut editor, "1");
    let half = items::change_object(&editor.scene(), id, |object| object.opacity = 0.5).unwrap();
    change(&mut editor, half);
    type_letters(&mut editor, "2");
    assert_eq!((place(&editor).x, opacity(&editor)), (-88.0, 0.5));
    // If the place itself is changed, the amount ends.
    let (scene, view, to) = (editor.scene(), editor.view(), DVec3::new(7.0, 8.0, 9.0));
    let first = GesturePhase::First;
    let moved = placement::object_translation(&scene, &view, id, to, first).unwrap();
    change(&mut editor, moved);
    type_letters(&mut editor, "3");
    assert_eq!(place(&editor), to);
    editor.perform(Action::TypeAmount);
    type_letters(&mut editor, "4");
    editor.perform(Action::Undo);
    type_letters(&mut editor, "5");
    assert_eq!(place(&editor), to);
}

#[test]
fn a_click_in_a_panel_ends_a_typed_amount_and_its_change_stays() {
    let mut editor = Editor::tall();
    editor.perform_all(&[Action::SubjectObject, Action::TypeAmount]);
    type_letters(&mut editor, "1");
    let object = |editor: &Editor| {
        let scene = editor.scene();
        scene.objects.get(editor.view().object.unwrap()).unwrap().clone()
    };
    let (before, jade) =
        (object(&editor).material, panels::middle(&editor, Role::RadioButton, "Material: jade"));
    editor.click(jade, LEFT);
    type_letters(&mut editor, "5");
    assert_ne!(object(&editor).material, before);
    assert_eq!(place(&editor), DVec3::new(-99.0, 0.0, 0.0));
}

#[test]
fn esc_and_the_right_button_take_a_drag_of_a_handle_back() {
    for by_key in [true, false] {
        let mut editor = with_ship();
        let before = editor.scene();
        let at = pull(&mut editor, 50.0);
        assert!(editor.scene() != before);
        if by_key {
            editor.press(Named(Key::Escape));
        } else {
            editor.button(at, RIGHT, true);
            editor.button(at, RIGHT, false);
        }
        editor.hover(at + vec2(60.0, 0.0));
        editor.button(at, LEFT, false);
        assert!(editor.scene() == before);
        assert_eq!(editor.steps(), 0);
    }
}

#[test]
fn ctrl_snaps_to_the_steps_of_the_keys() {
    let mut editor = with_ship();
    let at = pull(&mut editor, 50.0);
    editor.set_modifiers(Modifiers { ctrl: true, command: true, ..Modifiers::NONE });
    editor.hover(at + vec2(3.0, 0.0));
    let x = place(&editor).x + 100.0;
    assert!(x > 5.0 && (x / 10.0).fract() == 0.0, "{x}");
    editor.set_modifiers(Modifiers::NONE);
    editor.button(at, LEFT, false);
}

#[test]
fn a_click_on_a_handle_is_one_into_the_picture_and_without_handles_a_drag_turns_the_view() {
    let mut editor = with_ship();
    let before = editor.scene();
    let at = middle(&editor) + vec2(60.0, 0.0);
    editor.click(at, LEFT);
    assert!(editor.scene() == before);
    assert_eq!(editor.steps(), 0);
    editor.perform(Action::ToggleGizmo);
    assert_eq!(Action::ToggleGizmo.is_on(editor.state()), Some(false));
    let at = pull(&mut editor, 50.0);
    editor.button(at, LEFT, false);
    assert_eq!(place(&editor), DVec3::new(-100.0, 0.0, 0.0));
    assert!(editor.scene() != before, "the view has turned");
}

#[test]
fn rings_turn_and_squares_scale_in_the_frame_that_holds() {
    let mut editor = with_ship();
    editor.perform(Action::Rotate);
    let at = middle(&editor) + vec2(0.0, -84.0 * 1.18);
    editor.drag(LEFT, &[at, at + vec2(30.0, 4.0), at + vec2(60.0, 30.0)]);
    let turned = matrix(&editor);
    assert!(turned.x_axis.x < 0.999 && place(&editor) == DVec3::new(-100.0, 0.0, 0.0));
    editor.press(Command(Key::Z));
    // In the global frame objects turn about the world's origin, so the handles are there.
    let mut view = editor.view();
    view.frame = Frame::Global;
    editor.ask(Request::View(Box::new(view)));
    let at = editor.picture().center() + vec2(0.0, -84.0 * 1.18);
    editor.drag(LEFT, &[at, at + vec2(30.0, 4.0), at + vec2(60.0, 30.0)]);
    assert!(place(&editor).y.abs() > 10.0, "{}", place(&editor));
    editor.press(Command(Key::Z));
    editor.perform(Action::ToggleFrame);
    editor.perform(Action::Scale);
    let at = middle(&editor) + vec2(60.0, 0.0);
    editor.drag(LEFT, &[at, at + vec2(15.0, 0.0), at + vec2(30.0, 0.0)]);
    let m = matrix(&editor);
    assert!(m.x_axis.x > 1.2 && m.y_axis.y == 1.0, "{m}");
}

#[test]
fn a_bulb_is_moved_and_the_camera_that_is_looked_through_has_no_handles() {
    let mut editor = Editor::new();
    let bulb = editor.scene();
    let mut bulbs = bulb.lights.iter();
    let found = bulbs.find(|(_, light)| matches!(light.kind, LightKind::Bulb { .. }));
    editor.ask(Request::Select(ItemId::Light(found.unwrap().0)));
    assert_eq!(editor.view().subject, Subject::Light);
    // The object is at (0, 0, -200), in the middle of the picture.
    let at = editor.picture().center() + vec2(60.0, 0.0);
    editor.drag(LEFT, &[at, at + vec2(20.0, 0.0), at + vec2(40.0, 0.0)]);
    let scene = editor.scene();
    let LightKind::Bulb { position, .. } = &scene.lights.get(found.unwrap().0).unwrap().kind else {
        panic!()
    };
    let now = *position.now();
    assert!(now.x > 10.0 && now.y == 0.0 && now.z == -200.0, "{now}");
    editor.perform(Action::SubjectCamera);
    assert!(Action::TypeAmount.availability(editor.state()).is_err());
}

/// Runs frames until the pixel is explained.
fn until_explained(editor: &mut Editor) {
    for _ in 0..2000 {
        editor.settle();
        if editor.state().explained.as_ref().is_some_and(|pixel| pixel.explained.is_some()) {
            return editor.settle();
        }
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    panic!("it is never explained");
}

#[test]
fn e_and_a_click_explain_a_pixel_and_esc_closes_it() {
    let mut editor = with_ship();
    editor.press(Lower(Key::E));
    assert!(editor.state().explaining);
    let at = middle(&editor) + vec2(9.0, 3.0);
    editor.click(at, LEFT);
    until_explained(&mut editor);
    assert!(editor.shows("clamped and rounded") && editor.shows("sum"));
    assert!(editor.shows("r_falke, front"));
    assert!(editor.shows("sun, diffuse") && editor.shows("ambient, ambient"));
    let pixel = editor.state().explained.clone().unwrap();
    // The explanation follows the picture.
    editor.press(Lower(Key::Num1));
    for _ in 0..100 {
        editor.settle();
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    let now = editor.state().explained.clone().unwrap();
    assert_ne!(now.explained, pixel.explained, "the sun is off");
    assert!(!editor.shows("sun, diffuse"));
    editor.press(Named(Key::Escape));
    assert!(editor.state().explained.is_none() && !editor.shows("clamped and rounded"));
}

//! The mouse over the picture.
//!
//! Catches: drags that become several steps or cannot be undone, clicks taken for drags, wheel
//! notches lost or counted twice, keys that act while the right button steers.

use egui::{Event, Key, Modifiers, MouseWheelUnit, PointerButton, Vec2, vec2};
use marraztu::app::actions::Action;
use marraztu::app::actions::Chord::{Command, Either, Lower, Named, Upper};
use marraztu::app::actions::Request;
use marraztu_core::scene::{CameraMode, ItemId, PolygonMode, Subject};

use crate::editor::Editor;

const LEFT: PointerButton = PointerButton::Primary;
const RIGHT: PointerButton = PointerButton::Secondary;
const MIDDLE: PointerButton = PointerButton::Middle;

fn name_of_selected(editor: &Editor) -> String {
    let view = editor.view();
    view.object.and_then(|id| editor.state().name(ItemId::Object(id))).unwrap_or("").to_owned()
}

fn pose(editor: &Editor) -> marraztu_core::scene::Pose {
    *editor.scene().selected_camera(&editor.view()).pose.now()
}

/// The horizontal positions of the ships, in units of half of the picture's shorter side.
const X_WING: f32 = 0.6;
const R_FALKE: f32 = -0.6;

/// A position in the picture that shows this object.
fn place_of(editor: &mut Editor, name: &str, aside: f32) -> egui::Pos2 {
    let rect = editor.picture();
    let half = rect.size().min_elem() / 2.0;
    for step in -10..10_i8 {
        // Waits until the next click cannot count as a double click.
        editor.harness.run_steps(30);
        let at = rect.center() + vec2(aside, 0.02 * f32::from(step)) * half;
        editor.click(at, LEFT);
        if name_of_selected(editor) == name && editor.view().subject == Subject::Object {
            return at;
        }
    }
    panic!("{name} is not seen there");
}

#[test]
fn a_click_selects_the_visible_object_and_one_on_nothing_keeps_the_selection() {
    let mut editor = Editor::new();
    assert_eq!(name_of_selected(&editor), "r_falke");
    place_of(&mut editor, "x_wing", X_WING);
    let nothing = editor.at(0.5, 0.05);
    editor.click(nothing, LEFT);
    assert_eq!(name_of_selected(&editor), "x_wing");
    place_of(&mut editor, "r_falke", R_FALKE);
    assert_eq!(editor.steps(), 0, "a selection is no step");
}

#[test]
fn a_click_in_polygon_mode_selects_the_polygon_that_is_seen() {
    let mut editor = Editor::new();
    let at = place_of(&mut editor, "r_falke", R_FALKE);
    editor.press(Either(Key::O));
    // Shows all polygons of the object, so one of them is visible there.
    let mut view = editor.view();
    let object = editor.scene().objects.get(view.object.unwrap()).unwrap().clone();
    let count = u32::try_from(object.model.mesh.polygon_count()).unwrap();
    view.polygons = Some(PolygonMode { current: 0, shown: (0..count).collect() });
    editor.ask(Request::View(Box::new(view)));
    editor.harness.run_steps(30);
    editor.click(at, LEFT);
    let current = editor.view().polygons.unwrap().current;
    assert_ne!(current, 0);
    let forward = -pose(&editor).axes.z_axis;
    let normal = object.model.mesh.polygon_normals()[current as usize].map(f64::from);
    assert!(glam::DVec3::from_array(normal).dot(forward) < 0.0, "it faces the camera");
    assert_eq!(editor.steps(), 0);
}

#[test]
fn every_drag_is_one_step_and_comes_back_bit_for_bit() {
    let shift = Modifiers::SHIFT;
    let alt = Modifiers::ALT;
    let drags = [
        (LEFT, Modifiers::NONE, false),
        (LEFT, Modifiers::NONE, true),
        (LEFT, alt, false),
        (LEFT, shift, false),
        (MIDDLE, Modifiers::NONE, true),
        (RIGHT, Modifiers::NONE, false),
    ];
    for (button, modifiers, analysis) in drags {
        let mut editor = Editor::new();
        if analysis {
            editor.perform(Action::ToggleFrame);
        }
        let (before, steps) = (editor.scene(), editor.steps());
        let places =
            [(0.5, 0.2), (0.55, 0.25), (0.6, 0.2), (0.7, 0.3)].map(|(x, y)| editor.at(x, y));
        editor.set_modifiers(modifiers);
        editor.drag(button, &places);
        editor.set_modifiers(Modifiers::NONE);
        let of = format!("{button:?} {modifiers:?} analysis: {analysis}");
        assert!(editor.scene() != before, "{of} does nothing");
        assert_eq!(editor.steps(), steps, "{of}: looking around is no step");
        editor.press(Either(Key::U));
        assert_eq!(pose(&editor).eye, before.selected_camera(&editor.view()).pose.now().eye);
    }
}

#[test]
fn a_drag_that_is_taken_back_leaves_no_step_and_does_nothing_more() {
    for cancel_by_key in [true, false] {
        let mut editor = Editor::new();
        let before = editor.scene();
        let [from, to, on] = [(0.5, 0.2), (0.7, 0.3), (0.8, 0.4)].map(|(x, y)| editor.at(x, y));
        editor.hover(from);
        editor.button(from, LEFT, true);
        editor.hover(to);
        assert!(editor.scene() != before);
        if cancel_by_key {
            editor.press(Named(Key::Escape));
        } else {
            editor.button(to, RIGHT, true);
            editor.button(to, RIGHT, false);
        }
        editor.hover(on);
        editor.button(on, LEFT, false);
        assert!(editor.scene() == before);
        assert_eq!(editor.steps(), 0);
        editor.press(Command(Key::Y));
        assert!(editor.scene() == before, "nor can it be made again");
        assert!(!editor.shows("Frame all"), "and no menu opens");
    }
}

#[test]
fn a_drag_to_the_right_looks_to_the_right_and_up_looks_up() {
    let mut editor = Editor::new();
    let places = [(0.5, 0.5), (0.6, 0.4)].map(|(x, y)| editor.at(x, y));
    editor.drag(LEFT, &places);
    let forward = -pose(&editor).axes.z_axis;
    assert!(forward.x > 0.01 && forward.y > 0.01, "{forward}");
}

#[test]
fn an_orbit_keeps_the_distance_and_goes_the_way_that_turns_the_object_with_the_hand() {
    let mut editor = Editor::new();
    editor.perform(Action::ToggleFrame);
    let centre = |editor: &Editor| {
        let id = editor.view().object.unwrap();
        editor.scene().objects.get(id).unwrap().centre(0.0)
    };
    let before = pose(&editor);
    let distance = (before.eye - centre(&editor)).length();
    let places = [(0.5, 0.2), (0.6, 0.3)].map(|(x, y)| editor.at(x, y));
    editor.drag(LEFT, &places);
    let after = pose(&editor);
    assert!(((after.eye - centre(&editor)).length() - distance).abs() < 1e-9 * distance);
    // The pointer goes right and down, the camera left and up.
    let way = after.eye - before.eye;
    assert!(way.dot(before.axes.x_axis) < -1.0 && way.dot(before.axes.y_axis) > 1.0, "{way}");
    assert!(matches!(after.mode, CameraMode::Analysis { .. }));
}

fn wheel(editor: &mut Editor, notches: f32) {
    let modifiers = Modifiers::NONE;
    editor.harness.event(Event::MouseWheel {
        unit: MouseWheelUnit::Line,
        delta: vec2(0.0, notches),
        phase: egui::TouchPhase::Move,
        source: egui::MouseWheelSource::Unknown,
        modifiers,
    });
    editor.settle();
}

#[test]
fn the_wheel_comes_nearer_by_whole_notches_and_its_turns_in_one_place_are_one_movement() {
    let mut editor = Editor::new();
    let middle = editor.at(0.5, 0.2);
    editor.hover(middle);
    let before = pose(&editor).eye;
    wheel(&mut editor, 1.0);
    let first = pose(&editor).eye;
    assert!(first.z < before.z - 1.0);
    wheel(&mut editor, 1.0);
    wheel(&mut editor, 1.0);
    let aside = middle + Vec2::new(30.0, 0.0);
    editor.hover(aside);
    wheel(&mut editor, -1.0);
    assert_eq!(editor.steps(), 0, "looking around is no step");
    editor.press(Either(Key::U));
    assert_ne!(pose(&editor).eye, before);
    editor.press(Either(Key::U));
    assert_eq!(pose(&editor).eye, before, "two movements");
}

#[test]
fn the_wheel_over_a_panel_moves_nothing() {
    let mut editor = Editor::with_buttons(&[Action::Undo]);
    editor.hover(egui::pos2(5.0, 300.0));
    let before = editor.scene();
    wheel(&mut editor, 3.0);
    assert!(editor.scene() == before);
}

#[test]
fn while_the_right_button_is_held_letters_steer_and_ask_for_nothing() {
    let mut editor = Editor::new();
    let at = editor.at(0.5, 0.2);
    let (before, view) = (pose(&editor), editor.view());
    editor.hover(at);
    editor.button(at, RIGHT, true);
    for key in [Key::W, Key::D, Key::E] {
        editor.key(key, true, Modifiers::NONE);
        editor.settle();
        editor.key(key, false, Modifiers::NONE);
        editor.settle();
    }
    editor.press(Lower(Key::Z));
    editor.button(at, RIGHT, false);
    let way = pose(&editor).eye - before.eye;
    assert!(way.z < 0.0 && way.x > 0.0 && way.y > 0.0, "{way}");
    assert_eq!(editor.view().only_selected, view.only_selected, "D steers, and toggles nothing");
    assert_eq!(editor.steps(), 0);
    assert!(!editor.shows("Frame all"), "a flight is no right click");
    editor.press(Lower(Key::Z));
    assert_eq!(editor.steps(), 1, "and then keys act again");
}

#[test]
fn a_right_click_opens_the_menu_of_the_thing_under_it_and_selects_it() {
    let mut editor = Editor::new();
    let at = place_of(&mut editor, "x_wing", X_WING);
    place_of(&mut editor, "r_falke", R_FALKE);
    editor.click(at + vec2(1.0, 0.0), RIGHT);
    assert_eq!(name_of_selected(&editor), "x_wing");
    assert!(editor.shows("Split into parts"));
    let count = editor.scene().objects.len();
    editor.click_label("Duplicate");
    assert_eq!(editor.scene().objects.len(), count + 1);
    assert!(!editor.shows("Split into parts"), "the menu is closed");
}

#[test]
fn esc_closes_the_menu_and_no_more() {
    let mut editor = Editor::new();
    let nothing = editor.at(0.5, 0.05);
    editor.press(Lower(Key::Z));
    editor.click(nothing, RIGHT);
    assert!(editor.shows("Frame all"));
    editor.press(Named(Key::Escape));
    assert!(!editor.shows("Frame all"));
    assert!(!editor.shows("Save the scene?"));
}

#[test]
fn a_double_click_frames_the_object_and_one_on_nothing_frames_all() {
    let mut editor = Editor::new();
    let at = place_of(&mut editor, "x_wing", X_WING);
    // Waits until the next click cannot count as a double click.
    editor.harness.run_steps(60);
    let before = pose(&editor).eye;
    for _ in 0..2 {
        for pressed in [true, false] {
            let modifiers = Modifiers::NONE;
            editor.harness.event(Event::PointerButton {
                pos: at,
                button: LEFT,
                pressed,
                modifiers,
            });
            editor.harness.step();
        }
    }
    editor.settle();
    let object = editor.view().object.unwrap();
    let (centre, _) = editor.scene().objects.get(object).unwrap().bounding_sphere(0.0).unwrap();
    let framed = pose(&editor);
    assert_ne!(framed.eye, before);
    let aside = framed.axes.transpose() * (centre - framed.eye);
    assert!(aside.x.abs() < 1e-6 && aside.y.abs() < 1e-6, "it is in the middle: {aside}");
}

#[test]
fn with_an_object_as_observer_drags_do_nothing_and_say_why() {
    let mut editor = Editor::new();
    editor.press(Upper(Key::C));
    let before = editor.scene();
    let places = [(0.5, 0.2), (0.6, 0.3)].map(|(x, y)| editor.at(x, y));
    editor.drag(LEFT, &places);
    assert!(editor.scene() == before);
    assert!(editor.state().message.is_some());
}

#[test]
fn a_click_that_begins_and_ends_in_one_frame_is_a_click() {
    for button in [LEFT, RIGHT] {
        let mut editor = Editor::new();
        let at = place_of(&mut editor, "x_wing", X_WING);
        place_of(&mut editor, "r_falke", R_FALKE);
        editor.hover(at);
        let modifiers = Modifiers::NONE;
        for pressed in [true, false] {
            let event = Event::PointerButton { pos: at, button, pressed, modifiers };
            editor.harness.input_mut().events.push(event);
        }
        editor.settle();
        assert_eq!(name_of_selected(&editor), "x_wing", "{button:?}");
        assert_eq!(editor.shows("Split into parts"), button == RIGHT);
    }
}

#[test]
fn clicking_again_selects_the_object_behind_and_wraps_around() {
    let mut editor = Editor::new();
    // Seen from the right, one ship is in front of the other.
    editor.perform(Action::FrameAll);
    editor.perform(Action::LookRight);
    let mut view = editor.view();
    view.subject = Subject::Camera;
    view.steps.translation = 400.0;
    editor.ask(Request::View(Box::new(view)));
    editor.perform(Action::StepZUp);
    let rect = editor.picture();
    let half = rect.size().min_elem() / 2.0;
    let mut names = Vec::new();
    for step in -30..30_i8 {
        let at = rect.center() + vec2(0.03 * f32::from(step) * half, 0.0);
        names.clear();
        for _ in 0..3 {
            editor.harness.run_steps(30);
            editor.click(at, LEFT);
            names.push(name_of_selected(&editor));
        }
        if names[0] != names[1] {
            break;
        }
    }
    assert_eq!(names, ["x_wing", "r_falke", "x_wing"], "the nearer one first");
    assert_eq!(editor.steps(), 1, "to step back; framing is no step");
}

//! Several items selected at once.
//!
//! Catches: a command that acts on only one of the items, is several steps, or continues with an
//! outdated selection.

use egui::accesskit::Role;
use egui::{Key, Modifiers, PointerButton, vec2};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use glam::DVec3;
use marraztu::app::actions::Action;
use marraztu::app::actions::Chord::{Command, Lower, Named, Upper};
use marraztu::app::actions::{Also, Request};
use marraztu_core::edit::{Change, Gesture, GesturePhase, items, lights, placement, several};
use marraztu_core::scene::{
    CameraId, HALF_APERTURE, ItemId, LightId, MaterialChoice, Object, PresetId, Sides, SpotOwner,
    UpAxis,
};

use crate::dialogs::{CUBE, folder_with};
use crate::editor::Editor;
use crate::panels::{click, control};
use crate::properties::type_into;

const FIRST: GesturePhase = GesturePhase::First;
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
    let mut editor = tall_with(|_| {}, ships);
    click(&mut editor, Role::DisclosureTriangle, "Drawing");
    assert!(editor.shows("2 objects: changes apply to all"));
    assert!(editor.shows("Mixed: position, material"));
    let before = both(&editor);
    click(&mut editor, Role::RadioButton, "Sides: Two sides");
    let label = editor.state().history.steps().last().unwrap().to_owned();
    assert_eq!(label, "Change the sides of x_wing and 1 more");
    // Of a position, only the typed coordinate is copied to the others.
    type_into(&mut editor, "Position Y", "33");
    for (after, before) in both(&editor).into_iter().zip(before) {
        assert_eq!((after.sides, after.material), (Sides::Two, before.material));
        let (to, from) = (after.placement.now().w_axis, before.placement.now().w_axis);
        assert_eq!(to, glam::DVec4 { y: 33.0, ..from });
    }
}

/// A tall editor with these items selected; the keys act on the first of them.
fn tall_with(change: impl Fn(&mut Editor), items: impl Fn(&Editor) -> Vec<ItemId>) -> Editor {
    let mut editor = Editor::tall();
    change(&mut editor);
    let items = items(&editor);
    editor.ask(Request::Select(items[0]));
    editor.ask(Request::SelectAlso(items.clone(), Also::Only));
    assert_eq!(editor.state().selected(), Some(items[0]));
    assert_eq!(editor.state().others().len(), items.len() - 1);
    editor
}

fn change(editor: &mut Editor, command: Change) {
    let (gesture, label) = (Gesture::Whole, "Change".to_owned());
    editor.ask(Request::Change { command: command.unwrap(), gesture, label });
}

fn ships(editor: &Editor) -> Vec<ItemId> {
    vec![object(editor, "x_wing"), object(editor, "r_falke")]
}

/// Both ships.
fn both(editor: &Editor) -> [Object; 2] {
    let scene = editor.scene();
    ["x_wing", "r_falke"]
        .map(|name| scene.objects.iter().find(|(_, object)| object.name == name).unwrap().1.clone())
}

/// Changes only the second ship.
fn change_second(editor: &mut Editor, change_it: impl FnOnce(&mut Object)) {
    let ItemId::Object(id) = object(editor, "r_falke") else { panic!() };
    change(editor, items::change_object(&editor.scene(), id, change_it));
}

#[test]
fn mixed_values_can_become_what_the_first_item_has() {
    let differ = |editor: &mut Editor| {
        change_second(editor, |object| {
            object.material = MaterialChoice::Preset(PresetId::all().last().unwrap());
            object.sides = Sides::One;
            object.opacity = 0.5;
        });
    };
    let mut editor = tall_with(differ, ships);
    click(&mut editor, Role::DisclosureTriangle, "Drawing");
    let first = both(&editor)[0].clone();
    let MaterialChoice::Preset(material) = first.material else { panic!() };
    let steps = editor.steps();
    // A mixed field that is left without a number changes nothing.
    click(&mut editor, Role::SpinButton, "Opacity");
    editor.press(Named(Key::Tab));
    click(&mut editor, Role::SpinButton, "Opacity");
    editor.press(Named(Key::Enter));
    assert_eq!(editor.steps(), steps);
    // No option of a mixed choice is on.
    let is_on = |editor: &Editor, name: &str| {
        let toggled = control(editor, Role::RadioButton, name).accesskit_node().toggled();
        toggled == Some(egui::accesskit::Toggled::True)
    };
    let sphere = format!("Material: {}", material.get().name);
    assert!(!is_on(&editor, &sphere) && !is_on(&editor, "Sides: Auto"));
    type_into(&mut editor, "Opacity", "1");
    let x = first.placement.now().w_axis.x;
    type_into(&mut editor, "Position X", &x.to_string());
    click(&mut editor, Role::RadioButton, &sphere);
    click(&mut editor, Role::RadioButton, "Sides: Auto");
    for object in both(&editor) {
        let (placement, first) = (*object.placement.now(), &first);
        assert_eq!((placement.w_axis.x, object.opacity), (x, 1.0));
        assert_eq!((&object.material, object.sides), (&first.material, Sides::Auto));
    }
    assert!(is_on(&editor, &sphere) && is_on(&editor, "Sides: Auto"));
    assert_eq!(editor.steps(), steps + 4);
    assert!(editor.shows("Mixed: edges"));
}

#[test]
fn a_typed_angle_keeps_the_other_angles_of_all_objects() {
    let mut editor = tall_with(
        |editor| {
            let ItemId::Object(id) = object(editor, "x_wing") else { panic!() };
            let (scene, view) = (editor.scene(), editor.view());
            let degrees = DVec3::new(0.0, 0.0, 90.0);
            change(editor, placement::object_turn(&scene, &view, id, degrees, FIRST));
        },
        ships,
    );
    type_into(&mut editor, "Rotation X", "100");
    let turns = both(&editor).map(|object| placement::turn_degrees(object.placement.now()));
    // These say the same as (100, 0, 90).
    assert!(turns[0].distance(DVec3::new(-80.0, 180.0, -90.0)) < 1e-9, "{turns:?}");
    assert!(turns[1].distance(DVec3::new(100.0, 0.0, 0.0)) < 1e-9, "{turns:?}");
    let shown = |editor: &Editor, name| control(editor, Role::SpinButton, name).value().unwrap();
    assert_eq!(shown(&editor, "Rotation X"), "X 100", "it is the same in both");
    assert!(shown(&editor, "Rotation Z").contains("mixed"));
    // A drag beyond a quarter turn goes on in both.
    type_into(&mut editor, "Rotation X", "0");
    type_into(&mut editor, "Rotation Y", "80");
    let at = control(&editor, Role::SpinButton, "Rotation Y").rect().center();
    let path: Vec<_> = (0..=5_u8).map(|i| at + vec2(10.0 * f32::from(i), 0.0)).collect();
    editor.drag(LEFT, &path);
    let text = control(&editor, Role::SpinButton, "Rotation Y").value().unwrap();
    let y: f64 = text.trim_start_matches("Y ").parse().unwrap();
    assert!(y > 95.0, "{text}");
    let turns = both(&editor).map(|object| placement::turn_degrees(object.placement.now()));
    assert!(turns[1].distance(DVec3::new(0.0, y, 0.0)) < 1e-6, "{y}: {turns:?}");
}

#[test]
fn a_typed_yaw_keeps_the_pitch_of_all_cameras() {
    let cameras = |editor: &Editor| -> Vec<CameraId> { editor.scene().cameras.ids().collect() };
    let mut editor = tall_with(
        |editor| {
            editor.perform(Action::AddCamera);
            editor.click_label("Add");
            let (scene, view, id) = (editor.scene(), editor.view(), cameras(editor)[1]);
            let degrees = DVec3::new(5.0, -20.0, 3.0);
            change(editor, placement::camera_turn(&scene, &view, id, degrees, FIRST));
        },
        |editor| cameras(editor).into_iter().map(ItemId::Camera).collect(),
    );
    type_into(&mut editor, "Yaw", "30");
    let scene = editor.scene();
    let degrees = |id| placement::camera_degrees(scene.cameras.get(id).unwrap().pose.now());
    let [first, second] = cameras(&editor)[..] else { panic!() };
    assert!(degrees(first).distance(DVec3::new(30.0, 0.0, 0.0)) < 1e-9, "{}", degrees(first));
    assert!(degrees(second).distance(DVec3::new(30.0, -20.0, 3.0)) < 1e-9, "{}", degrees(second));
}

#[test]
fn a_locked_spot_gets_the_aperture_of_all_but_not_their_place() {
    let spots = |editor: &Editor| -> Vec<LightId> {
        let scene = editor.scene();
        let own = scene.lights.iter().filter(|(_, light)| light.name.starts_with("spot"));
        let mut ids: Vec<LightId> = own.map(|(id, _)| id).collect();
        ids.split_off(ids.len() - 2)
    };
    let mut editor = tall_with(
        |editor| {
            editor.perform_all(&[Action::AddSpot, Action::AddSpot]);
            let id = spots(editor)[1];
            change(editor, lights::set_number(&editor.scene(), id, &HALF_APERTURE, 30.0));
            change(editor, items::toggle_locked(&editor.scene(), ItemId::Light(id)));
        },
        |editor| spots(editor).into_iter().map(ItemId::Light).collect(),
    );
    type_into(&mut editor, "Half-aperture", "40");
    type_into(&mut editor, "Position X", "7");
    let scene = editor.scene();
    let kinds = spots(&editor).into_iter().map(|id| scene.lights.get(id).unwrap().kind.clone());
    let numbers: Vec<(f64, f64)> = kinds
        .map(|kind| {
            let place = kind.owner().and_then(SpotOwner::fixed).unwrap().now().position;
            ((HALF_APERTURE.get)(&kind).unwrap(), place.x)
        })
        .collect();
    assert_eq!(numbers, [(40.0, 7.0), (40.0, 0.0)]);
}

#[test]
fn up_axis_and_texture_go_to_all_objects_in_one_step() {
    let (folder, one) = folder_with("one.obj", CUBE);
    let two = folder.path().join("two.obj");
    let texture = folder.path().join("t.ppm");
    std::fs::write(&two, CUBE).unwrap();
    std::fs::write(&texture, "P3 1 1 255 9 9 9\n").unwrap();
    let mut editor = Editor::tall();
    editor.drop_files(&[&one, &two]);
    editor.wait_until(|editor| editor.scene().objects.len() == 2);
    editor.press(Command(Key::A));
    let (before, steps) = (editor.scene(), editor.steps());
    let ups = |editor: &Editor| -> Vec<UpAxis> {
        editor.scene().objects.iter().map(|(_, object)| object.model.options.up).collect()
    };
    editor.click_label("Up axis: Z");
    editor.wait_until(|editor| ups(editor).contains(&UpAxis::Z));
    editor.settle();
    assert_eq!((ups(&editor), editor.steps()), (vec![UpAxis::Z; 2], steps + 1));
    editor.press(Command(Key::Z));
    assert!(editor.scene() == before);
    editor.press(Command(Key::A));
    editor.perform(Action::ChooseTexture);
    editor.type_path(&texture);
    editor.wait_until(|editor| editor.steps() > steps);
    let textured = editor.scene().objects.iter().all(|(_, object)| object.texture.is_some());
    assert!(textured && editor.steps() == steps + 1);
}

#[test]
fn the_selected_object_is_framed_even_if_another_was_selected_before() {
    let mut editor = Editor::new();
    let (first, second) = (object(&editor, "x_wing"), object(&editor, "r_falke"));
    editor.ask(Request::Select(first));
    editor.perform(Action::FrameSelection);
    let pose = |editor: &Editor| *editor.scene().selected_camera(&editor.view()).pose.now();
    let framed = pose(&editor);
    let sun = editor.scene().lights.ids().next().map(ItemId::Light).unwrap();
    for also in [second, sun, second] {
        editor.ask(Request::SelectAlso(vec![also], Also::Toggle));
    }
    editor.perform(Action::FrameSelection);
    assert!(pose(&editor).eye.distance(framed.eye) < 1e-9, "{:?}", pose(&editor));
}

#[test]
fn a_box_inside_of_a_face_selects_its_object_and_a_ground_only_if_alone() {
    let mut editor = Editor::new();
    editor.perform_all(&[Action::New, Action::AddCube, Action::AddGround]);
    let id = |editor: &Editor, name: &str| {
        let scene = editor.scene();
        scene.objects.iter().find(|(_, object)| object.name == name).unwrap().0
    };
    let cube = id(&editor, "cube");
    let selected = |editor: &Editor| editor.view().object == Some(cube);
    let places = (1..20_u8).map(|i| f32::from(i) / 20.0);
    let found = places.into_iter().find(|y| {
        let at = editor.at(0.5, *y);
        editor.click(at, LEFT);
        editor.harness.run_steps(30);
        selected(&editor)
    });
    let at = editor.at(0.5, found.unwrap() + 0.02);
    editor.ask(Request::Select(ItemId::Object(id(&editor, "ground"))));
    assert!(!selected(&editor));
    editor.set_modifiers(Modifiers { ctrl: true, command: true, ..Modifiers::NONE });
    editor.drag(LEFT, &[at - vec2(8.0, 8.0), at, at + vec2(8.0, 8.0)]);
    editor.set_modifiers(Modifiers::NONE);
    assert!(names(&editor).contains(&"cube".to_owned()), "{:?}", names(&editor));
}

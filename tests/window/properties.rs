//! The properties of the selected item.
//!
//! Catches: a field that sets another value than its label, drags that become several steps, a
//! number typed for one item that changes another, fields that round hidden digits, sliders that
//! act differently from keys.

use egui::accesskit::Role;
use egui::{Key, PointerButton, Pos2, vec2};
use egui_kittest::kittest::NodeT as _;
use glam::DVec3;
use marraztu::app::actions::Action;
use marraztu::app::actions::Chord::{Command, Either, Lower, Named, Upper};
use marraztu::app::actions::{Also, Request};
use marraztu_core::base::Shared;
use marraztu_core::base::color::Color;
use marraztu_core::edit::{Gesture, items, placement};
use marraztu_core::scene::{
    Camera, CameraMode, ItemId, Light, LightKind, LoadOptions, MaterialChoice, Model, Object,
    ObjectId, PresetId, Sides, SpotOwner, Surface, View,
};
use marraztu_io::{Progress, parse};

use crate::editor::Editor;
use crate::panels::{click, control, type_text};

fn object(editor: &Editor) -> Object {
    let id = editor.view().object.unwrap();
    editor.scene().objects.get(id).unwrap().clone()
}

fn camera(editor: &Editor) -> Camera {
    editor.scene().selected_camera(&editor.view()).clone()
}

fn light(editor: &Editor) -> Light {
    let id = editor.view().light.unwrap();
    editor.scene().lights.get(id).unwrap().clone()
}

/// An editor with the first light of this kind selected.
fn with_light(wanted: impl Fn(&LightKind) -> bool) -> Editor {
    let mut editor = Editor::tall();
    editor.perform(Action::SubjectLight);
    while !wanted(&light(&editor).kind) {
        editor.perform(Action::NextItem);
    }
    editor
}

fn with_object() -> Editor {
    let mut editor = Editor::tall();
    editor.perform(Action::SubjectObject);
    for section in ["Step sizes", "Spin", "Drawing", "Model"] {
        click(&mut editor, Role::DisclosureTriangle, section);
    }
    editor
}

fn with_camera() -> Editor {
    let mut editor = Editor::tall();
    click(&mut editor, Role::DisclosureTriangle, "Step sizes");
    editor
}

/// Types into a field as a user does: a click, the text, Enter.
pub(crate) fn type_into(editor: &mut Editor, field: &str, text: &str) {
    click(editor, Role::SpinButton, field);
    type_text(editor, text);
    editor.press(Named(Key::Enter));
}

/// Drags a control to the right by a number of points.
fn drag(editor: &mut Editor, role: Role, label: &str, by: f32) {
    let at = control(editor, role, label).rect().center();
    let places: Vec<Pos2> = (0..=4_u8).map(|i| at + vec2(by * f32::from(i) / 4.0, 0.0)).collect();
    editor.drag(PointerButton::Primary, &places);
}

type Read = fn(&Editor) -> f64;

/// The value that each field of an object sets.
const OF_OBJECT: &[(&str, Read)] = &[
    ("Position X", |e| placement::translation(object(e).placement.now()).x),
    ("Position Y", |e| placement::translation(object(e).placement.now()).y),
    ("Position Z", |e| placement::translation(object(e).placement.now()).z),
    ("Rotation X", |e| placement::turn_degrees(object(e).placement.now()).x),
    ("Rotation Y", |e| placement::turn_degrees(object(e).placement.now()).y),
    ("Rotation Z", |e| placement::turn_degrees(object(e).placement.now()).z),
    ("Scale X", |e| placement::scale(object(e).placement.now()).x),
    ("Scale Y", |e| placement::scale(object(e).placement.now()).y),
    ("Scale Z", |e| placement::scale(object(e).placement.now()).z),
    ("Spin speed", |e| object(e).spin.speed),
];

/// The value that each field of a camera sets.
const OF_CAMERA: &[(&str, Read)] = &[
    ("Position X", |e| camera(e).pose.now().eye.x),
    ("Position Y", |e| camera(e).pose.now().eye.y),
    ("Position Z", |e| camera(e).pose.now().eye.z),
    ("Yaw", |e| placement::camera_degrees(camera(e).pose.now()).x),
    ("Pitch", |e| placement::camera_degrees(camera(e).pose.now()).y),
    ("Roll", |e| placement::camera_degrees(camera(e).pose.now()).z),
    ("Field of view", |e| 2.0 * camera(e).lens.half_angle),
    ("Near", |e| camera(e).lens.near),
    ("Far", |e| camera(e).lens.far),
    ("Half-size", |e| camera(e).lens.half_size),
    ("Orthographic near", |e| camera(e).lens.parallel_near),
    ("Orthographic far", |e| camera(e).lens.parallel_far),
];

/// Types and drags in each field. Each entry is one step that sets the field's value, and one undo
/// reverts it.
fn fields_set_what_they_name(mut editor: Editor, fields: &[(&str, Read)]) {
    for (field, read) in fields {
        let (before, steps) = (editor.scene(), editor.steps());
        type_into(&mut editor, field, "2*13.5");
        assert!((read(&editor) - 27.0).abs() < 1e-9, "{field} is {}", read(&editor));
        assert_eq!(editor.steps(), steps + 1, "{field} typed");
        drag(&mut editor, Role::SpinButton, field, 40.0);
        let dragged = read(&editor);
        assert!(dragged > 27.0, "{field} is dragged to {dragged}");
        assert_eq!(editor.steps(), steps + 2, "{field} dragged");
        editor.press(Command(Key::Z));
        let back = read(&editor);
        assert!((back - 27.0).abs() < 1e-9, "{field} is {back} without the drag to {dragged}");
        editor.press(Command(Key::Z));
        assert!(editor.scene() == before, "{field} back from all");
    }
}

#[test]
fn fields_of_an_object_set_the_named_property() {
    fields_set_what_they_name(with_object(), OF_OBJECT);
}

#[test]
fn fields_of_a_camera_set_the_named_property() {
    fields_set_what_they_name(with_camera(), OF_CAMERA);
}

#[test]
fn fields_of_lights_set_the_named_property() {
    let position: Read = |e| match light(e).kind {
        LightKind::Bulb { position, .. } => position.now().y,
        _ => f64::NAN,
    };
    let orbit: Read = |e| match light(e).kind {
        LightKind::Bulb { orbit, .. } => orbit.speed,
        _ => f64::NAN,
    };
    let mut bulb = with_light(|kind| matches!(kind, LightKind::Bulb { .. }));
    click(&mut bulb, Role::DisclosureTriangle, "Attenuation");
    fields_set_what_they_name(
        bulb,
        &[
            ("Position Y", position),
            ("Circling speed", orbit),
            ("Constant", |e| light(e).attenuation.constant),
            ("Linear", |e| light(e).attenuation.linear),
            ("Quadratic", |e| light(e).attenuation.quadratic),
            ("Red as a number", |e| f64::from(light(e).color.0[0])),
            ("Key", |e| f64::from(light(e).slot)),
        ],
    );
    let aperture: Read = |e| match light(e).kind {
        LightKind::Spot { half_aperture, .. } => half_aperture,
        _ => f64::NAN,
    };
    let exponent: Read = |e| match light(e).kind {
        LightKind::Spot { exponent, .. } => exponent,
        _ => f64::NAN,
    };
    let spot = with_light(|kind| matches!(kind, LightKind::Spot { .. }));
    fields_set_what_they_name(spot, &[("Half-aperture", aperture), ("Concentration", exponent)]);
}

#[test]
fn step_sizes_of_keys_are_set_without_an_undo_step() {
    let mut editor = with_object();
    for (field, read) in [
        ("Step: Move", (|view| view.steps.translation) as fn(&View) -> f64),
        ("Step: Rotate", |view| view.steps.rotation),
        ("Step: Scale", |view| view.steps.scaling),
    ] {
        type_into(&mut editor, field, "2.5");
        assert!((read(&editor.view()) - 2.5).abs() < 1e-12, "{field}");
    }
    click(&mut editor, Role::CheckBox, "Move by size");
    assert!(editor.view().steps.by_size);
    assert_eq!(editor.steps(), 0);
}

#[test]
fn the_u_key_takes_a_whole_drag_back() {
    let mut editor = with_object();
    let before = *object(&editor).placement.now();
    drag(&mut editor, Role::SpinButton, "Position X", 60.0);
    assert!(*object(&editor).placement.now() != before);
    editor.perform(Action::TakeBack);
    assert_eq!(*object(&editor).placement.now(), before);
}

#[test]
fn an_angle_beyond_90_degrees_is_kept_while_it_is_dragged() {
    let mut editor = with_object();
    type_into(&mut editor, "Rotation Y", "85");
    drag(&mut editor, Role::SpinButton, "Rotation Y", 100.0);
    let shown = |editor: &Editor, field| {
        control(editor, Role::SpinButton, field).value().unwrap_or_default()
    };
    let turned = shown(&editor, "Rotation Y");
    let degrees: f64 = turned.trim_start_matches("Y ").parse().unwrap();
    assert!(degrees > 100.0, "{turned}");
    assert_eq!(shown(&editor, "Rotation X"), "X 0");
    let z = object(&editor).placement.now().z_axis.truncate();
    let expected =
        DVec3::new(libm::sin(degrees.to_radians()), 0.0, libm::cos(degrees.to_radians()));
    assert!((z - expected).length() < 1e-9, "{z} is not {expected}");
}

#[test]
fn a_number_typed_for_one_item_never_lands_in_another() {
    let mut editor = with_object();
    let first = editor.view().object.unwrap();
    click(&mut editor, Role::SpinButton, "Position Y");
    type_text(&mut editor, "33");
    click(&mut editor, Role::ListBoxOption, "x_wing");
    let scene = editor.scene();
    let height = |id| placement::translation(scene.objects.get(id).unwrap().placement.now()).y;
    let second = editor.view().object.unwrap();
    assert_ne!(first, second);
    assert_eq!((height(first), height(second)), (33.0, 0.0));
    assert_eq!(editor.steps(), 1);
    // The selection changes while a number is typed; then the number belongs to no item.
    click(&mut editor, Role::SpinButton, "Position Z");
    type_text(&mut editor, "44");
    editor.ask(Request::Select(ItemId::Object(first)));
    editor.press(Named(Key::Enter));
    assert_eq!(editor.steps(), 1);
}

#[test]
fn walking_through_the_fields_changes_nothing() {
    let mut editor = with_object();
    let (scene, view, id) = (editor.scene(), editor.view(), editor.view().object.unwrap());
    let third = DVec3::new(1.0 / 3.0, 200.0 / 7.0, 1e-7);
    let stroke = marraztu_core::edit::GesturePhase::First;
    let command = placement::object_turn(&scene, &view, id, third * 3.1, stroke).unwrap();
    let label = String::new();
    editor.ask(Request::Change { command, gesture: Gesture::Whole, label: label.clone() });
    let command = placement::object_translation(&editor.scene(), &view, id, third, stroke).unwrap();
    editor.ask(Request::Change { command, gesture: Gesture::Whole, label });
    let before = editor.scene();
    click(&mut editor, Role::SpinButton, "Position X");
    for _ in 0..12 {
        editor.press(Named(Key::Tab));
    }
    editor.press(Named(Key::Escape));
    let steps: Vec<String> = editor.state().history.steps().map(str::to_owned).collect();
    assert_eq!(steps.len(), 2, "{steps:?}");
    assert!(editor.scene() == before);
}

#[test]
fn nan_and_numbers_that_would_flatten_the_object_change_nothing() {
    let mut editor = with_object();
    let before = editor.scene();
    for (field, text) in
        [("Position X", "abc"), ("Position X", "1/0"), ("Scale X", "0"), ("Rotation Z", "nan")]
    {
        type_into(&mut editor, field, text);
        assert!(editor.scene() == before, "{field} {text}");
    }
    type_into(&mut editor, "Scale X", "0");
    let message = editor.state().message.clone().unwrap();
    assert!(message.text.contains("flatten"), "{}", message.text);
    assert_eq!(editor.steps(), 0);
}

#[test]
fn a_stretch_goes_along_the_axes_of_the_chosen_frame() {
    let mut editor = with_object();
    type_into(&mut editor, "Rotation Z", "90");
    for (frame, button, expected) in [
        (None, "Stretch along own axes", DVec3::new(3.0, 1.0, 1.0)),
        (Some(Action::ToggleFrame), "Stretch along world's axes", DVec3::new(3.0, 3.0, 1.0)),
    ] {
        if let Some(action) = frame {
            editor.perform(action);
        }
        type_into(&mut editor, "Stretch X", "3");
        let steps = editor.steps();
        click(&mut editor, Role::Button, button);
        let scale = placement::scale(object(&editor).placement.now());
        assert!((scale - expected).length() < 1e-9, "{button}: {scale}");
        assert_eq!(editor.steps(), steps + 1);
    }
}

#[test]
fn a_stretch_of_several_objects_multiplies_each_placement() {
    let mut editor = with_object();
    let ids: Vec<ObjectId> = editor.scene().objects.ids().take(2).collect();
    let places = |editor: &Editor| -> Vec<f64> {
        let scene = editor.scene();
        ids.iter().map(|id| scene.objects.get(*id).unwrap().placement.now().w_axis.x).collect()
    };
    assert_eq!(places(&editor), [-100.0, 100.0]);
    let both: Vec<ItemId> = ids.iter().copied().map(ItemId::Object).collect();
    editor.ask(Request::SelectAlso(both, Also::Only));
    editor.perform(Action::ToggleFrame);
    type_into(&mut editor, "Stretch X", "2");
    click(&mut editor, Role::Button, "Stretch along world's axes");
    assert_eq!(places(&editor), [-200.0, 200.0]);
    assert_eq!(editor.steps(), 1);
}

#[test]
fn every_material_is_chosen_by_its_sphere() {
    let mut editor = with_object();
    for id in PresetId::all() {
        click(&mut editor, Role::RadioButton, &format!("Material: {}", id.get().name));
        assert_eq!(object(&editor).material, MaterialChoice::Preset(id));
    }
    click(&mut editor, Role::RadioButton, "Material: the file's own");
    assert_eq!(object(&editor).material, MaterialChoice::File);
    editor.press(Command(Key::Z));
    let last = PresetId::all().last().unwrap();
    assert_eq!(object(&editor).material, MaterialChoice::Preset(last));
}

#[test]
fn ones_own_material_begins_as_the_one_before_and_is_changed_number_by_number() {
    let mut editor = with_object();
    click(&mut editor, Role::RadioButton, "Material: your own");
    let mut expected = PresetId::RUBY.get().material;
    assert_eq!(object(&editor).material, MaterialChoice::Own(expected));
    for (row, channels) in [("Ambient", 0), ("Diffuse", 1), ("Specular", 2)] {
        for (i, channel) in ["red", "green", "blue"].into_iter().enumerate() {
            type_into(&mut editor, &format!("{row} {channel}"), "1/4");
            let factors = [&mut expected.ambient, &mut expected.diffuse, &mut expected.specular];
            factors.into_iter().nth(channels).unwrap()[i] = 0.25;
            assert_eq!(object(&editor).material, MaterialChoice::Own(expected), "{row} {channel}");
        }
    }
    type_into(&mut editor, "Exponent", "12");
    expected.exponent = 12.0;
    assert_eq!(object(&editor).material, MaterialChoice::Own(expected));
}

#[test]
fn the_surface_and_the_drawing_of_an_object_are_chosen() {
    let mut editor = with_object();
    for (label, surface) in [
        ("Surface: Material", Surface::Material),
        ("Surface: Texture", Surface::Texture),
        ("Surface: Both", Surface::TextureAndLight),
    ] {
        click(&mut editor, Role::RadioButton, label);
        assert_eq!(object(&editor).surface, surface);
    }
    for (label, sides) in [
        ("Sides: Two sides", Sides::Two),
        ("Sides: One side", Sides::One),
        ("Sides: Auto", Sides::Auto),
    ] {
        click(&mut editor, Role::RadioButton, label);
        assert_eq!(object(&editor).sides, sides);
    }
    click(&mut editor, Role::CheckBox, "About own Y");
    assert_eq!(object(&editor).spin.axes, [false, true, false]);
    let steps = editor.steps();
    click(&mut editor, Role::Button, "Apply rotation");
    assert_eq!(editor.steps(), steps + 1);
}

#[test]
fn a_slider_of_red_green_or_blue_equals_its_keys() {
    let sun = |kind: &LightKind| matches!(kind, LightKind::Sun { .. });
    for (slider, less, more) in [("Red", Key::Q, 0), ("Green", Key::V, 1), ("Blue", Key::A, 2)] {
        let (mut slid, mut pressed) = (with_light(sun), with_light(sun));
        control(&slid, Role::Slider, slider).set_value_accesskit(252.0);
        slid.settle();
        pressed.hold(Upper(less), 2);
        assert_eq!(light(&slid).color.0[more], 252, "{slider}");
        assert!(slid.scene() == pressed.scene(), "{slider}");
        assert_eq!((slid.steps(), pressed.steps()), (1, 1));
        pressed.press(Lower(less));
        type_into(&mut slid, &format!("{slider} as a number"), "253");
        assert!(slid.scene() == pressed.scene(), "{slider}");
    }
}

#[test]
fn a_drag_of_a_colours_slider_is_one_step() {
    let mut editor = with_light(|kind| matches!(kind, LightKind::Sun { .. }));
    drag(&mut editor, Role::Slider, "Green", -50.0);
    let Color([r, g, b]) = light(&editor).color;
    assert!(r == 255 && g < 255 && b == 255, "{:?}", light(&editor).color);
    assert_eq!(editor.steps(), 1);
    editor.press(Command(Key::Z));
    assert_eq!(light(&editor).color, Color::WHITE);
}

#[test]
fn a_key_that_another_light_has_is_refused() {
    let mut editor = with_light(|kind| matches!(kind, LightKind::Sun { .. }));
    type_into(&mut editor, "Key", "2");
    assert_eq!(light(&editor).slot, 1);
    let message = editor.state().message.clone().unwrap();
    assert!(message.text.contains("another light"), "{}", message.text);
    type_into(&mut editor, "Key", "7");
    assert_eq!(light(&editor).slot, 7);
    click(&mut editor, Role::CheckBox, "Shines");
    assert!(!light(&editor).on);
}

#[test]
fn a_detached_spot_keeps_its_position() {
    let mut editor =
        with_light(|kind| matches!(kind, LightKind::Spot { owner: SpotOwner::SelectedCamera, .. }));
    click(&mut editor, Role::ComboBox, "Shines from");
    editor.click_label("a fixed position");
    let LightKind::Spot { owner: SpotOwner::Fixed(aim), .. } = light(&editor).kind else {
        panic!("it follows {:?}", light(&editor).kind)
    };
    assert_eq!(aim.now().position, camera(&editor).pose.now().eye);
    assert_eq!(aim.now().direction, DVec3::NEG_Z);
    type_into(&mut editor, "Position X", "5");
    type_into(&mut editor, "Direction X", "1");
    let LightKind::Spot { owner: SpotOwner::Fixed(aim), .. } = light(&editor).kind else {
        panic!("it follows {:?}", light(&editor).kind)
    };
    assert!((aim.now().position - DVec3::new(5.0, 0.0, 400.0)).length() < 1e-9);
    let way = DVec3::new(1.0, 0.0, -1.0) / 2_f64.sqrt();
    assert!((aim.now().direction - way).length() < 1e-9, "{}", aim.now().direction);
}

#[test]
fn a_camera_goes_to_analysis_by_its_properties_as_by_the_key() {
    let (mut clicked, mut pressed) = (with_camera(), with_camera());
    let mode = |editor: &Editor| camera(editor).pose.now().mode;
    // Both the view switches and the properties have this control. The last one is in the
    // properties.
    clicked.click_label("Camera mode: Analysis");
    pressed.press(Either(Key::G));
    assert!(matches!(mode(&clicked), CameraMode::Analysis { .. }));
    assert!(clicked.scene() == pressed.scene());
    click(&mut clicked, Role::CheckBox, "Visible");
    assert!(!camera(&clicked).visible);
}

#[test]
fn an_invalid_lens_is_refused_with_a_message() {
    let mut editor = with_camera();
    let before = editor.scene();
    type_into(&mut editor, "Near", "5000");
    assert!(editor.scene() == before);
    let message = editor.state().message.clone().unwrap();
    assert!(message.text.contains("near before far"), "{}", message.text);
}

#[test]
fn the_fields_show_the_effect_of_keys() {
    let mut editor = with_object();
    editor.perform(Action::StepXUp);
    let shown = control(&editor, Role::SpinButton, "Position X").value();
    assert_eq!(shown.as_deref(), Some("X -90"));
}

/// Adds a model with this text, selects it, and returns its id.
fn with_model(editor: &mut Editor, text: &str) -> ObjectId {
    let options = LoadOptions::default();
    let loaded = parse(text.as_bytes(), "a.obj", None, &options, &Progress::new()).unwrap();
    let model = Model { source: Some("/a.obj".into()), ..loaded.model };
    let object = Object::new(Shared::new(model), MaterialChoice::File);
    let command = items::insert_object(&editor.scene(), object);
    editor.ask(Request::Change { command, gesture: Gesture::Whole, label: "Load".to_owned() });
    editor.view().object.unwrap()
}

const TENT: &str = "v 0 0 0\nv 1 1 0\nv 2 0 0\nv 0 0 1\nv 1 1 1\nv 2 0 1\nf 1 2 5 4\nf 2 3 6 5\n";

#[test]
fn a_crease_angle_makes_edges_sharp_or_smooth_in_one_step() {
    let mut editor = with_object();
    let id = with_model(&mut editor, TENT);
    let points = |editor: &Editor| object(editor).model.mesh.points().len();
    assert_eq!(points(&editor), 8, "90 degrees are sharp");
    let (before, steps) = (editor.scene(), editor.steps());
    type_into(&mut editor, "Crease angle", "45*2 + 1");
    assert_eq!((object(&editor).model.options.crease.get(), points(&editor)), (91.0, 6));
    assert_eq!(editor.steps(), steps + 1);
    drag(&mut editor, Role::SpinButton, "Crease angle", -60.0);
    let dragged = object(&editor).model.options.crease.get();
    assert!(dragged < 90.0 && points(&editor) == 8, "{dragged}");
    assert_eq!(editor.steps(), steps + 2);
    editor.press(Command(Key::Z));
    assert_eq!((object(&editor).model.options.crease.get(), points(&editor)), (91.0, 6));
    editor.press(Command(Key::Z));
    assert!(editor.scene() == before);

    // A copy with the same angle shares the model again.
    let copy = items::duplicate(&editor.scene(), ItemId::Object(id), DVec3::ZERO).unwrap();
    editor.ask(Request::Change {
        command: copy,
        gesture: Gesture::Whole,
        label: "Copy".to_owned(),
    });
    type_into(&mut editor, "Crease angle", "120");
    let model = |editor: &Editor, id| editor.scene().objects.get(id).unwrap().model.clone();
    let copy = editor.view().object.unwrap();
    assert!(copy != id && !Shared::same(&model(&editor, id), &model(&editor, copy)));
    type_into(&mut editor, "Crease angle", "60");
    assert!(Shared::same(&model(&editor, id), &model(&editor, copy)));
}

#[test]
fn the_crease_angle_is_off_if_it_has_no_effect() {
    let disabled = |editor: &Editor| {
        control(editor, Role::SpinButton, "Crease angle").accesskit_node().is_disabled()
    };
    let mut editor = with_object();
    assert!(disabled(&editor), "built-in models are always smooth");
    with_model(&mut editor, TENT);
    assert!(!disabled(&editor));
    with_model(&mut editor, &format!("s off\n{TENT}"));
    assert!(disabled(&editor));
    let filed = TENT.replace("f 1 2 5 4", "vn 0 1 0\nf 1//1 2//1 5//1 4//1");
    with_model(&mut editor, &filed);
    assert!(!disabled(&editor), "one face has no normals");
    with_model(&mut editor, &filed.replace("f 2 3 6 5", "f 2//1 3//1 6//1 5//1"));
    assert!(disabled(&editor));
    click(&mut editor, Role::CheckBox, "File normals");
    assert!(!disabled(&editor), "the file's normals are passed over");
}

#[test]
fn a_large_mesh_gets_its_crease_angle_when_the_drag_ends() {
    let side = 460_u32;
    let mut text = String::new();
    for i in 0..side * side {
        // Folds of 74 degrees.
        text += &format!("v {} {} {}\n", i % side, i / side, 0.75 * f64::from(i % side % 2));
    }
    for i in (0..side * (side - 1)).filter(|i| i % side != side - 1) {
        text += &format!("f {} {} {} {}\n", i + 1, i + 2, i + side + 2, i + side + 1);
    }
    let mut editor = with_object();
    with_model(&mut editor, &text);
    editor.perform(Action::ToggleVisible);
    let (before, steps) = (object(&editor).model, editor.steps());
    assert!(before.mesh.polygon_count() > 200_000);
    let at = control(&editor, Role::SpinButton, "Crease angle").rect().center();
    editor.hover(at);
    editor.button(at, PointerButton::Primary, true);
    for by in [20.0, 40.0, 60.0] {
        editor.hover(at + vec2(by, 0.0));
        assert!(Shared::same(&object(&editor).model, &before), "nothing is computed while dragged");
    }
    editor.button(at + vec2(60.0, 0.0), PointerButton::Primary, false);
    editor.settle();
    let after = object(&editor).model;
    assert!(after.options.crease.get() > 80.0, "{:?}", after.options.crease);
    assert!(after.mesh.points().len() < before.mesh.points().len());
    assert_eq!(editor.steps(), steps + 1);
    editor.press(Command(Key::Z));
    assert!(Shared::same(&object(&editor).model, &before));
}

#[test]
fn rotations_go_on_over_a_quarter_turn_and_open_with_the_plainest_angles() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("turned.marraztu");
    let mut editor = with_object();
    let angles = |editor: &Editor| {
        ["X", "Y", "Z"].map(|axis| {
            let field = format!("Rotation {axis}");
            control(editor, Role::SpinButton, &field).value().unwrap_or_default()
        })
    };
    editor.perform(Action::Rotate);
    // Steps beyond 90 degrees continue in the same angle.
    for step in 1..=20 {
        editor.perform(Action::StepYUp);
        let degrees = 10 * step;
        assert_eq!(angles(&editor), ["X 0".to_owned(), format!("Y {degrees}"), "Z 0".to_owned()]);
    }
    for _ in 0..8 {
        editor.perform(Action::Undo);
    }
    assert_eq!(angles(&editor), ["X 0", "Y 120", "Z 0"]);
    for _ in 0..10 {
        editor.perform(Action::StepYUp);
    }
    // A reopened scene has lost its history, so the angles come from the matrix alone.
    editor.press(Command(Key::S));
    editor.type_path(&file);
    editor.wait_until(|_| file.is_file());
    editor.ask(Request::LoadFiles(vec![file]));
    editor.wait_until(|editor| editor.steps() == 0);
    editor.settle();
    assert_eq!(angles(&editor), ["X 0", "Y -140", "Z 0"]);
}

#[test]
fn numbers_typed_with_tab_in_one_slow_frame_go_to_their_fields() {
    let mut editor = Editor::tall();
    editor.perform(Action::SubjectObject);
    click(&mut editor, Role::SpinButton, "Position X");
    let key = |editor: &Editor, key: Key| {
        editor.key(key, true, egui::Modifiers::NONE);
        editor.key(key, false, egui::Modifiers::NONE);
    };
    let digits = |editor: &Editor, digits: &str| {
        for digit in digits.chars() {
            editor.harness.event(egui::Event::Text(digit.to_string()));
        }
    };
    digits(&editor, "11");
    key(&editor, Key::Tab);
    digits(&editor, "12");
    key(&editor, Key::Tab);
    digits(&editor, "13");
    key(&editor, Key::Enter);
    editor.harness.run_steps(10);
    editor.settle();
    let id = editor.view().object.unwrap();
    let scene = editor.scene();
    let placement = scene.objects.get(id).unwrap().placement.now().w_axis.truncate();
    assert_eq!(placement, DVec3::new(11.0, 12.0, 13.0));
}

//! The properties of an object.

use egui::{Button, Id, Ui};
use glam::{DMat3, DMat4, DVec3};

use super::{crease, material, missing, number_row, steps_ui, surface};
use crate::app::actions::{Request, change};
use crate::app::state::State;
use crate::app::widgets::color_picker::swatch;
use crate::app::widgets::controls::{Choice, Switch, choices, fact, row, section};
use crate::app::widgets::number::{Number, keep_angles, short, shown_angles, vector};
use crate::app::widgets::text::grouped;
use marraztu_core::base::Shared;
use marraztu_core::base::math::{self, Axis};
use marraztu_core::edit::{Gesture, arrange, items, motion, placement, transform};
use marraztu_core::scene::{Frame, Model, Object, ObjectId, Sides, Spin, UpAxis};
use marraztu_io::is_example;

const LETTERS: [&str; 3] = ["X", "Y", "Z"];

pub(crate) fn show(ui: &mut Ui, state: &State, requests: &mut Vec<Request>, id: ObjectId) {
    let Some(object) = state.scene.objects.get(id) else { return };
    missing::show(ui, requests, object.missing_files());
    section(ui, "Transform", true, |ui| placement_ui(ui, state, requests, id, object));
    section(ui, "Material", true, |ui| {
        let label = format!("Material of {}", object.name);
        let chosen = material::choice_ui(ui, &object.material, Some(object));
        if let Some((to, gesture)) = chosen {
            let command = items::change_object(&state.scene, id, |object| object.material = to);
            change(requests, label, gesture, command);
        }
    });
    section(ui, "Surface", true, |ui| surface::show(ui, state, requests, id, object));
    steps_ui(ui, state, requests, true);
    section(ui, "Spin", false, |ui| spin_ui(ui, state, requests, id, object));
    section(ui, "Drawing", false, |ui| drawing_ui(ui, state, requests, id, object));
    section(ui, "Model", false, |ui| model_ui(ui, object));
}

fn placement_ui(
    ui: &mut Ui,
    state: &State,
    requests: &mut Vec<Request>,
    id: ObjectId,
    object: &Object,
) {
    let (scene, view) = (&state.scene, &state.view);
    let placement = object.placement.now();
    let speed = (object.largest_extent() / 200.0).clamp(1e-3, 10.0);
    let hint = "Position of the object's origin";
    let field = Number::new("Position", hint).speed(speed);
    let now = placement::translation(placement);
    let position = row(ui, "Position", |ui| vector(ui, &field, now));
    if let Some((to, gesture)) = position {
        let command = placement::object_translation(scene, view, id, to, state.phase(gesture));
        change(requests, format!("Move {}", object.name), gesture, command);
    }
    let hint = "Degrees about X, then Y, then Z of the object";
    // Angles are not unique: those shown stay close to the user's input.
    let canonical = placement::turn_degrees(placement);
    let given = shown_angles(ui, "rotation", canonical, object_turn);
    let field = Number::new("Rotation", hint).speed(0.5);
    let turn = row(ui, "Rotation", |ui| vector(ui, &field, given));
    if let Some((to, gesture)) = turn {
        keep_angles(ui, "rotation", to);
        let command = placement::object_turn(scene, view, id, to, state.phase(gesture));
        change(requests, format!("Rotate {}", object.name), gesture, command);
    }
    let hint = "Scale along the object's own axes relative to its file; negative mirrors";
    let field = Number::new("Scale", hint).speed(0.01);
    let scale = row(ui, "Scale", |ui| vector(ui, &field, placement::scale(placement)));
    if let Some((to, gesture)) = scale {
        let command = placement::object_scale(scene, view, id, to, state.phase(gesture));
        change(requests, format!("Scale {}", object.name), gesture, command);
    }
    stretch_ui(ui, state, requests, object);
    if let Some(size) = size(ui, id, object) {
        let [x, y, z] = size.to_array().map(short);
        fact(ui, "Size", &format!("{x} x {y} x {z}"));
    }
    up_axis_ui(ui, requests, id, object);
}

/// Shows the up axis of the model's file. The program's own models do not show it.
fn up_axis_ui(ui: &mut Ui, requests: &mut Vec<Request>, id: ObjectId, object: &Object) {
    let is_own = object.model.source.as_deref().is_none_or(is_example);
    if is_own {
        return;
    }
    let now = object.model.options.up;
    let mut axes = vec![UpAxis::Y, UpAxis::Z];
    if !axes.contains(&now) {
        axes.push(now);
    }
    let labels: Vec<String> = axes.iter().map(|up| up.word().to_uppercase()).collect();
    let hint = "The axis of the file that points up: the model is read again and turned";
    let all: Vec<Choice<'_>> = labels
        .iter()
        .zip(&axes)
        .map(|(label, up)| Choice::new("Up axis", label, *up == now, hint))
        .collect();
    if let Some(clicked) = row(ui, "Up axis", |ui| choices(ui, &all)) {
        requests.push(Request::TurnUp(id, axes[clicked]));
    }
}

/// Meshes with more vertices are measured only at the end of a drag.
const MOST_WHILE_DRAGGED: usize = 200_000;

/// Returns the size of the box around an object in the world, measured again if it changes.
fn size(ui: &Ui, id: ObjectId, object: &Object) -> Option<DVec3> {
    type Measured = (ObjectId, DMat4, Shared<Model>, Option<DVec3>);
    let key = Id::unique("size of an object");
    let (now, model) = (*object.placement.now(), &object.model);
    // The size is cached, since it visits every vertex.
    let known: Option<Measured> = ui.data(|data| data.get_temp(key));
    if let Some((of, placement, mesh, size)) = known {
        let many = model.mesh.positions().len() > MOST_WHILE_DRAGGED;
        let waits = many && ui.input(|input| input.pointer.any_down());
        if of == id && Shared::same(&mesh, model) && (placement == now || waits) {
            return size;
        }
    }
    let still = Object { spin: Spin::default(), ..object.clone() };
    let size = arrange::world_box(&still, 0.0).map(|bounds| bounds.extent());
    ui.data_mut(|data| data.insert_temp::<Measured>(key, (id, now, model.clone(), size)));
    size
}

/// Shows factors along the axes of the chosen frame, and the button that applies them.
fn stretch_ui(ui: &mut Ui, state: &State, requests: &mut Vec<Request>, object: &Object) {
    let id = ui.scope_id().with("stretch");
    let kept: [f64; 3] = ui.data(|data| data.get_temp(id)).unwrap_or([1.0; 3]);
    let hint = "Factor along each axis of the chosen frame";
    let field = Number::new("Stretch", hint).speed(0.01);
    let factors = row(ui, "Stretch", |ui| vector(ui, &field, DVec3::from_array(kept)));
    if let Some((to, _)) = factors {
        ui.data_mut(|data| data.insert_temp(id, to.to_array()));
    }
    let (axes, hint) = match state.view.frame {
        Frame::Local => ("own axes", "Multiplies along the object's axes"),
        Frame::Global => ("world's axes", "Multiplies along the world's axes, about its centre"),
    };
    row(ui, "", |ui| {
        let button = Button::new(format!("Stretch along {axes}"));
        let response = ui.add_enabled(kept != [1.0; 3], button);
        if response.on_hover_text(hint).on_disabled_hover_text("Set a factor first").clicked() {
            let factors = DVec3::from_array(kept);
            let phase = state.phase(Gesture::Whole);
            let command = transform::stretch(&state.scene, &state.view, factors, phase);
            change(requests, format!("Stretch {}", object.name), Gesture::Whole, command);
        }
    });
}

/// Computes R = Rx Ry Rz of angles in degrees.
fn object_turn(degrees: DVec3) -> DMat3 {
    Axis::ALL.iter().fold(DMat3::IDENTITY, |turn, axis| {
        turn * math::rotation(axis.unit(), degrees[axis.index()].to_radians())
    })
}

fn spin_ui(ui: &mut Ui, state: &State, requests: &mut Vec<Request>, id: ObjectId, object: &Object) {
    let (scene, time) = (&state.scene, state.view.time);
    let spin = object.spin;
    for axis in Axis::ALL {
        let letter = LETTERS[axis.index()];
        let label = format!("About own {letter}");
        let response = Switch::new(&label, spin.axes[axis.index()]).ui(ui);
        let hint = "Spins the object; switching it off keeps the rotation so far";
        if response.on_hover_text(hint).clicked() {
            let command = motion::toggle_spin(scene, id, axis, time);
            change(requests, format!("Spin {}", object.name), Gesture::Whole, command);
        }
    }
    let number = Number::new("Spin speed", "Degrees a second").suffix(" deg/s");
    if let Some((speed, gesture)) = number_row(ui, "Speed", number, spin.speed) {
        let to = Spin { speed, ..spin };
        let command = motion::set_spin(scene, id, to, time, state.phase(gesture));
        change(requests, format!("Spin {}", object.name), gesture, command);
    }
    row(ui, "", |ui| {
        let response = ui.add_enabled(spin.is_on(), Button::new("Apply rotation"));
        let hint = "Applies the rotation so far to the placement";
        if response.on_hover_text(hint).on_disabled_hover_text("The object does not spin").clicked()
        {
            let command = motion::apply_spin(scene, id, time);
            change(requests, format!("Apply the spin of {}", object.name), Gesture::Whole, command);
        }
    });
}

fn drawing_ui(
    ui: &mut Ui,
    state: &State,
    requests: &mut Vec<Request>,
    id: ObjectId,
    object: &Object,
) {
    let scene = &state.scene;
    let set = |requests: &mut Vec<Request>, verb: &str, gesture, command| {
        change(requests, format!("{verb} {}", object.name), gesture, command);
    };
    let sides = [
        ("One side", Sides::One, "Back faces are not drawn."),
        ("Two sides", Sides::Two, "Back faces are drawn too, lit with their normals turned."),
        ("Auto", Sides::Auto, "Two sides of an open surface, one of a closed surface."),
    ];
    let choice = |(label, sides, hint): &(&'static str, Sides, &'static str)| {
        Choice::new("Sides", label, object.sides == *sides, hint)
    };
    let all: Vec<Choice<'_>> = sides.iter().map(choice).collect();
    if let Some(clicked) = choices(ui, &all) {
        let to = sides[clicked].1;
        let command = items::change_object(scene, id, |object| object.sides = to);
        set(requests, "Change the sides of", Gesture::Whole, command);
    }
    let file_normals = Switch {
        enabled: object.model.mesh.has_file_normals(),
        ..Switch::new("File normals", object.file_normals)
    };
    let hint = match file_normals.enabled {
        true => "Uses the file's normals, and computes those that are missing",
        false => "The file has no normals: they are computed",
    };
    if file_normals.ui(ui).on_hover_text(hint).clicked() {
        let command = items::change_object(scene, id, |object| object.file_normals ^= true);
        set(requests, "Change the normals of", Gesture::Whole, command);
    }
    crease::show(ui, state, requests, id, object);
    row(ui, "Edges", |ui| {
        let hint = "The colour of edges and normals";
        if let Some((color, gesture)) = swatch(ui, "Edge colour", hint, object.edge_color) {
            let command = items::change_object(scene, id, |object| object.edge_color = color);
            set(requests, "Colour the edges of", gesture, command);
        }
    });
}

/// Shows the numbers of the model.
fn model_ui(ui: &mut Ui, object: &Object) {
    let model = &object.model;
    let mesh = &model.mesh;
    let source = model.source.as_deref().and_then(|path| path.file_name()).map_or_else(
        || format!("{} (built-in)", model.name),
        |name| name.to_string_lossy().into_owned(),
    );
    fact(ui, "File", &source);
    fact(ui, "Vertices", &grouped(mesh.positions().len()));
    fact(ui, "Polygons", &grouped(mesh.polygon_count()));
    fact(ui, "Triangles", &grouped(mesh.triangle_count()));
    fact(ui, "Parts", &grouped(mesh.parts().len()));
    if let Some(bounds) = mesh.bounds() {
        let [x, y, z] = bounds.extent().to_array().map(short);
        fact(ui, "Extent", &format!("{x} x {y} x {z}"));
    }
}

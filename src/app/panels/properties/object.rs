//! The properties of an object.

use std::collections::BTreeSet;

use egui::{Button, Id, Ui};
use glam::{DMat3, DMat4, DVec3};

use super::{material, missing_ui, number_row, steps_ui};
use crate::app::actions::{Request, Requests, change};
use crate::app::state::State;
use crate::app::widgets::color_picker::swatch;
use crate::app::widgets::controls::{Switch, choose, fact, row, section};
use crate::app::widgets::number::{Number, keep_angles, short, shown_angles, vector};
use crate::app::widgets::text::grouped;
use marraztu_core::base::Shared;
use marraztu_core::base::math::{self, Axis};
use marraztu_core::edit::{
    Gesture, Refusal, arrange, items, motion, placement, several, transform,
};
use marraztu_core::scene::{Command, Frame, Model, Object, ObjectId, Sides, Spin, UpAxis};
use marraztu_io::is_example;

const LETTERS: [&str; 3] = ["X", "Y", "Z"];

/// The object in the panel.
pub(super) struct Shown<'a> {
    pub(super) state: &'a State,
    pub(super) id: ObjectId,
    pub(super) object: &'a Object,
}

pub(crate) fn show(ui: &mut Ui, state: &State, requests: &mut Requests, id: ObjectId) {
    let Some(object) = state.scene.objects.get(id) else { return };
    let shown = Shown { state, id, object };
    missing_ui(ui, requests, object.missing_files());
    section(ui, "Transform", true, |ui| shown.placement_ui(ui, requests));
    section(ui, "Material", true, |ui| {
        if let Some((to, gesture)) = material::choice_ui(ui, &object.material, Some(object)) {
            shown.set(requests, "Material of", gesture, |object| object.material = to);
        }
    });
    section(ui, "Surface", true, |ui| shown.surface_ui(ui, requests));
    steps_ui(ui, state, requests, true);
    section(ui, "Spin", false, |ui| shown.spin_ui(ui, requests));
    section(ui, "Drawing", false, |ui| shown.drawing_ui(ui, requests));
    section(ui, "Model", false, |ui| model_ui(ui, object));
}

impl Shown<'_> {
    /// Requests a change of the scene, labelled with a verb and the name of the object.
    pub(super) fn change(
        &self,
        requests: &mut Requests,
        verb: &str,
        gesture: Gesture,
        command: Result<Command, Refusal>,
    ) {
        change(requests, format!("{verb} {}", self.object.name), gesture, command);
    }

    /// Requests a change of the object.
    pub(super) fn set(
        &self,
        requests: &mut Requests,
        verb: &str,
        gesture: Gesture,
        to: impl FnOnce(&mut Object),
    ) {
        self.change(requests, verb, gesture, items::change_object(&self.state.scene, self.id, to));
    }

    fn placement_ui(&self, ui: &mut Ui, requests: &mut Requests) {
        let Self { state, id, object } = *self;
        let (scene, view) = (&state.scene, &state.view);
        let placement = object.placement.now();
        let speed = (object.largest_extent() / 200.0).clamp(1e-3, 10.0);
        let field = Number::new("Position", "Position of the object's origin").speed(speed);
        let now = placement::translation(placement);
        if let Some((to, gesture)) = row(ui, "Position", |ui| vector(ui, &field, now)) {
            let command = placement::object_translation(scene, view, id, to, state.phase(gesture));
            self.change(requests, "Move", gesture, command);
        }
        let hint = "Degrees about X, then Y, then Z of the object";
        // Angles are not unique: those shown stay close to the user's input.
        let canonical = placement::turn_degrees(placement);
        let given = shown_angles(ui, "rotation", canonical, object_turn);
        let field = Number::new("Rotation", hint).speed(0.5);
        if let Some((to, gesture)) = row(ui, "Rotation", |ui| vector(ui, &field, given)) {
            keep_angles(ui, "rotation", to);
            let command = placement::object_turn(scene, view, id, to, state.phase(gesture));
            self.change(requests, "Rotate", gesture, command);
        }
        let hint = "Scale along the object's own axes relative to its file; negative mirrors";
        let field = Number::new("Scale", hint).speed(0.01);
        let now = placement::scale(placement);
        if let Some((to, gesture)) = row(ui, "Scale", |ui| vector(ui, &field, now)) {
            let command = placement::object_scale(scene, view, id, to, state.phase(gesture));
            self.change(requests, "Scale", gesture, command);
        }
        self.stretch_ui(ui, requests);
        if let Some(size) = size(ui, id, object) {
            let [x, y, z] = size.to_array().map(short);
            fact(ui, "Size", &format!("{x} x {y} x {z}"));
        }
        self.up_axis_ui(ui, requests);
    }

    /// Shows the up axis of the model's file. The program's own models do not show it.
    fn up_axis_ui(&self, ui: &mut Ui, requests: &mut Requests) {
        let model = &self.object.model;
        if model.source.as_deref().is_none_or(is_example) {
            return;
        }
        let now = model.options.up;
        let hint = "The axis of the file that points up: the model is read again and turned";
        let third = Some(now).filter(|up| ![UpAxis::Y, UpAxis::Z].contains(up));
        let axes = [UpAxis::Y, UpAxis::Z].into_iter().chain(third);
        let all: Vec<_> = axes.map(|up| (up.word().to_uppercase(), up, hint)).collect();
        if let Some(up) = row(ui, "Up axis", |ui| choose(ui, "Up axis", now, &all)) {
            requests.push(Request::TurnUp(self.id, up));
        }
    }

    /// Shows factors along the axes of the chosen frame, and the button that applies them.
    fn stretch_ui(&self, ui: &mut Ui, requests: &mut Requests) {
        let state = self.state;
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
            Frame::Global => {
                ("world's axes", "Multiplies along the world's axes, about its centre")
            }
        };
        row(ui, "", |ui| {
            let button = Button::new(format!("Stretch along {axes}"));
            let response = ui.add_enabled(kept != [1.0; 3], button);
            if response.on_hover_text(hint).on_disabled_hover_text("Set a factor first").clicked() {
                let factors = DVec3::from_array(kept);
                let phase = state.phase(Gesture::Whole);
                // Each object is stretched from its own placement.
                let others = state.others();
                let command = several::each(&state.scene, &state.view, &others, |scene, view| {
                    transform::stretch(scene, view, factors, phase)
                });
                self.change(requests, "Stretch", Gesture::Whole, command);
            }
        });
    }

    fn spin_ui(&self, ui: &mut Ui, requests: &mut Requests) {
        let (scene, time) = (&self.state.scene, self.state.view.time);
        let spin = self.object.spin;
        for axis in Axis::ALL {
            let label = format!("About own {}", LETTERS[axis.index()]);
            let response = Switch::new(&label, spin.axes[axis.index()]).ui(ui);
            let hint = "Spins the object; switching it off keeps the rotation so far";
            if response.on_hover_text(hint).clicked() {
                let command = motion::toggle_spin(scene, self.id, axis, time);
                self.change(requests, "Spin", Gesture::Whole, command);
            }
        }
        let number = Number::new("Spin speed", "Degrees a second").suffix(" deg/s");
        if let Some((speed, gesture)) = number_row(ui, "Speed", number, spin.speed) {
            let (to, phase) = (Spin { speed, ..spin }, self.state.phase(gesture));
            self.change(
                requests,
                "Spin",
                gesture,
                motion::set_spin(scene, self.id, to, time, phase),
            );
        }
        row(ui, "", |ui| {
            let response = ui.add_enabled(spin.is_on(), Button::new("Apply rotation"));
            let response = response.on_hover_text("Applies the rotation so far to the placement");
            if response.on_disabled_hover_text("The object does not spin").clicked() {
                let command = motion::apply_spin(scene, self.id, time);
                self.change(requests, "Apply the spin of", Gesture::Whole, command);
            }
        });
    }

    fn drawing_ui(&self, ui: &mut Ui, requests: &mut Requests) {
        let object = self.object;
        let sides = [
            ("One side", Sides::One, "Back faces are not drawn."),
            ("Two sides", Sides::Two, "Back faces are drawn too, lit with their normals turned."),
            ("Auto", Sides::Auto, "Two sides of an open surface, one of a closed surface."),
        ];
        if let Some(to) = choose(ui, "Sides", object.sides, &sides) {
            self.set(requests, "Change the sides of", Gesture::Whole, |object| object.sides = to);
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
            let toggle = |object: &mut Object| object.file_normals ^= true;
            self.set(requests, "Change the normals of", Gesture::Whole, toggle);
        }
        self.crease_ui(ui, requests);
        row(ui, "Edges", |ui| {
            let hint = "The colour of edges and normals";
            if let Some((color, gesture)) = swatch(ui, "Edge colour", hint, object.edge_color) {
                let set = |object: &mut Object| object.edge_color = color;
                self.set(requests, "Colour the edges of", gesture, set);
            }
        });
    }
}

/// Meshes with more vertices are measured only at the end of a drag.
const MOST_WHILE_DRAGGED: usize = 200_000;

/// Returns the size of the box around an object in the world, measured again if it changes.
fn size(ui: &Ui, id: ObjectId, object: &Object) -> Option<DVec3> {
    type Measured = (ObjectId, DMat4, Shared<Model>, BTreeSet<u32>, Option<DVec3>);
    let key = Id::unique("size of an object");
    let (now, model, hidden) = (*object.placement.now(), &object.model, &object.hidden_parts);
    // The size is cached, since it visits every vertex.
    let known: Option<Measured> = ui.data(|data| data.get_temp(key));
    if let Some((of, placement, mesh, without, size)) = known {
        let many = model.mesh.positions().len() > MOST_WHILE_DRAGGED;
        let waits = many && ui.input(|input| input.pointer.any_down());
        let is_same = of == id && Shared::same(&mesh, model) && without == *hidden;
        if is_same && (placement == now || waits) {
            return size;
        }
    }
    let still = Object { spin: Spin::default(), ..object.clone() };
    let size = arrange::world_box(&still, 0.0).map(|bounds| bounds.extent());
    let measured = (id, now, model.clone(), hidden.clone(), size);
    ui.data_mut(|data| data.insert_temp::<Measured>(key, measured));
    size
}

/// Computes R = Rx Ry Rz of angles in degrees.
fn object_turn(degrees: DVec3) -> DMat3 {
    Axis::ALL.iter().fold(DMat3::IDENTITY, |turn, axis| {
        turn * math::rotation(axis.unit(), degrees[axis.index()].to_radians())
    })
}

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

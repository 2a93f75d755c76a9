//! The properties of an object.

use std::collections::BTreeSet;

use egui::{Button, Id, Ui};
use glam::{DMat3, DMat4, DVec3};

use super::several::label;
use super::{material, missing_ui, number_row, steps_ui, up_by_default_ui};
use crate::app::actions::{Request, Requests, change};
use crate::app::state::State;
use crate::app::widgets::color_picker::swatch;
use crate::app::widgets::controls::{Switch, choose, fact, row, section};
use crate::app::widgets::mixed::is_mixed;
use crate::app::widgets::number::{Number, keep_angles, short, shown_angles, vector};
use crate::app::widgets::text::grouped;
use marraztu_core::base::Shared;
use marraztu_core::base::math::{self, Axis};
use marraztu_core::edit::angles::nearest;
use marraztu_core::edit::{
    Change, Gesture, GesturePhase, Refusal, arrange, items, motion, placement, several, transform,
};
use marraztu_core::scene::{
    Frame, ItemId, Model, Object, ObjectId, Scene, Sides, Spin, UpAxis, View,
};
use marraztu_io::is_example;

const LETTERS: [&str; 3] = ["X", "Y", "Z"];

/// The object in the panel, and the other selected objects.
pub(super) struct Shown<'a> {
    pub(super) state: &'a State,
    pub(super) others: &'a [ItemId],
    pub(super) id: ObjectId,
    pub(super) object: &'a Object,
}

pub(crate) fn show(
    ui: &mut Ui,
    state: &State,
    others: &[ItemId],
    requests: &mut Requests,
    id: ObjectId,
) {
    let Some(object) = state.scene.objects.get(id) else { return };
    let shown = Shown { state, others, id, object };
    missing_ui(ui, requests, object.missing_files());
    section(ui, "Transform", true, |ui| shown.placement_ui(ui, requests));
    section(ui, "Material", true, |ui| {
        if let Some((to, gesture)) = material::choice_ui(ui, &object.material, Some(object)) {
            shown.set(requests, "Material of", gesture, |object| object.material = to.clone());
        }
    });
    section(ui, "Surface", true, |ui| shown.surface_ui(ui, requests));
    steps_ui(ui, state, requests, true);
    section(ui, "Spin", false, |ui| shown.spin_ui(ui, requests));
    section(ui, "Drawing", false, |ui| shown.drawing_ui(ui, requests));
    section(ui, "Model", false, |ui| model_ui(ui, object));
}

impl Shown<'_> {
    /// Requests a change of each object, labelled with a verb and the name of the first.
    pub(super) fn change(
        &self,
        requests: &mut Requests,
        verb: &str,
        gesture: Gesture,
        act: impl Fn(&Scene, &View, ObjectId) -> Change,
    ) {
        let State { scene, view, .. } = self.state;
        let command = several::each_object(scene, view, self.others, act);
        change(requests, label(verb, &self.object.name, self.others), gesture, command);
    }

    /// Requests a change of the properties of each object.
    pub(super) fn set(
        &self,
        requests: &mut Requests,
        verb: &str,
        gesture: Gesture,
        to: impl Fn(&mut Object),
    ) {
        self.change(requests, verb, gesture, |scene, _, id| items::change_object(scene, id, &to));
    }

    fn placement_ui(&self, ui: &mut Ui, requests: &mut Requests) {
        let Self { state, id, object, others: _ } = *self;
        let placement = object.placement.now();
        let of = |scene: &Scene, id| Some(*scene.objects.get(id)?.placement.now());
        let speed = (object.largest_extent() / 200.0).clamp(1e-3, 10.0);
        let field = Number::new("Position", "Position of the object's origin").speed(speed);
        let now = placement::translation(placement);
        if let Some((to, gesture)) = row(ui, "Position", |ui| vector(ui, &field, now)) {
            let phase = state.phase(gesture);
            self.change(requests, "Move", gesture, |scene, view, id| {
                let own = placement::translation(&of(scene, id).ok_or(Refusal::Gone)?);
                placement::object_translation(scene, view, id, to.set_in(own), phase)
            });
        }
        let hint = "Degrees about X, then Y, then Z of the object";
        // Angles are not unique: those shown stay close to the user's input.
        let canonical = placement::turn_degrees(placement);
        let given = shown_angles(ui, "rotation", canonical, object_turn);
        let field = Number::new("Rotation", hint).speed(0.5);
        if let Some((to, gesture)) = row(ui, "Rotation", |ui| vector(ui, &field, given)) {
            keep_angles(ui, "rotation", to.set_in(given));
            let phase = state.phase(gesture);
            self.change(requests, "Rotate", gesture, |scene, view, other| {
                let own = placement::turn_degrees(&of(scene, other).ok_or(Refusal::Gone)?);
                let own = if other == id { given } else { nearest(own, given, object_turn) };
                placement::object_turn(scene, view, other, to.set_in(own), phase)
            });
        }
        let hint = "Scale along the object's own axes relative to its file; negative mirrors";
        let field = Number::new("Scale", hint).speed(0.01);
        let now = placement::scale(placement);
        if let Some((to, gesture)) = row(ui, "Scale", |ui| vector(ui, &field, now)) {
            let phase = state.phase(gesture);
            self.change(requests, "Scale", gesture, |scene, view, id| {
                let own = placement::scale(&of(scene, id).ok_or(Refusal::Gone)?);
                placement::object_scale(scene, view, id, to.set_in(own), phase)
            });
        }
        self.stretch_ui(ui, requests);
        if let Some(size) = size(ui, id, object) {
            let [x, y, z] = size.to_array().map(short);
            fact(ui, "Size", &format!("{x} x {y} x {z}"));
        }
        self.up_axis_ui(ui, requests);
    }

    /// Returns the object in the panel and the others.
    pub(super) fn ids(&self) -> Vec<ObjectId> {
        let others = self.others.iter().filter_map(|other| match other {
            ItemId::Object(id) => Some(*id),
            ItemId::Camera(_) | ItemId::Light(_) => None,
        });
        [self.id].into_iter().chain(others).collect()
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
            requests.push(Request::TurnUp(self.ids(), up));
        }
        if now != self.state.up {
            row(ui, "", |ui| up_by_default_ui(ui, self.state, now, requests));
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
            let to = to.set_in(DVec3::from_array(kept));
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
                self.change(requests, "Stretch", Gesture::Whole, |scene, view, _| {
                    transform::stretch(scene, view, factors, phase)
                });
            }
        });
    }

    fn spin_ui(&self, ui: &mut Ui, requests: &mut Requests) {
        let (spin, time) = (self.object.spin, self.state.view.time);
        let of = |scene: &Scene, id| scene.objects.get(id).map(|object| object.spin);
        for axis in Axis::ALL {
            let i = axis.index();
            let label = format!("About own {}", LETTERS[i]);
            let response = Switch::new(&label, spin.axes[i]).ui(ui);
            let hint = "Spins the object; switching it off keeps the rotation so far";
            if response.on_hover_text(hint).clicked() {
                self.change(requests, "Spin", Gesture::Whole, |scene, _, id| {
                    let mut to = of(scene, id).ok_or(Refusal::Gone)?;
                    to.axes[i] = !spin.axes[i];
                    motion::set_spin(scene, id, to, time, GesturePhase::First)
                });
            }
        }
        let number = Number::new("Spin speed", "Degrees a second").suffix(" deg/s");
        if let Some((speed, gesture)) = number_row(ui, "Speed", number, spin.speed) {
            let phase = self.state.phase(gesture);
            self.change(requests, "Spin", gesture, |scene, _, id| {
                let to = Spin { speed, ..of(scene, id).ok_or(Refusal::Gone)? };
                motion::set_spin(scene, id, to, time, phase)
            });
        }
        row(ui, "", |ui| {
            let any = spin.is_on() || is_mixed(ui.ctx(), "Spin");
            let response = ui.add_enabled(any, Button::new("Apply rotation"));
            let response = response.on_hover_text("Applies the rotation so far to the placement");
            if response.on_disabled_hover_text("The object does not spin").clicked() {
                self.change(requests, "Apply the spin of", Gesture::Whole, |scene, _, id| {
                    motion::apply_spin(scene, id, time)
                });
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
            let to = !object.file_normals;
            let set = |object: &mut Object| object.file_normals = to;
            self.set(requests, "Change the normals of", Gesture::Whole, set);
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
pub(super) fn object_turn(degrees: DVec3) -> DMat3 {
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
    for (label, count) in ["Lines", "Points"].into_iter().zip(mesh.stroke_counts()) {
        if count > 0 {
            fact(ui, label, &grouped(count));
        }
    }
    fact(ui, "Parts", &grouped(mesh.parts().len()));
    if let Some(bounds) = mesh.bounds() {
        let [x, y, z] = bounds.extent().to_array().map(short);
        fact(ui, "Extent", &format!("{x} x {y} x {z}"));
    }
}

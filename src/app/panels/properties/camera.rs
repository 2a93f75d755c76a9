//! The properties of a camera.

use egui::Ui;
use glam::{DMat3, DVec3};

use super::several::label;
use super::{material, missing_ui, number_row, steps_ui};
use crate::app::actions::{Requests, change};
use crate::app::panels::view_switches::frame_ui;
use crate::app::state::State;
use crate::app::widgets::controls::{Switch, row, section};
use crate::app::widgets::number::{Number, keep_angles, shown_angles, vector};
use marraztu_core::base::math::{self, Axis};
use marraztu_core::edit::angles::nearest;
use marraztu_core::edit::{Change, Gesture, Refusal, items, placement, several};
use marraztu_core::scene::{Camera, CameraId, ItemId, Lens, Scene, View};

/// The camera in the panel, and the other selected cameras.
struct Shown<'a> {
    state: &'a State,
    others: &'a [ItemId],
    id: CameraId,
    camera: &'a Camera,
}

pub(crate) fn show(
    ui: &mut Ui,
    state: &State,
    others: &[ItemId],
    requests: &mut Requests,
    id: CameraId,
) {
    let Some(camera) = state.scene.cameras.get(id) else { return };
    let shown = Shown { state, others, id, camera };
    missing_ui(ui, requests, camera.missing_file().into_iter());
    section(ui, "Transform", true, |ui| {
        shown.pose_ui(ui, requests);
        row(ui, "Moves", |ui| frame_ui(ui, state, requests));
    });
    section(ui, "Lens", true, |ui| shown.lens_ui(ui, requests));
    steps_ui(ui, state, requests, false);
    section(ui, "Camera model", true, |ui| shown.mark_ui(ui, requests));
}

impl Shown<'_> {
    /// Requests a change of each camera, labelled with a verb and the name of the first.
    fn change(
        &self,
        requests: &mut Requests,
        verb: &str,
        gesture: Gesture,
        act: impl Fn(&Scene, &View, CameraId) -> Change,
    ) {
        let State { scene, view, .. } = self.state;
        let command = several::each_camera(scene, view, self.others, act);
        change(requests, label(verb, &self.camera.name, self.others), gesture, command);
    }

    fn pose_ui(&self, ui: &mut Ui, requests: &mut Requests) {
        let pose = self.camera.pose.now();
        let of = |scene: &Scene, id| Some(*scene.cameras.get(id)?.pose.now());
        let hint = "Position of the camera's eye";
        let eye = row(ui, "Position", |ui| vector(ui, &Number::new("Position", hint), pose.eye));
        if let Some((to, gesture)) = eye {
            let phase = self.state.phase(gesture);
            self.change(requests, "Move", gesture, |scene, view, id| {
                let own = of(scene, id).ok_or(Refusal::Gone)?.eye;
                placement::camera_eye(scene, view, id, to.set_in(own), phase)
            });
        }
        // The angles come from a matrix: the least of them are its rounding.
        let canonical = placement::camera_degrees(pose)
            .map(|degrees| if degrees.abs() < 1e-6 { 0.0 } else { degrees });
        let given = shown_angles(ui, "angles", canonical, camera_turn);
        let rows = [
            ("Yaw", "Degrees about the world's Y: to the left"),
            ("Pitch", "Degrees about the camera's X: up"),
            ("Roll", "Degrees about the camera's Z: counter-clockwise"),
        ];
        for (i, (label, hint)) in rows.into_iter().enumerate() {
            let number = Number::new(label, hint).speed(0.2).suffix(" deg");
            if let Some((degrees, gesture)) = number_row(ui, label, number, given[i]) {
                let set_in = |mut angles: DVec3| {
                    angles[i] = degrees;
                    angles
                };
                keep_angles(ui, "angles", set_in(given));
                let phase = self.state.phase(gesture);
                self.change(requests, "Turn", gesture, |scene, view, id| {
                    let own = placement::camera_degrees(&of(scene, id).ok_or(Refusal::Gone)?);
                    let is_first = id == self.id;
                    let own = if is_first { given } else { nearest(own, given, camera_turn) };
                    placement::camera_turn(scene, view, id, set_in(own), phase)
                });
            }
        }
    }

    fn lens_ui(&self, ui: &mut Ui, requests: &mut Requests) {
        let lens = self.camera.lens;
        let mut set = |changed: Option<(f64, Gesture)>, to: &dyn Fn(f64, Lens) -> Lens| {
            if let Some((value, gesture)) = changed {
                self.change(requests, "Lens of", gesture, |scene, _, id| {
                    let own = scene.cameras.get(id).ok_or(Refusal::Gone)?.lens;
                    items::set_lens(scene, id, to(value, own))
                });
            }
        };
        ui.weak("Perspective");
        let hint =
            "The whole angle across the shorter side of the picture, usually the vertical one";
        let number =
            Number::new("Field of view", hint).speed(0.2).range(0.02..=179.8).suffix(" deg");
        let angle = number_row(ui, "Field of view", number, 2.0 * lens.half_angle);
        set(angle, &|angle, lens| Lens { half_angle: angle / 2.0, ..lens });
        let number = Number::new("Near", "Distance of the near plane: more than 0").speed(0.1);
        let near = number_row(ui, "Near", number, lens.near);
        set(near, &|near, lens| Lens { near, automatic_near: false, ..lens });
        let automatic = lens.automatic_near;
        let hint = "Moves the near plane towards the eye before it cuts a surface in view";
        if Switch::new("Automatic near", automatic).ui(ui).on_hover_text(hint).clicked() {
            let toggle = |_, lens| Lens { automatic_near: !automatic, ..lens };
            set(Some((lens.near, Gesture::Whole)), &toggle);
        }
        let number = Number::new("Far", "Distance of the far plane: more than Near").speed(5.0);
        let far = number_row(ui, "Far", number, lens.far);
        set(far, &|far, lens| Lens { far, ..lens });
        ui.weak("Orthographic");
        let hint = "Units from the axis to the border across the shorter side of the picture";
        let number = Number::new("Half-size", hint).range(1e-9..=1e12);
        let half_size = number_row(ui, "Half-size", number, lens.half_size);
        set(half_size, &|half_size, lens| Lens { half_size, ..lens });
        let number =
            Number::new("Orthographic near", "Distance of the near plane of the orthographic view");
        let near = number_row(ui, "Near", number, lens.parallel_near);
        set(near, &|parallel_near, lens| Lens { parallel_near, ..lens });
        let number = Number::new(
            "Orthographic far",
            "Distance of the far plane of the orthographic view: more than Near",
        )
        .speed(5.0);
        let far = number_row(ui, "Far", number, lens.parallel_far);
        set(far, &|parallel_far, lens| Lens { parallel_far, ..lens });
    }

    /// Shows the properties of the camera's model, as seen by other observers.
    fn mark_ui(&self, ui: &mut Ui, requests: &mut Requests) {
        let hint = "Shows the camera to other observers as a small pyramid";
        let visible = self.camera.visible;
        if Switch::new("Visible", visible).ui(ui).on_hover_text(hint).clicked() {
            self.change(requests, "Show or hide", Gesture::Whole, |scene, _, id| {
                items::change_camera(scene, id, |camera| camera.visible = !visible)
            });
        }
        if let Some((to, gesture)) = material::choice_ui(ui, &self.camera.material, None) {
            self.change(requests, "Material of", gesture, |scene, _, id| {
                items::change_camera(scene, id, |camera| camera.material = to.clone())
            });
        }
    }
}

/// Computes R = Ry Rx Rz of yaw, pitch and roll in degrees.
pub(super) fn camera_turn(degrees: DVec3) -> DMat3 {
    let turn = |axis: Axis, degrees: f64| math::rotation(axis.unit(), degrees.to_radians());
    turn(Axis::Y, degrees.x) * turn(Axis::X, degrees.y) * turn(Axis::Z, degrees.z)
}

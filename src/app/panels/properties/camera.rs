//! The properties of a camera.

use egui::Ui;
use glam::{DMat3, DVec3};

use super::{material, missing_ui, number_row, steps_ui};
use crate::app::actions::{Requests, change};
use crate::app::panels::view_switches::frame_ui;
use crate::app::state::State;
use crate::app::widgets::controls::{Switch, row, section};
use crate::app::widgets::number::{Number, keep_angles, shown_angles, vector};
use marraztu_core::base::math::{self, Axis};
use marraztu_core::edit::{Gesture, items, placement};
use marraztu_core::scene::{Camera, CameraId, Lens};

pub(crate) fn show(ui: &mut Ui, state: &State, requests: &mut Requests, id: CameraId) {
    let Some(camera) = state.scene.cameras.get(id) else { return };
    missing_ui(ui, requests, camera.missing_file().into_iter());
    section(ui, "Transform", true, |ui| {
        pose_ui(ui, state, requests, id, camera);
        row(ui, "Moves", |ui| frame_ui(ui, state, requests));
    });
    section(ui, "Lens", true, |ui| lens_ui(ui, state, requests, id, camera));
    steps_ui(ui, state, requests, false);
    section(ui, "Camera model", true, |ui| mark_ui(ui, state, requests, id, camera));
}

fn pose_ui(ui: &mut Ui, state: &State, requests: &mut Requests, id: CameraId, camera: &Camera) {
    let (scene, view) = (&state.scene, &state.view);
    let pose = camera.pose.now();
    let hint = "Position of the camera's eye";
    let eye = row(ui, "Position", |ui| vector(ui, &Number::new("Position", hint), pose.eye));
    if let Some((to, gesture)) = eye {
        let command = placement::camera_eye(scene, view, id, to, state.phase(gesture));
        change(requests, format!("Move {}", camera.name), gesture, command);
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
            let mut to = given;
            to[i] = degrees;
            keep_angles(ui, "angles", to);
            let command = placement::camera_turn(scene, view, id, to, state.phase(gesture));
            change(requests, format!("Turn {}", camera.name), gesture, command);
        }
    }
}

/// Computes R = Ry Rx Rz of yaw, pitch and roll in degrees.
fn camera_turn(degrees: DVec3) -> DMat3 {
    let turn = |axis: Axis, degrees: f64| math::rotation(axis.unit(), degrees.to_radians());
    turn(Axis::Y, degrees.x) * turn(Axis::X, degrees.y) * turn(Axis::Z, degrees.z)
}

fn lens_ui(ui: &mut Ui, state: &State, requests: &mut Requests, id: CameraId, camera: &Camera) {
    let lens = camera.lens;
    let mut set = |changed: Option<(f64, Gesture)>, to: &dyn Fn(f64) -> Lens| {
        if let Some((value, gesture)) = changed {
            let command = items::set_lens(&state.scene, id, to(value));
            change(requests, format!("Lens of {}", camera.name), gesture, command);
        }
    };
    ui.weak("Perspective");
    let hint = "The whole angle across the shorter side of the picture, usually the vertical one";
    let number = Number::new("Field of view", hint).speed(0.2).range(0.02..=179.8).suffix(" deg");
    let angle = number_row(ui, "Field of view", number, 2.0 * lens.half_angle);
    set(angle, &|angle| Lens { half_angle: angle / 2.0, ..lens });
    let number = Number::new("Near", "Distance of the near plane: more than 0").speed(0.1);
    let near = number_row(ui, "Near", number, lens.near);
    set(near, &|near| Lens { near, ..lens });
    let number = Number::new("Far", "Distance of the far plane: more than Near").speed(5.0);
    let far = number_row(ui, "Far", number, lens.far);
    set(far, &|far| Lens { far, ..lens });
    ui.weak("Orthographic");
    let hint = "Units from the axis to the border across the shorter side of the picture";
    let number = Number::new("Half-size", hint).range(1e-9..=1e12);
    let half_size = number_row(ui, "Half-size", number, lens.half_size);
    set(half_size, &|half_size| Lens { half_size, ..lens });
    let number =
        Number::new("Orthographic near", "Distance of the near plane of the orthographic view");
    let near = number_row(ui, "Near", number, lens.parallel_near);
    set(near, &|parallel_near| Lens { parallel_near, ..lens });
    let number = Number::new(
        "Orthographic far",
        "Distance of the far plane of the orthographic view: more than Near",
    )
    .speed(5.0);
    let far = number_row(ui, "Far", number, lens.parallel_far);
    set(far, &|parallel_far| Lens { parallel_far, ..lens });
}

/// Shows the properties of the camera's model, as seen by other observers.
fn mark_ui(ui: &mut Ui, state: &State, requests: &mut Requests, id: CameraId, camera: &Camera) {
    let scene = &state.scene;
    let hint = "Shows the camera to other observers as a small pyramid";
    if Switch::new("Visible", camera.visible).ui(ui).on_hover_text(hint).clicked() {
        let command = items::change_camera(scene, id, |camera| camera.visible ^= true);
        change(requests, format!("Show or hide {}", camera.name), Gesture::Whole, command);
    }
    if let Some((to, gesture)) = material::choice_ui(ui, &camera.material, None) {
        let command = items::change_camera(scene, id, |camera| camera.material = to);
        change(requests, format!("Material of {}", camera.name), gesture, command);
    }
}

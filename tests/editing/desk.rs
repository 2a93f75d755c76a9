//! A scene and its view, as the window holds them.

use glam::{DMat3, DMat4, DVec3};
use marraztu_core::base::math::Axis;
use marraztu_core::edit::selection::{self, Selection};
use marraztu_core::edit::transform::{self, Sign};
use marraztu_core::edit::{GesturePhase, Refusal};
use marraztu_core::scene::{
    CameraMode, Command, LightKind, Object, Pose, Scene, SpotOwner, Subject, Transformation, View,
};

use super::common;

pub(crate) struct Desk {
    pub(crate) scene: Scene,
    pub(crate) view: View,
}

impl Desk {
    pub(crate) fn new(subject: Subject, transformation: Transformation) -> Self {
        let (scene, mut view) = common::three_objects();
        (view.subject, view.transformation) = (subject, transformation);
        Self { scene, view }
    }

    /// Applies a command, and returns its inverse.
    pub(crate) fn perform(&mut self, command: Result<Command, Refusal>) -> Command {
        let before = self.scene.clone();
        let back = command.unwrap().apply(&mut self.scene).unwrap();
        selection::follow(&before, &self.scene, &mut self.view);
        back
    }

    pub(crate) fn step(&self, axis: Axis, sign: Sign) -> Result<Command, Refusal> {
        transform::step(&self.scene, &self.view, axis, sign, GesturePhase::First)
    }

    pub(crate) fn press(&mut self, axis: Axis, sign: Sign) {
        self.perform(self.step(axis, sign));
    }

    pub(crate) fn take_back(&mut self) {
        self.perform(transform::take_back(&self.scene, &self.view));
    }

    pub(crate) fn analyse(&mut self) {
        self.perform(transform::toggle_analysis(&self.scene, &self.view));
    }

    pub(crate) fn choose(&mut self, selection: Result<Selection, Refusal>) {
        let Selection { view, command } = selection.unwrap();
        self.view = view;
        if let Some(command) = command {
            command.apply(&mut self.scene).unwrap();
        }
    }

    pub(crate) fn object(&self) -> &Object {
        self.scene.objects.get(self.view.object.unwrap()).unwrap()
    }

    pub(crate) fn placement(&self) -> DMat4 {
        *self.object().placement.now()
    }

    pub(crate) fn pose(&self) -> Pose {
        *self.scene.selected_camera(&self.view).pose.now()
    }

    pub(crate) fn camera_depth(&self) -> usize {
        self.scene.selected_camera(&self.view).pose.depth()
    }

    pub(crate) fn mode(&self) -> CameraMode {
        self.pose().mode_with(self.view.object)
    }

    /// Returns position and direction of the selected light; zero if the light has no such value.
    pub(crate) fn light(&self) -> (DVec3, DVec3) {
        match &self.scene.lights.get(self.view.light.unwrap()).unwrap().kind {
            LightKind::Sun { direction } => (DVec3::ZERO, *direction.now()),
            LightKind::Bulb { position, .. } => (*position.now(), DVec3::ZERO),
            LightKind::Spot { owner: SpotOwner::Fixed(aim), .. } => {
                (aim.now().position, aim.now().direction)
            }
            _ => (DVec3::ZERO, DVec3::ZERO),
        }
    }

    /// The angle in radians between the camera's axis and the centre of the selected object.
    pub(crate) fn off_aim(&self) -> f64 {
        let pose = self.pose();
        let to_eye = pose.eye - self.object().centre(self.view.time);
        to_eye.cross(pose.axes.z_axis).length().atan2(to_eye.dot(pose.axes.z_axis))
    }
}

/// The rotation matrix about one axis, written out per axis independently of glam.
pub(crate) fn turned(axis: Axis, degrees: f64) -> DMat3 {
    let (s, c) = degrees.to_radians().sin_cos();
    let rows = match axis {
        Axis::X => [[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]],
        Axis::Y => [[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]],
        Axis::Z => [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]],
    };
    DMat3::from_cols_array_2d(&rows).transpose()
}

#[track_caller]
pub(crate) fn close(a: DVec3, b: DVec3) {
    assert!((a - b).length() < 1e-9, "{a} is not {b}");
}

#[track_caller]
pub(crate) fn close_matrix(a: DMat4, b: DMat4) {
    assert!(a.abs_diff_eq(b, 1e-9), "{a} is not {b}");
}

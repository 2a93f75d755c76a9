//! Names the steps of the history.

use super::info::{Group, StepName};
use super::table::Action;
use crate::app::state::State;
use crate::app::widgets::number::short;
use marraztu_core::base::math::Axis;
use marraztu_core::edit::transform::{self, distance};
use marraztu_core::scene::{CameraMode, Subject, Transformation};

impl Action {
    /// Names the effect of the action, repeated `times` times in one gesture, for the history:
    /// "Move teapot 10 along x".
    pub fn step_label(self, state: &State, times: u32) -> String {
        let name = &state.acted_on_name();
        let info = self.info();
        match info.step {
            StepName::Label if info.group == Group::Add => {
                format!("Add {}", info.label.to_lowercase())
            }
            StepName::Label => info.label.to_owned(),
            StepName::Around(before, after) => {
                format!("{before} {name} {after}").trim_end().to_owned()
            }
            StepName::Switched(on, off) => {
                let verb = if self.is_on(state) == Some(true) { on } else { off };
                format!("{verb} {name}")
            }
            StepName::Amount(axis, sign) => amount(state, name, axis, sign.of(f64::from(times))),
        }
    }
}

/// Names the effect of `count` steps along or about an axis.
fn amount(state: &State, name: &str, axis: Axis, count: f64) -> String {
    let letter = ["x", "y", "z"][axis.index()];
    let steps = &state.view.steps;
    let (transformation, orbits) = deed(state, axis);
    match transformation {
        Transformation::Translation => {
            let amount = short(count * distance(&state.scene, &state.view, axis));
            format!("Move {name} {amount} along {letter}")
        }
        Transformation::Rotation => {
            let amount = short(count * steps.rotation);
            let (verb, about) = if orbits { ("Orbit", "by") } else { ("Rotate", "about") };
            format!("{verb} {name} {amount} deg {about} {letter}")
        }
        Transformation::Scaling => {
            let factor = libm::pow(steps.scaling, count);
            format!("Scale {name} by {}", short(factor))
        }
    }
}

/// Returns the effect of a step of x, y or z on the selected item, and whether it orbits an object.
fn deed(state: &State, axis: Axis) -> (Transformation, bool) {
    let view = &state.view;
    let chosen = view.transformation;
    match view.subject {
        Subject::Object => (chosen, false),
        Subject::Camera => {
            let pose = state.scene.selected_camera(view).pose.now();
            match (axis, pose.mode_with(view.object)) {
                (Axis::X | Axis::Y, mode) => (Transformation::Rotation, mode != CameraMode::Fly),
                (Axis::Z, _) => (chosen, false),
            }
        }
        Subject::Light => {
            let light = view.light.and_then(|id| state.scene.lights.get(id));
            let does = light.and_then(|light| transform::transformation_of(light, chosen).ok());
            (does.unwrap_or(chosen), false)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_history_names_distance_and_axis_of_a_step() {
        let (scene, view) = marraztu_io::default_scene();
        let mut state = State::new(scene, view);
        let label = |state: &State, action: Action, times| action.step_label(state, times);
        assert_eq!(label(&state, Action::StepXUp, 1), "Rotate camera 1 10 deg about x");
        assert_eq!(label(&state, Action::StepZDown, 3), "Move camera 1 -30 along z");
        state.view.subject = Subject::Object;
        assert_eq!(label(&state, Action::StepXUp, 1), "Move r_falke 10 along x");
        state.view.transformation = Transformation::Rotation;
        assert_eq!(label(&state, Action::StepYDown, 2), "Rotate r_falke -20 deg about y");
        state.view.transformation = Transformation::Scaling;
        assert_eq!(label(&state, Action::StepYUp, 2), "Scale r_falke by 1.44");
        assert_eq!(label(&state, Action::Delete, 1), "Delete r_falke");
        assert_eq!(label(&state, Action::DropToGround, 1), "Drop r_falke to the ground");
        assert_eq!(label(&state, Action::ToggleVisible, 1), "Hide r_falke");
        assert_eq!(label(&state, Action::ToggleLocked, 1), "Lock r_falke");
        assert_eq!(label(&state, Action::AddCube, 1), "Add cube");
    }
}

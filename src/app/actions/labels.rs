//! Names what an action does now, as the history shows it.

use super::table::Action;
use crate::app::state::State;
use crate::app::widgets::number::short;
use crate::base::math::Axis;
use crate::edit::transform::{self, distance};
use crate::scene::{CameraMode, Subject, Transformation};

/// What a step of x, y or z does to the selected item.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Deed {
    Move,
    Turn,
    Orbit,
    Scale,
}

impl Action {
    /// The name of what the action does now when it is asked for `times` times in one gesture, as
    /// the history shows it: "Move teapot 10 along x".
    #[must_use]
    pub fn step_label(self, state: &State, times: u32) -> String {
        let name = &state.acted_on_name();
        let (axis, sign) = match self {
            Self::StepXUp => (Axis::X, 1.0),
            Self::StepXDown => (Axis::X, -1.0),
            Self::StepYUp => (Axis::Y, 1.0),
            Self::StepYDown => (Axis::Y, -1.0),
            Self::StepZUp => (Axis::Z, 1.0),
            Self::StepZDown => (Axis::Z, -1.0),
            Self::Delete | Self::Duplicate | Self::Rename | Self::AimAtSelection => {
                return format!("{} {name}", self.info().label);
            }
            Self::DropToGround => return format!("Drop {name} to the ground"),
            Self::ResetPlacement => return format!("Reset the placement of {name}"),
            Self::ToggleLocked => {
                let verb = if self.is_on(state) == Some(true) { "Unlock" } else { "Lock" };
                return format!("{verb} {name}");
            }
            _ => return self.info().label.to_owned(),
        };
        let letter = ["x", "y", "z"][axis.index()];
        let steps = &state.view.steps;
        let many = f64::from(times);
        match deed(state, axis) {
            Deed::Move => {
                let amount = short(sign * many * distance(&state.scene, &state.view, axis));
                format!("Move {name} {amount} along {letter}")
            }
            Deed::Turn => {
                let amount = short(sign * many * steps.rotation);
                format!("Rotate {name} {amount} deg about {letter}")
            }
            Deed::Orbit => {
                let amount = short(sign * many * steps.rotation);
                format!("Orbit {name} {amount} deg by {letter}")
            }
            Deed::Scale => {
                let factor = libm::pow(steps.scaling, sign * many);
                format!("Scale {name} by {}", short(factor))
            }
        }
    }
}

fn deed(state: &State, axis: Axis) -> Deed {
    let view = &state.view;
    let deed = |transformation| match transformation {
        Transformation::Translation => Deed::Move,
        Transformation::Rotation => Deed::Turn,
        Transformation::Scaling => Deed::Scale,
    };
    let chosen = deed(view.transformation);
    match view.subject {
        Subject::Object => chosen,
        Subject::Camera => {
            let pose = state.scene.selected_camera(view).pose.now();
            match (axis, pose.mode_with(view.object)) {
                (Axis::X | Axis::Y, CameraMode::Analysis { .. }) => Deed::Orbit,
                (Axis::X | Axis::Y, CameraMode::Fly) => Deed::Turn,
                (Axis::Z, _) => chosen,
            }
        }
        Subject::Light => {
            let light = view.light.and_then(|id| state.scene.lights.get(id));
            let does = light.map(|light| transform::transformation_of(light, view.transformation));
            does.and_then(Result::ok).map_or(chosen, deed)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_history_says_how_far_and_along_what() {
        let (scene, view) = crate::io::default_scene();
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
    }
}

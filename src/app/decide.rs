//! What an action means for the scene as it is now.
//!
//! Whether an action can be done is asked here as well, by deciding what it would do: so a greyed
//! button, a refusal in the status line and what happens can never disagree.

use super::action::Action;
use super::state::State;
use crate::base::math::Axis;
use crate::edit::frame::Side;
use crate::edit::lights::{APERTURE_STEP, Channel};
use crate::edit::selection::Selection;
use crate::edit::transform::Sign;
use crate::edit::{Refusal, Stroke, frame, items, lights, selection, transform};
use crate::scene::{
    Command, Fill, Frame, LightKind, NormalLength, Normals, ObjectId, Projection, SpotOwner,
    Subject, Transformation, View,
};

/// What an action means.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Meaning {
    /// A change of the scene.
    Change(Command),
    /// A change of the scene, whose new item becomes the subject.
    Add(Command, Subject),
    /// A change of the view.
    Look(Box<View>),
    /// Another selection.
    Select(Box<Selection>),
    /// Something of the window, which the app does itself.
    Window,
}

type Decided = Result<Meaning, Refusal>;

/// What `action` means; `stroke` says where in a gesture it stands.
///
/// # Errors
/// Why it cannot be done now.
pub(super) fn decide(action: Action, state: &State, stroke: Stroke) -> Decided {
    let (scene, view) = (&state.scene, &state.view);
    if let Some((axis, sign)) = action.step() {
        return transform::step(scene, view, axis, sign, stroke).map(Meaning::Change);
    }
    if let Some((channel, by)) = action.color_step() {
        return lights::step_color(scene, view, channel, by).map(Meaning::Change);
    }
    if let Some(slot) = action.slot() {
        return lights::toggle_slot(scene, slot).map(Meaning::Change);
    }
    let change = match action {
        Action::TakeBack => transform::take_back(scene, view),
        Action::Delete => items::remove(scene, selected(state)?),
        Action::Split => items::split(scene, object(state)?),
        Action::ToggleVisible => items::toggle_shown(scene, selected(state)?),
        Action::Duplicate => {
            let id = selected(state)?;
            let subject = selection::subject_of(id);
            return items::duplicate(scene, id).map(|command| Meaning::Add(command, subject));
        }
        Action::FrameSelection => frame::selection(scene, view),
        Action::FrameAll => frame::all(scene, view),
        Action::LookFront => frame::side(scene, view, Side::Front),
        Action::LookRight => frame::side(scene, view, Side::Right),
        Action::LookTop => frame::side(scene, view, Side::Top),
        Action::ApertureUp => lights::step_aperture(scene, view, APERTURE_STEP),
        Action::ApertureDown => lights::step_aperture(scene, view, -APERTURE_STEP),
        Action::ToggleFrame if view.subject == Subject::Camera => {
            transform::toggle_analysis(scene, view)
        }
        Action::AddSun => return add_light(state, lights::sun()),
        Action::AddBulb => return add_light(state, lights::bulb()),
        Action::AddSpot => return add_light(state, lights::spot(lights::fixed())),
        Action::AddObjectSpot => {
            return add_light(state, lights::spot(SpotOwner::Object(object(state)?)));
        }
        Action::AddCameraSpot => {
            return add_light(state, lights::spot(SpotOwner::Camera(view.camera)));
        }
        Action::NextItem => {
            let next = selection::next(scene, view, stroke)?;
            return Ok(Meaning::Select(Box::new(next)));
        }
        _ => return look(action, state),
    };
    change.map(Meaning::Change)
}

fn selected(state: &State) -> Result<crate::scene::ItemId, Refusal> {
    state.selected().ok_or(match state.view.subject {
        Subject::Light => Refusal::NoLight,
        Subject::Camera | Subject::Object => Refusal::NoObject,
    })
}

fn object(state: &State) -> Result<ObjectId, Refusal> {
    state.view.object.ok_or(Refusal::NoObject)
}

fn add_light(state: &State, kind: LightKind) -> Decided {
    let command = items::insert_light(&state.scene, kind)?;
    Ok(Meaning::Add(command, Subject::Light))
}

/// What an action means that changes the view at most.
fn look(action: Action, state: &State) -> Decided {
    let (scene, mut view) = (&state.scene, state.view.clone());
    match action {
        Action::NextPolygon => selection::next_polygon(scene, &mut view)?,
        Action::NextSubject => selection::cycle_subject(&mut view),
        Action::SubjectCamera => selection::set_subject(&mut view, Subject::Camera),
        Action::SubjectObject => selection::set_subject(&mut view, Subject::Object),
        Action::SubjectLight => selection::set_subject(&mut view, Subject::Light),
        Action::Translate => {
            selection::set_transformation(&mut view, Transformation::Translation)?;
        }
        Action::Rotate => selection::set_transformation(&mut view, Transformation::Rotation)?,
        Action::Scale => selection::set_transformation(&mut view, Transformation::Scaling)?,
        Action::ToggleFrame if view.subject == Subject::Light => {
            return Err(Refusal::NoModeOfLight);
        }
        Action::ToggleFrame => view.frame = other(view.frame, Frame::Local, Frame::Global),
        Action::ToggleObserver => selection::toggle_observer(scene, &mut view)?,
        Action::TogglePolygons => selection::toggle_polygons(scene, &mut view)?,
        Action::ToggleOthers if view.polygons.is_some() => view.polygons_stay ^= true,
        Action::ToggleOthers => view.only_selected ^= true,
        Action::ToggleEdges => view.fill = other(view.fill, Fill::Filled, Fill::Edges),
        Action::ToggleEdgesOverFill => view.edges_over_fill ^= true,
        Action::ToggleBackFaces => view.back_faces ^= true,
        Action::ToggleFaceNormals => view.face_normals ^= true,
        Action::ToggleVertexNormals => view.vertex_normals ^= true,
        Action::ToggleNormalLength => {
            view.normal_length =
                other(view.normal_length, NormalLength::Units, NormalLength::BySize);
        }
        Action::ToggleMarks => view.marks ^= true,
        Action::ToggleCoarse => view.coarse_while_moving ^= true,
        Action::ToggleLightNormals => {
            view.normals = other(view.normals, Normals::Vertex, Normals::Face);
        }
        Action::ToggleProjection => {
            view.projection =
                other(view.projection, Projection::Perspective, Projection::Orthographic);
        }
        Action::Undo if state.history.position() == 0 => return Err(Refusal::NothingDone),
        Action::Redo if state.history.position() == state.history.steps().len() => {
            return Err(Refusal::NothingUndone);
        }
        Action::Rename => {
            selected(state)?;
            return Ok(Meaning::Window);
        }
        _ => return Ok(Meaning::Window),
    }
    Ok(Meaning::Look(Box::new(view)))
}

/// The one of two that `now` is not.
fn other<T: Copy + PartialEq>(now: T, first: T, second: T) -> T {
    if now == first { second } else { first }
}

impl Action {
    /// Whether the action can be done now; else why not, as the end of "Not now: ...".
    ///
    /// # Errors
    /// The reason, in words.
    pub fn availability(self, state: &State) -> Result<(), String> {
        match decide(self, state, Stroke::First) {
            Ok(_) => Ok(()),
            Err(refusal) => Err(refusal.to_string()),
        }
    }

    /// The axis along or about which the action transforms, and which way.
    #[must_use]
    pub const fn step(self) -> Option<(Axis, Sign)> {
        Some(match self {
            Self::StepXUp => (Axis::X, Sign::Positive),
            Self::StepXDown => (Axis::X, Sign::Negative),
            Self::StepYUp => (Axis::Y, Sign::Positive),
            Self::StepYDown => (Axis::Y, Sign::Negative),
            Self::StepZUp => (Axis::Z, Sign::Positive),
            Self::StepZDown => (Axis::Z, Sign::Negative),
            _ => return None,
        })
    }

    /// The channel of the selected light's colour that the action changes, and by how much.
    #[must_use]
    pub const fn color_step(self) -> Option<(Channel, i16)> {
        Some(match self {
            Self::RedUp => (Channel::Red, 1),
            Self::RedDown => (Channel::Red, -1),
            Self::GreenUp => (Channel::Green, 1),
            Self::GreenDown => (Channel::Green, -1),
            Self::BlueUp => (Channel::Blue, 1),
            Self::BlueDown => (Channel::Blue, -1),
            _ => return None,
        })
    }

    /// As the history calls what the action does now: "Rotate teapot".
    #[must_use]
    pub fn step_label(self, state: &State) -> String {
        let name = state.selected_name();
        match self {
            _ if self.step().is_some() => {
                let verb = match state.view.transformation {
                    Transformation::Translation => "Move",
                    Transformation::Rotation => "Rotate",
                    Transformation::Scaling => "Scale",
                };
                format!("{verb} {name}")
            }
            Self::Delete | Self::Duplicate => format!("{} {name}", self.look().label),
            _ => self.look().label.to_owned(),
        }
    }
}

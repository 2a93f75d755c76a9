//! Finds out which actions are switches, and whether they are on.

use egui::ThemePreference;

use super::table::Action;
use crate::app::state::State;
use marraztu_core::accuracy::AccuracyPreset;
use marraztu_core::edit::lights;
use marraztu_core::scene::{
    CameraMode, Fill, Frame, NormalLength, Normals, Observer, Projection, Subject, Transformation,
};

/// The switches of the lights, in the order of their keys.
const LIGHT_SWITCHES: [Action; 10] = [
    Action::Light0,
    Action::Light1,
    Action::Light2,
    Action::Light3,
    Action::Light4,
    Action::Light5,
    Action::Light6,
    Action::Light7,
    Action::Light8,
    Action::Light9,
];

impl Action {
    /// Returns the slot of the light that the action switches.
    pub fn slot(self) -> Option<u32> {
        let at = LIGHT_SWITCHES.iter().position(|action| *action == self)?;
        u32::try_from(at).ok()
    }

    /// Returns the preset of the dial that the action chooses.
    pub fn preset(self) -> Option<&'static AccuracyPreset> {
        let place = Self::DIAL.iter().position(|action| *action == self)?;
        AccuracyPreset::dial().get(place)
    }

    /// The actions of the dial, in the order of its presets.
    pub const DIAL: [Self; 4] =
        [Self::DialDraft, Self::DialDefault, Self::DialExact, Self::DialIdeal];

    /// Returns whether the action's switch is on; `None` if the action is not a switch.
    pub fn is_on(self, state: &State) -> Option<bool> {
        let (scene, view) = (&state.scene, &state.view);
        if let Some(slot) = self.slot() {
            return Some(scene.lights.iter().any(|(_, light)| light.slot == slot && light.on));
        }
        Some(match self {
            Self::SubjectCamera => view.subject == Subject::Camera,
            Self::SubjectObject => view.subject == Subject::Object,
            Self::SubjectLight => view.subject == Subject::Light,
            Self::Translate => view.transformation == Transformation::Translation,
            Self::Rotate => view.transformation == Transformation::Rotation,
            Self::Scale => view.transformation == Transformation::Scaling,
            Self::ToggleFrame => match view.subject {
                Subject::Camera => {
                    let pose = scene.selected_camera(view).pose.now();
                    pose.mode_with(view.object) != CameraMode::Fly
                }
                Subject::Object => view.frame == Frame::Global,
                Subject::Light => false,
            },
            Self::ToggleVisible => state.is_shown(state.selected()?)?,
            Self::ToggleLocked => scene.locked.contains(&state.selected()?),
            Self::ToggleEdges => view.fill == Fill::Edges,
            Self::ToggleEdgesOverFill => view.edges_over_fill,
            Self::TogglePolygons => view.polygons.is_some(),
            Self::ToggleOthers => match view.polygons {
                Some(_) => !view.polygons_stay,
                None => view.only_selected,
            },
            Self::ToggleBackFaces => view.back_faces,
            Self::ToggleFaceNormals => view.face_normals,
            Self::ToggleVertexNormals => view.vertex_normals,
            Self::ToggleNormalLength => view.normal_length == NormalLength::BySize,
            Self::ToggleMarks => view.marks,
            Self::ToggleOverlays => state.overlays,
            Self::ToggleGizmo => state.gizmo,
            Self::ToggleDial => state.dial.shown,
            Self::ToggleLoupe => state.loupe,
            Self::DialDraft | Self::DialDefault | Self::DialExact | Self::DialIdeal => {
                self.preset()?.of(&state.settings) == state.settings
            }
            Self::ToggleWatch => state.watches,
            Self::ToggleGrid => state.helpers.grid,
            Self::ToggleDimensions => state.helpers.dimensions,
            Self::ToggleDirections => state.helpers.directions,
            Self::SoloLight => lights::is_solo(scene, view.light?),
            Self::AimByClick => state.aiming,
            Self::ExplainPixel => state.explaining,
            Self::Palette => state.palette,
            Self::ToggleCoarse => state.coarse_while_moving,
            Self::ToggleRefine => state.drawing.refines,
            Self::ToggleLightNormals => view.normals == Normals::Face,
            Self::ToggleAllShadows => lights::casts_shadows(scene),
            Self::ToggleShadows => scene.lights.get(view.light?)?.shadows,
            Self::ToggleProjection => view.projection == Projection::Orthographic,
            Self::ToggleObserver => view.observer == Observer::Object,
            Self::Panel(panel) => match panel.info().dock.side().filter(|_| state.narrow) {
                Some(side) => state.layout.unfolded == Some(side),
                None => state.panels.has(panel),
            },
            Self::Present => state.presenting.is_some(),
            Self::MeasurePlan => state.plan.measuring,
            Self::ThemeSystem => state.theme == ThemePreference::System,
            Self::ThemeLight => state.theme == ThemePreference::Light,
            Self::ThemeDark => state.theme == ThemePreference::Dark,
            // The match is exhaustive, so a new action has to state that it is not a switch.
            Self::New | Self::Open | Self::Load | Self::Save | Self::SaveAs | Self::SavePicture => {
                return None;
            }
            Self::CopyPicture | Self::PictureOptions | Self::SaveTurntable => return None,
            Self::ReloadModels | Self::RecoverWork | Self::FitExposure => return None,
            Self::RecoverDiscarded | Self::FindMissing => return None,
            Self::ExportModels | Self::ExportScene => return None,
            Self::NewAncestor | Self::ToPanelsBack => return None,
            Self::Quit | Self::Undo | Self::Redo | Self::TakeBack | Self::Rename => return None,
            Self::Cut | Self::Copy | Self::Paste | Self::CopyMaterial => return None,
            Self::LightStudio | Self::ChoosePanorama => return None,
            Self::Duplicate | Self::Delete | Self::Split | Self::AddCamera | Self::AddSun => {
                return None;
            }
            Self::AddSky
            | Self::AddBulb
            | Self::AddSpot
            | Self::AddObjectSpot
            | Self::AddCameraSpot => {
                return None;
            }
            Self::AddGround | Self::AddPlane | Self::AddCube | Self::AddSphere => return None,
            Self::AddCylinder | Self::AddTorus => return None,
            Self::DropToGround | Self::ResetPlacement => return None,
            Self::AlignX | Self::AlignY | Self::AlignZ => return None,
            Self::Escape | Self::SelectAll | Self::SelectNone | Self::TypeAmount => return None,
            Self::NextItem | Self::NextPolygon | Self::NextSubject => return None,
            Self::StepXUp | Self::StepXDown | Self::StepYUp | Self::StepYDown => return None,
            Self::StepZUp | Self::StepZDown | Self::FrameSelection | Self::FrameAll => return None,
            Self::PreviousView | Self::NextView | Self::SavedView => return None,
            Self::LookFront | Self::LookRight | Self::LookTop => return None,
            Self::LookBack | Self::LookLeft | Self::LookBottom => return None,
            Self::ApertureUp | Self::ApertureDown | Self::RedUp | Self::RedDown => return None,
            Self::GreenUp | Self::GreenDown | Self::BlueUp | Self::BlueDown => return None,
            Self::LargerText | Self::SmallerText | Self::NormalText => return None,
            Self::PastNotices => return None,
            Self::AimAtSelection | Self::WhyUnseen | Self::ChooseTexture => return None,
            Self::ToPanels | Self::Light0 | Self::Light1 | Self::Light2 | Self::Light3 => {
                return None;
            }
            Self::Light4 | Self::Light5 | Self::Light6 | Self::Light7 => return None,
            Self::Light8 | Self::Light9 => return None,
        })
    }
}

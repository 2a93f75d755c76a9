//! Resolves an action to its effect on the current scene.
//!
//! This also decides whether an action is available. A disabled button, a refusal in the status
//! line and the effect of the action therefore always agree. The matches are exhaustive, so a new
//! action does not compile until it has an effect.

use egui::ThemePreference;

use super::intent::{ClipboardIntent, FileIntent, Intent};
use super::table::Action;
use crate::app::panels::Panel;
use crate::app::state::{State, ViewStep};
use crate::app::widgets::regions::Way;
use marraztu_core::base::math::Axis;
use marraztu_core::edit::framing::Side as LookSide;
use marraztu_core::edit::lights::{APERTURE_STEP, Channel};
use marraztu_core::edit::several::{self, Others};
use marraztu_core::edit::transform::Sign;
use marraztu_core::edit::{
    GesturePhase, Refusal, aiming, arrange, copies, framing, gizmo, items, lighting, lights,
    selection, shapes, transform,
};
use marraztu_core::scene::{
    Command, Fill, Frame, ItemId, LightKind, NormalLength, Normals, ObjectId, Projection, Scene,
    Shape, SpotOwner, Subject, Transformation, View,
};
use marraztu_io::ExportOptions;

type Resolved = Result<Intent, Refusal>;

/// The actions that add a light with a separate position or direction, in the order of menus.
pub(crate) const ADD_LIGHTS: [Action; 4] =
    [Action::AddSky, Action::AddSun, Action::AddBulb, Action::AddSpot];

/// The actions that add an object, in the order of menus.
pub(crate) const ADD_OBJECTS: [Action; 7] = [
    Action::Load,
    Action::AddCube,
    Action::AddSphere,
    Action::AddCylinder,
    Action::AddTorus,
    Action::AddPlane,
    Action::AddGround,
];

/// Returns the effect of `action` in this phase of a gesture.
///
/// # Errors
/// The reason why the action is not available.
pub(crate) fn resolve(action: Action, state: &State, phase: GesturePhase) -> Resolved {
    let (scene, view) = (&state.scene, &state.view);
    let others = state.others();
    // Steps apply to all selected items, as one command.
    let each = |act: &dyn Fn(&Scene, &View) -> Result<Command, Refusal>| {
        several::each(scene, view, &others, act).map(Intent::Change)
    };
    let step = |axis, sign| each(&|scene, view| transform::step(scene, view, axis, sign, phase));
    let color = |channel, by| each(&|scene, view| lights::step_color(scene, view, channel, by));
    let aperture = |by| each(&|scene, view| lights::step_aperture(scene, view, by));
    let look_from = |side| framing::side(scene, view, side).map(Intent::Navigate);
    let file = |intent| Ok(Intent::File(intent));
    match action {
        // Files. Actions without anything to work on are refused here.
        Action::New => file(FileIntent::New),
        Action::Open => file(FileIntent::Open),
        Action::Load => file(FileIntent::Load),
        Action::RecoverWork if state.recoverable.is_empty() => Err(Refusal::NothingToRecover),
        Action::RecoverWork => file(FileIntent::Recover),
        Action::RecoverDiscarded if state.discarded.is_empty() => Err(Refusal::NothingDiscarded),
        Action::RecoverDiscarded => file(FileIntent::RecoverDiscarded),
        Action::FindMissing if scene.missing_files().is_empty() => Err(Refusal::NothingMissing),
        Action::FindMissing => file(FileIntent::FindMissing),
        Action::ReloadModels => file(FileIntent::Reload),
        Action::ToggleWatch => show(|state| state.watches ^= true),
        Action::FitExposure => Ok(Intent::FitExposure),
        Action::Save => file(FileIntent::Save),
        Action::SaveAs => file(FileIntent::SaveAs),
        Action::SavePicture => file(FileIntent::SavePicture),
        Action::CopyPicture => file(FileIntent::CopyPicture),
        Action::PictureOptions => file(FileIntent::PictureOptions),
        Action::SaveTurntable => {
            let visible = scene.objects.iter().any(|(_, object)| object.visible);
            if visible { file(FileIntent::Turntable) } else { Err(Refusal::NothingToFrame) }
        }
        Action::ExportModels => file(FileIntent::Export(ExportOptions::MODELS)),
        Action::ExportScene => file(FileIntent::Export(ExportOptions::SCENE)),
        Action::NewAncestor => file(FileIntent::NewAncestor),
        Action::Quit => file(FileIntent::Quit),

        // Edits of the history and of the selected items.
        Action::Undo if state.history.position() == 0 => Err(Refusal::NothingDone),
        Action::Undo => Ok(Intent::Undo),
        Action::Redo if state.history.position() == state.history.steps().len() => {
            Err(Refusal::NothingUndone)
        }
        Action::Redo => Ok(Intent::Redo),
        Action::Escape => Ok(Intent::Escape),
        Action::TakeBack => each(&transform::take_back),
        Action::Rename => selected(state).map(Intent::Rename),
        Action::Duplicate => {
            let subject = selection::subject_of(selected(state)?);
            copies::duplicate(scene, view, &others).map(|command| Intent::Add(command, subject))
        }
        Action::Delete => delete(state, &others).map(Intent::Change),
        Action::Cut => delete(state, &others).map(|it| clipboard(ClipboardIntent::Cut(it))),
        Action::Copy => selected(state).map(|_| clipboard(ClipboardIntent::Copy)),
        Action::Paste => Ok(clipboard(ClipboardIntent::Paste)),
        Action::CopyMaterial => {
            object(state).map(|id| clipboard(ClipboardIntent::CopyMaterial(id)))
        }
        Action::ChooseTexture => objects(state).map(Intent::ChooseTexture),
        Action::ChoosePanorama => Ok(Intent::ChoosePanorama),
        Action::Split => items::split(scene, object(state)?).map(Intent::Change),
        Action::ToggleVisible => {
            selected(state)?;
            several::toggle_shown(scene, view, &others).map(Intent::Change)
        }
        Action::ToggleLocked => {
            selected(state)?;
            several::toggle_locked(scene, view, &others).map(Intent::Change)
        }
        Action::SelectAll => {
            let first = selected(state)?;
            let all = several::all(scene, view, &others, |item| state.is_listed(item));
            show(move |state| state.several = Others::new(first, all))
        }
        Action::SelectNone if others.is_empty() => Err(Refusal::OneSelected),
        Action::SelectNone => show(|state| state.several = Others::default()),

        // New items.
        Action::AddGround => add_shape(state, Shape::Ground),
        Action::AddPlane => add_shape(state, Shape::Plane),
        Action::AddCube => add_shape(state, Shape::Cube),
        Action::AddSphere => add_shape(state, Shape::Sphere),
        Action::AddCylinder => add_shape(state, Shape::Cylinder),
        Action::AddTorus => add_shape(state, Shape::Torus),
        Action::AddCamera => Ok(Intent::AskCamera),
        Action::AddSky => add_light(state, lights::sky()),
        Action::AddSun => add_light(state, lights::sun()),
        Action::AddBulb => add_light(state, lights::bulb()),
        Action::AddSpot => add_light(state, lights::spot(lights::fixed())),
        Action::AddObjectSpot => add_light(state, lights::spot(SpotOwner::Object(object(state)?))),
        Action::AddCameraSpot => add_light(state, lights::spot(SpotOwner::Camera(view.camera))),

        // The selection.
        Action::NextItem => {
            selection::next(scene, view, phase).map(|next| Intent::Select(Box::new(next)))
        }
        Action::NextPolygon => seen(state, |view| selection::next_polygon(scene, view)),
        Action::NextSubject => viewed(state, selection::cycle_subject),
        Action::SubjectCamera => subject(state, Subject::Camera),
        Action::SubjectObject => subject(state, Subject::Object),
        Action::SubjectLight => subject(state, Subject::Light),

        // Transformations of the subject.
        Action::Translate => transformation(state, Transformation::Translation),
        Action::Rotate => transformation(state, Transformation::Rotation),
        Action::Scale => transformation(state, Transformation::Scaling),
        Action::ToggleFrame => match view.subject {
            Subject::Camera => transform::toggle_analysis(scene, view).map(Intent::Change),
            Subject::Object => {
                viewed(state, |view| view.frame = other(view.frame, Frame::Local, Frame::Global))
            }
            Subject::Light => Err(Refusal::NoModeOfLight),
        },
        Action::TypeAmount => gizmo::pivot(scene, view).map(|_| Intent::TypeAmount),
        Action::DropToGround => {
            object_subject(view)?;
            each(&|scene, view| arrange::drop_to_ground(scene, view, phase))
        }
        Action::ResetPlacement => {
            object_subject(view)?;
            each(&|scene, view| arrange::reset(scene, view, phase))
        }
        Action::AlignX => align(state, &others, Axis::X),
        Action::AlignY => align(state, &others, Axis::Y),
        Action::AlignZ => align(state, &others, Axis::Z),
        Action::StepXUp => step(Axis::X, Sign::Positive),
        Action::StepXDown => step(Axis::X, Sign::Negative),
        Action::StepYUp => step(Axis::Y, Sign::Positive),
        Action::StepYDown => step(Axis::Y, Sign::Negative),
        Action::StepZUp => step(Axis::Z, Sign::Positive),
        Action::StepZDown => step(Axis::Z, Sign::Negative),

        // Display modes.
        Action::ToggleEdges => {
            viewed(state, |view| view.fill = other(view.fill, Fill::Filled, Fill::Edges))
        }
        Action::ToggleEdgesOverFill => viewed(state, |view| view.edges_over_fill ^= true),
        Action::TogglePolygons => seen(state, |view| selection::toggle_polygons(scene, view)),
        Action::ToggleOthers => viewed(state, |view| match view.polygons {
            Some(_) => view.polygons_stay ^= true,
            None => view.only_selected ^= true,
        }),
        Action::ToggleBackFaces => viewed(state, |view| view.back_faces ^= true),
        Action::ToggleFaceNormals => viewed(state, |view| view.face_normals ^= true),
        Action::ToggleVertexNormals => viewed(state, |view| view.vertex_normals ^= true),
        Action::ToggleNormalLength => viewed(state, |view| {
            view.normal_length =
                other(view.normal_length, NormalLength::Units, NormalLength::BySize);
        }),
        Action::ToggleMarks => viewed(state, |view| view.marks ^= true),
        Action::ToggleOverlays => show(|state| state.overlays ^= true),
        Action::ToggleGizmo => show(|state| state.gizmo ^= true),
        Action::ToggleDial => show(|state| state.dial.shown ^= true),
        Action::ToggleLoupe => Ok(Intent::Loupe),
        Action::DialDraft | Action::DialDefault | Action::DialExact | Action::DialIdeal => {
            let preset = action.preset().expect("an action of the dial has a preset");
            show(|state| state.settings = preset.of(&state.settings))
        }
        Action::ToggleCoarse => show(|state| state.coarse_while_moving ^= true),
        Action::ToggleGrid => show(|state| state.helpers.grid ^= true),
        Action::ToggleDimensions => show(|state| state.helpers.dimensions ^= true),
        Action::ToggleDirections => show(|state| state.helpers.directions ^= true),
        Action::ToggleRefine => show(|state| state.drawing.refines ^= true),
        Action::ToggleLightNormals => {
            viewed(state, |view| view.normals = other(view.normals, Normals::Vertex, Normals::Face))
        }

        // The camera.
        Action::ToggleProjection => viewed(state, |view| {
            view.projection =
                other(view.projection, Projection::Perspective, Projection::Orthographic);
        }),
        Action::ToggleObserver => seen(state, |view| selection::toggle_observer(scene, view)),
        Action::FrameSelection => {
            framing::objects(scene, view, &objects(state)?).map(Intent::Navigate)
        }
        Action::FrameAll => framing::all(scene, view).map(Intent::Navigate),
        Action::LookFront => look_from(LookSide::Front),
        Action::LookRight => look_from(LookSide::Right),
        Action::LookTop => look_from(LookSide::Top),
        Action::PreviousView => to_viewpoint(state, ViewStep::Earlier, Refusal::NoEarlierView),
        Action::NextView => to_viewpoint(state, ViewStep::Later, Refusal::NoLaterView),
        Action::SavedView => to_viewpoint(state, ViewStep::Saved, Refusal::AtSavedView),
        Action::WhyUnseen => object(state).map(Intent::WhyUnseen),
        Action::ExplainPixel => show(|state| {
            state.explaining ^= true;
            state.aiming = false;
        }),
        Action::LookBack => look_from(LookSide::Back),
        Action::LookLeft => look_from(LookSide::Left),
        Action::LookBottom => look_from(LookSide::Bottom),

        // Lights.
        Action::Light0
        | Action::Light1
        | Action::Light2
        | Action::Light3
        | Action::Light4
        | Action::Light5
        | Action::Light6
        | Action::Light7
        | Action::Light8
        | Action::Light9 => {
            let slot = action.slot().ok_or(Refusal::NoLight)?;
            lights::toggle_slot(scene, slot).map(Intent::Change)
        }
        Action::ApertureUp => aperture(APERTURE_STEP),
        Action::ApertureDown => aperture(-APERTURE_STEP),
        Action::LightStudio => lighting::studio(scene, view).map(Intent::Change),
        Action::SoloLight => lights::solo(scene, view, &state.lit_before).map(Intent::Change),
        Action::ToggleAllShadows => lights::toggle_all_shadows(scene).map(Intent::Change),
        Action::ToggleShadows => lights::toggle_selected_shadows(scene, view).map(Intent::Change),
        Action::AimAtSelection => each(&|scene, view| aiming::aim_at_selection(scene, view, phase)),
        Action::AimByClick => {
            aiming::can_aim(scene, view)?;
            show(|state| {
                state.aiming ^= true;
                state.explaining = false;
            })
        }
        Action::RedUp => color(Channel::Red, 1),
        Action::RedDown => color(Channel::Red, -1),
        Action::GreenUp => color(Channel::Green, 1),
        Action::GreenDown => color(Channel::Green, -1),
        Action::BlueUp => color(Channel::Blue, 1),
        Action::BlueDown => color(Channel::Blue, -1),

        // The window.
        Action::ToPanels => Ok(Intent::ChangeKeyboardOwner(Way::On)),
        Action::ToPanelsBack => Ok(Intent::ChangeKeyboardOwner(Way::Back)),
        Action::Palette => show(|state| state.palette ^= true),
        Action::PastNotices => Ok(Intent::PastNotices),
        Action::LargerText => zoom(state, 0.1),
        Action::SmallerText => zoom(state, -0.1),
        Action::NormalText => Ok(Intent::Zoom(1.0)),
        Action::Panel(panel) => toggle(state, panel),
        Action::Present => Ok(Intent::Present),
        Action::MeasurePlan => Ok(Intent::Measure),
        Action::ThemeSystem => Ok(Intent::Theme(ThemePreference::System)),
        Action::ThemeLight => Ok(Intent::Theme(ThemePreference::Light)),
        Action::ThemeDark => Ok(Intent::Theme(ThemePreference::Dark)),
    }
}

/// Scales the interface, from half to three times its size.
fn zoom(state: &State, by: f32) -> Resolved {
    let to = ((state.zoom + by) * 10.0).round() / 10.0;
    if !(0.5..=3.0).contains(&to) {
        return Err(Refusal::LargestOrSmallest);
    }
    Ok(Intent::Zoom(to))
}

const fn clipboard(intent: ClipboardIntent) -> Intent {
    Intent::Clipboard(intent)
}

fn delete(state: &State, others: &[ItemId]) -> Result<Command, Refusal> {
    selected(state)?;
    several::each(&state.scene, &state.view, others, |scene, view| {
        items::remove(scene, selection::selected(view).ok_or(Refusal::Gone)?)
    })
}

fn selected(state: &State) -> Result<ItemId, Refusal> {
    state.selected().ok_or(match state.view.subject {
        Subject::Light => Refusal::NoLight,
        Subject::Camera | Subject::Object => Refusal::NoObject,
    })
}

fn object(state: &State) -> Result<ObjectId, Refusal> {
    state.view.object.ok_or(Refusal::NoObject)
}

fn to_viewpoint(state: &State, step: ViewStep, refusal: Refusal) -> Resolved {
    let found = state.viewpoints.at(step, &state.scene, &state.view);
    found.map(|_| Intent::ToViewpoint(step)).ok_or(refusal)
}

fn add_shape(state: &State, shape: Shape) -> Resolved {
    let command = shapes::insert(&state.scene, &state.view, shape);
    Ok(Intent::Add(command, Subject::Object))
}

fn add_light(state: &State, kind: LightKind) -> Resolved {
    let command = items::insert_light(&state.scene, kind)?;
    Ok(Intent::Add(command, Subject::Light))
}

/// Returns the selected objects; if only cameras or lights are selected, the object that was
/// selected last.
fn objects(state: &State) -> Result<Vec<ObjectId>, Refusal> {
    let items = state.selected().into_iter().chain(state.others());
    let objects: Vec<ObjectId> = items
        .filter_map(|item| match item {
            ItemId::Object(id) => Some(id),
            ItemId::Camera(_) | ItemId::Light(_) => None,
        })
        .collect();
    if objects.is_empty() { object(state).map(|id| vec![id]) } else { Ok(objects) }
}

/// Fails unless the keys act on objects.
fn object_subject(view: &View) -> Result<(), Refusal> {
    if view.subject == Subject::Object { Ok(()) } else { Err(Refusal::OnlyObjects) }
}

fn align(state: &State, others: &[ItemId], axis: Axis) -> Resolved {
    let (scene, view) = (&state.scene, &state.view);
    object_subject(view)?;
    arrange::align(scene, view, others, axis, GesturePhase::First).map(Intent::Change)
}

fn show(change: impl FnOnce(&mut State) + 'static) -> Resolved {
    Ok(Intent::Show(Box::new(change)))
}

/// Changes the view in a way that may be refused.
fn seen(state: &State, change: impl FnOnce(&mut View) -> Result<(), Refusal>) -> Resolved {
    let mut view = state.view.clone();
    change(&mut view)?;
    Ok(Intent::View(Box::new(view)))
}

/// Changes the view in a way that is always possible.
fn viewed(state: &State, change: impl FnOnce(&mut View)) -> Resolved {
    let mut view = state.view.clone();
    change(&mut view);
    Ok(Intent::View(Box::new(view)))
}

fn subject(state: &State, subject: Subject) -> Resolved {
    viewed(state, |view| selection::set_subject(view, subject))
}

fn transformation(state: &State, transformation: Transformation) -> Resolved {
    seen(state, |view| selection::set_transformation(view, transformation))
}

/// Shows or hides a panel. In a narrow window, panels at the sides of the picture are unfolded or
/// folded instead.
fn toggle(state: &State, panel: Panel) -> Resolved {
    match panel.info().dock.side().filter(|_| state.narrow) {
        Some(side) => {
            let unfolded = (state.layout.unfolded != Some(side)).then_some(side);
            show(move |state| state.layout.unfolded = unfolded)
        }
        None => show(move |state| state.panels = state.panels.toggled(panel)),
    }
}

/// Returns the one of two values that differs from `now`.
fn other<T: Copy + PartialEq>(now: T, first: T, second: T) -> T {
    if now == first { second } else { first }
}

impl Action {
    /// Checks whether the action is available. The reason, if not, completes "Not now: ...".
    ///
    /// # Errors
    /// The reason, in words.
    pub fn availability(self, state: &State) -> Result<(), String> {
        match resolve(self, state, GesturePhase::First) {
            Ok(_) => Ok(()),
            Err(refusal) => Err(refusal.to_string()),
        }
    }
}

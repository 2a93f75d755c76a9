//! The switches of the view, with their keys, and the settings of accuracy.

use egui::{Id, ScrollArea, Sense, StrokeKind, TextStyle, Ui, WidgetInfo, vec2};

use crate::app::actions::{Action, Group, Request, Requests, change, change_view};
use crate::app::input::buttons::{action_choice, action_switch};
use crate::app::state::{DrawingChoices, State};
use crate::app::theme;
use crate::app::widgets::color_picker::swatch;
use crate::app::widgets::controls::{
    self, Choice, choices, choices_in_rows, choose_in_rows, row, section,
};
use crate::app::widgets::number::Number;
use crate::app::widgets::regions;
use marraztu_core::accuracy::{ACCURACY_PRESETS, AXES, AccuracyPreset, Axis, Samples};
use marraztu_core::scene::{CameraMode, Command, Frame, Subject, View};

pub(crate) fn show(ui: &mut Ui, state: &State, requests: &mut Requests) {
    let area = ScrollArea::vertical().id_salt("view switches").auto_shrink(false);
    area.content_margin(theme::SCROLL_MARGIN).show(ui, |ui| {
        section(ui, "Keys act on", true, |ui| {
            subject_ui(ui, state, requests);
            transformation_ui(ui, state, requests);
            frame_ui(ui, state, requests);
        });
        section(ui, "View", true, |ui| {
            let (of, labels) = ("Observer", ["From camera", "From object"]);
            either_ui(ui, state, requests, of, labels, Action::ToggleObserver);
            let (of, labels) = ("Projection", ["Perspective", "Orthographic"]);
            either_ui(ui, state, requests, of, labels, Action::ToggleProjection);
            let (of, labels) = ("Normals", ["Vertex", "Face"]);
            row(ui, of, |ui| {
                either_ui(ui, state, requests, of, labels, Action::ToggleLightNormals);
            });
            background_ui(ui, state, requests);
        });
        section(ui, "Display", true, |ui| {
            ui.spacing_mut().item_spacing.y = 0.0;
            // Flat shading is in the section above.
            let here = |action: &Action| {
                *action != Action::ToggleLightNormals
                    && !Group::OVER_PICTURE.contains(action)
                    && action.preset().is_none()
            };
            for action in Group::Show.actions().filter(here) {
                action_switch(ui, state, requests, action);
            }
        });
        section(ui, "Over the picture", true, |ui| {
            ui.spacing_mut().item_spacing.y = 0.0;
            for action in Group::OVER_PICTURE {
                action_switch(ui, state, requests, action);
            }
            line_width_ui(ui, state, requests);
        });
        section(ui, "Light", true, |ui| {
            slots_ui(ui, state, requests);
            exposure_ui(ui, state, requests);
            action_switch(ui, state, requests, Action::ToggleAllShadows);
            for axis in AXES.iter().filter(|axis| is_of_light(axis)) {
                axis_ui(ui, axis, state, requests);
            }
        });
        section(ui, "Accuracy", true, |ui| settings_ui(ui, state, requests));
        section(ui, "Still and moving", true, |ui| drawing_ui(ui, state, requests));
    });
}

/// Shows a choice among actions: each entry has a label, whether it is chosen, and the action that
/// chooses it.
fn actions_ui(
    ui: &mut Ui,
    state: &State,
    requests: &mut Requests,
    of: &str,
    actions: &[(&str, bool, Action)],
) {
    let all: Vec<Choice<'_>> = actions
        .iter()
        .map(|(label, on, action)| action_choice(ui, of, (label, *on), *action, state))
        .collect();
    if let Some(clicked) = choices(ui, &all) {
        requests.push(actions[clicked].2.into());
    }
}

/// Shows the subject of the keys. The key `c` changes it to the next one.
pub(crate) fn subject_ui(ui: &mut Ui, state: &State, requests: &mut Requests) {
    let subject = state.view.subject;
    let all = [
        ("Camera", Subject::Camera, Action::SubjectCamera),
        ("Object", Subject::Object, Action::SubjectObject),
        ("Light", Subject::Light, Action::SubjectLight),
    ];
    let next = match subject {
        Subject::Camera => Subject::Object,
        Subject::Object => Subject::Light,
        Subject::Light => Subject::Camera,
    };
    let all_choices: Vec<Choice<'_>> = all
        .iter()
        .map(|(label, this, action)| Choice {
            key: (*this == next).then(|| "c".to_owned()),
            ..action_choice(ui, "Subject", (label, *this == subject), *action, state)
        })
        .collect();
    if let Some(clicked) = choices(ui, &all_choices) {
        requests.push(all[clicked].2.into());
    }
}

fn transformation_ui(ui: &mut Ui, state: &State, requests: &mut Requests) {
    let all = [("Move", Action::Translate), ("Rotate", Action::Rotate), ("Scale", Action::Scale)];
    let all = all.map(|(label, action)| (label, action.is_on(state) == Some(true), action));
    actions_ui(ui, state, requests, "Transformation", &all);
}

/// Shows the mode of cameras, or the frame of an object's transformation.
pub(crate) fn frame_ui(ui: &mut Ui, state: &State, requests: &mut Requests) {
    let view = &state.view;
    let (of, [first, second], is_second) = match view.subject {
        Subject::Camera => {
            let pose = state.scene.selected_camera(view).pose.now();
            let analysis = pose.mode_with(view.object) != CameraMode::Fly;
            ("Camera mode", ["Fly", "Analysis"], analysis)
        }
        Subject::Object | Subject::Light => {
            ("Frame", ["Local", "Global"], view.frame == Frame::Global)
        }
    };
    let all = [(first, !is_second, Action::ToggleFrame), (second, is_second, Action::ToggleFrame)];
    actions_ui(ui, state, requests, of, &all);
}

/// Shows the choice between the states of a switch, off and on.
fn either_ui(
    ui: &mut Ui,
    state: &State,
    requests: &mut Requests,
    of: &str,
    [off, on]: [&str; 2],
    action: Action,
) {
    let is_on = action.is_on(state) == Some(true);
    actions_ui(ui, state, requests, of, &[(off, !is_on, action), (on, is_on, action)]);
}

fn background_ui(ui: &mut Ui, state: &State, requests: &mut Requests) {
    row(ui, "Background", |ui| {
        let color = state.scene.background;
        let changed = swatch(ui, "Background", "Colour of the background", color);
        if let Some((color, gesture)) = changed {
            change(requests, "Set the background", gesture, Ok(Command::Background(color)));
        }
    });
}

/// Shows the width of the lines of models, if any model has lines or points.
fn line_width_ui(ui: &mut Ui, state: &State, requests: &mut Requests) {
    let mut objects = state.scene.objects.iter();
    if objects.all(|(_, object)| object.model.mesh.strokes().is_empty()) {
        return;
    }
    row(ui, "Line width", |ui| {
        let hint = "The width of the lines of models, and the diameter of their points";
        let field =
            Number::new("Line width", hint).suffix(" px").speed(0.02).range(View::LINE_WIDTHS);
        if let Some((line_width, _)) = field.ui(ui, EXPOSURE_WIDTH, state.view.line_width) {
            change_view(requests, state, |view| view.line_width = line_width);
        }
    });
}

/// The width of the exposure field and of the field of the line width, in points.
const EXPOSURE_WIDTH: f32 = 84.0;

/// Shows the exposure, with a button that fits it to the picture.
fn exposure_ui(ui: &mut Ui, state: &State, requests: &mut Requests) {
    row(ui, "Exposure", |ui| {
        let most = View::MOST_EXPOSURE;
        let field = Number::new("Exposure", "Stops: each doubles all light")
            .suffix(" stops")
            .speed(0.02)
            .range(-most..=most);
        if let Some((exposure, _)) = field.ui(ui, EXPOSURE_WIDTH, state.view.exposure) {
            change_view(requests, state, |view| view.exposure = exposure);
        }
    });
    // Next to the field, it would be wider than the panel, and so would all rows below it.
    row(ui, "", |ui| requests.extend(Action::FitExposure.button(ui, state).map(Request::from)));
}

/// Shows the lights that have keys as a row of small switches.
fn slots_ui(ui: &mut Ui, state: &State, requests: &mut Requests) {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 2.0;
        let width = ((ui.available_width() - 9.0 * 2.0) / 10.0).floor();
        let slots = Action::ALL.iter().copied().filter_map(|action| Some((action, action.slot()?)));
        let slots: Vec<(Action, u32)> = slots.collect();
        let ids: Vec<Id> = slots.iter().map(|slot| ui.scope_id().with(("slot", slot.1))).collect();
        let stop = regions::stop(ui, &ids, None, ids.len());
        for (i, ((action, slot), id)) in slots.into_iter().zip(ids).enumerate() {
            let place = Slot { id, is_stop: i == stop, width };
            slot_ui(ui, state, requests, action, slot, place);
        }
    });
}

/// The small switch of a light.
#[derive(Clone, Copy)]
struct Slot {
    id: Id,
    is_stop: bool,
    width: f32,
}

fn slot_ui(
    ui: &mut Ui,
    state: &State,
    requests: &mut Requests,
    action: Action,
    slot: u32,
    place: Slot,
) {
    let light = state.scene.lights.iter().find(|(_, light)| light.slot == slot);
    let on = light.is_some_and(|(_, light)| light.on);
    let enabled = light.is_some();
    // A key without a light keeps the focus, so screen readers can report it.
    let sense = if enabled { Sense::click() } else { Sense::focusable_noninteractive() };
    let (rect, _) = ui.allocate_exact_size(vec2(place.width, theme::ROW), Sense::hover());
    let response = ui.interact(rect, place.id, regions::sense(sense, place.is_stop));
    let label = action.info().label;
    response.widget_info(|| WidgetInfo::selected(egui::Role::CheckBox, enabled, on, label));
    let visuals = ui.visuals();
    let (fill, color) = match (on, enabled) {
        (true, _) => (visuals.selection.bg_fill, visuals.selection.stroke.color),
        (false, true) => (visuals.widgets.inactive.bg_fill, visuals.text_color()),
        (false, false) => (visuals.panel_fill, visuals.disable(visuals.weak_text_color())),
    };
    ui.painter().rect_filled(rect, 3.0, fill);
    if !enabled {
        let line = egui::Stroke::new(1.0, theme::line(visuals));
        ui.painter().rect_stroke(rect, 3.0, line, StrokeKind::Inside);
    }
    if on {
        // An underline as well as a colour marks lights that are on.
        let bar = rect.with_min_y(rect.bottom() - 2.0).shrink2(vec2(3.0, 0.0));
        ui.painter().rect_filled(bar, 1.0, theme::accent(visuals));
    }
    let digit = controls::text(ui, slot.to_string(), TextStyle::Body, place.width);
    let at = rect.center() - digit.size() / 2.0;
    ui.painter().galley_with_override_text_color(at, digit, color);
    controls::focus_ring(ui, rect, &response);
    let name = light.map_or("No light has this key", |(_, light)| light.name.as_str());
    let response = action.explain_also(response, state, name);
    if enabled && response.clicked() {
        requests.push(action.into());
    }
}

/// Shows the accuracy presets and every axis of the table.
fn settings_ui(ui: &mut Ui, state: &State, requests: &mut Requests) {
    let now = state.settings;
    let preset = |preset: &AccuracyPreset| (preset.label, preset.of(&now), preset.in_words());
    let all: Vec<_> = ACCURACY_PRESETS.iter().map(preset).collect();
    if let Some(to) = row(ui, "Accuracy", |ui| choose_in_rows(ui, "Accuracy", now, &all)) {
        requests.push(Request::Settings(to));
    }
    for (i, axis) in AXES.iter().filter(|axis| !is_of_light(axis)).enumerate() {
        // A second region splits the long list for the keyboard.
        if i == AXES.len() / 2 {
            regions::begin(ui, "more axes");
        }
        axis_ui(ui, axis, state, requests);
    }
}

/// Shows the preferences for drawing: refinement, and the time budget while moving.
fn drawing_ui(ui: &mut Ui, state: &State, requests: &mut Requests) {
    let now = state.drawing;
    let hint = "The samples per pixel while nothing moves, and of saved pictures. The setting \
        above is for the moving picture.";
    let refined = Samples::ALL[1..]
        .iter()
        .map(|samples| (format!("{} samples", samples.count()), Some(*samples), hint));
    let all: Vec<_> = std::iter::once(("Off".to_owned(), None, hint)).chain(refined).collect();
    let to = now.refines.then_some(now.refined);
    if let Some(to) = row(ui, "When still", |ui| choose_in_rows(ui, "Refined to", to, &all)) {
        let (refines, refined) = (to.is_some(), to.unwrap_or(now.refined));
        requests.push(Request::Drawing(DrawingChoices { refines, refined, ..now }));
    }
    let hint = "The time limit for a picture while something moves. If a picture takes longer, \
        the window draws the most exact quality that was within the limit when it was measured on \
        this scene.";
    let all = BUDGETS.map(|ms| (format!("{ms} ms"), ms, hint));
    let of = "Time while moving";
    if let Some(budget_ms) = row(ui, "Moving", |ui| choose_in_rows(ui, of, now.budget_ms, &all)) {
        requests.push(Request::Drawing(DrawingChoices { budget_ms, ..now }));
    }
}

/// Milliseconds for 60, 30 and 10 pictures per second.
const BUDGETS: [u16; 3] = [16, 33, 100];

/// Returns whether an axis is in the section for light: shading and highlights.
fn is_of_light(axis: &Axis) -> bool {
    matches!(axis.key, "shading" | "specular")
}

/// Shows the choices of an axis of accuracy.
pub(crate) fn axis_ui(ui: &mut Ui, axis: &Axis, state: &State, requests: &mut Requests) {
    let now = state.settings;
    let senseless = (axis.sense)(&state.scene, &state.view).err();
    let own = |choice: &marraztu_core::accuracy::Choice| {
        choice.is_of_its_own(&state.scene, &state.view, &now)
    };
    // The tooltip states the error of a choice, or why the choice has no effect now.
    let hints: Vec<String> = axis
        .choices
        .iter()
        .map(|choice| match senseless.or_else(|| own(choice).err()) {
            Some(why) => format!("{} Has no effect now: {why}.", choice.what),
            None => format!("{} Error: {}.", choice.what, choice.error),
        })
        .collect();
    let all: Vec<Choice<'_>> = axis
        .choices
        .iter()
        .zip(&hints)
        .map(|(choice, hint)| Choice::new(axis.label, choice.label, choice.is(&now), hint))
        .collect();
    if let Some(clicked) = row(ui, axis.label, |ui| choices_in_rows(ui, &all)) {
        requests.push(Request::Settings(axis.choices[clicked].of(&now)));
    }
}

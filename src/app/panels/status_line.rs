//! The status line: the effect of the next key, and the last message; without a message, mouse
//! input over the picture.
//!
//! If the window is too narrow for all parts, the least important parts in the middle are left out;
//! no part is truncated. Hints about the mouse fill the rest of the line.

use egui::{
    Align, Layout, Popup, PopupCloseBehavior, RichText, Role, ScrollArea, Sense, TextStyle, Ui,
    WidgetInfo, vec2,
};

use super::outline::place;
use crate::app::actions::{Request, Requests};
use crate::app::state::{Message, Reduction, State, Tone};
use crate::app::theme;
use crate::app::widgets::controls;
use crate::app::widgets::icons::Icon;
use crate::app::widgets::number::short;
use crate::app::widgets::text::counted;
use marraztu_core::accuracy::Samples;
use marraztu_core::edit::{steps, transform};
use marraztu_core::scene::{
    CameraMode, Fill, Frame, ItemId, Observer, Projection, Subject, Transformation,
};

/// The separator between parts.
const BETWEEN: &str = "  |  ";

/// Longer names are elided in the middle.
const LONGEST_NAME: usize = 28;

pub(crate) fn show(ui: &mut Ui, state: &State, requests: &mut Requests) {
    ui.horizontal(|ui| {
        ui.set_min_height(theme::ROW);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            if !state.past_notices.is_empty() {
                past_ui(ui, state, requests);
                ui.add_space(theme::GAP);
            }
            // An open system dialog comes first, since it may be hidden behind the window.
            if let Some(title) = state.asking {
                let text = format!("the dialog \"{title}\" is open");
                let message = Message { text, tone: Tone::Done };
                message_ui(ui, &message, ui.available_width() * 0.5);
            } else if let Some(message) = &state.message {
                message_ui(ui, message, ui.available_width() * 0.5);
            } else {
                mouse_ui(ui, state);
            }
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| line_ui(ui, state));
        });
    });
}

/// Shows a button that lists past notices with their details.
fn past_ui(ui: &mut Ui, state: &State, requests: &mut Requests) {
    let name = counted(state.past_notices.len(), "notice", "notices");
    let color = ui.visuals().weak_text_color();
    let galley = controls::text(ui, &name, TextStyle::Body, f32::INFINITY);
    let size = vec2(galley.size().x + theme::ROW, theme::ROW);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    Icon::INFO.paint(ui.painter(), rect.with_max_x(rect.left() + 16.0), 12.0, color);
    controls::put_text(ui, rect.with_min_x(rect.left() + 20.0), galley, color);
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &name));
    controls::focus_ring(ui, rect, &response);
    let popup = Popup::menu(&response).close_behavior(PopupCloseBehavior::CloseOnClickOutside);
    popup.show(|ui| {
        ui.set_width(LIST.x);
        ScrollArea::vertical().max_height(LIST.y).show(ui, |ui| {
            ui.set_width(LIST.x);
            for notice in state.past_notices.iter().rev() {
                ui.label(&notice.text);
                for line in &notice.details {
                    ui.weak(line);
                }
                ui.add_space(theme::GAP);
            }
        });
        if ui.button("Clear").on_hover_text("Clears these notices").clicked() {
            requests.push(Request::ClearNotices);
            ui.close();
        }
    });
    let last = state.past_notices.last().map_or("", |notice| &notice.text);
    response.on_hover_text(last);
}

/// The maximum size of the list of notices.
const LIST: egui::Vec2 = vec2(420.0, 300.0);

fn width(ui: &Ui, text: &str) -> f32 {
    controls::text(ui, RichText::new(text), TextStyle::Body, f32::INFINITY).size().x
}

/// Shows the hints about the mouse that fit next to the whole line.
fn mouse_ui(ui: &mut Ui, state: &State) {
    let used = width(ui, &parts(state).join(BETWEEN)) + 8.0 * theme::GAP;
    let room = ui.available_width() - used;
    let all = mouse_hints(state);
    let shown = (1..=all.len()).rev().map(|count| all[..count].join(BETWEEN));
    let Some(text) = shown.into_iter().find(|text| width(ui, text) <= room) else { return };
    ui.add(egui::Label::new(RichText::new(text).weak()))
        .on_hover_text("Mouse actions over the picture; the list of keys has them all");
}

/// Lists hints about the mouse, the most important first.
fn mouse_hints(state: &State) -> Vec<&'static str> {
    let view = &state.view;
    if view.observer == Observer::Object {
        return vec!["Click: select", "Right click: menu"];
    }
    let pose = state.scene.selected_camera(view).pose.now();
    let [drag, other] = match pose.mode_with(view.object) {
        CameraMode::Fly => ["Drag: look around", "Alt+drag: orbit"],
        CameraMode::Analysis { .. } => ["Drag: orbit", "Right held: fly"],
    };
    vec![drag, "Wheel: zoom", other, "Shift+drag: pan", "Right click: menu"]
}

fn line_ui(ui: &mut Ui, state: &State) {
    let parts = parts(state);
    let room = ui.available_width() - 2.0 * theme::GAP;
    let text = fitted(&parts, |text| width(ui, text) <= room);
    let whole = parts.join(BETWEEN);
    let response = ui.add(egui::Label::new(text).truncate());
    response.widget_info(|| WidgetInfo::labeled(Role::Status, true, &whole));
    response.on_hover_text(format!("{whole}\n{TIME}"));
}

/// The explanation of the time at the end of the line.
const TIME: &str = "The time to draw the last picture, from the scene to pixels in memory. \
    It does not include the time to show the picture in the window.";

fn message_ui(ui: &mut Ui, message: &Message, room: f32) {
    let (icon, color) = match message.tone {
        Tone::Done => (Icon::TICK, ui.visuals().weak_text_color()),
        Tone::Refused => (Icon::WARNING, theme::error(ui.visuals())),
    };
    let text = RichText::new(&message.text).color(color);
    let galley = controls::text(ui, text, TextStyle::Body, room - theme::ROW);
    let size = vec2(galley.size().x + theme::ROW, theme::ROW);
    let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
    icon.paint(ui.painter(), rect.with_max_x(rect.left() + 16.0), 12.0, color);
    controls::put_text(ui, rect.with_min_x(rect.left() + 20.0), galley, color);
    response.widget_info(|| WidgetInfo::labeled(Role::Alert, true, &message.text));
    response.on_hover_text(&message.text);
}

/// Lists the parts of the line in order: the selection, the effect of the keys, the observer, the
/// cost of the picture.
fn parts(state: &State) -> Vec<String> {
    let (scene, view) = (&state.scene, &state.view);
    let mut parts =
        vec![selected(state), transformation(state).map_or_else(|why| why, verb).to_owned()];
    parts.extend(frame(state).map(str::to_owned));
    parts.extend(step(state));
    let projection = match view.projection {
        Projection::Perspective => "perspective",
        Projection::Orthographic => "orthographic",
    };
    let camera = &scene.selected_camera(view).name;
    parts.push(match view.object.and_then(|id| scene.objects.get(id)) {
        Some(object) if view.observer == Observer::Object => {
            format!("seen from {}, {projection}", middle_elided(&object.name, LONGEST_NAME))
        }
        _ => format!("{}, {projection}", middle_elided(camera, LONGEST_NAME)),
    });
    parts.extend(drawn(state));
    let on = scene.lights.iter().filter(|(_, light)| light.on).count();
    parts.push(counted(on, "light", "lights"));
    let statistics = &state.statistics;
    if statistics.reduction != Reduction::NONE {
        let lost = statistics.lost.map(|lost| format!(" (error {lost:.1} of 255)"));
        let lost = lost.unwrap_or_default();
        parts.push(format!("while moving: {}{lost}", statistics.reduction.words()));
    }
    // The time of the last picture would be misleading while a slow one is drawn.
    if let Some(late) = &statistics.late {
        parts.push(format!("drawing {}", late.in_words()));
        return parts;
    }
    parts.extend(refined(state));
    if statistics.pictures > 0 {
        let time = format!("{:.1} ms", statistics.time.as_secs_f64() * 1000.0);
        // Refining takes longer, and is not timed.
        let is_refined = statistics.refined.is_some_and(|now| now != state.settings.samples);
        // The dial has times of many pictures, and this one may have been the first.
        let is_told = is_refined && state.shows_dial() && state.dial.current;
        parts.extend((!is_told).then(|| match is_refined {
            false => time,
            true => format!("{} took {time}", samples(state.settings.samples)),
        }));
    }
    parts
}

/// Describes the progress of refinement.
fn refined(state: &State) -> Option<String> {
    let most = state.refined_to().filter(|_| state.statistics.pictures > 0)?;
    let now = state.statistics.refined.unwrap_or(state.settings.samples);
    Some(match now.count() < most.count() {
        true => format!("refining: {} of {}", now.count(), samples(most)),
        false => format!("refined: {}", samples(now)),
    })
}

fn samples(samples: Samples) -> String {
    counted(samples.count() as usize, "sample", "samples")
}

/// Describes unusual display modes: polygon by polygon, wireframe, isolated selection.
fn drawn(state: &State) -> Vec<String> {
    let (scene, view) = (&state.scene, &state.view);
    let mut parts = Vec::new();
    let object = view.object.and_then(|id| scene.objects.get(id));
    if let (Some(mode), Some(object)) = (&view.polygons, object) {
        let count = object.model.mesh.polygon_count();
        parts.push(format!("polygon {} of {count}", mode.current + 1));
    } else if view.only_selected {
        parts.push("isolated".to_owned());
    }
    if view.fill == Fill::Edges {
        parts.push("wireframe".to_owned());
    }
    parts
}

fn selected(state: &State) -> String {
    let kind = match state.view.subject {
        Subject::Object => "Object",
        Subject::Camera => "Camera",
        Subject::Light => "Light",
    };
    let item = state.selected().and_then(|item| Some((place(state, item)?, state.name(item)?)));
    match item {
        Some(((place, count), name)) => {
            format!("{kind} {}/{count} {}", place + 1, middle_elided(name, LONGEST_NAME))
        }
        None => format!("No {}", kind.to_lowercase()),
    }
}

/// Returns the effect of x, y and z on the selection, or why they have no effect.
fn transformation(state: &State) -> Result<Transformation, &'static str> {
    let (scene, view) = (&state.scene, &state.view);
    if state.selected().is_some_and(|id| scene.locked.contains(&id)) {
        return Err("locked");
    }
    let Some(ItemId::Light(id)) = state.selected() else { return Ok(view.transformation) };
    let Some(light) = scene.lights.get(id) else { return Err("from everywhere") };
    transform::transformation_of(light, view.transformation).map_err(|_refusal| {
        if light.kind.owner().is_some() { "follows its owner" } else { "from everywhere" }
    })
}

const fn verb(transformation: Transformation) -> &'static str {
    match transformation {
        Transformation::Translation => "move",
        Transformation::Rotation => "rotate",
        Transformation::Scaling => "scale",
    }
}

fn frame(state: &State) -> Option<&'static str> {
    let view = &state.view;
    match view.subject {
        Subject::Camera => {
            let camera = state.scene.selected_camera(view);
            Some(match camera.pose.now().mode_with(view.object) {
                CameraMode::Fly => "fly",
                CameraMode::Analysis { .. } => "analysis",
            })
        }
        Subject::Object => Some(match view.frame {
            Frame::Local => "local",
            Frame::Global => "global",
        }),
        Subject::Light => None,
    }
}

/// Describes the step size of x, y or z.
fn step(state: &State) -> Option<String> {
    let by = &state.view.steps;
    Some(match transformation(state).ok()? {
        Transformation::Translation => {
            let length = short(steps::length(&state.scene, &state.view));
            format!("step {length}{}", if by.by_size { " by size" } else { "" })
        }
        Transformation::Rotation => format!("step {} deg", short(by.rotation)),
        Transformation::Scaling => format!("step x {}", short(by.scaling)),
    })
}

/// Joins the parts. If they do not fit, dots replace parts in the middle.
fn fitted(parts: &[String], fits: impl Fn(&str) -> bool) -> String {
    // The first part and the last ones are the most important.
    for left_out in 0..parts.len().saturating_sub(1) {
        let first = (parts.len() - left_out).div_ceil(2);
        let mut kept = parts.to_vec();
        if left_out > 0 {
            kept.splice(first..first + left_out, ["...".to_owned()]);
        }
        let text = kept.join(BETWEEN);
        if fits(&text) {
            return text;
        }
    }
    parts.first().cloned().unwrap_or_default()
}

/// Elides the middle of `name` if it has more than `longest` letters. Line breaks become blanks.
pub(crate) fn middle_elided(name: &str, longest: usize) -> String {
    let shown = |letter: char| if letter.is_control() { ' ' } else { letter };
    let letters: Vec<char> = name.chars().map(shown).collect();
    if letters.len() <= longest {
        return letters.into_iter().collect();
    }
    let kept = longest.saturating_sub(3);
    let (head, tail) = (kept.div_ceil(2), kept / 2);
    let head: String = letters[..head].iter().collect();
    let tail: String = letters[letters.len() - tail..].iter().collect();
    format!("{head}...{tail}")
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;
    use crate::app::state::Late;

    #[test]
    fn a_long_name_keeps_its_beginning_and_its_end() {
        assert_eq!(middle_elided("teapot", 10), "teapot");
        assert_eq!(middle_elided("tea\npot", 10), "tea pot");
        assert_eq!(middle_elided("a_very_long_name_2", 10), "a_ve...e_2");
    }

    #[test]
    fn reductions_of_a_picture_are_shown_before_its_time() {
        let (scene, view) = marraztu_io::default_scene();
        let mut state = State::new(scene, view);
        state.statistics.pictures = 1;
        assert!(!parts(&state).join(BETWEEN).contains("moving"));
        state.statistics.reduction.vertex_light = true;
        state.statistics.reduction.shrink = crate::app::state::Shrink::Half;
        state.statistics.lost = Some(3.12);
        let said = "  |  while moving: light per vertex, half size (error 3.1 of 255)  |  0.0 ms";
        assert!(parts(&state).join(BETWEEN).ends_with(said));
    }

    #[test]
    fn while_a_picture_takes_long_no_figures_of_the_last_one_are_said() {
        let (scene, view) = marraztu_io::default_scene();
        let mut state = State::new(scene, view);
        state.statistics.pictures = 1;
        let said = |state: &State| parts(state).last().cloned().unwrap_or_default();
        assert!(said(&state).ends_with("ms"));
        let (spent, fraction) = (Duration::from_secs(2), Some(0.25));
        state.statistics.late = Some(Late { spent, fraction });
        assert_eq!(said(&state), "drawing 25%, about 6 s left");
        assert!(!parts(&state).iter().any(|part| part.starts_with("refin")));
    }

    #[test]
    fn the_hint_for_a_drag_depends_on_the_camera_mode() {
        let (scene, view) = marraztu_io::default_scene();
        let mut state = State::new(scene, view);
        assert_eq!(mouse_hints(&state)[0], "Drag: look around");
        let command = transform::toggle_analysis(&state.scene, &state.view);
        command.unwrap().apply(&mut state.scene).unwrap();
        assert_eq!(mouse_hints(&state)[0], "Drag: orbit");
        state.view.observer = Observer::Object;
        assert!(!mouse_hints(&state).iter().any(|hint| hint.contains("rag:")));
    }

    #[test]
    fn parts_that_do_not_fit_are_dropped_from_the_middle() {
        let parts: Vec<String> = ["first", "second", "third", "fourth"].map(String::from).into();
        let within = |room: usize| fitted(&parts, |text| text.len() <= room);
        assert_eq!(within(99), "first  |  second  |  third  |  fourth");
        assert_eq!(within(35), "first  |  second  |  ...  |  fourth");
        assert_eq!(within(24), "first  |  ...  |  fourth");
        assert_eq!(within(1), "first");
    }
}

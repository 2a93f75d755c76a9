//! The properties of the selected item.

mod camera;
mod crease;
mod light;
mod material;
mod object;
mod several;
mod surface;

use std::path::Path;

use egui::{ScrollArea, Sense, TextStyle, Ui, vec2};

use crate::app::actions::{MissingRequest, Request, Requests, change_view};
use crate::app::state::State;
use crate::app::theme;
use crate::app::widgets::controls::{self, Switch, row, section};
use crate::app::widgets::icons::Icon;
use crate::app::widgets::mixed::set_mixed;
use crate::app::widgets::number::Number;
use crate::app::widgets::text::file_name;
use marraztu_core::edit;
use marraztu_core::scene::{ItemId, Transformation, UpAxis};

/// Shows a button that makes the up axis of a model the default.
pub(super) fn up_by_default_ui(ui: &mut Ui, state: &State, up: UpAxis, requests: &mut Requests) {
    let hint = format!("Opens models with {} up, unless their files state an axis", up.word());
    let button = ui.add_enabled(up != state.up, egui::Button::new("Use for all from now on"));
    if button.on_hover_text(hint).clicked() {
        requests.push(Request::UpByDefault(up));
    }
}

pub(crate) fn show(ui: &mut Ui, state: &State, requests: &mut Requests) {
    let Some(item) = state.selected().filter(|item| state.scene.contains(*item)) else {
        ui.add_space(theme::GAP);
        ui.weak("Nothing is selected.");
        return;
    };
    title(ui, state, item);
    let others = several::note_ui(ui, state, item);
    // The ids of fields depend on the scene and the item. A number typed for one item never ends up
    // in another.
    let area = ScrollArea::vertical().id_salt("properties").auto_shrink(false);
    area.content_margin(theme::SCROLL_MARGIN).show(ui, |ui| {
        ui.push_id((state.generation, item), |ui| match item {
            ItemId::Object(id) => object::show(ui, state, &others, requests, id),
            ItemId::Camera(id) => camera::show(ui, state, &others, requests, id),
            ItemId::Light(id) => light::show(ui, state, &others, requests, id),
        });
    });
    set_mixed(ui.ctx(), Vec::new());
}

fn title(ui: &mut Ui, state: &State, item: ItemId) {
    let kind = match item {
        ItemId::Object(_) => "Object",
        ItemId::Camera(_) => "Camera",
        ItemId::Light(_) => "Light",
    };
    let width = ui.available_width() - f32::from(theme::MARGIN);
    let size = vec2(width, theme::ROW + 6.0);
    let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
    let color = ui.visuals().strong_text_color();
    let icon = rect.with_max_x(rect.left() + 18.0);
    Icon::of(&state.scene, item).paint(ui.painter(), icon, 15.0, color);
    let weak = ui.visuals().weak_text_color();
    let kind = controls::text(ui, kind, TextStyle::Small, 60.0);
    let right = rect.right() - kind.size().x;
    controls::put_text(ui, rect.with_min_x(right), kind, weak);
    let left = rect.with_min_x(icon.right() + 6.0).with_max_x(right - theme::GAP);
    let text =
        controls::text(ui, state.name(item).unwrap_or_default(), TextStyle::Heading, left.width());
    controls::put_text(ui, left, text, color);
    response.on_hover_text(state.name(item).unwrap_or_default());
}

/// Shows the step sizes of the keys x, y and z.
fn steps_ui(ui: &mut Ui, state: &State, requests: &mut Requests, scaling: bool) {
    // Sizes chosen by the program are shown unfolded.
    section(ui, "Step sizes", state.view.steps.by_size, |ui| {
        let steps = state.view.steps;
        let does = |to| match to {
            Transformation::Translation => ("Move", "Units per press of x, y or z"),
            Transformation::Rotation => ("Rotate", "Degrees per press of x, y or z"),
            Transformation::Scaling => ("Scale", "Factor per press of x, y or z"),
        };
        let mut field = |ui: &mut Ui, to: Transformation, value: f64| {
            let (label, hint) = does(to);
            let number = Number::new(format!("Step: {label}"), hint);
            let number = match to {
                Transformation::Translation => number.speed(0.1).range(1e-9..=1e9),
                Transformation::Rotation => number.speed(0.5).range(0.001..=180.0).suffix(" deg"),
                Transformation::Scaling => number.speed(0.01).range(1.000_001..=1000.0),
            };
            let changed = row(ui, label, |ui| {
                let width = ui.available_width();
                number.ui(ui, width, value)
            });
            if let Some((value, _)) = changed {
                change_view(requests, state, |view| match to {
                    Transformation::Translation => view.steps.translation = value,
                    Transformation::Rotation => view.steps.rotation = value,
                    Transformation::Scaling => view.steps.scaling = value,
                });
            }
        };
        ui.add_enabled_ui(!steps.by_size, |ui| {
            let length = edit::steps::length(&state.scene, &state.view);
            field(ui, Transformation::Translation, length);
        });
        field(ui, Transformation::Rotation, steps.rotation);
        if scaling {
            field(ui, Transformation::Scaling, steps.scaling);
        }
        let by_size = Switch::new("Move by size", steps.by_size).ui(ui);
        let hint = "Moves by a hundredth of the scene's extent per press, rounded to 1, 2 or 5";
        if by_size.on_hover_text(hint).clicked() {
            change_view(requests, state, |view| view.steps.by_size ^= true);
        }
    });
}

/// Shows a number in a separate row.
fn number_row(
    ui: &mut Ui,
    label: &str,
    number: Number<'_>,
    value: f64,
) -> Option<(f64, edit::Gesture)> {
    row(ui, label, |ui| {
        let width = ui.available_width();
        number.ui(ui, width, value)
    })
}

/// Lists the missing files of an item, each with a button to find it.
fn missing_ui<'a>(ui: &mut Ui, requests: &mut Requests, files: impl Iterator<Item = &'a Path>) {
    for file in files {
        ui.horizontal_wrapped(|ui| {
            let text = format!("{} is missing", file_name(file));
            let color = ui.visuals().warn_fg_color;
            ui.colored_label(color, text).on_hover_text(file.display().to_string());
            if ui.button("Find...").on_hover_text("Locates the missing file").clicked() {
                requests.push(Request::Missing(MissingRequest::Find(Some(file.to_owned()))));
            }
        });
    }
}

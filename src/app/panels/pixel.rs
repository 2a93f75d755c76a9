//! The explanation of a pixel: the item at the pixel, the terms of its colour, and the light
//! vectors.

use egui::{
    Align2, Color32, Context, Grid, Label, Painter, Pos2, Rect, RichText, Role, ScrollArea, Sense,
    Stroke, TextStyle, Ui, Vec2, WidgetInfo, Window, pos2, vec2,
};
use glam::DVec3;

use crate::app::actions::{Request, Requests};
use crate::app::state::{ExplainedPixel, State};
use crate::app::theme;
use crate::app::widgets::controls::{self, icon_button};
use crate::app::widgets::icons::Icon;
use marraztu_core::base::math;
use marraztu_lab::pixel;
use marraztu_render::{PixelColor, SurfacePoint, Term};

/// The height of the diagram.
const DIAGRAM: f32 = 120.0;

/// The length of a unit vector in the diagram.
const VECTOR: f32 = 72.0;

/// The height of the title, the buttons, and their margins.
const BUTTONS: f32 = 76.0;

/// The height of the axes of the world above the window.
const AXES: f32 = 90.0;

pub(crate) fn show(ctx: &Context, state: &State, picture: Rect, requests: &mut Requests) {
    let Some(pixel) = &state.explained else { return };
    let mut open = true;
    let [x, y] = pixel.at;
    // Away from the pixel, which stays visible.
    #[expect(clippy::cast_precision_loss, reason = "pictures have fewer than 2^24 pixels a side")]
    let is_right = x as f32 * 2.0 > pixel.shot.size.width as f32;
    let left = if is_right { picture.left() + 12.0 } else { picture.right() - 372.0 };
    let place = pos2(left, picture.top() + AXES).max(picture.min);
    let most = (picture.height() - AXES - 28.0).max(160.0);
    Window::new(format!("Pixel {x}, {y}"))
        .id(egui::Id::unique(("explained pixel", is_right)))
        .open(&mut open)
        .default_pos(place)
        .default_width(360.0)
        .max_height(most)
        .constrain_to(picture)
        .collapsible(false)
        .show(ctx, |ui| match &pixel.explained {
            Some(explained) => {
                // The buttons remain visible below the scrolled contents.
                ScrollArea::vertical().max_height(most - BUTTONS).show(ui, |ui| {
                    explained_ui(ui, state, pixel, explained);
                });
                ui.separator();
                buttons_ui(ui, state, pixel, explained, requests);
            }
            None => drop(ui.weak("Outside the picture.")),
        });
    if !open {
        requests.push(Request::EndExplaining);
    }
}

fn explained_ui(ui: &mut Ui, state: &State, pixel: &ExplainedPixel, explained: &PixelColor) {
    let mono = |text: String| RichText::new(text).monospace();
    // The colour comes first, since it is the answer.
    ui.scope(|ui| sum_ui(ui, pixel, explained));
    if explained.linear {
        ui.weak("Linear light: encoded in sRGB before it is rounded.");
    }
    if let Some(line) = pixel::drawn_line(explained) {
        ui.weak(line);
    }
    let samples = state.refined_to().unwrap_or(pixel.shot.settings.samples);
    if samples.count() > 1 {
        let count = samples.count();
        ui.weak(format!(
            "The picture has the mean of {count} samples; this is the light at the pixel's centre."
        ));
    }
    if let Some(point) = &explained.surface {
        ui.separator();
        diagram_ui(ui, pixel, point, explained);
        ui.separator();
        Grid::new("facts").num_columns(2).spacing(vec2(10.0, 2.0)).show(ui, |ui| {
            for [name, value] in pixel::facts(&pixel.shot.scene, point) {
                ui.weak(name);
                ui.add(Label::new(mono(value)).wrap());
                ui.end_row();
            }
        });
    }
}

fn buttons_ui(
    ui: &mut Ui,
    state: &State,
    pixel: &ExplainedPixel,
    explained: &PixelColor,
    requests: &mut Requests,
) {
    ui.horizontal(|ui| {
        if ui.button("Copy as text").clicked() {
            ui.ctx().copy_text(pixel::lines(&pixel.shot.scene, explained).join("\n"));
        }
        if ui.selectable_label(state.explaining, "Another pixel").clicked() {
            requests.push(Request::Do(crate::app::actions::Action::ExplainPixel));
        }
        for (icon, name, by) in [
            (Icon::LEFT, "The pixel to the left", [-1, 0]),
            (Icon::RIGHT, "The pixel to the right", [1, 0]),
            (Icon::UP, "The pixel above", [0, -1]),
            (Icon::DOWN, "The pixel below", [0, 1]),
        ] {
            let next = |at: usize, by: isize| at.checked_add_signed(by);
            let response = icon_button(ui, icon, name, true).on_hover_text(name);
            if let ([Some(x), Some(y)], true) =
                ([next(pixel.at[0], by[0]), next(pixel.at[1], by[1])], response.clicked())
            {
                requests.push(Request::Explain([x, y]));
            }
        }
    });
}

/// The width of a term's name.
const TERM: f32 = 140.0;

/// The width of each number of a term.
const NUMBER: f32 = 58.0;

/// Shows the terms, their sum, and the resulting byte.
fn sum_ui(ui: &mut Ui, pixel: &ExplainedPixel, explained: &PixelColor) {
    // A number that rounds to 0 has no sign.
    let number = |x: f64| format!("{:.3}", if x.abs() < 5e-4 { 0.0 } else { x });
    ui.spacing_mut().item_spacing.y = 1.0;
    let weak = ui.visuals().weak_text_color();
    let strong = ui.visuals().strong_text_color();
    let plain = ui.visuals().text_color();
    term_ui(ui, "in steps of a byte", ["red", "green", "blue"].map(str::to_owned), weak);
    for term in pixel::rows(&pixel.shot.scene, explained, 3) {
        let color = if term.value == [0.0; 3] { weak } else { plain };
        term_ui(ui, &term.label, term.value.map(number), color);
    }
    term_ui(ui, "sum", explained.color.map(|x| number(x * 255.0)), strong);
    term_ui(ui, "clamped and rounded", explained.bytes.map(|byte| byte.to_string()), strong);
    let [r, g, b] = explained.bytes;
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), 10.0), Sense::hover());
    ui.painter().rect_filled(rect, 2.0, Color32::from_rgb(r, g, b));
}

/// Shows a row of the sum: a name, and three numbers in columns.
fn term_ui(ui: &mut Ui, label: &str, values: [String; 3], color: Color32) {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = theme::GAP;
        let (rect, response) = ui.allocate_exact_size(vec2(TERM, theme::ROW - 4.0), Sense::hover());
        response.widget_info(|| WidgetInfo::labeled(Role::Label, true, label));
        let text = controls::text(ui, label, TextStyle::Body, TERM);
        let is_cut = text.elided;
        controls::put_text(ui, rect, text, color);
        if is_cut {
            response.on_hover_text(label);
        }
        for value in values {
            let size = vec2(NUMBER, theme::ROW - 4.0);
            let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
            response.widget_info(|| WidgetInfo::labeled(Role::Label, true, &value));
            controls::right_text(ui, rect, &value, TextStyle::Monospace, color);
        }
    });
}

/// Draws N and V, and L and R of the strongest light, seen from the side with N upwards.
fn diagram_ui(ui: &mut Ui, pixel: &ExplainedPixel, point: &SurfacePoint, explained: &PixelColor) {
    // Only the nearest surface counts, since N belongs to it.
    let lit = |term: &&Term| term.layer == 0 && term.ray.is_some_and(|ray| ray.n_l > 0.0);
    let bright = |term: &&Term| term.value.iter().sum::<f64>();
    let strongest =
        explained.terms.iter().filter(lit).max_by(|a, b| bright(a).total_cmp(&bright(b)));
    let (rect, response) =
        ui.allocate_exact_size(vec2(ui.available_width(), DIAGRAM), Sense::hover());
    let painter = ui.painter().with_clip_rect(rect);
    let middle = pos2(rect.center().x, rect.bottom() - 22.0);
    let ink = ui.visuals().text_color();
    let weak = ui.visuals().weak_text_color();
    painter.hline(rect.shrink(12.0).x_range(), middle.y, Stroke::new(2.0, weak));
    let ray = strongest.and_then(|term| Some((term.light?, term.ray?)));
    // The plane of N and L, or of N and V if there is no light.
    let aside = ray.map_or(point.to_eye, |(_, ray)| ray.to_light);
    let across = math::unit(aside - point.normal * point.normal.dot(aside))
        .unwrap_or_else(|| point.normal.any_orthonormal_vector());
    let on = |v: DVec3| flat(v, point.normal, across);
    let accent = theme::accent(ui.visuals());
    let mut arrows = vec![("N", point.normal, ink), ("V", point.to_eye, accent)];
    if let Some((_, ray)) = ray {
        arrows.push(("L", ray.to_light, Color32::from_rgb(214, 150, 20)));
        arrows.push(("R", ray.reflected, Color32::from_rgb(200, 80, 160)));
    }
    let font = TextStyle::Body.resolve(ui.style());
    for (name, v, color) in arrows {
        let way = on(v) * VECTOR;
        arrow(&painter, middle, way, color);
        let at = middle + way + way.normalized() * 9.0;
        painter.text(at, Align2::CENTER_CENTER, name, font.clone(), color);
    }
    let words = ray.map_or_else(
        || "No light reaches the front of the surface here.".to_owned(),
        |(id, ray)| {
            let name = pixel::light_name(&pixel.shot.scene, id);
            format!("L and R of {name}: {}", pixel::ray_line(&ray))
        },
    );
    response.on_hover_text(&words);
    ui.add(Label::new(RichText::new(words).small()).wrap());
}

/// Projects a vector into the plane of the diagram, with the light at the left.
#[expect(clippy::cast_possible_truncation, reason = "a drawing for the eye")]
fn flat(v: DVec3, normal: DVec3, across: DVec3) -> Vec2 {
    vec2(-v.dot(across) as f32, -v.dot(normal) as f32)
}

fn arrow(painter: &Painter, from: Pos2, way: Vec2, color: Color32) {
    let stroke = Stroke::new(2.0, color);
    painter.line_segment([from, from + way], stroke);
    let along = way.normalized();
    for side in [along.rot90(), -along.rot90()] {
        let end = from + way;
        painter.line_segment([end, end - along * 8.0 + side * 4.0], stroke);
    }
}

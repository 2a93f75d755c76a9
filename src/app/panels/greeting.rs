//! The greeting: first steps, over the lower edge of the first picture. It disappears with the
//! first change and never takes keyboard focus.

use egui::{
    Align2, Area, Color32, ColorImage, FontId, Frame, Id, Order, Rect, Role, Sense, Stroke,
    StrokeKind, TextureHandle, TextureOptions, Ui, Vec2, WidgetInfo, pos2, vec2,
};

use super::status_line::middle_elided;
use crate::app::actions::{Action, LabRequest, Request, Requests};
use crate::app::state::State;
use crate::app::theme;
use crate::app::widgets::regions;
use crate::app::widgets::text::file_name;
use marraztu_core::accuracy::Axis;
use marraztu_io::{EXAMPLES, Example, lesson_on};

/// The lessons to offer, by their axes, with their topics.
const LESSONS: [(&str, &str); 3] =
    [("samples", "Jagged edges"), ("shading", "Flat or smooth"), ("depth", "Z-fighting")];

/// The maximum number of recent files to offer.
const RECENT: usize = 3;

/// The greeting is hidden over a picture with a shorter side, or with a smaller area. On a phone,
/// the picture is narrow but high.
const LEAST_SIDE: f32 = 260.0;
const LEAST_AREA: f32 = 420.0 * 260.0;

/// Over a smaller picture, examples are shown by name only.
const LEAST_FOR_THUMBNAILS: Vec2 = vec2(640.0, 500.0);

/// The size of a thumbnail in points: half of its pixels.
const THUMBNAIL: Vec2 = vec2(144.0, 90.0);

/// Returns whether the greeting is shown over this picture.
pub(crate) fn is_shown(state: &State, picture: Rect) -> bool {
    let is_small = picture.size().min_elem() < LEAST_SIDE || picture.area() < LEAST_AREA;
    state.greeting && !state.lab.away && state.overlays && !is_small
}

pub(crate) fn show(ui: &Ui, picture: Rect, state: &State, requests: &mut Requests) {
    if !is_shown(state, picture) {
        return;
    }
    let area = Area::new(Id::unique("greeting")).order(Order::Middle).constrain_to(picture);
    let at = picture.center_bottom() - vec2(0.0, 10.0);
    let width = (picture.width() - 40.0).min(760.0);
    area.pivot(Align2::CENTER_BOTTOM).fixed_pos(at).show(ui.ctx(), |ui| {
        Frame::popup(ui.style()).show(ui, |ui| {
            regions::begin(ui, "greeting");
            ui.set_max_width(width);
            let is_roomy = picture.width() >= LEAST_FOR_THUMBNAILS.x
                && picture.height() >= LEAST_FOR_THUMBNAILS.y;
            contents(ui, is_roomy, state, requests);
        });
    });
}

/// Shows one row each for files to open, examples, and lessons.
fn contents(ui: &mut Ui, is_roomy: bool, state: &State, requests: &mut Requests) {
    ui.horizontal_wrapped(|ui| {
        ui.weak("Drop a model here, or");
        let hint = "Shows a model alone, framed and lit";
        if ui.button("Open model...").on_hover_text(hint).clicked() {
            requests.push(Request::AskModels);
        }
        requests.extend(Action::Open.button(ui, state).map(Request::from));
        for path in state.recent.iter().take(RECENT) {
            let name = middle_elided(&file_name(path), 24);
            let button = ui.button(name);
            if button.on_hover_text(path.display().to_string()).clicked() {
                requests.push(Request::OpenFiles(vec![path.clone()]));
            }
        }
    });
    ui.horizontal_wrapped(|ui| {
        ui.weak("Or open an example:");
        for example in EXAMPLES {
            let hint = "Opens it in place of this scene";
            let thumbnail = thumbnail(ui, example).filter(|_| is_roomy);
            let button = match thumbnail {
                Some(picture) => thumbnail_button(ui, &picture, example.title),
                None => ui.button(example.title),
            };
            if button.on_hover_text(hint).clicked() {
                requests.push(Request::LoadFiles(vec![example.path.into()]));
            }
        }
    });
    ui.horizontal_wrapped(|ui| {
        ui.weak("Or try a lesson:");
        for (key, about) in LESSONS {
            let hint = Axis::named(key).map_or("", |axis| lesson_on(axis).title.as_str());
            if ui.button(about).on_hover_text(hint).clicked() {
                requests.push(Request::Lab(LabRequest::ShowLesson(key)));
            }
        }
        ui.add_space(3.0 * theme::GAP);
        if ui.button("Dismiss").on_hover_text("Closes this strip").clicked() {
            requests.push(Request::EndGreeting);
        }
    });
}

/// Returns the thumbnail of an example, decoded on first use.
fn thumbnail(ui: &Ui, example: &Example) -> Option<TextureHandle> {
    let id = Id::unique(("thumbnail", example.path));
    let known = ui.data(|data| data.get_temp::<TextureHandle>(id));
    known.or_else(|| {
        let picture = example.thumbnail()?;
        let size = [picture.size().width, picture.size().height];
        let image = ColorImage::from_rgba_unmultiplied(size, picture.pixels().as_flattened());
        let texture = ui.ctx().load_texture(example.path, image, TextureOptions::LINEAR);
        ui.data_mut(|data| data.insert_temp(id, texture.clone()));
        Some(texture)
    })
}

/// A button that is a picture with its title on the lower edge.
fn thumbnail_button(ui: &mut Ui, picture: &TextureHandle, title: &str) -> egui::Response {
    let (rect, response) = ui.allocate_exact_size(THUMBNAIL, Sense::click());
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, title));
    let painter = ui.painter();
    let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
    painter.image(picture.id(), rect, whole, Color32::WHITE);
    let strip = Rect::from_min_max(pos2(rect.left(), rect.bottom() - 20.0), rect.max);
    painter.rect_filled(strip, 0.0, Color32::from_black_alpha(170));
    let font = FontId::proportional(13.0);
    painter.text(strip.center(), Align2::CENTER_CENTER, title, font, Color32::WHITE);
    let is_marked = response.hovered() || response.has_focus();
    let color = if is_marked { ui.visuals().selection.bg_fill } else { Color32::TRANSPARENT };
    painter.rect_stroke(rect, 2.0, Stroke::new(2.0, color), StrokeKind::Outside);
    response
}

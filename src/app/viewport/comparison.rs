//! Compares the picture with the exact one: a split viewport, or the amplified error.
//!
//! One background thread draws both pictures whenever the scene has changed, so they always show
//! the same moment. Until they are finished, the exact half is dimmed and labelled.

use std::sync::Arc;

use egui::{Align2, ColorImage, Context, CursorIcon, Id, Pos2, Rect, Sense, Stroke, TextureHandle};
use egui::{TextureOptions, Ui, pos2, vec2};

use crate::app::actions::{LabRequest, Request, Requests};
use crate::app::state::State;
use crate::app::state::laboratory::{Compare, in_words};
use crate::app::tasks::Task;
use crate::app::theme;
use crate::app::widgets::plate::plate_ui;
use marraztu_core::accuracy::Shot;
use marraztu_core::base::image::{Picture, Size};
use marraztu_io::Progress;
use marraztu_lab::error::{Error, amplified};
use marraztu_lab::picture_source::{PictureSource as _, Reference, Studio};

/// All inputs of the two pictures.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Compared {
    pub(crate) shot: Shot,
    pub(crate) against: Reference,
}

/// The picture and the exact one, with the error between them.
pub(crate) struct Pair {
    pub(crate) of: Compared,
    pub(crate) exact: Picture,
    pub(crate) ours: Picture,
    pub(crate) error: Error,
}

/// A pair that is being drawn.
pub(crate) struct Drawing {
    pub(crate) of: Compared,
    pub(crate) task: Task<Option<Box<Pair>>>,
}

/// Draws both pictures; `None` if `progress` is cancelled.
pub(crate) fn draw(of: Compared, progress: &Progress) -> Option<Pair> {
    let mut studio = Studio::watched(of.shot.clone(), progress.clone());
    let exact = studio.rendering(&of.against.of(&of.shot.settings));
    if progress.is_cancelled() {
        return None;
    }
    let ours = studio.rendering(&of.shot.settings);
    if progress.is_cancelled() {
        return None;
    }
    let error = ours.error(&exact);
    Some(Pair { of, exact: exact.picture().clone(), ours: ours.picture().clone(), error })
}

/// The compared pictures, and the task that draws new ones.
#[derive(Default)]
pub(crate) struct Comparison {
    /// The pair in progress, if any.
    pub(crate) drawing: Option<Drawing>,
    pub(crate) drawn: Option<Box<Pair>>,
    /// The request of the last frame.
    pub(crate) wanted: Option<Compared>,
    /// Whether the finished pair belongs to the picture in the window.
    pub(crate) current: bool,
    exact: Option<TextureHandle>,
    /// The amplified error, with its factor.
    error: Option<(u16, TextureHandle)>,
}

impl std::fmt::Debug for Comparison {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Comparison")
            .field("drawing", &self.drawing.is_some())
            .finish_non_exhaustive()
    }
}

impl Comparison {
    /// Discards the pictures of a scene that is no longer shown.
    pub(crate) fn forget(&mut self) {
        if let Some(drawing) = &self.drawing {
            drawing.task.progress.cancel();
        }
        (self.drawn, self.exact, self.error, self.current) = (None, None, None, false);
    }

    pub(crate) fn take(&mut self, ctx: &Context, drawn: Box<Pair>) {
        load(ctx, &mut self.exact, "exact", &drawn.exact);
        self.error = None;
        self.drawn = Some(drawn);
    }

    /// Shows the comparison over the picture in `rect`.
    pub(crate) fn ui(&mut self, ui: &Ui, rect: Rect, state: &State, requests: &mut Requests) {
        match state.lab.compare {
            Compare::Off => {}
            Compare::Split(part) => self.split_ui(ui, rect, (part, state), requests),
            Compare::Error(factor) => self.error_ui(ui, rect, factor),
        }
    }

    fn split_ui(&self, ui: &Ui, rect: Rect, (part, state): (f32, &State), requests: &mut Requests) {
        let scale = ui.ctx().pixels_per_point();
        // The split is aligned to whole pixels, so it cuts through none.
        let x = ((rect.left() + part * rect.width()) * scale).round() / scale;
        let left = rect.with_max_x(x);
        if let Some(exact) = &self.exact {
            let painter = ui.painter().with_clip_rect(left);
            painter.image(exact.id(), rect, whole(), egui::Color32::WHITE);
        }
        if !self.current {
            dim(ui, left);
        }
        let (dark, light) = (egui::Color32::from_black_alpha(160), egui::Color32::WHITE);
        ui.painter().vline(x, rect.y_range(), Stroke::new(3.0, dark));
        ui.painter().vline(x, rect.y_range(), Stroke::new(1.0, light));
        // The handle is at the lower end, where it covers little of the picture.
        let low = pos2(x, rect.bottom() - HANDLE.y);
        let handle = Rect::from_center_size(low, HANDLE);
        let response = ui.interact(grip_at(rect, part), Id::unique("split"), Sense::drag());
        let response = response.on_hover_cursor(CursorIcon::ResizeHorizontal);
        response.widget_info(|| {
            let name = "Split between the reference and the picture";
            egui::WidgetInfo::slider(true, f64::from(part), name)
        });
        ui.painter().rect_filled(handle, 4.0, theme::accent(ui.visuals()));
        if let Some(at) = response.interact_pointer_pos().filter(|_| response.dragged()) {
            let part = ((at.x - rect.left()) / rect.width()).clamp(0.02, 0.98);
            requests.push(Request::Lab(LabRequest::Compare(Compare::Split(part))));
        }
        let name = state.lab.reference.name(&state.settings);
        let name = if self.current { name } else { format!("{name}: drawing") };
        plate_ui(ui, left.with_max_x(x - 4.0), Align2::RIGHT_TOP, name);
        let samples = self.drawn.as_ref().map(|pair| pair.of.shot.settings.samples_in_words());
        let drawn = samples.map_or_else(|| "drawn".to_owned(), |it| format!("drawn, {it}"));
        plate_ui(ui, rect.with_min_x(x + 4.0), Align2::LEFT_TOP, drawn);
    }

    fn error_ui(&mut self, ui: &Ui, rect: Rect, factor: u16) {
        let Some(drawn) = &self.drawn else {
            dim(ui, rect);
            return plate_ui(ui, rect, Align2::LEFT_TOP, format!("Error x {factor}: drawing"));
        };
        // The amplified picture is computed once per pair and factor.
        if self.error.as_ref().is_none_or(|(last, _)| *last != factor) {
            let mut texture = self.error.take().map(|(_, texture)| texture);
            let picture = amplified(&drawn.ours, &drawn.exact, factor);
            load(ui.ctx(), &mut texture, "error", &picture);
            self.error = texture.map(|texture| (factor, texture));
        }
        let Some((_, texture)) = &self.error else { return };
        ui.painter().image(texture.id(), rect, whole(), egui::Color32::WHITE);
        let said = if self.current { in_words(&drawn.error) } else { "drawing".to_owned() };
        if !self.current {
            dim(ui, rect);
        }
        plate_ui(ui, rect, Align2::LEFT_TOP, format!("Error x {factor}: {said}"));
    }
}

/// Dims a picture that is out of date.
fn dim(ui: &Ui, rect: Rect) {
    ui.painter().rect_filled(rect, 0.0, egui::Color32::from_black_alpha(120));
}

/// The size of the slider's handle.
const HANDLE: egui::Vec2 = vec2(12.0, 34.0);

/// Returns the area for grabbing the slider; a press there does not reach the picture.
pub(crate) fn grip(state: &State, rect: Rect) -> Option<Rect> {
    match state.lab.compare {
        Compare::Split(part) => Some(grip_at(rect, part)),
        Compare::Off | Compare::Error(_) => None,
    }
}

fn grip_at(rect: Rect, part: f32) -> Rect {
    let x = rect.left() + part * rect.width();
    Rect::from_center_size(pos2(x, rect.center().y), vec2(14.0, rect.height()))
}

fn whole() -> Rect {
    Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0))
}

/// Copies a picture into a texture without filtering.
fn load(ctx: &Context, texture: &mut Option<TextureHandle>, name: &str, picture: &Picture) {
    let Size { width, height } = picture.size();
    let bytes = picture.pixels().as_flattened();
    let image = Arc::new(ColorImage::from_rgba_unmultiplied([width, height], bytes));
    match texture {
        Some(texture) => texture.set(image, TextureOptions::NEAREST),
        None => *texture = Some(ctx.load_texture(name, image, TextureOptions::NEAREST)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use marraztu_core::accuracy::{AXES, Settings};

    #[test]
    fn a_comparison_that_is_cancelled_gives_no_pictures() {
        let (scene, view) = marraztu_io::default_scene();
        let shot = Shot::new(&scene, &view, &Settings::default(), Size::new(64, 48));
        let shading = Reference::Alone(&AXES[0]);
        for against in [Reference::Ideal, shading] {
            let of = Compared { shot: shot.clone(), against };
            let progress = Progress::new();
            assert!(draw(of.clone(), &progress).is_some());
            progress.cancel();
            assert!(draw(of, &progress).is_none());
        }
    }
}

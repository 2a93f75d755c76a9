//! The picture beside the exact one: a slider that splits the viewport, or the error, amplified.
//!
//! Both pictures are drawn on a thread of its own whenever what is shown has changed, so that the two
//! always show the same moment.

use std::sync::Arc;

use egui::{Align2, ColorImage, Context, CursorIcon, Id, Pos2, Rect, Sense, Stroke, TextureHandle};
use egui::{TextureOptions, Ui, pos2, vec2};

use super::ask::Ask;
use super::editor::App;
use super::laboratory::LabAsk;
use super::overlay::plate_ui;
use super::state::State;
use super::tasks::{Outcome, Task};
use super::theme;
use crate::base::image::{Picture, Size};
use crate::io;
use crate::lab::error::{Error, amplified};
use crate::lab::picture_source::{PictureSource as _, Studio};
use crate::lab::report::brief;
use crate::scene::{Scene, Settings, View};

/// How the picture is compared with the exact one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Compare {
    /// Not at all.
    #[default]
    Off,
    /// The exact picture at the left of this part of the width.
    Split(f32),
    /// The error in place of the picture, so many times as large.
    Error(u16),
}

/// How far a picture is from the exact one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Judged {
    /// The error.
    pub error: Error,
    /// Of the picture that these settings draw.
    pub settings: Settings,
}

/// Everything that the two pictures depend on.
#[derive(Clone, Debug, PartialEq)]
struct Wanted {
    scene: Scene,
    view: View,
    settings: Settings,
    size: Size,
}

struct Drawn {
    of: Wanted,
    exact: Picture,
    ours: Picture,
    error: Error,
}

/// The pictures, and the thread that draws them.
#[derive(Default)]
pub(super) struct Comparison {
    task: Option<Task<Box<Drawn>>>,
    drawn: Option<Box<Drawn>>,
    exact: Option<TextureHandle>,
    /// The error, and how many times as large it is.
    error: Option<(u16, TextureHandle)>,
}

impl std::fmt::Debug for Comparison {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Comparison").field("drawing", &self.task.is_some()).finish_non_exhaustive()
    }
}

impl App {
    /// Begins to draw the two pictures where they are wanted and others were drawn last, and takes those
    /// that are finished.
    pub(super) fn compare(&mut self, ctx: &Context) {
        let comparison = &mut self.comparison;
        if let Some(task) = &comparison.task {
            match task.outcome() {
                Outcome::Running => return,
                Outcome::Done(drawn) => {
                    let settings = drawn.of.settings;
                    let judged = Judged { error: drawn.error, settings };
                    let is_now = drawn.of.scene == self.state.scene;
                    self.state.lab.judged = is_now.then_some(judged);
                    comparison.take(ctx, drawn);
                }
                Outcome::Lost => self.state.lab.compare = Compare::Off,
            }
            comparison.task = None;
            ctx.request_repaint();
        }
        let (Some(size), true) = (self.viewport.size(), self.state.lab.compare != Compare::Off)
        else {
            return;
        };
        let State { scene, view, settings, .. } = &self.state;
        let same = |drawn: &Drawn| {
            let Wanted { scene: s, view: v, settings: t, size: z } = &drawn.of;
            s == scene && v == view && t == settings && *z == size
        };
        if self.comparison.drawn.as_deref().is_some_and(same) {
            return;
        }
        let (scene, view) = (scene.clone(), view.clone());
        let of = Wanted { scene, view, settings: *settings, size };
        let work = move |_: &io::Progress| Box::new(draw(of));
        // Without a thread the picture is simply not compared.
        self.comparison.task = Task::start(ctx, "Comparing".to_owned(), work).ok();
    }
}

fn draw(of: Wanted) -> Drawn {
    let mut studio = Studio::new(of.scene.clone(), of.view.clone(), of.size);
    let exact = studio.rendering(&of.settings.reference());
    let ours = studio.rendering(&of.settings);
    let error = ours.error(&exact);
    Drawn { of, exact: exact.picture().clone(), ours: ours.picture().clone(), error }
}

impl Comparison {
    fn take(&mut self, ctx: &Context, drawn: Box<Drawn>) {
        load(ctx, &mut self.exact, "exact", &drawn.exact);
        self.error = None;
        self.drawn = Some(drawn);
    }

    /// Shows what is to be compared over the picture in `rect`.
    pub(super) fn ui(&mut self, ui: &Ui, rect: Rect, state: &State, asks: &mut Vec<Ask>) {
        match state.lab.compare {
            Compare::Off => {}
            Compare::Split(part) => self.split_ui(ui, rect, part, asks),
            Compare::Error(factor) => self.error_ui(ui, rect, factor),
        }
    }

    fn split_ui(&self, ui: &Ui, rect: Rect, part: f32, asks: &mut Vec<Ask>) {
        let Some(exact) = &self.exact else { return };
        let scale = ui.ctx().pixels_per_point();
        let x = ((rect.left() + part * rect.width()) * scale).round() / scale;
        let left = rect.with_max_x(x);
        ui.painter().with_clip_rect(left).image(exact.id(), rect, whole(), egui::Color32::WHITE);
        let (dark, light) = (egui::Color32::from_black_alpha(160), egui::Color32::WHITE);
        ui.painter().vline(x, rect.y_range(), Stroke::new(3.0, dark));
        ui.painter().vline(x, rect.y_range(), Stroke::new(1.0, light));
        // At the lower end, where it covers nothing that is looked at.
        let low = pos2(x, rect.bottom() - HANDLE.y);
        let handle = Rect::from_center_size(low, HANDLE);
        let response = ui.interact(grip_at(rect, part), Id::unique("split"), Sense::drag());
        let response = response.on_hover_cursor(CursorIcon::ResizeHorizontal);
        response.widget_info(|| {
            egui::WidgetInfo::slider(true, f64::from(part), "Split between exact and drawn")
        });
        ui.painter().rect_filled(handle, 4.0, theme::accent(ui.visuals()));
        if let Some(at) = response.interact_pointer_pos().filter(|_| response.dragged()) {
            let part = ((at.x - rect.left()) / rect.width()).clamp(0.02, 0.98);
            asks.push(Ask::Lab(LabAsk::Compare(Compare::Split(part))));
        }
        plate_ui(ui, left.with_max_x(x - 4.0), Align2::RIGHT_TOP, "exact".to_owned());
        plate_ui(ui, rect.with_min_x(x + 4.0), Align2::LEFT_TOP, "drawn".to_owned());
    }

    fn error_ui(&mut self, ui: &Ui, rect: Rect, factor: u16) {
        let Some(drawn) = &self.drawn else { return };
        if self.error.as_ref().is_none_or(|(last, _)| *last != factor) {
            let mut texture = self.error.take().map(|(_, texture)| texture);
            let picture = amplified(&drawn.ours, &drawn.exact, factor);
            load(ui.ctx(), &mut texture, "error", &picture);
            self.error = texture.map(|texture| (factor, texture));
        }
        let Some((_, texture)) = &self.error else { return };
        ui.painter().image(texture.id(), rect, whole(), egui::Color32::WHITE);
        let text = format!("Error x {factor}: {}", in_words(&drawn.error));
        plate_ui(ui, rect, Align2::LEFT_TOP, text);
    }
}

/// The size of what the slider shows to be held by.
const HANDLE: egui::Vec2 = vec2(12.0, 34.0);

/// Where the slider between the two pictures is held; a press there is none on the picture.
pub(super) fn grip(state: &State, rect: Rect) -> Option<Rect> {
    match state.lab.compare {
        Compare::Split(part) => Some(grip_at(rect, part)),
        Compare::Off | Compare::Error(_) => None,
    }
}

fn grip_at(rect: Rect, part: f32) -> Rect {
    let x = rect.left() + part * rect.width();
    Rect::from_center_size(pos2(x, rect.center().y), vec2(14.0, rect.height()))
}

/// An error in words: "largest 3 steps, RMSE 0.02, 1.2 % of the bytes differ".
pub(super) fn in_words(error: &Error) -> String {
    if error.largest == 0 && error.coverage == 0 {
        return "none, every byte is exact".to_owned();
    }
    let steps = if error.largest == 1 { "step" } else { "steps" };
    let mut text = format!(
        "largest {} {steps}, RMSE {}, {} % of the bytes differ",
        error.largest,
        brief(error.rmse),
        brief(error.differing * 100.0)
    );
    if error.coverage > 0 {
        text += &format!(", {} pixels show another triangle", error.coverage);
    }
    text
}

fn whole() -> Rect {
    Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0))
}

/// Puts a picture into a texture, unfiltered.
fn load(ctx: &Context, texture: &mut Option<TextureHandle>, name: &str, picture: &Picture) {
    let Size { width, height } = picture.size();
    let bytes = picture.pixels().as_flattened();
    let image = Arc::new(ColorImage::from_rgba_unmultiplied([width, height], bytes));
    match texture {
        Some(texture) => texture.set(image, TextureOptions::NEAREST),
        None => *texture = Some(ctx.load_texture(name, image, TextureOptions::NEAREST)),
    }
}

//! The viewport: the picture, with mouse and keyboard input over it.
//!
//! The picture is aligned to the pixels of the screen and shown unfiltered: one pixel of the
//! renderer is one pixel of the screen.

mod axes;
mod clicks;
pub(crate) mod comparison;
pub(crate) mod gizmo;
mod helpers;
mod loupe;
mod marks;
mod menu;
mod mouse;
mod over;
mod picking;

use std::sync::Arc;

use egui::{
    ColorImage, Context, Id, Pos2, Rect, Response, Sense, TextureHandle, TextureOptions, Ui, pos2,
    vec2,
};
use glam::DMat4;

use crate::app::actions::{Action, LabRequest, Request, Requests};
use crate::app::drawing::border::Border;
use crate::app::drawing::worker::{News, Pick, Worker};
use crate::app::input::keyboard::{Keyboard, Letters};
use crate::app::state::State;
use crate::app::widgets::plate::plate_ui;
use gizmo::{Gizmo, Grab};
use loupe::Loupe;
use marks::Projection;
use marraztu_core::base::image::Size;
use marraztu_core::scene::ItemId;
use marraztu_render::Hit;
use mouse::{Mouse, Under};
use over::Over;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Purpose {
    /// Finds the item under the pointer.
    Hover,
    /// Selects the item that was clicked.
    Select,
    /// Adds the item that was clicked to the selection, or removes it.
    SelectAlso,
    /// Selects the items in this part of the window.
    Box(Rect),
    /// Frames the item that was double-clicked.
    Frame,
    /// Opens the menu of the item that was right-clicked.
    Menu(Pos2),
    /// Aims the selected light at this point of the window.
    Aim(Pos2),
}

/// The longest time, in seconds, that keys wait for a click to select something.
const PATIENCE: f64 = 2.0;

/// The picture, and the state of input over it.
#[derive(Default)]
pub(crate) struct Viewport {
    texture: Option<TextureHandle>,
    image: Option<Arc<ColorImage>>,
    /// The place in the window, and the size in pixels.
    place: Option<(Rect, Size)>,
    mouse: Mouse,
    /// The pixel under the pointer, and the hit there if known.
    hovered: Option<([usize; 2], Option<Hit>)>,
    menu: Option<Menu>,
    /// The border of the item under the pointer.
    border: Option<Border>,
    /// The borders of the item that the keys act on, and of the other selected items.
    outline: [Option<Border>; 2],
    /// Whether the picture has changed since the last pick under the pointer.
    stale: bool,
    /// The item of the last border requested.
    asked: Option<ItemId>,
    loupe: Loupe,
    /// The pixel and the observer of the last click. A second click there selects the item behind.
    clicked: Option<([usize; 2], DMat4)>,
    /// The number of picks of clicks that are not answered.
    clicks: usize,
    /// The time of the last of them, in seconds.
    clicked_at: f64,
}

#[derive(Clone, Copy, Debug)]
struct Menu {
    at: Pos2,
    item: Option<ItemId>,
}

impl std::fmt::Debug for Viewport {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Viewport").field("place", &self.place).finish_non_exhaustive()
    }
}

impl Viewport {
    /// Returns the size of the picture in pixels; `None` before the first frame.
    pub(crate) fn size(&self) -> Option<Size> {
        self.place.map(|(_, size)| size)
    }

    /// Returns its place in the window; `None` before the first frame.
    pub(crate) fn rect(&self) -> Option<Rect> {
        self.place.map(|(rect, _)| rect)
    }

    pub(crate) fn image(&self) -> Option<&Arc<ColorImage>> {
        self.image.as_ref()
    }

    /// Begins to take an amount from the keyboard. Returns whether the selection has handles.
    pub(crate) fn type_amount(&mut self, state: &State) -> bool {
        let grab = self.place.and_then(|(rect, size)| Grab::typing(state, rect, size));
        let found = grab.is_some();
        grab.into_iter().for_each(|grab| self.mouse.type_amount(grab));
        found
    }

    /// Returns the seconds for which keys still wait for the worker to look up a click, if any. A
    /// very slow picture must not keep the user from saving.
    pub(crate) fn click_wait(&self, now: f64) -> Option<f64> {
        let rest = self.clicked_at + PATIENCE - now;
        (self.clicks > 0 && rest > 0.0).then_some(rest)
    }

    /// Gives the keyboard focus to the picture.
    pub(crate) fn take_keyboard(&self, ctx: &Context) {
        ctx.memory_mut(|memory| memory.request_focus(Id::unique("viewport")));
    }

    /// Cancels the current drag. Returns whether there was one.
    pub(crate) fn cancel_drag(&mut self, requests: &mut Requests) -> bool {
        self.mouse.cancel(requests)
    }

    /// Handles the results of the worker and adds the resulting requests.
    pub(crate) fn hear(
        &mut self,
        ctx: &Context,
        state: &State,
        news: News<Purpose>,
        requests: &mut Requests,
    ) {
        // A new picture comes with its border, if it has one.
        if news.drawn.is_some() || news.border.is_some() {
            self.border = news.border;
        }
        for (pick, hit) in news.picked {
            if pick.purpose != Purpose::Hover {
                self.clicks = self.clicks.saturating_sub(1);
            }
            self.answer(ctx, state, pick, hit, requests);
        }
        if news.failed {
            // Picks may have been lost.
            self.clicks = 0;
        }
        if let Some(outline) = news.outline {
            self.outline = outline;
        }
        if let Some((window, picture)) = news.ideal {
            self.loupe.take(window, picture);
        }
        if let Some(drawn) = news.drawn {
            self.loupe.forget();
            self.take(ctx, drawn.image);
            // A new picture may show another item under the pointer; until the pick, the old hit is
            // used.
            self.stale = true;
        }
        if let Some(refined) = news.refined {
            self.take(ctx, refined.image);
        }
    }

    pub(crate) fn ui(
        &mut self,
        ui: &Ui,
        state: &State,
        worker: &Worker<Purpose>,
        requests: &mut Requests,
    ) {
        let (rect, size) = whole_pixels(ui);
        self.place = Some((rect, size));
        let id = Id::unique("viewport");
        let response = ui.interact(rect, id, Sense::click_and_drag());
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Canvas, true, "Viewport"));
        keep_focus(ui.ctx(), &response);
        if let Some(texture) = &self.texture {
            let all = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
            ui.painter().image(texture.id(), rect, all, egui::Color32::WHITE);
        }
        // The mouse comes first: its state decides whether letters steer, type or act.
        let hit = self.hovered.and_then(|(_, hit)| hit);
        let gizmo = Gizmo::new(state, rect, size);
        let typed = Keyboard::take_typed(ui.ctx());
        let ends = if state.picture_only { Vec::new() } else { axes::ends(state, rect) };
        let under = Under { rect, size, hit, gizmo: gizmo.as_ref(), axes: &ends, typed: &typed };
        let picks = self.mouse.ui(ui, &response, state, under, requests);
        let letters = match (self.mouse.is_flying(), self.mouse.is_typing()) {
            (true, _) => Letters::Steer,
            (false, true) => Letters::Type,
            (false, false) => Letters::Act,
        };
        Keyboard::set_viewport(ui.ctx(), id, letters);
        if state.picture_only {
            // A double click frames everything; nothing is selected.
            let frames = picks.into_iter().filter(|(_, purpose)| *purpose == Purpose::Frame);
            requests.extend(frames.map(|_| Request::Do(Action::FrameAll)));
            return;
        }
        let projection = Projection::new(state, rect, size);
        let over = Over { gizmo, ..Over::new(state, rect, &projection) };
        // Overlays take a click first. Only a click on the picture needs a pick by the worker.
        for (at, purpose) in picks {
            if let Some(request) = self.over_click(state, &over, at, purpose) {
                requests.extend(request);
                continue;
            }
            let purpose = match purpose {
                Purpose::Select if state.aiming => Purpose::Aim(at),
                purpose => purpose,
            };
            let at = self.pixel(at);
            if state.explaining && purpose == Purpose::Select {
                requests.push(Request::Explain(at));
            } else if state.lab.picking && purpose == Purpose::Select {
                requests.push(Request::Lab(LabRequest::Attribute(at)));
            } else {
                self.clicks += 1;
                self.clicked_at = ui.input(|input| input.time);
                worker.pick(Pick { at, purpose });
            }
        }
        self.hover(&response, worker);
        self.border_ui(ui, worker);
        self.over_ui(ui, state, &response, &projection, &over);
        self.overlay(ui, state);
        self.loupe_ui(ui, state, &response, worker);
        self.menu_ui(ui, state, requests);
    }

    fn loupe_ui(&mut self, ui: &Ui, state: &State, response: &Response, worker: &Worker<Purpose>) {
        let Some(pointer) = response.hover_pos().filter(|_| state.loupe) else { return };
        let at = self.pixel(pointer);
        let (Some((rect, size)), Some(image)) = (self.place, &self.image) else { return };
        let ask = |window| worker.ideal(window);
        self.loupe.ui(ui, (rect, size, at), (image, pointer), ask);
    }

    /// Picks the pixel under the pointer, once for each pixel that the pointer enters.
    fn hover(&mut self, response: &Response, worker: &Worker<Purpose>) {
        let Some(pointer) = response.hover_pos().filter(|_| !self.mouse.is_dragging()) else {
            self.hovered = None;
            return;
        };
        let at = self.pixel(pointer);
        if std::mem::take(&mut self.stale) || self.hovered.is_none_or(|(last, _)| last != at) {
            // The hit of the previous pixel is the best guess until the answer arrives.
            self.hovered = Some((at, self.hovered.and_then(|(_, hit)| hit)));
            worker.pick(Pick { at, purpose: Purpose::Hover });
        }
    }

    /// Outlines the item under the pointer.
    fn border_ui(&mut self, ui: &Ui, worker: &Worker<Purpose>) {
        let over = self.hovered.and_then(|(_, hit)| hit).map(|hit| hit.item);
        if over != self.asked {
            worker.border(over);
            self.asked = over;
        }
        if let (Some(border), Some((rect, _))) = (&self.border, self.place)
            && Some(border.item) == over
        {
            over::border_ui(ui, rect, border, egui::Color32::WHITE);
        }
    }

    fn take(&mut self, ctx: &Context, image: Arc<ColorImage>) {
        // A picture of the viewport's size is shown unfiltered; a coarser one is interpolated.
        let fits = self.place.is_none_or(|(_, size)| [size.width, size.height] == image.size);
        let filter = if fits { TextureOptions::NEAREST } else { TextureOptions::LINEAR };
        // Reusing a texture of the same size avoids an allocation per picture.
        match &mut self.texture {
            Some(texture) if texture.size() == image.size => {
                texture.set_partial([0, 0], Arc::clone(&image), filter);
            }
            Some(texture) => texture.set(Arc::clone(&image), filter),
            None => {
                self.texture = Some(ctx.load_texture("viewport", Arc::clone(&image), filter));
            }
        }
        self.image = Some(image);
    }

    /// Returns the pixel of the picture under a point of the window.
    fn pixel(&self, at: Pos2) -> [usize; 2] {
        self.place
            .map_or([0, 0], |(rect, Size { width, height })| pixel_at(rect, [width, height], at))
    }

    /// Returns the centre of a pixel in the window.
    #[expect(clippy::cast_precision_loss, reason = "pictures have fewer than 2^24 pixels a side")]
    fn point(&self, [x, y]: [usize; 2]) -> Pos2 {
        let Some((rect, size)) = self.place else { return Pos2::ZERO };
        let part = vec2(
            (x as f32 + 0.5) / size.width.max(1) as f32,
            (y as f32 + 0.5) / size.height.max(1) as f32,
        );
        rect.min + part * rect.size()
    }

    /// Shows the name of the item under the pointer, or the speed of flight.
    fn overlay(&self, ui: &Ui, state: &State) {
        let name = self.hovered.and_then(|(_, hit)| hit).and_then(|hit| state.name(hit.item));
        let item = self.hovered.and_then(|(_, hit)| hit).map(|hit| hit.item);
        let locked = item.is_some_and(|item| state.scene.locked.contains(&item));
        let text = match (self.mouse.flight(), name) {
            (Some(speed), _) => {
                format!("Fly: W A S D Q E, Shift fast, Alt slow, wheel: speed x {speed:.2}")
            }
            (None, Some(name)) if locked => format!("{name} (locked)"),
            (None, Some(name)) => name.to_owned(),
            (None, None) => return,
        };
        let Some((rect, _)) = self.place else { return };
        plate_ui(ui, rect, egui::Align2::LEFT_BOTTOM, text);
    }
}

/// Returns the pixel under a point of the window, of a picture of this size in `rect`.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_precision_loss,
    reason = "brought to the picture's borders, which are small"
)]
fn pixel_at(rect: Rect, [width, height]: [usize; 2], at: Pos2) -> [usize; 2] {
    let part = (at - rect.min) / rect.size();
    let along = |part: f32, count: usize| {
        ((part * count as f32).max(0.0) as usize).min(count.saturating_sub(1))
    };
    [along(part.x, width), along(part.y, height)]
}

/// Returns the rest of `ui`, aligned to whole pixels, and its size in pixels.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_precision_loss,
    reason = "rounded, and brought to what a texture can have"
)]
fn whole_pixels(ui: &Ui) -> (Rect, Size) {
    let scale = ui.ctx().pixels_per_point();
    let most = ui.input(|input| input.max_texture_side);
    let left = ui.available_rect_before_wrap();
    let min = ((left.min.to_vec2() * scale).round() / scale).to_pos2();
    let count = |points: f32| ((points * scale).round().max(1.0) as usize).min(most);
    let size = Size::new(count(left.width()), count(left.height()));
    let points = vec2(size.width as f32, size.height as f32) / scale;
    (Rect::from_min_size(min, points), size)
}

/// Gives the viewport keyboard focus if it is clicked or no widget has it.
fn keep_focus(ctx: &Context, response: &Response) {
    let pressed = ctx.input(|input| input.pointer.any_pressed()) && response.contains_pointer();
    let free =
        ctx.memory(|memory| memory.focused().is_none() && memory.top_modal_layer().is_none());
    if (pressed || free) && !response.has_focus() && !egui::Popup::is_any_open(ctx) {
        response.request_focus();
    }
}

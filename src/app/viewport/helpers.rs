//! Helpers over the picture: the grid on the ground, the sizes of the selected objects, and the
//! names of missing files.
//!
//! The grid appears behind everything, because its lines cover only pixels that show the
//! background.

use egui::{Color32, ColorImage, Painter, Pos2, Rect, Stroke, TextStyle, Ui, vec2};
use glam::DVec3;

use super::marks::Projection;
use super::pixel_at;
use crate::app::state::State;
use crate::app::theme;
use crate::app::widgets::number::short;
use crate::app::widgets::text::file_name;
use marraztu_core::base::math::Axis;
use marraztu_core::edit::{arrange, steps};
use marraztu_core::scene::{Bounds, ItemId};

/// The number of grid lines on each side of the middle.
const LINES: i32 = 10;

/// The number of pieces of each line. A piece that reaches behind the observer is cut at the near
/// plane.
const PIECES: i32 = 20;

/// Draws the grid on the ground over pixels of `image` that show the background, unless that is a
/// panorama.
pub(super) fn grid_ui(ui: &Ui, state: &State, onto: &Projection, image: Option<&ColorImage>) {
    // In front of a panorama, no pixel tells whether it shows the background.
    let is_plain = state
        .scene
        .lights
        .iter()
        .all(|(_, light)| !(light.on && light.kind.panorama().is_some_and(|sky| sky.is_shown)));
    let is_drawn = state.helpers.grid && state.shows_overlays() && is_plain;
    let Some(image) = image.filter(|_| is_drawn) else { return };
    let [r, g, b] = state.scene.background.0;
    let rect = onto.rect();
    let ground = Ground { image, rect, background: Color32::from_rgb(r, g, b) };
    let painter = ui.painter().with_clip_rect(rect);
    let spacing = steps::of_grid(&state.scene);
    let at = |x: i32, z: i32| DVec3::new(f64::from(x), 0.0, f64::from(z)) * spacing;
    // Dark lines on a bright background, bright lines on a dark one.
    let is_bright = u32::from(r) + u32::from(g) + u32::from(b) > 3 * 128;
    let plain =
        if is_bright { Color32::from_black_alpha(70) } else { Color32::from_white_alpha(60) };
    for i in -LINES..=LINES {
        let (along_x, along_z) = match i {
            0 => (theme::axis_on_dark(Axis::X), theme::axis_on_dark(Axis::Z)),
            _ => (plain, plain),
        };
        for piece in 0..PIECES {
            let part = |piece: i32| -LINES + piece * (2 * LINES / PIECES);
            let (from, to) = (part(piece), part(piece + 1));
            for (ends, color) in
                [([at(from, i), at(to, i)], along_x), ([at(i, from), at(i, to)], along_z)]
            {
                if let Some(ends) = onto.segment(ends) {
                    ground.line(&painter, ends, Stroke::new(1.0, color));
                }
            }
        }
    }
}

/// The picture, as a mask of the background.
struct Ground<'a> {
    image: &'a ColorImage,
    rect: Rect,
    background: Color32,
}

impl Ground<'_> {
    /// Draws the parts of a line over pixels that show the background.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within a line")]
    fn line(&self, painter: &Painter, ends: [Pos2; 2], stroke: Stroke) {
        let Some([from, to]) = within(self.rect, ends) else { return };
        // The line is sampled about once per point, and samples over the background are joined.
        let count = (to - from).length().ceil().max(1.0) as u16;
        let at = |i: u16| from + (to - from) * (f32::from(i) / f32::from(count));
        let mut begun = None;
        for i in 0..=count {
            match (self.shows(at(i)), begun) {
                (true, None) => begun = Some(i),
                (false, Some(first)) => {
                    painter.line_segment([at(first), at(i)], stroke);
                    begun = None;
                }
                (true, Some(_)) | (false, None) => {}
            }
        }
        if let Some(first) = begun {
            painter.line_segment([at(first), to], stroke);
        }
    }

    fn shows(&self, at: Pos2) -> bool {
        let [x, y] = pixel_at(self.rect, self.image.size, at);
        self.image.pixels.get(y * self.image.width() + x) == Some(&self.background)
    }
}

/// Clips a line to a rectangle (Liang and Barsky, "A New Concept and Method for Line Clipping",
/// 1984).
fn within(rect: Rect, [a, b]: [Pos2; 2]) -> Option<[Pos2; 2]> {
    let way = b - a;
    let (mut from, mut to) = (0.0_f32, 1.0_f32);
    for (speed, room) in [
        (-way.x, a.x - rect.left()),
        (way.x, rect.right() - a.x),
        (-way.y, a.y - rect.top()),
        (way.y, rect.bottom() - a.y),
    ] {
        if speed == 0.0 {
            if room < 0.0 {
                return None;
            }
        } else if speed < 0.0 {
            from = from.max(room / speed);
        } else {
            to = to.min(room / speed);
        }
    }
    (from < to).then(|| [a + way * from, a + way * to])
}

/// Draws boxes around the selected objects, labelled with their sizes.
pub(super) fn dimensions_ui(ui: &Ui, state: &State, onto: &Projection) {
    if !state.helpers.dimensions || !state.shows_overlays() {
        return;
    }
    let painter = ui.painter().with_clip_rect(onto.rect());
    let stroke = Stroke::new(1.0, theme::accent_on_dark());
    let mut ids: Vec<ItemId> = state.selected().into_iter().chain(state.others()).collect();
    if !ids.iter().any(|id| matches!(id, ItemId::Object(_))) {
        ids.extend(state.view.object.map(ItemId::Object));
    }
    for id in ids {
        let ItemId::Object(id) = id else { continue };
        let object = state.scene.objects.get(id).filter(|object| object.visible);
        if let Some(bounds) = object.and_then(|it| arrange::world_box(it, state.view.time)) {
            box_ui(ui, &painter, onto, &bounds, stroke);
        }
    }
}

fn box_ui(ui: &Ui, painter: &Painter, onto: &Projection, bounds: &Bounds, stroke: Stroke) {
    let corners = bounds.corners();
    let size = bounds.extent();
    // Each axis has four parallel edges. The outermost on the screen is labelled.
    for axis in Axis::ALL {
        let bit = 1 << axis.index();
        let edges = (0..8).filter(|corner| corner & bit == 0);
        let edges: Vec<[DVec3; 2]> = edges.map(|i| [corners[i], corners[i | bit]]).collect();
        for ends in &edges {
            onto.line(painter, *ends, stroke);
        }
        let middles = edges.iter().filter_map(|[a, b]| onto.place((*a + *b) * 0.5));
        // The height is at the left, the other sizes at the bottom.
        let outer = |at: &Pos2| if axis == Axis::Y { -at.x } else { at.y };
        if let Some(at) = middles.max_by(|a, b| outer(a).total_cmp(&outer(b))) {
            let text = format!("{} {}", LETTERS[axis.index()], short(size[axis.index()]));
            // Next to the edge, where it covers neither the edge nor a handle.
            let aside = if axis == Axis::Y { vec2(-28.0, 0.0) } else { vec2(0.0, 13.0) };
            label_ui(ui, painter, at + aside, text, theme::axis_on_dark(axis));
        }
    }
}

const LETTERS: [&str; 3] = ["x", "y", "z"];

/// Shows the file name of each missing model at its box.
pub(super) fn placeholders_ui(ui: &Ui, state: &State, onto: &Projection) {
    let view = &state.view;
    if !state.shows_overlays() || view.polygons.is_some() {
        return;
    }
    let painter = ui.painter().with_clip_rect(onto.rect());
    for (id, object) in state.scene.objects.iter() {
        let file = object.model.source.as_deref().filter(|_| object.model.is_placeholder());
        if let (true, Some(file)) = (view.shows(id, object), file)
            && let Some(at) = onto.place(object.centre(view.time))
            && onto.rect().contains(at)
        {
            let text = format!("{} is missing", file_name(file));
            // Below the middle, which the gizmo of the selection occupies.
            label_ui(ui, &painter, at + vec2(0.0, 28.0), text, theme::warning_on_dark());
        }
    }
}

/// Draws a text on a dark plate, centred at `at`.
fn label_ui(ui: &Ui, painter: &Painter, at: Pos2, text: String, color: Color32) {
    let font = TextStyle::Small.resolve(ui.style());
    let galley = painter.layout_no_wrap(text, font, color);
    let size = galley.size() + vec2(8.0, 4.0);
    let room = painter.clip_rect().shrink2(size / 2.0 + vec2(2.0, 2.0));
    let plate = Rect::from_center_size(room.clamp(at), size);
    painter.rect_filled(plate, 3.0, Color32::from_black_alpha(190));
    painter.galley(plate.center() - galley.size() / 2.0, galley, color);
}

#[cfg(test)]
mod tests {
    use egui::pos2;

    use super::*;

    #[test]
    fn of_a_line_the_part_within_the_picture_is_left() {
        let rect = Rect::from_min_max(pos2(0.0, 0.0), pos2(10.0, 10.0));
        let line = |a: (f32, f32), b: (f32, f32)| within(rect, [a.into(), b.into()]);
        assert_eq!(line((-5.0, 5.0), (15.0, 5.0)), Some([pos2(0.0, 5.0), pos2(10.0, 5.0)]));
        assert_eq!(line((2.0, 2.0), (3.0, 4.0)), Some([pos2(2.0, 2.0), pos2(3.0, 4.0)]));
        assert_eq!(line((-5.0, 12.0), (15.0, 12.0)), None);
        assert_eq!(line((-4.0, 5.0), (5.0, -4.0)), Some([pos2(0.0, 1.0), pos2(1.0, 0.0)]));
    }
}

//! The loupe: the pixels under the pointer, as drawn, as in the ideal, and their difference.

use std::sync::Arc;

use egui::{
    Color32, ColorImage, Id, LayerId, Order, Painter, Pos2, Rect, Stroke, StrokeKind, TextStyle,
    Ui, pos2, vec2,
};

use crate::app::theme;
use marraztu_core::base::image::{Picture, Size};
use marraztu_render::screen::coverage::PixelBox;

/// The side of the window, in pixels.
const SIDE: i32 = 16;

/// The side of an enlarged pixel, in points.
const PIXEL: f32 = 9.0;

/// The factor of the difference.
const TIMES: u8 = 8;

/// The space around and between the three squares, and the height of the lines of text.
const GAP: f32 = 8.0;
const LINE: f32 = 16.0;

/// Returns the colour of a pixel of the window, by column and row, if it is known.
type PixelColor<'a> = dyn Fn(i32, i32) -> Option<[u8; 4]> + 'a;

#[derive(Debug, Default)]
pub(super) struct Loupe {
    /// The window that was requested last.
    asked: Option<PixelBox>,
    /// The last window of the ideal.
    ideal: Option<(PixelBox, Picture)>,
}

impl Loupe {
    /// Forgets the ideal of another picture.
    pub(super) fn forget(&mut self) {
        (self.asked, self.ideal) = (None, None);
    }

    pub(super) fn take(&mut self, window: PixelBox, picture: Picture) {
        self.ideal = Some((window, picture));
    }

    /// Shows the loupe at a pixel of the picture in `rect`. `ask` requests a window of the ideal.
    pub(super) fn ui(
        &mut self,
        ui: &Ui,
        (rect, size, at): (Rect, Size, [usize; 2]),
        (drawn, pointer): (&Arc<ColorImage>, Pos2),
        ask: impl FnOnce(PixelBox),
    ) {
        let window = around(at, size);
        if self.asked != Some(window) {
            ask(window);
            self.asked = Some(window);
        }
        let ideal = self.ideal.as_ref().filter(|(of, _)| *of == window).map(|(_, picture)| picture);
        let plate = place(rect, pointer);
        // The dial and the start strip must not cover it.
        let layer = LayerId::new(Order::Foreground, Id::unique("loupe"));
        let painter = &ui.painter().clone().with_layer_id(layer);
        painter.rect_filled(plate, 6.0, ui.visuals().window_fill);
        painter.rect_stroke(plate, 6.0, ui.visuals().window_stroke, StrokeKind::Inside);
        let shown = |x: i32, y: i32| color_at(drawn, size, [window.left + x, window.top + y]);
        let exact = |x: i32, y: i32| {
            ideal.map(|picture| {
                let [x, y] = [x, y].map(|i| usize::try_from(i).unwrap_or(0));
                picture.pixel(x, y)
            })
        };
        let difference = |x: i32, y: i32| {
            let (a, b) = (shown(x, y)?, exact(x, y)?);
            let step = |i: usize| a[i].abs_diff(b[i]).saturating_mul(TIMES);
            Some([step(0), step(1), step(2), 255])
        };
        let centre = [at[0], at[1]].map(|i| i32::try_from(i).unwrap_or(0));
        let centre = [centre[0] - window.left, centre[1] - window.top];
        let difference_label = format!("difference, {TIMES} times");
        let columns: [(&str, &PixelColor<'_>); 3] =
            [("on screen", &shown), ("ideal", &exact), (&difference_label, &difference)];
        for (i, (label, colors)) in (0_u8..).zip(columns) {
            let left = plate.left() + GAP + f32::from(i) * (square() + GAP);
            let square =
                Rect::from_min_size(pos2(left, plate.top() + GAP + LINE), vec2(square(), square()));
            text(ui, painter, square.left_top() - vec2(0.0, LINE), label);
            painter.rect_filled(square, 0.0, ui.visuals().extreme_bg_color);
            square_ui(painter, square, window, colors);
            mark_ui(painter, square, centre);
            let [x, y] = centre;
            let own = match (i, shown(x, y), exact(x, y)) {
                (0, Some([r, g, b, _]), _) | (1, _, Some([r, g, b, _])) => {
                    format!("R {r}  G {g}  B {b}")
                }
                (2, Some(a), Some(b)) => {
                    let step = |i: usize| i16::from(a[i]) - i16::from(b[i]);
                    format!("R {:+}  G {:+}  B {:+}", step(0), step(1), step(2))
                }
                _ => "drawing".to_owned(),
            };
            text(ui, painter, square.left_bottom() + vec2(0.0, 2.0), &own);
        }
    }
}

/// Returns the side of a square in points.
fn square() -> f32 {
    PIXEL * 16.0
}

/// Returns the window around a pixel, moved into the picture.
fn around(at: [usize; 2], size: Size) -> PixelBox {
    let start = |at: usize, most: usize| {
        let [at, most] = [at, most].map(|i| i32::try_from(i).unwrap_or(i32::MAX));
        (at - SIDE / 2).min(most - SIDE).max(0)
    };
    let end = |from: i32, most: usize| (from + SIDE).min(i32::try_from(most).unwrap_or(i32::MAX));
    let (left, top) = (start(at[0], size.width), start(at[1], size.height));
    PixelBox { left, top, right: end(left, size.width), bottom: end(top, size.height) }
}

/// Returns the place of the loupe next to the pointer, inside the picture.
fn place(picture: Rect, pointer: Pos2) -> Rect {
    let size = vec2(3.0 * square() + 4.0 * GAP, square() + 2.0 * LINE + 2.0 * GAP + 4.0);
    let below = pointer.y + 24.0 + size.y <= picture.bottom();
    let top = if below { pointer.y + 24.0 } else { pointer.y - 24.0 - size.y };
    let left = (pointer.x - size.x / 2.0).min(picture.right() - size.x).max(picture.left());
    Rect::from_min_size(pos2(left, top.max(picture.top())), size)
}

/// Returns the colour of a pixel of the image on screen, which may be smaller than the picture.
fn color_at(image: &ColorImage, size: Size, at: [i32; 2]) -> Option<[u8; 4]> {
    let [width, height] = image.size;
    let [x, y] = at.map(|i| usize::try_from(i).unwrap_or(usize::MAX));
    if x >= size.width || y >= size.height {
        return None;
    }
    let (x, y) = (x * width / size.width, y * height / size.height);
    image.pixels.get(y * width + x).map(Color32::to_array)
}

fn square_ui(painter: &Painter, square: Rect, window: PixelBox, colors: &PixelColor<'_>) {
    let (columns, rows) = (window.right - window.left, window.bottom - window.top);
    let mut from = square.min;
    for y in 0..rows {
        for x in 0..columns {
            let pixel = Rect::from_min_size(from, vec2(PIXEL, PIXEL));
            if let Some([r, g, b, _]) = colors(x, y) {
                painter.rect_filled(pixel, 0.0, Color32::from_rgb(r, g, b));
            }
            from.x += PIXEL;
        }
        from = pos2(square.left(), from.y + PIXEL);
    }
}

/// Marks the pixel under the pointer.
fn mark_ui(painter: &Painter, square: Rect, [x, y]: [i32; 2]) {
    let [x, y] = [x, y].map(|i| f32::from(i16::try_from(i).unwrap_or(0)) * PIXEL);
    let pixel = Rect::from_min_size(square.min + vec2(x, y), vec2(PIXEL, PIXEL));
    let (dark, light) =
        (Stroke::new(1.0, Color32::BLACK), Stroke::new(1.0, theme::accent_on_dark()));
    painter.rect_stroke(pixel.expand(1.0), 0.0, dark, StrokeKind::Outside);
    painter.rect_stroke(pixel, 0.0, light, StrokeKind::Outside);
}

fn text(ui: &Ui, painter: &Painter, at: Pos2, text: &str) {
    let font = TextStyle::Small.resolve(ui.style());
    painter.text(at, egui::Align2::LEFT_TOP, text, font, ui.visuals().text_color());
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_window_of_a_pixel_contains_it_and_stays_in_the_picture() {
        let size = Size::new(100, 40);
        for at in [[0, 0], [99, 39], [50, 20], [7, 39]] {
            let PixelBox { left, top, right, bottom } = around(at, size);
            let [x, y] = at.map(|i| i32::try_from(i).unwrap());
            assert!((left..right).contains(&x) && (top..bottom).contains(&y), "{at:?}");
            assert!(left >= 0 && top >= 0 && right <= 100 && bottom <= 40);
            assert_eq!((right - left, bottom - top), (16, 16));
        }
        let small = around([3, 2], Size::new(9, 5));
        assert_eq!(small, PixelBox { left: 0, top: 0, right: 9, bottom: 5 });
    }
}

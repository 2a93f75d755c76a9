//! A colour field that opens a picker: a square of shades, a bar of hues, and red, green and blue
//! as numbers.
//!
//! Hue, saturation and value follow Smith, "Color Gamut Transform Pairs", SIGGRAPH 1978, applied to
//! display values. The picked HSV values are kept together with the colour, because grey has no
//! hue: a drag through grey would otherwise lose the hue.

use std::ops::RangeInclusive;

use egui::{
    Color32, CursorIcon, Mesh, Popup, PopupCloseBehavior, Pos2, Rect, Response, Role, Sense, Shape,
    Stroke, StrokeKind, TextEdit, Ui, WidgetInfo, pos2, vec2,
};

use super::controls::focus_ring;
use super::gestures;
use super::number::{self, Number};
use crate::app::theme;
use marraztu_core::base::color::Color;
use marraztu_core::edit::Gesture;

const WIDTH: f32 = 204.0;
const SQUARE: f32 = 140.0;
const BAR: f32 = 16.0;

/// Hue, saturation and value, each from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Hsv {
    hue: f64,
    saturation: f64,
    value: f64,
}

impl Hsv {
    fn of(color: Color) -> Self {
        let [r, g, b] = color.factors();
        let value = r.max(g).max(b);
        let chroma = value - r.min(g).min(b);
        if chroma <= 0.0 {
            return Self { hue: 0.0, saturation: 0.0, value };
        }
        let sixth = if value <= r {
            (g - b) / chroma
        } else if value <= g {
            (b - r) / chroma + 2.0
        } else {
            (r - g) / chroma + 4.0
        };
        Self { hue: (sixth / 6.0).rem_euclid(1.0), saturation: chroma / value, value }
    }

    fn color(self) -> Color {
        // Each channel is full for a third of the hues and ramps over a sixth on either side.
        let channel = |turn: f64| {
            let sixth = ((self.hue + turn) * 6.0).rem_euclid(6.0);
            let full = ((sixth - 3.0).abs() - 1.0).clamp(0.0, 1.0);
            self.value * (1.0 - self.saturation * (1.0 - full))
        };
        Color::from_factors([channel(0.0), channel(2.0 / 3.0), channel(1.0 / 3.0)])
    }
}

/// Shows a colour that opens a picker. Returns the colour that the user picked.
pub(crate) fn swatch(
    ui: &mut Ui,
    name: &str,
    hint: &str,
    color: Color,
) -> Option<(Color, Gesture)> {
    let (rect, response) = ui.allocate_exact_size(vec2(34.0, theme::ROW), Sense::click());
    let [r, g, b] = color.0;
    response.widget_info(|| {
        let mut info = WidgetInfo::labeled(Role::ColorWell, ui.is_enabled(), name);
        info.current_text_value = Some(format!("{r}, {g}, {b}"));
        info
    });
    ui.painter().rect_filled(rect, 4.0, shown(color));
    let border = if response.hovered() {
        ui.visuals().strong_text_color()
    } else {
        ui.visuals().weak_text_color()
    };
    ui.painter().rect_stroke(rect, 4.0, Stroke::new(1.0, border), StrokeKind::Inside);
    focus_ring(ui, rect, &response);
    let picked = Popup::menu(&response)
        .close_behavior(PopupCloseBehavior::CloseOnClickOutside)
        .show(|ui| picker_ui(ui, name, color));
    response.on_hover_ui(|ui| {
        ui.label(hint);
        ui.weak(format!("Red {r}, green {g}, blue {b}"));
    });
    let (to, gesture) = picked?.inner?;
    (to != color).then_some((to, gesture))
}

const fn shown(color: Color) -> Color32 {
    let [r, g, b] = color.0;
    Color32::from_rgb(r, g, b)
}

fn picker_ui(ui: &mut Ui, name: &str, color: Color) -> Option<(Color, Gesture)> {
    // Fields look as in panels, not as the entries of a menu.
    ui.set_style(ui.ctx().global_style());
    ui.set_width(WIDTH);
    // The kept HSV values are used unless the colour was changed by other means.
    let id = ui.scope_id().with("hue, saturation and value");
    let kept = ui.data(|data| data.get_temp::<[f64; 3]>(id));
    let kept = kept.map(|[hue, saturation, value]| Hsv { hue, saturation, value });
    let mut hsv = kept.filter(|hsv| hsv.color() == color).unwrap_or_else(|| Hsv::of(color));
    let mut picked = None;
    let (rect, response) = ui.allocate_exact_size(vec2(WIDTH, SQUARE), Sense::drag());
    response.widget_info(|| WidgetInfo::labeled(Role::ColorWell, true, format!("{name}: shade")));
    square(ui, rect, hsv);
    if let Some(at) = pressed_at(&response) {
        hsv.saturation = part(at.x, rect.left()..=rect.right());
        hsv.value = 1.0 - part(at.y, rect.top()..=rect.bottom());
        picked = Some(gestures::of(&response));
    }
    let (rect, response) = ui.allocate_exact_size(vec2(WIDTH, BAR), Sense::drag());
    response.widget_info(|| WidgetInfo::labeled(Role::ColorWell, true, format!("{name}: hue")));
    bar(ui, rect, hsv);
    if let Some(at) = pressed_at(&response) {
        // The hue stops short of 1, which would be the red of 0: the marker would jump to the other
        // end.
        hsv.hue = part(at.x, rect.left()..=rect.right()).min(0.999_999);
        picked = Some(gestures::of(&response));
    }
    if let Some(gesture) = picked {
        ui.data_mut(|data| data.insert_temp(id, [hsv.hue, hsv.saturation, hsv.value]));
        return Some((hsv.color(), gesture));
    }
    let typed = numbers_ui(ui, name, color);
    typed.or_else(|| hex_ui(ui, name, color).map(|to| (to, Gesture::Whole)))
}

/// Shows the colour as six hexadecimal digits, as in HTML.
fn hex_ui(ui: &mut Ui, name: &str, color: Color) -> Option<Color> {
    let [r, g, b] = color.0;
    let id = ui.scope_id().with("hexadecimal");
    let field = id.with("field");
    let kept = ui.data(|data| data.get_temp::<String>(id));
    // Another field that was clicked already has the focus.
    let edited = ui.memory(|memory| memory.has_focus(field) || memory.had_focus_last_frame(field));
    let mut text = kept.filter(|_| edited).unwrap_or_else(|| format!("#{r:02x}{g:02x}{b:02x}"));
    let edit = TextEdit::singleline(&mut text).id(field).desired_width(WIDTH - 8.0);
    let response = ui.add(edit).accessible_name(format!("{name}: hexadecimal"));
    // A click elsewhere takes the focus one frame later, when the picker may be closed. Escape
    // leaves the field without a change.
    let clicked_away = edited && response.clicked_elsewhere();
    let escaped = ui.input(|input| input.key_pressed(egui::Key::Escape));
    let left = (response.lost_focus() || clicked_away) && !escaped;
    let to = hexadecimal(&text);
    if left && to.is_none() {
        number::say_bad_text(ui.ctx(), &text);
    }
    ui.data_mut(|data| {
        if left {
            data.remove::<String>(id);
        } else {
            data.insert_temp(id, text);
        }
    });
    response.on_hover_text("Six hexadecimal digits: red, green, blue");
    to.filter(|to| left && *to != color)
}

/// Parses `#7db8f7` or `7db8f7`; each of three digits counts twice.
pub(crate) fn hexadecimal(text: &str) -> Option<Color> {
    let digits = text.trim().trim_start_matches('#');
    let digit = |c: char| c.to_digit(16).and_then(|digit| u8::try_from(digit).ok());
    let digits: Vec<u8> = digits.chars().map(digit).collect::<Option<_>>()?;
    match digits[..] {
        [r, g, b] => Some(Color([r, g, b].map(|digit| digit * 17))),
        [r, s, g, h, b, c] => Some(Color([r * 16 + s, g * 16 + h, b * 16 + c])),
        _ => None,
    }
}

fn pressed_at(response: &Response) -> Option<Pos2> {
    response.interact_pointer_pos().filter(|_| response.is_pointer_button_down_on())
}

/// Returns the position of `at` between two ends, from 0 to 1.
fn part(at: f32, ends: RangeInclusive<f32>) -> f64 {
    let length = f64::from(ends.end() - ends.start());
    (f64::from(at - ends.start()) / length).clamp(0.0, 1.0)
}

fn numbers_ui(ui: &mut Ui, name: &str, color: Color) -> Option<(Color, Gesture)> {
    ui.horizontal(|ui| {
        let width = (WIDTH - 2.0 * theme::GAP) / 3.0;
        let mut picked = None;
        let channels = [("R", "red"), ("G", "green"), ("B", "blue")];
        for (i, (letter, channel)) in channels.into_iter().enumerate() {
            let number = Number::new(format!("{name}: {channel}"), channel).letter(letter);
            let number = number.range(0.0..=255.0).speed(0.5).whole();
            if let Some((to, gesture)) = number.ui(ui, width, f64::from(color.0[i])) {
                let mut color = color;
                color.0[i] = marraztu_core::base::color::byte(to / 255.0);
                picked = Some((color, gesture));
            }
        }
        picked
    })
    .inner
}

/// Draws the shades of a hue: saturation to the right, value upwards.
fn square(ui: &Ui, rect: Rect, hsv: Hsv) {
    const CELLS: u16 = 16;
    let color = |x: f64, y: f64| shown(Hsv { saturation: x, value: 1.0 - y, ..hsv }.color());
    ui.painter().add(gradient(rect, [CELLS, CELLS], color));
    let at = rect.lerp_inside(vec2(narrow(hsv.saturation), 1.0 - narrow(hsv.value)));
    ring(ui, at, shown(hsv.color()));
    cursor(ui, rect);
}

fn bar(ui: &Ui, rect: Rect, hsv: Hsv) {
    let full = |hue: f64| shown(Hsv { hue, saturation: 1.0, value: 1.0 }.color());
    ui.painter().add(gradient(rect, [36, 1], |x, _| full(x)));
    ring(ui, rect.lerp_inside(vec2(narrow(hsv.hue), 0.5)), full(hsv.hue));
    cursor(ui, rect);
}

/// Creates a mesh of `cells` rectangles across and down; `color` maps places from 0 to 1 to
/// colours.
fn gradient(rect: Rect, cells: [u16; 2], color: impl Fn(f64, f64) -> Color32) -> Shape {
    let mut mesh = Mesh::default();
    let [across, down] = cells;
    let row = u32::from(across) + 1;
    for y in 0..=down {
        for x in 0..=across {
            let (u, v) = (f64::from(x) / f64::from(across), f64::from(y) / f64::from(down));
            mesh.colored_vertex(rect.lerp_inside(vec2(narrow(u), narrow(v))), color(u, v));
            if x < across && y < down {
                let at = u32::from(y) * row + u32::from(x);
                mesh.add_triangle(at, at + 1, at + row);
                mesh.add_triangle(at + 1, at + row, at + row + 1);
            }
        }
    }
    Shape::mesh(mesh)
}

/// Draws the picked colour in a ring that is visible on light and dark colours.
fn ring(ui: &Ui, at: Pos2, color: Color32) {
    let at = pos2(at.x.round(), at.y.round());
    ui.painter().circle(at, 6.0, color, Stroke::new(2.0, Color32::WHITE));
    ui.painter().circle_stroke(at, 7.0, Stroke::new(1.0, Color32::BLACK));
}

fn cursor(ui: &Ui, rect: Rect) {
    if ui.rect_contains_pointer(rect) {
        ui.set_cursor_icon(CursorIcon::Crosshair);
    }
}

#[expect(clippy::cast_possible_truncation, reason = "the nearest f32 is meant")]
const fn narrow(number: f64) -> f32 {
    number as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hexadecimal_digits_are_colours() {
        assert_eq!(hexadecimal("#7db8f7"), Some(Color([0x7d, 0xb8, 0xf7])));
        assert_eq!(hexadecimal(" FA0 "), Some(Color([0xff, 0xaa, 0x00])));
        for bad in ["", "#12", "#12345g", "1234567"] {
            assert_eq!(hexadecimal(bad), None, "{bad}");
        }
    }

    #[test]
    fn every_colour_comes_back_from_its_hue_saturation_and_value() {
        for i in 0..4096_u16 {
            let byte = |shift: u16| u8::try_from((i >> shift) & 15).unwrap_or(0) * 17;
            let color = Color([byte(0), byte(4), byte(8)]);
            assert_eq!(Hsv::of(color).color(), color);
        }
    }

    #[test]
    fn the_hues_begin_with_red_and_go_by_way_of_green_and_blue() {
        let pure = |hue: f64| Hsv { hue, saturation: 1.0, value: 1.0 }.color().0;
        let expected = [[255, 0, 0], [255, 255, 0], [0, 255, 0], [0, 255, 255], [0, 0, 255]];
        for (i, color) in (0..5_u8).zip(expected) {
            assert_eq!(pure(f64::from(i) / 6.0), color);
        }
        assert_eq!(Hsv::of(Color([0, 0, 179])).hue, 4.0 / 6.0);
    }
}

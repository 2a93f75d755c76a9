//! Number fields: the value can be dragged, typed, or given as an expression.
//!
//! An idle field shows the digits that fit; a focused field shows all of them. Leaving a field
//! without typing another number changes nothing, so tabbing through fields does not round values.
//! A mixed field is empty while it is edited: any number typed into it is a change.

use std::cell::Cell;
use std::ops::RangeInclusive;

use egui::text::CCursorRange;
use egui::{Context, DragValue, Id, RichText, TextEdit, TextStyle, Ui, vec2};
use glam::{DMat3, DVec3};

use super::expression;
use super::gestures;
use super::mixed::is_mixed;
use crate::app::theme;
use marraztu_core::base::math::Axis;
use marraztu_core::edit::Gesture;
use marraztu_core::edit::angles::{nearest, same_turn};

/// The maximum length of an idle number, in characters.
const ROOM: usize = 8;

/// The width of a digit, in parts of the font's size.
const DIGIT: f32 = 0.53;

/// The distance from the border of a field to its text.
const PADDING: f32 = 3.0;

const LETTERS: [&str; 3] = ["X", "Y", "Z"];

#[derive(Clone, Debug)]
pub(crate) struct Number<'a> {
    name: String,
    hint: &'a str,
    letter: &'static str,
    axis: Option<Axis>,
    suffix: &'static str,
    speed: f64,
    range: RangeInclusive<f64>,
    whole: bool,
}

impl<'a> Number<'a> {
    /// Creates a field called `name` by screen readers. Its tooltip shows `hint`.
    pub(crate) fn new(name: impl Into<String>, hint: &'a str) -> Self {
        Self {
            name: name.into(),
            hint,
            letter: "",
            axis: None,
            suffix: "",
            speed: 1.0,
            range: f64::NEG_INFINITY..=f64::INFINITY,
            whole: false,
        }
    }

    /// Adds the letter of an axis before the number and after the name.
    fn axis(self, axis: Axis) -> Self {
        let name = format!("{} {}", self.name, LETTERS[axis.index()]);
        Self { axis: Some(axis), name, letter: LETTERS[axis.index()], ..self }
    }

    /// Adds a letter before the number.
    pub(crate) fn letter(self, letter: &'static str) -> Self {
        Self { letter, ..self }
    }

    /// Adds a unit after the number.
    pub(crate) fn suffix(self, suffix: &'static str) -> Self {
        Self { suffix, ..self }
    }

    /// Sets the change per point of a drag.
    pub(crate) fn speed(self, speed: f64) -> Self {
        Self { speed, ..self }
    }

    /// Sets the range. Values outside are clamped.
    pub(crate) fn range(self, range: RangeInclusive<f64>) -> Self {
        Self { range, ..self }
    }

    /// Allows only whole numbers.
    pub(crate) fn whole(self) -> Self {
        Self { whole: true, ..self }
    }

    /// Returns the number of characters that fit next to the letter and the unit.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within 3 and 8")]
    fn room(&self, width: f32) -> usize {
        let signs =
            if self.letter.is_empty() { 0.0 } else { 1.8 } + self.suffix.chars().count() as f32;
        let room = (width - 2.0 * PADDING) / (DIGIT * theme::BODY) - signs;
        room.clamp(3.0, ROOM as f32) as usize
    }

    /// Shows the field, `width` points wide. Returns the number that the user entered.
    pub(crate) fn ui(self, ui: &mut Ui, width: f32, value: f64) -> Option<(f64, Gesture)> {
        let id = ui.next_auto_id();
        let mut to = value;
        // Focus is read only when the text is made: Tab moves the focus to the field just before
        // that.
        let (ctx, room) = (ui.ctx().clone(), self.room(width));
        let parsed = ctx.clone();
        let mixed = is_mixed(&ctx, &self.name);
        let edited = move || ctx.memory(|memory| memory.has_focus(id));
        // Text that the field had when the user began to edit it.
        let offered = if mixed { String::new() } else { exact(value) };
        let format = move |number: f64, _| match (edited(), mixed) {
            (true, true) => String::new(),
            (true, false) => exact(number),
            (false, true) => "mixed".to_owned(),
            (false, false) => short_in(number, room),
        };
        let typed = Cell::new(false);
        // The range clamps only new input: values from files are shown as they are.
        let mut field = DragValue::new(&mut to)
            .speed(self.speed)
            .range(self.range)
            .clamp_existing_to_range(false)
            .update_while_editing(false)
            .min_size(vec2(width, theme::ROW))
            .clip_text(true)
            .custom_formatter(format)
            .custom_parser(|text| {
                let value = expression::value(text);
                typed.set(value.is_some());
                if value.is_none() && !(mixed && text.is_empty()) {
                    say_bad_text(&parsed, text);
                }
                value
            });
        if self.whole {
            field = field.max_decimals(0);
        }
        if !self.letter.is_empty() {
            let letter = self.letter;
            let weak = ui.visuals().weak_text_color();
            let color = self.axis.map_or(weak, |axis| theme::axis(ui.visuals(), axis));
            field = field.prefix(
                RichText::new(format!("{letter} ")).text_style(TextStyle::Small).color(color),
            );
        }
        if !self.suffix.is_empty() {
            field = field.suffix(RichText::new(self.suffix).weak());
        }
        // The padding is set directly, since a scope would change the id of the field.
        let padding = std::mem::replace(&mut ui.spacing_mut().button_padding.x, PADDING);
        let response = ui.add(field).accessible_name(&self.name);
        ui.spacing_mut().button_padding.x = padding;
        if response.clicked() {
            // egui selects only the length of the idle text, which may be shorter than all digits.
            let mut state = TextEdit::load_state(ui.ctx(), id).unwrap_or_default();
            state.cursor.set_char_range(Some(CCursorRange::select_all_str(&offered)));
            state.store(ui.ctx(), id);
        }
        let response = response.on_disabled_hover_text(self.hint).on_hover_ui(|ui| {
            ui.label(self.hint);
            ui.label(RichText::new("Drag, or click and type a number or an expression").weak());
        });
        // A focused field without another number typed into it reports no change.
        let to = if self.whole { to.round() } else { to };
        let changed = response.changed() && (response.dragged() || exact(to) != exact(value));
        (changed || mixed && typed.get()).then(|| (to, gestures::of(&response)))
    }
}

fn bad_text() -> Id {
    Id::unique("text that is no number")
}

/// Records that a field could not parse its text.
pub(super) fn say_bad_text(ctx: &Context, text: &str) {
    ctx.data_mut(|data| data.insert_temp(bad_text(), text.to_owned()));
}

/// Takes the text that a field could not parse since the last call.
pub(crate) fn take_bad_text(ctx: &Context) -> Option<String> {
    ctx.data_mut(|data| data.remove_temp(bad_text()))
}

/// A coordinate that the user entered.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Coordinate {
    axis: Axis,
    value: f64,
}

impl Coordinate {
    /// Returns a vector with this coordinate.
    pub(crate) fn set_in(self, mut vector: DVec3) -> DVec3 {
        vector[self.axis.index()] = self.value;
        vector
    }
}

/// Shows one copy of `field` for each axis in a row. Returns the coordinate that the user entered.
pub(crate) fn vector(
    ui: &mut Ui,
    field: &Number<'_>,
    value: DVec3,
) -> Option<(Coordinate, Gesture)> {
    ui.spacing_mut().item_spacing.x = theme::GAP;
    let width = (ui.available_width() - 2.0 * theme::GAP) / 3.0;
    let mut changed = None;
    for axis in Axis::ALL {
        let number = field.clone().axis(axis);
        if let Some((to, gesture)) = number.ui(ui, width, value[axis.index()]) {
            changed = Some((Coordinate { axis, value: to }, gesture));
        }
    }
    changed
}

/// Formats a number in few characters, with at most three decimals.
pub(crate) fn short(number: f64) -> String {
    short_in(number, ROOM)
}

fn short_in(number: f64, room: usize) -> String {
    for decimals in (0..=3).rev() {
        let text = trimmed(&format!("{number:.decimals$}"));
        // A number other than 0 is never shown as 0.
        if text.chars().count() <= room && (text != "0" || number.abs() < 1e-12) {
            return text;
        }
    }
    let text = format!("{number:.1e}");
    if text.len() <= room { text } else { format!("{number:.0e}") }
}

/// Formats a number with all digits that a user may have entered.
fn exact(number: f64) -> String {
    let size = number.abs();
    if size != 0.0 && !(1e-6..1e15).contains(&size) {
        return format!("{number:e}");
    }
    trimmed(&format!("{number:.9}"))
}

fn trimmed(text: &str) -> String {
    let text =
        if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { text };
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

/// Returns the angles to show for a rotation: the last ones if they give the same rotation, else
/// the nearest equivalent ones.
///
/// Without this, an angle of 95 degrees about Y would jump to 180, 85 and 180 during a drag.
/// `canonical` is shown first; `turn` converts angles into a rotation.
pub(crate) fn shown_angles(
    ui: &Ui,
    name: &'static str,
    canonical: DVec3,
    turn: impl Fn(DVec3) -> DMat3,
) -> DVec3 {
    let id = ui.scope_id().with(name);
    let last = ui.data(|data| data.get_temp::<[f64; 3]>(id)).map(DVec3::from_array);
    let shown = match last {
        Some(last) if same_turn(turn(last), turn(canonical)) => return last,
        Some(last) => nearest(canonical, last, turn),
        None => canonical,
    };
    keep_angles(ui, name, shown);
    shown
}

/// Keeps angles that the user entered, for [`shown_angles`].
pub(crate) fn keep_angles(ui: &Ui, name: &'static str, given: DVec3) {
    ui.data_mut(|data| data.insert_temp(ui.scope_id().with(name), given.to_array()));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_at_rest_fit_their_field_and_end_without_zeros() {
        for (number, expected) in [
            (0.0, "0"),
            (-0.0, "0"),
            (10.0, "10"),
            (-200.0, "-200"),
            (1.2, "1.2"),
            (33.333_333, "33.333"),
            (-1234.5678, "-1234.57"),
            (12_345_678.0, "12345678"),
            (5e-6, "5.0e-6"),
            (123_456_789.0, "1.2e8"),
            (1e-300, "0"),
        ] {
            assert_eq!(short(number), expected);
        }
        let narrow = [-0.000_12, 33.333_333, -1234.5678, 123_456.0, -123_456.0];
        assert_eq!(
            narrow.map(|number| short_in(number, 5)),
            ["-1e-4", "33.33", "-1235", "1.2e5", "-1e5"]
        );
    }

    #[test]
    fn a_number_that_is_edited_reads_back_as_itself() {
        for number in [0.1, 1.0 / 3.0, -98.7, 5e-6, 1e300, 1e-300, 123_456.789] {
            let back = expression::value(&exact(number)).unwrap();
            assert!((back - number).abs() <= 1e-8 * number.abs(), "{number} became {back}");
            assert_eq!(exact(back), exact(number));
        }
    }
}

//! The controls of panels: sections, rows, switches, choices, icon buttons.
//!
//! Each control has a name for screen readers, a focus ring and a tooltip. It shows that it is on
//! by a shape as well as by a colour.

use std::sync::Arc;

use egui::collapsing_header::CollapsingState;
use egui::{
    Color32, Galley, Id, Rect, Response, RichText, Role, ScrollArea, Sense, Stroke, StrokeKind,
    TextStyle, TextWrapMode, Ui, WidgetInfo, WidgetText, pos2, vec2,
};

use super::icons::Icon;
use super::mixed::is_mixed;
use super::regions;
use crate::app::theme;

/// Lays out a line of text, truncated with dots if it does not fit.
pub(crate) fn text(
    ui: &Ui,
    text: impl Into<WidgetText>,
    style: TextStyle,
    width: f32,
) -> Arc<Galley> {
    text.into().into_galley(ui, Some(TextWrapMode::Truncate), width.max(0.0), style)
}

/// Draws a line of text at the left of `rect`, vertically centred.
pub(crate) fn put_text(ui: &Ui, rect: Rect, galley: Arc<Galley>, color: Color32) {
    let at = pos2(rect.left(), rect.center().y - galley.size().y / 2.0);
    ui.painter().galley_with_override_text_color(at, galley, color);
}

/// Draws a line of text at the right of `rect`, vertically centred.
pub(crate) fn right_text(ui: &Ui, rect: Rect, value: &str, style: TextStyle, color: Color32) {
    let galley = text(ui, value, style, rect.width());
    put_text(ui, rect.with_min_x(rect.right() - galley.size().x), galley, color);
}

/// Draws the background of a row that is on or under the pointer. Returns the colour of its text.
pub(crate) fn row_ground(ui: &Ui, row: &Response, on: bool) -> Color32 {
    let visuals = ui.visuals();
    let (fill, ink) = match (on, row.hovered()) {
        (true, _) => (visuals.selection.bg_fill, visuals.selection.stroke.color),
        (false, true) => (visuals.widgets.hovered.bg_fill, visuals.text_color()),
        (false, false) => (Color32::TRANSPARENT, visuals.text_color()),
    };
    ui.painter().rect_filled(row.rect, 3.0, fill);
    ink
}

/// Shows a part of a panel that can be folded.
pub(crate) fn section(ui: &mut Ui, title: &'static str, open: bool, add: impl FnOnce(&mut Ui)) {
    regions::begin(ui, ("section", ui.layer_id(), title));
    let id = Id::unique(("section", title));
    let mut folding = CollapsingState::load_with_default_open(ui.ctx(), id, open);
    let size = vec2(ui.available_width(), theme::ROW + 4.0);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    if response.clicked() {
        folding.toggle(ui);
    }
    let is_open = folding.is_open();
    response.widget_info(|| WidgetInfo::selected(Role::DisclosureTriangle, true, is_open, title));
    let visuals = ui.visuals();
    let color = if response.hovered() { visuals.strong_text_color() } else { visuals.text_color() };
    let line = Stroke::new(1.0, theme::line(visuals));
    ui.painter().hline(rect.x_range(), rect.top() + 0.5, line);
    let chevron = Rect::from_min_size(rect.min, vec2(10.0, rect.height()));
    let icon = if is_open { Icon::DOWN } else { Icon::RIGHT };
    icon.paint(ui.painter(), chevron, 8.0, color);
    let left = rect.with_min_x(rect.left() + 16.0);
    put_text(ui, left, text(ui, title, TextStyle::Body, left.width()), color);
    focus_ring(ui, rect, &response);
    folding.show_body_unindented(ui, |ui| {
        add(ui);
        ui.add_space(theme::GAP);
    });
    regions::follow_focus(ui);
}

/// Shows the name of a dialog above its contents.
pub(crate) fn heading(ui: &mut Ui, name: impl Into<RichText>) {
    ui.heading(name);
    ui.add_space(theme::GAP);
}

/// Shows contents that need `least` points of width; narrower panels scroll sideways.
pub(crate) fn no_narrower(ui: &mut Ui, least: f32, add: impl FnOnce(&mut Ui)) {
    if ui.available_width() >= least {
        return add(ui);
    }
    let area = ScrollArea::horizontal().id_salt("sideways").auto_shrink(false);
    area.show(ui, |ui| {
        ui.set_width(least);
        add(ui);
    });
}

/// Shows a row: a label at the left, a control at the right.
pub(crate) fn row<R>(ui: &mut Ui, label: &str, add: impl FnOnce(&mut Ui) -> R) -> R {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = theme::GAP;
        let label = text(ui, label, TextStyle::Body, ui.available_width() / 2.0);
        let width = theme::LABEL.max(label.size().x + 2.0);
        let (rect, _) = ui.allocate_exact_size(vec2(width, theme::ROW), Sense::hover());
        put_text(ui, rect, label, ui.visuals().weak_text_color());
        add(ui)
    })
    .inner
}

/// Shows a row with a value that cannot be changed.
pub(crate) fn fact(ui: &mut Ui, label: &str, value: &str) {
    row(ui, label, |ui| {
        ui.add(egui::Label::new(value).truncate()).on_hover_text(value);
    });
}

/// A switch with a tick, as wide as the panel.
#[derive(Clone, Debug)]
pub(crate) struct Switch<'a> {
    pub(crate) label: &'a str,
    pub(crate) key: Option<String>,
    pub(crate) on: bool,
    /// Whether it can be clicked.
    pub(crate) enabled: bool,
}

impl<'a> Switch<'a> {
    /// Creates a switch without a key.
    pub(crate) const fn new(label: &'a str, on: bool) -> Self {
        Self { label, key: None, on, enabled: true }
    }

    /// Shows it.
    pub(crate) fn ui(self, ui: &mut Ui) -> Response {
        let Self { label, key, on, enabled } = self;
        let size = vec2(ui.available_width(), theme::ROW);
        let sense = if enabled { Sense::click() } else { Sense::hover() };
        let (rect, response) = ui.allocate_exact_size(size, sense);
        response.widget_info(|| WidgetInfo::selected(Role::CheckBox, enabled, on, label));
        let hovered = enabled && response.hovered();
        if hovered {
            ui.painter().rect_filled(rect, 4.0, ui.visuals().widgets.inactive.bg_fill);
        }
        let box_rect = Rect::from_center_size(
            pos2(rect.left() + 4.0 + 7.0, rect.center().y),
            vec2(14.0, 14.0),
        );
        tick_box(ui, box_rect, on, enabled);
        let color = text_color(ui, enabled);
        let mut right = rect.right() - 4.0;
        if let Some(key) = key {
            right = key_cap(ui, pos2(right, rect.center().y), &key, enabled) - theme::GAP;
        }
        let left = Rect::from_x_y_ranges(box_rect.right() + 7.0..=right, rect.y_range());
        put_text(ui, left, text(ui, label, TextStyle::Body, left.width()), color);
        focus_ring(ui, rect, &response);
        response
    }
}

fn tick_box(ui: &Ui, rect: Rect, on: bool, enabled: bool) {
    let visuals = ui.visuals();
    let fade = |color: Color32| if enabled { color } else { visuals.disable(color) };
    let painter = ui.painter();
    if on {
        painter.rect_filled(rect, 3.0, fade(visuals.selection.bg_fill));
        Icon::TICK.paint(painter, rect, 10.0, fade(visuals.selection.stroke.color));
    } else {
        painter.rect_filled(rect, 3.0, fade(visuals.extreme_bg_color));
    }
    let line = Stroke::new(1.0, fade(visuals.weak_text_color().gamma_multiply(0.7)));
    painter.rect_stroke(rect, 3.0, line, StrokeKind::Inside);
}

pub(crate) fn key_width(ui: &Ui, key: &str) -> f32 {
    let font = TextStyle::Monospace.resolve(ui.style());
    let galley = ui.painter().layout_no_wrap(key.to_owned(), font, Color32::WHITE);
    (galley.size().x + 8.0).max(16.0)
}

/// Draws a key cap with its right end at `at`. Returns the x position of its left end.
pub(crate) fn key_cap(ui: &Ui, at: egui::Pos2, key: &str, enabled: bool) -> f32 {
    let visuals = ui.visuals();
    let fade = |color: Color32| if enabled { color } else { visuals.disable(color) };
    let font = TextStyle::Monospace.resolve(ui.style());
    let color = fade(visuals.weak_text_color());
    let galley = ui.painter().layout_no_wrap(key.to_owned(), font, color);
    let size = vec2(key_width(ui, key), 16.0);
    let rect = Rect::from_min_size(at - vec2(size.x, size.y / 2.0), size);
    ui.painter().rect_filled(rect, 3.0, fade(visuals.extreme_bg_color));
    let line = Stroke::new(1.0, fade(theme::line(visuals)));
    ui.painter().rect_stroke(rect, 3.0, line, StrokeKind::Inside);
    ui.painter().galley(rect.center() - galley.size() / 2.0, galley, color);
    rect.left()
}

/// One of several options that exclude one another.
#[derive(Clone, Debug)]
pub(crate) struct Choice<'a> {
    pub(crate) label: &'a str,
    /// Its name for screen readers.
    pub(crate) name: String,
    pub(crate) key: Option<String>,
    pub(crate) on: bool,
    /// The reason why it cannot be chosen, if any.
    pub(crate) refused: Option<String>,
    /// An explanation for the tooltip.
    pub(crate) hint: &'a str,
}

impl<'a> Choice<'a> {
    /// Creates an option. `of` names the group for screen readers.
    pub(crate) fn new(of: &str, label: &'a str, on: bool, hint: &'a str) -> Self {
        let name = format!("{of}: {label}");
        Self { label, name, key: None, on, refused: None, hint }
    }
}

/// Shows options in one row. Returns the index of a clicked option that was not chosen yet.
pub(crate) fn choices(ui: &mut Ui, choices: &[Choice<'_>]) -> Option<usize> {
    choices_in(ui, choices, choices.len().max(1))
}

/// Shows options in as many rows as their labels need.
pub(crate) fn choices_in_rows(ui: &mut Ui, choices: &[Choice<'_>]) -> Option<usize> {
    let columns = columns(ui, choices);
    choices_in(ui, choices, columns)
}

/// Shows options with values and hints in one row. `of` names the group for screen readers, and
/// `now` is the chosen value, unless the choice is mixed. Returns the value of an option that was
/// clicked.
pub(crate) fn choose<T: Copy + PartialEq>(
    ui: &mut Ui,
    of: &str,
    now: T,
    all: &[(impl AsRef<str>, T, impl AsRef<str>)],
) -> Option<T> {
    choices(ui, &options(ui, of, now, all)).map(|clicked| all[clicked].1)
}

/// Shows options as [`choose`] does, in as many rows as their labels need.
pub(crate) fn choose_in_rows<T: Copy + PartialEq>(
    ui: &mut Ui,
    of: &str,
    now: T,
    all: &[(impl AsRef<str>, T, impl AsRef<str>)],
) -> Option<T> {
    choices_in_rows(ui, &options(ui, of, now, all)).map(|clicked| all[clicked].1)
}

fn options<'a, T: Copy + PartialEq>(
    ui: &Ui,
    of: &str,
    now: T,
    all: &'a [(impl AsRef<str>, T, impl AsRef<str>)],
) -> Vec<Choice<'a>> {
    let now = (!is_mixed(ui.ctx(), of)).then_some(now);
    let option = |(label, value, hint): &'a (_, T, _)| {
        Choice::new(of, AsRef::as_ref(label), now == Some(*value), AsRef::as_ref(hint))
    };
    all.iter().map(option).collect()
}

fn choices_in(ui: &mut Ui, choices: &[Choice<'_>], columns: usize) -> Option<usize> {
    let rows = u16::try_from(choices.len().div_ceil(columns)).unwrap_or(1);
    let size = vec2(ui.available_width(), f32::from(rows) * theme::ROW);
    let (all, _) = ui.allocate_exact_size(size, Sense::hover());
    ui.painter().rect_filled(all, 4.0, ui.visuals().widgets.inactive.bg_fill);
    let mut clicked = None;
    let mut at = all.left_top();
    // The group is one stop of Tab: the arrow keys move between the options.
    let ids: Vec<Id> = choices.iter().map(|choice| ui.scope_id().with(&choice.name)).collect();
    let chosen = choices.iter().position(|choice| choice.on);
    let stop = regions::stop(ui, &ids, chosen, columns);
    for (i, choice) in choices.iter().enumerate() {
        // Each option gets an equal share of the rest of its row, so rounding leaves no gap at the
        // end.
        let in_row = columns.min(choices.len() - i / columns * columns);
        let rest = u16::try_from(in_row - i % columns).unwrap_or(1);
        let width = ((all.right() - at.x) / f32::from(rest)).round();
        let rect = Rect::from_min_size(at, vec2(width, theme::ROW));
        at.x += width;
        if rest == 1 {
            at = pos2(all.left(), at.y + theme::ROW);
        }
        let shown = choice_ui(ui, rect, choice, i == stop);
        if shown.clicked() && !choice.on && choice.refused.is_none() {
            clicked = Some(i);
        }
    }
    clicked
}

/// Returns the number of options in a row, such that each has room for its label.
fn columns(ui: &Ui, choices: &[Choice<'_>]) -> usize {
    let width = |choice: &Choice<'_>| {
        text(ui, choice.label, TextStyle::Body, f32::INFINITY).size().x + 2.0 * ROOM
    };
    let widest = choices.iter().map(width).fold(1.0, f32::max);
    let fits =
        |n: &usize| u16::try_from(*n).is_ok_and(|n| f32::from(n) * widest <= ui.available_width());
    let all = choices.len().max(1);
    let most = (1..=all).rev().find(fits).unwrap_or(1);
    // Rows are as even as possible.
    all.div_ceil(all.div_ceil(most))
}

/// The space on either side of a label.
const ROOM: f32 = 4.0;

fn choice_ui(ui: &Ui, rect: Rect, choice: &Choice<'_>, is_stop: bool) -> Response {
    let enabled = choice.refused.is_none();
    // An unavailable option still takes the focus, so screen readers can read the reason.
    let sense = if enabled { Sense::click() } else { Sense::focusable_noninteractive() };
    let sense = regions::sense(sense, is_stop);
    let response = ui.interact(rect, ui.scope_id().with(&choice.name), sense);
    let info = || WidgetInfo::selected(Role::RadioButton, enabled, choice.on, &choice.name);
    response.widget_info(info);
    let visuals = ui.visuals();
    let painter = ui.painter();
    let mut color = text_color(ui, enabled);
    if choice.on {
        painter.rect_filled(rect, 4.0, visuals.selection.bg_fill);
        // A bar as well, for users who do not see the colour.
        let bar = Rect::from_min_max(rect.left_bottom() - vec2(-6.0, 2.0), rect.right_bottom());
        painter.rect_filled(bar.with_max_x(rect.right() - 6.0), 1.0, theme::accent(visuals));
        color = visuals.selection.stroke.color;
    } else if enabled && response.hovered() {
        painter.rect_filled(rect, 4.0, visuals.widgets.hovered.bg_fill);
    }
    // The label and the key are centred together.
    let key_font = TextStyle::Monospace.resolve(ui.style());
    let key = choice.key.clone().filter(|_| !choice.on).unwrap_or_default();
    let key = painter.layout_no_wrap(key, key_font, color);
    let gap = if key.size().x > 0.0 { 5.0 } else { 0.0 };
    let room = rect.width() - 2.0 * ROOM;
    let label = text(ui, choice.label, TextStyle::Body, room);
    // If space is short, the key is left out first.
    let show_key = label.size().x + gap + key.size().x <= room;
    let width = label.size().x + if show_key { gap + key.size().x } else { 0.0 };
    let at = rect.center() - vec2(width / 2.0, label.size().y / 2.0);
    let end = at.x + label.size().x + gap;
    painter.galley_with_override_text_color(at, label, color);
    if show_key {
        let at = pos2(end, rect.center().y - key.size().y / 2.0);
        painter.galley_with_override_text_color(at, key, color.gamma_multiply(0.75));
    }
    focus_ring(ui, rect, &response);
    response.on_hover_ui(|ui| {
        ui.label(choice.hint);
        if let Some(key) = &choice.key {
            ui.weak(format!("Key: {key}"));
        }
        if let Some(why) = &choice.refused {
            ui.label(format!("Unavailable: {why}."));
        }
    })
}

/// Shows a small button with an icon. The first line of its tooltip is its name.
pub(crate) fn icon_button(ui: &mut Ui, icon: Icon, name: &str, enabled: bool) -> Response {
    let sense = if enabled { Sense::click() } else { Sense::hover() };
    let (rect, response) = ui.allocate_exact_size(vec2(theme::ROW, theme::ROW), sense);
    icon_at(ui, rect, &response, icon, name, enabled);
    response
}

/// Draws a button with an icon in `rect` for an existing response.
pub(crate) fn icon_at(
    ui: &Ui,
    rect: Rect,
    response: &Response,
    icon: Icon,
    name: &str,
    enabled: bool,
) {
    response.widget_info(|| WidgetInfo::labeled(Role::Button, enabled, name));
    let hovered = enabled && response.hovered();
    if hovered {
        ui.painter().rect_filled(rect, 4.0, ui.visuals().widgets.hovered.bg_fill);
    }
    let color = match (hovered, enabled) {
        (true, _) => ui.visuals().strong_text_color(),
        (false, true) => ui.visuals().weak_text_color(),
        (false, false) => ui.visuals().disable(ui.visuals().weak_text_color()),
    };
    icon.paint(ui.painter(), rect, 12.0, color);
    focus_ring(ui, rect, response);
}

/// Draws the ring around the control with keyboard focus.
pub(crate) fn focus_ring(ui: &Ui, rect: Rect, response: &Response) {
    if response.has_focus() {
        let ring = theme::ring(ui.visuals());
        ui.painter().rect_stroke(rect, 4.0, ring, StrokeKind::Inside);
    }
}

/// Returns the colour of text on a control.
pub(crate) fn text_color(ui: &Ui, enabled: bool) -> Color32 {
    let color = ui.visuals().text_color();
    if enabled { color } else { ui.visuals().disable(color) }
}

/// Gives a button the keyboard, so Enter presses it, unless another control of the dialog has it.
pub(crate) fn take_focus(ui: &Ui, button: &Response) {
    let layer = ui.layer_id();
    let here = |id: Id| ui.ctx().read_response(id).is_some_and(|it| it.layer_id == layer);
    if !ui.memory(egui::Memory::focused).is_some_and(here) {
        button.request_focus();
    }
}

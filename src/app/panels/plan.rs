//! The plan panel: each effect of the picture, whether it is on, why, and its cost.
//!
//! Each effect has a line, with lines for its items below it if they differ. Effects that are on
//! have a full disk and strong text; the disk of a light or of its shadows is a switch. Costs are
//! numbers with bars, so the largest is easy to see. Beside each time stands what the picture loses
//! without the effect, and what no one would miss can be switched off together.

use std::collections::BTreeSet;
use std::sync::Arc;

use egui::{
    Align2, Color32, Id, Rect, RichText, ScrollArea, Sense, TextStyle, Ui, WidgetInfo, pos2, vec2,
};

use crate::app::actions::{Action, Request, Requests};
use crate::app::state::{Measured, State};
use crate::app::theme;
use crate::app::widgets::controls;
use crate::app::widgets::icons::Icon;
use crate::app::widgets::regions;
use crate::app::widgets::text::grouped;
use marraztu_core::edit::{Change, Gesture, items, lights};
use marraztu_core::scene::{Command, ItemId, Scene};
use marraztu_lab::cost::{Cost, Explained, Group};
use marraztu_lab::dial::error_in_words;
use marraztu_lab::estimate::Estimate;
use marraztu_render::{Effect, EffectUse, PathPixels};

pub(crate) fn show(ui: &mut Ui, state: &State, requests: &mut Requests) {
    let Some(explained) = state.plan.explained.clone() else {
        ui.add(egui::Label::new("The plan appears with the next picture.").wrap());
        return;
    };
    header_ui(ui, state, requests, &explained);
    controls::no_narrower(ui, LEAST, |ui| table_ui(ui, state, requests, &explained));
}

/// The width of the Measure button.
const BUTTON: f32 = 70.0;

/// Narrower panels scroll the table sideways.
const LEAST: f32 = 400.0;

/// Narrower panels have narrower columns.
const ROOMY: f32 = 540.0;

/// Shows the summary and the Measure button.
fn header_ui(ui: &mut Ui, state: &State, requests: &mut Requests, explained: &Explained) {
    ui.horizontal(|ui| {
        ui.set_min_height(theme::ROW);
        let title = ui.label(RichText::new("Plan").strong());
        ui.add_space(theme::GAP);
        let summary = RichText::new(summary(explained)).weak();
        let text = controls::text(ui, summary.clone(), TextStyle::Body, f32::INFINITY);
        // In a narrow window, the button takes the place of the summary.
        let room = ui.available_width() - BUTTON - 2.0 * f32::from(theme::MARGIN);
        let label = if text.size().x <= room { ui.label(summary) } else { title };
        label.on_hover_text("Leaving effects out does not change a single bit of the picture.");
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            ui.add_space(f32::from(theme::MARGIN));
            let label = if state.plan.measuring { "Stop" } else { "Measure" };
            let button = ui.add(egui::Button::new(label).min_size(vec2(BUTTON, theme::ROW)));
            if Action::MeasurePlan.explain(button, state).clicked() {
                requests.push(Action::MeasurePlan.into());
            }
            if state.plan.measuring {
                ui.add(egui::Spinner::new().size(14.0));
            } else if let Some(measured) = &state.plan.costs {
                let is_of_now = is_of_now(measured, state);
                if is_of_now {
                    drop_ui(ui, (state, requests), (explained, measured));
                }
                times_ui(ui, measured, is_of_now);
            }
        });
    });
    ui.add_space(2.0);
}

fn times_ui(ui: &mut Ui, measured: &Measured, now: bool) {
    let costs = &measured.costs;
    let text = if now {
        format!("{:.2} ms a frame, noise {:.2} ms", costs.frame, costs.noise)
    } else {
        "measured before the last change".to_owned()
    };
    ui.weak(text).on_hover_text(
        "Milliseconds are medians over pairs of frames, one with an effect and one without it. \
        The noise is the difference between two equal frames.",
    );
}

/// Shows the button that switches off what no one would miss.
fn drop_ui(
    ui: &mut Ui,
    (state, requests): (&State, &mut Requests),
    (explained, measured): (&Explained, &Measured),
) {
    let unseen = measured.costs.effects.iter().filter(|cost| !cost.missed.is_seen());
    let unseen: Vec<Effect> = unseen.map(|cost| cost.effect).collect();
    // A light that is off casts no shadows.
    let is_off = |effect: Effect| match effect {
        Effect::Shadows(id) => unseen.contains(&Effect::Light(id)),
        _ => false,
    };
    let unseen = unseen.iter().filter(|effect| !is_off(**effect)).filter_map(|effect| {
        let group = explained.groups().find(|group| group.effect == *effect)?;
        Some((group.uses[0].name.clone(), switched(&state.scene, *effect)?.ok()?))
    });
    let (names, commands): (Vec<String>, Vec<Command>) = unseen.unzip();
    if names.is_empty() {
        return;
    }
    let button = ui.button(format!("Drop unseen ({})", names.len()));
    let hint = format!("Switches off what no one would see missing here: {}.", names.join(", "));
    if button.on_hover_text(hint).clicked() {
        let all = Ok(Command::Batch(commands));
        requests.push(Request::change("Drop what no one sees", Gesture::Whole, all));
    }
}

/// Returns the change that switches an effect on or off; `None` if it has no switch of its own.
fn switched(scene: &Scene, effect: Effect) -> Option<Change> {
    match effect {
        Effect::Light(id) => Some(items::toggle_shown(scene, ItemId::Light(id))),
        Effect::Shadows(id) => Some(lights::toggle_shadows(scene, id)),
        _ => None,
    }
}

fn summary(explained: &Explained) -> String {
    let on = explained.uses.iter().filter(|one| one.state.is_on()).count();
    let left_out = explained.uses.len() - on;
    format!("{on} on; {left_out} left out without changing a bit")
}

/// Returns whether the measurement belongs to the picture in the viewport.
fn is_of_now(measured: &Measured, state: &State) -> bool {
    measured.of == state.shot(measured.of.size)
}

/// The rectangles of the columns in a row.
struct Columns {
    name: Rect,
    on: Rect,
    why: Rect,
    /// Measured, a narrow panel has no room for it.
    pixels: Option<Rect>,
    time: Rect,
    /// What the picture loses without the effect, if it is measured.
    missed: Option<Rect>,
}

impl Columns {
    fn of(row: Rect, is_measured: bool) -> Self {
        let is_roomy = row.width() >= ROOMY;
        let number = if is_roomy { 92.0 } else { 68.0 };
        let shares = if is_roomy { [0.34, 0.26] } else { [0.37, 0.35] };
        let right = row.right() - 4.0;
        let shows_pixels = is_roomy || !is_measured;
        let numbers = 1.0 + f32::from(shows_pixels) + f32::from(is_measured);
        let text = (right - numbers * number - row.left()).max(120.0);
        let [name, on] = shares.map(|share| (text * share).min(220.0));
        let column = |left: f32, width: f32| {
            Rect::from_min_max(pos2(left, row.top()), pos2(left + width - 8.0, row.bottom()))
        };
        let left = row.left();
        // The last column ends with the row.
        let last = |is_last: bool| if is_last { number + 8.0 } else { number };
        Self {
            name: column(left, name),
            on: column(left + name, on),
            why: column(left + name + on, text - name - on),
            pixels: shows_pixels.then(|| column(right - numbers * number, number)),
            time: column(right - (1.0 + f32::from(is_measured)) * number, last(!is_measured)),
            missed: is_measured.then(|| column(right - number, last(true))),
        }
    }
}

fn table_ui(ui: &mut Ui, state: &State, requests: &mut Requests, explained: &Explained) {
    let times = state.plan.costs.as_ref().filter(|measured| is_of_now(measured, state));
    let (head, _) = ui.allocate_exact_size(vec2(ui.available_width(), 16.0), Sense::hover());
    let own = head.with_max_x(head.right() - f32::from(theme::MARGIN));
    let columns = Columns::of(own, times.is_some());
    // Headings of text columns are left-aligned, of numbers right-aligned.
    let titles = [
        (Some(columns.name), "Effect"),
        (Some(columns.on), "Item"),
        (Some(columns.why), "Reason"),
        (columns.pixels, "Pixels"),
        (Some(columns.time), if columns.time.width() < 80.0 { "ms" } else { "Milliseconds" }),
        (columns.missed, "Missed"),
    ];
    let weak = ui.visuals().weak_text_color();
    for (i, (rect, title)) in titles.into_iter().enumerate() {
        let Some(rect) = rect else { continue };
        let title = controls::text(ui, title, TextStyle::Small, rect.width());
        let left = if i < 3 { rect.left() } else { rect.right() - title.size().x };
        controls::put_text(ui, rect.with_min_x(left), title, weak);
    }
    let line = egui::Stroke::new(1.0, theme::line(ui.visuals()));
    ui.painter().hline(head.x_range(), head.bottom(), line);

    let id = Id::unique("plan: unfolded");
    let mut open: BTreeSet<Effect> = ui.data(|data| data.get_temp(id)).unwrap_or_default();
    // The bars of all groups have one scale.
    let most = explained.groups().filter_map(|group| group.pixels()).max().unwrap_or(0);
    let area = ScrollArea::vertical().id_salt("plan").auto_shrink(false);
    area.content_margin(theme::SCROLL_MARGIN).show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        for group in explained.groups() {
            let is_open = open.contains(&group.effect);
            let paths = explained.paths.filter(|_| group.effect == Effect::Surfaces);
            if group_ui(ui, (state, requests), (most, times), (&group, paths), is_open) {
                if is_open {
                    open.remove(&group.effect);
                } else {
                    open.insert(group.effect);
                }
            }
            if is_open && !group.is_alike() {
                for one in group.uses {
                    use_ui(ui, (most, times.is_some()), one);
                }
            }
        }
        regions::follow_focus(ui);
    });
    ui.data_mut(|data| data.insert_temp(id, open));
}

/// Shows the line of an effect. Returns whether it was clicked.
fn group_ui(
    ui: &mut Ui,
    (state, requests): (&State, &mut Requests),
    (most, times): (u64, Option<&Arc<Measured>>),
    (group, paths): (&Group<'_>, Option<PathPixels>),
    is_open: bool,
) -> bool {
    let first = &group.uses[0];
    let folds = !group.is_alike();
    let things = group.of();
    let why = if folds { String::new() } else { first.state.to_string() };
    let row = Row {
        name: &first.name,
        indent: 0.0,
        chevron: folds.then_some(is_open),
        on: group.on() > 0,
        things: &things,
        why: &why,
        more: paths.as_ref().map(coloured_by),
        pixels: group.pixels(),
        most,
        is_measured: times.is_some(),
    };
    let (rect, response) = row.ui(ui);
    if let Some(Ok(command)) = switched(&state.scene, group.effect)
        && row.switch_ui(ui, rect, group.effect)
    {
        let label = format!("Switch {} {}", first.name, if row.on { "off" } else { "on" });
        requests.push(Request::change(label, Gesture::Whole, Ok(command)));
    }
    if let Some((measured, cost)) =
        times.and_then(|measured| Some((measured, measured.costs.of(group.effect)?)))
    {
        let Columns { time: column, missed, .. } = Columns::of(rect, true);
        if let Some(column) = missed {
            missed_ui(ui, column, cost);
        }
        if measured.costs.is_clear(cost) {
            let part = cost.milliseconds / measured.costs.frame;
            number_ui(ui, column, &format!("{:.2}", cost.milliseconds), part, true);
        } else {
            number_ui(ui, column, "noise", 0.0, false);
        }
    }
    folds && response.clicked()
}

/// Says how the pixels got their colours.
fn coloured_by(paths: &PathPixels) -> String {
    let used = paths.rows().into_iter().filter(|(.., pixels)| *pixels > 0);
    let lines = used.map(|(name, reason, pixels)| {
        let pixels = grouped(usize::try_from(pixels).unwrap_or(usize::MAX));
        format!("{name}: {pixels} pixels, {reason}")
    });
    lines.collect::<Vec<_>>().join("\n")
}

/// Shows what the picture loses without an effect.
fn missed_ui(ui: &Ui, column: Rect, cost: &Cost) {
    let error = error_in_words(&Estimate::exact(cost.missed.rmse)).unwrap_or_default();
    if cost.missed.is_seen() {
        number_ui(ui, column, &error, cost.missed.rmse / 255.0, true);
    } else {
        number_ui(ui, column, "unseen", 0.0, false);
    }
    let hint = format!(
        "Without it, the picture differs by {error} of 255 on average (RMSE), and by {:.2} of \
         1 in a pixel as seen by the eye (FLIP); less than 0.1 is not seen.",
        cost.missed.flip
    );
    let id = ui.scope_id().with(("missed", cost.effect.label(), column.top().to_bits()));
    ui.interact(column, id, Sense::hover()).on_hover_text(hint);
}

fn use_ui(ui: &mut Ui, (most, is_measured): (u64, bool), one: &EffectUse) {
    let row = Row {
        name: "",
        indent: 16.0,
        chevron: None,
        on: one.state.is_on(),
        things: one.on.as_ref().map_or("the frame", |thing| &thing.name),
        why: &one.state.to_string(),
        more: None,
        pixels: one.pixels,
        most,
        is_measured,
    };
    row.ui(ui);
}

/// The distance of a disk from the left end of its line.
const MARK: f32 = 12.0;

/// A line of the table.
struct Row<'a> {
    name: &'a str,
    indent: f32,
    /// Whether it is unfolded; `None` if it cannot be unfolded.
    chevron: Option<bool>,
    on: bool,
    things: &'a str,
    why: &'a str,
    /// What its hint says more than the cell.
    more: Option<String>,
    pixels: Option<u64>,
    /// The largest number of pixels in the table.
    most: u64,
    /// Whether the table has times.
    is_measured: bool,
}

impl Row<'_> {
    fn ui(&self, ui: &mut Ui) -> (Rect, egui::Response) {
        let sense = if self.chevron.is_some() { Sense::click() } else { Sense::hover() };
        let size = vec2(ui.available_width(), theme::ROW - 2.0);
        let (rect, response) = ui.allocate_exact_size(size, sense);
        let spoken = self.spoken();
        response.widget_info(|| WidgetInfo::labeled(egui::Role::Row, true, &spoken));
        if !ui.is_rect_visible(rect) {
            return (rect, response);
        }
        if response.hovered() {
            ui.painter().rect_filled(rect, 3.0, ui.visuals().widgets.inactive.bg_fill);
        }
        let visuals = ui.visuals();
        let color = if self.on { visuals.text_color() } else { visuals.weak_text_color() };
        let columns = Columns::of(rect, self.is_measured);
        let middle = rect.center().y;
        let mark = columns.name.left() + MARK;
        if let Some(is_open) = self.chevron {
            let icon = if is_open { Icon::DOWN } else { Icon::RIGHT };
            let at =
                Rect::from_center_size(pos2(columns.name.left() + 4.0, middle), vec2(8.0, 8.0));
            icon.paint(ui.painter(), at, 8.0, color);
        }
        // The disk is next to the effect's name, or next to the item's name in the lines below.
        let disk = if self.name.is_empty() { columns.on.left() + 5.0 } else { mark + 6.0 };
        disk_ui(ui, pos2(disk, middle), self.on);
        let put = |rect: Rect, left: f32, text: &str, color: Color32| {
            let rect = rect.with_min_x(left);
            let text = controls::text(ui, text, TextStyle::Body, rect.width());
            controls::put_text(ui, rect, text, color);
        };
        put(columns.name, mark + 16.0, self.name, color);
        put(columns.on, columns.on.left() + self.indent, self.things, color);
        put(columns.why, columns.why.left(), self.why, ui.visuals().weak_text_color());
        if let Some((pixels, column)) = self.pixels.filter(|_| self.on).zip(columns.pixels) {
            #[expect(clippy::cast_precision_loss, reason = "for the eye")]
            let part = pixels as f64 / self.most.max(1) as f64;
            let text = grouped(usize::try_from(pixels).unwrap_or(usize::MAX));
            number_ui(ui, column, &text, part, true);
        }
        controls::focus_ring(ui, rect, &response);
        let tip = if self.why.is_empty() { self.things } else { self.why };
        let tip = match &self.more {
            Some(more) => format!("{tip}\n{more}"),
            None => tip.to_owned(),
        };
        (rect, response.on_hover_text_at_pointer(tip))
    }

    /// Makes the disk of the line a switch. Returns whether it was clicked.
    fn switch_ui(&self, ui: &Ui, line: Rect, effect: Effect) -> bool {
        let at = pos2(line.left() + MARK + 6.0, line.center().y);
        let square = Rect::from_center_size(at, vec2(18.0, line.height()));
        let response = ui.interact(square, Id::unique(("switch", effect)), Sense::click());
        let name = format!("Switch {}", self.name);
        response.widget_info(|| WidgetInfo::selected(egui::Role::CheckBox, true, self.on, &name));
        if response.hovered() || response.has_focus() {
            let line = egui::Stroke::new(1.0, ui.visuals().text_color());
            ui.painter().circle_stroke(at, 6.5, line);
        }
        let hint = format!("Switch {} {}", self.name, if self.on { "off" } else { "on" });
        response.on_hover_text(hint).clicked()
    }

    fn spoken(&self) -> String {
        let state = if self.on { "on" } else { "left out" };
        let mut spoken = format!("{} {state}, {}", self.name, self.things);
        if !self.why.is_empty() {
            spoken += &format!(": {}", self.why);
        }
        spoken.trim_start().to_owned()
    }
}

/// Draws a disk: full if an effect is on, empty if it is left out.
fn disk_ui(ui: &Ui, at: egui::Pos2, on: bool) {
    let visuals = ui.visuals();
    if on {
        ui.painter().circle_filled(at, 4.0, theme::accent(visuals));
    } else {
        let line = egui::Stroke::new(1.0, visuals.weak_text_color());
        ui.painter().circle_stroke(at, 3.5, line);
    }
}

/// Draws a right-aligned number over a bar of its share.
fn number_ui(ui: &Ui, column: Rect, text: &str, part: f64, strong: bool) {
    let visuals = ui.visuals();
    let color = if strong { visuals.text_color() } else { visuals.weak_text_color() };
    #[expect(clippy::cast_possible_truncation, reason = "for the eye")]
    let part = part.clamp(0.0, 1.0) as f32;
    if part > 0.0 {
        let right = column.right();
        let bar = Rect::from_min_max(
            pos2(right - column.width() * part, column.bottom() - 3.0),
            pos2(right, column.bottom() - 1.0),
        );
        ui.painter().rect_filled(bar, 1.0, theme::accent(visuals).gamma_multiply(0.8));
    }
    let font = TextStyle::Body.resolve(ui.style());
    let at = pos2(column.right(), column.center().y - 1.0);
    ui.painter().text(at, Align2::RIGHT_CENTER, text, font, color);
}

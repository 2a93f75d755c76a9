//! The dial: what accuracy costs in this view, over the picture and always visible.
//!
//! Each row is a preset with the time and the error of its picture; a further row has the user's
//! own settings, if there are any. The editor measures them while nothing happens; until then, the
//! figures are grey. Bars show how times rise, in powers of ten, and errors fall. A click draws
//! with the settings of a row. Below them is a line from quick to exact, on which one drags: all
//! settings that no other ones beat in this view. Over a low picture, the dial is one row, which
//! unfolds the others.

use std::time::Duration;

use egui::{Align2, Area, ComboBox, Frame, Id, Order, Rect, RichText, Role, Sense};
use egui::{TextStyle, Ui, WidgetInfo, pos2, vec2};

use crate::app::actions::{Action, Request, Requests};
use crate::app::input::buttons::first_key;
use crate::app::state::State;
use crate::app::state::laboratory::Compare;
use crate::app::theme;
use crate::app::widgets::controls::{self, focus_ring, icon_at, put_text, right_text, row_ground};
use crate::app::widgets::icons::Icon;
use crate::app::widgets::regions;
use marraztu_core::accuracy::{ACCURACY_PRESETS, AccuracyPreset, Settings};
use marraztu_lab::dial::{Figures, error_in_words, in_words, is_steady};
use marraztu_lab::estimate::Estimate;

const WIDTH: f32 = 284.0;

/// The distance from the left edge of the picture at which other panels may begin.
pub(super) const RIGHT: f32 = WIDTH + 36.0;

/// The right ends of the columns of samples, time and error.
const COLUMNS: [f32; 3] = [134.0, 200.0, WIDTH - 6.0];

/// The length of the longest bar, and the powers of ten of the bar of the shortest time.
const BAR: f32 = 46.0;
const SHORTEST: f64 = 0.5;

/// The height of the line from quick to exact, and the radius of its points.
const LINE: f32 = 66.0;
const POINT: f32 = 3.5;

/// The dial is hidden over a smaller picture.
const LEAST: egui::Vec2 = vec2(400.0, 100.0);

/// The greatest height of the dial when it unfolds.
const UNFOLDED: f32 = 300.0;

/// Over a lower picture, the dial is one row until it is clicked.
const LOW: f32 = 400.0;

pub(crate) fn show(ui: &Ui, picture: Rect, state: &State, requests: &mut Requests) {
    let is_small = picture.width() < LEAST.x || picture.height() < LEAST.y;
    // A comparison has its own labels there.
    if !state.shows_dial() || is_small || state.lab.compare != Compare::Off {
        return;
    }
    let is_low = picture.height() < LOW;
    let area = Area::new(Id::unique("dial")).order(Order::Middle).constrain_to(picture);
    let at = picture.left_top() + vec2(8.0, 8.0);
    area.pivot(Align2::LEFT_TOP).fixed_pos(at).show(ui.ctx(), |ui| {
        Frame::popup(ui.style()).inner_margin(6.0).show(ui, |ui| {
            regions::begin(ui, "dial");
            ui.set_width(WIDTH);
            ui.spacing_mut().item_spacing.y = 0.0;
            if is_low {
                folded_ui(ui, state, requests);
            } else {
                contents(ui, state, requests);
            }
            regions::follow_focus(ui);
        });
    });
}

/// Pictures that take longer show their progress over the picture.
const SLOW: Duration = Duration::from_secs(1);

/// Shows the progress of a slow picture, with a button that returns to the settings before.
pub(crate) fn progress_ui(ui: &Ui, picture: Rect, state: &State, requests: &mut Requests) {
    let Some(late) = state.statistics.late.filter(|late| late.spent >= SLOW) else { return };
    let now = state.settings;
    let before = state.dial.drawn.filter(|before| *before != now).unwrap_or_default();
    let area = Area::new(Id::unique("slow picture")).order(Order::Middle).constrain_to(picture);
    let at = picture.center_bottom() - vec2(0.0, 12.0);
    area.pivot(Align2::CENTER_BOTTOM).fixed_pos(at).show(ui.ctx(), |ui| {
        Frame::popup(ui.style()).show(ui, |ui| {
            ui.horizontal(|ui| {
                let rows = rows(state);
                let label = rows.iter().find(|row| row.settings == now).map_or("", |row| row.label);
                ui.label(format!("Drawing {label}: {}", late.in_words()));
                let hint = format!("Returns to the settings before: {}", before.in_words());
                let cancel = ui.add_enabled(before != now, egui::Button::new("Cancel"));
                if cancel.on_hover_text(hint).clicked() {
                    requests.push(Request::Settings(before.modelled_as(&now)));
                }
            });
        });
    });
}

/// Shows the row of the current settings, which unfolds the others.
fn folded_ui(ui: &mut Ui, state: &State, requests: &mut Requests) {
    let rows = rows(state);
    let on = rows.iter().find(|row| row.settings == state.settings);
    let mut text = RichText::new(on.map_or_else(|| "Accuracy".to_owned(), |row| row.name(state)));
    if !state.dial.current {
        text = text.weak();
    }
    let combo = ComboBox::from_id_salt("presets").selected_text(text).width(WIDTH);
    let combo = combo.height(UNFOLDED).show_ui(ui, |ui| {
        ui.set_width(WIDTH);
        contents(ui, state, requests);
    });
    let hint = "Accuracy: what it costs in this view. Click to see every preset.";
    combo.response.accessible_name("Accuracy").on_hover_text(hint);
}

fn contents(ui: &mut Ui, state: &State, requests: &mut Requests) {
    head_ui(ui, state, requests);
    let rows = rows(state);
    let ids: Vec<Id> = rows.iter().map(|row| ui.scope_id().with(row.label)).collect();
    let on = rows.iter().position(|row| row.settings == state.settings);
    let stop = regions::stop(ui, &ids, on, 1);
    for (i, row) in rows.iter().enumerate() {
        if row.ui(ui, state, (ids[i], i == stop)) && on != Some(i) {
            let chosen = row.action.map_or(Request::Settings(row.settings), Request::Do);
            requests.push(chosen);
        }
    }
    // What the figures mean, in a sentence, or what the point of the line is that is drawn.
    let point = state.dial.on_line(&state.settings).filter(|_| on.is_none());
    let said = match &point {
        Some(figures) => Some(point_in_words(figures)),
        None => in_words(state.dial.figures()).filter(|_| state.dial.current),
    };
    let waits_for = match state.lab.running {
        Some(_) => "Paused while the laboratory measures.",
        None if state.dial.current => "Comparing parts of the pictures with the ideal...",
        None => "Measured as soon as nothing moves.",
    };
    let said = said.unwrap_or_else(|| waits_for.to_owned());
    ui.add_space(2.0);
    // Two lines high, so that the line below does not move while one drags.
    let height = 2.0 * ui.text_style_height(&TextStyle::Small);
    ui.allocate_ui(vec2(WIDTH, height), |ui| {
        ui.set_min_height(height);
        ui.add(egui::Label::new(RichText::new(said).small()).wrap());
    });
    line_ui(ui, state, requests);
}

/// Describes a point of the line.
fn point_in_words(figures: &Figures) -> String {
    let error = figures.error.and_then(|error| error_in_words(&error)).unwrap_or_default();
    let settings = figures.settings.in_words();
    format!("{}, an error of {error}: {settings}", milliseconds(&figures.ms))
}

/// Shows the line from quick to exact: to the right, the time in powers of ten; upwards, the error,
/// its root, so that small ones do not look alike. The point next to the pointer is chosen.
fn line_ui(ui: &mut Ui, state: &State, requests: &mut Requests) {
    let line = state.dial.line();
    let Some((first, last)) = line.first().zip(line.last()).filter(|_| line.len() > 1) else {
        return;
    };
    ui.add_space(4.0);
    let (rect, _) = ui.allocate_exact_size(vec2(WIDTH, LINE), Sense::hover());
    let plot = rect.shrink2(vec2(POINT + 3.0, POINT + 1.0)).with_max_y(rect.bottom() - 16.0);
    let [quick, slow] = [first, last].map(|(_, figures)| libm::log10(figures.ms.value));
    let largest = first.1.error.map_or(1.0, |error| error.value);
    #[expect(clippy::cast_possible_truncation, reason = "for the eye")]
    let place = |(_, figures): &(Settings, Figures)| {
        let across = (libm::log10(figures.ms.value) - quick) / (slow - quick);
        let error = figures.error.map_or(0.0, |error| error.value);
        let up = (error / largest).sqrt();
        plot.lerp_inside(vec2(across.clamp(0.0, 1.0) as f32, 1.0 - up.clamp(0.0, 1.0) as f32))
    };
    let places: Vec<egui::Pos2> = line.iter().map(place).collect();
    let (weak, accent) = (ui.visuals().weak_text_color(), theme::accent(ui.visuals()));
    // Dragged only: the keyboard walks along the points.
    let whole = ui.interact(rect, ui.scope_id().with("line"), Sense::DRAG);
    let painter = ui.painter();
    painter.hline(plot.x_range(), plot.bottom(), (1.0, weak.gamma_multiply(0.5)));
    painter.line(places.clone(), (1.5, accent.gamma_multiply(0.8)));
    let below = rect.with_min_y(plot.bottom() + POINT);
    for (text, align) in [("quick", Align2::LEFT_TOP), ("exact", Align2::RIGHT_TOP)] {
        let at = align.pos_in_rect(&below.shrink2(vec2(4.0, 0.0)));
        painter.text(at, align, text, TextStyle::Small.resolve(ui.style()), weak);
    }
    let now = state.dial.on_line(&state.settings).map(|figures| figures.settings);
    let on = line.iter().position(|(_, figures)| Some(figures.settings) == now);
    let mut chosen = None;
    let ids: Vec<Id> = (0..line.len()).map(|i| ui.scope_id().with(("point", i))).collect();
    let stop = regions::stop(ui, &ids, on, line.len());
    for (i, (at, (_, figures))) in places.iter().zip(&line).enumerate() {
        let is_on = on == Some(i);
        let square = Rect::from_center_size(*at, vec2(2.0 * POINT + 4.0, 2.0 * POINT + 4.0));
        let point = ui.interact(square, ids[i], regions::sense(Sense::click(), i == stop));
        let name = point_in_words(figures);
        point.widget_info(|| WidgetInfo::selected(Role::RadioButton, true, is_on, &name));
        let radius = if is_on || point.hovered() { POINT + 1.5 } else { POINT - 0.5 };
        let fill = if is_on { accent } else { ui.visuals().window_fill };
        ui.painter().circle(*at, radius, fill, (1.5, accent));
        focus_ring(ui, square, &point);
        if point.on_hover_text(name).clicked() {
            chosen = Some(i);
        }
    }
    let pointer = whole.interact_pointer_pos().filter(|_| whole.dragged());
    if let Some(pointer) = pointer {
        let far = |i: &usize| egui::emath::OrderedFloat((places[*i].x - pointer.x).abs());
        chosen = (0..places.len()).min_by_key(far);
    }
    if let Some(i) = chosen.filter(|i| on != Some(*i)) {
        requests.push(Request::Settings(line[i].0));
    }
}

/// Shows the heads of the columns, and the button of the loupe.
fn head_ui(ui: &mut Ui, state: &State, requests: &mut Requests) {
    let (rect, _) = ui.allocate_exact_size(vec2(WIDTH, theme::ROW - 2.0), Sense::hover());
    let weak = ui.visuals().weak_text_color();
    let heads = [
        ("samples", "The samples of each pixel, when nothing moves and the picture is refined"),
        ("time", "Milliseconds of this picture; ~ if other programs keep the machine too busy"),
        (
            "error",
            "How far the picture is from the ideal, on average, in steps of colours from 0 to 255 \
             (RMSE), with its 95% interval. Less than 1 is hard to see.",
        ),
    ];
    let title = controls::text(ui, "Accuracy", TextStyle::Body, 60.0);
    put_text(ui, rect.with_min_x(rect.left() + 4.0), title, weak);
    for ((head, hint), right) in heads.into_iter().zip(COLUMNS) {
        let cell = column(rect, right);
        right_text(ui, cell, head, TextStyle::Body, weak);
        ui.interact(cell, ui.scope_id().with(("head", head)), Sense::hover()).on_hover_text(hint);
    }
    let square =
        Rect::from_center_size(pos2(rect.left() + 70.0, rect.center().y), vec2(20.0, 18.0));
    let response = ui.interact(square, ui.scope_id().with("loupe"), Sense::click());
    if state.loupe {
        ui.painter().rect_filled(square, 3.0, ui.visuals().selection.bg_fill);
    }
    icon_at(ui, square, &response, Icon::LOUPE, "Loupe", true);
    let hint = "Loupe: shows the pixels under the pointer next to the ideal. Or hold the key k.";
    if response.on_hover_text(hint).clicked() {
        requests.push(Request::Do(Action::ToggleLoupe));
    }
}

struct Row {
    label: &'static str,
    hint: String,
    settings: Settings,
    /// The action that chooses the settings, if they are a preset.
    action: Option<Action>,
}

/// Returns the presets, and the user's own settings.
fn rows(state: &State) -> Vec<Row> {
    let presets = AccuracyPreset::dial().iter().zip(Action::DIAL).map(|(preset, action)| Row {
        label: preset.label,
        hint: preset.what.to_owned(),
        settings: preset.of(&state.settings),
        action: Some(action),
    });
    let own = state.dial.own.map(|own| {
        let settings = own.modelled_as(&state.settings);
        let preset = ACCURACY_PRESETS.iter().find(|preset| preset.of(&settings) == settings);
        let hint = format!("The settings of this scene: {}.", settings.in_words());
        Row { label: preset.map_or("Custom", |preset| preset.label), hint, settings, action: None }
    });
    presets.chain(own).collect()
}

impl Row {
    /// Returns the label, with the figures if they are measured.
    fn name(&self, state: &State) -> String {
        let [_, time, error] = self.texts(state);
        let samples = state.dial.at_rest(&self.settings, state).samples_in_words();
        match state.dial.of(&self.settings) {
            Some(Figures { error: Some(_), .. }) => {
                format!("{}, {samples}: {time}, error {error}", self.label)
            }
            _ => self.label.to_owned(),
        }
    }

    /// Returns the samples, the time and the error of the picture.
    fn texts(&self, state: &State) -> [String; 3] {
        let unknown = || "...".to_owned();
        let samples = state.dial.at_rest(&self.settings, state).samples_in_words();
        let samples = samples.split(' ').next().unwrap_or_default().to_owned();
        let figures = state.dial.of(&self.settings);
        let time = figures.map_or_else(unknown, |it| milliseconds(&it.ms));
        let error = figures.and_then(|it| error_in_words(&it.error?));
        [samples, time, error.unwrap_or_else(unknown)]
    }

    /// Returns the lengths of the bars under samples, time and error, from 0 to 1.
    #[expect(clippy::cast_possible_truncation, reason = "for the eye")]
    fn bars(&self, state: &State) -> [Option<f32>; 3] {
        let figures = state.dial.figures();
        let Some(own) = state.dial.of(&self.settings).filter(|_| state.dial.current) else {
            return [None; 3];
        };
        let times = || figures.iter().map(|it| it.ms.value).filter(|ms| *ms > 0.0);
        let [least, most] =
            [times().fold(f64::INFINITY, f64::min), times().fold(0.0, f64::max)].map(libm::log10);
        // The shortest time has a short bar, too.
        let time = (libm::log10(own.ms.value) - least + SHORTEST) / (most - least + SHORTEST);
        let errors = figures.iter().filter_map(|it| it.error);
        let largest = errors.map(|error| error.value).fold(0.0, f64::max);
        let error = own.error.map(|error| error.value / largest);
        let part = |part: f64| part.is_finite().then(|| part.clamp(0.0, 1.0) as f32);
        [None, part(time), error.and_then(part)]
    }

    /// Shows the row. Returns whether it was clicked.
    fn ui(&self, ui: &mut Ui, state: &State, (id, is_stop): (Id, bool)) -> bool {
        let is_on = self.settings == state.settings;
        let (rect, _) = ui.allocate_exact_size(vec2(WIDTH, theme::ROW - 2.0), Sense::hover());
        let response = ui.interact(rect, id, regions::sense(Sense::click(), is_stop));
        let (texts, name) = (self.texts(state), self.name(state));
        response.widget_info(|| WidgetInfo::selected(Role::RadioButton, true, is_on, &name));
        let ink = row_ground(ui, &response, is_on);
        if is_on {
            let bar =
                Rect::from_min_size(rect.min + vec2(0.0, 3.0), vec2(2.0, rect.height() - 6.0));
            ui.painter().rect_filled(bar, 1.0, theme::accent(ui.visuals()));
        }
        let label = controls::text(ui, self.label, TextStyle::Body, 80.0);
        put_text(ui, rect.with_min_x(rect.left() + 8.0), label, ink);
        // Figures of another picture, and times of a busy machine, are grey.
        let weak = ui.visuals().weak_text_color();
        let is_steady = state.dial.of(&self.settings).is_some_and(|it| is_steady(&it.ms));
        let inks = [ink, if is_steady { ink } else { weak }, ink];
        let bars = self.bars(state);
        for (((text, right), ink), bar) in texts.iter().zip(COLUMNS).zip(inks).zip(bars) {
            let ink = if state.dial.current { ink } else { weak };
            right_text(ui, column(rect, right), text, TextStyle::Body, ink);
            if let Some(part) = bar.filter(|part| *part > 0.0) {
                let left = rect.left() + right - BAR * part;
                let bottom = rect.bottom() - 1.0;
                let bar =
                    Rect::from_min_max(pos2(left, bottom - 2.0), pos2(rect.left() + right, bottom));
                ui.painter().rect_filled(bar, 1.0, theme::accent(ui.visuals()).gamma_multiply(0.8));
            }
        }
        focus_ring(ui, rect, &response);
        let key = self.action.and_then(|action| first_key(ui, action));
        response
            .on_hover_ui(|ui| {
                ui.label(&self.hint);
                if let Some(key) = key {
                    ui.weak(format!("Key: {key}"));
                }
            })
            .clicked()
    }
}

/// Formats a time: "0.42 ms", "12 ms", "3.1 s", "75 s"; "~12 ms" if it is uncertain.
fn milliseconds(time: &Estimate) -> String {
    let ms = time.value;
    let text = match ms {
        9950.0.. => format!("{:.0} s", ms / 1e3),
        1000.0.. => format!("{:.1} s", ms / 1e3),
        9.95.. => format!("{ms:.0} ms"),
        1.0.. => format!("{ms:.1} ms"),
        _ => format!("{ms:.2} ms"),
    };
    if is_steady(time) { text } else { format!("~{text}") }
}

fn column(row: Rect, right: f32) -> Rect {
    Rect::from_x_y_ranges(row.left() + right - 62.0..=row.left() + right, row.y_range())
}

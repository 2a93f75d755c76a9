//! The plots of time against error: an overview, or the panel of an axis. A click on a mark applies
//! its settings.

use egui::{
    Color32, ComboBox, Id, Pos2, Rect, Response, RichText, ScrollArea, Sense, Stroke, Ui, Visuals,
};
use egui::{WidgetInfo, pos2, vec2};
use egui_plot::{GridMark, Plot, PlotPoint, PlotTransform, Span};

use crate::app::actions::{LabRequest, Request, Requests};
use crate::app::state::State;
use crate::app::theme;
use crate::app::widgets::controls::{self, choose_in_rows};
use crate::app::widgets::regions;
use marraztu_lab::report::{Panel, PanelMark, Panels, Report, TextBox, brief, place};
use marraztu_lab::sweep::{Against, Row};

/// The largest height of a plot.
const USUAL: f32 = 420.0;

/// The minimum height, in a panel that is lower.
const LEAST: f32 = 110.0;

/// Below this height, the label of the axis of errors is short.
const LOW: f32 = 220.0;

/// The height of the choice of a plot.
const CHOICE: f32 = 34.0;

/// The radius of a mark.
const MARK: f32 = 5.0;

/// Returns the colour of the default in every plot.
const fn default_color(visuals: &Visuals) -> Color32 {
    if visuals.dark_mode { Color32::from_rgb(230, 159, 0) } else { Color32::from_rgb(213, 94, 0) }
}

/// Returns the colour of a mark without the pointer on it.
fn mark_color(visuals: &Visuals, mark: &PanelMark) -> Color32 {
    if mark.is_default { default_color(visuals) } else { theme::accent(visuals) }
}

/// Shows the choice of the scene, and the verdict: it comes first, because it answers the question.
pub(crate) fn verdict_ui(ui: &mut Ui, state: &State, requests: &mut Requests) {
    suite_ui(ui, state, requests);
    for sentence in state.lab.shown().map(Report::verdict).unwrap_or_default() {
        ui.add(egui::Label::new(sentence).wrap());
    }
}

pub(crate) fn show(ui: &mut Ui, state: &State, requests: &mut Requests) {
    let Some(report) = state.lab.shown() else {
        return empty_ui(ui, state);
    };
    let panels = Panels::new(report);
    let panel = panels.of(state.lab.panel);
    let height = height(ui.available_height());
    let area = ScrollArea::vertical().id_salt("plots").auto_shrink(false);
    area.content_margin(theme::SCROLL_MARGIN).show(ui, |ui| {
        panels_ui(ui, &panels, panel, requests);
        let size = vec2(ui.available_width(), height);
        ui.allocate_ui(size, |ui| panel_ui(ui, (&panels, panel), (state, report), requests));
    });
}

/// Returns the height of the plot below the choice of a plot.
fn height(room: f32) -> f32 {
    (room - CHOICE).clamp(LEAST, USUAL)
}

fn empty_ui(ui: &mut Ui, state: &State) {
    let text = match state.lab.running {
        Some(_) => {
            "The ideal is drawn first. Then the default is measured against itself to find the \
                noise."
        }
        None => {
            "What does accuracy cost? Measure draws this picture with every choice, and plots the \
                time and the error of each here."
        }
    };
    ui.add_space(theme::GAP);
    ui.vertical_centered(|ui| ui.add(egui::Label::new(text).wrap()));
    let size = vec2(ui.available_width(), (ui.available_height() - 8.0).clamp(60.0, USUAL));
    let (rect, _) = ui.allocate_exact_size(size, Sense::hover());
    sketch_ui(ui, rect);
}

/// Sketches the plot that a measurement will show: a falling line of choices.
fn sketch_ui(ui: &Ui, rect: Rect) {
    let width = rect.width().min(2.0 * rect.height());
    let frame = Rect::from_center_size(rect.center(), vec2(width, rect.height()));
    let frame = frame.shrink2(vec2(34.0, 16.0));
    let faint = ui.visuals().weak_text_color().gamma_multiply(0.6);
    let line = Stroke::new(1.0, faint);
    let painter = ui.painter();
    painter.line_segment([frame.left_top(), frame.left_bottom()], line);
    painter.line_segment([frame.left_bottom(), frame.right_bottom()], line);
    let font = egui::TextStyle::Small.resolve(ui.style());
    let label = |at: Pos2, align: egui::Align2, text: &str| {
        painter.text(at, align, text, font.clone(), faint);
    };
    label(frame.right_bottom() + vec2(0.0, 2.0), egui::Align2::RIGHT_TOP, "time");
    label(frame.left_top() - vec2(4.0, 0.0), egui::Align2::RIGHT_TOP, "error");
    label(frame.center_top(), egui::Align2::CENTER_TOP, "a sketch: each mark will be a choice");
    let marks = [(0.06, 0.1), (0.3, 0.55), (0.66, 0.8), (0.95, 0.97)];
    let at = |(x, y): &(f32, f32)| frame.min + vec2(*x, *y) * frame.size();
    let _ = painter.line(marks.iter().map(at).collect(), Stroke::new(1.5, faint));
    for mark in &marks {
        painter.circle_filled(at(mark), MARK, faint);
    }
}

/// Shows the choice between the scene on screen and the scenes of the suite.
fn suite_ui(ui: &mut Ui, state: &State, requests: &mut Requests) {
    if state.lab.suite.is_empty() {
        return;
    }
    let scenes = state.lab.suite.iter().map(|report| report.scene.as_str()).enumerate();
    let scenes = scenes.map(|(i, name)| (Some(i), name.trim_start_matches("suite scene ")));
    let hint = "Chooses the scene of these figures";
    let all = std::iter::once((None, "This scene")).chain(scenes);
    let all: Vec<_> = all.map(|(place, name)| (name, place, hint)).collect();
    if let Some(place) = choose_in_rows(ui, "Measured", state.lab.shown_suite, &all) {
        requests.push(Request::Lab(LabRequest::ShowSuite(place)));
    }
}

/// Shows the choice of a plot.
fn panels_ui(ui: &mut Ui, panels: &Panels, shown: &Panel, requests: &mut Requests) {
    ui.horizontal(|ui| {
        let combo = ComboBox::from_id_salt("plot").selected_text(&shown.title).width(180.0);
        let combo = combo.height(400.0).show_ui(ui, |ui| {
            for panel in std::iter::once(&panels.overview).chain(&panels.axes) {
                if ui.selectable_label(panel.title == shown.title, &panel.title).clicked() {
                    let key = panel.axis.map(|axis| axis.key);
                    requests.push(Request::Lab(LabRequest::Panel(key)));
                }
            }
        });
        combo.response.accessible_name("Plot").on_hover_text("Time against error");
        ui.add(egui::Label::new(RichText::new(shown.note).small().weak()).truncate());
    });
}

fn panel_ui(
    ui: &mut Ui,
    (panels, panel): (&Panels, &Panel),
    (state, report): (&State, &Report),
    requests: &mut Requests,
) {
    // Marks are connected in order, each with a line for the noise of its time.
    let transform = plot_ui(ui, panels, panel);
    let at: Vec<Pos2> = panel.marks.iter().map(|mark| position(mark, &transform)).collect();
    let line = Stroke::new(1.5, theme::accent(ui.visuals()));
    let painter = ui.painter().with_clip_rect(*transform.frame());
    let _ = painter.line(at.clone(), line);
    for (mark, at) in panel.marks.iter().zip(&at) {
        let [from, to] = mark.noise.map(|x| transform.position_from_point_x(x));
        let ink = mark_color(ui.visuals(), mark);
        painter.hline(from..=to, at.y, Stroke::new(1.0, ink));
    }
    let is_now = |mark: &PanelMark| mark.chosen == state.settings;
    // The marks are one stop of Tab: the arrow keys move between them.
    let ids: Vec<Id> =
        panel.marks.iter().map(|mark| ui.scope_id().with(("mark", mark.point))).collect();
    let stop = regions::stop(ui, &ids, panel.marks.iter().position(is_now), 1);
    for (i, (mark, at)) in panel.marks.iter().zip(&at).enumerate() {
        let rect = Rect::from_center_size(*at, vec2(14.0, 14.0));
        let sense = regions::sense(Sense::click(), i == stop);
        let response = ui.interact(rect, ids[i], sense);
        if mark_ui(ui, response, mark, is_now(mark), report).clicked() {
            requests.push(Request::Settings(mark.chosen));
        }
    }
    names_ui(ui, panel, &at, transform.frame());
}

fn position(mark: &PanelMark, transform: &PlotTransform) -> Pos2 {
    transform.position_from_point(&PlotPoint::new(mark.at[0], mark.at[1]))
}

/// Draws the scales, the line of exact choices, and the noise.
fn plot_ui(ui: &mut Ui, panels: &Panels, panel: &Panel) -> PlotTransform {
    let marks = |ticks: &[(f64, String)]| -> Vec<GridMark> {
        ticks.iter().map(|(value, _)| GridMark { value: *value, step_size: 1.0 }).collect()
    };
    let label = |ticks: &[(f64, String)], at: f64| {
        let tick = ticks.iter().find(|(value, _)| (value - at).abs() < 1e-9);
        tick.map(|(_, label)| label.clone()).unwrap_or_default()
    };
    let faint = ui.visuals().weak_text_color();
    let [left, right] = panels.x.range;
    let [low, high] = panels.y.range;
    let is_low = ui.available_height() < LOW;
    let plot = Plot::new("time against error")
        .allow_drag(false)
        .allow_zoom(false)
        .allow_scroll(false)
        .allow_boxed_zoom(false)
        .allow_double_click_reset(false)
        .show_crosshair(false)
        // Without a grid, the data are the strongest lines.
        .show_grid(false)
        .sense(Sense::hover())
        .default_x_bounds(left, right)
        .default_y_bounds(low, high)
        .auto_bounds(false)
        .set_margin_fraction(egui::Vec2::ZERO)
        .x_axis_label(panels.x.label.clone())
        .y_axis_label(if is_low { "error".to_owned() } else { panels.y.label.clone() })
        .label_formatter(|_| None)
        .x_grid_spacer(|_| marks(&panels.x.ticks))
        .y_grid_spacer(|_| marks(&panels.y.ticks))
        .x_axis_formatter(|mark, _| label(&panels.x.ticks, mark.value))
        .y_axis_formatter(|mark, _| label(&panels.y.ticks, mark.value));
    let shown = plot.show(ui, |plot| {
        plot.set_plot_bounds_x(left..=right);
        plot.set_plot_bounds_y(low..=high);
        let [from, to] = panels.noise;
        let band = Span::new("", from..=to).fill(faint.gamma_multiply(0.2));
        plot.span(band.border_width(0.0));
    });
    let (frame, painter) = (*shown.transform.frame(), ui.painter());
    let y = shown.transform.position_from_point_y(panels.zero);
    painter.hline(frame.x_range(), y, Stroke::new(1.0, faint.gamma_multiply(0.6)));
    let font = egui::TextStyle::Small.resolve(ui.style());
    let middle = shown.transform.position_from_point_x(panels.noise.iter().sum::<f64>() / 2.0);
    // The default lies in the band of the noise: its word goes to the other end.
    let default = panel.marks.iter().find(|mark| mark.is_default);
    let is_high = default.is_some_and(|mark| position(mark, &shown.transform).y < frame.center().y);
    let (end, align) = match is_high {
        true => (y - 1.0, egui::Align2::CENTER_BOTTOM),
        false => (frame.top() + 2.0, egui::Align2::CENTER_TOP),
    };
    // A low plot has no room for more than the names of the marks.
    if !is_low {
        painter.text(pos2(middle, end), align, "noise", font.clone(), faint);
        let exact = pos2(frame.center().x, y - 1.0);
        painter.text(exact, egui::Align2::CENTER_BOTTOM, "no error", font, faint);
    }
    shown.transform
}

/// Draws names next to marks, without overlaps.
fn names_ui(ui: &Ui, panel: &Panel, at: &[Pos2], frame: &Rect) {
    let font = egui::TextStyle::Small.resolve(ui.style());
    let visuals = ui.visuals();
    let galleys: Vec<_> = panel
        .marks
        .iter()
        .map(|mark| {
            let ink = if mark.is_default { default_color(visuals) } else { visuals.text_color() };
            ui.painter().layout_no_wrap(mark.label.clone(), font.clone(), ink)
        })
        .collect();
    let marks: Vec<[f32; 2]> = at.iter().map(|at| [at.x, at.y]).collect();
    // Placement is independent of egui: it gets marks, sizes and a frame.
    let sizes: Vec<[f32; 2]> =
        galleys.iter().map(|galley| [galley.size().x + 2.0, galley.size().y]).collect();
    let frame = TextBox { min: [frame.left(), frame.top()], max: [frame.right(), frame.bottom()] };
    let default = panel.marks.iter().position(|mark| mark.is_default).unwrap_or(0);
    // A name farther away would seem to belong to another mark. The tooltips have all names.
    let placed = place(&marks, &sizes, default, &frame, [MARK + 4.0, 22.0]);
    for (text, galley) in placed.into_iter().zip(galleys) {
        if let Some(TextBox { min: [x, y], .. }) = text {
            ui.painter().galley(pos2(x + 1.0, y), galley, visuals.text_color());
        }
    }
}

fn mark_ui(
    ui: &Ui,
    response: Response,
    mark: &PanelMark,
    is_now: bool,
    report: &Report,
) -> Response {
    let (rect, at) = (response.rect, response.rect.center());
    let name = format!("Draw with {}", report.findings.points[mark.point].name);
    response.widget_info(|| WidgetInfo::selected(egui::Role::RadioButton, true, is_now, &name));
    let visuals = ui.visuals();
    let ink = match response.hovered() {
        true => visuals.strong_text_color(),
        false => mark_color(visuals, mark),
    };
    ui.painter().circle_filled(at, MARK, ink);
    if is_now {
        ui.painter().circle_stroke(at, MARK + 4.0, Stroke::new(2.0, visuals.strong_text_color()));
    }
    controls::focus_ring(ui, rect.expand(3.0), &response);
    response.on_hover_ui(|ui| tip_ui(ui, mark, report))
}

/// Shows the measurements of a choice in its tooltip.
fn tip_ui(ui: &mut Ui, mark: &PanelMark, report: &Report) {
    let point = &report.findings.points[mark.point];
    let [least, most] = report.findings.noise_of(mark.point);
    ui.strong(&point.name);
    ui.label(format!(
        "{} ms: {:.3} times the default; by {} pairs, between {least:.3} and {most:.3} times (the \
         line)",
        brief(point.ms),
        point.ratio.quartiles.median,
        point.ratio.pairs,
    ));
    let in_words = crate::app::state::laboratory::in_words;
    let is_it = |row: &&Row| row.point == mark.point && row.against == Against::Axis;
    if let Some(row) = report.findings.rows.iter().find(is_it) {
        ui.label(format!("What this axis alone changes: {}", in_words(&row.error)));
    }
    if let Some(ideal) = &point.ideal {
        ui.label(format!("Against the ideal: {}; FLIP {}", in_words(ideal), brief(ideal.flip)));
    }
    ui.weak("Click to draw the picture with these settings.");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plot_takes_the_height_below_its_choice_within_limits() {
        assert_eq!(height(290.0), 290.0 - CHOICE);
        assert_eq!(height(700.0), USUAL);
        assert_eq!(height(100.0), LEAST);
    }
}

//! The scatter plot of time against error; clicking a mark draws the picture with its settings.

use egui::{Color32, Id, Pos2, Rect, Response, Sense, Shape, Stroke, Ui, WidgetInfo, pos2, vec2};
use egui_plot::{GridMark, Plot, PlotPoint, PlotTransform, Span};

use crate::app::actions::Request;
use crate::app::state::State;
use crate::app::theme;
use crate::app::widgets::{controls, regions};
use crate::lab::report::{Chart, Mark, MarkKind, Report, brief};

/// Shows the panel; its requests are added to `requests`.
pub(crate) fn show(ui: &mut Ui, state: &State, requests: &mut Vec<Request>) {
    let Some(report) = &state.lab.report else {
        return empty_ui(ui, state);
    };
    let chart = Chart::new(report);
    let transform = plot_ui(ui, &chart);
    front_ui(ui, &chart, (&chart.front_apart, 1.0), &transform);
    front_ui(ui, &chart, (&chart.front, 1.5), &transform);
    // The current settings and the front are drawn above the rest.
    let mut marks: Vec<&Mark> = chart.marks.iter().collect();
    let is_now = |mark: &Mark| report.findings.points[mark.point].settings == state.settings;
    marks.sort_by_key(|mark| (is_now(mark), mark.on_front));
    let ids: Vec<Id> = marks.iter().map(|mark| mark_id(ui, mark)).collect();
    let chosen = marks.iter().position(|mark| is_now(mark));
    let stop = regions::stop(ui, &ids, chosen, 1);
    for (i, mark) in marks.iter().enumerate() {
        let sense = regions::sense(Sense::click(), i == stop);
        let response = ui.interact(mark_rect(mark, &transform), ids[i], sense);
        if mark_ui(ui, response, mark, is_now(mark), report).clicked() {
            requests.push(Request::Settings(report.findings.points[mark.point].settings));
        }
    }
    marks.reverse();
    names_ui(ui, &marks, &transform);
}

fn mark_id(ui: &Ui, mark: &Mark) -> Id {
    ui.scope_id().with(("mark", mark.point))
}

fn mark_rect(mark: &Mark, transform: &PlotTransform) -> Rect {
    Rect::from_center_size(place(mark, transform), vec2(14.0, 14.0))
}

fn place(mark: &Mark, transform: &PlotTransform) -> Pos2 {
    transform.position_from_point(&PlotPoint::new(mark.at[0], mark.at[1]))
}

fn empty_ui(ui: &mut Ui, state: &State) {
    let text = match state.lab.running {
        Some(_) => {
            "The default is measured against itself first: how much it differs is the noise."
        }
        None => {
            "What does accuracy cost? Measure draws this picture with every choice and shows \
             here how long each takes and how far it is from the exact picture."
        }
    };
    ui.add_space(ui.available_height() * 0.35);
    ui.vertical_centered(|ui| ui.add(egui::Label::new(text).wrap()));
}

fn plot_ui(ui: &mut Ui, chart: &Chart) -> PlotTransform {
    let marks = |ticks: &[(f64, String)]| -> Vec<GridMark> {
        ticks.iter().map(|(value, _)| GridMark { value: *value, step_size: 1.0 }).collect()
    };
    let label = |ticks: &[(f64, String)], at: f64| {
        let tick = ticks.iter().find(|(value, _)| (value - at).abs() < 1e-9);
        tick.map(|(_, label)| label.clone()).unwrap_or_default()
    };
    let noise = ui.visuals().weak_text_color();
    let [left, right] = chart.x.range;
    let [low, high] = chart.y.range;
    let plot = Plot::new("time against error")
        .allow_drag(false)
        .allow_zoom(false)
        .allow_scroll(false)
        .allow_boxed_zoom(false)
        .allow_double_click_reset(false)
        .show_crosshair(false)
        .sense(Sense::hover())
        .default_x_bounds(left, right)
        .default_y_bounds(low, high)
        .auto_bounds(false)
        .set_margin_fraction(egui::Vec2::ZERO)
        .x_axis_label(chart.x.label.clone())
        .y_axis_label(chart.y.label.clone())
        .label_formatter(|_| None)
        .x_grid_spacer(|_| marks(&chart.x.ticks))
        .y_grid_spacer(|_| marks(&chart.y.ticks))
        .x_axis_formatter(|mark, _| label(&chart.x.ticks, mark.value))
        .y_axis_formatter(|mark, _| label(&chart.y.ticks, mark.value));
    let shown = plot.show(ui, |plot| {
        plot.set_plot_bounds_x(left..=right);
        plot.set_plot_bounds_y(low..=high);
        let [from, to] = chart.floor;
        let band = Span::new("", from..=to).fill(noise.gamma_multiply(0.25));
        plot.span(band.border_width(0.0));
    });
    let middle = shown.transform.position_from_point_x(chart.floor.iter().sum::<f64>() / 2.0);
    let top = pos2(middle, shown.transform.frame().top() + 2.0);
    let font = egui::TextStyle::Small.resolve(ui.style());
    ui.painter().text(top, egui::Align2::CENTER_TOP, "noise", font, noise);
    shown.transform
}

/// A front as steps: between two points nothing was measured.
fn front_ui(ui: &Ui, chart: &Chart, (front, width): (&[usize], f32), transform: &PlotTransform) {
    let mut line: Vec<Pos2> = Vec::new();
    for at in front.iter().map(|mark| place(&chart.marks[*mark], transform)) {
        line.extend(line.last().map(|before| pos2(at.x, before.y)));
        line.push(at);
    }
    let stroke = Stroke::new(width, theme::accent(ui.visuals()));
    let _ = ui.painter().with_clip_rect(*transform.frame()).line(line, stroke);
}

/// Names beside marks, in order, if there is room for them.
fn names_ui(ui: &Ui, marks: &[&Mark], transform: &PlotTransform) {
    let font = egui::TextStyle::Small.resolve(ui.style());
    let mut taken: Vec<Rect> = marks
        .iter()
        .map(|mark| Rect::from_center_size(place(mark, transform), vec2(12.0, 12.0)))
        .collect();
    let named = |mark: &&&Mark| !matches!(mark.kind, MarkKind::Combination);
    for mark in marks.iter().filter(named) {
        let (at, visuals) = (place(mark, transform), ui.visuals());
        let ink = if mark.on_front { visuals.text_color() } else { visuals.weak_text_color() };
        let text = ui.painter().layout_no_wrap(mark.name.clone(), font.clone(), ink);
        let size = text.size();
        // Last: to the upper right, along the front.
        let around = [
            at + vec2(10.0, -size.y),
            at + vec2(-10.0 - size.x, 0.0),
            at + vec2(10.0, 0.0),
            at + vec2(-12.0 - size.x, -size.y / 2.0),
            at + vec2(-size.x / 2.0, 10.0),
            at + vec2(-size.x / 2.0, -10.0 - size.y),
        ];
        let rects = around.map(|corner| Rect::from_min_size(corner, size));
        let free = |rect: &Rect| {
            transform.frame().contains_rect(*rect) && !taken.iter().any(|t| t.intersects(*rect))
        };
        if let Some(rect) = rects.into_iter().find(free) {
            taken.push(rect);
            ui.painter().galley(rect.min, text, ink);
        }
    }
}

fn mark_ui(ui: &Ui, response: Response, mark: &Mark, is_now: bool, report: &Report) -> Response {
    let at = response.rect.center();
    let name = format!("Draw with {}", mark.name);
    response.widget_info(|| WidgetInfo::selected(egui::Role::RadioButton, true, is_now, &name));
    let visuals = ui.visuals();
    let ink = if mark.on_front { theme::accent(visuals) } else { visuals.weak_text_color() };
    let ink = if response.hovered() { visuals.strong_text_color() } else { ink };
    let painter = ui.painter();
    match mark.kind {
        MarkKind::Default => {
            painter.add(diamond(at, 7.0, ink));
        }
        MarkKind::Preset => {
            let square = Rect::from_center_size(at, vec2(10.0, 9.0));
            painter.rect_filled(square, 1.0, ink);
        }
        MarkKind::Axis => {
            painter.circle_filled(at, 4.5, ink);
        }
        MarkKind::Combination => {
            painter.circle_filled(at, 2.5, ink);
        }
        MarkKind::Apart => {
            painter.add(triangle(at, 5.5, ink));
        }
        MarkKind::Model => {
            painter.circle_stroke(at, 4.5, Stroke::new(1.0, ink));
        }
    }
    if is_now {
        painter.circle_stroke(at, 10.0, Stroke::new(2.0, visuals.strong_text_color()));
    }
    controls::focus_ring(ui, response.rect.expand(3.0), &response);
    response.on_hover_ui(|ui| tip_ui(ui, mark, report))
}

fn diamond(at: Pos2, size: f32, ink: Color32) -> Shape {
    let corner = |x: f32, y: f32| at + vec2(x, y) * size;
    let corners = vec![corner(0.0, -1.0), corner(1.0, 0.0), corner(0.0, 1.0), corner(-1.0, 0.0)];
    Shape::convex_polygon(corners, ink, Stroke::NONE)
}

fn triangle(at: Pos2, size: f32, ink: Color32) -> Shape {
    let corner = |x: f32, y: f32| at + vec2(x, y) * size;
    let corners = vec![corner(0.0, -1.0), corner(1.0, 0.7), corner(-1.0, 0.7)];
    Shape::convex_polygon(corners, ink, Stroke::NONE)
}

/// The figures of a choice, for its tooltip.
fn tip_ui(ui: &mut Ui, mark: &Mark, report: &Report) {
    let point = &report.findings.points[mark.point];
    let quartiles = &point.ratio.quartiles;
    ui.strong(&mark.name);
    ui.label(format!(
        "{} ms: {:.3} times the default, half of {} pairs from {:.3} to {:.3}",
        brief(point.ms),
        quartiles.median,
        point.ratio.pairs,
        quartiles.lower,
        quartiles.upper
    ));
    ui.label(format!(
        "Error: {}; FLIP {}",
        crate::app::state::laboratory::in_words(&point.error),
        brief(point.error.flip)
    ));
    if mark.on_front {
        ui.label("No other choice is both faster and more exact.");
    }
    match mark.kind {
        MarkKind::Model => {
            ui.label("Another model: judged against its own exact picture, and not scored.");
        }
        MarkKind::Apart => {
            ui.label("Judged against 64 samples per pixel, each lit: a front of its own.");
        }
        MarkKind::Default | MarkKind::Preset | MarkKind::Axis | MarkKind::Combination => {
            if !report.is_scored(mark.point) {
                ui.label("Some pixels show other triangles, which only FLIP judges: on no front.");
            }
        }
    }
    ui.weak("Click to draw the picture with these settings.");
}

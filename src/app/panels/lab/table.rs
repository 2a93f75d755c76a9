//! The table of the laboratory: every choice with its measurements; a click applies it.

use egui::{Id, Rect, RichText, ScrollArea, Sense, TextStyle, Ui, WidgetInfo, vec2};

use crate::app::actions::{Request, Requests};
use crate::app::state::State;
use crate::app::theme;
use crate::app::widgets::controls::{
    focus_ring, no_narrower, put_text, right_text, row_ground, text,
};
use crate::app::widgets::regions;
use crate::app::widgets::text::counted;
use marraztu_core::accuracy::Axis;
use marraztu_lab::candidates::Group;
use marraztu_lab::error::{Error, Region};
use marraztu_lab::picture_source::Reference;
use marraztu_lab::report::{Report, brief, heading, left_out_in_words};
use marraztu_lab::sweep::{Measured, Row, TOO_BUSY, Verdict};

struct Column {
    heading: &'static str,
    hint: &'static str,
    share: f32,
    value: fn(&Measured, &Error, Region) -> String,
}

/// Narrower panels scroll the table sideways.
const LEAST: f32 = 480.0;

/// The share of the width for the names.
const NAMES: f32 = 0.30;

const COLUMNS: [Column; 7] = [
    Column {
        heading: "time",
        hint: "Time relative to the default, each without the disturbances of other programs",
        share: 0.09,
        value: |point, _, _| format!("{}x", ratio(point.ratio.quartiles.median)),
    },
    Column {
        heading: "spread",
        hint: "The quartiles of the ratio, by a bootstrap over the pairs",
        share: 0.15,
        value: |point, _, _| {
            let quartiles = &point.ratio.quartiles;
            match point.ratio.pairs {
                // A picture that takes so long is drawn once.
                1 => "once".to_owned(),
                _ => format!("{} - {}", ratio(quartiles.lower), ratio(quartiles.upper)),
            }
        },
    },
    Column {
        heading: "ms",
        hint: "Milliseconds of a picture",
        share: 0.08,
        value: |point, _, _| brief(point.ms),
    },
    Column {
        heading: "max",
        hint: "The maximum error: the largest difference of a byte",
        share: 0.08,
        value: |_, error, region| error.over(region).largest.to_string(),
    },
    Column {
        heading: "RMSE",
        hint: "The root of the mean square difference, in byte steps",
        share: 0.10,
        value: |_, error, region| brief(error.over(region).rmse),
    },
    Column {
        heading: "bytes",
        hint: "The percentage of bytes that differ",
        share: 0.11,
        value: |_, error, region| format!("{}%", brief(error.over(region).differing * 100.0)),
    },
    Column {
        heading: "FLIP",
        hint: "The perceived difference, from 0 to 1",
        share: 0.09,
        value: |_, error, _| brief(error.flip),
    },
];

/// Formats a ratio: "0.97", "12.4", "764".
fn ratio(ratio: f64) -> String {
    match ratio {
        100.0.. => format!("{ratio:.0}"),
        10.0.. => format!("{ratio:.1}"),
        _ => format!("{ratio:.2}"),
    }
}

pub(crate) fn show(ui: &mut Ui, state: &State, requests: &mut Requests) {
    let Some(report) = state.lab.shown() else {
        ui.weak("Nothing has been measured yet.");
        return;
    };
    no_narrower(ui, LEAST, |ui| rows_ui(ui, state, report, requests));
}

fn rows_ui(ui: &mut Ui, state: &State, report: &Report, requests: &mut Requests) {
    head_ui(ui);
    let area = ScrollArea::vertical().id_salt("table of the laboratory").auto_shrink(false);
    area.content_margin(theme::SCROLL_MARGIN).show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        let mut last = String::new();
        let front = report.front();
        let rows: Vec<&Row> = report.rows();
        let ids: Vec<Id> = (0..rows.len()).map(|i| ui.scope_id().with(("row", i))).collect();
        // The rows are one stop of Tab: the arrow keys move between them.
        let is_now = |row: &&Row| row.chosen == state.settings;
        let stop = regions::stop(ui, &ids, rows.iter().position(is_now), 1);
        for (i, row) in rows.into_iter().enumerate() {
            let heading = heading(row);
            if heading != last {
                ui.add_space(theme::GAP);
                ui.horizontal(|ui| {
                    ui.label(RichText::new(&heading).small().strong());
                    let against = format!("errors against {}", reference(report, row));
                    ui.weak(RichText::new(against).small());
                });
                last = heading;
            }
            let place = Place { id: ids[i], is_stop: i == stop };
            row_ui(ui, state, report, row, (place, front.contains(&row.point)), requests);
        }
        foot_ui(ui, report);
        regions::follow_focus(ui);
    });
}

/// Returns the name of the picture that a row is judged against.
fn reference(report: &Report, row: &Row) -> String {
    let axis = match row.group {
        Group::Axis(key) => Axis::named(key),
        Group::Preset | Group::Current | Group::Combination => None,
    };
    let settings = &report.findings.points[row.point].settings;
    match axis.map(Reference::Alone) {
        Some(reference) => reference.name(settings),
        None => format!("the {}", Reference::Ideal.name(settings)),
    }
}

/// The keyboard stop of a row.
#[derive(Clone, Copy, Debug)]
struct Place {
    id: Id,
    is_stop: bool,
}

fn cell(row: Rect, column: usize) -> Rect {
    let before: f32 = COLUMNS[..column].iter().map(|column| column.share).sum();
    let left = row.left() + (NAMES + before) * row.width();
    Rect::from_min_max(
        egui::pos2(left, row.top()),
        egui::pos2(left + COLUMNS[column].share * row.width() - 4.0, row.bottom()),
    )
}

fn head_ui(ui: &mut Ui) {
    let size = vec2(ui.available_width() - f32::from(theme::MARGIN), theme::ROW);
    let (row, _) = ui.allocate_exact_size(size, Sense::hover());
    for (i, column) in COLUMNS.iter().enumerate() {
        let rect = cell(row, i);
        right_text(ui, rect, column.heading, TextStyle::Small, ui.visuals().weak_text_color());
        ui.interact(rect, ui.scope_id().with(("column", i)), Sense::hover())
            .on_hover_text(column.hint);
    }
}

fn row_ui(
    ui: &mut Ui,
    state: &State,
    report: &Report,
    row: &Row,
    (place, on_front): (Place, bool),
    requests: &mut Requests,
) {
    let (point, error) = (&report.findings.points[row.point], &row.error);
    let now = row.chosen == state.settings;
    let size = vec2(ui.available_width(), theme::ROW - 3.0);
    let (rect, _) = ui.allocate_exact_size(size, Sense::hover());
    let response = ui.interact(rect, place.id, regions::sense(Sense::click(), place.is_stop));
    let name = format!("{}: {}", heading(row), row.name);
    response.widget_info(|| WidgetInfo::selected(egui::Role::RadioButton, true, now, &name));
    let ink = row_ground(ui, &response, now);
    // A bar marks choices on the Pareto front.
    if on_front {
        let bar = Rect::from_min_size(rect.min + vec2(1.0, 3.0), vec2(2.0, rect.height() - 6.0));
        ui.painter().rect_filled(bar, 1.0, theme::accent(ui.visuals()));
    }
    let star = if row.point == 0 { " *" } else { "" };
    let left = rect.with_min_x(rect.left() + 8.0).with_max_x(rect.left() + NAMES * rect.width());
    let label = text(ui, format!("{}{star}", row.name), TextStyle::Body, left.width());
    put_text(ui, left, label, ink);
    for (i, column) in COLUMNS.iter().enumerate() {
        // Times within the noise are shown weakly.
        let is_noise = matches!(point.verdict, Verdict::Alike | Verdict::Busy);
        let noise = i < 3 && is_noise && row.point != 0 && !now;
        let ink = if noise { ui.visuals().weak_text_color() } else { ink };
        let value = (column.value)(point, error, report.region);
        right_text(ui, cell(rect, i), &value, TextStyle::Small, ink);
    }
    focus_ring(ui, rect, &response);
    let verdict = match point.verdict {
        _ if error.is_incomplete() => "surfaces of the reference are missing",
        Verdict::Faster => "faster than the default",
        Verdict::Slower => "slower than the default",
        Verdict::Alike => "no difference in time beyond the noise",
        Verdict::Busy => "the machine was too busy to tell",
    };
    let hint = format!(
        "{verdict}, {}, {} discarded; {} with another triangle",
        counted(point.ratio.pairs, "pair", "pairs"),
        point.ratio.thrown,
        counted(error.coverage, "pixel", "pixels")
    );
    if response.on_hover_text(hint).clicked() {
        requests.push(Request::Settings(row.chosen));
    }
}

/// Shows the conditions of the measurement, and the parts that were not measured.
fn foot_ui(ui: &mut Ui, report: &Report) {
    let findings = &report.findings;
    let [width, height] = findings.size;
    ui.add_space(theme::GAP);
    ui.label(RichText::new("measured with").small().strong());
    let small = |ui: &mut Ui, text: String| {
        ui.add(egui::Label::new(RichText::new(text).small()).wrap());
    };
    small(
        ui,
        format!(
            "{width} x {height} pixels, {}, {}. The default takes {} ms; {}, and so are \
                differences within the interval of a row (95%). * is the default; a bar marks \
                choices that no other choice beats in both time and error. Errors of an axis are \
                relative to the default with this axis alone at its most exact; all others, to \
                the ideal: 256 samples per pixel, each lit.",
            counted(findings.threads, "thread", "threads"),
            findings.instructions,
            brief(findings.control.a_ms),
            if findings.floor > TOO_BUSY {
                "the machine is too busy to tell times".to_owned()
            } else {
                format!("differences below {:.1}% are noise", findings.floor * 100.0)
            }
        ),
    );
    small(ui, left_out_in_words(report));
    for kernel in &findings.kernels {
        small(
            ui,
            format!(
                "{}: SIMD takes {:.2} of the plain loop's time, {}.",
                kernel.name,
                kernel.ratio.quartiles.median,
                if kernel.equal { "results equal" } else { "DIFFERENT RESULTS" }
            ),
        );
    }
}

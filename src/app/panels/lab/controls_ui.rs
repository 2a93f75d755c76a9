//! The controls of the laboratory: measuring, error metric, budgets, comparison, attribution.

use egui::{ProgressBar, RichText, ScrollArea, TextStyle, Ui, vec2};

use crate::app::actions::{LabRequest, Request, Requests};
use crate::app::state::State;
use crate::app::state::laboratory::{Compare, in_words};
use crate::app::theme;
use crate::app::widgets::controls::{Switch, choose, choose_in_rows, row};
use crate::app::widgets::number::Number;
use crate::app::widgets::regions;
use marraztu_core::accuracy::{AXES, Axis};
use marraztu_io::Lesson;
use marraztu_lab::candidates::Thoroughness;
use marraztu_lab::error::{Measure, Region};
use marraztu_lab::picture_source::Reference;
use marraztu_lab::report::{Budgets, Report, brief, capitalized, tabs};
use marraztu_lab::suite::SuiteDetail;

pub(crate) fn show(ui: &mut Ui, state: &State, requests: &mut Requests) {
    let area = ScrollArea::vertical().id_salt("what the laboratory is asked").auto_shrink(false);
    area.content_margin(theme::SCROLL_MARGIN).show(ui, |ui| {
        measure_ui(ui, state, requests);
        judge_ui(ui, state, requests);
        region_ui(ui, state, requests);
        budgets_ui(ui, state, requests);
        ui.add_space(theme::GAP);
        compare_ui(ui, state, requests);
        pixel_ui(ui, state, requests);
        if let Some(report) = state.lab.shown() {
            command_ui(ui, report);
        }
        regions::follow_focus(ui);
    });
}

/// Shows the buttons that measure, or the progress.
#[expect(clippy::cast_possible_truncation, reason = "a fraction from 0 to 1")]
pub(super) fn measure_ui(ui: &mut Ui, state: &State, requests: &mut Requests) {
    let lab = &state.lab;
    ui.horizontal(|ui| match lab.running {
        Some(fraction) => {
            let width = ui.available_width() - 70.0;
            ui.add(ProgressBar::new(fraction as f32).desired_width(width).show_percentage());
            if ui.button("Cancel").on_hover_text("Cancels measuring").clicked() {
                requests.push(Request::Lab(LabRequest::Cancel));
            }
        }
        None => {
            let quick = ui.button("Measure").on_hover_text(
                "Times every choice against the default and compares its picture with the exact \
                 one: about 20 seconds for the default scene",
            );
            let whole = ui.button("Thoroughly").on_hover_text(
                "Measures more pairs of pictures and more combinations: a few minutes",
            );
            let suite = ui.button("Suite").on_hover_text(
                "Measures each axis on a scene in which it matters: at most ten minutes",
            );
            if suite.clicked() {
                requests.push(Request::Lab(LabRequest::Suite(SuiteDetail::WHOLE)));
            }
            for (clicked, thoroughness) in
                [(quick.clicked(), Thoroughness::QUICK), (whole.clicked(), Thoroughness::WHOLE)]
            {
                if clicked {
                    requests.push(Request::Lab(LabRequest::Measure(thoroughness)));
                }
            }
        }
    });
    // Two lines are always reserved, so the rows below stay where they are.
    let lines = 2.0 * ui.text_style_height(&TextStyle::Body) + ui.spacing().item_spacing.y;
    ui.allocate_ui(vec2(ui.available_width(), lines), |ui| {
        ui.set_min_height(lines);
        progress_ui(ui, state);
        age_ui(ui, state);
    });
}

/// Shows the time left, or why nothing was measured.
fn progress_ui(ui: &mut Ui, state: &State) {
    let lab = &state.lab;
    if let Some(fraction) = lab.running {
        ui.weak(match lab.left {
            None if fraction <= 0.0 => "Drawing the ideal first".to_owned(),
            None => "Timing the first choices".to_owned(),
            Some(left @ 100.0..) => format!("About {:.0} minutes left", left / 60.0),
            Some(left) => format!("About {left:.0} seconds left"),
        });
    }
    if let Some(why) = &lab.failed {
        ui.colored_label(theme::error(ui.visuals()), format!("Not measured: {why}."));
    }
}

/// Warns if the results belong to another picture.
pub(super) fn age_ui(ui: &mut Ui, state: &State) {
    let lab = &state.lab;
    if lab.is_rough {
        ui.weak("Measuring was cancelled: these first results are rough.");
    }
    if lab.report.is_some() && lab.is_stale(state) {
        let warn = ui.visuals().warn_fg_color;
        let what = "The scene, its view or its size has changed since this was measured.";
        ui.colored_label(warn, what);
    }
}

fn judge_ui(ui: &mut Ui, state: &State, requests: &mut Requests) {
    let texts = [
        ("RMSE", "The root of the mean square of the differences, in byte steps of 255"),
        ("Maximum", "The largest difference of a byte, in steps of 255"),
        ("Differing bytes", "The fraction of bytes that differ"),
        ("FLIP", "The perceived difference when flipping between the pictures, from 0 to 1"),
    ];
    let all = Measure::ALL.into_iter().zip(texts);
    let all: Vec<_> = all.map(|(measure, (label, hint))| (label, measure, hint)).collect();
    let of = "Error metric";
    if let Some(to) = row(ui, of, |ui| choose_in_rows(ui, of, state.lab.measure, &all)) {
        requests.push(Request::Lab(LabRequest::Judge(to)));
    }
}

fn region_ui(ui: &mut Ui, state: &State, requests: &mut Requests) {
    let all = [
        ("All pixels", Region::Whole, "Errors over the whole picture, edges included"),
        ("Same coverage", Region::Inside, "Errors over the pixels that show the same triangle"),
    ];
    let of = "Error over";
    if let Some(to) = row(ui, of, |ui| choose_in_rows(ui, of, state.lab.region, &all)) {
        requests.push(Request::Lab(LabRequest::Over(to)));
    }
}

fn budgets_ui(ui: &mut Ui, state: &State, requests: &mut Requests) {
    let (budgets, report) = (state.lab.budgets, state.lab.shown());
    let error = Budget {
        label: "Error up to",
        name: "Largest acceptable error",
        hint: "Finds the fastest choice with at most this error",
        suffix: "",
        value: budgets.error,
        found: report.and_then(Report::fastest),
    };
    if let Some(error) = budget_ui(ui, &error, report, requests) {
        requests.push(Request::Lab(LabRequest::Budgets(Budgets { error, ..budgets })));
    }
    let ms = Budget {
        label: "Time up to",
        name: "Longest acceptable time for a picture",
        hint: "Finds the most exact choice within this time",
        suffix: " ms",
        value: budgets.ms,
        found: report.and_then(Report::most_exact),
    };
    if let Some(ms) = budget_ui(ui, &ms, report, requests) {
        requests.push(Request::Lab(LabRequest::Budgets(Budgets { ms, ..budgets })));
    }
}

struct Budget {
    label: &'static str,
    name: &'static str,
    hint: &'static str,
    suffix: &'static str,
    value: Option<f64>,
    /// The point within the budget. The outer `None` means no budget, the inner one that no point
    /// is within it.
    found: Option<Option<usize>>,
}

/// Shows a budget and the choice that meets it; a click applies that choice. Returns the changed
/// budget.
fn budget_ui(
    ui: &mut Ui,
    budget: &Budget,
    report: Option<&Report>,
    requests: &mut Requests,
) -> Option<Option<f64>> {
    let mut changed = None;
    row(ui, budget.label, |ui| {
        let field = Number::new(budget.name, budget.hint)
            .suffix(budget.suffix)
            .speed(0.05)
            .range(0.0..=1e6);
        if let Some((value, _)) = field.ui(ui, 64.0, budget.value.unwrap_or(0.0)) {
            changed = Some((value > 0.0).then_some(value));
        }
        match (budget.found, report) {
            (Some(Some(place)), Some(report)) => {
                let point = &report.findings.points[place];
                let text = format!("{} ms: {}", brief(point.ms), point.name);
                let button = egui::Button::new(text).truncate();
                let hint = format!("Draws the picture with these settings: {}", point.name);
                if ui.add(button).on_hover_text(hint).clicked() {
                    requests.push(Request::Settings(report.chosen(place)));
                }
            }
            (Some(None), _) => {
                ui.weak("none");
            }
            _ => {
                ui.weak(if report.is_some() { "0: no budget" } else { "" });
            }
        }
    });
    changed
}

fn compare_ui(ui: &mut Ui, state: &State, requests: &mut Requests) {
    let now = state.lab.compare;
    // Every split is the same choice, wherever its slider is.
    let chosen = if matches!(now, Compare::Split(_)) { Compare::SPLIT } else { now };
    let all = [
        ("Off", Compare::Off, "Shows only the picture"),
        ("Split", Compare::SPLIT, "Shows the ideal to the left of a slider"),
        ("x1", Compare::Error(1), "Shows the error"),
        ("x16", Compare::Error(16), "Shows 16 times the error"),
        ("x256", Compare::Error(256), "Shows 256 times the error"),
    ];
    if let Some(to) = row(ui, "Compare", |ui| choose(ui, "Compare", chosen, &all)) {
        requests.push(Request::Lab(LabRequest::Compare(to)));
    }
    if now != Compare::Off {
        with_ui(ui, state, requests);
    }
    if let (Some(judged), true) = (&state.lab.judged, now != Compare::Off) {
        let samples = judged.settings.samples_in_words();
        let text = format!("Error with {samples}: {}", in_words(&judged.error));
        ui.label(RichText::new(text).small());
    }
}

/// Chooses the picture to compare with: the ideal, or the one that differs in a single axis.
fn with_ui(ui: &mut Ui, state: &State, requests: &mut Requests) {
    let now = state.lab.reference;
    let alone = match now {
        Reference::Alone(axis) => axis,
        Reference::Ideal => {
            let lesson = state.lab.lesson.map(Lesson::axis);
            state.lab.panel.and_then(Axis::named).or(lesson).unwrap_or(&AXES[0])
        }
    };
    let label = capitalized(&Reference::Alone(alone).name(&state.settings));
    let exact = "256 samples per pixel, each lit, with every choice at its most exact";
    let same = "The same settings, except that this axis is at its most exact";
    let all = [("Ideal", Reference::Ideal, exact), (label.as_str(), Reference::Alone(alone), same)];
    if let Some(with) = row(ui, "With", |ui| choose(ui, "Compare with", now, &all)) {
        requests.push(Request::Lab(LabRequest::Against(with)));
    }
}

fn pixel_ui(ui: &mut Ui, state: &State, requests: &mut Requests) {
    let switch = Switch::new("Attribute the error of a pixel", state.lab.picking).ui(ui);
    let switch = switch.on_hover_text("Shows the error of one pixel and attributes it to an axis");
    if switch.clicked() {
        requests.push(Request::Lab(LabRequest::Pick(!state.lab.picking)));
    }
    for line in state.lab.attribution.iter().flatten() {
        ui.add(egui::Label::new(RichText::new(line).monospace()).wrap());
    }
}

fn command_ui(ui: &mut Ui, report: &Report) {
    ui.horizontal(|ui| {
        if ui
            .button("Copy command")
            .on_hover_text("Copies the command line that runs this measurement")
            .clicked()
        {
            ui.ctx().copy_text(report.command.clone());
        }
        let hint = "Copies the whole table as tab-separated text for spreadsheets";
        if ui.button("Copy table").on_hover_text(hint).clicked() {
            ui.ctx().copy_text(tabs(report));
        }
        let command = egui::Label::new(RichText::new(&report.command).monospace()).truncate();
        ui.add(command).on_hover_text(&report.command);
    });
}

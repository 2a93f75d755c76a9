//! The state of the laboratory panel and of the comparison with the exact picture.

use std::collections::BTreeMap;

use super::State;
use crate::app::drawing::snapshot::pictured;
use marraztu_core::accuracy::{AXES, Settings, Shot};
use marraztu_io::Lesson;
use marraztu_lab::error::{Error, Measure, Region};
use marraztu_lab::picture_source::Reference;
use marraztu_lab::report::{Budgets, Report, brief};

/// The contents of the laboratory panel.
#[derive(Debug, Default)]
pub struct Laboratory {
    /// The last measurement, or the results so far of the running one.
    pub report: Option<Report>,
    /// Whether the report is of a measurement that was cancelled.
    pub is_rough: bool,
    /// The reports of the suite, if it was measured.
    pub suite: Vec<Report>,
    /// The index of the suite's report to show; `None` shows the report of the scene on screen.
    pub shown_suite: Option<usize>,
    /// The progress of the running measurement, from 0 to 1.
    pub running: Option<f64>,
    /// The seconds that the running measurement will still take, if they can be told.
    pub left: Option<f64>,
    /// The error message of the last measurement, if it failed.
    pub failed: Option<String>,
    /// The error metric.
    pub measure: Measure,
    /// The pixels over which the metric is computed.
    pub region: Region,
    /// The axis of the plot on show, by its key; `None` for the overview.
    pub panel: Option<&'static str>,
    /// The budgets of time and error.
    pub budgets: Budgets,
    /// How the picture is compared with the exact one.
    pub compare: Compare,
    /// The picture to compare with.
    pub reference: Reference,
    /// The error of the picture at the last comparison.
    pub judged: Option<Judged>,
    /// Whether the next click on the picture picks a pixel for attribution.
    pub picking: bool,
    /// The last attribution, in lines.
    pub attribution: Option<Vec<String>>,
    /// The lesson on show.
    pub lesson: Option<&'static Lesson>,
    /// Whether the scene is that of a lesson, with the user's scene to return to.
    pub away: bool,
    /// The measured effect of each axis, by the axis's key.
    pub costs: BTreeMap<&'static str, AxisCost>,
    /// The picture that was measured; other settings do not matter.
    pub(crate) measured: Option<Shot>,
}

impl Laboratory {
    /// Returns the report to show.
    pub fn shown(&self) -> Option<&Report> {
        match self.shown_suite {
            Some(i) => self.suite.get(i),
            None => self.report.as_ref(),
        }
    }

    /// Keeps the measured effect of each axis.
    pub(crate) fn note_costs(&mut self, report: &Report) {
        for axis in AXES.iter().filter(|axis| report.findings.rows_of(axis).count() > 1) {
            let choices = axis.choices.iter().filter_map(|choice| {
                report.verdict_on_choice(axis, choice).map(|line| (choice.word, line))
            });
            let cost = AxisCost { all: report.verdict_on(axis), choices: choices.collect() };
            self.costs.insert(axis.key, cost);
        }
    }

    /// Returns whether the measured scene, view or size differs from the viewport's.
    pub fn is_stale(&self, state: &State) -> bool {
        self.measured.as_ref().is_some_and(|Shot { scene, view, size, .. }| {
            let same_view = pictured(&state.view) == pictured(view);
            let same_size = state.statistics.size == *size;
            !same_view || !same_size || *scene != state.scene
        })
    }
}

/// The measured effect of an axis on time and error.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct AxisCost {
    /// A paragraph on all choices.
    pub all: String,
    /// A line on each measured choice, by its word.
    pub choices: BTreeMap<&'static str, String>,
}

/// The way to compare the picture with the exact one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Compare {
    /// Not at all.
    #[default]
    Off,
    /// The exact picture in the left part of the window, up to this fraction of the width.
    Split(f32),
    /// The error instead of the picture, amplified by this factor.
    Error(u16),
}

impl Compare {
    /// The split to begin with: most of the window shows the picture.
    pub const SPLIT: Self = Self::Split(1.0 / 3.0);
}

/// The measured error of a picture against the exact one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Judged {
    /// The error.
    pub error: Error,
    /// The settings of the picture.
    pub settings: Settings,
}

/// Describes an error: "largest 3 steps, RMSE 0.02, 1.2% of the bytes differ".
pub(crate) fn in_words(error: &Error) -> String {
    let figures = &error.whole;
    if figures.largest == 0 && error.coverage == 0 {
        return "none, every byte is exact".to_owned();
    }
    let steps = if figures.largest == 1 { "step" } else { "steps" };
    let mut text = format!(
        "largest {} {steps}, RMSE {}, {}% of the bytes differ",
        figures.largest,
        brief(figures.rmse),
        brief(figures.differing * 100.0)
    );
    if error.coverage > 0 {
        let (pixels, show) = match error.coverage {
            1 => ("pixel", "shows"),
            _ => ("pixels", "show"),
        };
        text += &format!(", {} {pixels} {show} another triangle", error.coverage);
    }
    text
}

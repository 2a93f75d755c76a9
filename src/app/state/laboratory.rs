//! The state of the laboratory panel and of the comparison with the exact picture.

use std::collections::BTreeMap;

use super::State;
use marraztu_core::accuracy::{AXES, Axis, Samples, Settings};
use marraztu_core::base::image::Size;
use marraztu_core::scene::{Scene, View};
use marraztu_lab::error::{Error, Measure, Region};
use marraztu_lab::picture_source::Reference;
use marraztu_lab::report::{Budgets, Report, brief};

/// What the panel of the laboratory shows.
#[derive(Debug)]
pub struct Laboratory {
    /// The last measurement, or the one so far.
    pub report: Option<Report>,
    /// The reports of the suite, once it was measured.
    pub suite: Vec<Report>,
    /// Which of them is shown; `None` if that of the scene on screen is.
    pub shown_suite: Option<usize>,
    /// The progress of the running measurement, from 0 to 1.
    pub running: Option<f64>,
    /// Why measuring failed, if it did.
    pub failed: Option<String>,
    /// The error metric.
    pub measure: Measure,
    /// The pixels that it is taken over.
    pub region: Region,
    /// The axis whose plot is shown, by its key; `None` for the overview.
    pub panel: Option<&'static str>,
    /// The budgets of time and error.
    pub budgets: Budgets,
    /// How the picture is compared with the exact one.
    pub compare: Compare,
    /// What it is compared with; several samples per pixel are always compared with 256.
    pub reference: Reference,
    /// The error of the picture at the last comparison.
    pub judged: Option<Judged>,
    /// Whether the next click on the picture picks a pixel for attribution.
    pub picking: bool,
    /// The last attribution, in lines.
    pub attribution: Option<Vec<String>>,
    /// The axis whose lesson is shown.
    pub lesson: &'static Axis,
    /// Whether this is the scene of a lesson, and there is another to go back to.
    pub away: bool,
    /// What was measured of each axis, by its key, in a sentence.
    pub costs: BTreeMap<&'static str, String>,
    /// The panel beside the plots.
    pub side: Side,
    /// The scene, the view and the size that were measured.
    pub(crate) measured: Option<(Scene, View, Size)>,
}

impl Default for Laboratory {
    fn default() -> Self {
        Self {
            report: None,
            suite: Vec::new(),
            shown_suite: None,
            running: None,
            failed: None,
            measure: Measure::default(),
            region: Region::default(),
            panel: None,
            budgets: Budgets::default(),
            compare: Compare::Off,
            reference: Reference::default(),
            away: false,
            costs: BTreeMap::new(),
            judged: None,
            picking: false,
            attribution: None,
            lesson: &AXES[0],
            side: Side::Table,
            measured: None,
        }
    }
}

/// The panel beside the plots.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Side {
    /// Every choice with its figures.
    #[default]
    Table,
    /// What each axis teaches.
    Lessons,
}

impl Laboratory {
    /// The report that is shown.
    #[must_use]
    pub fn shown(&self) -> Option<&Report> {
        match self.shown_suite {
            Some(i) => self.suite.get(i),
            None => self.report.as_ref(),
        }
    }

    /// Keeps in a sentence what was measured of each axis.
    pub(crate) fn note_costs(&mut self, report: &Report) {
        for axis in AXES.iter().filter(|axis| report.findings.rows_of(axis).count() > 1) {
            self.costs.insert(axis.key, report.verdict_on(axis));
        }
    }

    /// What the picture is compared with: several samples per pixel with 256.
    pub(crate) fn against(&self, settings: &Settings) -> Reference {
        if settings.samples == Samples::One { self.reference } else { Reference::Sampled }
    }

    /// Whether the measurement is not of the picture in the viewport any more.
    #[must_use]
    pub fn is_stale(&self, state: &State) -> bool {
        self.measured.as_ref().is_some_and(|(scene, view, size)| {
            // What the keys act on, and how far, changes nothing of the picture.
            let same_view = View {
                subject: view.subject,
                light: view.light,
                transformation: view.transformation,
                frame: view.frame,
                steps: view.steps,
                ..state.view.clone()
            } == *view;
            let same_size = state.statistics.size == *size;
            !same_view || !same_size || *scene != state.scene
        })
    }
}

/// How the picture is compared with the exact one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Compare {
    /// Not at all.
    #[default]
    Off,
    /// The exact picture to the left of this fraction of the width.
    Split(f32),
    /// The error instead of the picture, amplified by this factor.
    Error(u16),
}

/// The error of a picture against the exact one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Judged {
    /// The error.
    pub error: Error,
    /// Of the picture that these settings draw.
    pub settings: Settings,
}

/// An error in words: "largest 3 steps, RMSE 0.02, 1.2% of the bytes differ".
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
        text += &format!(", {} pixels show another triangle", error.coverage);
    }
    text
}

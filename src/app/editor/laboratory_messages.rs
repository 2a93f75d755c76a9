//! Messages of the laboratory to another instance of the program that measures, where there are no
//! threads: in a page, a worker measures while the window stays responsive.

use std::sync::mpsc::Sender;

use serde::{Deserialize, Serialize};

use marraztu_core::accuracy::{Axis, Shot};
use marraztu_core::base::image::Size;
use marraztu_io::{Known, Progress, scene_of_message, scene_to_message};
use marraztu_lab::candidates::Thoroughness;
use marraztu_lab::pairs::{Unmeasured, Watch};
use marraztu_lab::picture_source::Studio;
use marraztu_lab::report::Report;
use marraztu_lab::suite::{self, SUITE, SuiteDetail, SuiteScene};
use marraztu_lab::sweep::{Findings, Question, sweep};
use marraztu_lab::timing::WallClock;

/// A measurement.
#[derive(Debug, Serialize, Deserialize)]
pub(super) enum Job {
    /// Of axes in a scene.
    Sweep { scene: String, size: Size, axes: Vec<String>, thoroughness: String },
    /// Of the suite.
    Suite,
}

/// Results of a measurement.
#[derive(Debug, Serialize, Deserialize)]
enum Told {
    /// The finished fraction, and the findings up to now.
    SoFar(f64, Option<Box<Findings>>),
    /// The end of a sweep.
    Sweep(Result<Box<Findings>, Unmeasured>),
    /// The end of the suite.
    Suite(Result<Vec<Report>, Unmeasured>),
}

impl Job {
    /// Describes a sweep; `None` if its scene cannot be sent.
    pub(super) fn sweep(shot: &Shot, question: &Question) -> Option<Self> {
        let Shot { scene, view, size, .. } = shot;
        let scene = scene_to_message((scene, view, &question.current), None).ok()?;
        let axes = question.axes.iter().map(|axis| axis.key.to_owned()).collect();
        let thoroughness = question.thoroughness.word.to_owned();
        Some(Self::Sweep { scene, size: *size, axes, thoroughness })
    }

    /// Writes the message to the other instance.
    pub(super) fn written(&self) -> Vec<u8> {
        // Texts and numbers always have a JSON form.
        serde_json::to_vec(self).unwrap_or_default()
    }
}

/// Does the measurement of a message of [`CanvasShell::job`](crate::app::CanvasShell::job), and
/// tells results for [`CanvasShell::told`](crate::app::CanvasShell::told).
pub fn measure_job(job: &[u8], tell: &mut dyn FnMut(String)) {
    let written = |told: &Told| serde_json::to_string(told).unwrap_or_default();
    let progress = Progress::new();
    let watch = Watch::default().with(&progress);
    let clock = &mut WallClock::default();
    let end = match serde_json::from_slice(job) {
        Ok(Job::Sweep { scene, size, axes, thoroughness }) => {
            prepared(&scene, size, &axes, &thoroughness).map(|(mut studio, question)| {
                let tell = &mut |findings: &Findings| {
                    let findings = Some(Box::new(findings.clone()));
                    tell(written(&Told::SoFar(progress.fraction(), findings)));
                };
                Told::Sweep(sweep(&mut studio, &question, clock, &watch, tell).map(Box::new))
            })
        }
        Ok(Job::Suite) => {
            let scenes: Vec<&SuiteScene> = SUITE.iter().collect();
            let tell = &mut |_: &Report| tell(written(&Told::SoFar(progress.fraction(), None)));
            Some(Told::Suite(suite::run(&scenes, &SuiteDetail::WHOLE, clock, &watch, tell)))
        }
        Err(_) => None,
    };
    // Any other text loses the task.
    tell(end.map_or_else(|| "the measurement is not understood".to_owned(), |end| written(&end)));
}

/// Prepares a sweep; `None` if it cannot be read.
fn prepared(
    scene: &str,
    size: Size,
    axes: &[String],
    thoroughness: &str,
) -> Option<(Studio, Question)> {
    let (scene, view, current) = scene_of_message(scene, None, &Known::default()).ok()?;
    let axes = axes.iter().filter_map(|key| Axis::named(key)).collect();
    let thoroughness = Thoroughness::named(thoroughness)?;
    let studio = Studio::new(Shot::new(&scene, &view, &current, size));
    Some((studio, Question { current, axes, thoroughness }))
}

/// The receivers of the results of the other instance.
#[derive(Debug)]
pub(super) enum Answers {
    Sweep(Sender<Result<Findings, Unmeasured>>),
    Suite(Sender<Result<Vec<Report>, Unmeasured>>),
}

impl Answers {
    /// Passes results on: calls `so_far` with the fraction that is done and the first findings, or
    /// ends the task. Returns whether more will come. A text that is not understood, as of an
    /// instance that has failed, loses the task.
    pub(super) fn take(&self, told: &str, so_far: impl FnOnce(f64, Option<Findings>)) -> bool {
        // The tasks may have ended before.
        match (serde_json::from_str(told), self) {
            (Ok(Told::SoFar(fraction, findings)), _) => {
                so_far(fraction, findings.map(|findings| *findings));
                return true;
            }
            (Ok(Told::Sweep(findings)), Self::Sweep(sender)) => {
                let _ = sender.send(findings.map(|findings| *findings));
            }
            (Ok(Told::Suite(reports)), Self::Suite(sender)) => {
                let _ = sender.send(reports);
            }
            _ => {}
        }
        false
    }

    /// Ends the task as cancelled.
    pub(super) fn cancel(&self) {
        let _ = match self {
            Self::Sweep(sender) => sender.send(Err(Unmeasured::Cancelled)).is_ok(),
            Self::Suite(sender) => sender.send(Err(Unmeasured::Cancelled)).is_ok(),
        };
    }
}

//! Jobs for another instance of the program, where there are no threads: in a page, workers measure
//! for the laboratory and make files, while the window stays responsive.

use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::mpsc::Sender;

use serde::{Deserialize, Serialize};

use super::orders::{Made, Order};
use marraztu_core::accuracy::{Axis, Settings, Shot};
use marraztu_core::base::image::Size;
use marraztu_core::scene::{Scene, View};
use marraztu_io::{Known, Progress, Sources, scene_of_message, scene_to_message};
use marraztu_lab::candidates::Thoroughness;
use marraztu_lab::pairs::{Unmeasured, Watch};
use marraztu_lab::picture_source::Studio;
use marraztu_lab::report::Report;
use marraztu_lab::suite::{self, SUITE, SuiteDetail, SuiteScene};
use marraztu_lab::sweep::{Findings, Question, sweep};
use marraztu_lab::timing::WallClock;

/// The kinds of jobs. One job of each kind is done at a time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JobKind {
    /// Measuring for the laboratory.
    Measure,
    /// Making a file.
    Make,
}

/// A job, with the scene as a message.
#[derive(Debug, Serialize, Deserialize)]
pub(super) enum Job {
    /// Measuring axes in a scene.
    Sweep { scene: String, size: Size, axes: Vec<String>, thoroughness: String },
    /// Measuring the suite.
    Suite,
    /// Making a file.
    Make { scene: String, order: Order },
}

/// What the other instance tells.
#[derive(Debug, Serialize, Deserialize)]
enum Told {
    /// The finished fraction, and the findings up to now.
    SoFar(f64, Option<Box<Findings>>),
    /// The end of a sweep.
    Sweep(Result<Box<Findings>, Unmeasured>),
    /// The end of the suite.
    Suite(Result<Vec<Report>, Unmeasured>),
    /// The end of making a file.
    Made(Made),
}

impl Told {
    fn written(&self) -> String {
        // Texts and numbers always have a JSON form.
        serde_json::to_string(self).unwrap_or_default()
    }
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

    /// Describes an order; `None` if its scene cannot be sent.
    pub(super) fn make(of: (&Scene, &View, &Settings), order: &Order) -> Option<Self> {
        let scene = scene_to_message(of, None).ok()?;
        Some(Self::Make { scene, order: order.clone() })
    }

    /// Writes the message to the other instance.
    pub(super) fn written(&self) -> Vec<u8> {
        // Texts and numbers always have a JSON form.
        serde_json::to_vec(self).unwrap_or_default()
    }
}

/// Does the job of a message of [`CanvasShell::job`](crate::app::CanvasShell::job). What it tells,
/// and finally returns, is for [`CanvasShell::told`](crate::app::CanvasShell::told); by then, its
/// files are written.
pub fn do_job(job: &[u8], tell: Arc<dyn Fn(String) + Send + Sync>) -> String {
    let end = match serde_json::from_slice(job) {
        Ok(Job::Sweep { scene, size, axes, thoroughness }) => {
            prepared(&scene, size, &axes, &thoroughness).map(|(mut studio, question)| {
                let progress = Progress::new();
                let watch = Watch::default().with(&progress);
                let tell = &mut |findings: &Findings| {
                    let findings = Some(Box::new(findings.clone()));
                    tell(Told::SoFar(progress.fraction(), findings).written());
                };
                let clock = &mut WallClock::default();
                Told::Sweep(sweep(&mut studio, &question, clock, &watch, tell).map(Box::new))
            })
        }
        Ok(Job::Suite) => {
            let scenes: Vec<&SuiteScene> = SUITE.iter().collect();
            let watch = Watch::default().with(&telling(tell));
            let clock = &mut WallClock::default();
            Some(Told::Suite(suite::run(&scenes, &SuiteDetail::WHOLE, clock, &watch, &mut |_| {})))
        }
        Ok(Job::Make { scene, order }) => {
            let opened = scene_of_message(&scene, None, &Known::default()).ok();
            opened.map(|opened| {
                let sources = Sources::of(&opened.0);
                Told::Made(order.fulfil(opened, &sources, &telling(tell)))
            })
        }
        Err(_) => None,
    };
    // Any other text loses the task.
    end.map_or_else(|| "the job is not understood".to_owned(), |end| end.written())
}

/// Returns a progress that tells each per cent.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from 0 to 100")]
fn telling(tell: Arc<dyn Fn(String) + Send + Sync>) -> Progress {
    let last = AtomicU32::new(0);
    Progress::heard_by(move |fraction| {
        let percent = (fraction * 100.0) as u32;
        if last.swap(percent, Ordering::Relaxed) != percent {
            tell(Told::SoFar(fraction, None).written());
        }
    })
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

/// The receiver of the result of the other instance.
#[derive(Debug)]
pub(super) enum Answers {
    Sweep(Sender<Result<Findings, Unmeasured>>),
    Suite(Sender<Result<Vec<Report>, Unmeasured>>),
    Made(Sender<Made>),
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
            (Ok(Told::Made(made)), Self::Made(sender)) => {
                let _ = sender.send(made);
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
            Self::Made(sender) => sender.send(Made::Cancelled).is_ok(),
        };
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;
    use std::sync::{Mutex, PoisonError};

    use super::*;
    use crate::app::documents::picture_dialog::{PictureChoices, Purpose};
    use crate::app::editor::orders::Content;
    use marraztu_core::accuracy::Samples;

    fn orders(folder: &Path) -> Vec<Order> {
        let size = Size::new(64, 48);
        let choices = |purpose| PictureChoices::new(purpose, size, Samples::Four);
        let turntable = PictureChoices { frames: 5, ..choices(Purpose::Turntable) };
        [
            ("a.png", Content::Drawn(choices(Purpose::Picture))),
            ("a.gif", Content::Drawn(turntable)),
            ("a.glb", Content::Exported),
        ]
        .map(|(name, content)| Order { path: folder.join(name), content })
        .into()
    }

    #[test]
    fn a_file_made_by_another_instance_has_the_bytes_of_one_made_here() {
        let [here, there] = [(); 2].map(|()| tempfile::tempdir().unwrap());
        let ((scene, view), settings) = (marraztu_io::default_scene(), Settings::default());
        for (here, there) in orders(here.path()).iter().zip(&orders(there.path())) {
            let of = (scene.clone(), view.clone(), settings);
            let made = here.fulfil(of, &Sources::default(), &Progress::new());
            assert!(matches!(made, Made::Done(..)), "{made:?}");
            let job = Job::make((&scene, &view, &settings), there).unwrap();
            let told = Arc::new(Mutex::new(Vec::new()));
            let heard = Arc::clone(&told);
            let tell = move |told| heard.lock().unwrap_or_else(PoisonError::into_inner).push(told);
            let end = do_job(&job.written(), Arc::new(tell));
            let (sender, receiver) = std::sync::mpsc::channel();
            let (answers, mut parts) = (Answers::Made(sender), Vec::new());
            for told in told.lock().unwrap().iter() {
                assert!(answers.take(told, |fraction, _| parts.push(fraction)));
            }
            assert!(parts.is_sorted() && parts.iter().all(|part| (0.0..=1.0).contains(part)));
            assert!(!answers.take(&end, |_, _| {}));
            let made = receiver.try_recv().unwrap();
            assert!(matches!(&made, Made::Done(path, _) if *path == there.path), "{made:?}");
            let [a, b] = [here, there].map(|order| std::fs::read(&order.path).unwrap());
            assert!(a == b, "{}", there.path.display());
        }
    }

    #[test]
    fn a_message_that_is_not_understood_loses_the_task() {
        let (sender, receiver) = std::sync::mpsc::channel::<Made>();
        let answers = Answers::Made(sender);
        assert!(!answers.take(&do_job(b"nonsense", Arc::new(|_| {})), |_, _| {}));
        drop(answers);
        assert!(receiver.recv().is_err());
    }
}

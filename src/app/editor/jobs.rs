//! Jobs for another instance of the program, where there are no threads: in a page, workers measure
//! for the laboratory, make files and draw comparisons, while the window stays responsive.

use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::mpsc::Sender;

use serde::{Deserialize, Serialize};

use super::orders::{Made, Order};
use crate::app::drawing::worker::message::{read, write};
use crate::app::viewport::comparison::{Compared, Pair, draw};
use marraztu_core::accuracy::{Axis, Samples, Settings, Shot};
use marraztu_core::base::image::{Picture, Size};
use marraztu_core::scene::{Scene, View};
use marraztu_io::{Known, Progress, Sources, scene_of_message, scene_to_message};
use marraztu_lab::candidates::Thoroughness;
use marraztu_lab::error::Error;
use marraztu_lab::pairs::{Unmeasured, Watch};
use marraztu_lab::picture_source::{Reference, Studio};
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
    /// Drawing the picture and its reference.
    Compare,
}

impl JobKind {
    /// All kinds.
    pub const ALL: [Self; 3] = [Self::Measure, Self::Make, Self::Compare];
}

/// A job, with the scene as a message.
#[derive(Debug, Serialize, Deserialize)]
pub(super) enum Job {
    /// Measuring axes in a scene.
    Sweep {
        scene: String,
        size: Size,
        axes: Vec<String>,
        thoroughness: String,
        refined: Option<Samples>,
    },
    /// Measuring the suite.
    Suite,
    /// Making a file.
    Make { scene: String, order: Order },
    /// Comparing with the ideal, or with the picture that is exact in an axis.
    Compare { scene: String, size: Size, axis: Option<String> },
}

/// The progress of a job: the finished fraction, and the findings up to now.
#[derive(Debug, Serialize, Deserialize)]
struct SoFar(f64, Option<Box<Findings>>);

/// The end of a job. Pictures follow.
#[derive(Debug, Serialize, Deserialize)]
enum End {
    Sweep(Result<Box<Findings>, Unmeasured>),
    Suite(Result<Vec<Report>, Unmeasured>),
    Made(Made),
    /// The reference and the picture follow.
    Compared(Size, Error),
}

impl SoFar {
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
        let refined = question.refined;
        Some(Self::Sweep { scene, size: *size, axes, thoroughness, refined })
    }

    /// Describes an order; `None` if its scene cannot be sent.
    pub(super) fn make(of: (&Scene, &View, &Settings), order: &Order) -> Option<Self> {
        let scene = scene_to_message(of, None).ok()?;
        Some(Self::Make { scene, order: order.clone() })
    }

    /// Describes a comparison; `None` if its scene cannot be sent.
    pub(super) fn compare(of: &Compared) -> Option<Self> {
        let Shot { scene, view, settings, size } = &of.shot;
        let scene = scene_to_message((scene, view, settings), None).ok()?;
        let axis = match of.against {
            Reference::Ideal => None,
            Reference::Alone(axis) => Some(axis.key.to_owned()),
        };
        Some(Self::Compare { scene, size: *size, axis })
    }

    /// Writes the message to the other instance.
    pub(super) fn written(&self) -> Vec<u8> {
        // Texts and numbers always have a JSON form.
        serde_json::to_vec(self).unwrap_or_default()
    }
}

/// Does the job of a message of [`CanvasShell::job`](crate::app::CanvasShell::job). Its progress is
/// for [`CanvasShell::told`](crate::app::CanvasShell::told). The result is for
/// [`CanvasShell::done`](crate::app::CanvasShell::done), and is empty if the message is not
/// understood. By then, the files of the job are written.
pub fn do_job(job: &[u8], tell: Arc<dyn Fn(String) + Send + Sync>) -> Vec<u8> {
    let opened = |scene: &str| scene_of_message(scene, None, &Known::default()).ok();
    let clock = &mut WallClock::default();
    let end = match serde_json::from_slice(job) {
        Ok(Job::Sweep { scene, size, axes, thoroughness, refined }) => {
            prepared(&scene, size, (&axes, &thoroughness, refined)).map(|(mut studio, question)| {
                let progress = Progress::new();
                let watch = Watch::default().with(&progress);
                let tell = &mut |findings: &Findings| {
                    let findings = Some(Box::new(findings.clone()));
                    tell(SoFar(progress.fraction(), findings).written());
                };
                End::Sweep(sweep(&mut studio, &question, clock, &watch, tell).map(Box::new))
            })
        }
        Ok(Job::Suite) => {
            let scenes: Vec<&SuiteScene> = SUITE.iter().collect();
            let watch = Watch::default().with(&telling(tell));
            Some(End::Suite(suite::run(&scenes, &SuiteDetail::WHOLE, clock, &watch, &mut |_| {})))
        }
        Ok(Job::Make { scene, order }) => opened(&scene).map(|opened| {
            let sources = Sources::of(&opened.0);
            End::Made(order.fulfil(opened, &sources, &telling(tell)))
        }),
        Ok(Job::Compare { scene, size, axis }) => {
            let against = axis.as_deref().and_then(Axis::named);
            let against = against.map_or(Reference::Ideal, Reference::Alone);
            let of = opened(&scene).map(|(scene, view, settings)| Compared {
                shot: Shot { scene, view, settings, size },
                against,
            });
            let pair = of.and_then(|of| draw(of, &Progress::new()));
            return pair.map_or_else(Vec::new, |Pair { of, exact, ours, error }| {
                let pictures = [&exact, &ours].map(|picture| picture.pixels().as_flattened());
                write(&End::Compared(of.shot.size, error), &pictures)
            });
        }
        Err(_) => None,
    };
    end.map_or_else(Vec::new, |end| write(&end, &[]))
}

/// Returns a progress that tells each per cent.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from 0 to 100")]
fn telling(tell: Arc<dyn Fn(String) + Send + Sync>) -> Progress {
    let last = AtomicU32::new(0);
    Progress::heard_by(move |fraction| {
        let percent = (fraction * 100.0) as u32;
        if last.swap(percent, Ordering::Relaxed) != percent {
            tell(SoFar(fraction, None).written());
        }
    })
}

/// Prepares a sweep; `None` if it cannot be read.
fn prepared(
    scene: &str,
    size: Size,
    (axes, thoroughness, refined): (&[String], &str, Option<Samples>),
) -> Option<(Studio, Question)> {
    let (scene, view, current) = scene_of_message(scene, None, &Known::default()).ok()?;
    let axes = axes.iter().filter_map(|key| Axis::named(key)).collect();
    let thoroughness = Thoroughness::named(thoroughness)?;
    let studio = Studio::new(Shot { scene, view, settings: current, size });
    Some((studio, Question { current, axes, thoroughness, refined }))
}

/// The receiver of the result of the other instance.
#[derive(Debug)]
pub(super) enum Answers {
    Sweep(Sender<Result<Findings, Unmeasured>>),
    Suite(Sender<Result<Vec<Report>, Unmeasured>>),
    Made(Sender<Made>),
    Compared(Sender<Option<Box<Pair>>>, Box<Compared>),
}

/// A job that another instance does.
#[derive(Debug, Default)]
pub(crate) struct Elsewhere {
    /// The job, until it is taken.
    job: Option<Job>,
    /// Receives the result.
    answers: Option<Answers>,
}

impl Elsewhere {
    pub(super) const fn new(job: Job, answers: Answers) -> Self {
        Self { job: Some(job), answers: Some(answers) }
    }

    /// Returns the job, if it was not taken yet.
    pub(crate) fn take_job(&mut self) -> Option<Vec<u8>> {
        self.job.take().map(|job| job.written())
    }

    /// Returns whether another instance does the job now.
    pub(super) const fn is_taken(&self) -> bool {
        self.job.is_none() && self.answers.is_some()
    }

    pub(crate) const fn is_awaited(&self) -> bool {
        self.answers.is_some()
    }

    pub(crate) fn end(&mut self, end: &[u8]) {
        if let Some(answers) = self.answers.take() {
            answers.end(end);
        }
    }

    /// Ends the job as cancelled.
    pub(super) fn cancel(&mut self) {
        self.job = None;
        if let Some(answers) = self.answers.take() {
            answers.cancel();
        }
    }
}

/// Reads the progress of a job: the finished fraction, and the findings up to now.
pub(super) fn so_far(told: &str) -> Option<(f64, Option<Findings>)> {
    let SoFar(fraction, findings) = serde_json::from_str(told).ok()?;
    Some((fraction, findings.map(|findings| *findings)))
}

impl Answers {
    /// Passes the end of the job on. An end that is not understood, as of an instance that has
    /// failed, loses the task.
    pub(super) fn end(self, end: &[u8]) {
        let Some((end, mut pictures)) = read(end) else { return };
        // The tasks may have ended before.
        match (end, self) {
            (End::Sweep(findings), Self::Sweep(sender)) => {
                let _ = sender.send(findings.map(|findings| *findings));
            }
            (End::Suite(reports), Self::Suite(sender)) => {
                let _ = sender.send(reports);
            }
            (End::Made(made), Self::Made(sender)) => {
                let _ = sender.send(made);
            }
            (End::Compared(size, error), Self::Compared(sender, of)) => {
                let mut next = || {
                    let (pixels, _) = pictures.take([size.width, size.height])?.as_chunks();
                    Picture::from_pixels(size, pixels.to_vec())
                };
                if let (Some(exact), Some(ours)) = (next(), next()) {
                    let _ = sender.send(Some(Box::new(Pair { of: *of, exact, ours, error })));
                }
            }
            _ => {}
        }
    }

    /// Ends the task as cancelled.
    pub(super) fn cancel(self) {
        let _ = match self {
            Self::Sweep(sender) => sender.send(Err(Unmeasured::Cancelled)).is_ok(),
            Self::Suite(sender) => sender.send(Err(Unmeasured::Cancelled)).is_ok(),
            Self::Made(sender) => sender.send(Made::Cancelled).is_ok(),
            Self::Compared(sender, _) => sender.send(None).is_ok(),
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
    use marraztu_io::ExportOptions;

    fn orders(folder: &Path) -> Vec<Order> {
        let size = Size::new(64, 48);
        let choices = |purpose| PictureChoices::new(purpose, size, Samples::Four);
        let turntable = PictureChoices { frames: 5, ..choices(Purpose::Turntable) };
        [
            ("a.png", Content::Drawn(choices(Purpose::Picture))),
            ("a.gif", Content::Drawn(turntable)),
            ("a.glb", Content::Exported(ExportOptions::MODELS)),
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
            let told = told.lock().unwrap();
            let parts: Vec<f64> = told.iter().map(|told| so_far(told).unwrap().0).collect();
            assert!(parts.is_sorted() && parts.iter().all(|part| (0.0..=1.0).contains(part)));
            Answers::Made(sender).end(&end);
            let made = receiver.try_recv().unwrap();
            assert!(matches!(&made, Made::Done(path, _) if *path == there.path), "{made:?}");
            let [a, b] = [here, there].map(|order| std::fs::read(&order.path).unwrap());
            assert!(a == b, "{}", there.path.display());
        }
    }

    #[test]
    fn a_message_that_is_not_understood_loses_the_task() {
        let (sender, receiver) = std::sync::mpsc::channel::<Made>();
        Answers::Made(sender).end(&do_job(b"nonsense", Arc::new(|_| {})));
        assert!(receiver.recv().is_err());
    }

    #[test]
    fn a_comparison_by_another_instance_has_the_pixels_of_one_drawn_here() {
        let (scene, view) = marraztu_io::default_scene();
        let (settings, size) = (Settings::default(), Size::new(40, 30));
        for against in [Reference::Ideal, Reference::Alone(Axis::named("depth").unwrap())] {
            let of = Compared { shot: Shot::new(&scene, &view, &settings, size), against };
            let (sender, receiver) = std::sync::mpsc::channel();
            let job = Job::compare(&of).unwrap().written();
            Answers::Compared(sender, Box::new(of.clone())).end(&do_job(&job, Arc::new(|_| {})));
            let (there, here) = (receiver.recv().unwrap().unwrap(), draw(of, &Progress::new()));
            let here = here.unwrap();
            assert!(there.exact == here.exact && there.ours == here.ours && there.of == here.of);
            assert_eq!(there.error, here.error);
        }
    }
}

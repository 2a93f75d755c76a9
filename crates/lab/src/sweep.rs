//! Measures the cost of accuracy: every choice of every axis against the default.
//!
//! Two references are drawn first, whatever the current settings: the picture with every axis at
//! its most exact choice, and the mean of 256 samples per pixel, each lit. Most choices are judged
//! against the first, samples per pixel against the second. The default is measured against itself.
//! The spread of this control is the noise floor: smaller differences are ignored. Every candidate
//! is then measured against the default in the same process, in alternation.
//!
//! Verdicts, plots and pages all use one interval, [`Ratio::noise`]: the larger of the control's
//! noise and the ratio's own. Two choices differ in time only if their intervals do not overlap.
//! The control alone is not enough: it is measured once, at the beginning, and other load may start
//! later.

use fearless_simd::Level;
use serde::Serialize;

use super::candidates::{Candidate, Candidates, Group, LeftOut, Thoroughness, candidates};
use super::error::{Error, Figures, Rendering};
use super::instructions;
use super::kernels::{self, Kernel};
use super::pairs::{Ratio, Unmeasured, Watch, measure};
use super::picture_source::{PictureSource, Studio, hash};
use super::statistics::Quartiles;
use super::timing::Clock;
use marraztu_core::accuracy::Shot;
use marraztu_core::accuracy::{AXES, Axis, AxisKind, Settings};
use marraztu_core::base::image::Size;

/// The task of a sweep.
#[derive(Clone, Debug)]
pub struct Question {
    /// The current settings.
    pub current: Settings,
    /// The axes to measure.
    pub axes: Vec<&'static Axis>,
    /// The thoroughness of the sweep.
    pub thoroughness: Thoroughness,
}

/// The results of a sweep.
#[derive(Clone, Debug, Serialize)]
pub struct Findings {
    /// The picture's width and height.
    pub size: [usize; 2],
    /// The number of threads.
    pub threads: usize,
    /// The SIMD instruction set.
    pub instructions: String,
    /// The name of the thoroughness.
    pub thoroughness: &'static str,
    /// The default measured against itself.
    pub control: Ratio,
    /// The noise of the control: the largest distance of its quartiles from 1. It is the minimum
    /// for all rows.
    pub floor: f64,
    /// The current settings.
    pub current: Settings,
    /// The distinct settings that were measured; the first is the default.
    pub points: Vec<Measured>,
    /// The rows of the table. Each refers to a point.
    pub rows: Vec<Row>,
    /// Settings that were not measured, with the reason.
    pub left_out: Vec<LeftOut>,
    /// Small kernels, plain and with SIMD.
    pub kernels: Vec<Kernel>,
}

/// Settings with their time and error.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Measured {
    /// The first name under which the settings were measured.
    pub name: String,
    /// The settings.
    pub settings: Settings,
    /// The milliseconds of a picture: the default's median times the ratio.
    pub ms: f64,
    /// The time relative to the default.
    pub ratio: Ratio,
    /// Whether the ratio exceeds the noise: see [`Findings::noise_of`].
    pub verdict: Verdict,
    /// The error against the reference: every axis at its most exact, one sample per pixel.
    pub error: Error,
    /// The error against 256 samples per pixel, each lit; `None` for models other than the current
    /// one.
    pub sampled: Option<Error>,
    /// The difference from the default's picture.
    pub change: Figures,
    /// The picture's hash, as 16 hexadecimal digits.
    pub hash: String,
}

/// The reference of a row's picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Against {
    /// Every axis at its most exact choice, one sample per pixel.
    Exact,
    /// 256 samples per pixel, each lit.
    Sampled,
    /// The reference of a model other than the current one.
    Model,
}

impl Against {
    /// Returns the name in tables.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::Sampled => "256 samples",
            Self::Model => "model",
        }
    }

    /// Returns the reference of a candidate.
    fn of(candidate: &Candidate, base: &Settings) -> Self {
        let Candidate { group, settings, .. } = candidate;
        let apart = |axis: &Axis| axis.kind == AxisKind::ScoredApart;
        let differs = |axis: &&Axis| apart(axis) && !axis.default_choice().is(settings);
        if settings.modelled_as(base) != *settings {
            Self::Model
        } else if AXES.iter().any(|axis| differs(&axis))
            || matches!(group, Group::Axis(key) if Axis::named(key).is_some_and(apart))
        {
            Self::Sampled
        } else {
            Self::Exact
        }
    }
}

/// The significance of a ratio.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// Faster than the default, beyond the noise.
    Faster,
    /// Slower than the default, beyond the noise.
    Slower,
    /// Within the noise.
    Alike,
}

/// A row of the table.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// The group of the row.
    #[serde(flatten)]
    pub group: Group,
    /// The name in the group.
    pub name: String,
    /// The index of the point.
    pub point: usize,
    /// The reference of the row.
    pub against: Against,
}

impl Findings {
    /// Returns the error of a row against its own reference.
    #[must_use]
    pub fn error_of(&self, row: &Row) -> &Error {
        let point = &self.points[row.point];
        match row.against {
            Against::Exact | Against::Model => &point.error,
            Against::Sampled => point.sampled.as_ref().unwrap_or(&point.error),
        }
    }

    /// Returns the interval of a point's ratio to the default. Two points differ in time if their
    /// intervals do not overlap.
    #[must_use]
    pub fn noise_of(&self, point: usize) -> [f64; 2] {
        if point == 0 { DEFAULT } else { self.points[point].ratio.noise(self.floor) }
    }

    /// Returns the smallest and the largest noise of some points, as fractions. The noise of a
    /// point is the larger distance of its median to the ends of its interval. Without points, it
    /// is the control's.
    #[must_use]
    pub fn noises(&self, points: impl Iterator<Item = usize>) -> [f64; 2] {
        let noise = |point: usize| {
            let median = self.points[point].ratio.quartiles.median;
            let [lower, upper] = self.noise_of(point);
            (median / lower - 1.0).max(upper / median - 1.0)
        };
        let noises = points.filter(|point| *point != 0).map(noise);
        let ends = |ends: Option<[f64; 2]>, noise: f64| {
            Some(ends.map_or([noise; 2], |[least, most]| [least.min(noise), most.max(noise)]))
        };
        noises.fold(None, ends).unwrap_or([self.floor; 2])
    }

    /// Returns the rows of an axis, from coarse to exact.
    pub fn rows_of<'a>(&'a self, axis: &'a Axis) -> impl Iterator<Item = &'a Row> {
        self.rows.iter().filter(move |row| row.group == Group::Axis(axis.key))
    }
}

/// The interval of the default's ratio to itself.
const DEFAULT: [f64; 2] = [1.0; 2];

impl Verdict {
    /// Judges a ratio to the default, ignoring differences up to `floor`.
    #[must_use]
    pub fn of(ratio: &Ratio, floor: f64) -> Self {
        Self::between(ratio.noise(floor), DEFAULT)
    }

    /// Judges one choice against another by the intervals of their ratios: they differ only if the
    /// intervals do not overlap.
    #[must_use]
    pub fn between(one: [f64; 2], other: [f64; 2]) -> Self {
        if one[1] < other[0] {
            Self::Faster
        } else if one[0] > other[1] {
            Self::Slower
        } else {
            Self::Alike
        }
    }

    /// Returns the name in tables.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Faster => "faster",
            Self::Slower => "slower",
            Self::Alike => "alike",
        }
    }
}

/// Measures a scene. `tell` is called with the results so far after every choice.
///
/// # Errors
/// If it was cancelled or disturbed, or if a picture was not reproducible.
pub fn sweep(
    studio: &mut Studio,
    question: &Question,
    clock: &mut dyn Clock,
    watch: &Watch,
    tell: &mut dyn FnMut(&Findings),
) -> Result<Findings, Unmeasured> {
    let combinations = question.thoroughness.combinations;
    let Shot { scene, view, size, .. } = studio.shot().clone();
    let candidates = candidates(&scene, &view, &question.current, &question.axes, combinations);
    let mut bench = Bench { clock, source: studio, watch, question, size };
    bench.run(candidates, tell)
}

/// The context of a sweep.
pub struct Bench<'a> {
    /// Measures time.
    pub clock: &'a mut dyn Clock,
    /// Draws the pictures.
    pub source: &'a mut dyn PictureSource,
    /// Connects the sweep with the user.
    pub watch: &'a Watch,
    /// The task.
    pub question: &'a Question,
    /// The picture's size.
    pub size: Size,
}

impl std::fmt::Debug for Bench<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Bench").field("question", self.question).finish_non_exhaustive()
    }
}

impl Bench<'_> {
    /// Measures candidates; the first is the default.
    ///
    /// # Errors
    /// The same as [`sweep`].
    pub fn run(
        &mut self,
        candidates: Candidates,
        tell: &mut dyn FnMut(&Findings),
    ) -> Result<Findings, Unmeasured> {
        let begun = self.clock.now();
        let thoroughness = self.question.thoroughness;
        let Candidates { all, left_out } = candidates;
        let base = all.first().expect("the default is always measured").settings;
        // The references are drawn first, once, outside the timed part.
        let mut references = References {
            exact: vec![(base.reference(), self.source.rendering(&base.reference()))],
            sampled: self.source.sampled(&base),
            default: self.source.rendering(&base),
        };
        self.watch.progress.reached(0, all.len())?;
        // The control measures the default against itself, which gives the noise floor.
        let control = self.measured(&base, &base)?;
        let mut findings = self.begin(control, left_out);
        // Each kernel counts as a choice.
        let steps = all.len() + kernels::COUNT;
        let mut late = 0;
        for (i, candidate) in all.into_iter().enumerate() {
            self.watch.progress.reached(i, steps)?;
            // Only combinations are dropped for lack of time; single axes are always measured.
            let is_late = self.clock.now().saturating_sub(begun) >= thoroughness.time;
            if candidate.group == Group::Combination && is_late {
                late += 1;
                continue;
            }
            self.add(&mut findings, &base, candidate, &mut references)?;
            tell(&findings);
        }
        if late > 0 {
            findings.left_out.push(LeftOut {
                what: format!("{late} combinations"),
                reason: "the time was up".to_owned(),
            });
        }
        for i in 0..kernels::COUNT {
            self.watch.progress.reached(steps - kernels::COUNT + i, steps)?;
            let limits = &thoroughness.limits;
            findings.kernels.push(kernels::measure(i, self.clock, limits, self.watch)?);
        }
        Ok(findings)
    }

    fn begin(&self, control: Ratio, left_out: Vec<LeftOut>) -> Findings {
        let Quartiles { lower, median, upper } = control.quartiles;
        let floor =
            [lower, median, upper].iter().fold(0.0, |most: f64, x| most.max((x - 1.0).abs()));
        Findings {
            size: [self.size.width, self.size.height],
            threads: rayon::current_num_threads(),
            instructions: instructions::name_of(Level::new()),
            thoroughness: self.question.thoroughness.word,
            control,
            floor,
            current: self.question.current,
            points: Vec::new(),
            rows: Vec::new(),
            left_out,
            kernels: Vec::new(),
        }
    }

    fn measured(&mut self, a: &Settings, b: &Settings) -> Result<Ratio, Unmeasured> {
        measure(self.clock, self.source, [a, b], &self.question.thoroughness.limits, self.watch)
    }

    /// Measures a candidate, unless its settings were measured under another name.
    fn add(
        &mut self,
        findings: &mut Findings,
        base: &Settings,
        candidate: Candidate,
        references: &mut References,
    ) -> Result<(), Unmeasured> {
        let against = Against::of(&candidate, base);
        let Candidate { group, name, settings } = candidate;
        let known = findings.points.iter().position(|point| point.settings == settings);
        let point = match known {
            Some(point) => point,
            None => {
                let point = self.point(findings, base, settings, references)?;
                findings.points.push(point);
                findings.points.len() - 1
            }
        };
        // The current settings get a row only if no other row shows them.
        if group != Group::Current || known.is_none() {
            findings.rows.push(Row { group, name, point, against });
        }
        Ok(())
    }

    fn point(
        &mut self,
        findings: &Findings,
        base: &Settings,
        settings: Settings,
        references: &mut References,
    ) -> Result<Measured, Unmeasured> {
        let a_ms = findings.control.a_ms;
        // All times are relative to the default. Its own ratio is the control's.
        let (ratio, ms) = if settings == *base {
            (findings.control.clone(), a_ms)
        } else {
            let ratio = self.measured(base, &settings)?;
            let ms = a_ms * ratio.quartiles.median;
            (ratio, ms)
        };
        // Each model has its own exact reference, drawn on first use.
        let reference = settings.reference();
        if references.exact.iter().all(|(settings, _)| *settings != reference) {
            references.exact.push((reference, self.source.rendering(&reference)));
        }
        let exact = references.exact.iter().find(|(settings, _)| *settings == reference);
        let (_, exact) = exact.expect("it was drawn if it was not there");
        let rendering = self.source.rendering(&settings);
        let is_model = settings.modelled_as(base) != settings;
        Ok(Measured {
            name: settings.in_words(),
            settings,
            ms,
            verdict: Verdict::of(&ratio, findings.floor),
            ratio,
            error: rendering.error(exact),
            sampled: (!is_model).then(|| rendering.error(&references.sampled)),
            change: rendering.change(&references.default),
            hash: format!("{:016x}", hash(rendering.picture())),
        })
    }
}

/// The reference pictures of errors.
struct References {
    /// Every axis at its most exact, with the settings: one per model, the default's first.
    exact: Vec<(Settings, Rendering)>,
    /// 256 samples per pixel.
    sampled: Rendering,
    /// The default's picture.
    default: Rendering,
}

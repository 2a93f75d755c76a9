//! Measures the cost of accuracy: every choice of every axis against the default.
//!
//! Two questions are answered, each with its own reference. How far is a picture from the truth?
//! The [ideal](marraztu_core::accuracy::Settings::ideal) answers, which is drawn once. What does
//! one choice change? The picture that differs in its axis alone answers, with that axis at its
//! most exact: aliasing, which is the same in both, hides nothing. Rows of axes show the second
//! error; presets, combinations and the current settings show the first.
//!
//! The default is measured against itself. The spread of this control is the noise floor: smaller
//! differences are ignored. Every candidate is then measured against the default in the same
//! process, in alternation.
//!
//! Verdicts, plots and pages all use one interval, [`Ratio::noise`]: the larger of the control's
//! noise and the ratio's own. Two choices differ in time only if their intervals do not overlap.
//! The control alone is not enough: it is measured once, at the beginning, and other load may start
//! later.

use fearless_simd::Level;
use serde::{Deserialize, Serialize};

use super::candidates::{Candidate, Candidates, Group, LeftOut, Thoroughness, candidates};
use super::error::{Error, Figures, Rendering};
use super::instructions;
use super::kernels::{self, Kernel};
use super::pairs::{Ratio, Unmeasured, Watch, measure};
use super::picture_source::{PictureSource, Reference, Studio, hash};
use super::statistics::Quartiles;
use super::timing::{Clock, Work};
use super::word::Word;
use marraztu_core::accuracy::Shot;
use marraztu_core::accuracy::{Axis, Samples, Settings};
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
    /// The samples per pixel of a picture at rest; `None` if it stays as it is drawn.
    pub refined: Option<Samples>,
}

impl Question {
    /// Asks about pictures that have the samples of a picture in a file when nothing moves.
    pub const fn new(
        current: Settings,
        axes: Vec<&'static Axis>,
        thoroughness: Thoroughness,
    ) -> Self {
        Self { current, axes, thoroughness, refined: Some(Settings::REFINED) }
    }

    /// Returns the settings of a picture at rest.
    pub fn at_rest(&self, settings: &Settings) -> Settings {
        settings.at_rest(self.refined)
    }
}

/// The results of a sweep.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Findings {
    /// The picture's width and height.
    pub size: [usize; 2],
    /// The number of threads.
    pub threads: usize,
    /// The SIMD instruction set.
    pub instructions: String,
    /// The name of the thoroughness.
    #[serde(deserialize_with = "crate::word::read")]
    pub thoroughness: Word,
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
    /// Whether everything was measured: not while the sweep runs, or if it was cancelled.
    pub complete: bool,
}

/// Settings with their time and error.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
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
    /// The error against the ideal; `None` for models other than the current one, and if the
    /// ideal was not drawn.
    pub ideal: Option<Error>,
    /// The difference from the default's picture.
    pub change: Figures,
    /// The picture's hash, as 16 hexadecimal digits.
    pub hash: String,
}

/// The reference of a row's picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Against {
    /// The ideal.
    Ideal,
    /// The default with the row's axis at its most exact choice.
    Axis,
}

impl Against {
    /// Returns the name in tables.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Ideal => "ideal",
            Self::Axis => "axis",
        }
    }
}

/// The significance of a ratio.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// Faster than the default, beyond the noise.
    Faster,
    /// Slower than the default, beyond the noise.
    Slower,
    /// Within the noise.
    Alike,
    /// The machine was too busy to tell: see [`TOO_BUSY`].
    Busy,
}

/// With more noise than this, two choices are not called equally fast: a difference that people
/// care about may be hidden.
pub const TOO_BUSY: f64 = 0.2;

/// A row of the table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// The group of the row.
    #[serde(flatten)]
    pub group: Group,
    /// The name in the group.
    pub name: String,
    /// The index of the point.
    pub point: usize,
    /// The settings to choose for this picture: at rest, it may have more samples than chosen.
    pub chosen: Settings,
    /// The reference of the row.
    pub against: Against,
    /// The error against it.
    pub error: Error,
}

impl Findings {
    /// Returns the interval of a point's ratio to the default. Two points differ in time if their
    /// intervals do not overlap.
    pub fn noise_of(&self, point: usize) -> [f64; 2] {
        if point == 0 { DEFAULT } else { self.points[point].ratio.noise(self.floor) }
    }

    /// Returns the smallest and the largest noise of some points, as fractions. The noise of a
    /// point is the larger distance of its median to the ends of its interval. Without points, it
    /// is the control's.
    pub fn noises(&self, points: impl Iterator<Item = usize>) -> [f64; 2] {
        let noise = |point: usize| {
            noise_from(self.points[point].ratio.quartiles.median, self.noise_of(point))
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

/// The larger distance of a ratio to the ends of its interval, as a fraction.
fn noise_from(ratio: f64, [lower, upper]: [f64; 2]) -> f64 {
    (ratio / lower - 1.0).max(upper / ratio - 1.0)
}

/// The interval of the default's ratio to itself.
const DEFAULT: [f64; 2] = [1.0; 2];

impl Verdict {
    /// Judges a ratio to the default, ignoring differences up to `floor`.
    pub fn of(ratio: &Ratio, floor: f64) -> Self {
        let (noise, median) = (ratio.noise(floor), ratio.quartiles.median);
        match Self::between(noise, DEFAULT) {
            Self::Alike if noise_from(median, noise) > TOO_BUSY => Self::Busy,
            verdict => verdict,
        }
    }

    /// Judges one choice against another by the intervals of their ratios: they differ only if the
    /// intervals do not overlap.
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
    pub const fn word(self) -> &'static str {
        match self {
            Self::Faster => "faster",
            Self::Slower => "slower",
            Self::Alike => "alike",
            Self::Busy => "busy",
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
    let Shot { scene, view, size, .. } = studio.shot().clone();
    let candidates = candidates(&scene, &view, question);
    let mut bench = Bench { clock, source: studio, watch, question, size };
    bench.run(candidates, tell)
}

/// The share of the progress for drawing the ideal.
const IDEAL: f64 = 0.2;

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
        // The references are drawn once, outside the timed part, except that the ideal is timed.
        let mut references = References { ideal_ms: 0.0, drawn: Vec::new() };
        references.place(self.source, base);
        if thoroughness.presets {
            let (ideal, source) = (base.ideal(), &mut *self.source);
            let progress = self.watch.progress.part(0.0, IDEAL);
            let draw = &mut || source.draw_slowly(&ideal, &progress);
            let time = self.clock.time(Work::Picture(&ideal), draw);
            references.ideal_ms = time.as_secs_f64() * 1e3;
            references.drawn.push((ideal, self.source.last_rendering(&ideal)));
        }
        let ideal = if thoroughness.presets { IDEAL } else { 0.0 };
        let progress = self.watch.progress.part(ideal, 1.0);
        progress.reached(0, all.len())?;
        // The control measures the default against itself, which gives the noise floor.
        let control = self.measured(&base, &base)?;
        let mut findings = self.begin(control, left_out);
        // Each kernel counts as a choice; those are not measured for a single axis.
        let kernels = if thoroughness.presets { kernels::COUNT } else { 0 };
        let steps = all.len() + kernels;
        let mut late = 0;
        for (i, candidate) in all.into_iter().enumerate() {
            progress.reached(i, steps)?;
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
        for i in 0..kernels {
            progress.reached(steps - kernels + i, steps)?;
            let limits = &thoroughness.limits;
            findings.kernels.push(kernels::measure(i, self.clock, limits, self.watch)?);
        }
        findings.complete = true;
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
            complete: false,
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
        let Candidate { group, name, chosen, settings } = candidate;
        let known = findings.points.iter().position(|point| point.settings == settings);
        let point = match known {
            Some(point) => point,
            None => {
                let name = match group {
                    Group::Preset => name.clone(),
                    Group::Axis(_) | Group::Current | Group::Combination => settings.in_words(),
                };
                let point = self.point(findings, base, (name, settings), references)?;
                findings.points.push(point);
                findings.points.len() - 1
            }
        };
        // The current settings get a row only if no other row shows them.
        if group == Group::Current && known.is_some() {
            return Ok(());
        }
        let axis = match group {
            Group::Axis(key) => Axis::named(key),
            Group::Preset | Group::Current | Group::Combination => None,
        };
        let reference = axis.map_or(Reference::Ideal, Reference::Alone);
        let against = if axis.is_some() { Against::Axis } else { Against::Ideal };
        let (exact, own) = (reference.of(&settings), settings);
        let [exact, own] = [exact, own].map(|settings| references.place(self.source, settings));
        let error = references.drawn[own].1.error(&references.drawn[exact].1);
        findings.rows.push(Row { group, name, point, chosen, against, error });
        Ok(())
    }

    fn point(
        &mut self,
        findings: &Findings,
        base: &Settings,
        (name, settings): (String, Settings),
        references: &mut References,
    ) -> Result<Measured, Unmeasured> {
        let a_ms = findings.control.a_ms;
        // All times are relative to the default, whose own ratio is 1 with the control's spread.
        // The ideal is too slow to be drawn again.
        let ratio = if settings == *base {
            findings.control.around_one()
        } else if settings == base.ideal() {
            Ratio::once(references.ideal_ms / a_ms, a_ms)
        } else {
            self.measured(base, &settings)?
        };
        let is_model = settings.modelled_as(base) != settings;
        let [own, default] =
            [settings, *base].map(|settings| references.place(self.source, settings));
        let is_judged = !is_model && self.question.thoroughness.presets;
        let ideal = is_judged.then(|| references.place(self.source, base.ideal()));
        let rendering = &references.drawn[own].1;
        Ok(Measured {
            name,
            settings,
            ms: if settings == *base { a_ms } else { a_ms * ratio.quartiles.median },
            verdict: Verdict::of(&ratio, findings.floor),
            ratio,
            ideal: ideal.map(|ideal| rendering.error(&references.drawn[ideal].1)),
            change: rendering.change(&references.drawn[default].1),
            hash: format!("{:016x}", hash(rendering.picture())),
        })
    }
}

/// The pictures drawn so far, by their settings.
struct References {
    /// The milliseconds of the ideal.
    ideal_ms: f64,
    drawn: Vec<(Settings, Rendering)>,
}

impl References {
    /// Returns the place of the picture with these settings, and draws it on first use.
    fn place(&mut self, source: &mut dyn PictureSource, settings: Settings) -> usize {
        let known = self.drawn.iter().position(|(other, _)| *other == settings);
        known.unwrap_or_else(|| {
            self.drawn.push((settings, source.rendering(&settings)));
            self.drawn.len() - 1
        })
    }
}

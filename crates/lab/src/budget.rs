//! Finds settings for a budget: the most exact within a time, or the fastest within an error.
//!
//! The axes have far too many combinations to draw, so the search is guided by a model: the time
//! ratios of choices multiply, and their squared errors add up. Around the best settings so far,
//! each single choice is measured. The model predicts the best combinations of them, which are
//! measured in turn, and the search continues from the best one until it stays the best. Then
//! successive halving decides among the contenders: they are drawn again and compared with more
//! windows of the ideal, and the better half remains.
//!
//! Successive halving: Jamieson and Talwalkar, "Non-stochastic Best Arm Identification and
//! Hyperparameter Optimization", AISTATS 2016.

mod meter;
pub(crate) mod model;

use std::cmp::Ordering;
use std::time::Duration;

use super::candidates::is_historical;
use super::picture_source::PictureSource;
use super::timing::Clock;
use marraztu_core::accuracy::{AXES, AccuracyPreset, Axis, AxisKind, Choice, Samples, Settings};
use marraztu_core::accuracy::{Resolution, Shot};

pub use self::meter::Measured;
use self::meter::Meter;
use self::model::{Step, predictions};
pub use crate::flip::VISIBLE;

/// The time after which no other settings are tried, and the one if fewer pictures were drawn.
const SEARCHING: Duration = Duration::from_secs(1);
const SEARCHING_SLOWLY: Duration = Duration::from_secs(4);
const LEAST_PICTURES: usize = 40;

/// The time for windows before the search, in each round of halving, and for the answer.
const FIRST_WINDOWS: Duration = Duration::from_millis(300);
const ROUND: Duration = Duration::from_millis(100);
const REFINING: Duration = Duration::from_millis(1500);

/// The time for comparing the rest of the picture with the ideal, pixel by pixel.
const COMPARING: Duration = Duration::from_secs(4);

/// The settings that enter the first round of halving.
const CONTENDERS: usize = 4;

/// The most settings that are refined before the goal is given up.
const TRIES: usize = 24;

/// Presets that take this many times as long as settings that reach the goal are not refined.
const SLOW: f64 = 3.0;

/// The predicted combinations that are measured in each round of the search.
const PREDICTIONS: usize = 6;

/// The most rounds of the search.
const ROUNDS: usize = 6;

/// A choice has to save this part of the time; less is noise.
const WORTHWHILE: f64 = 0.05;

/// A squared error that is larger by this factor is no disadvantage: 1% of the error.
const EQUAL: f64 = 1.02;

/// The times that two choices are drawn in turn before one is preferred, at least and at most, and
/// the milliseconds after which that ends.
const PAIRS: [usize; 2] = [2, 5];
const PAIRING: f64 = 200.0;

/// The axes that change times and errors most: they are tried first.
const FIRST_AXES: [&str; 9] = [
    "shading",
    "transparency",
    "shadow-method",
    "light-samples",
    "bounces",
    "samples",
    "resolution",
    "filter",
    "bumps",
];

/// What is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Goal {
    /// The most exact picture within these milliseconds.
    Within(f64),
    /// The fastest picture with at most this root mean square error against the ideal, in byte
    /// steps.
    Error(f64),
    /// The fastest picture without a pixel that visibly differs from the ideal: [`VISIBLE`].
    Unseen,
}

/// The settings for a goal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Answer {
    /// The settings, and what they reach. If the goal is not reached, the nearest ones.
    pub measured: Measured,
    /// Whether they reach the goal.
    pub is_reached: bool,
    /// The part of the picture that was compared with the ideal, from 0 to 1.
    pub compared: f64,
}

/// Searches the settings of a shot for a goal. Models, and the axes in `fixed`, keep the choices of
/// the shot.
pub fn search(
    source: &mut dyn PictureSource,
    clock: &mut dyn Clock,
    shot: &Shot,
    (goal, fixed): (Goal, &[&'static Axis]),
) -> Answer {
    let free = free_axes(shot, fixed);
    let guides = guides(shot, &free);
    let mut meter = Meter::new(source, clock, (shot, goal == Goal::Unseen), &guides);
    meter.look_for(FIRST_WINDOWS);
    let begun = meter.now();
    let matters = |axis: &&&Axis| (axis.sense)(&shot.scene, &shot.view).is_ok();
    let fixed = fixed.iter().filter(matters).copied().collect();
    Search { meter, shot, goal, free, fixed, begun }.run()
}

/// An axis whose choices are searched.
#[derive(Debug)]
pub(crate) struct FreeAxis {
    axis: &'static Axis,
    pub(crate) choices: Vec<&'static Choice>,
}

/// Returns the axes that have a distinct effect in the scene, with the choices worth trying. Models
/// and choices for teaching are left out; the ideal has the most samples and is added at the end.
pub(crate) fn free_axes(shot: &Shot, fixed: &[&'static Axis]) -> Vec<FreeAxis> {
    let (scene, view) = (&shot.scene, &shot.view);
    let is_free = |axis: &&Axis| {
        axis.kind == AxisKind::Scored
            && (axis.sense)(scene, view).is_ok()
            && !fixed.iter().any(|other| other.key == axis.key)
    };
    let free = AXES.iter().filter(is_free).map(|axis| {
        let is_tried = |choice: &&Choice| {
            (choice.sense)(scene, view).is_ok()
                && !is_historical(axis, choice)
                && choice.of(&Settings::default()).samples != Samples::TwoFiftySix
        };
        FreeAxis { axis, choices: axis.choices.iter().filter(is_tried).collect() }
    });
    let mut free: Vec<FreeAxis> = free.filter(|free| !free.choices.is_empty()).collect();
    free.sort_by_key(|free| !FIRST_AXES.contains(&free.axis.key));
    free
}

/// Returns the settings of the shot, with the choices of `settings` for the free axes.
fn merged(shot: &Shot, free: &[FreeAxis], settings: &Settings) -> Settings {
    free.iter().fold(shot.settings, |all, it| it.axis.chosen(settings).of(&all))
}

/// Returns the settings whose differences show where the details of the picture are.
fn guides(shot: &Shot, free: &[FreeAxis]) -> Vec<Settings> {
    let default = Settings::default();
    let refined = Settings { samples: Samples::Sixteen, ..default };
    let draft = Settings { resolution: Resolution::Half, ..default };
    let mut all: Vec<Settings> = Vec::new();
    for settings in [draft, default, refined].map(|settings| merged(shot, free, &settings)) {
        if !all.contains(&settings) {
            all.push(settings);
        }
    }
    all
}

/// How many times as long as the default the most exact choices take at least.
const EXACT_TAKES: f64 = 3.0;

struct Search<'a> {
    meter: Meter<'a>,
    shot: &'a Shot,
    goal: Goal,
    free: Vec<FreeAxis>,
    /// The axes that keep their choices although others would matter.
    fixed: Vec<&'static Axis>,
    begun: Duration,
}

impl Search<'_> {
    fn run(mut self) -> Answer {
        // The ideal needs no search if there is time for it.
        let ideal = self.ideal().filter(|ideal| match self.goal {
            Goal::Within(most) => ideal.ms.interval[1] <= most,
            Goal::Error(_) | Goal::Unseen => false,
        });
        if let Some(measured) = ideal {
            return self.answer(measured, true);
        }
        self.climb();
        for _ in 0..ROUNDS {
            let best = self.best();
            let steps = self.steps(&best);
            self.combine(&best, &steps);
            if self.best().settings == best.settings || self.is_over() {
                break;
            }
        }
        self.halve();
        self.settle()
    }

    /// Measures the presets and the current settings with more and more samples per pixel, until
    /// the time is spent or the error is reached.
    fn climb(&mut self) {
        let shot = self.shot;
        let exact = AccuracyPreset::named("exact").map(|preset| preset.of(&shot.settings));
        let lines = [Some(shot.settings), Some(Settings::default()), exact];
        let draft = Settings { resolution: Resolution::Half, ..Settings::default() };
        self.meter.measure(&merged(shot, &self.free, &draft));
        let samples = Samples::ALL.into_iter().filter(|it| *it != Samples::TwoFiftySix);
        let samples: Vec<Samples> = samples.collect();
        for line in lines.into_iter().flatten() {
            if Some(line) == exact && !self.may_afford_exact() {
                continue;
            }
            for samples in &samples {
                let settings = Settings { samples: *samples, ..line };
                let measured = self.meter.measure(&merged(shot, &self.free, &settings));
                let is_enough = match self.goal {
                    Goal::Within(most) => measured.ms.value > most,
                    Goal::Error(_) | Goal::Unseen => self.is_kept(&measured),
                };
                // Far slower settings than the best ones lead nowhere.
                let best = self.best();
                let is_slow = self.is_kept(&best) && measured.ms.value > SLOW * best.ms.value;
                if is_enough || (is_slow && !matches!(self.goal, Goal::Within(_))) {
                    break;
                }
            }
        }
    }

    /// Returns whether the most exact choices together, which take several times as long as those
    /// of the default, can be of use.
    fn may_afford_exact(&self) -> bool {
        let best = self.best();
        match self.goal {
            Goal::Within(most) => best.ms.value * EXACT_TAKES <= most,
            Goal::Error(_) | Goal::Unseen => !self.is_kept(&best),
        }
    }

    /// Measures each choice that differs from the best settings in one axis.
    fn steps(&mut self, best: &Measured) -> Vec<Vec<Step>> {
        let mut all = Vec::new();
        for i in 0..self.free.len() {
            let FreeAxis { axis, choices } = &self.free[i];
            let place = axis.choices.iter().position(|choice| choice.is(&best.settings));
            let (is_samples, choices) = (axis.key == "samples", choices.clone());
            let all_choices = axis.choices;
            let mut steps = Vec::new();
            for choice in choices {
                // Four times the samples take up to four times as long: one step up at a time.
                let at = all_choices.iter().position(|it| it.word == choice.word);
                let is_near = at.zip(place).is_none_or(|(at, place)| at <= place + 1);
                let settings = choice.of(&best.settings);
                let is_apart = (choice.among)(&best.settings).is_ok();
                if choice.is(&best.settings) || !is_apart || (is_samples && !is_near) {
                    continue;
                }
                if self.is_over() {
                    break;
                }
                let measured = self.meter.measure(&settings);
                let time = measured.ms.value / best.ms.value;
                let error = self.badness(&measured) - self.badness(best);
                // A choice that is neither faster nor more exact is of no use.
                if time < 1.0 - WORTHWHILE || error < 0.0 {
                    steps.push(Step { choice, time, error });
                }
            }
            all.push(steps);
        }
        all
    }

    /// Measures the combinations of steps that are predicted to be best.
    fn combine(&mut self, best: &Measured, steps: &[Vec<Step>]) {
        let start = (best.settings, [best.ms.value, self.badness(best)]);
        let mut all = predictions(start, steps);
        let goal = self.goal;
        all.retain(|(settings, _)| is_sound(settings, &best.settings));
        all.sort_by(|a, b| compare(&rank(goal, a.1), &rank(goal, b.1)));
        // A few are measured even if single choices have taken all the time.
        let mut left = if self.is_over() { PREDICTIONS / 2 } else { PREDICTIONS };
        for (settings, _) in all {
            if left == 0 {
                break;
            }
            if self.meter.known(&settings).is_none() {
                self.meter.measure(&settings);
                left -= 1;
            }
        }
    }

    /// Draws the contenders again and again, with more windows, and drops half of them each time.
    fn halve(&mut self) {
        let (mut rest, best) = (self.ranked(), self.best());
        rest.truncate(CONTENDERS);
        // Far slower ones would take most of the time, and win nothing.
        rest.retain(|it| !self.is_kept(&best) || it.ms.value <= SLOW * best.ms.value);
        while rest.len() > 1 {
            self.meter.look_for(ROUND);
            rest = rest.iter().map(|it| self.meter.again(&it.settings)).collect();
            self.sort(&mut rest);
            rest.truncate(rest.len().div_ceil(2).min(rest.len() - 1));
        }
    }

    /// Refines the figures of the best settings until they surely reach the goal, or takes the next
    /// ones.
    fn settle(mut self) -> Answer {
        let mut tried: Vec<Settings> = Vec::new();
        let end = self.meter.looked() + REFINING;
        let tries = if self.goal == Goal::Unseen { CONTENDERS } else { TRIES };
        while tried.len() < tries {
            let ranked = self.ranked();
            let open = |it: &&Measured| self.is_kept(it) && !tried.contains(&it.settings);
            let Some(next) = ranked.iter().find(open).map(|it| it.settings) else { break };
            if self.is_sure(&next, end) {
                let plainer = self.plainer(next);
                let is_sure = plainer != next && self.is_sure(&plainer, end);
                let measured = self.meter.steady(if is_sure { &plainer } else { &next });
                if self.is_kept(&measured) {
                    return self.answer(measured, true);
                }
            }
            tried.push(next);
        }
        let ideal = self.ideal().filter(|_| !matches!(self.goal, Goal::Within(_)));
        let is_reached = ideal.is_some();
        let nearest = self.ranked().into_iter().min_by(|a, b| {
            let [a, b] = [a, b].map(|it| [it.ms.value, self.badness(it)]);
            match self.goal {
                Goal::Within(_) => compare(&a, &b),
                Goal::Error(_) | Goal::Unseen => compare(&[a[1], a[0]], &[b[1], b[0]]),
            }
        });
        self.answer(ideal.or(nearest).expect("pictures were measured"), is_reached)
    }

    /// Returns whether refined figures reach the goal: the whole interval of an error does, or all
    /// windows with details were compared.
    fn is_sure(&mut self, settings: &Settings, end: Duration) -> bool {
        let measured = self.meter.again(settings);
        self.is_kept(&measured)
            && match self.goal {
                Goal::Within(_) => {
                    self.meter.sharpen(settings, end);
                    true
                }
                Goal::Error(most) => self.meter.sharpen(settings, end).interval[1] <= most,
                Goal::Unseen => self.meter.compare(settings, COMPARING, VISIBLE),
            }
    }

    /// Replaces choices that do not pay by those of the default: the time must be noticeably
    /// shorter, or the error smaller.
    fn plainer(&mut self, mut settings: Settings) -> Settings {
        for i in 0..self.free.len() {
            let choice = self.free[i].axis.default_choice();
            // Fewer samples are never noise.
            if choice.is(&settings) || self.free[i].axis.key == "samples" {
                continue;
            }
            let other = choice.of(&settings);
            // Drawn in turn, since the speed of the machine changes.
            let mut pair = [settings, other].map(|it| self.meter.again(&it));
            let mut spent = 0.0;
            for drawn in 1..PAIRS[1] {
                if drawn >= PAIRS[0] && spent > PAIRING {
                    break;
                }
                pair = [settings, other].map(|it| self.meter.again(&it));
                spent += pair[0].ms.value + pair[1].ms.value;
            }
            let [ms, plain] = pair.map(|it| it.ms);
            let is_as_fast = plain.value <= ms.value * (1.0 + WORTHWHILE) || plain.overlaps(&ms);
            let is_as_exact = self.badness(&pair[1]) <= self.badness(&pair[0]) * EQUAL;
            if is_as_fast && is_as_exact && self.is_kept(&pair[1]) {
                settings = other;
            }
        }
        settings
    }

    /// Returns the ideal, if the fixed axes allow it.
    fn ideal(&self) -> Option<Measured> {
        let ideal = self.shot.settings.ideal();
        let is_exact = |axis: &&Axis| axis.chosen(&ideal).is(&self.shot.settings);
        let settings = merged(self.shot, &self.free, &ideal);
        self.fixed.iter().all(is_exact).then(|| Measured { settings, ..self.meter.ideal() })
    }

    fn answer(&self, measured: Measured, is_reached: bool) -> Answer {
        let is_ideal = self.ideal().is_some_and(|ideal| ideal.settings == measured.settings);
        let compared = if is_ideal { 1.0 } else { self.meter.compared() };
        Answer { measured, is_reached, compared }
    }

    /// Returns whether the search has had its time.
    fn is_over(&self) -> bool {
        let spent = self.meter.now().saturating_sub(self.begun);
        spent > SEARCHING && (spent > SEARCHING_SLOWLY || self.meter.drawn() >= LEAST_PICTURES)
    }

    fn best(&self) -> Measured {
        self.ranked()[0]
    }

    /// Returns everything measured, the best first.
    fn ranked(&self) -> Vec<Measured> {
        let mut all = self.meter.all();
        self.sort(&mut all);
        all
    }

    fn sort(&self, all: &mut [Measured]) {
        let rank = |it: &Measured| rank(self.goal, [it.ms.value, self.badness(it)]);
        all.sort_by(|a, b| compare(&rank(a), &rank(b)));
    }

    fn is_kept(&self, measured: &Measured) -> bool {
        rank(self.goal, [measured.ms.value, self.badness(measured)])[0] == 0.0
    }

    /// Returns an error that adds up: the squared error, or the largest FLIP.
    fn badness(&self, measured: &Measured) -> f64 {
        match self.goal {
            Goal::Within(_) | Goal::Error(_) => measured.error.value * measured.error.value,
            Goal::Unseen => measured.flip,
        }
    }
}

/// Returns the rank of a time and an error: 0 if the goal is reached, then the figure to minimise.
fn rank(goal: Goal, [ms, error]: [f64; 2]) -> [f64; 3] {
    match goal {
        Goal::Within(most) if ms <= most => [0.0, error, ms],
        Goal::Within(_) => [1.0, ms, error],
        Goal::Error(most) if error <= most * most => [0.0, ms, error],
        Goal::Unseen if error <= VISIBLE => [0.0, ms, error],
        Goal::Error(_) | Goal::Unseen => [1.0, error, ms],
    }
}

/// Compares ranks, figure by figure.
fn compare(a: &[f64], b: &[f64]) -> Ordering {
    let differ = a.iter().zip(b).map(|(a, b)| a.total_cmp(b));
    differ.into_iter().find(|order| order.is_ne()).unwrap_or(Ordering::Equal)
}

/// Returns whether each choice that differs from `base` has an effect with the other ones.
pub(crate) fn is_sound(settings: &Settings, base: &Settings) -> bool {
    AXES.iter().all(|axis| {
        let choice = axis.chosen(settings);
        choice.is(base) || (choice.among)(settings).is_ok()
    })
}

//! Measures each preset of the dial for one view, time and error, in about a second.
//!
//! Pictures are drawn in turn, so that a change of the machine's speed affects all alike. The error
//! is the root mean square difference from the ideal in byte steps, over all pixels. Drawing the
//! whole ideal would take too long, so it is drawn in windows of 16 x 16 pixels, chosen at random
//! from strata of similar detail. Each figure has its interval, and is measured
//! further while that is wide.
//!
//! A picture that takes seconds is not drawn as a whole: its time is that of smaller ones, and its
//! error is that of windows alone.
//!
//! The work is divided into short steps, so an idle editor can measure and stop at any time.

mod drawn;
mod line;

use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

use super::estimate::Estimate;
use super::strata::Strata;
use drawn::Drawn;
pub use line::Line;
use marraztu_core::accuracy::{AccuracyPreset, LightSamples, Samples, Settings, Shot};
use marraztu_core::base::image::{Picture, Size};
use marraztu_render::screen::coverage::PixelBox;
use marraztu_render::{Cancelled, FramePlan, Renderer, plan_frame};

/// The side of a window in pixels, and where any picture is slow: then each pixel of the ideal is.
const WINDOW: usize = 16;
const SLOW_WINDOW: usize = 8;

/// The times that each picture is drawn, if that is quick.
const DRAWS: usize = 5;

/// The most times that it is drawn while its time is uncertain.
pub(crate) const MOST_DRAWS: usize = 30;

/// The time for drawing pictures and the time for drawing windows before the first figures.
const DRAWING: Duration = Duration::from_millis(300);
const SAMPLING: Duration = Duration::from_millis(600);

/// The time after which no new window is drawn.
const REFINING: Duration = Duration::from_secs(8);

/// The time between two results.
const BETWEEN: Duration = Duration::from_millis(400);

/// The uncertainty at which an error, and a time, is known well enough.
pub(crate) const ENOUGH: f64 = 0.05;
pub(crate) const NARROW: f64 = 0.1;

/// What a picture costs and what it gives.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Figures {
    /// The settings of the picture.
    pub settings: Settings,
    /// The milliseconds of a picture.
    pub ms: Estimate,
    /// The root mean square difference from the ideal, in byte steps; `None` until it is known.
    pub error: Option<Estimate>,
}

/// Returns the pictures of the dial: each preset with its settings, refined to at least `refined`
/// samples, as the window shows it at rest. Models are those of `settings`.
pub fn of_dial(
    settings: &Settings,
    refined: Option<Samples>,
) -> impl Iterator<Item = (&'static AccuracyPreset, Settings)> {
    let of = move |preset: &'static AccuracyPreset| (preset, preset.of(settings).at_rest(refined));
    AccuracyPreset::dial().iter().map(of)
}

/// Formats an error of the dial in byte steps, with its uncertainty if that changes a digit: "12",
/// "1.4 \u{b1} 0.2", "0.04". `None` if it is too uncertain to be told.
pub fn error_in_words(error: &Estimate) -> Option<String> {
    if error.interval[1] < 0.01 {
        return Some(if error.value == 0.0 { "0" } else { "< 0.01" }.to_owned());
    }
    if !error.is_within(TOO_UNCERTAIN) {
        // Small errors may be zero, but are surely small.
        let [_, most] = error.interval;
        return (most < SEEN).then(|| format!("< {most:.2}"));
    }
    let decimals = match error.value {
        9.95.. => 0,
        0.095.. => 1,
        _ => 2,
    };
    let [value, half] = [error.value, error.half_width()].map(|it| format!("{it:.decimals$}"));
    let is_certain = half.bytes().all(|byte| !(b'1'..=b'9').contains(&byte));
    Some(if is_certain { value } else { format!("{value} \u{b1} {half}") })
}

/// Returns whether a time is known well enough to be shown as it is. Otherwise, the machine was too
/// busy.
pub fn is_steady(ms: &Estimate) -> bool {
    ms.is_within(UNSTEADY)
}

/// Describes what the third picture of the dial, Exact, costs and gives compared with the second,
/// Default: "Exact takes about 6x as long as Default and cuts the error from 2.3 to 0.8 of 255".
pub fn in_words(figures: &[Figures]) -> Option<String> {
    let [_, default, exact, ..] = figures else { return None };
    let (before, after) = (default.error?, exact.error?);
    let in_digits = error_in_words(&Estimate::exact(before.value))
        .zip(error_in_words(&Estimate::exact(after.value)))?;
    let times = exact.ms.value / default.ms.value;
    let time = match times {
        2.5.. => format!("takes about {times:.0}x as long as Default"),
        1.15.. => format!("takes {times:.1}x as long as Default"),
        0.87.. => "takes as long as Default".to_owned(),
        _ => format!("takes {times:.1}x as long as Default"),
    };
    let is_steady = [default, exact].iter().all(|it| is_steady(&it.ms));
    let busy = if is_steady { "" } else { ", as far as this busy machine tells," };
    let gain = match after.value / before.value {
        _ if before.interval[1] < SEEN => "and shows nothing more".to_owned(),
        _ if !(before.is_within(TOO_UNCERTAIN) && after.is_within(TOO_UNCERTAIN)) => {
            return Some(format!("Here, Exact{busy} {time}; its error is not known well yet."));
        }
        left if left < 1.0 - GAIN && before.value >= HARDLY && !after.overlaps(&before) => {
            format!("and cuts the error from {} to {} of 255", in_digits.0, in_digits.1)
        }
        _ => "and looks almost the same".to_owned(),
    };
    Some(format!("Here, Exact{busy} {time} {gain}."))
}

/// An error below this, in byte steps, cannot be seen.
const SEEN: f64 = 0.05;

/// An error below this, in byte steps, is hard to see.
const HARDLY: f64 = 1.0;

/// An error with a larger uncertainty is not told, nor a time.
const TOO_UNCERTAIN: f64 = 0.5;
const UNSTEADY: f64 = 0.25;

/// A gain below this fraction is not worth mentioning.
const GAIN: f64 = 0.1;

/// A measurement in progress.
#[derive(Debug)]
pub struct Dial {
    /// The ideal in windows.
    plan: FramePlan,
    /// A quick picture, which differs from the others where there are details.
    rough: FramePlan,
    pictures: Vec<Drawn>,
    /// The place of the ideal among the results.
    ideal: Settings,
    sample: Option<Sample>,
    /// The time spent at the last results.
    told: Duration,
}

/// The windows of the ideal that were drawn so far. Their figures are the milliseconds, and the
/// squared error of each picture.
#[derive(Debug)]
struct Sample {
    windows: Vec<PixelBox>,
    strata: Strata,
    spent: Duration,
}

/// Whether a measurement is finished.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// There is more to do.
    More,
    /// There are better figures, and more to do.
    Better,
    /// All figures are final.
    Done,
}

impl Dial {
    /// Prepares to measure pictures of a shot with these settings.
    pub fn new(shot: &Shot, all: &[Settings]) -> Self {
        let ideal = shot.settings.ideal();
        let others = all.iter().filter(|settings| **settings != ideal);
        let pictures = others.map(|settings| Drawn::new(shot.with(*settings)));
        let rough = Settings { light_samples: LightSamples::One, ..Settings::default() };
        let rough = plan_frame(&shot.with(rough.modelled_as(&shot.settings)));
        let (pictures, plan) = (pictures.collect(), plan_frame(&shot.with(ideal)));
        Self { plan, rough, pictures, ideal, sample: None, told: Duration::ZERO }
    }

    /// Takes the next step: draws one picture or one window.
    ///
    /// # Errors
    /// [`Cancelled`] if `wanted` returns false. The step can then be taken again.
    pub fn step(
        &mut self,
        renderer: &mut Renderer,
        wanted: &(dyn Fn() -> bool + Sync),
    ) -> Result<Step, Cancelled> {
        let drawing: Duration = self.pictures.iter().map(Drawn::spent).sum();
        // First figures come soon: each picture once, a few times if it is quick, then windows.
        let draws = if drawing > DRAWING { 1 } else { DRAWS };
        if let Some(next) =
            self.pictures.iter_mut().filter(|it| it.draws() < draws).min_by_key(|it| it.draws())
        {
            next.draw(renderer, wanted)?;
            // The errors of slow pictures take long, so their times are told before.
            let are_timed = self.pictures.iter().all(|it| it.draws() > 0);
            let is_news = are_timed && self.told.is_zero() && self.is_slow();
            if is_news {
                self.told = drawing.max(BETWEEN);
            }
            return Ok(if is_news { Step::Better } else { Step::More });
        }
        if self.sample.is_none() {
            self.sample = Some(Sample::new(&self.pictures, &self.rough, renderer, wanted)?);
        }
        let sample = self.sample.as_mut().expect("it was just made");
        let is_good = sample.is_good(self.pictures.len());
        let begins = !sample.strata.is_begun() || (!is_good && sample.spent < SAMPLING);
        // Then both become better, in turn.
        let unsteady = self.pictures.iter_mut().filter(|it| !begins && it.is_unsteady());
        let unsteady = unsteady.min_by_key(|it| it.draws());
        let draws = begins || (!is_good && sample.spent < REFINING);
        match unsteady {
            Some(next) if !draws || drawing < sample.spent => next.draw(renderer, wanted)?,
            Some(_) | None if draws => {
                if !sample.add(&self.plan, &self.pictures, renderer, wanted)? {
                    // All windows are known.
                    sample.spent = sample.spent.max(REFINING);
                }
            }
            Some(_) | None => return Ok(Step::Done),
        }
        let spent = drawing + sample.spent;
        let is_told = sample.strata.is_begun() && !begins && spent >= self.told + BETWEEN;
        if is_told {
            self.told = spent;
        }
        Ok(if is_told { Step::Better } else { Step::More })
    }

    /// Returns the figures so far: those of the pictures in their order, then the ideal's.
    pub fn figures(&self) -> Vec<Figures> {
        let sample = self.sample.as_ref().filter(|sample| sample.strata.is_begun());
        let pixels = self.plan.size().area();
        let drawn = self.pictures.iter().enumerate().map(|(i, it)| Figures {
            settings: it.settings(),
            ms: it.ms().unwrap_or(Estimate::exact(f64::INFINITY)),
            error: sample.map(|sample| sample.rmse(i, pixels)),
        });
        let ideal = sample.map(|sample| Figures {
            settings: self.ideal,
            ms: sample.ms(self.plan.size()),
            error: Some(Estimate::exact(0.0)),
        });
        drawn.chain(ideal).collect()
    }

    fn is_slow(&self) -> bool {
        self.pictures.iter().any(Drawn::is_slow)
    }
}

impl Sample {
    /// Sorts windows by their detail, the differences between the pictures: each picture is
    /// inexact in its own places.
    fn new(
        pictures: &[Drawn],
        rough: &FramePlan,
        renderer: &mut Renderer,
        wanted: &(dyn Fn() -> bool + Sync),
    ) -> Result<Self, Cancelled> {
        let side = if pictures.iter().any(Drawn::is_slow) { SLOW_WINDOW } else { WINDOW };
        let windows: Vec<PixelBox> = windows(rough.size(), side).collect();
        let rough = renderer.render_while(rough, wanted)?;
        let whole = pictures.iter().filter_map(Drawn::picture);
        let all: Vec<&Picture> = whole.chain(std::iter::once(rough)).collect();
        let strata = Strata::new(&details(&all, &windows), 1);
        Ok(Self { windows, strata, spent: Duration::ZERO })
    }

    /// Draws another window. Returns false if all are known.
    fn add(
        &mut self,
        plan: &FramePlan,
        pictures: &[Drawn],
        renderer: &mut Renderer,
        wanted: &(dyn Fn() -> bool + Sync),
    ) -> Result<bool, Cancelled> {
        let Some(next) = self.strata.next() else { return Ok(false) };
        let (window, begun) = (self.windows[next], Instant::now());
        let exact = renderer.render_window(plan, window, wanted)?;
        let mut figures = vec![begun.elapsed().as_secs_f64() * 1e3];
        for drawn in pictures {
            figures.push(drawn.squares(&exact, window, renderer, wanted)?);
        }
        self.strata.note(next, figures);
        self.spent += begun.elapsed();
        Ok(true)
    }

    fn rmse(&self, picture: usize, pixels: usize) -> Estimate {
        let bytes = (3 * pixels.max(1)) as f64;
        self.strata.sum(1 + picture).map(|sum| libm::sqrt(sum / bytes))
    }

    /// Estimates the milliseconds of the whole ideal, which is drawn in larger windows. The
    /// quickest window shows the time that a window takes whatever it shows.
    fn ms(&self, size: Size) -> Estimate {
        let fixed = self.strata.known().map(|it| it[0]).fold(f64::INFINITY, f64::min);
        let windows = (self.windows.len() as f64, Renderer::window_count(size) as f64);
        self.strata.sum(0).map(|ms| ms - fixed * (windows.0 - windows.1))
    }

    /// Returns whether the errors of all pictures are known well enough.
    fn is_good(&self, pictures: usize) -> bool {
        // The root halves relative errors.
        (1..=pictures).all(|i| self.strata.sum(i).map(libm::sqrt).is_within(ENOUGH))
    }
}

/// Returns the detail of each window: how much the pictures differ there.
pub(crate) fn details(pictures: &[&Picture], windows: &[PixelBox]) -> Vec<f64> {
    let mut details = vec![0.0; windows.len()];
    for (i, one) in pictures.iter().enumerate() {
        for other in &pictures[..i] {
            // The root, because windows without a difference may still have an error.
            let difference = |window| libm::sqrt(squares(one, other, window));
            let all: Vec<f64> = windows.iter().map(difference).collect();
            let sum = all.iter().sum::<f64>();
            if sum > 0.0 {
                details.iter_mut().zip(all).for_each(|(detail, it)| *detail += it / sum);
            }
        }
    }
    details
}

/// Divides a picture into windows of at most `side` x `side` pixels.
pub(crate) fn windows(size: Size, side: usize) -> impl Iterator<Item = PixelBox> {
    let at = |pixels: usize| i32::try_from(pixels).unwrap_or(i32::MAX);
    (0..size.height).step_by(side).flat_map(move |top| {
        (0..size.width).step_by(side).map(move |left| PixelBox {
            left: at(left),
            top: at(top),
            right: at((left + side).min(size.width)),
            bottom: at((top + side).min(size.height)),
        })
    })
}

/// Returns the sum of the squared byte differences of two pictures in a window.
fn squares(a: &Picture, b: &Picture, window: &PixelBox) -> f64 {
    pixels_of(a, window).zip(pixels_of(b, window)).map(|(a, b)| squared(a, b)).sum()
}

/// Returns the root mean square difference of two pictures of one size, in byte steps.
pub(crate) fn rmse(a: &Picture, b: &Picture) -> f64 {
    let squares: f64 = a.pixels().iter().zip(b.pixels()).map(|(a, b)| squared(a, b)).sum();
    libm::sqrt(squares / (3 * a.pixels().len().max(1)) as f64)
}

/// Returns the same sum, for a picture `exact` of the window alone.
pub(crate) fn squares_within(picture: &Picture, exact: &Picture, window: &PixelBox) -> f64 {
    pixels_of(picture, window).zip(exact.pixels()).map(|(a, b)| squared(a, b)).sum()
}

fn pixels_of<'a>(picture: &'a Picture, window: &PixelBox) -> impl Iterator<Item = &'a [u8; 4]> {
    let [left, top, right, bottom] = [window.left, window.top, window.right, window.bottom]
        .map(|side| usize::try_from(side).unwrap_or(0));
    let width = picture.size().width;
    (top..bottom).flat_map(move |y| &picture.pixels()[y * width + left..y * width + right])
}

fn squared(a: &[u8; 4], b: &[u8; 4]) -> f64 {
    let step = |i: usize| f64::from(a[i].abs_diff(b[i]));
    (0..3).map(|i| step(i) * step(i)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Rendering;
    use crate::suite::SUITE;
    use marraztu_core::accuracy::{AXES, AxisKind};
    use marraztu_io::{EXAMPLES, Progress};

    fn measured(shot: &Shot, all: &[Settings]) -> Vec<Figures> {
        let (mut dial, mut renderer) = (Dial::new(shot, all), Renderer::default());
        assert!(dial.figures().iter().all(|figures| figures.error.is_none()));
        while dial.step(&mut renderer, &|| true) != Ok(Step::Done) {}
        dial.figures()
    }

    /// The estimate is compared with the whole ideal.
    #[test]
    fn the_errors_of_the_dial_are_those_against_the_whole_ideal() {
        let (scene, view) = marraztu_io::default_scene();
        let shot = Shot::new(&scene, &view, &Settings::default(), Size::new(160, 100));
        let all: Vec<Settings> =
            of_dial(&shot.settings, Some(Samples::Sixteen)).map(|(_, settings)| settings).collect();
        let figures = measured(&shot, &all);
        assert_eq!(figures.iter().map(|it| it.settings).collect::<Vec<_>>(), all);
        let mut renderer = Renderer::default();
        let mut drawn = |settings: &Settings| {
            let picture = renderer.render(&plan_frame(&shot.with(*settings))).clone();
            Rendering::new(picture, vec![0; shot.size.area()]).mixed()
        };
        let ideal = drawn(&shot.settings.ideal());
        for figures in &figures[..3] {
            let exact = drawn(&figures.settings).error(&ideal).whole.rmse;
            let error = figures.error.unwrap();
            assert!((error.value / exact - 1.0).abs() < 0.15, "{exact}: {error:?}");
            assert!(error.is_within(ENOUGH), "it is measured further while it is uncertain");
        }
        let errors: Vec<f64> = figures.iter().filter_map(|it| Some(it.error?.value)).collect();
        assert!(errors[0] > errors[1] && errors[1] >= errors[2] && errors[3] == 0.0, "{errors:?}");
        assert!(figures.iter().all(|it| it.ms.value > 0.0 && it.ms.value.is_finite()));
    }

    /// The examples and the scenes of the suite, without the ones with the slowest ideals.
    fn scenes() -> Vec<Shot> {
        const SLOWEST: [&str; 5] = ["vertices", "layers", "bumps", "soft", "mirrors"];
        let size = Size::new(208, 120);
        let examples = EXAMPLES.iter().map(|example| {
            let opened = marraztu_io::open(example.path.as_ref(), &Progress::new()).unwrap();
            Shot::new(&opened.scene, &opened.view, &opened.settings, size)
        });
        let suite = SUITE.iter().filter(|it| !SLOWEST.contains(&it.word));
        let suite = suite.map(|suite| {
            let (scene, view) = suite.open(100);
            Shot::new(&scene, &view, &Settings::default(), size)
        });
        examples.chain(suite).collect()
    }

    /// The settings of each scene: single choices of axes, at rest and moving.
    fn choices(shot: &Shot) -> impl Iterator<Item = Settings> {
        let base = Settings::default().modelled_as(&shot.settings);
        let (scene, view) = (shot.scene.clone(), shot.view.clone());
        let scored = AXES.iter().filter(|axis| axis.kind == AxisKind::Scored);
        let choices = scored.flat_map(|axis| axis.choices.iter());
        let choices = choices
            .filter(move |it| !it.is(&base) && it.is_of_its_own(&scene, &view, &base).is_ok());
        let all = choices.flat_map(move |it| [it.of(&base), it.of(&base).refined()]);
        all.filter(|it| it.samples != Samples::TwoFiftySix)
    }

    /// The intervals promise 95%. Pictures and windows are smaller than in the dial.
    #[test]
    fn the_true_error_is_within_its_interval_for_190_of_200_pairs_of_scene_and_settings() {
        const SIDE: usize = 8;
        let (mut all, mut wrong, mut halves) = (0, Vec::new(), Vec::new());
        for shot in scenes() {
            let mut renderer = Renderer::default();
            let mut drawn =
                |settings: &Settings| renderer.render(&plan_frame(&shot.with(*settings))).clone();
            let ideal = drawn(&shot.settings.ideal());
            let dial: Vec<Picture> = of_dial(&shot.settings, Some(Samples::Sixteen))
                .take(3)
                .map(|(_, settings)| drawn(&settings))
                .collect();
            let rough = drawn(&Settings::default().modelled_as(&shot.settings));
            let windows: Vec<PixelBox> = windows(shot.size, SIDE).collect();
            for settings in choices(&shot).take(20) {
                let pictures: Vec<Picture> =
                    dial.iter().cloned().chain([drawn(&settings)]).collect();
                let errors = |window: &PixelBox| -> Vec<f64> {
                    pictures.iter().map(|it| squares(it, &ideal, window)).collect()
                };
                let of: Vec<&Picture> = pictures.iter().chain([&rough]).collect();
                let mut strata = Strata::new(&details(&of, &windows), 1 + all);
                let is_good =
                    |it: &Strata| (0..4).all(|i| it.sum(i).map(libm::sqrt).is_within(ENOUGH));
                while !(strata.is_begun() && is_good(&strata)) {
                    let Some(next) = strata.next() else { break };
                    strata.note(next, errors(&windows[next]));
                }
                let truth: f64 = windows.iter().map(|window| errors(window)[3]).sum();
                let sum = strata.sum(3);
                let [lower, upper] = sum.interval;
                all += 1;
                if !(lower <= truth * (1.0 + 1e-9) && truth <= upper * (1.0 + 1e-9)) {
                    wrong.push((settings.in_words(), truth, sum));
                }
                halves.push(sum.map(libm::sqrt).half_width() / libm::sqrt(truth.max(1.0)));
            }
        }
        assert!(all >= 200, "{all}");
        assert!(wrong.len() as u64 * 20 <= all, "{} of {all}: {wrong:?}", wrong.len());
        // An interval from 0 to infinity would hold, too.
        halves.sort_by(f64::total_cmp);
        assert!(halves[halves.len() / 2] > 0.01 && *halves.last().unwrap() < 0.2, "{halves:?}");
    }

    #[test]
    fn a_sentence_states_what_exact_costs_and_gives() {
        let within = |value: f64, part: f64| Estimate {
            value,
            interval: [value * (1.0 - part), value * (1.0 + part)],
        };
        let figures = |ms: f64, error: f64| Figures {
            settings: Settings::default(),
            ms: within(ms, 0.05),
            error: Some(within(error, 0.02)),
        };
        let said = |default: Figures, exact: Figures| {
            in_words(&[figures(0.1, 9.0), default, exact, figures(900.0, 0.0)]).unwrap()
        };
        let cut = "Here, Exact takes about 6x as long as Default and cuts the error from 2.3 to \
                   0.8 of 255.";
        assert_eq!(said(figures(1.0, 2.3), figures(5.6, 0.8)), cut);
        let hardly = "Here, Exact takes about 12x as long as Default and looks almost the same.";
        assert_eq!(said(figures(1.0, 2.3), figures(12.0, 2.2)), hardly);
        // From 0.5 to 0.4: both are hard to tell from the ideal.
        assert_eq!(said(figures(1.0, 0.5), figures(12.0, 0.4)), hardly);
        let nothing = "Here, Exact takes as long as Default and shows nothing more.";
        assert_eq!(said(figures(1.0, 0.0), figures(1.1, 0.0)), nothing);
        let busy = Figures { ms: within(5.6, 0.9), ..figures(5.6, 0.8) };
        let uncertain = "Here, Exact, as far as this busy machine tells, takes about 6x as long \
                         as Default and cuts the error from 2.3 to 0.8 of 255.";
        assert_eq!(said(figures(1.0, 2.3), busy), uncertain);
        let wide = Figures { error: Some(within(0.8, 0.7)), ..figures(5.6, 0.8) };
        let unknown =
            "Here, Exact takes about 6x as long as Default; its error is not known well yet.";
        assert_eq!(said(figures(1.0, 2.3), wide), unknown);
        assert_eq!(in_words(&[]), None);
    }

    #[test]
    fn an_error_is_told_with_its_uncertainty_unless_that_is_too_large() {
        let told = |value: f64, half: f64| {
            error_in_words(&Estimate { value, interval: [value - half, value + half] })
        };
        for (value, half, text) in [
            (1.43, 0.22, Some("1.4 \u{b1} 0.2")),
            (1.43, 0.03, Some("1.4")),
            (12.2, 0.3, Some("12")),
            (12.2, 1.6, Some("12 \u{b1} 2")),
            (0.042, 0.011, Some("0.04 \u{b1} 0.01")),
            (0.0, 0.0, Some("0")),
            (0.004, 0.001, Some("< 0.01")),
            (0.02, 0.02, Some("< 0.04")),
            (1.43, 0.9, None),
        ] {
            assert_eq!(told(value, half).as_deref(), text, "{value} {half}");
        }
    }

    #[test]
    fn an_empty_scene_has_no_error_and_a_measurement_stops_at_once() {
        let (mut scene, mut view) = marraztu_io::default_scene();
        scene.objects = marraztu_core::scene::List::default();
        view.marks = false;
        let shot = Shot::new(&scene, &view, &Settings::default(), Size::new(40, 30));
        let figures = measured(&shot, &[Settings::default()]);
        let errors: Vec<_> = figures.iter().map(|it| it.error).collect();
        assert_eq!(errors, [Some(Estimate::exact(0.0)); 2]);
        let mut dial = Dial::new(&shot, &[Settings::default()]);
        assert_eq!(dial.step(&mut Renderer::default(), &|| false), Err(Cancelled));
    }
}

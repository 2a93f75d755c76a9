//! Measures each preset of the dial for one view, time and error, in about a second.
//!
//! Each picture is drawn a few times; its shortest time counts. The error is the root mean square
//! difference from the ideal in byte steps, over all pixels. Drawing the whole ideal would take
//! too long, so it is drawn in windows of 16 x 16 pixels that are chosen at random, with
//! replacement. Windows with more detail are chosen more often: the chance of a window grows with
//! the difference between the quickest and the second picture there. Dividing by the chance removes
//! the bias (Hansen and Hurwitz, "On the Theory of Sampling from Finite Populations", 1943).
//!
//! The work is divided into short steps, so that an idle editor can measure and stop at any time.

use std::collections::BTreeMap;
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

use marraztu_core::accuracy::{AccuracyPreset, Samples, Settings, Shot};
use marraztu_core::base::image::{Picture, Size};
use marraztu_core::base::rng::Rng;
use marraztu_render::screen::coverage::PixelBox;
use marraztu_render::{Cancelled, FramePlan, Renderer, plan_frame};

/// The side of a window in pixels.
const WINDOW: usize = 16;

/// The times that each picture is drawn, if that is quick.
const DRAWS: usize = 5;

/// The time for drawing pictures, and the time after which no new window is drawn.
const DRAWING: Duration = Duration::from_millis(300);
const SAMPLING: Duration = Duration::from_millis(600);

/// The fewest and the most windows that are chosen.
const LEAST: usize = 12;
const MOST: usize = 2000;

/// The relative standard error at which an estimate is good enough for two digits.
const ENOUGH: f64 = 0.03;

/// The part of the chances that all windows share.
const SHARED: f64 = 0.1;

/// What a picture costs and what it gives.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Figures {
    /// The settings of the picture.
    pub settings: Settings,
    /// The milliseconds of a picture.
    pub ms: f64,
    /// The root mean square difference from the ideal, in byte steps; `None` until it is known.
    pub error: Option<f64>,
}

/// Returns the pictures of the dial: each preset with its settings, refined to at least `refined`
/// samples, as the window shows it at rest. Models are those of `settings`.
pub fn of_dial(
    settings: &Settings,
    refined: Option<Samples>,
) -> impl Iterator<Item = (&'static AccuracyPreset, Settings)> {
    let of = move |preset: &'static AccuracyPreset| {
        let settings = preset.of(settings);
        (preset, refined.map_or(settings, |samples| settings.refined_to(samples)))
    };
    AccuracyPreset::dial().iter().map(of)
}

/// Formats an error of the dial in byte steps: "12", "3.2", "0.04".
pub fn error_in_words(error: f64) -> String {
    match error {
        0.0 => "0".to_owned(),
        9.95.. => format!("{error:.0}"),
        0.095.. => format!("{error:.1}"),
        0.01.. => format!("{error:.2}"),
        _ => "< 0.01".to_owned(),
    }
}

/// Describes what the third picture of the dial, Exact, costs and gives compared with the second,
/// Default: "Exact takes about 6x as long as Default and cuts the error from 2.3 to 0.8 of 255".
pub fn in_words(figures: &[Figures]) -> Option<String> {
    let [_, default, exact, ..] = figures else { return None };
    let (before, after) = (default.error?, exact.error?);
    let times = exact.ms / default.ms;
    let time = match times {
        2.5.. => format!("takes about {times:.0}x as long as Default"),
        1.15.. => format!("takes {times:.1}x as long as Default"),
        _ => "takes as long as Default".to_owned(),
    };
    // Smaller changes are invisible, or within the error of the estimate.
    let gain = match after / before {
        _ if before < SEEN => "and shows nothing more".to_owned(),
        left if left < 1.0 - GAIN && before >= HARDLY => {
            format!(
                "and cuts the error from {} to {} of 255",
                error_in_words(before),
                error_in_words(after)
            )
        }
        _ => "and looks almost the same".to_owned(),
    };
    Some(format!("Here, Exact {time} {gain}."))
}

/// An error below this, in byte steps, cannot be seen.
const SEEN: f64 = 0.05;

/// An error below this, in byte steps, is hard to see.
const HARDLY: f64 = 1.0;

/// A gain below this fraction is not worth mentioning.
const GAIN: f64 = 0.1;

/// A measurement in progress.
#[derive(Debug)]
pub struct Dial {
    /// The ideal in windows.
    plan: FramePlan,
    pictures: Vec<Drawn>,
    /// The place of the ideal among the results.
    ideal: Settings,
    begun: Option<Instant>,
    sample: Option<Sample>,
}

#[derive(Debug)]
struct Drawn {
    settings: Settings,
    plan: FramePlan,
    /// The shortest time so far, in milliseconds.
    ms: f64,
    draws: usize,
    picture: Picture,
}

/// The windows that were chosen so far.
#[derive(Debug)]
struct Sample {
    windows: Vec<PixelBox>,
    /// The chance of each window, and the sum of the chances up to and including it.
    chances: Vec<f64>,
    sums: Vec<f64>,
    rng: Rng,
    /// The windows drawn: the milliseconds, and the squared error of each picture.
    known: BTreeMap<usize, (f64, Vec<f64>)>,
    chosen: Vec<usize>,
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
        let pictures = all.iter().filter(|settings| **settings != ideal).map(|settings| Drawn {
            settings: *settings,
            plan: plan_frame(&shot.with(*settings)),
            ms: f64::INFINITY,
            draws: 0,
            picture: Picture::default(),
        });
        let (pictures, plan) = (pictures.collect(), plan_frame(&shot.with(ideal)));
        Self { plan, pictures, ideal, begun: None, sample: None }
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
        let begun = *self.begun.get_or_insert_with(Instant::now);
        let is_late = begun.elapsed() > DRAWING;
        let left = self.pictures.iter_mut().filter(|it| it.draws < if is_late { 1 } else { DRAWS });
        if let Some(next) = left.min_by_key(|it| it.draws) {
            next.draw(renderer, wanted)?;
            return Ok(Step::More);
        }
        let sample =
            self.sample.get_or_insert_with(|| Sample::new(&self.pictures, self.plan.size()));
        sample.add(&self.plan, &self.pictures, renderer, wanted)?;
        let count = sample.chosen.len();
        let is_done = count >= MOST
            || (count >= LEAST && (sample.spent > SAMPLING || sample.is_good(self.pictures.len())));
        Ok(match is_done {
            true => Step::Done,
            false if count.is_power_of_two() && count >= LEAST => Step::Better,
            false => Step::More,
        })
    }

    /// Returns the figures so far: those of the pictures in their order, then the ideal's.
    pub fn figures(&self) -> Vec<Figures> {
        let sample = self.sample.as_ref().filter(|sample| sample.chosen.len() >= LEAST);
        let pixels = self.plan.size().area();
        let drawn = self.pictures.iter().enumerate().map(|(i, it)| Figures {
            settings: it.settings,
            ms: it.ms,
            error: sample.map(|sample| sample.rmse(i, pixels)),
        });
        let ideal = sample.map(|sample| Figures {
            settings: self.ideal,
            ms: sample.ms(),
            error: Some(0.0),
        });
        drawn.chain(ideal).collect()
    }
}

impl Drawn {
    fn draw(
        &mut self,
        renderer: &mut Renderer,
        wanted: &(dyn Fn() -> bool + Sync),
    ) -> Result<(), Cancelled> {
        let begun = Instant::now();
        let picture = renderer.render_while(&self.plan, wanted)?;
        self.ms = self.ms.min(begun.elapsed().as_secs_f64() * 1e3);
        if self.draws == 0 {
            self.picture = picture.clone();
        }
        self.draws += 1;
        Ok(())
    }
}

impl Sample {
    fn new(pictures: &[Drawn], size: Size) -> Self {
        let windows: Vec<PixelBox> = windows(size).collect();
        let difference = |window: &PixelBox| match pictures {
            [first, second, ..] => squares(&first.picture, &second.picture, window),
            _ => 0.0,
        };
        // The root, because windows without a difference may still have an error.
        let details: Vec<f64> = windows.iter().map(|it| libm::sqrt(difference(it))).collect();
        let (sum, count) = (details.iter().sum::<f64>(), windows.len().max(1) as f64);
        let shared = if sum > 0.0 { SHARED } else { 1.0 };
        let chance = |detail: &f64| shared / count + (1.0 - shared) * detail / sum.max(1e-9);
        let chances: Vec<f64> = details.iter().map(chance).collect();
        let mut up_to = 0.0;
        let add = |chance: &f64| {
            up_to += chance;
            up_to
        };
        let sums = chances.iter().map(add).collect();
        let (known, chosen) = (BTreeMap::new(), Vec::new());
        Self { windows, chances, sums, rng: Rng::new(1), known, chosen, spent: Duration::ZERO }
    }

    /// Chooses another window, and draws it unless it is known.
    fn add(
        &mut self,
        plan: &FramePlan,
        pictures: &[Drawn],
        renderer: &mut Renderer,
        wanted: &(dyn Fn() -> bool + Sync),
    ) -> Result<(), Cancelled> {
        let at = self.rng.real(0.0, self.sums.last().copied().unwrap_or(1.0));
        let place = self.sums.partition_point(|sum| *sum <= at).min(self.windows.len() - 1);
        if !self.known.contains_key(&place) {
            let (window, begun) = (self.windows[place], Instant::now());
            let exact = renderer.render_window(plan, window, wanted)?;
            let time = begun.elapsed();
            let errors = pictures.iter().map(|it| squares_within(&it.picture, &exact, &window));
            self.known.insert(place, (time.as_secs_f64() * 1e3, errors.collect()));
            self.spent += time;
        }
        self.chosen.push(place);
        Ok(())
    }

    /// Returns the mean of a figure over the chosen windows, each divided by its chance, and its
    /// standard error: an estimate of the sum over all windows.
    fn sum(&self, of: impl Fn(&(f64, Vec<f64>)) -> f64) -> (f64, f64) {
        let values: Vec<f64> =
            self.chosen.iter().map(|place| of(&self.known[place]) / self.chances[*place]).collect();
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let squares = values.iter().map(|value| (value - mean) * (value - mean)).sum::<f64>();
        (mean, libm::sqrt(squares / (count * (count - 1.0).max(1.0))))
    }

    fn rmse(&self, picture: usize, pixels: usize) -> f64 {
        let (sum, _) = self.sum(|(_, errors)| errors[picture]);
        libm::sqrt(sum / (3 * pixels.max(1)) as f64)
    }

    /// Returns the milliseconds of the whole ideal.
    fn ms(&self) -> f64 {
        self.sum(|(ms, _)| *ms).0
    }

    /// Returns whether the errors of all pictures are known well enough. The root halves relative
    /// errors. An error of 0 may be that of the background, so it is never known early.
    fn is_good(&self, pictures: usize) -> bool {
        (0..pictures).all(|i| {
            let (sum, error) = self.sum(|(_, errors)| errors[i]);
            sum > 0.0 && error <= 2.0 * ENOUGH * sum
        })
    }
}

/// Divides a picture into windows.
fn windows(size: Size) -> impl Iterator<Item = PixelBox> {
    let side = |pixels: usize| i32::try_from(pixels).unwrap_or(i32::MAX);
    (0..size.height).step_by(WINDOW).flat_map(move |top| {
        (0..size.width).step_by(WINDOW).map(move |left| PixelBox {
            left: side(left),
            top: side(top),
            right: side((left + WINDOW).min(size.width)),
            bottom: side((top + WINDOW).min(size.height)),
        })
    })
}

/// Returns the sum of the squared byte differences of two pictures in a window.
fn squares(a: &Picture, b: &Picture, window: &PixelBox) -> f64 {
    pixels_of(a, window).zip(pixels_of(b, window)).map(|(a, b)| squared(a, b)).sum()
}

/// Returns the same sum, for a picture `exact` of the window alone.
fn squares_within(picture: &Picture, exact: &Picture, window: &PixelBox) -> f64 {
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
            assert!((error / exact - 1.0).abs() < 0.25, "{error} for {exact}: {figures:?}");
        }
        let errors: Vec<f64> = figures.iter().filter_map(|it| it.error).collect();
        assert!(errors[0] > errors[1] && errors[1] >= errors[2] && errors[3] == 0.0, "{errors:?}");
        assert!(figures.iter().all(|it| it.ms > 0.0 && it.ms.is_finite()));
    }

    #[test]
    fn a_sentence_states_what_exact_costs_and_gives() {
        let figures =
            |ms: f64, error: f64| Figures { settings: Settings::default(), ms, error: Some(error) };
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
        assert_eq!(in_words(&[]), None);
    }

    #[test]
    fn an_empty_scene_has_no_error_and_a_measurement_stops_at_once() {
        let (mut scene, mut view) = marraztu_io::default_scene();
        scene.objects = marraztu_core::scene::List::default();
        view.marks = false;
        let shot = Shot::new(&scene, &view, &Settings::default(), Size::new(40, 30));
        let figures = measured(&shot, &[Settings::default()]);
        assert_eq!(figures.iter().map(|it| it.error).collect::<Vec<_>>(), [Some(0.0), Some(0.0)]);
        let mut dial = Dial::new(&shot, &[Settings::default()]);
        assert_eq!(dial.step(&mut Renderer::default(), &|| false), Err(Cancelled));
    }
}

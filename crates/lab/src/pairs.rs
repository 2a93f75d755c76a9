//! Measures the time of one setting relative to another, also on a busy machine.
//!
//! A pair consists of four pictures in the order A B B A, so a steady drift of the machine's speed
//! affects both alike. The next is B A A B: a picture that follows one of its kind is quicker, and
//! the first of a pair is slower. Other programs can only make a picture slower, so the time of
//! each side is a low quantile: the speed of the undisturbed machine, even if most pictures were
//! disturbed. The ratio of the two gets its interval from a bootstrap over the pairs. Measuring
//! continues while the interval is wide, up to a limit. Every picture is hashed after it is timed:
//! the compiler cannot omit work, and equal settings must give equal bytes.
//!
//! The bootstrap: Efron and Tibshirani, "An Introduction to the Bootstrap", 1993, chapter 13.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

use super::estimate::{RESAMPLES, UNDISTURBED};
use super::picture_source::{PictureSource, hash};
use super::statistics::{Quartiles, quantile_of};
use super::timing::{Clock, Work};
use marraztu_core::accuracy::Settings;
use marraztu_core::base::rng::Rng;
use marraztu_io::{Cancelled, Progress};

/// The limits of a measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// The most pairs per choice.
    pub pairs: usize,
    /// The fewest pairs per choice.
    pub least: usize,
    /// The time after which no new pair is started, if there are enough.
    pub time: Duration,
}

/// An interval of this width, relative to the ratio, is narrow enough to stop.
const NARROW: f64 = 0.03;

/// Pictures that take this many times the limit of time have only [`LEAST_SLOW`] pairs.
const LONGEST: f64 = 4.0;

/// The fewest pairs of slow pictures.
const LEAST_SLOW: usize = 2;

/// A bootstrap over fewer pairs is too narrow.
const FEW: usize = 7;

/// Connects measurements with the user, who waits for them and may disturb them.
#[derive(Clone, Debug, Default)]
pub struct Watch {
    /// Reports progress and cancels.
    pub progress: Progress,
    touches: Arc<Touches>,
}

#[derive(Debug, Default)]
struct Touches {
    /// Odd while the machine is used for something else.
    count: AtomicU64,
    last: Mutex<Option<Instant>>,
    /// The time of the last pair in milliseconds.
    pair: AtomicU64,
}

/// While this guard exists, measurements are invalid.
#[derive(Debug)]
#[must_use]
pub struct Touch(Arc<Touches>);

/// The time that the effects of a touch last, such as showing the window.
const AFTERMATH: Duration = Duration::from_millis(40);

/// The longest wait for a touch to end: a busy machine may take long to show the window.
const PATIENCE: Duration = Duration::from_secs(if cfg!(test) { 1 } else { 10 });

impl Watch {
    /// Returns the same watch with the progress of other work.
    #[must_use]
    pub fn with(self, progress: &Progress) -> Self {
        Self { progress: progress.clone(), ..self }
    }

    /// Marks the machine as busy while the guard exists. The current pair is discarded.
    pub fn touch(&self) -> Touch {
        self.touches.count.fetch_add(1, Ordering::Relaxed);
        Touch(Arc::clone(&self.touches))
    }

    /// Returns the current time of a pair. More frequent touches would disturb every pair.
    pub fn pair(&self) -> Duration {
        Duration::from_millis(self.touches.pair.load(Ordering::Relaxed))
    }

    fn touches(&self) -> u64 {
        self.touches.count.load(Ordering::Relaxed)
    }

    /// Waits for the current touch to end, and for the effects of the last one. It waits only once
    /// per touch, since constant touches must not stop the work. `endless` is a touch that did not
    /// end.
    fn settle(&self, endless: &mut Option<u64>) {
        let (touch, begun) = (self.touches(), Instant::now());
        while !touch.is_multiple_of(2) && *endless != Some(touch) && self.touches() == touch {
            if begun.elapsed() > PATIENCE {
                *endless = Some(touch);
            }
            std::thread::sleep(Duration::from_millis(1));
        }
        let last = *self.touches.last.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(rest) = last.and_then(|last| AFTERMATH.checked_sub(last.elapsed())) {
            std::thread::sleep(rest);
        }
    }
}

impl Drop for Touch {
    fn drop(&mut self) {
        self.0.count.fetch_add(1, Ordering::Relaxed);
        *self.0.last.lock().unwrap_or_else(PoisonError::into_inner) = Some(Instant::now());
    }
}

/// The time of a choice B relative to a choice A.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ratio {
    /// The ratio of B's time to A's as the median, with the quartiles of its bootstrap.
    pub quartiles: Quartiles,
    /// The interval of the true ratio, with a probability of [`CONFIDENCE`].
    pub interval: [f64; 2],
    /// The number of valid pairs.
    pub pairs: usize,
    /// The number of discarded pairs.
    pub thrown: usize,
    /// The time of an undisturbed picture of A in milliseconds.
    pub a_ms: f64,
}

/// The probability that [`Ratio::interval`] contains the true ratio.
pub const CONFIDENCE: f64 = 0.95;

impl Ratio {
    /// Returns the interval of ratios that are indistinguishable from this one. It combines, on
    /// each side, the larger of the confidence interval and `floor` around the median.
    pub fn noise(&self, floor: f64) -> [f64; 2] {
        let ([lower, upper], median) = (self.interval, self.quartiles.median);
        [lower.min(median / (1.0 + floor)), upper.max(median * (1.0 + floor))]
    }

    /// The ratio of equal settings: 1, with a spread that includes what was measured.
    #[must_use]
    pub fn around_one(&self) -> Self {
        let Quartiles { lower, upper, .. } = self.quartiles;
        let quartiles = Quartiles { lower: lower.min(1.0), median: 1.0, upper: upper.max(1.0) };
        let [from, to] = self.interval;
        Self { quartiles, interval: [from.min(1.0), to.max(1.0)], ..self.clone() }
    }

    /// A ratio that was measured once, without pairs.
    pub const fn once(ratio: f64, a_ms: f64) -> Self {
        let quartiles = Quartiles { lower: ratio, median: ratio, upper: ratio };
        Self { quartiles, interval: [ratio; 2], pairs: 1, thrown: 0, a_ms }
    }

    /// The ratio of some pairs, each with the two times of A and of B in milliseconds.
    fn of(pairs: &[[[f64; 2]; 2]], thrown: usize) -> Option<Self> {
        let side = |pairs: &mut dyn Iterator<Item = &[[f64; 2]; 2]>, which: usize| {
            quantile_of(pairs.flat_map(|pair| pair[which]).collect(), UNDISTURBED)
        };
        let a_ms = side(&mut pairs.iter(), 0)?;
        let ratio = side(&mut pairs.iter(), 1)? / a_ms;
        // A fixed seed: the same times always give the same interval.
        let mut rng = Rng::new(1);
        let mut resampled: Vec<f64> = (0..RESAMPLES)
            .filter_map(|_| {
                let some: Vec<_> = pairs.iter().map(|_| &pairs[rng.index(pairs.len())]).collect();
                Some(side(&mut some.iter().copied(), 1)? / side(&mut some.iter().copied(), 0)?)
            })
            .collect();
        resampled.sort_by(f64::total_cmp);
        let at = |p: f64| quantile_of(resampled.clone(), p);
        let tail = (1.0 - CONFIDENCE) / 2.0;
        let (lower, upper) = (at(0.25)?.min(ratio), at(0.75)?.max(ratio));
        let mut interval = [at(tail)?.min(ratio), at(1.0 - tail)?.max(ratio)];
        // Resamples of a few pairs differ too little, so the interval contains each pair's ratio.
        if pairs.len() < FEW {
            for [a, b] in pairs {
                let ratio = (b[0] + b[1]) / (a[0] + a[1]);
                interval = [interval[0].min(ratio), interval[1].max(ratio)];
            }
        }
        let quartiles = Quartiles { lower, median: ratio, upper };
        Some(Self { quartiles, interval, pairs: pairs.len(), thrown, a_ms })
    }

    /// Whether its interval is narrow enough.
    fn is_narrow(&self) -> bool {
        let [lower, upper] = self.interval;
        upper - lower <= NARROW * self.quartiles.median
    }
}

/// The reason why a measurement failed.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, thiserror::Error)]
pub enum Unmeasured {
    /// It was cancelled.
    #[error("cancelled")]
    Cancelled,
    /// The interface was busy during every pair.
    #[error("every pair was disturbed")]
    Disturbed,
    /// Equal settings gave different bytes.
    #[error("{0}: the same settings gave two different pictures")]
    Unsteady(String),
}

impl From<Cancelled> for Unmeasured {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}

/// Measures the time of B relative to A.
///
/// # Errors
/// If it was cancelled, if every pair was disturbed, or if a picture differs from the one before.
pub fn measure(
    clock: &mut dyn Clock,
    source: &mut dyn PictureSource,
    [a, b]: [&Settings; 2],
    limits: &Limits,
    watch: &Watch,
) -> Result<Ratio, Unmeasured> {
    let mut expected = [None; 2];
    let mut draw = |which: usize| {
        let settings = [a, b][which];
        let time = clock.time(Work::Picture(settings), &mut || source.draw(settings));
        // A cancelled picture is incomplete, and says nothing.
        if watch.progress.is_cancelled() {
            return Err(Unmeasured::Cancelled);
        }
        // Hashing is outside the timed part.
        let hash = hash(source.picture());
        match expected[which].replace(hash) {
            Some(before) if before != hash => Err(Unmeasured::Unsteady(settings.in_words())),
            _ => Ok(time.as_secs_f64() * 1e3),
        }
    };
    abba(limits, watch, &mut draw)
}

/// Measures two tasks in pairs; `run` executes task 0 or 1 and returns its milliseconds.
///
/// # Errors
/// If it was cancelled, if every pair was disturbed, or if `run` fails.
pub fn abba(
    limits: &Limits,
    watch: &Watch,
    run: &mut dyn FnMut(usize) -> Result<f64, Unmeasured>,
) -> Result<Ratio, Unmeasured> {
    // The first runs fill caches, so they are not counted.
    run(0)?;
    run(1)?;
    let (mut pairs, mut thrown, mut spent) = (Vec::new(), 0, 0.0);
    let mut endless = None;
    // Discarded pairs are limited, too: constant touches must not keep the loop running.
    while pairs.len() < limits.pairs && thrown < MOST_THROWN * limits.pairs {
        // Both orders occur equally often.
        if pairs.len() >= limits.least && (pairs.len() + thrown).is_multiple_of(2) {
            let is_narrow = Ratio::of(&pairs, thrown).is_some_and(|ratio| ratio.is_narrow());
            if is_narrow || spent >= limits.time.as_secs_f64() * 1e3 {
                break;
            }
        }
        if pairs.len() >= LEAST_SLOW && spent >= LONGEST * limits.time.as_secs_f64() * 1e3 {
            break;
        }
        if watch.progress.is_cancelled() {
            return Err(Unmeasured::Cancelled);
        }
        // A pair counts only if no touch began, ended or was active during it.
        watch.settle(&mut endless);
        let before = watch.touches();
        let outer = (pairs.len() + thrown) % 2;
        let [first, second, third, last] =
            [run(outer)?, run(1 - outer)?, run(1 - outer)?, run(outer)?];
        let mut times = [[first, last], [second, third]];
        times.rotate_left(outer);
        let pair = first + second + third + last;
        spent += pair;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a time")]
        watch.touches.pair.store(pair.ceil() as u64, Ordering::Relaxed);
        let is_undisturbed = watch.touches() == before && before.is_multiple_of(2);
        if is_undisturbed || pair >= LONG {
            pairs.push(times);
        } else {
            thrown += 1;
        }
    }
    // Without a single valid pair, there is no result.
    Ratio::of(&pairs, thrown).ok_or(Unmeasured::Disturbed)
}

/// Pairs of at least this many milliseconds count even if they were touched. A window that is drawn
/// a few times per second touches every such pair, but takes a small part of it.
const LONG: f64 = 500.0;

/// The most discarded pairs for each wanted pair.
const MOST_THROWN: usize = 3;

#[cfg(test)]
mod tests {
    use std::thread::Builder;

    use super::*;

    const LIMITS: Limits = Limits { pairs: 9, least: 3, time: Duration::from_millis(40) };

    #[test]
    fn a_steady_drift_cancels_and_twice_the_time_is_twice() {
        let mut clock = 0.0;
        let ratio = abba(&LIMITS, &Watch::default(), &mut |which| {
            clock += 0.01;
            Ok(if which == 0 { 1.0 } else { 2.0 } * (1.0 + clock))
        });
        let ratio = ratio.unwrap();
        assert!((ratio.quartiles.median - 2.0).abs() < 0.05, "{ratio:?}");
    }

    #[test]
    fn neither_gains_from_its_place_in_the_pair() {
        let (mut before, mut count) = (2, 0);
        let mut run = |which| {
            count += 1;
            // The first picture of a pair finds cold caches, after two that are not counted.
            let is_first = count > 2 && count % 4 == 3;
            let follows = std::mem::replace(&mut before, which) == which;
            Ok(if is_first {
                1.3
            } else if follows {
                1.0
            } else {
                1.1
            })
        };
        let limits = Limits { pairs: 8, ..LIMITS };
        let ratio = abba(&limits, &Watch::default(), &mut run).unwrap();
        assert_eq!(ratio.quartiles.median, 1.0, "{ratio:?}");
    }

    #[test]
    fn the_noise_of_a_ratio_is_at_least_the_floor() {
        let mut times = [1.0, 1.3, 1.1, 1.4, 1.2, 1.5, 1.3, 1.6, 1.25].into_iter().cycle();
        let mut run = |which| Ok(if which == 0 { 1.0 } else { times.next().unwrap_or(1.0) });
        let ratio = abba(&LIMITS, &Watch::default(), &mut run).unwrap();
        let [lower, upper] = ratio.interval;
        let median = ratio.quartiles.median;
        assert!(lower <= median && median <= upper && lower < upper, "{ratio:?}");
        assert_eq!(ratio.noise(0.0), ratio.interval);
        let [below, above] = ratio.noise(1.0);
        assert!(below <= median / 2.0 && above >= median * 2.0, "{ratio:?}");
    }

    #[test]
    fn a_choice_has_at_least_the_least_and_at_most_the_most_pairs() {
        let pairs = |ms: f64, noise: [f64; 3]| {
            let mut noise = noise.into_iter().cycle();
            let mut run =
                |which| Ok(ms * if which == 0 { 1.0 } else { noise.next().unwrap_or(1.0) });
            abba(&LIMITS, &Watch::default(), &mut run).unwrap().pairs
        };
        // Measuring continues while the interval is wide and there is time; pictures that take far
        // longer have two pairs.
        let noisy = [1.0, 5.0, 9.0];
        assert_eq!([pairs(0.001, noisy), pairs(100.0, noisy), pairs(0.001, [1.0; 3])], [9, 2, 4]);
    }

    #[test]
    fn a_pair_that_was_touched_is_thrown_away_and_counted() {
        let (watch, mut runs) = (Watch::default(), 0);
        let ratio = abba(&LIMITS, &watch, &mut |which| {
            runs += 1;
            // The second pair, after two uncounted runs.
            if runs == 8 {
                drop(watch.touch());
                return Ok(LONG / 2.0);
            }
            Ok(if which == 0 { 2.0 } else { 1.0 } * 0.001)
        });
        let ratio = ratio.unwrap();
        assert_eq!((ratio.thrown, ratio.quartiles.upper), (1, 0.5));
        let touch = watch.touch();
        let long = abba(&LIMITS, &watch, &mut |_| Ok(LONG / 4.0)).unwrap();
        assert!(long.pairs > 0 && long.thrown == 0, "{long:?}");
        let disturbed = abba(&LIMITS, &watch, &mut |_| Ok(1.0));
        drop(touch);
        assert_eq!(disturbed, Err(Unmeasured::Disturbed));
    }

    /// Otherwise short pairs would all be over before a slow window is shown.
    #[test]
    fn a_touch_that_takes_longer_than_all_pairs_is_waited_for() {
        let watch = Watch::default();
        let touch = watch.touch();
        let show = move || {
            std::thread::sleep(Duration::from_millis(50));
            drop(touch);
        };
        let shown = Builder::new().name("window".to_owned()).spawn(show).unwrap();
        let limits = Limits { pairs: 1, least: 1, time: Duration::ZERO };
        let ratio = abba(&limits, &watch, &mut |_| Ok(0.001)).unwrap();
        shown.join().unwrap();
        assert_eq!((ratio.pairs, ratio.thrown), (1, 0));
    }

    #[test]
    fn who_waits_can_end_it() {
        let watch = Watch::default();
        let ended = abba(&LIMITS, &watch, &mut |_| {
            watch.progress.cancel();
            Ok(1.0)
        });
        assert_eq!(ended, Err(Unmeasured::Cancelled));
    }
}

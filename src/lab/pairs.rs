//! How much longer one way of drawing takes than another, measured so that the machine's moods cancel.
//!
//! A pair is four pictures, A B B A: what grows or shrinks steadily meanwhile falls on both alike. What
//! counts is the ratio of each pair; their median and quartiles are told, and how many there were. Every
//! picture is hashed after it was timed, so that none of the work can be left out, and the same settings
//! are held to give the same bytes.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use serde::Serialize;

use super::picture_source::{PictureSource, hash};
use super::statistics::Quartiles;
use super::timing::{Clock, Work};
use crate::accuracy::Settings;
use crate::io::{Cancelled, Progress};

/// How long is measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// At most so many pairs of a choice.
    pub pairs: usize,
    /// At least so many.
    pub least: usize,
    /// No further pair is begun when a choice has taken so long, once there are enough.
    pub time: Duration,
}

/// The one who waits for measurements, and may disturb them.
#[derive(Clone, Debug, Default)]
pub struct Watch {
    /// How far they are, and whether they should end.
    pub progress: Progress,
    touches: Arc<Touches>,
}

#[derive(Debug, Default)]
struct Touches {
    /// Odd while the machine is used for something else.
    count: AtomicU64,
    last: Mutex<Option<Instant>>,
    /// How long the last pair took, in milliseconds.
    pair: AtomicU64,
}

/// The machine is used for something else as long as this lives.
#[derive(Debug)]
pub struct Touch(Arc<Touches>);

/// What goes on for a little after a touch, like the showing of what was drawn, is waited for.
const AFTERMATH: Duration = Duration::from_millis(40);

impl Watch {
    /// Watches with the progress of other work.
    #[must_use]
    pub fn with(self, progress: &Progress) -> Self {
        Self { progress: progress.clone(), ..self }
    }

    /// Says that the machine is used for something else from now on: the pair that is measured meanwhile
    /// is thrown away.
    #[must_use]
    pub fn touch(&self) -> Touch {
        self.touches.count.fetch_add(1, Ordering::Relaxed);
        Touch(Arc::clone(&self.touches))
    }

    /// How long the pairs that are measured now take: whoever touches more often than that disturbs
    /// all of them.
    #[must_use]
    pub fn pair(&self) -> Duration {
        Duration::from_millis(self.touches.pair.load(Ordering::Relaxed))
    }

    fn touches(&self) -> u64 {
        self.touches.count.load(Ordering::Relaxed)
    }

    /// Waits for the aftermath of the last touch; but only once, for whoever touches without pause shall
    /// see that the work goes on.
    fn settle(&self) {
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

/// What was measured of a choice, B, against another, A.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Ratio {
    /// How many times as long B takes.
    pub quartiles: Quartiles,
    /// How many pairs were measured.
    pub pairs: usize,
    /// How many more were thrown away.
    pub thrown: usize,
    /// Milliseconds of a picture of A, the median.
    pub a_ms: f64,
}

/// Why something is not measured.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Unmeasured {
    /// The one who waits wanted the end.
    #[error("cancelled")]
    Cancelled,
    /// The interface was at work all the time.
    #[error("no pair was left undisturbed")]
    Disturbed,
    /// The same settings gave other bytes than before.
    #[error("{0}: the same settings gave two different pictures")]
    Unsteady(String),
}

impl From<Cancelled> for Unmeasured {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}

/// Measures how many times as long B takes as A.
///
/// # Errors
/// Where it was cancelled, or disturbed all the time, or a picture came out otherwise than before.
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
        let hash = hash(source.picture());
        match expected[which].replace(hash) {
            Some(before) if before != hash => Err(Unmeasured::Unsteady(settings.in_words())),
            _ => Ok(time.as_secs_f64() * 1e3),
        }
    };
    abba(limits, watch, &mut draw)
}

/// Measures two pieces of work in pairs; `run` does number 0 or 1 and gives its milliseconds.
///
/// # Errors
/// Where it was cancelled or disturbed all the time, or `run` fails.
pub fn abba(
    limits: &Limits,
    watch: &Watch,
    run: &mut dyn FnMut(usize) -> Result<f64, Unmeasured>,
) -> Result<Ratio, Unmeasured> {
    // The first runs fill caches and queues, and are not counted.
    run(0)?;
    run(1)?;
    let (mut ratios, mut of_a, mut thrown, mut spent) = (Vec::new(), Vec::new(), 0, 0.0);
    while ratios.len() < limits.pairs && thrown < MOST_THROWN * limits.pairs {
        if ratios.len() >= limits.least && spent >= limits.time.as_secs_f64() * 1e3 {
            break;
        }
        if watch.progress.is_cancelled() {
            return Err(Unmeasured::Cancelled);
        }
        watch.settle();
        let before = watch.touches();
        let [a1, b1, b2, a2] = [run(0)?, run(1)?, run(1)?, run(0)?];
        let pair = a1 + b1 + b2 + a2;
        spent += pair;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a time")]
        watch.touches.pair.store(pair.ceil() as u64, Ordering::Relaxed);
        if watch.touches() == before && before.is_multiple_of(2) {
            ratios.push((b1 + b2) / (a1 + a2));
            of_a.extend([a1, a2]);
        } else {
            thrown += 1;
        }
    }
    let quartiles = Quartiles::of(&ratios).ok_or(Unmeasured::Disturbed)?;
    let a_ms = Quartiles::of(&of_a).ok_or(Unmeasured::Disturbed)?.median;
    Ok(Ratio { quartiles, pairs: ratios.len(), thrown, a_ms })
}

/// So many pairs may be thrown away for each that is wanted.
const MOST_THROWN: usize = 3;

#[cfg(test)]
mod tests {
    use super::*;

    const LIMITS: Limits = Limits { pairs: 9, least: 3, time: Duration::from_millis(40) };

    #[test]
    fn a_steady_drift_cancels_and_twice_the_time_is_twice() {
        let mut clock = 0.0;
        let ratio = abba(&LIMITS, &Watch::default(), &mut |which| {
            clock += 0.1;
            Ok(if which == 0 { 1.0 } else { 2.0 } * (1.0 + clock))
        });
        let ratio = ratio.unwrap();
        assert!((ratio.quartiles.median - 2.0).abs() < 0.01, "{ratio:?}");
    }

    #[test]
    fn a_choice_has_at_least_the_least_and_at_most_the_most_pairs() {
        let pairs = |ms: f64| abba(&LIMITS, &Watch::default(), &mut |_| Ok(ms)).unwrap().pairs;
        assert_eq!([pairs(0.001), pairs(2.0), pairs(100.0)], [9, 5, 3]);
    }

    #[test]
    fn a_pair_that_was_touched_is_thrown_away_and_counted() {
        let (watch, mut runs) = (Watch::default(), 0);
        let ratio = abba(&LIMITS, &watch, &mut |which| {
            runs += 1;
            // The second pair, behind two runs that are not counted.
            if runs == 8 {
                drop(watch.touch());
                return Ok(1000.0);
            }
            Ok(if which == 0 { 2.0 } else { 1.0 } * 0.001)
        });
        let ratio = ratio.unwrap();
        assert_eq!((ratio.thrown, ratio.quartiles.upper), (1, 0.5));
        let touch = watch.touch();
        let disturbed = abba(&LIMITS, &watch, &mut |_| Ok(1.0));
        drop(touch);
        assert_eq!(disturbed, Err(Unmeasured::Disturbed));
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

//! Adaptive quality: keeps the viewport responsive by lowering the quality of pictures.
//!
//! While something moves and frames take longer than the budget, frames are drawn at reduced
//! quality. As soon as everything is still, full quality returns. The choice of reduction rests on
//! measurements of the scene at hand: while it is still, each reduction is drawn once to measure
//! its time and its error. While it moves, the most exact reduction on the Pareto front of time and
//! error that keeps the budget is used. Until all are measured, a short chain is tried in order. No
//! code here reads a clock: times are passed in.
//!
//! A frame is cancelled for a newer one only at full quality, only if it takes longer than the
//! budget, and never twice in a row. A slow frame therefore never delays the next action, and in a
//! stream of changes at least every second frame is finished and shown. Frames at reduced quality
//! are always finished: cancelling them would not bring the next one sooner.

use std::time::Duration;

use super::reduction::{Applicable, COUNT, Reduction};
use marraztu_lab::front::{Point, front, most_exact_within};

/// A change of the time of full frames by this factor means that the scene is another one.
const ANOTHER_SCENE: f64 = 1.5;

/// The time of a picture at rest from which on a preview is shown first.
const SLOW: Duration = Duration::from_millis(500);

/// The part of the error that a slower reduction has to remove to be on the front.
const LEAST_CUT: f64 = 0.05;

/// The measurements of one reduction.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Known {
    /// The time of the last whole frame.
    time: Option<Duration>,
    /// The root mean square of its errors against full quality, in steps of a byte.
    error: Option<f64>,
}

/// Chooses the reduction from measured frame times and errors.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AdaptiveQuality {
    known: [Known; COUNT],
    /// The time of the last frame at full quality that was redrawn in part.
    part: Option<Duration>,
    last: Reduction,
}

impl Default for AdaptiveQuality {
    fn default() -> Self {
        Self { known: [Known::default(); COUNT], part: None, last: Reduction::NONE }
    }
}

impl AdaptiveQuality {
    /// Chooses the reduction of the next picture. `share` (0 to 1) is the part of the picture that
    /// has to be redrawn at full quality.
    pub(crate) fn choose(
        &self,
        moving: bool,
        share: f64,
        applicable: Applicable,
        budget: Duration,
    ) -> Reduction {
        let full = self.expected(Reduction::NONE, share);
        // A picture of many rays that is slow, or new, is preceded by one of few.
        if !moving && full.is_none_or(|time| time > SLOW) {
            return applicable.limited(Reduction::PREVIEW);
        }
        // Full quality if nothing moves, if it keeps the budget, or if its time is not known yet.
        if !moving || full.is_none_or(|time| time <= budget) {
            return Reduction::NONE;
        }
        let chosen = if self.unknown(applicable).is_none() {
            self.on_the_front(applicable, budget)
        } else {
            self.tried(applicable, budget)
        };
        // A reduction that is not quicker than full quality would only lose detail.
        match chosen {
            Some(chosen) if self.expected(chosen, 1.0).is_none_or(|time| Some(time) < full) => {
                chosen
            }
            Some(_) | None => Reduction::NONE,
        }
    }

    /// Finds the most exact reduction of the measured front that keeps the budget, else the
    /// quickest.
    fn on_the_front(&self, applicable: Applicable, budget: Duration) -> Option<Reduction> {
        let measured = |one: Reduction| {
            let Known { time, error } = self.known[one.place()];
            Some((one, Point { time: time?.as_secs_f64(), error: error? }))
        };
        let all: Vec<(Reduction, Point)> = applicable.reductions().filter_map(measured).collect();
        let points: Vec<Point> = all.iter().map(|(_, point)| *point).collect();
        let order = front(&points, LEAST_CUT);
        let on_front: Vec<Point> = order.iter().map(|i| points[*i]).collect();
        // `front` sorts by time, so the first point is the quickest.
        let place = most_exact_within(&on_front, budget.as_secs_f64()).unwrap_or(0);
        order.get(place).map(|i| all[*i].0)
    }

    /// Finds the first reduction of the chain that may keep the budget, else the quickest.
    fn tried(&self, applicable: Applicable, budget: Duration) -> Option<Reduction> {
        let mut quickest: Option<(Reduction, Duration)> = None;
        for reduction in Reduction::CHAIN {
            let reduction = applicable.limited(reduction);
            if reduction == Reduction::NONE {
                continue;
            }
            match self.known[reduction.place()].time {
                Some(time) if time > budget => {
                    if quickest.is_none_or(|(_, best)| time < best) {
                        quickest = Some((reduction, time));
                    }
                }
                Some(_) | None => return Some(reduction),
            }
        }
        quickest.map(|(reduction, _)| reduction)
    }

    /// Finds a reduction of this picture that has not been measured yet.
    fn unknown(&self, applicable: Applicable) -> Option<Reduction> {
        applicable.reductions().find(|one| self.known[one.place()].error.is_none())
    }

    /// Returns a reduction to measure while the picture is still; `None` if full quality keeps the
    /// budget or all reductions are measured.
    pub(crate) fn unmeasured(&self, applicable: Applicable, budget: Duration) -> Option<Reduction> {
        let full = self.known[0].time.filter(|time| *time > budget);
        full.and_then(|_| self.unknown(applicable))
    }

    /// Records the time and the error of a reduction, drawn while the picture was still.
    pub(crate) fn measured(&mut self, reduction: Reduction, time: Duration, error: f64) {
        let known = &mut self.known[reduction.place()];
        // The time of a frame that was shown is better: its memory was already allocated.
        known.time = known.time.or(Some(time));
        known.error = Some(error);
    }

    /// Returns the measured error of a reduction, in steps of a byte.
    pub(crate) fn error(&self, reduction: Reduction) -> Option<f64> {
        self.known[reduction.place()].error
    }

    /// Returns the expected time of a frame, if known.
    pub(crate) fn expected(&self, reduction: Reduction, share: f64) -> Option<Duration> {
        let whole = self.known[reduction.place()].time;
        if reduction != Reduction::NONE || share >= 1.0 {
            return whole;
        }
        self.part.or(whole.map(|whole| whole.mul_f64(share)))
    }

    pub(crate) fn record(&mut self, reduction: Reduction, share: f64, time: Duration) {
        let again = std::mem::replace(&mut self.last, reduction) == reduction;
        if reduction != Reduction::NONE {
            // The first frame at a reduction also allocates memory.
            if again {
                self.record_reduced(reduction, time);
            }
        } else if share < 1.0 {
            self.part = Some(time);
        } else {
            let before = self.known[0].time.map_or(0.0, |before| before.as_secs_f64());
            let times = time.as_secs_f64() / before;
            // A very different time means another scene: the old measurements no longer apply.
            if !(1.0 / ANOTHER_SCENE..=ANOTHER_SCENE).contains(&times) {
                self.known = [Known::default(); COUNT];
                self.part = None;
            }
            self.known[0].time = Some(time);
        }
    }

    /// Records the time of a reduced frame and scales the times of all other reductions.
    ///
    /// A view that is slower at one reduction is slower at the others too. Their times are scaled
    /// by the square root of the ratio, which limits the effect of a single slow frame.
    fn record_reduced(&mut self, reduction: Reduction, time: Duration) {
        let before = self.known[reduction.place()].time.replace(time);
        let Some(before) = before.filter(|before| !before.is_zero()) else { return };
        let ratio = (time.as_secs_f64() / before.as_secs_f64()).clamp(0.25, 4.0).sqrt();
        for (place, known) in self.known.iter_mut().enumerate().skip(1) {
            if place != reduction.place() {
                known.time = known.time.map(|time| time.mul_f64(ratio));
            }
        }
    }

    /// Records that a frame at full quality was cancelled after this time, which is a lower bound.
    pub(crate) fn record_given_up(&mut self, share: f64, after: Duration) {
        let known = if share < 1.0 { &mut self.part } else { &mut self.known[0].time };
        *known = (*known).max(Some(after));
    }
}

/// A frame that is being drawn.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Attempt {
    pub(crate) reduction: Reduction,
    /// Its expected time, if known.
    pub(crate) expected: Option<Duration>,
    /// Whether the frame before it was cancelled.
    pub(crate) second: bool,
    /// The time that a frame may take.
    pub(crate) budget: Duration,
}

impl Attempt {
    /// Returns whether the frame is cancelled for a newer one after this time.
    pub(crate) fn gives_way(&self, elapsed: Duration) -> bool {
        let time = self.expected.map_or(elapsed, |expected| expected.max(elapsed));
        self.reduction == Reduction::NONE && !self.second && time > self.budget
    }
}

#[cfg(test)]
mod tests {
    use super::super::reduction::Shrink;
    use super::*;
    use marraztu_core::accuracy::Settings;

    const BUDGET: Duration = Duration::from_millis(33);

    fn all() -> Applicable {
        Applicable { settings: Settings::default(), textured: true, casts_rays: false }
    }

    fn ms(time: u64) -> Duration {
        Duration::from_millis(time)
    }

    /// Returns the chain as limited by [`all`], without the one with one sample per pixel.
    fn chain() -> [Reduction; 5] {
        let [_, vertex, nearest, half, all_half, quarter] = Reduction::CHAIN;
        [vertex, nearest, half, all_half, quarter].map(|one| all().limited(one))
    }

    fn place(reduction: Reduction) -> usize {
        chain().iter().position(|other| *other == reduction).map_or(0, |i| i + 1)
    }

    /// Draws frames with these times until the choice no longer changes, and returns the choice.
    fn settled(quality: &mut AdaptiveQuality, times: [u64; 6]) -> Reduction {
        let mut last = Reduction::NONE;
        for _ in 0..20 {
            last = quality.choose(true, 1.0, all(), BUDGET);
            quality.record(last, 1.0, ms(times[place(last)]));
        }
        last
    }

    #[test]
    fn before_anything_is_measured_a_chain_is_tried_and_the_first_that_is_quick_enough_stays() {
        let [vertex, nearest, half, least, quarter] = chain();
        for (times, chosen) in [
            ([20, 1, 1, 1, 1, 1], Reduction::NONE),
            ([33, 1, 1, 1, 1, 1], Reduction::NONE),
            ([60, 30, 20, 20, 10, 5], vertex),
            ([60, 40, 20, 20, 10, 5], nearest),
            ([60, 50, 50, 20, 10, 5], half),
            ([200, 150, 100, 60, 30, 10], least),
            ([900, 850, 800, 300, 250, 200], quarter),
        ] {
            let mut quality = AdaptiveQuality::default();
            assert_eq!(settled(&mut quality, times), chosen, "{times:?}");
            assert_eq!(quality.choose(false, 1.0, all(), BUDGET), Reduction::NONE, "still");
        }
    }

    /// Returns a quality with every reduction measured: `of` gives its time and its error.
    fn surveyed(of: impl Fn(Reduction) -> (u64, f64)) -> AdaptiveQuality {
        let mut quality = AdaptiveQuality::default();
        quality.record(Reduction::NONE, 1.0, ms(200));
        while let Some(one) = quality.unmeasured(all(), BUDGET) {
            let (time, error) = of(one);
            quality.measured(one, ms(time), error);
        }
        quality
    }

    #[test]
    fn once_measured_the_most_exact_reduction_that_keeps_the_budget_is_chosen() {
        let half = Reduction { shrink: Shrink::Half, ..Reduction::NONE };
        let vertex = Reduction { vertex_light: true, ..Reduction::NONE };
        // Here vertex lighting costs more than it saves, and nearest texels have a large error.
        let of = |one: Reduction| {
            let mut error = [0.0, 4.0, 9.0][one.shrink as usize];
            let mut time = [150, 40, 10][one.shrink as usize];
            if one.vertex_light {
                (error, time) = (error + 1.0, time + 5);
            }
            if one.nearest_texels {
                (error, time) = (error + 20.0, time - 8);
            }
            (time, error)
        };
        let quality = surveyed(of);
        let choose = |budget| quality.choose(true, 1.0, all(), ms(budget));
        let quarter = Reduction { shrink: Shrink::Quarter, ..Reduction::NONE };
        assert_eq!(choose(33), quarter);
        assert_eq!(choose(40), half, "a longer budget walks up the front");
        assert_eq!(choose(155), vertex);
        assert_eq!(choose(250), Reduction::NONE);
        assert_eq!(choose(1).shrink, Shrink::Quarter, "the quickest");
        assert_eq!(quality.error(half), Some(4.0));
        assert_eq!(quality.unmeasured(all(), BUDGET), None, "nothing is left to measure");
    }

    #[test]
    fn a_view_that_becomes_slower_walks_down_the_front() {
        let mut quality = surveyed(|one| match one.shrink {
            Shrink::Whole => (100, 1.0),
            Shrink::Half => (30, 4.0),
            Shrink::Quarter => (9, 9.0),
        });
        let first = quality.choose(true, 1.0, all(), BUDGET);
        assert_eq!(first.shrink, Shrink::Half);
        for _ in 0..3 {
            quality.record(first, 1.0, ms(60));
        }
        assert_eq!(quality.choose(true, 1.0, all(), BUDGET).shrink, Shrink::Quarter);
    }

    #[test]
    fn a_scene_that_keeps_the_budget_is_not_measured() {
        let mut quality = AdaptiveQuality::default();
        assert_eq!(quality.unmeasured(all(), BUDGET), None);
        quality.record(Reduction::NONE, 1.0, ms(30));
        assert_eq!(quality.unmeasured(all(), BUDGET), None);
        quality.record(Reduction::NONE, 1.0, ms(34));
        assert!(quality.unmeasured(all(), BUDGET).is_some());
    }

    #[test]
    fn where_only_a_part_is_drawn_again_its_own_time_counts() {
        let mut quality = AdaptiveQuality::default();
        let choose = |quality: &AdaptiveQuality, share| quality.choose(true, share, all(), BUDGET);
        quality.record(Reduction::NONE, 1.0, ms(100));
        assert_eq!(choose(&quality, 0.2), Reduction::NONE, "20 ms of 100");
        assert_ne!(choose(&quality, 0.5), Reduction::NONE, "50 ms of 100");
        quality.record(Reduction::NONE, 0.2, ms(60));
        assert_ne!(choose(&quality, 0.2), Reduction::NONE, "it was 60 ms");
        assert_ne!(choose(&quality, 1.0), Reduction::NONE);
    }

    #[test]
    fn times_of_another_scene_are_forgotten() {
        let mut quality = AdaptiveQuality::default();
        let [vertex, _, half, ..] = chain();
        assert_eq!(settled(&mut quality, [60, 50, 50, 20, 10, 5]), half);
        quality.record(Reduction::NONE, 1.0, ms(70));
        assert_eq!(quality.choose(true, 1.0, all(), BUDGET), half, "about the same");
        quality.record(Reduction::NONE, 1.0, ms(300));
        assert_eq!(quality.choose(true, 1.0, all(), BUDGET), vertex, "tried again");
    }

    #[test]
    fn in_a_stream_of_changes_every_second_frame_is_finished() {
        let (reduction, budget) = (Reduction::NONE, BUDGET);
        let slow = Attempt { reduction, expected: Some(ms(500)), second: false, budget };
        assert!(slow.gives_way(ms(0)));
        assert!(!Attempt { second: true, ..slow }.gives_way(ms(10_000)));
        // A frame that is nearly done is awaited. Coarse frames are finished to keep the stream
        // going.
        let quick = Attempt { expected: Some(ms(20)), ..slow };
        assert!(!quick.gives_way(ms(30)) && quick.gives_way(ms(40)));
        assert!(!Attempt { reduction: chain()[4], ..slow }.gives_way(ms(10_000)));
        let unknown = Attempt { expected: None, ..slow };
        assert!(!unknown.gives_way(ms(30)) && unknown.gives_way(ms(40)));
    }

    #[test]
    fn a_frame_that_was_given_up_is_known_to_be_slow() {
        let mut quality = AdaptiveQuality::default();
        quality.record(Reduction::NONE, 1.0, ms(5));
        quality.record_given_up(1.0, ms(40));
        assert_eq!(quality.choose(true, 1.0, all(), BUDGET), chain()[0]);
        quality.record_given_up(1.0, ms(2));
        assert_eq!(quality.expected(Reduction::NONE, 1.0), Some(ms(40)));
    }
}

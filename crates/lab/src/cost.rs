//! Explains the effects of a frame, and measures the cost of each in pixels and milliseconds, and
//! how far the picture without it is from the one with it.
//!
//! A time is measured by alternating frames with and without the effect. The result is the median
//! of the differences; its spread is half the interquartile range. Pairs of equal frames, measured
//! first, give the noise: a time within it is meaningless.

use std::hint::black_box;
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

use super::dial::rmse;
use super::flip::{Perceived, VISIBLE};
use super::statistics::Quartiles;
use super::timing::time;
use marraztu_core::accuracy::Shot;
use marraztu_core::base::image::Size;
use marraztu_render::explain_frame;
use marraztu_render::plan_frame;
use marraztu_render::{Effect, EffectUse, FramePlan, PathPixels, Renderer};

/// The fewest pairs per effect, unless frames take long.
const PAIRS: usize = 7;

/// The noise of frames that take long, as a part of their time: one pair shows none.
const SLOW_NOISE: f64 = 0.05;

/// The time for which frames are drawn before they are measured.
const WARM: Duration = Duration::from_millis(30);

/// The most pairs per effect.
const MOST_PAIRS: usize = 31;

/// The effects of a frame.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Explained {
    /// The uses and omissions of effects, sorted by effect.
    pub uses: Vec<EffectUse>,
    /// The size of the picture.
    pub size: Size,
    /// How its pixels were coloured, if all were.
    pub paths: Option<PathPixels>,
}

/// The uses of one effect; never empty.
#[derive(Clone, Copy, Debug)]
pub struct Group<'a> {
    /// The effect.
    pub effect: Effect,
    /// The uses and omissions.
    pub uses: &'a [EffectUse],
}

impl Explained {
    /// Groups the uses by effect.
    pub fn groups(&self) -> impl Iterator<Item = Group<'_>> {
        let groups = self.uses.chunk_by(|a, b| a.effect == b.effect);
        groups.map(|uses| Group { effect: uses[0].effect, uses })
    }
}

impl Group<'_> {
    /// Returns the number of items with the effect on.
    pub fn on(&self) -> usize {
        self.uses.iter().filter(|one| one.state.is_on()).count()
    }

    /// Returns whether all uses are in the same state, for the same reason.
    pub fn is_alike(&self) -> bool {
        self.uses.iter().all(|one| one.state == self.uses[0].state)
    }

    /// Returns the total number of pixels.
    pub fn pixels(&self) -> Option<u64> {
        let counted = self.uses.iter().filter_map(|one| one.pixels);
        counted.reduce(|sum, pixels| sum + pixels)
    }

    /// Describes the items with the effect on.
    pub fn of(&self) -> String {
        let (on, all) = (self.on(), self.uses.len());
        match &self.uses[0].on {
            None => "the frame".to_owned(),
            Some(thing) if all == 1 => thing.name.clone(),
            Some(_) if self.is_alike() => format!("all {all} objects"),
            Some(_) => format!("{on} of {all} objects"),
        }
    }
}

/// The cost of an effect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cost {
    /// The effect.
    pub effect: Effect,
    /// The milliseconds that the effect adds to a frame.
    pub milliseconds: f64,
    /// Half the interquartile range of the milliseconds.
    pub spread: f64,
    /// What is missing without the effect.
    pub missed: Missed,
}

/// How far a picture without an effect is from the one with it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Missed {
    /// The root mean square difference in byte steps.
    pub rmse: f64,
    /// The largest FLIP of a pixel, from 0 to 1.
    pub flip: f64,
}

impl Missed {
    /// Returns whether a pixel differs visibly: see [`VISIBLE`].
    pub fn is_seen(&self) -> bool {
        self.flip > VISIBLE
    }
}

/// The measurements of a frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Costs {
    /// The time of the frame in milliseconds.
    pub frame: f64,
    /// The apparent difference of two equal frames in milliseconds.
    pub noise: f64,
    /// The costs of all removable effects that are on.
    pub effects: Vec<Cost>,
}

impl Costs {
    /// Returns the cost of an effect, if it was measured.
    pub fn of(&self, effect: Effect) -> Option<&Cost> {
        self.effects.iter().find(|cost| cost.effect == effect)
    }

    /// Returns whether a cost exceeds the noise.
    pub fn is_clear(&self, cost: &Cost) -> bool {
        cost.milliseconds.abs() > self.noise + cost.spread
    }

    /// Returns the effects in the order of the error that a millisecond of them saves, the most
    /// worthwhile first. Times below the noise count as noise.
    pub fn by_worth(&self) -> Vec<&Cost> {
        let worth = |cost: &Cost| {
            let ms = cost.milliseconds.max(self.noise).max(f64::MIN_POSITIVE);
            (cost.missed.is_seen(), cost.missed.rmse / ms)
        };
        let mut all: Vec<&Cost> = self.effects.iter().collect();
        all.sort_by(|a, b| {
            let ((seen, worth), (other_seen, other)) = (worth(a), worth(b));
            other_seen.cmp(&seen).then(other.total_cmp(&worth))
        });
        all
    }
}

/// Plans and draws a picture, and counts the pixels of each effect.
pub fn explain(shot: &Shot) -> Explained {
    let mut renderer = Renderer::default();
    renderer.render(&plan_frame(shot));
    explain_with(&mut renderer, shot)
}

/// Works like [`explain`], for the picture that `renderer` drew last.
pub fn explain_with(renderer: &mut Renderer, shot: &Shot) -> Explained {
    let (_, mut uses) = explain_frame(shot);
    let paths = renderer.path_pixels();
    renderer.count(&mut uses);
    Explained { uses, size: shot.size, paths }
}

/// Measures the costs of a picture's effects within about `budget`. Once `stopped` returns true,
/// the result is partial.
pub fn measure(shot: &Shot, budget: Duration, stopped: impl Fn() -> bool) -> Costs {
    let (plan, uses) = explain_frame(shot);
    let mut effects: Vec<Effect> =
        uses.iter().filter(|one| one.state.is_on()).map(|one| one.effect).collect();
    effects.dedup();
    let without: Vec<(Effect, FramePlan)> =
        effects.iter().filter_map(|effect| Some((*effect, plan.without(*effect)?))).collect();
    // The budget is divided equally among the effects and the control.
    let share = budget / u32::try_from(without.len() + 1).unwrap_or(u32::MAX);

    // Warm up caches and memory before the control measurement.
    let (mut bench, begun) = (Bench::default(), Instant::now());
    bench.time(&plan);
    while begun.elapsed() < WARM && !stopped() {
        bench.time(&plan);
    }
    let picture = bench.renderer.picture().clone();
    let perceived = Perceived::new(&picture);
    let control = bench.pairs(&plan, &plan, share, &stopped);
    let least = if control.count < PAIRS { control.frame * SLOW_NOISE } else { 0.0 };
    let noise = noise(&control.difference).max(least);
    let mut costs = Costs { frame: control.frame, noise, effects: Vec::new() };
    for (effect, without) in &without {
        if stopped() {
            break;
        }
        // The first frame allocates memory, so its time does not count.
        bench.time(without);
        let other = bench.renderer.picture();
        let rmse = rmse(&picture, other);
        // The same bytes need no filters.
        let flip = if rmse > 0.0 { perceived.largest_of_all(&Perceived::new(other)) } else { 0.0 };
        let missed = Missed { rmse, flip };
        let difference = bench.pairs(&plan, without, share, &stopped).difference;
        let (milliseconds, spread) = (difference.median, difference.spread());
        costs.effects.push(Cost { effect: *effect, milliseconds, spread, missed });
    }
    costs
}

#[derive(Default)]
struct Bench {
    renderer: Renderer,
}

/// The median frame in milliseconds, and the extra time of the frame with the effect.
struct Pairs {
    frame: f64,
    difference: Quartiles,
    /// The number of pairs.
    count: usize,
}

impl Bench {
    fn time(&mut self, plan: &FramePlan) -> f64 {
        let render = || {
            black_box(self.renderer.render(plan));
        };
        time(render).as_secs_f64() * 1e3
    }

    /// Times frames in the order with, without, without, with, which cancels drift.
    fn pairs(
        &mut self,
        with: &FramePlan,
        without: &FramePlan,
        share: Duration,
        stopped: &impl Fn() -> bool,
    ) -> Pairs {
        let begun = Instant::now();
        let (mut frames, mut differences) = (Vec::new(), Vec::new());
        let goes_on = |pairs: usize| {
            let spent = begun.elapsed();
            spent < share || pairs == 0 || (pairs < PAIRS && spent < share * 3)
        };
        while differences.len() < MOST_PAIRS && goes_on(differences.len()) && !stopped() {
            // Alternate the order within pairs, so that neither plan always comes first.
            let (a, b) = if differences.len().is_multiple_of(2) {
                let a = self.time(with);
                (a, self.time(without))
            } else {
                let b = self.time(without);
                (self.time(with), b)
            };
            frames.push(a);
            differences.push(a - b);
        }
        // Without a complete pair, nothing was measured.
        let none = Quartiles { lower: 0.0, median: 0.0, upper: 0.0 };
        let count = differences.len();
        let [frame, difference] =
            [frames, differences].map(|all| Quartiles::of(&all).unwrap_or(none));
        Pairs { frame: frame.median, difference, count }
    }
}

/// Returns the apparent difference of equal frames: |median| plus half the interquartile range.
fn noise(differences: &Quartiles) -> f64 {
    differences.median.abs() + differences.spread()
}

#[cfg(test)]
mod tests {
    use super::*;
    use marraztu_core::accuracy::Settings;

    /// Differences with the median -1 and the quartiles -3 and 3.
    const DIFFERENCES: [f64; 9] = [4.0, -7.0, -3.0, 3.0, -1.0, 2.0, -2.0, 5.0, -4.0];

    #[test]
    fn the_noise_is_the_median_and_half_of_the_interquartile_range() {
        let differences = Quartiles::of(&DIFFERENCES).unwrap();
        assert_eq!(differences.spread(), 3.0);
        assert_eq!(noise(&differences), 4.0);
    }

    #[test]
    fn a_cost_within_the_noise_and_its_own_spread_is_not_clear() {
        let costs = Costs { frame: 9.0, noise: 4.0, effects: Vec::new() };
        let missed = Missed { rmse: 1.0, flip: 0.5 };
        let cost =
            |milliseconds| Cost { effect: Effect::Texture, milliseconds, spread: 3.0, missed };
        for within in [0.0, 6.5, 7.0, -7.0] {
            assert!(!costs.is_clear(&cost(within)), "{within}");
        }
        for beyond in [7.1, -7.1] {
            assert!(costs.is_clear(&cost(beyond)), "{beyond}");
        }
    }

    #[test]
    fn effects_are_ranked_by_the_error_that_a_millisecond_saves_and_unseen_ones_come_last() {
        let cost = |effect, milliseconds, rmse, flip| Cost {
            effect,
            milliseconds,
            spread: 0.1,
            missed: Missed { rmse, flip },
        };
        let effects = vec![
            cost(Effect::Bumps, 2.0, 50.0, 0.05),
            cost(Effect::Texture, 4.0, 8.0, 0.5),
            cost(Effect::Highlights, 1.0, 8.0, 0.5),
            // Its time is noise: it counts as 0.5.
            cost(Effect::Mirrors, 0.01, 1.0, 0.2),
        ];
        let costs = Costs { frame: 9.0, noise: 0.5, effects };
        let order: Vec<Effect> = costs.by_worth().iter().map(|cost| cost.effect).collect();
        assert_eq!(order, [Effect::Highlights, Effect::Texture, Effect::Mirrors, Effect::Bumps]);
    }

    /// The errors are those of pictures that are drawn without the effect.
    #[test]
    fn what_is_missed_is_the_difference_of_two_pictures() {
        let (scene, view) = marraztu_io::default_scene();
        let shot = Shot::new(&scene, &view, &Settings::default(), Size::new(80, 60));
        let costs = measure(&shot, Duration::ZERO, || false);
        let (plan, mut renderer) = (plan_frame(&shot), Renderer::default());
        let with = renderer.render(&plan).clone();
        for cost in &costs.effects {
            let without = renderer.render(&plan.without(cost.effect).unwrap()).clone();
            assert_eq!(cost.missed.rmse, rmse(&with, &without), "{:?}", cost.effect);
            assert_eq!(cost.missed.flip > 0.0, with != without, "{:?}", cost.effect);
        }
        assert!(costs.of(Effect::Surfaces).unwrap().missed.is_seen());
    }
}

//! The search for a budget finds the best of all combinations, with planted times and errors.

use std::collections::HashSet;
use std::time::Duration;

use marraztu_core::accuracy::{AXES, Axis, DepthFormat, Samples, Settings, Shot};
use marraztu_core::base::image::{Picture, Size};
use marraztu_core::base::rng::Rng;
use marraztu_lab::budget::{Answer, Goal, VISIBLE, search};
use marraztu_lab::flip::difference;
use marraztu_lab::picture_source::PictureSource;
use marraztu_lab::timing::{Clock, Work};

/// The axes with planted figures.
const PLANTED: [&str; 5] = ["shading", "arithmetic", "subpixels", "depth", "samples"];

const SIZE: Size = Size::new(64, 64);

/// A larger picture, for a slow ideal that is drawn only in part.
const LARGE: Size = Size::new(256, 256);

/// The figures of each choice: the factor of its time, and the number of pixels that it gets wrong.
struct Plants {
    choices: Vec<Vec<(f64, usize)>>,
    /// A pair of choices (axis, choice) that takes ten times as long as the model says.
    slow_pair: Option<[(usize, usize); 2]>,
    /// Whether a window of the ideal takes 0.1 s.
    has_slow_ideal: bool,
}

impl Plants {
    /// Choices that are slower the more exact they are, but for some that are of no use.
    fn random(seed: u64) -> Self {
        let mut rng = Rng::new(seed);
        let of_axis = |key: &&str| {
            let count = Axis::named(key).unwrap().choices.len();
            let (mut time, mut wrong) = (1.0, 40 * count + rng.index(400));
            let mut next = |i: usize| {
                let is_useless = *key != "samples" && rng.index(5) == 0;
                let here = (if is_useless { time * 3.0 } else { time }, wrong);
                time *= 1.1 + 0.1 * rng.index(10) as f64;
                wrong = if i + 2 == count { 0 } else { wrong / (2 + rng.index(3)) };
                here
            };
            (0..count).map(&mut next).collect()
        };
        Self {
            choices: PLANTED.iter().map(of_axis).collect(),
            slow_pair: None,
            has_slow_ideal: false,
        }
    }

    /// The numbers of the choices of these settings.
    fn numbers(settings: &Settings) -> Vec<usize> {
        let number = |key: &&str| {
            let axis = Axis::named(key).unwrap();
            axis.choices.iter().position(|choice| choice.is(settings)).unwrap()
        };
        PLANTED.iter().map(number).collect()
    }

    fn seconds(&self, settings: &Settings) -> f64 {
        if self.has_slow_ideal && settings.samples == Samples::TwoFiftySix {
            return 0.1;
        }
        let numbers = Self::numbers(settings);
        let is_slow = |pair: &[(usize, usize); 2]| pair.iter().all(|(i, n)| numbers[*i] == *n);
        let factor = if self.slow_pair.as_ref().is_some_and(is_slow) { 10.0 } else { 1.0 };
        let factors = numbers.iter().enumerate().map(|(i, n)| self.choices[i][*n].0);
        1e-5 * factor * factors.product::<f64>()
    }

    fn rmse(&self, settings: &Settings) -> f64 {
        let numbers = Self::numbers(settings);
        let wrong: usize = numbers.iter().enumerate().map(|(i, n)| self.choices[i][*n].1).sum();
        libm::sqrt((wrong * 40 * 40) as f64 / (3 * SIZE.area()) as f64)
    }
}

/// Draws a grey picture. Each axis has its own pixels to get wrong, so squared errors add up.
struct FakeSource<'a> {
    plants: &'a Plants,
    picture: Picture,
    /// The pixels of an axis in random order: the first ones are wrong.
    places: Vec<usize>,
    /// The settings that were drawn.
    drawn: HashSet<Settings>,
}

impl PictureSource for FakeSource<'_> {
    fn draw(&mut self, settings: &Settings) {
        self.drawn.insert(*settings);
        let numbers = Plants::numbers(settings);
        self.picture.pixels_mut().fill([100, 100, 100, 255]);
        let larger = self.picture.size().area() / SIZE.area();
        for (axis, number) in numbers.iter().enumerate() {
            let wrong = self.plants.choices[axis][*number].1 * larger;
            for place in &self.places[..wrong] {
                self.picture.pixels_mut()[place * PLANTED.len() + axis][0] = 140;
            }
        }
    }

    fn picture(&self) -> &Picture {
        &self.picture
    }

    fn primitives(&mut self) -> Vec<u32> {
        vec![1; self.picture.size().area()]
    }
}

struct FakeClock<'a>(&'a Plants, Duration);

impl Clock for FakeClock<'_> {
    fn time(&mut self, work: Work<'_>, todo: &mut dyn FnMut()) -> Duration {
        todo();
        let Work::Picture(settings) = work else { return Duration::ZERO };
        let time = Duration::from_secs_f64(self.0.seconds(settings));
        self.1 += time;
        time
    }

    fn now(&self) -> Duration {
        self.1
    }
}

fn planted_shot() -> Shot {
    let (scene, view) = marraztu_io::default_scene();
    // The other axes allow the ideal.
    Shot::new(&scene, &view, &Settings::default().ideal(), SIZE)
}

fn shuffle(all: &mut [usize], rng: &mut Rng) {
    for i in (1..all.len()).rev() {
        all.swap(i, rng.index(i + 1));
    }
}

/// Searches the planted axes that are not in `fixed`.
fn found(plants: &Plants, shot: &Shot, goal: Goal, fixed: &[&str]) -> Answer {
    let is_fixed = |key: &&str| !PLANTED.contains(key) || fixed.contains(key);
    let fixed: Vec<&Axis> = AXES.iter().filter(|axis| is_fixed(&axis.key)).collect();
    let picture = Picture::filled(shot.size, [100; 4]);
    let (mut places, mut rng) =
        ((0..shot.size.area() / PLANTED.len()).collect::<Vec<_>>(), Rng::new(9));
    shuffle(&mut places, &mut rng);
    let mut source = FakeSource { plants, picture, places, drawn: HashSet::new() };
    let mut clock = FakeClock(plants, Duration::ZERO);
    let answer = search(&mut source, &mut clock, shot, (goal, &fixed));
    assert!(source.drawn.len() < 90, "{} of 480 were drawn", source.drawn.len());
    answer
}

/// All combinations of the planted axes that make sense, without the ideal's samples.
fn combinations() -> Vec<Settings> {
    let mut all = vec![Settings::default()];
    for key in PLANTED {
        let choices = Axis::named(key).unwrap().choices;
        all = all.iter().flat_map(|it| choices.iter().map(|choice| choice.of(it))).collect();
    }
    let is_sensible = |it: &Settings| {
        let is_apart = |axis: &Axis| (axis.chosen(it).among)(it).is_ok();
        it.samples != Samples::TwoFiftySix
            && PLANTED.iter().all(|key| is_apart(Axis::named(key).unwrap()))
    };
    all.retain(is_sensible);
    all
}

/// Times and errors are planted for 480 combinations of five axes. The search draws fewer than 90.
#[test]
fn the_search_finds_the_best_of_all_combinations() {
    let (all, shot) = (combinations(), planted_shot());
    assert!(all.len() > 400);
    let (mut misses, mut worst) = (Vec::new(), 1.0_f64);
    for seed in 0..20 {
        let plants = Plants::random(seed);
        let mut times: Vec<f64> = all.iter().map(|it| plants.seconds(it) * 1e3).collect();
        let mut errors: Vec<f64> = all.iter().map(|it| plants.rmse(it)).collect();
        times.sort_by(f64::total_cmp);
        errors.sort_by(f64::total_cmp);
        for part in [2, 10, 30, 60] {
            let place = all.len() * part / 100;
            let (most, least) = (times[place], errors[place]);
            let within = all.iter().filter(|it| plants.seconds(it) * 1e3 <= most);
            let best = within.map(|it| plants.rmse(it)).fold(f64::INFINITY, f64::min);
            let answer = found(&plants, &shot, Goal::Within(most * 1.0001), &[]);
            assert!(answer.is_reached && answer.measured.ms.value <= most * 1.0001);
            let error = plants.rmse(&answer.measured.settings);
            assert!((answer.measured.error.value - error).abs() < 1e-9);
            if error > best * 1.011 + 1e-9 {
                misses.push((seed, part, "within", best, error));
            }
            let within = all.iter().filter(|it| plants.rmse(it) <= least);
            let best = within.map(|it| plants.seconds(it) * 1e3).fold(f64::INFINITY, f64::min);
            let answer = found(&plants, &shot, Goal::Error(least * 1.0001), &[]);
            assert!(answer.is_reached && answer.measured.error.interval[1] <= least * 1.0001);
            let ms = plants.seconds(&answer.measured.settings) * 1e3;
            worst = worst.max(ms / best);
            if ms > best * 1.05 {
                misses.push((seed, part, "error", best, ms));
            }
        }
    }
    assert!(misses.len() <= 1 && worst < 1.1, "{} of 160: {misses:?}", misses.len());
}

/// In each case, fast settings are 0.1% beyond the limit, and only a part of the windows is known.
#[test]
fn an_estimated_error_is_within_the_limit_in_19_of_20_cases() {
    let (all, mut shot) = (combinations(), planted_shot());
    shot.size = LARGE;
    let (mut beyond, mut partly) = (0, 0);
    for seed in 0..20 {
        let plants = Plants::random(seed);
        let mut errors: Vec<f64> = all.iter().map(|it| plants.rmse(it)).collect();
        errors.sort_by(f64::total_cmp);
        let fast = found(&plants, &planted_shot(), Goal::Error(errors[all.len() / 4]), &[]);
        let most = 0.999 * plants.rmse(&fast.measured.settings);
        let plants = Plants { has_slow_ideal: true, ..plants };
        let answer = found(&plants, &shot, Goal::Error(most), &[]);
        assert!(answer.is_reached);
        beyond += usize::from(plants.rmse(&answer.measured.settings) > most);
        partly += usize::from(answer.compared < 0.5);
    }
    assert!(beyond <= 1 && partly == 20, "{beyond} and {partly} of 20");
}

/// The model is wrong for two choices that the best settings would have.
#[test]
fn a_combination_that_is_slower_than_predicted_is_not_chosen() {
    let (shot, mut plants) = (planted_shot(), Plants::random(3));
    let most = 1e3 * 2.0 * plants.seconds(&Settings::default());
    let before = found(&plants, &shot, Goal::Within(most), &[]).measured;
    let numbers = Plants::numbers(&before.settings);
    plants.slow_pair = Some([(0, numbers[0]), (3, numbers[3])]);
    let after = found(&plants, &shot, Goal::Within(most), &[]);
    assert!(after.is_reached && after.measured.ms.value <= most);
    assert!(after.measured.settings != before.settings);
    assert!(1e3 * plants.seconds(&after.measured.settings) <= most);
}

#[test]
fn fixed_axes_and_models_keep_their_choices() {
    let (mut shot, plants) = (planted_shot(), Plants::random(1));
    let choose = |key: &str, word: &str, settings: &Settings| {
        Axis::named(key).unwrap().choice(word).unwrap().of(settings)
    };
    shot.settings = choose("depth", "bits-16", &shot.settings);
    shot.settings = choose("specular", "half-vector", &shot.settings);
    for goal in [Goal::Within(0.05), Goal::Within(5.0), Goal::Error(9.0)] {
        let settings = found(&plants, &shot, goal, &["depth"]).measured.settings;
        assert_eq!(
            (settings.depth, settings.specular),
            (shot.settings.depth, shot.settings.specular)
        );
    }
    // With every axis fixed, there is nothing to search.
    let answer = found(&plants, &shot, Goal::Within(1e6), &PLANTED);
    assert_eq!(answer.measured.settings, shot.settings);
    assert!(answer.is_reached);
}

#[test]
fn a_goal_out_of_reach_is_answered_with_the_nearest_settings() {
    let (mut shot, plants) = (planted_shot(), Plants::random(2));
    let answer = found(&plants, &shot, Goal::Within(1e-4), &[]);
    assert!(!answer.is_reached);
    let fastest = combinations().iter().map(|it| plants.seconds(it)).fold(f64::INFINITY, f64::min);
    assert!(answer.measured.ms.value <= 1e3 * fastest * 1.001);
    // Without error, only the ideal remains; it is out of reach with depths in 16 bits.
    let answer = found(&plants, &shot, Goal::Error(0.0), &[]);
    assert!(answer.is_reached && plants.rmse(&answer.measured.settings) == 0.0);
    shot.settings.depth = DepthFormat::Bits16;
    let answer = found(&plants, &shot, Goal::Error(0.0), &["depth"]);
    assert!(!answer.is_reached && answer.measured.error.value > 0.0);
}

/// A wrong pixel is 40 steps of red away. That is visible where several are near each other.
#[test]
fn pictures_that_look_the_same_have_no_pixel_with_a_visible_difference() {
    let (mut shot, plants) = (planted_shot(), Plants::random(4));
    let answer = found(&plants, &shot, Goal::Unseen, &[]);
    assert!(answer.is_reached && answer.measured.flip <= VISIBLE);
    assert!(plants.rmse(&answer.measured.settings) < 1.0 && answer.compared == 1.0);
    shot.settings = Settings { samples: Samples::One, ..Settings::default() };
    let answer = found(&plants, &shot, Goal::Unseen, &PLANTED);
    assert!(!answer.is_reached && answer.measured.flip > VISIBLE);
}

/// Grey 100 of 255 has a lightness of 42.4, grey 105 of 44.4, and grey 106 of 44.8: just noticeable
/// differences are 2.3.
#[test]
fn a_difference_is_visible_from_a_lightness_of_2_3() {
    let grey = |byte: u8| Picture::filled(SIZE, [byte, byte, byte, 255]);
    let flip = |byte| difference(&grey(100), &grey(byte));
    assert!(flip(105) < VISIBLE && VISIBLE < flip(106), "{} {}", flip(105), flip(106));
}

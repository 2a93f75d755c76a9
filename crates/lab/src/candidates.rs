//! Chooses the settings to measure: each axis separately, the presets, and some combinations.

use std::collections::BTreeMap;
use std::time::Duration;

use super::pairs::Limits;
use super::sweep::Question;
use super::word::Word;
use marraztu_core::accuracy::{
    ACCURACY_PRESETS, AXES, AccuracyPreset, Axis, AxisKind, Choice, Samples, Settings,
};
use marraztu_core::scene::{Scene, View};

/// The thoroughness of a measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thoroughness {
    /// The name on the command line and in reports.
    pub word: &'static str,
    /// The measuring time of each choice.
    pub limits: Limits,
    /// The most combinations that are measured.
    pub combinations: usize,
    /// The time after which no new combination is started.
    pub time: Duration,
    /// Whether presets are measured, and everything is compared with the ideal.
    pub presets: bool,
}

impl Thoroughness {
    /// About 25 seconds for the first scene on two cores.
    pub const QUICK: Self = Self {
        word: "quick",
        limits: Limits { pairs: 12, least: 8, time: Duration::from_millis(300) },
        combinations: 12,
        time: Duration::from_secs(20),
        presets: true,
    };
    /// One axis in a second or two: only its choices.
    pub const AXIS: Self = Self {
        word: "axis",
        limits: Limits { pairs: 16, least: 6, time: Duration::from_millis(250) },
        combinations: 0,
        time: Duration::from_secs(10),
        presets: false,
    };
    /// At most 4 minutes for the first scene on two cores.
    pub const WHOLE: Self = Self {
        word: "whole",
        limits: Limits { pairs: 32, least: 8, time: Duration::from_secs(3) },
        combinations: 48,
        time: Duration::from_secs(200),
        presets: true,
    };

    /// Finds one of them by its name.
    pub fn named(word: &str) -> Option<Self> {
        [Self::QUICK, Self::AXIS, Self::WHOLE].into_iter().find(|one| one.word == word)
    }
}

/// Settings to measure, with their name in the table.
#[derive(Clone, Debug, PartialEq)]
pub struct Candidate {
    /// The reason why they are measured.
    pub group: Group,
    /// The name in the table.
    pub name: String,
    /// The settings that a user chooses.
    pub chosen: Settings,
    /// The settings that are drawn: at rest, a picture may have more samples.
    pub settings: Settings,
}

/// The reason why settings are measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(tag = "group", content = "axis", rename_all = "lowercase")]
pub enum Group {
    /// A preset.
    Preset,
    /// The default with another choice for the axis with this key.
    Axis(#[serde(deserialize_with = "crate::word::read")] Word),
    /// The current settings.
    Current,
    /// Other choices of several axes.
    Combination,
}

/// Settings that are not measured, with the reason.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct LeftOut {
    /// Their description.
    pub what: String,
    /// The reason.
    pub reason: String,
}

/// The settings to measure, and those left out.
#[derive(Clone, Debug, Default)]
pub struct Candidates {
    /// In the order of measurement; the first is the default.
    pub all: Vec<Candidate>,
    /// Choices without an effect in this scene, and combinations beyond the limit.
    pub left_out: Vec<LeftOut>,
}

/// Lists the settings to measure in this scene.
///
/// The first are the pictures of the dial, as the window shows them at rest: they answer the first
/// question of a user. Choices of axes are measured with the samples of a moving picture.
pub fn candidates(scene: &Scene, view: &View, question: &Question) -> Candidates {
    let Question { current, axes, thoroughness, .. } = question;
    let most_combinations = thoroughness.combinations;
    let base = Settings::default().modelled_as(current);
    let mut found = Candidates::default();
    let mut add = |group, name: String, chosen: Settings, settings: Settings| {
        found.all.push(Candidate { group, name, chosen, settings });
    };
    let sampled =
        |label: &str, settings: &Settings| format!("{label}, {}", settings.samples_in_words());
    // The default comes first: all others are measured against it.
    add(Group::Preset, sampled("Default", &base), base, base);
    if thoroughness.presets {
        for preset in AccuracyPreset::dial() {
            let chosen = preset.of(current);
            let settings = question.at_rest(&chosen);
            if settings != base {
                add(Group::Preset, sampled(preset.label, &settings), chosen, settings);
            }
        }
        add(Group::Current, current.in_words(), *current, question.at_rest(current));
    }
    // Axes without an effect in this scene are listed as left out.
    let (sensible, senseless): (Vec<&Axis>, Vec<&Axis>) =
        axes.iter().partition(|axis| (axis.sense)(scene, view).is_ok());
    for axis in &sensible {
        for choice in offered(axis, (scene, view), &base) {
            let settings = choice.of(&base);
            add(Group::Axis(axis.key), choice.label.to_owned(), settings, settings);
        }
    }
    if thoroughness.presets {
        for preset in &ACCURACY_PRESETS[AccuracyPreset::dial().len()..] {
            let settings = preset.of(current);
            add(Group::Preset, sampled(preset.label, &settings), settings, settings);
        }
    }
    let (combinations, count) = combinations(&base, &sensible, (scene, view), most_combinations);
    for settings in combinations {
        add(Group::Combination, settings.in_words(), settings, settings);
    }
    // Report omissions with reasons, since a missing row would look like an error.
    for axis in senseless {
        let reason = (axis.sense)(scene, view).err().unwrap_or_default().to_owned();
        found.left_out.push(LeftOut { what: axis.label.to_owned(), reason });
    }
    for axis in &sensible {
        for choice in axis.choices {
            if let Err(reason) = choice.is_of_its_own(scene, view, &base) {
                let (what, reason) = (axis.in_words(choice), reason.to_owned());
                found.left_out.push(LeftOut { what, reason });
            }
        }
    }
    if sensible.iter().any(|axis| axis.choices.iter().any(|choice| is_ideal(choice, &base))) {
        let what = "256 samples per pixel".to_owned();
        found.left_out.push(LeftOut { what, reason: "the ideal has as many".to_owned() });
    }
    if count > most_combinations {
        found.left_out.push(LeftOut {
            what: format!("{} of {count} combinations", count - most_combinations),
            reason: format!("{most_combinations} are enough for a front"),
        });
    }
    found
}

/// Returns the choices of an axis that have a distinct effect in this scene, given the other
/// settings.
fn offered<'a>(
    axis: &'static Axis,
    (scene, view): (&'a Scene, &'a View),
    settings: &'a Settings,
) -> impl Iterator<Item = &'static Choice> + 'a {
    let is_own = |choice: &&Choice| choice.is_of_its_own(scene, view, settings).is_ok();
    axis.choices.iter().filter(is_own).filter(|choice| !is_ideal(choice, settings))
}

/// A choice that is combined with others, and the index of its axis.
type Pick = (usize, &'static Choice);

/// Returns up to `most` settings that differ from `base` in at least two axes (models excepted),
/// and the number of candidates considered. Settings that differ in two axes come first, then
/// three, and so on.
///
/// With equal numbers of axes, the next setting is the one with the least frequently chosen axes,
/// so even a short list covers all axes.
fn combinations(
    base: &Settings,
    axes: &[&'static Axis],
    seen: (&Scene, &View),
    most: usize,
) -> (Vec<Settings>, usize) {
    let picks: Vec<Pick> = (0..axes.len())
        .flat_map(|i| axes[i].choices.iter().map(move |choice| (i, choice)))
        .filter(|(i, choice)| is_combined(axes[*i], choice, base, seen))
        .collect();
    let of = |combination: &[Pick]| {
        combination.iter().fold(*base, |settings, (_, choice)| choice.of(&settings))
    };
    let mut all: Vec<Vec<Pick>> = picks.iter().map(|pick| vec![*pick]).collect();
    let (mut chosen, mut count, mut spread) = (Vec::new(), 0, Spread::default());
    while chosen.len() < most && !all.is_empty() {
        // Extend each combination by a pick of a later axis, so each set appears once.
        let grown = all.iter().flat_map(|combination| {
            let last = combination.last().map_or(0, |(axis, _)| *axis);
            let later = picks.iter().filter(move |(axis, _)| *axis > last);
            later.map(move |pick| [combination.as_slice(), &[*pick]].concat())
        });
        all = grown.take(MOST).collect();
        let is_new = |combination: &&Vec<Pick>| {
            let settings = of(combination);
            combination.iter().all(|(_, choice)| (choice.among)(&settings).is_ok())
        };
        let mut left: Vec<&Vec<Pick>> = all.iter().filter(is_new).collect();
        count += left.len();
        while chosen.len() < most && !left.is_empty() {
            let next = (0..left.len()).min_by_key(|i| spread.weight(left[*i]));
            let next = left.remove(next.expect("some are left"));
            spread.add(next);
            chosen.push(of(next));
        }
    }
    (chosen, count)
}

/// Returns whether a choice has the samples of the ideal, which is drawn only once.
fn is_ideal(choice: &Choice, base: &Settings) -> bool {
    choice.of(base).samples == Samples::TwoFiftySix
}

/// Returns whether a choice is combined with others. Excluded are choices without an effect,
/// models, historical choices, and the number of samples of the ideal.
fn is_combined(
    axis: &Axis,
    choice: &Choice,
    base: &Settings,
    (scene, view): (&Scene, &View),
) -> bool {
    axis.kind != AxisKind::Model
        && !is_ideal(choice, base)
        && !choice.is(base)
        && !is_historical(axis, choice)
        && (choice.sense)(scene, view).is_ok()
}

/// Returns whether a choice exists only for teaching.
pub(crate) fn is_historical(axis: &Axis, choice: &Choice) -> bool {
    HISTORICAL.contains(&(axis.key, choice.word))
}

/// Choices that exist only for teaching.
const HISTORICAL: [(&str, &str); 5] = [
    ("coverage", "points"),
    ("coverage", "scan-lines"),
    ("interpolation", "affine"),
    ("stretched", "as-it-is"),
    ("rounding", "truncated"),
];

/// The number of times that each axis, set of axes and choice was chosen.
#[derive(Default)]
struct Spread {
    axes: BTreeMap<usize, usize>,
    sets: BTreeMap<Vec<usize>, usize>,
    choices: BTreeMap<(usize, &'static str), usize>,
}

impl Spread {
    /// Returns the number of times that the parts of a combination were chosen: axes, set, choices.
    fn weight(&self, combination: &[Pick]) -> [usize; 3] {
        let axes = combination.iter().filter_map(|(axis, _)| self.axes.get(axis));
        let choices = combination.iter().filter_map(|(i, it)| self.choices.get(&(*i, it.word)));
        let set = self.sets.get(&set(combination)).copied().unwrap_or_default();
        [axes.sum(), set, choices.sum()]
    }

    fn add(&mut self, combination: &[Pick]) {
        *self.sets.entry(set(combination)).or_default() += 1;
        for (axis, choice) in combination {
            *self.axes.entry(*axis).or_default() += 1;
            *self.choices.entry((*axis, choice.word)).or_default() += 1;
        }
    }
}

/// Returns the axes of a combination.
fn set(combination: &[Pick]) -> Vec<usize> {
    combination.iter().map(|(axis, _)| *axis).collect()
}

/// The most combinations that are considered: many axes have more.
const MOST: usize = 4096;

/// Returns all axes.
pub fn all_axes() -> Vec<&'static Axis> {
    AXES.iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns up to `most` combinations in the first scene.
    fn combined(most: usize) -> Vec<Settings> {
        let (scene, view) = marraztu_io::default_scene();
        let thoroughness = Thoroughness { combinations: most, ..Thoroughness::QUICK };
        let question = Question::new(Settings::default(), all_axes(), thoroughness);
        let found = candidates(&scene, &view, &question);
        let all = found.all.into_iter().filter(|it| it.group == Group::Combination);
        all.map(|it| it.settings).collect()
    }

    /// Returns the choices that differ from the default, by axis.
    fn words(settings: &Settings) -> Vec<(&'static str, &'static str)> {
        let words = AXES.iter().map(|axis| (axis, axis.chosen(settings).word));
        let own = words.filter(|(axis, word)| *word != axis.default_choice().word);
        own.map(|(axis, word)| (axis.key, word)).collect()
    }

    #[test]
    fn few_combinations_are_spread_over_all_axes_and_none_is_history() {
        let all = combined(Thoroughness::QUICK.combinations);
        assert_eq!(all.len(), Thoroughness::QUICK.combinations);
        let words: Vec<_> = all.iter().map(words).collect();
        // Axes with non-historical choices and an effect in the first scene, except models.
        let of_axes = |key: &str| words.iter().flatten().filter(|(axis, _)| *axis == key).count();
        for key in [
            "shading",
            "arithmetic",
            "vertices",
            "subpixels",
            "coverage",
            "depth",
            "samples",
            "rounding",
        ] {
            assert!((1..=4).contains(&of_axes(key)), "{key} in {words:?}");
        }
        for key in ["interpolation", "stretched", "filter", "specular"] {
            assert_eq!(of_axes(key), 0, "{key} in {words:?}");
        }
        for settings in combined(400) {
            assert!(words_are_of_today(&settings), "{}", settings.in_words());
        }
    }

    fn words_are_of_today(settings: &Settings) -> bool {
        words(settings).iter().all(|word| !HISTORICAL.contains(word))
    }

    #[test]
    fn the_pictures_of_the_dial_are_measured_first_and_say_their_samples() {
        let (scene, view) = marraztu_io::default_scene();
        let current = Settings::default();
        let question = Question::new(current, all_axes(), Thoroughness::QUICK);
        let found = candidates(&scene, &view, &question);
        let (default, others) = found.all.split_first().unwrap();
        assert_eq!((default.name.as_str(), default.settings), ("Default, 1 sample", current));
        let dial = crate::dial::of_dial(&current, Some(Settings::REFINED));
        let names =
            ["Draft, 1/4 sample", "Default, 16 samples", "Exact, 16 samples", "Ideal, 256 samples"];
        for (((preset, settings), name), it) in dial.zip(names).zip(others) {
            assert_eq!((it.name.as_str(), it.settings), (name, settings));
            assert_eq!((it.group, it.chosen), (Group::Preset, preset.of(&current)));
        }
    }

    #[test]
    fn ways_of_history_are_choices_of_the_table() {
        for (key, word) in HISTORICAL {
            assert!(Axis::named(key).and_then(|axis| axis.choice(word)).is_some(), "{key} {word}");
        }
    }

    #[test]
    fn no_combination_is_listed_twice_or_differs_in_one_axis_alone() {
        let all = combined(200);
        assert_eq!(all.len(), 200);
        for (i, settings) in all.iter().enumerate() {
            assert!(words(settings).len() >= 2, "{}", settings.in_words());
            assert!(!all[..i].contains(settings), "{}", settings.in_words());
            let one = settings.samples == Samples::One;
            assert!(!one || settings.light != marraztu_core::accuracy::LightAt::Sample);
        }
    }
}

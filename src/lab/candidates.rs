//! Which settings are measured: each axis by itself, the presets, and a fair number of combinations.

use std::time::Duration;

use super::pairs::Limits;
use crate::scene::{ACCURACY_PRESETS, AXES, Axis, AxisKind, Choice, Scene, Settings, View};

/// How much is measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thoroughness {
    /// Its word.
    pub word: &'static str,
    /// How long each choice is measured.
    pub limits: Limits,
    /// How many combinations are measured at most.
    pub combinations: usize,
    /// No further combination is begun after so long.
    pub time: Duration,
}

impl Thoroughness {
    /// Some 20 seconds for the first scene on two cores.
    pub const QUICK: Self = Self {
        word: "quick",
        limits: Limits { pairs: 11, least: 7, time: Duration::from_millis(400) },
        combinations: 12,
        time: Duration::from_secs(13),
    };
    /// At most 4 minutes for the first scene on two cores.
    pub const WHOLE: Self = Self {
        word: "whole",
        limits: Limits { pairs: 31, least: 7, time: Duration::from_secs(3) },
        combinations: 48,
        time: Duration::from_secs(200),
    };
}

/// Settings that are measured, and what they are called in a table.
#[derive(Clone, Debug, PartialEq)]
pub struct Candidate {
    /// Why they are measured.
    pub group: Group,
    /// What they are called there.
    pub name: String,
    /// The settings.
    pub settings: Settings,
}

/// Why settings are measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(tag = "group", content = "axis", rename_all = "lowercase")]
pub enum Group {
    /// They are a preset.
    Preset,
    /// They are the default but for one axis, which has this key.
    Axis(&'static str),
    /// They are what the picture is drawn with now.
    Current,
    /// They differ from the default in several axes.
    Combination,
}

/// Something that is not measured, and why.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct LeftOut {
    /// What.
    pub what: String,
    /// Why.
    pub reason: String,
}

/// What is to be measured, and what is not.
#[derive(Clone, Debug, Default)]
pub struct Candidates {
    /// In the order in which they are measured; the first is the default.
    pub all: Vec<Candidate>,
    /// What makes no sense in this scene, and what there are too many of.
    pub left_out: Vec<LeftOut>,
}

/// Which settings are measured of these axes, in this scene.
#[must_use]
pub fn candidates(
    scene: &Scene,
    view: &View,
    current: &Settings,
    axes: &[&'static Axis],
    most_combinations: usize,
) -> Candidates {
    let base = Settings::default().modelled_as(current);
    let mut found = Candidates::default();
    let mut add = |group, name: String, settings| {
        found.all.push(Candidate { group, name, settings });
    };
    for preset in ACCURACY_PRESETS.iter().filter(|preset| preset.of(current) == base) {
        add(Group::Preset, preset.label.to_owned(), base);
    }
    let (sensible, senseless): (Vec<&Axis>, Vec<&Axis>) =
        axes.iter().partition(|axis| (axis.sense)(scene, view).is_ok());
    for axis in &sensible {
        for choice in offered(axis, scene, view) {
            add(Group::Axis(axis.key), choice.label.to_owned(), choice.of(&base));
        }
    }
    for preset in ACCURACY_PRESETS.iter().filter(|preset| preset.of(current) != base) {
        add(Group::Preset, preset.label.to_owned(), preset.of(current));
    }
    add(Group::Current, current.in_words(), *current);
    let combinations = combinations(&base, &sensible, scene, view);
    let count = combinations.len();
    for settings in combinations.into_iter().take(most_combinations) {
        add(Group::Combination, settings.in_words(), settings);
    }
    for axis in senseless {
        let reason = (axis.sense)(scene, view).err().unwrap_or_default().to_owned();
        found.left_out.push(LeftOut { what: axis.name.to_owned(), reason });
    }
    for axis in &sensible {
        for choice in axis.choices {
            if let Err(reason) = (choice.sense)(scene, view) {
                let (what, reason) = (format!("{} {}", axis.key, choice.word), reason.to_owned());
                found.left_out.push(LeftOut { what, reason });
            }
        }
    }
    if count > most_combinations {
        found.left_out.push(LeftOut {
            what: format!("{} of {count} combinations", count - most_combinations),
            reason: format!("{most_combinations} are enough for a front"),
        });
    }
    found
}

/// The choices of an axis that are something of their own in a scene.
fn offered(axis: &Axis, scene: &Scene, view: &View) -> impl Iterator<Item = &'static Choice> {
    axis.choices.iter().filter(|choice| (choice.sense)(scene, view).is_ok())
}

/// Settings that differ from `base` in two or more scored axes: first all that differ in two, then in
/// three, and so on.
fn combinations(
    base: &Settings,
    axes: &[&'static Axis],
    scene: &Scene,
    view: &View,
) -> Vec<Settings> {
    let scored = axes.iter().filter(|axis| axis.kind == AxisKind::Scored);
    let mut all: Vec<(usize, Settings)> = vec![(0, *base)];
    for axis in scored {
        let others = |settings: &Settings| -> Vec<&'static Choice> {
            offered(axis, scene, view).filter(|choice| !choice.is(settings)).collect()
        };
        let grown: Vec<(usize, Settings)> = all
            .iter()
            .flat_map(|(count, settings)| {
                let grown = others(settings).into_iter();
                grown.map(|choice| (count + 1, choice.of(settings))).collect::<Vec<_>>()
            })
            .take(MOST)
            .collect();
        all.extend(grown);
    }
    all.retain(|(count, _)| *count >= 2);
    all.sort_by_key(|(count, _)| *count);
    all.into_iter().map(|(_, settings)| settings).collect()
}

/// With many axes there are more combinations than can be listed.
const MOST: usize = 4096;

/// The axes of these keys, or all.
///
/// # Errors
/// The first word that is the key of no axis.
pub fn axes_named<'a>(
    keys: impl IntoIterator<Item = &'a str>,
) -> Result<Vec<&'static Axis>, &'a str> {
    keys.into_iter().map(|key| Axis::named(key).ok_or(key)).collect()
}

/// Every axis of the table.
#[must_use]
pub fn all_axes() -> Vec<&'static Axis> {
    AXES.iter().collect()
}

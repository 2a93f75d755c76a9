//! The lessons: one for each axis of accuracy, in a scene that makes its errors as visible as
//! possible.
//!
//! Their texts are data in `assets/lessons/*.ron`, and their scenes are ordinary scene files. Both
//! are built into the program.

use std::path::PathBuf;
use std::sync::OnceLock;

use marraztu_core::accuracy::{AXES, Axis, Choice, Settings};
use marraztu_core::base::once::get_or_compute;
use serde::Deserialize;

use super::progress::Progress;
use super::scene_file::{Opened, SceneFileError, open_text};

/// A lesson about an axis: a title and two sentences.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Lesson {
    /// The key of the axis.
    pub axis: String,
    /// The question that it answers: "Why Gouraud misses a highlight".
    pub title: String,
    /// Other words that people search for.
    pub words: String,
    /// The reason, in a sentence.
    pub why: String,
    /// The place to look at, in a sentence.
    pub look: String,
    /// The name of its scene: see [`lesson_scene`].
    pub scene: String,
    /// The word of the choice that it opens with: the one with the most visible faults.
    pub choice: String,
}

impl Lesson {
    /// The axis.
    ///
    /// # Panics
    /// Never: a test compares every lesson with the table of axes.
    pub fn axis(&self) -> &'static Axis {
        Axis::named(&self.axis).expect("a lesson is about an axis")
    }

    /// The choice that it opens with.
    ///
    /// # Panics
    /// Never, like [`Self::axis`].
    pub fn opens_with(&self) -> &'static Choice {
        self.axis().choice(&self.choice).expect("a lesson opens with a choice of its axis")
    }

    /// The settings that it opens with.
    pub fn settings(&self) -> Settings {
        self.opens_with().of(&Settings::default())
    }
}

/// The texts, in the order of [`AXES`].
const TEXTS: &[&str] = &[
    include_str!("../../../assets/lessons/shading.ron"),
    include_str!("../../../assets/lessons/arithmetic.ron"),
    include_str!("../../../assets/lessons/vertices.ron"),
    include_str!("../../../assets/lessons/subpixels.ron"),
    include_str!("../../../assets/lessons/coverage.ron"),
    include_str!("../../../assets/lessons/depth.ron"),
    include_str!("../../../assets/lessons/transparency.ron"),
    include_str!("../../../assets/lessons/shadow-method.ron"),
    include_str!("../../../assets/lessons/light-samples.ron"),
    include_str!("../../../assets/lessons/bounces.ron"),
    include_str!("../../../assets/lessons/samples.ron"),
    include_str!("../../../assets/lessons/resolution.ron"),
    include_str!("../../../assets/lessons/interpolation.ron"),
    include_str!("../../../assets/lessons/stretched.ron"),
    include_str!("../../../assets/lessons/filter.ron"),
    include_str!("../../../assets/lessons/bumps.ron"),
    include_str!("../../../assets/lessons/rounding.ron"),
    include_str!("../../../assets/lessons/specular.ron"),
    include_str!("../../../assets/lessons/tangents.ron"),
    include_str!("../../../assets/lessons/terminator.ron"),
    include_str!("../../../assets/lessons/values.ron"),
];

/// Returns the lessons, in the order of [`AXES`].
///
/// # Panics
/// Never: a test reads every text.
pub fn lessons() -> &'static [Lesson] {
    static LESSONS: OnceLock<Vec<Lesson>> = OnceLock::new();
    let read = |text: &&str| ron::from_str(text).expect("a lesson of the program");
    let all: &Vec<Lesson> = get_or_compute(&LESSONS, || TEXTS.iter().map(read).collect());
    all
}

/// Returns the lesson about an axis.
///
/// # Panics
/// Never: every axis has a lesson.
pub fn lesson_on(axis: &Axis) -> &'static Lesson {
    let place = AXES.iter().position(|other| other.key == axis.key);
    &lessons()[place.expect("an axis of the table")]
}

/// The scenes, by the names in [`Lesson::scene`].
const LESSONS: &[(&str, &str)] = &[
    ("ball", include_str!("../../../assets/lessons/ball.marraztu")),
    ("dimples", include_str!("../../../assets/lessons/dimples.marraztu")),
    ("dusk", include_str!("../../../assets/lessons/dusk.marraztu")),
    ("far", include_str!("../../../assets/lessons/far.marraztu")),
    ("fence", include_str!("../../../assets/lessons/fence.marraztu")),
    ("floor", include_str!("../../../assets/lessons/floor.marraztu")),
    ("highlight", include_str!("../../../assets/lessons/highlight.marraztu")),
    ("mirrors", include_str!("../../../assets/lessons/mirrors.marraztu")),
    ("near", include_str!("../../../assets/lessons/near.marraztu")),
    ("night", include_str!("../../../assets/lessons/night.marraztu")),
    ("panes", include_str!("../../../assets/lessons/panes.marraztu")),
    ("plate", include_str!("../../../assets/lessons/plate.marraztu")),
    ("pressed", include_str!("../../../assets/lessons/pressed.marraztu")),
    ("shadow", include_str!("../../../assets/lessons/shadow.marraztu")),
    ("soft", include_str!("../../../assets/lessons/soft.marraztu")),
    ("telescope", include_str!("../../../assets/lessons/telescope.marraztu")),
    ("wheel", include_str!("../../../assets/lessons/wheel.marraztu")),
];

/// Opens the scene of a lesson.
///
/// # Errors
/// If no lesson has this name.
pub fn lesson_scene(name: &str) -> Result<Opened, SceneFileError> {
    let found = LESSONS.iter().find(|(other, _)| *other == name);
    let Some((_, text)) = found else {
        let reason = "the program has no lesson of this name".to_owned();
        return Err(SceneFileError::File { file: name.to_owned(), reason });
    };
    open_text(text, name, PathBuf::new(), &Progress::new())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_axis_has_a_lesson_in_a_scene_in_which_it_matters() {
        for (axis, lesson) in AXES.iter().zip(lessons()) {
            assert_eq!(lesson.axis, axis.key);
            let Opened { scene, view, .. } = lesson_scene(&lesson.scene).unwrap();
            assert_eq!((axis.sense)(&scene, &view), Ok(()), "{}", axis.key);
            assert!(axis.choice(&lesson.choice).is_some(), "{}", axis.key);
            // Two sentences, short enough for all of them to be read in five minutes.
            for sentence in [&lesson.why, &lesson.look] {
                assert!(sentence.ends_with('.') && !sentence.contains(". "), "{sentence}");
            }
            assert!(lesson.why.len() + lesson.look.len() < 320, "{}", axis.key);
        }
        assert_eq!(lessons().len(), AXES.len());
        assert!(lesson_scene("nothing").is_err());
    }
}

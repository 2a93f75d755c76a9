//! The axes of accuracy: every choice that trades exactness for time, in one table.
//!
//! Menus, the command line and the laboratory read this table, and tests compare a scene file's
//! words with it, so a row is all that a new axis needs. A row defines the purpose of the axis, how
//! its choices are set in [`Settings`] and read back, the most exact choice, and the scenes in
//! which the axis matters. The default is [`Settings::default`].

/// A choice that sets one field of the settings to one value.
macro_rules! choice {
    ($word:literal $label:literal $field:ident = $value:expr, $what:literal, $error:literal) => {
        choice!($word $label $field = $value, $what, $error, |_, _| Ok(()))
    };
    (
        $word:literal $label:literal $field:ident = $value:expr, $what:literal, $error:literal,
        $sense:expr
    ) => {
        choice!($word $label $field = $value, $what, $error, $sense, |_| Ok(()))
    };
    (
        $word:literal $label:literal $field:ident = $value:expr, $what:literal, $error:literal,
        $sense:expr, $among:expr
    ) => {
        Choice {
            word: $word,
            label: $label,
            what: $what,
            error: $error,
            slower_because: None,
            set: |settings| settings.$field = $value,
            is: |settings| settings.$field == $value,
            sense: $sense,
            among: $among,
        }
    };
}

mod geometry;
mod light;
mod picture;
mod rays;
mod sampling;
mod sense;
mod shadows;
mod texture;
mod transparency;

use crate::accuracy::Settings;
use crate::scene::{Scene, View};

/// A decision between exact and fast, or between two models.
#[derive(Debug)]
pub struct Axis {
    /// Its option on the command line, and its field in a scene file.
    pub key: &'static str,
    /// Its name: "Texture filter".
    pub label: &'static str,
    /// A choice of it in a sentence, with {} for the choice: "{} texture filter".
    pub phrase: &'static str,
    /// Its purpose, as a phrase: "Where light is evaluated".
    pub what: &'static str,
    /// Whether some choices are more exact than others.
    pub kind: AxisKind,
    /// The choices, from the coarse to the exact if they are scored.
    pub choices: &'static [Choice],
    /// Returns whether it can change the picture of a scene in a view, or else the reason.
    pub sense: fn(&Scene, &View) -> Result<(), &'static str>,
}

/// Whether the choices of an axis can be ranked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AxisKind {
    /// The last choice is the most exact one; the errors of the others are measured against it.
    Scored,
    /// The choices are different models: none is an error of another.
    Model,
}

/// A value of an axis.
#[derive(Debug)]
pub struct Choice {
    /// Its word on the command line.
    pub word: &'static str,
    /// Its label on a button.
    pub label: &'static str,
    /// Its effect, in a sentence.
    pub what: &'static str,
    /// The expected error, in words.
    pub error: &'static str,
    /// Why it takes longer than a more exact choice, if it does, as a clause.
    pub slower_because: Option<&'static str>,
    /// Returns whether it differs from the other choices for a scene in a view, or else the reason.
    pub sense: fn(&Scene, &View) -> Result<(), &'static str>,
    /// Returns whether it differs from the other choices with these settings of the other axes, or
    /// else the reason.
    pub among: fn(&Settings) -> Result<(), &'static str>,
    set: fn(&mut Settings),
    is: fn(&Settings) -> bool,
}

/// Every axis, in the order of the interface.
pub const AXES: &[Axis] = &[
    light::SHADING,
    light::ARITHMETIC,
    geometry::VERTICES,
    geometry::SUBPIXELS,
    geometry::COVERAGE,
    picture::DEPTH,
    transparency::TRANSPARENCY,
    shadows::SHADOW_METHOD,
    shadows::LIGHT_SAMPLES,
    rays::BOUNCES,
    sampling::SAMPLES,
    sampling::RESOLUTION,
    geometry::INTERPOLATION,
    geometry::STRETCHED,
    texture::FILTER,
    texture::BUMPS,
    picture::ROUNDING,
    light::SPECULAR,
    texture::TANGENTS,
    shadows::TERMINATOR,
    light::VALUES,
];

impl Axis {
    /// The axis with this key.
    pub fn named(key: &str) -> Option<&'static Self> {
        AXES.iter().find(|axis| axis.key == key)
    }

    /// The choice with this word.
    pub fn choice(&self, word: &str) -> Option<&'static Choice> {
        self.choices.iter().find(|choice| choice.word == word)
    }

    /// The choice of these settings.
    pub fn chosen(&self, settings: &Settings) -> &'static Choice {
        let chosen = self.choices.iter().find(|choice| choice.is(settings));
        chosen.expect("every value of a setting is a choice of its axis")
    }

    /// One of its choices in a sentence: "nearest texture filter", "depth in 16 bits".
    pub fn in_words(&self, choice: &Choice) -> String {
        let phrase = self.phrase.replace("{}", &uncapitalized(choice.label));
        // The only phrases that count.
        match choice.label {
            "1" => phrase.replace("samples", "sample").replace("bounces", "bounce"),
            _ => phrase,
        }
    }

    /// The choice of the default settings.
    pub fn default_choice(&self) -> &'static Choice {
        self.chosen(&Settings::default())
    }

    /// The most exact choice that differs from the others with these settings; for a model, the
    /// choice of these settings.
    pub fn most_exact(&self, settings: &Settings) -> &'static Choice {
        let own = |choice: &&Choice| (choice.among)(settings).is_ok();
        match (self.kind, self.choices.iter().rfind(own)) {
            (AxisKind::Scored, Some(last)) => last,
            _ => self.chosen(settings),
        }
    }
}

impl Choice {
    /// States why it takes longer than a more exact choice: "edges are kept in 64 bits".
    const fn slower_because(self, reason: &'static str) -> Self {
        Self { slower_because: Some(reason), ..self }
    }

    /// Whether it differs from the other choices for a scene in a view with these settings.
    ///
    /// # Errors
    /// The reason why it does not.
    pub fn is_of_its_own(
        &self,
        scene: &Scene,
        view: &View,
        settings: &Settings,
    ) -> Result<(), &'static str> {
        (self.sense)(scene, view).and_then(|()| (self.among)(settings))
    }

    /// The settings with this choice made.
    pub fn of(&self, settings: &Settings) -> Settings {
        let mut settings = *settings;
        (self.set)(&mut settings);
        settings
    }

    /// Whether it is the choice of these settings.
    pub fn is(&self, settings: &Settings) -> bool {
        (self.is)(settings)
    }
}

/// A label inside a sentence: only names keep their capitals.
pub fn uncapitalized(label: &str) -> String {
    const NAMES: [&str; 2] = ["Gouraud", "Phong"];
    let mut letters = label.chars();
    let (first, second) = (letters.next(), letters.next());
    let is_word = first.zip(second).is_some_and(|(a, b)| a.is_uppercase() && !b.is_uppercase());
    match first.filter(|_| is_word && !NAMES.contains(&label) && second != Some('.')) {
        Some(first) => first.to_lowercase().chain(label.chars().skip(1)).collect(),
        None => label.to_owned(),
    }
}

#[cfg(test)]
mod tests;

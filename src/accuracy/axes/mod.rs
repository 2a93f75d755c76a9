//! The axes of accuracy: every choice that trades exactness for time, in one table.
//!
//! Menus, the command line and the laboratory read this table, and a scene file's words are held to
//! it by test: an axis is known everywhere by standing here. A row says what the axis is, how its
//! choices are set in [`Settings`] and read back, which of them is the most exact, where the axis
//! means something, and what there is to learn from it. The default of an axis is what
//! [`Settings::default`] has.

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
mod sampling;
mod sense;
mod texture;

use crate::accuracy::Settings;
use crate::scene::{Scene, View};

/// One way in which a picture can be more or less exact, or otherwise modelled.
#[derive(Debug)]
pub struct Axis {
    /// What it is called in text: "shading".
    pub name: &'static str,
    /// Its option on the command line, and its field in a scene file.
    pub key: &'static str,
    /// Its name on a narrow row: "Shading".
    pub label: &'static str,
    /// What it says, as a phrase: "Where light is evaluated".
    pub what: &'static str,
    /// Whether one choice is nearer to the truth than another.
    pub kind: AxisKind,
    /// The choices, from the coarse to the exact where they are scored.
    pub choices: &'static [Choice],
    /// Whether it changes anything in a scene that is seen so, and why not.
    pub sense: fn(&Scene, &View) -> Result<(), &'static str>,
    /// What it teaches.
    pub lesson: Lesson,
}

/// Whether the choices of an axis can be ranked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AxisKind {
    /// The last choice is the most exact, and the others have an error against it.
    Scored,
    /// The same, but the exact choice shows so much else that the references of all other axes leave
    /// this one as it is.
    ScoredApart,
    /// The choices are different models of the world: none is an error of another.
    Model,
}

/// A place on an axis.
#[derive(Debug)]
pub struct Choice {
    /// Its word on the command line.
    pub word: &'static str,
    /// Its name on a button.
    pub label: &'static str,
    /// What it does, in a sentence.
    pub what: &'static str,
    /// The error to expect of it, in words.
    pub error: &'static str,
    /// Whether it is anything of its own in a scene that is seen so, and why not.
    pub sense: fn(&Scene, &View) -> Result<(), &'static str>,
    /// Whether it is anything of its own beside what such settings choose on other axes, and why not.
    pub among: fn(&Settings) -> Result<(), &'static str>,
    set: fn(&mut Settings),
    is: fn(&Settings) -> bool,
}

/// What an axis teaches, in three sentences.
#[derive(Debug)]
pub struct Lesson {
    /// What a student would ask: "Why Gouraud misses a highlight".
    pub title: &'static str,
    /// What it is.
    pub what: &'static str,
    /// What goes wrong when it is coarse.
    pub coarse: &'static str,
    /// Where that shows.
    pub shows: &'static str,
    /// The small scene, carried by the program, in which the difference is plain to see.
    pub scene: &'static str,
    /// The word of the choice that is drawn with there, where it is not the coarsest.
    pub choice: Option<&'static str>,
}

/// Every axis, in the order in which they are shown.
pub const AXES: &[Axis] = &[
    light::SHADING,
    light::ARITHMETIC,
    light::POWER,
    light::NORMALISING,
    light::FAINT,
    geometry::VERTICES,
    geometry::SUBPIXELS,
    geometry::COVERAGE,
    picture::DEPTH,
    sampling::SAMPLES,
    geometry::INTERPOLATION,
    geometry::STRETCHED,
    texture::FILTER,
    picture::ROUNDING,
    light::SPECULAR,
];

impl Axis {
    /// The axis of this key.
    #[must_use]
    pub fn named(key: &str) -> Option<&'static Self> {
        AXES.iter().find(|axis| axis.key == key)
    }

    /// The choice of this word.
    #[must_use]
    pub fn choice(&self, word: &str) -> Option<&'static Choice> {
        self.choices.iter().find(|choice| choice.word == word)
    }

    /// What its lesson begins with: the choice that goes most plainly wrong there.
    #[must_use]
    pub fn lesson_choice(&self) -> &'static Choice {
        let named = self.lesson.choice.and_then(|word| self.choice(word));
        named.unwrap_or(&self.choices[0])
    }

    /// What these settings have chosen.
    #[must_use]
    pub fn chosen(&self, settings: &Settings) -> &'static Choice {
        let chosen = self.choices.iter().find(|choice| choice.is(settings));
        chosen.expect("every value of a setting is a choice of its axis")
    }

    /// What settings have that nobody has touched.
    #[must_use]
    pub fn default_choice(&self) -> &'static Choice {
        self.chosen(&Settings::default())
    }

    /// The most exact choice that is anything of its own beside the others of these settings; of a model,
    /// the one that they have.
    #[must_use]
    pub fn most_exact(&self, settings: &Settings) -> &'static Choice {
        let own = |choice: &&Choice| (choice.among)(settings).is_ok();
        match (self.kind, self.choices.iter().rfind(own)) {
            (AxisKind::Scored | AxisKind::ScoredApart, Some(last)) => last,
            _ => self.chosen(settings),
        }
    }
}

impl Choice {
    /// Whether it is anything of its own in a scene that is seen so, drawn with such settings otherwise,
    /// and why not.
    ///
    /// # Errors
    /// The reason.
    pub fn is_of_its_own(
        &self,
        scene: &Scene,
        view: &View,
        settings: &Settings,
    ) -> Result<(), &'static str> {
        (self.sense)(scene, view).and_then(|()| (self.among)(settings))
    }

    /// The settings with this choice made.
    #[must_use]
    pub fn of(&self, settings: &Settings) -> Settings {
        let mut settings = *settings;
        (self.set)(&mut settings);
        settings
    }

    /// Whether it is the choice of these settings.
    #[must_use]
    pub fn is(&self, settings: &Settings) -> bool {
        (self.is)(settings)
    }
}

#[cfg(test)]
mod tests;

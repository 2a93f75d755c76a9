//! The options for accuracy, one per axis, generated from the table of axes.

use clap::builder::PossibleValuesParser;
use clap::{Arg, ArgGroup, ArgMatches, Args, Command, FromArgMatches, Id};
use marraztu_core::accuracy::{ACCURACY_PRESETS, AXES, AccuracyPreset, Axis, Choice, Settings};

/// The chosen options; other axes keep their settings.
#[derive(Debug, Default)]
pub(crate) struct Accuracy {
    preset: Option<&'static AccuracyPreset>,
    choices: Vec<&'static Choice>,
    /// The axes of these choices.
    axes: Vec<&'static Axis>,
    /// Whether the samples per pixel are among the choices.
    names_samples: bool,
}

const PRESET: &str = "preset";
const SAMPLES: &str = "samples";

/// The group of all options, named like the groups that clap derives.
const GROUP: &str = "Accuracy";

impl Accuracy {
    /// Applies the preset to settings, then the single axes.
    pub(crate) fn of(&self, settings: &Settings) -> Settings {
        let settings = self.preset.map_or(*settings, |preset| preset.of(settings));
        self.choices.iter().fold(settings, |settings, choice| choice.of(&settings))
    }

    /// Returns the settings for a picture file: refined as in an idle window, unless the samples
    /// per pixel are chosen.
    pub(crate) fn of_file(&self, settings: &Settings) -> Settings {
        let settings = self.of(settings);
        if self.names_samples { settings } else { settings.refined() }
    }

    /// Returns the axes that were given as options.
    pub(crate) fn fixed(&self) -> Vec<&'static Axis> {
        self.axes.clone()
    }
}

impl Args for Accuracy {
    fn group_id() -> Option<Id> {
        Some(GROUP.into())
    }

    fn augment_args(command: Command) -> Command {
        let presets: Vec<&str> = ACCURACY_PRESETS.iter().map(|preset| preset.word).collect();
        let help =
            format!("An accuracy preset, applied before single axes: {}", presets.join(", "));
        let group = ArgGroup::new(GROUP).multiple(true).arg(PRESET);
        let group = AXES.iter().fold(group, |group, axis| group.arg(axis.key));
        let command = command.next_help_heading("Accuracy").arg(option(PRESET, presets, help));
        AXES.iter()
            .fold(command, |command, axis| {
                let words = axis.choices.iter().map(|choice| choice.word).collect();
                command.arg(option(axis.key, words, help_of(axis)))
            })
            .group(group)
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

fn option(name: &'static str, words: Vec<&'static str>, help: String) -> Arg {
    Arg::new(name)
        .long(name)
        .value_name("CHOICE")
        .hide_possible_values(true)
        .value_parser(PossibleValuesParser::new(words))
        .help(help)
}

/// Formats the help of an axis: "Where light is evaluated: face, vertex, pixel*".
fn help_of(axis: &Axis) -> String {
    let star = |choice: &Choice| {
        let star = if choice.word == axis.default_choice().word { "*" } else { "" };
        format!("{}{star}", choice.word)
    };
    let words: Vec<String> = axis.choices.iter().map(star).collect();
    let of_files = if axis.key == SAMPLES { "; 16 in files" } else { "" };
    format!("{}: {}{of_files}", axis.what, words.join(", "))
}

impl FromArgMatches for Accuracy {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let mut accuracy = Self::default();
        accuracy.update_from_arg_matches(matches)?;
        Ok(accuracy)
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        let word = |name: &str| matches.get_one::<String>(name).map(String::as_str);
        self.preset = word(PRESET).and_then(AccuracyPreset::named);
        let chosen = |axis: &Axis| word(axis.key).and_then(|word| axis.choice(word));
        self.choices = AXES.iter().filter_map(chosen).collect();
        self.axes = AXES.iter().filter(|axis| chosen(axis).is_some()).collect();
        self.names_samples = word(SAMPLES).is_some();
        Ok(())
    }
}

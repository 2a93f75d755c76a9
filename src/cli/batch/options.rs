//! The options of the pictures: those of the command line, overridden by each row of a list.
//!
//! A row is parsed by clap, with the argument definitions of the command line, so a value means the
//! same in both. Options are therefore kept as text until each row is known.

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::fmt::Write as _;
use std::sync::Arc;

use clap::error::{ContextKind, ContextValue};
use clap::parser::ValueSource;
use clap::{ArgAction, ArgMatches, Args, Command, FromArgMatches};
use marraztu_core::base::image::Size;

use crate::cli::accuracy::Accuracy;
use crate::cli::arguments::{Reading, SceneArguments, Surfaces};
use crate::cli::layers::LayerOptions;
use crate::cli::values::size;

/// The options of one picture.
#[derive(Debug, Args)]
#[command(next_help_heading = "Pictures")]
pub(super) struct PictureOptions {
    /// Width and height in pixels; one number for a square [default: 800x800]
    #[arg(long, value_name = "WxH", allow_negative_numbers = true, value_parser = size)]
    pub(super) size: Option<Size>,
    /// Omit the background: the pictures get an alpha channel
    #[arg(long)]
    pub(super) transparent: bool,
    #[command(flatten)]
    pub(super) scene: SceneArguments,
    #[command(flatten)]
    pub(super) accuracy: Accuracy,
    #[command(flatten)]
    pub(super) layers: LayerOptions,
}

/// Options as text: values by name, and `None` for switches.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct OptionTexts(BTreeMap<String, Option<OsString>>);

/// Parsed options.
#[derive(Debug)]
pub(super) struct Parsed {
    pub(super) options: PictureOptions,
    /// All options in a fixed order, for stamps.
    pub(super) text: String,
    /// The options that the loaded model depends on.
    pub(super) model_text: String,
}

/// A value in a list.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Value {
    /// A text or a number.
    Text(String),
    /// A switch.
    Switch(bool),
}

/// An option that is wrong, and the reason.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct WrongOption {
    /// The name of the option, if one option alone is wrong.
    pub(super) option: Option<String>,
    /// The reason.
    pub(super) reason: String,
}

/// The command that parses the options of a row.
fn command() -> Command {
    let command = Command::new("row").no_binary_name(true).disable_help_flag(true);
    PictureOptions::augment_args(command)
}

/// Parses options, and remembers the result of equal ones: most rows of a list are equal.
#[derive(Debug)]
pub(super) struct OptionParser {
    command: Command,
    /// Whether an option is a switch, by its name.
    names: BTreeMap<String, bool>,
    /// The options that a loaded model depends on.
    of_models: Vec<String>,
    parsed: BTreeMap<OptionTexts, Arc<Parsed>>,
}

impl OptionTexts {
    /// Returns the options with another one, which has a value.
    pub(super) fn and(mut self, name: &str, value: &str) -> Self {
        self.0.insert(name.to_owned(), Some(value.into()));
        self
    }
}

impl OptionParser {
    pub(super) fn new() -> Self {
        let command = command();
        let is_switch = |action: &ArgAction| !action.takes_values();
        let named = |argument: &clap::Arg| {
            let name = argument.get_long()?.to_owned();
            Some((name, is_switch(argument.get_action())))
        };
        let names = command.get_arguments().filter_map(named).collect();
        let of_models = Surfaces::augment_args(Reading::augment_args(Command::new("model")));
        let of_models = of_models.get_arguments().filter_map(|argument| argument.get_long());
        let of_models = of_models.map(str::to_owned).collect();
        Self { command, names, of_models, parsed: BTreeMap::new() }
    }

    /// Returns whether there is an option of this name.
    pub(super) fn has(&self, name: &str) -> bool {
        self.names.contains_key(name)
    }

    /// Returns options with one of them replaced. Fails if a switch has a value that is neither
    /// true nor false.
    pub(super) fn with(
        &self,
        texts: &OptionTexts,
        name: &str,
        value: Value,
    ) -> Result<OptionTexts, WrongOption> {
        let mut texts = texts.clone();
        let is_switch = self.names.get(name).copied().unwrap_or_default();
        let text = match value {
            Value::Text(text) => text,
            Value::Switch(on) => on.to_string(),
        };
        if !is_switch {
            texts.0.insert(name.to_owned(), Some(text.into()));
            return Ok(texts);
        }
        match text.to_ascii_lowercase().as_str() {
            "true" | "yes" | "1" => _ = texts.0.insert(name.to_owned(), None),
            "false" | "no" | "0" => _ = texts.0.remove(name),
            _ => {
                let reason = format!("{text:?} is not a switch: write true or false");
                return Err(WrongOption { option: Some(name.to_owned()), reason });
            }
        }
        Ok(texts)
    }

    /// Parses options. Fails if a value is invalid, or options conflict.
    pub(super) fn parse(&mut self, texts: &OptionTexts) -> Result<Arc<Parsed>, WrongOption> {
        if let Some(parsed) = self.parsed.get(texts) {
            return Ok(Arc::clone(parsed));
        }
        let options = self.options(texts).map_err(|error| wrong(&error))?;
        let (mut text, mut model_text) = (String::new(), String::new());
        for (name, value) in &texts.0 {
            let value = value.as_deref().unwrap_or_default().to_string_lossy();
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{name}={value}");
            if self.of_models.contains(name) {
                let _ = writeln!(model_text, "{name}={value}");
            }
        }
        let parsed = Arc::new(Parsed { options, text, model_text });
        self.parsed.insert(texts.clone(), Arc::clone(&parsed));
        Ok(parsed)
    }

    fn options(&self, texts: &OptionTexts) -> Result<PictureOptions, clap::Error> {
        let arguments = texts.0.iter().map(|(name, value)| {
            let mut argument = OsString::from(format!("--{name}"));
            if let Some(value) = value {
                argument.push("=");
                argument.push(value);
            }
            argument
        });
        let matches = self.command.clone().try_get_matches_from(arguments)?;
        PictureOptions::from_arg_matches(&matches)
    }
}

/// Converts an error of clap to one sentence.
fn wrong(error: &clap::Error) -> WrongOption {
    let name = |text: &str| {
        let name = text.trim_start_matches('-');
        name.split([' ', '=']).next().unwrap_or_default().to_owned()
    };
    let option = match error.get(ContextKind::InvalidArg) {
        Some(ContextValue::String(text)) => Some(name(text)),
        _ => None,
    };
    // The first paragraph is the reason; usage follows.
    let text = error.to_string();
    let lines = text.lines().map(str::trim).take_while(|line| !line.is_empty());
    let sentence = lines.collect::<Vec<_>>().join(" ");
    let reason = sentence.strip_prefix("error: ").unwrap_or(&sentence).to_owned();
    WrongOption { option, reason }
}

impl Args for OptionTexts {
    fn augment_args(command: Command) -> Command {
        PictureOptions::augment_args(command)
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl FromArgMatches for OptionTexts {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let mut texts = Self::default();
        texts.update_from_arg_matches(matches)?;
        Ok(texts)
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        for argument in command().get_arguments() {
            let id = argument.get_id().as_str();
            let Some(name) = argument.get_long() else { continue };
            if matches.value_source(id) != Some(ValueSource::CommandLine) {
                continue;
            }
            let value = match argument.get_action().takes_values() {
                true => matches.get_raw(id).and_then(Iterator::last).map(OsString::from),
                false => None,
            };
            self.0.insert(name.to_owned(), value);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(text: &str) -> Value {
        Value::Text(text.to_owned())
    }

    #[test]
    fn a_row_overrides_the_options_of_the_command_line() {
        let matches = OptionTexts::augment_args(Command::new("batch")).get_matches_from([
            "batch",
            "--edges",
            "--size=64",
            "--from",
            "-30,10",
        ]);
        let base = OptionTexts::from_arg_matches(&matches).unwrap();
        let mut parser = OptionParser::new();
        let parsed = parser.parse(&base).unwrap();
        assert_eq!(parsed.text, "edges=\nfrom=-30,10\nsize=64\n");
        assert!(parsed.options.scene.seeing.edges);
        let row = parser.with(&base, "edges", Value::Switch(false)).unwrap();
        let row = parser.with(&row, "size", text("32x16")).unwrap();
        let row = parser.with(&row, "material", text("gold")).unwrap();
        let parsed = parser.parse(&row).unwrap();
        assert_eq!(parsed.options.size, Some(Size::new(32, 16)));
        assert!(!parsed.options.scene.seeing.edges);
        assert_eq!(parsed.model_text, "material=gold\n");
        assert!(Arc::ptr_eq(&parsed, &parser.parse(&row).unwrap()), "equal rows are parsed once");
    }

    #[test]
    fn a_wrong_value_is_named_with_its_option() {
        let mut parser = OptionParser::new();
        let none = OptionTexts::default();
        let size = parser.with(&none, "size", text("0x5")).unwrap();
        let wrong = parser.parse(&size).unwrap_err();
        assert_eq!(wrong.option.as_deref(), Some("size"));
        assert!(wrong.reason.contains("800x600") && !wrong.reason.contains('\n'), "{wrong:?}");
        let wrong = parser.with(&none, "edges", text("maybe")).unwrap_err();
        assert_eq!(wrong.option.as_deref(), Some("edges"));
        let both = parser.with(&none, "edges", Value::Switch(true)).unwrap();
        let both = parser.with(&both, "edges-over", text("yes")).unwrap();
        assert!(parser.parse(&both).unwrap_err().reason.contains("cannot be used with"));
        assert!(parser.has("flip-winding") && !parser.has("flip_winding") && !parser.has("out"));
    }
}

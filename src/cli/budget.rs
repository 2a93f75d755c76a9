//! Settings for a budget: options that state what a picture may cost, or what it has to reach.
//!
//! A budget is resolved to settings first, which are printed as options. The picture is then the
//! one that these options draw on every machine.

use clap::Args;
use marraztu_core::accuracy::{AXES, Axis, Settings, Shot};
use marraztu_lab::budget::{Answer, Goal, VISIBLE, search};
use marraztu_lab::dial::{error_in_words, is_steady};
use marraztu_lab::picture_source::Studio;
use marraztu_lab::report::brief;
use marraztu_lab::timing::WallClock;

use super::accuracy::Accuracy;
use super::bar::Bar;
use super::failure::Failure;
use super::talk::note;

/// The options for budgets.
#[derive(Debug, Args)]
#[command(next_help_heading = "Accuracy for a budget")]
pub(crate) struct Budget {
    /// Find the most exact settings for pictures that this machine draws in this time: "20ms" or
    /// "0.5s". Prints the settings as options; axes that are given as options keep their choices
    #[arg(long, value_name = "TIME", value_parser = milliseconds)]
    #[arg(conflicts_with_all = ["error", "unseen", "preset", "transparent"])]
    within: Option<f64>,
    /// Find the fastest settings with at most this error, the root mean square difference from the
    /// ideal (256 samples per pixel) in steps of 255
    #[arg(long, value_name = "STEPS", value_parser = steps)]
    #[arg(conflicts_with_all = ["unseen", "preset", "transparent"])]
    error: Option<f64>,
    #[arg(long, conflicts_with_all = ["preset", "transparent"], help = unseen_help())]
    unseen: bool,
}

fn unseen_help() -> String {
    format!(
        "Find the fastest settings whose pictures look like the ideal: no pixel has a FLIP above \
         {VISIBLE}, a just noticeable difference in lightness, at 67 pixels per degree"
    )
}

impl Budget {
    fn goal(&self) -> Option<Goal> {
        let unseen = self.unseen.then_some(Goal::Unseen);
        self.within.map(Goal::Within).or(self.error.map(Goal::Error)).or(unseen)
    }

    /// Returns whether settings are searched.
    pub(super) fn is_given(&self) -> bool {
        self.goal().is_some()
    }

    /// Finds settings for a shot and prints them, or fails with the nearest ones. Returns the
    /// settings of the shot if there is no budget.
    pub(super) fn settings(&self, shot: &Shot, accuracy: &Accuracy) -> Result<Settings, Failure> {
        let Some(goal) = self.goal() else { return Ok(shot.settings) };
        let fixed = accuracy.fixed();
        let mut studio = Studio::new(shot.clone());
        let bar = Bar::unmeasured("searching settings");
        let answer = search(&mut studio, &mut WallClock::default(), shot, (goal, &fixed));
        drop(bar);
        let options = options(&answer.measured.settings, &shot.settings, &fixed);
        let text = in_words(goal, &answer, &options);
        if !answer.is_reached {
            return Err(Failure::Absent(text));
        }
        note(&text);
        Ok(answer.measured.settings)
    }
}

/// Returns the options that choose settings, each with its value: each choice that differs from the
/// default or from the scene's, and the samples per pixel, which files would otherwise refine.
pub(super) fn chosen(
    settings: &Settings,
    scene: &Settings,
    fixed: &[&Axis],
) -> Vec<(&'static str, &'static str)> {
    let is_stated = |axis: &&Axis| {
        let word = axis.chosen(settings).word;
        let differs = word != axis.default_choice().word || word != axis.chosen(scene).word;
        let is_fixed = fixed.iter().any(|other| other.key == axis.key);
        (differs || axis.key == "samples") && !is_fixed
    };
    let option = |axis: &'static Axis| (axis.key, axis.chosen(settings).word);
    AXES.iter().filter(is_stated).map(option).collect()
}

/// Returns the options that choose settings, as on the command line.
fn options(settings: &Settings, scene: &Settings, fixed: &[&Axis]) -> String {
    let option = |(key, word)| format!("--{key} {word}");
    chosen(settings, scene, fixed).into_iter().map(option).collect::<Vec<_>>().join(" ")
}

/// Describes an answer: "within 20 ms: 17 ms, error 1.2 of 255: --samples 4".
fn in_words(goal: Goal, answer: &Answer, options: &str) -> String {
    let Answer { measured, is_reached, compared } = answer;
    let busy = if is_steady(&measured.ms) { "" } else { ", as far as this busy machine tells" };
    let error = error_in_words(&measured.error)
        .unwrap_or_else(|| format!("at most {}", brief(measured.error.interval[1])));
    let figures = format!(
        "{} ms{busy}, error {error} of 255 against the ideal (RMSE, 95% interval)",
        brief(measured.ms.value)
    );
    let options = if options.is_empty() { "the given options" } else { options };
    // A picture with one missing window is not compared as a whole.
    let percent = (compared * 100.0).floor().max(1.0);
    let part = if *compared < 1.0 {
        format!(" in the {percent}% of the picture that were compared")
    } else {
        String::new()
    };
    let seen = format!("FLIP of at most {:.2}{part}", measured.flip);
    match (goal, is_reached) {
        (Goal::Within(most), true) => format!("within {} ms: {figures}: {options}", brief(most)),
        (Goal::Within(most), false) => format!(
            "nothing is drawn within {} ms here; the fastest settings: {figures}: {options}",
            brief(most)
        ),
        (Goal::Error(most), true) => format!("error up to {most}: {figures}: {options}"),
        (Goal::Error(most), false) => format!(
            "no other settings have an error of at most {most} with the given options; the most \
             exact ones: {figures}: {options}"
        ),
        (Goal::Unseen, true) => format!("looks like the ideal: {seen}; {figures}: {options}"),
        (Goal::Unseen, false) => format!(
            "nothing looks like the ideal with the given options; the most similar settings: \
             {seen}; {figures}: {options}"
        ),
    }
}

fn milliseconds(text: &str) -> Result<f64, String> {
    let (number, factor) = match (text.strip_suffix("ms"), text.strip_suffix('s')) {
        (Some(number), _) => (number, 1.0),
        (None, Some(number)) => (number, 1000.0),
        (None, None) => ("", 1.0),
    };
    let number = number.trim().parse().ok().map(|number: f64| number * factor);
    let number = number.filter(|number| number.is_finite() && *number > 0.0);
    number.ok_or_else(|| "write a time above 0 with its unit, as 20ms or 0.5s".to_owned())
}

fn steps(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|number: &f64| (0.0..=255.0).contains(number));
    number.ok_or_else(|| "write byte steps, from 0 to 255".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_have_a_unit() {
        assert_eq!(milliseconds("20ms"), Ok(20.0));
        assert_eq!(milliseconds("0.5 s"), Ok(500.0));
        for wrong in ["20", "ms", "0ms", "-1s", "1e999s", "NaNms"] {
            assert!(milliseconds(wrong).is_err(), "{wrong}");
        }
        assert!(steps("0.5").is_ok() && steps("-1").is_err() && steps("256").is_err());
    }
}

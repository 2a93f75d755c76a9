//! The commands of the program, and its arguments without one.

#[cfg(feature = "desktop")]
use std::path::PathBuf;

use clap::{Parser, Subcommand};
use marraztu_core::base::threads::Caller;

#[cfg(feature = "desktop")]
use super::arguments::choice;
#[cfg(feature = "desktop")]
use marraztu::app::Shell;
#[cfg(feature = "desktop")]
use marraztu_core::accuracy::{ACCURACY_PRESETS, AccuracyPreset};

/// Edits and draws 3D scenes of .obj models, on the CPU alone.
/// Without a command, opens the editor with the given models and scene, or with the first scene.
#[derive(Debug, Parser)]
#[command(
    name = "marraztu",
    version,
    args_conflicts_with_subcommands = true,
    subcommand_required = cfg!(not(feature = "desktop")),
    after_help = "\
Examples:
  marraztu                                  open the editor with the first scene
  marraztu teapot.obj                       open the editor with a model
  marraztu render teapot.obj                draw a model into teapot.png
  marraztu render --out first.png           draw the first scene
  marraztu turntable teapot.obj             draw a turntable of a model into teapot.gif
  marraztu export --out first.glb           write the first scene as glTF
  marraztu info teapot.obj                  describe a file and its problems

Exit status: 0 on success, 1 if something failed, 2 for invalid arguments."
)]
pub(crate) struct Arguments {
    /// The command to run without a window
    #[command(subcommand)]
    pub(crate) command: Option<Headless>,
    /// Models (.obj) and a scene (.marraztu) to open in the editor
    #[cfg(feature = "desktop")]
    pub(crate) files: Vec<PathBuf>,
    /// How to draw the window: automatic*, gl (OpenGL), software (on the CPU, without OpenGL)
    #[cfg(feature = "desktop")]
    #[arg(long, hide_possible_values = true, value_name = "WHAT", value_parser = choice(&[
        ("automatic", Shell::Automatic),
        ("gl", Shell::Gl),
        ("software", Shell::Software),
    ]))]
    pub(crate) shell: Option<Shell>,
    /// The accuracy preset to start with: draft, default, exact, ideal, ancestor-a, ancestor-b
    #[cfg(feature = "desktop")]
    #[arg(long, hide_possible_values = true, value_name = "CHOICE", value_parser = preset)]
    pub(crate) preset: Option<&'static AccuracyPreset>,
}

/// The commands that run without a window.
#[derive(Debug, Subcommand)]
pub(crate) enum Headless {
    /// Draw a picture into a file, with the same pixels as in the editor
    Render(Box<super::arguments::Render>),
    /// Draw many pictures: of all models of a list, from several views
    #[cfg(not(target_family = "wasm"))]
    Batch(Box<super::batch::Batch>),
    /// Join the reports of the parts of a batch
    #[cfg(not(target_family = "wasm"))]
    Merge(super::merge::Merge),
    /// Compare two pictures, or the pictures of two folders
    #[cfg(not(target_family = "wasm"))]
    Compare(super::compare::Compare),
    /// Draw standard views of a model into one picture, with its facts
    #[cfg(not(target_family = "wasm"))]
    Views(Box<super::views::Views>),
    /// Draw a small picture for a file manager
    Thumbnail(super::thumbnail::Thumbnail),
    /// Draw a turntable: a GIF, an animated PNG, or numbered pictures
    Turntable(Box<super::turntable::Turntable>),
    /// Export the scene as OBJ with MTL, or as glTF
    Export(Box<super::export::Export>),
    /// List the effects of a frame: on or left out, the reason, and the cost
    Plan(Box<super::plan::Plan>),
    /// Explain a pixel: its surface, and the light that makes up its colour
    Explain(Box<super::explain::Explain>),
    /// Describe files: shape, parts, materials and problems
    Info(super::arguments::Info),
    /// List every key of the editor
    #[cfg(feature = "desktop")]
    Keys(super::keys::Keys),
    /// Measure the cost of accuracy: time and error of each choice of each axis
    #[cfg(not(target_family = "wasm"))]
    Lab(Box<super::lab::Lab>),
    /// Check that this processor draws the same pictures as all others
    Verify(super::verify::Verify),
    /// Print a script that completes commands and options in a shell
    #[cfg(not(target_family = "wasm"))]
    Completions(super::manuals::Completions),
    /// Write manual pages for `man`
    #[cfg(not(target_family = "wasm"))]
    Man(super::manuals::Manuals),
}

impl Headless {
    /// Returns the number of threads that draw, one per core by default, and whether this thread is
    /// one of them.
    pub(super) fn threads(&self) -> (Option<usize>, Caller) {
        let threads = match self {
            Self::Render(arguments) => arguments.picture.threads,
            Self::Turntable(arguments) => arguments.picture.threads,
            Self::Plan(arguments) => arguments.picture.threads,
            Self::Explain(arguments) => arguments.picture.threads,
            // Waking this thread after each picture would be a part of the times.
            #[cfg(not(target_family = "wasm"))]
            Self::Lab(arguments) => return (arguments.threads, Caller::Joins),
            // Its threads have their own pools.
            #[cfg(not(target_family = "wasm"))]
            Self::Batch(_) => Some(1),
            #[cfg(not(target_family = "wasm"))]
            Self::Merge(_)
            | Self::Compare(_)
            | Self::Views(_)
            | Self::Completions(_)
            | Self::Man(_) => None,
            #[cfg(feature = "desktop")]
            Self::Keys(_) => None,
            Self::Thumbnail(_) | Self::Export(_) | Self::Info(_) | Self::Verify(_) => None,
        };
        let caller = if threads.is_some() { Caller::Joins } else { Caller::Waits };
        (threads, caller)
    }
}

#[cfg(feature = "desktop")]
fn preset(text: &str) -> Result<&'static AccuracyPreset, String> {
    AccuracyPreset::named(text).ok_or_else(|| {
        let words: Vec<&str> = ACCURACY_PRESETS.iter().map(|preset| preset.word).collect();
        format!("possible values: {}", words.join(", "))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_arguments_fit_together() {
        Arguments::command().debug_assert();
    }
}

//! `marraztu turntable`: draws a full turn of a scene.

use std::path::PathBuf;

use clap::Args;
use clap::builder::{PathBufValueParser, TypedValueParser};
use marraztu_core::accuracy::Shot;
use marraztu_core::edit::Refusal;
use marraztu_core::edit::turntable::{Turn, turned};
use marraztu_core::scene::View;
use marraztu_io::{Animation, AnimationFormat, AnimationWriter, Progress, Sources};
use marraztu_render::{Renderer, plan_frame, without_ground};

use super::arguments::PictureArguments;
use super::bar::Bar;
use super::budget::Budget;
use super::failure::Failure;
use super::render::stage;
use super::stage::Stage;
use super::talk::note;
use super::target::default_name;
use super::values::is_standard;

/// The most pictures in a turn: one per tenth of a degree.
const MOST_FRAMES: i64 = 3600;

/// A turn, and the file that it goes to.
#[derive(Debug, Args)]
#[command(after_help = "\
The first picture is the same as from `render` with these options; a budget for accuracy is resolved
for it, and all pictures have its settings. Objects that spin and lights that
circle keep moving. Nothing is written before the last picture is drawn, except numbered pictures.

Examples:
  marraztu turntable teapot.obj
  marraztu turntable bunny.obj --out bunny.png --size 480 --samples 4 --frames 90 --seconds 6
  marraztu turntable shelf.marraztu --out frames --turn camera
  marraztu turntable ship.obj --out ship.gif --transparent --material gold")]
pub(crate) struct Turntable {
    /// The file to write: .gif, .png (animated), or a name without an ending for a folder of
    /// numbered pictures [default: the name of the scene or first model with .gif, in the current
    /// folder]
    #[arg(short, long, value_name = "FILE")]
    #[arg(value_parser = PathBufValueParser::new().try_map(animation))]
    out: Option<PathBuf>,
    /// Number of pictures per turn
    #[arg(long, value_name = "N", default_value_t = 60)]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=MOST_FRAMES))]
    frames: u32,
    /// Seconds per turn
    #[arg(long, value_name = "SECONDS", default_value_t = 4.0, value_parser = seconds)]
    seconds: f64,
    /// The part that turns: objects* (under fixed lights), camera
    #[arg(long, value_name = "WHAT", hide_possible_values = true, default_value = "objects")]
    #[arg(hide_default_value = true, value_parser = ["objects", "camera"])]
    turn: String,
    /// Omit the background: the pictures get an alpha channel
    #[arg(long)]
    transparent: bool,
    #[command(flatten)]
    pub(super) picture: PictureArguments,
    #[command(flatten)]
    budget: Budget,
}

/// Draws the turn described by the arguments.
pub(super) fn turntable(arguments: &Turntable) -> Result<(), Failure> {
    let Turntable { out, frames, seconds, turn, transparent, picture, budget } = arguments;
    let path = out.clone().unwrap_or_else(|| default_name(&picture.files).with_extension("gif"));
    // Check the name before the files are loaded, which may take long.
    AnimationWriter::check(&path, &Sources::default())?;
    let mut stage = stage(picture)?;
    let size = picture.size;
    let (frames, seconds, transparent) = (*frames, *seconds, *transparent);
    let animation = Animation { size, frames, seconds, transparent };
    let turn = if turn == "camera" { Turn::Camera } else { Turn::Objects };
    // A refusal leaves no file.
    let scene = turned(&stage.scene, &stage.view, turn, 0.0).map_err(|refusal| match refusal {
        Refusal::ObjectLooks => Failure::Absent(
            "the observer is an object; choose a camera with --camera to turn it".to_owned(),
        ),
        other => other.into(),
    })?;
    // All pictures have the settings of the first one, so the turn does not flicker.
    let first = Shot { scene, ..stage.shot(size) };
    stage.settings = budget.settings(&first, &picture.accuracy)?;
    let mut writer = AnimationWriter::begin(&path, animation, &stage.sources(&picture.files))?;
    for text in writer.notes() {
        note(text);
    }
    let mut renderer = Renderer::default();
    let progress = Progress::new();
    let bar = Bar::of("drawing", &progress);
    for i in 0..frames {
        let part = f64::from(i) / f64::from(frames);
        let scene = turned(&stage.scene, &stage.view, turn, part)?;
        // Spins and orbits continue during the turn.
        let time = stage.view.time + seconds * part;
        let view = View { time, ..stage.view.clone() };
        let shot =
            Stage { scene, view, findings: Vec::new(), notes: Vec::new(), ..stage }.shot(size);
        if transparent {
            writer.push(&without_ground(&mut renderer, &shot))?;
        } else {
            writer.push(renderer.render(&plan_frame(&shot)))?;
        }
        // Nothing cancels this progress.
        let _ = progress.reached(i as usize + 1, frames as usize);
    }
    writer.finish()?;
    drop(bar);
    if out.is_none() {
        note(&format_args!("the turntable is in {}", path.display()));
    }
    Ok(())
}

/// Checks the file name before the pictures are drawn, which may take long.
fn animation(path: PathBuf) -> Result<PathBuf, String> {
    if is_standard(&path) {
        return Err("a turntable cannot be written to standard output".to_owned());
    }
    AnimationFormat::of(&path).map(|_| path)
}

fn seconds(text: &str) -> Result<f64, String> {
    let seconds = text.parse().ok().filter(|it: &f64| (0.01..=3600.0).contains(it));
    seconds.ok_or_else(|| "write seconds, from 0.01 to 3600".to_owned())
}

//! `marraztu job`: one drawing job, measured, in a form that other renderers print too.

use std::io::Write;
use std::path::PathBuf;

use clap::Args;
use fearless_simd::Level;
use marraztu::base::image::Size;
use marraztu::io;
use marraztu::lab::instructions::named as instructions_named;
use marraztu::lab::job::{self, Mode};
use marraztu::scene::{Crease, LoadOptions, Samples};

use super::failure::Failure;
use super::stage::load;
use super::values::{size, threads};
use super::{draw_along, say};

/// What is drawn, how, and for how long.
#[derive(Debug, Args)]
#[command(after_help = "\
Draws a mesh from an orbit, lit by five lights, and prints one line of comma-separated figures:
R, label, mesh, triangles, mode, size, samples, frames, median and shortest milliseconds a frame,
processor milliseconds a frame, the same three again, and how many pixels are covered.

Exit status 3: this mode, number of samples or set of instructions is not supported.")]
pub(crate) struct Job {
    /// The model (.obj)
    #[arg(long)]
    pub(crate) mesh: PathBuf,
    /// How to draw it: flat, gouraud, phong, depth, wire
    #[arg(long)]
    pub(crate) mode: String,
    /// Width and height in pixels; one number for a square
    #[arg(long, value_name = "WxH", default_value = "800x800", value_parser = size)]
    pub(crate) size: Size,
    /// Samples per pixel: 1, 4, 16, 64
    #[arg(long, default_value_t = 1)]
    pub(crate) msaa: u32,
    /// The most frames to measure
    #[arg(long, default_value_t = 200)]
    pub(crate) frames: usize,
    /// Frames to draw first, without measuring them
    #[arg(long, default_value_t = 3)]
    pub(crate) warm: usize,
    /// Milliseconds after which measuring stops
    #[arg(long, default_value_t = 1000.0)]
    pub(crate) budget: f64,
    /// Distance of the camera from the origin, at which it looks
    #[arg(long, default_value_t = 290.0)]
    pub(crate) dist: f64,
    /// Look straight at the mesh and hardly turn
    #[arg(long)]
    pub(crate) face: bool,
    /// Leave the mesh where its file has it
    #[arg(long)]
    pub(crate) raw: bool,
    /// Save the first frame's picture: .ppm, .png, .jpg or .webp
    #[arg(long)]
    pub(crate) out: Option<PathBuf>,
    /// The label of the line
    #[arg(long, default_value = "marraztu")]
    pub(crate) label: String,
    /// Instructions to draw with: best, avx512, avx2, sse4.2, plain. The picture is the same
    #[arg(long, value_name = "SET", default_value = "best")]
    pub(crate) instructions: String,
    /// Threads that draw [default: one for each core]
    #[arg(long, value_name = "N", value_parser = threads)]
    pub(crate) threads: Option<usize>,
}

/// The exit status of a job that this program does not do.
const UNSUPPORTED: u8 = 3;

/// How a job is drawn; else a sentence that says what is not supported.
fn supported(arguments: &Job) -> Result<(Mode, Samples, Level), String> {
    let Job { mode, msaa, instructions, .. } = arguments;
    let mode = Mode::named(mode).ok_or_else(|| {
        format!("the mode \"{mode}\" is not supported; there are flat, gouraud, phong, depth, wire")
    })?;
    let samples = Samples::ALL.into_iter().find(|samples| samples.count() == *msaa);
    let samples = samples.ok_or_else(|| {
        format!("{msaa} samples per pixel are not supported; there are 1, 4, 16 and 64")
    })?;
    let level = instructions_named(instructions).ok_or_else(|| {
        format!(
            "the instructions \"{instructions}\" are unknown, or this processor does not have \
             them; there are best, avx512, avx2, sse4.2, plain"
        )
    })?;
    Ok((mode, samples, level))
}

/// Measures a job and prints its line. Gives the exit status.
pub(crate) fn job(arguments: &Job) -> Result<u8, Failure> {
    let (mode, samples, level) = match supported(arguments) {
        Ok(supported) => supported,
        Err(reason) => {
            say("error", &reason);
            return Ok(UNSUPPORTED);
        }
    };
    draw_along(arguments.threads);
    // The job has normals of its own.
    let options = LoadOptions { crease: Crease::SMOOTH, ..LoadOptions::default() };
    let loaded = load(&arguments.mesh, &options)?;
    let measured = job::run(
        &job::Job {
            mode,
            size: arguments.size,
            samples,
            frames: arguments.frames.max(1),
            warm_up: arguments.warm,
            budget: arguments.budget,
            distance: arguments.dist,
            face: arguments.face,
            raw: arguments.raw,
            level,
        },
        &loaded.model,
    )?;
    if let Some(out) = &arguments.out {
        io::save_picture(out, &measured.picture)?;
    }
    let Size { width, height } = arguments.size;
    let times =
        format!("{:.4},{:.4},{:.4}", measured.median(), measured.shortest(), measured.processor);
    writeln!(
        std::io::stdout().lock(),
        "R,{},{},{},{},{width}x{height},{},{},{times},{times},{}",
        arguments.label,
        arguments.mesh.display(),
        measured.triangles,
        arguments.mode,
        arguments.msaa,
        measured.frames.len(),
        measured.covered,
    )
    .map_err(Failure::Output)?;
    Ok(0)
}

//! `marraztu job`: one drawing job, measured, in a form that other renderers print too.

use std::io::Write;
use std::path::PathBuf;

use clap::Args;
use marraztu::base::image::Size;
use marraztu::io;
use marraztu::lab::job::{self, Mode};
use marraztu::scene::{Crease, LoadOptions, Samples};

use super::arguments::size;
use super::draw_along;
use super::failure::Failure;
use super::stage::load;

/// What is drawn, how, and for how long.
#[derive(Debug, Args)]
#[command(after_help = "\
Draws a mesh from an orbit, lit by five lights, and prints one line of comma-separated figures:
R, label, mesh, triangles, mode, size, samples, frames, median and shortest milliseconds a frame,
processor milliseconds a frame, the same three again, and how many pixels are covered.

Exit status 3 says that this mode or number of samples is not drawn, or not with these instructions.")]
pub(crate) struct Job {
    /// The model (.obj)
    #[arg(long)]
    pub(crate) mesh: PathBuf,
    /// How it is drawn: flat, gouraud, phong, depth, wire
    #[arg(long)]
    pub(crate) mode: String,
    /// The picture's size
    #[arg(long, value_name = "WxH", default_value = "800x800", value_parser = size)]
    pub(crate) size: Size,
    /// Samples a pixel: 1, 4, 16, 64
    #[arg(long, default_value_t = 1)]
    pub(crate) msaa: u32,
    /// Frames to measure at the most
    #[arg(long, default_value_t = 200)]
    pub(crate) frames: usize,
    /// Frames to draw before
    #[arg(long, default_value_t = 3)]
    pub(crate) warm: usize,
    /// Milliseconds after which measuring stops
    #[arg(long, default_value_t = 1000.0)]
    pub(crate) budget: f64,
    /// From where the camera looks at the origin
    #[arg(long, default_value_t = 290.0)]
    pub(crate) dist: f64,
    /// The camera looks straight at the mesh and hardly turns
    #[arg(long)]
    pub(crate) face: bool,
    /// The mesh is left where its file has it
    #[arg(long)]
    pub(crate) raw: bool,
    /// The first frame's picture (.ppm, .png)
    #[arg(long)]
    pub(crate) out: Option<PathBuf>,
    /// What the line calls this program
    #[arg(long, default_value = "marraztu")]
    pub(crate) label: String,
    /// Instructions that it is drawn with: best, avx512, avx2, sse4.2, plain. The picture is the same
    #[arg(long, value_name = "SET", default_value = "best")]
    pub(crate) instructions: String,
    /// Threads that draw; all cores where it is not said
    #[arg(long)]
    pub(crate) threads: Option<usize>,
}

/// Measures a job and prints its line. Gives the exit status.
pub(crate) fn job(arguments: &Job) -> Result<u8, Failure> {
    let samples = Samples::ALL.into_iter().find(|samples| samples.count() == arguments.msaa);
    let level = job::instructions(&arguments.instructions);
    let (Some(mode), Some(samples), Some(level)) = (Mode::named(&arguments.mode), samples, level)
    else {
        return Ok(3);
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

//! Counts the instructions of a frame: lights that are off add none.
//!
//! `callgrind` counts what runs inside `counted_frame` only. Every process that is counted does the
//! same before: it plans and draws both frames, so that memory is laid out the same way.

use std::hint::black_box;
use std::process::Command;

use fearless_simd::Level;

use marraztu_core::accuracy::Settings;
use marraztu_core::base::image::Size;
use marraztu_core::base::rng::Rng;
use marraztu_io as io;
use marraztu_render::{FramePlan, Renderer};

use super::absent::with_lights_off;
use super::random_scenes::RandomScene;

/// A pattern of callgrind for the function that is counted.
pub(crate) const COUNTED: &str = "*counted_frame*";

/// The number of lights that are off in the second frame.
pub(crate) const LIGHTS_OFF: u32 = 100;

/// The frame that is counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Frame {
    /// The first scene.
    Plain,
    /// The same among [`LIGHTS_OFF`] lights that are off.
    LightsOff,
}

/// Draws both frames, and then the one that is counted.
///
/// # Errors
/// If this thread draws together with others already.
pub(crate) fn draw(frame: Frame) -> Result<(), rayon::ThreadPoolBuildError> {
    // All on this thread, since callgrind counts one thread.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build()?;
    let (scene, view) = io::default_scene();
    let (settings, size) = (Settings::default(), Size::new(128, 128));
    let it = RandomScene { seed: 0, scene, view, settings, size };
    let more = with_lights_off(&it, LIGHTS_OFF, &mut Rng::new(1));
    let plans = [it.plan(), more.plan()];
    let mut renderer = Renderer::new(level());
    pool.install(|| {
        for plan in plans.iter().chain(&plans) {
            black_box(renderer.render(plan));
        }
        match frame {
            Frame::Plain => counted_frame(&mut renderer, &plans[0]),
            Frame::LightsOff => counted_frame(&mut renderer, &plans[1]),
        }
    });
    Ok(())
}

/// See [`COUNTED`].
#[inline(never)]
fn counted_frame(renderer: &mut Renderer, plan: &FramePlan) {
    black_box(renderer.render(black_box(plan)));
}

/// The best instructions that callgrind supports.
pub(super) fn level() -> Level {
    let best = Level::new();
    #[cfg(target_arch = "x86_64")]
    if let Some(avx2) = best.as_avx2() {
        return Level::Avx2(avx2);
    }
    best
}

/// The number of instructions that callgrind counts inside functions of a pattern, in a process of
/// this program with these arguments.
///
/// # Errors
/// What went wrong.
pub(crate) fn count(pattern: &str, arguments: &[&str]) -> Result<u64, String> {
    let program = std::env::current_exe().map_err(|error| error.to_string())?;
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .arg(format!("--toggle-collect={pattern}"))
        .arg(program)
        .args(arguments)
        .output()
        .map_err(|error| format!("valgrind does not run: {error}"))?;
    let said = String::from_utf8_lossy(&output.stderr);
    let collected = said.lines().find_map(|line| line.split_once("Collected : "));
    let count = collected.and_then(|(_, count)| count.trim().parse().ok()).filter(|n| *n > 0);
    // Stripped programs have no names of functions.
    count.ok_or_else(|| {
        format!("callgrind counted nothing; add --profile profiling. It said:\n{said}")
    })
}

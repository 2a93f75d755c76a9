//! Counts the instructions of a frame: lights that are off add none.
//!
//! `callgrind` counts only the code inside `counted_frame`. Every counted process does the same
//! work beforehand: it plans and draws both frames, which gives memory the same layout.

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

/// The callgrind pattern for the counted function.
pub(crate) const COUNTED: &str = "*counted_frame*";

/// The number of lights that are off in the second frame.
pub(crate) const LIGHTS_OFF: u32 = 100;

/// The counted frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Frame {
    /// The first scene.
    Plain,
    /// The first scene with [`LIGHTS_OFF`] additional lights that are off.
    LightsOff,
}

/// Draws both frames, then the counted one.
///
/// # Errors
/// If this thread already belongs to a thread pool.
pub(crate) fn draw(frame: Frame) -> Result<(), rayon::ThreadPoolBuildError> {
    // Everything runs on this thread, because callgrind counts one thread.
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

/// The best instruction set that callgrind supports.
pub(super) fn level() -> Level {
    let best = Level::new();
    #[cfg(target_arch = "x86_64")]
    if let Some(avx2) = best.as_avx2() {
        return Level::Avx2(avx2);
    }
    best
}

/// Runs this program under callgrind with these arguments, and returns the number of instructions
/// inside functions that match a pattern.
///
/// # Errors
/// The failure.
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
    // Stripped programs have no function names.
    count.ok_or_else(|| {
        format!("callgrind counted nothing; add --profile profiling. It said:\n{said}")
    })
}

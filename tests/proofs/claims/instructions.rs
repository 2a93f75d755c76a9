//! A frame whose instructions are counted: the same however many lights are off.
//!
//! `callgrind` counts what runs inside `counted_frame` and nothing else. Every process that is counted
//! does the same before: it plans and draws both frames, so that memory is laid out alike.

use std::hint::black_box;

use fearless_simd::Level;

use marraztu::accuracy::Settings;
use marraztu::base::image::Size;
use marraztu::base::rng::Rng;
use marraztu::io;
use marraztu::render::{FramePlan, Renderer};

use super::absent::with_lights_off;
use super::random_scenes::RandomScene;

/// The function that counting is switched on in, as callgrind's patterns have it.
pub(crate) const COUNTED: &str = "*counted_frame*";

/// How many lights are off in the second frame.
pub(crate) const LIGHTS_OFF: u32 = 100;

/// Which of the two frames is counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Frame {
    /// The first scene.
    Plain,
    /// The same among [`LIGHTS_OFF`] lights that are off.
    LightsOff,
}

/// Draws both frames, and the one that is wanted once more to be counted.
///
/// # Errors
/// Where this thread draws already together with others.
pub(crate) fn draw(frame: Frame) -> Result<(), rayon::ThreadPoolBuildError> {
    // All on this thread, for counting is switched on for the thread that comes by.
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

/// The best instructions that callgrind knows.
fn level() -> Level {
    let best = Level::new();
    #[cfg(target_arch = "x86_64")]
    if let Some(avx2) = best.as_avx2() {
        return Level::Avx2(avx2);
    }
    best
}

//! A frame whose instructions are counted: the same however many lights are off.
//!
//! `callgrind` counts what runs inside `counted_frame` and nothing else. Every process that is counted
//! does the same before: it plans and draws both frames, so that memory is laid out alike.

use std::hint::black_box;

use fearless_simd::Level;

use super::absent::with_lights_off;
use super::samples::Sample;
use crate::base::image::Size;
use crate::io;
use crate::lab::prove::dice::Dice;
use crate::render::{FramePlan, Renderer};
use crate::scene::Settings;

/// The function that counting is switched on in, as callgrind's patterns have it.
pub const COUNTED: &str = "*counted_frame*";

/// How many lights are off in the second frame.
pub const LIGHTS_OFF: u32 = 100;

/// Which of the two frames is counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Frame {
    /// The first scene.
    Plain,
    /// The same among [`LIGHTS_OFF`] lights that are off.
    WithLightsOff,
}

/// Draws both frames, and the one that is wanted once more to be counted.
///
/// # Errors
/// Where this thread draws already together with others.
pub fn draw(frame: Frame) -> Result<(), rayon::ThreadPoolBuildError> {
    // All on this thread, for counting is switched on for the thread that comes by.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build()?;
    let (scene, view) = io::default_scene();
    let it =
        Sample { seed: 0, scene, view, settings: Settings::default(), size: Size::new(128, 128) };
    let more = with_lights_off(&it, LIGHTS_OFF, &mut Dice::new(1));
    let plan = |it: &Sample| FramePlan::new(&it.scene, &it.view, &it.settings, it.size);
    let plans = [plan(&it), plan(&more)];
    let mut renderer = Renderer::new(level());
    pool.install(|| {
        for plan in plans.iter().chain(&plans) {
            black_box(renderer.render(plan));
        }
        match frame {
            Frame::Plain => counted_frame(&mut renderer, &plans[0]),
            Frame::WithLightsOff => counted_frame(&mut renderer, &plans[1]),
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

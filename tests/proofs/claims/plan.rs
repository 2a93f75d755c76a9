//! Leaving effects out changes nothing: pictures of random scenes are compared with pictures from
//! complete plans. `tests/breakages` breaks the rules one by one and expects this proof to fail.

use marraztu_core::accuracy::Shot;
use marraztu_core::base::image::Picture;
use marraztu_render::plan_everything;

use marraztu_render::{FramePlan, Renderer};

use super::random_scenes::{RandomScene, random_scene};
use super::{Proof, Tally};

/// The number of scenes in a batch. One renderer draws them in turn, as the editor does.
pub(super) const SCENES: u64 = 16;

pub(crate) const PLAN: Proof = Proof {
    name: "plan",
    claim: "what a plan leaves out, and what is not drawn again, changes no bit of a picture",
    unit: "scenes",
    batch: SCENES,
    quick: 10_000,
    whole: 100_000,
    shows: &[("pixels that show something", 200_000)],
    regressions: &[644, 4569],
    check: is_complete,
};

/// The seeds of a batch.
pub(super) const fn seeds(batch: u64) -> std::ops::Range<u64> {
    batch * SCENES..(batch + 1) * SCENES
}

/// The complete plan of a scene, which computes everything.
fn complete(it: &RandomScene) -> FramePlan {
    plan_everything(&Shot::new(&it.scene, &it.view, &it.settings, it.size))
}

/// Draws the scenes of a batch with both plans, and expects the same bytes.
fn is_complete(batch: u64) -> Result<Tally, String> {
    let (mut renderer, mut reference) = (Renderer::default(), Renderer::default());
    let mut tally = Tally::default();
    for seed in seeds(batch) {
        // One scene in four repeats the previous one, to test a frame without changes.
        let it = random_scene(if seed % 4 == 3 { seed - 1 } else { seed });
        let expected = reference.render(&complete(&it));
        let drawn = renderer.redraw(&it.plan(), &|| true);
        drawn.map_err(|_cancelled| "the frame was cancelled".to_owned())?;
        same(seed, renderer.picture(), expected)?;
        count(&mut tally, &it, expected);
    }
    Ok(tally)
}

/// Compares two pictures, and names the first pixel that differs.
pub(super) fn same(seed: u64, got: &Picture, wanted: &Picture) -> Result<(), String> {
    if got == wanted {
        return Ok(());
    }
    let size = wanted.size();
    let at = |picture: &Picture, i: usize| picture.pixels().get(i).copied().unwrap_or_default();
    let differs = |i: &usize| at(got, *i) != at(wanted, *i);
    let i = (0..size.area()).find(differs).unwrap_or(0);
    let (x, y, got, wanted) = (i % size.width, i / size.width, at(got, i), at(wanted, i));
    Err(format!("scene {seed}: pixel ({x}, {y}) is {got:?} and should be {wanted:?}"))
}

fn count(tally: &mut Tally, it: &RandomScene, picture: &Picture) {
    let background = it.scene.background.opaque();
    let shown = picture.pixels().iter().filter(|pixel| **pixel != background).count();
    tally.count("scenes", 1);
    tally.count("pixels that show something", shown as u64);
}

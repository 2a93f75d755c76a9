//! What a plan leaves out changes nothing: pictures of scenes by chance against pictures by plans that
//! leave out nothing; and the proof itself against rules that are wrong on purpose.

pub mod absent;
pub mod instructions;
pub mod samples;
mod shapes;

use self::samples::{Sample, sample};
use super::{Proof, Tally};
use crate::base::image::Picture;
use crate::render::{FramePlan, Renderer};
use crate::scene::{LeaveOut, Settings};

/// Scenes of a lot: they are drawn one after the other with the same memory, as the editor does.
const SCENES: u64 = 16;

pub(super) const PLAN: Proof = Proof {
    name: "plan",
    claim: "what a plan leaves out, and what is not drawn again, changes no bit of a picture",
    unit: "scenes",
    lot: SCENES,
    tested: 10_000,
    whole: 100_000,
    check: is_full,
};

pub(super) const FAINT: Proof = Proof {
    name: "faint",
    claim: "light that is left out as too faint changes a byte by one step at most",
    unit: "scenes",
    lot: SCENES,
    tested: 2000,
    whole: 100_000,
    check: is_within_a_step,
};

pub(super) const ABSENT: Proof = Proof {
    name: "absent",
    claim: "lights that are off, hidden objects and unused materials change no byte, wherever they \
            are put in",
    unit: "scenes",
    lot: SCENES,
    tested: 2000,
    whole: 100_000,
    check: absent::is_not_seen,
};

/// The seeds of a lot.
const fn seeds(lot: u64) -> std::ops::Range<u64> {
    lot * SCENES..(lot + 1) * SCENES
}

/// Draws the scenes of a lot by `rules`, and by no rules at all, and wants the same bytes.
fn is_full(lot: u64) -> Result<Tally, String> {
    let (mut easel, mut full) = (Renderer::default(), Renderer::default());
    let mut tally = Tally::default();
    for seed in seeds(lot) {
        // One scene of four is the one before once more: then nothing has changed.
        let it = sample(if seed % 4 == 3 { seed - 1 } else { seed });
        let wanted =
            full.render(&FramePlan::of_everything(&it.scene, &it.view, &it.settings, it.size));
        let plan = planned(&it, &it.settings);
        easel.redraw(&plan, &|| true).map_err(|_given_up| "it was given up".to_owned())?;
        same(seed, easel.picture(), wanted)?;
        count(&mut tally, &it, wanted);
    }
    Ok(tally)
}

/// Draws the scenes of a lot with what is too faint left out, and wants bytes within a step of those
/// with nothing left out that is seen.
fn is_within_a_step(lot: u64) -> Result<Tally, String> {
    let (mut thinned, mut exact) = (Renderer::default(), Renderer::default());
    let mut tally = Tally::default();
    for it in seeds(lot).map(sample) {
        let wanted = exact.render(&planned(&it, &it.settings));
        let settings = Settings { leave_out: LeaveOut::HalfStep, ..it.settings };
        let got = thinned.render(&planned(&it, &settings));
        let pairs = got.pixels().as_flattened().iter().zip(wanted.pixels().as_flattened());
        let apart = pairs.map(|(a, b)| a.abs_diff(*b));
        let (worst, steps) =
            apart.fold((0, 0), |(worst, steps), by| (by.max(worst), steps + u64::from(by > 0)));
        if worst > 1 {
            return Err(format!("scene {}: a byte is {worst} steps off", it.seed));
        }
        count(&mut tally, &it, wanted);
        tally.count("bytes a step off", steps);
    }
    Ok(tally)
}

fn planned(it: &Sample, settings: &Settings) -> FramePlan {
    FramePlan::new(&it.scene, &it.view, settings, it.size)
}

/// Two pictures, and where they differ first.
fn same(seed: u64, got: &Picture, wanted: &Picture) -> Result<(), String> {
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

fn count(tally: &mut Tally, it: &Sample, picture: &Picture) {
    let background = it.scene.background.opaque();
    let shown = picture.pixels().iter().filter(|pixel| **pixel != background).count();
    tally.count("scenes", 1);
    tally.count("pixels that show something", shown as u64);
}

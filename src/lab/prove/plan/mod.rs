//! What a plan leaves out changes nothing: pictures of scenes by chance against pictures by plans that
//! leave out nothing; and the proof itself against rules that are wrong on purpose.

pub mod absent;
pub mod instructions;
pub mod samples;
mod shapes;

use std::sync::Arc;

use self::samples::{Sample, sample};
use super::{Proof, Tally};
use crate::base::image::Picture;
use crate::render::effects::Lamp;
use crate::render::plan::rules::{Meeting, Rules, Test, Verdict};
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
    check: |lot| is_full(&Rules::sound(), lot),
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

pub(super) const RULES: Proof = Proof {
    name: "rules",
    claim: "each rule by which something is left out changes pictures when it is made wrong",
    unit: "breakages",
    lot: 1,
    tested: (Rules::COUNT + FAULTS.len()) as u64,
    whole: (Rules::COUNT + FAULTS.len()) as u64,
    check: is_caught,
};

/// In so many lots every broken rule has to be caught.
const PATIENCE: u64 = 2500;

/// The seeds of a lot.
const fn seeds(lot: u64) -> std::ops::Range<u64> {
    lot * SCENES..(lot + 1) * SCENES
}

/// Draws the scenes of a lot by `rules`, and by no rules at all, and wants the same bytes.
fn is_full(rules: &Arc<Rules>, lot: u64) -> Result<Tally, String> {
    let (mut easel, mut full) = (Renderer::default(), Renderer::default());
    let mut tally = Tally::default();
    for seed in seeds(lot) {
        // One scene of four is the one before once more: then nothing has changed.
        let it = sample(if seed % 4 == 3 { seed - 1 } else { seed });
        let wanted = full.render(&planned(&Rules::off(), &it, &it.settings));
        let plan = planned(rules, &it, &it.settings);
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
    let rules = Rules::sound();
    for it in seeds(lot).map(sample) {
        let wanted = exact.render(&planned(&rules, &it, &it.settings));
        let settings = Settings { leave_out: LeaveOut::HalfStep, ..it.settings };
        let got = thinned.render(&planned(&rules, &it, &settings));
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

fn planned(rules: &Arc<Rules>, it: &Sample, settings: &Settings) -> FramePlan {
    FramePlan::by(Arc::clone(rules), &it.scene, &it.view, settings, it.size)
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

/// A rule made wrong.
#[derive(Clone, Copy, Debug)]
struct Breakage {
    rule: &'static str,
    /// What is wrong with it.
    fault: &'static str,
    replace: fn(Test) -> Test,
}

/// Every rule leaving out whatever it is asked about, and some rules with likely faults.
fn breakages() -> Vec<Breakage> {
    let sound = Rules::sound();
    let always = sound.iter().map(|rule| Breakage {
        rule: rule.name,
        fault: "leaves out whatever it is asked about",
        replace: Test::always,
    });
    always.chain(FAULTS.iter().copied()).collect()
}

/// Looks for a scene that shows that a rule is broken.
fn is_caught(number: u64) -> Result<Tally, String> {
    let mut tally = Tally::default();
    let number = usize::try_from(number).unwrap_or(usize::MAX);
    let Some(Breakage { rule, fault, replace }) = breakages().get(number).copied() else {
        return Ok(tally);
    };
    let broken =
        Rules::with(rule, replace).ok_or_else(|| format!("there is no rule \"{rule}\""))?;
    let caught = (0..PATIENCE).find(|lot| is_full(&broken, *lot).is_err());
    let lot = caught.ok_or_else(|| format!("\"{rule}\", which {fault}, is not seen"))?;
    tally.count("breakages", 1);
    tally.error("scenes until one is seen", ((lot + 1) * SCENES) as f64);
    Ok(tally)
}

const FAULTS: &[Breakage] = &[
    Breakage {
        rule: "light black",
        fault: "looks at red alone",
        replace: |_| Test::Light(|it| (it.light.color.0[0] == 0).then_some("no red")),
    },
    Breakage {
        rule: "coefficients 0",
        fault: "forgets Ks",
        replace: |_| Test::Reflection(|it| (it.matter.diffuse == [0.0; 3]).then_some("Kd is 0")),
    },
    Breakage {
        rule: "Ks 0",
        fault: "looks at blue alone",
        replace: |_| Test::Highlight(|it| (it.matter.specular[2] == 0.0).then_some("no blue")),
    },
    Breakage {
        rule: "object beyond the light",
        fault: "takes cones to be a tenth narrower",
        replace: |_| Test::Object(narrower),
    },
    Breakage {
        rule: "tile beyond the light",
        fault: "takes cones to be a tenth narrower",
        replace: |_| Test::Tile(narrower),
    },
    Breakage {
        rule: "light behind the faces",
        fault: "takes the sun to shine more from behind than it does",
        replace: |_| Test::Object(sideways),
    },
    Breakage {
        rule: "normals not needed",
        fault: "is glad where there are fewer than three lights",
        replace: |_| Test::Places(|it| (it.lights < 3).then_some("few lights")),
    },
];

/// Takes light along the faces to come from behind.
fn sideways(it: &Meeting<'_>) -> Verdict {
    let lamp = it.lamp;
    let [x, y, z] = lamp.direction;
    let aside = Lamp { direction: [x, y, z + 0.5], ..*lamp };
    (it.effect.is_behind)(&aside, it.region?, it.turning?).then_some("more or less behind")
}

/// The right rule, asked about a cone of nine tenths of the angle.
fn narrower(it: &Meeting<'_>) -> Verdict {
    let angle = libm::acos(it.lamp.cos_half_aperture) * 0.9;
    let lamp = Lamp { cos_half_aperture: libm::cos(angle), ..*it.lamp };
    (it.effect.misses)(&lamp, it.region?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_rule_is_broken_at_least_once() {
        assert_eq!(breakages().len() as u64, RULES.whole);
        for rule in Rules::sound().iter() {
            assert!(breakages().iter().any(|breakage| breakage.rule == rule.name), "{}", rule.name);
        }
    }
}

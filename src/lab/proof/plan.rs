//! What a plan leaves out changes nothing: proved on scenes by chance against plans that leave out
//! nothing, and the proof itself proved by rules that are wrong on purpose.

use std::ops::Range;
use std::sync::Arc;

use rayon::prelude::*;

use super::scenes::{Sample, sample};
use crate::base::image::Picture;
use crate::render::plan::rules::{Meeting, Rules, Test, Verdict};
use crate::render::{FramePlan, Renderer};
use crate::scene::{LeaveOut, Settings};

/// Scenes that are drawn one after the other with the same memory, as the editor does.
const RUN: u64 = 16;

/// A picture that is not what it should be.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Difference {
    /// The scene's seed.
    pub seed: u64,
    /// Column and row of the first pixel that differs.
    pub pixel: [usize; 2],
    /// What it shows.
    pub got: [u8; 4],
    /// What it should show.
    pub wanted: [u8; 4],
}

impl std::fmt::Display for Difference {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { seed, pixel: [x, y], got, wanted } = self;
        write!(f, "scene {seed}: pixel ({x}, {y}) is {got:?} and should be {wanted:?}")
    }
}

/// What a proof went through.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Scenes.
    pub scenes: u64,
    /// Pixels that show something.
    pub pixels: u64,
    /// Bytes that are one step off, where they may be.
    pub steps: u64,
}

impl Tally {
    fn with(self, other: Self) -> Self {
        Self {
            scenes: self.scenes + other.scenes,
            pixels: self.pixels + other.pixels,
            steps: self.steps + other.steps,
        }
    }
}

/// Draws the scenes of these seeds by `rules`, and by no rules at all, and wants the same bytes.
///
/// # Errors
/// The first pixel that differs in the first scene where one does.
pub fn plan_is_full(rules: &Arc<Rules>, seeds: Range<u64>) -> Result<Tally, Difference> {
    in_runs(seeds, |run| {
        let (mut easel, mut full) = (Easel::default(), Renderer::default());
        run.map(|seed| {
            let it = again(seed);
            let wanted = full.render(&planned(&Rules::off(), &it, &it.settings));
            let got = easel.show(planned(rules, &it, &it.settings));
            same(seed, got, wanted)?;
            Ok(tally(&it, wanted, 0))
        })
        .try_fold(Tally::default(), |sum, one: Result<_, _>| Ok(sum.with(one?)))
    })
}

/// Draws the scenes of these seeds with what is too faint left out, and wants bytes within a step of
/// those with nothing left out that is seen.
///
/// # Errors
/// The first pixel that is more than a step off in the first scene where one is.
pub fn faint_is_within_a_step(seeds: Range<u64>) -> Result<Tally, Difference> {
    in_runs(seeds, |run| {
        let (mut thinned, mut exact) = (Renderer::default(), Renderer::default());
        run.map(|seed| {
            let it = sample(seed);
            let rules = Rules::sound();
            let wanted = exact.render(&planned(&rules, &it, &it.settings));
            let settings = Settings { leave_out: LeaveOut::HalfStep, ..it.settings };
            let got = thinned.render(&planned(&rules, &it, &settings));
            let pairs = got.pixels().as_flattened().iter().zip(wanted.pixels().as_flattened());
            let apart = pairs.map(|(a, b)| a.abs_diff(*b));
            let (worst, steps) =
                apart.fold((0, 0), |(worst, steps), by| (by.max(worst), steps + u64::from(by > 0)));
            if worst > 1 {
                same(seed, got, wanted)?;
            }
            Ok(tally(&it, wanted, steps))
        })
        .try_fold(Tally::default(), |sum, one: Result<_, _>| Ok(sum.with(one?)))
    })
}

/// One scene of four is that of the seed before once more: then nothing has changed.
fn again(seed: u64) -> Sample {
    sample(if seed % 4 == 3 { seed - 1 } else { seed })
}

/// Goes through seeds in runs, on all threads; of what fails the first is given.
fn in_runs(
    seeds: Range<u64>,
    check: impl Fn(Range<u64>) -> Result<Tally, Difference> + Sync + Send,
) -> Result<Tally, Difference> {
    let runs: Vec<Range<u64>> = seeds
        .clone()
        .step_by(usize::try_from(RUN).expect("a small number"))
        .map(|from| from..(from + RUN).min(seeds.end))
        .collect();
    let results: Vec<_> = runs.into_par_iter().map(check).collect();
    results.into_iter().try_fold(Tally::default(), |sum, one| Ok(sum.with(one?)))
}

fn planned(rules: &Arc<Rules>, it: &Sample, settings: &Settings) -> FramePlan {
    FramePlan::by(Arc::clone(rules), &it.scene, &it.view, settings, it.size)
}

/// A picture that stays where the rules say that nothing has changed.
#[derive(Default)]
struct Easel {
    renderer: Renderer,
    shown: Option<FramePlan>,
}

impl Easel {
    fn show(&mut self, plan: FramePlan) -> &Picture {
        let stays = self.shown.as_ref().is_some_and(|shown| plan.left_out_after(shown).is_some());
        if !stays {
            self.renderer.render(&plan);
            self.shown = Some(plan);
        }
        self.renderer.picture()
    }
}

fn same(seed: u64, got: &Picture, wanted: &Picture) -> Result<(), Difference> {
    if got == wanted {
        return Ok(());
    }
    let size = wanted.size();
    let at = |picture: &Picture, i: usize| picture.pixels().get(i).copied().unwrap_or_default();
    let differs = |i: &usize| at(got, *i) != at(wanted, *i);
    let i = (0..size.area()).find(differs).unwrap_or(0);
    let pixel = [i % size.width, i / size.width];
    Err(Difference { seed, pixel, got: at(got, i), wanted: at(wanted, i) })
}

fn tally(it: &Sample, picture: &Picture, steps: u64) -> Tally {
    let background = it.scene.background.opaque();
    let shown = picture.pixels().iter().filter(|pixel| **pixel != background).count();
    Tally { scenes: 1, pixels: shown as u64, steps }
}

/// A rule made wrong.
#[derive(Clone, Copy, Debug)]
pub struct Breakage {
    /// The rule's name.
    pub rule: &'static str,
    /// What is wrong with it.
    pub fault: &'static str,
    replace: fn(Test) -> Test,
}

/// Every rule leaving out whatever it is asked about, and some rules with likely faults.
#[must_use]
pub fn breakages() -> Vec<Breakage> {
    let always = Rules::sound();
    let always = always.iter().map(|rule| Breakage {
        rule: rule.name,
        fault: "leaves out whatever it is asked about",
        replace: Test::always,
    });
    always.chain(FAULTS.iter().copied()).collect()
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
        fault: "takes the sun to shine more from the front than it does",
        replace: |_| Test::Object(sideways),
    },
    Breakage {
        rule: "normals not needed",
        fault: "is glad where there are fewer than three lights",
        replace: |_| Test::Places(|it| (it.lights() < 3).then_some("few lights")),
    },
];

/// Takes light along the faces to come from behind.
fn sideways(it: &Meeting<'_>) -> Verdict {
    let lamp = it.lamp;
    let [x, y, z] = lamp.direction;
    let aside = crate::render::effects::Lamp { direction: [x, y, z - 0.5], ..*lamp };
    (it.effect.is_behind)(&aside, it.region?, it.facing?).then_some("more or less behind")
}

/// The right rule, asked about a cone of nine tenths of the angle.
fn narrower(it: &Meeting<'_>) -> Verdict {
    let angle = libm::acos(it.lamp.cos_half_aperture) * 0.9;
    let lamp = crate::render::effects::Lamp { cos_half_aperture: libm::cos(angle), ..*it.lamp };
    (it.effect.misses)(&lamp, it.region?)
}

/// The first scene of these whose picture shows that a rule is broken, if one does.
#[must_use]
pub fn caught_by(breakage: &Breakage, seeds: Range<u64>) -> Option<Difference> {
    let broken = Rules::with(breakage.rule, breakage.replace)?;
    // Little by little, since most are caught soon.
    let mut from = seeds.start;
    while from < seeds.end {
        let to = (from + 8 * RUN).min(seeds.end);
        if let Err(difference) = plan_is_full(&broken, from..to) {
            return Some(difference);
        }
        from = to;
    }
    None
}

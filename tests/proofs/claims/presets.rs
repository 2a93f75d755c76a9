//! Exact keeps its promise on random scenes: with 16 samples per pixel it is the reference. Its
//! distance to the ideal is counted beside that of the default, not judged: on few pixels with
//! hard edges, either may be nearer.

use marraztu_core::accuracy::{AccuracyPreset, Samples, Settings, Shot};
use marraztu_core::base::image::Picture;
use marraztu_render::{Renderer, plan_everything, plan_frame};

use super::plan::same;
use super::random_scenes::random_scene;
use super::{Proof, Tally};

/// The number of scenes in a batch.
const SCENES: u64 = 4;

/// The difference of two errors that counts, in byte steps.
const MARGIN: f64 = 0.1;

pub(crate) const PROOF: Proof = Proof {
    name: "presets",
    claim: "Exact has the bytes of the reference, which leaves nothing out",
    unit: "scenes",
    batch: SCENES,
    quick: 40,
    whole: 1000,
    shows: &[("scenes nearer to the ideal than the default", 20)],
    regressions: &[],
    check: keep_their_promises,
};

fn keep_their_promises(batch: u64) -> Result<Tally, String> {
    let preset = |word: &str| {
        AccuracyPreset::named(word).ok_or_else(|| format!("there is no preset {word}"))
    };
    let (exact, ideal) = (preset("exact")?, preset("ideal")?);
    let mut renderer = Renderer::default();
    let mut tally = Tally::default();
    for seed in batch * SCENES..(batch + 1) * SCENES {
        let scene = random_scene(seed);
        let usual = Settings::default();
        let shot = |settings| Shot::new(&scene.scene, &scene.view, &settings, scene.size);
        let mut draw = |settings| renderer.render(&plan_frame(&shot(settings))).clone();
        let sixteen = |settings: Settings| settings.refined_to(Samples::Sixteen);
        let [usual_drawn, exact_drawn, ideal] =
            [sixteen(usual), sixteen(exact.of(&usual)), ideal.of(&usual)].map(&mut draw);
        // The reference computes everything, in one complete plan.
        let reference = sixteen(usual).reference();
        let complete = Renderer::default().render(&plan_everything(&shot(reference))).clone();
        same(seed, &exact_drawn, &complete)?;
        let errors = [&usual_drawn, &exact_drawn].map(|picture| rmse(picture, &ideal));
        tally.count("scenes", 1);
        let nearer = [errors[1] < errors[0] - MARGIN, errors[0] < errors[1] - MARGIN];
        tally.count("scenes nearer to the ideal than the default", u64::from(nearer[0]));
        tally.count("scenes farther from it", u64::from(nearer[1]));
    }
    Ok(tally)
}

/// The root mean square of the difference of two pictures' bytes.
fn rmse(a: &Picture, b: &Picture) -> f64 {
    let bytes = a.pixels().as_flattened().iter().zip(b.pixels().as_flattened());
    let squares: f64 = bytes.map(|(a, b)| f64::from(a.abs_diff(*b)).powi(2)).sum();
    (squares / (3.0 * a.size().area() as f64)).sqrt()
}

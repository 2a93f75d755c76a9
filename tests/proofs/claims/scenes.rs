//! Scenes with hostile numbers are drawn without a panic, with the same bytes on all instruction
//! sets, with depths from 0 to 1, and without pixels that are dark in f32 but lit in f64.

use fearless_simd::Level;
use glam::{DMat4, DVec3, DVec4};
use marraztu_render::simd::levels;

use super::hostile::Hostile;
use super::{Proof, Tally};
use marraztu_core::accuracy::Shot;
use marraztu_core::accuracy::{Arithmetic, Settings};
use marraztu_core::base::image::{Picture, Size};
use marraztu_core::base::rng::Rng;
use marraztu_core::scene::{
    Aim, Command, Item, Light, LightKind, MaterialChoice, Orbit, Scene, SpotOwner, Tracked, View,
};
use marraztu_render::Renderer;
use marraztu_render::plan_frame;

pub(crate) const PROOF: Proof = Proof {
    name: "scenes",
    claim: "scenes of hostile numbers are refused and left as they were, or drawn: no panic, the \
            same bytes on all instructions, depths from 0 to 1, no light lost in 32 bits",
    unit: "scenes",
    batch: SCENES,
    quick: 30_000,
    whole: 1_000_000,
    shows: &[],
    regressions: &[2456],
    check,
};

const SCENES: u64 = 100;

fn check(batch: u64) -> Result<Tally, String> {
    let mut tally = Tally::default();
    let [mut plain, mut best] = [levels()[0], Level::new()].map(Renderer::new);
    for i in 0..SCENES {
        let mut hostile = Hostile::new(batch * SCENES + i);
        let (scene, view) = hostile.scene(&mut tally);
        let settings = hostile.settings();
        let size = Size::new(1 + hostile.rng.index(40), 1 + hostile.rng.index(40));
        let plan = plan_frame(&Shot::new(&scene, &view, &settings, size));
        // The baseline and the best instruction set draw the same bytes.
        let first = plain.render(&plan).clone();
        let fail = |what: String| Err(format!("scene {i}: {what}"));
        if let Some(at) = difference(&first, best.render(&plan)) {
            return fail(format!("instructions show at {at:?}"));
        }
        // Depths stay in range at two random pixels.
        for _ in 0..2 {
            let (x, y) = (hostile.rng.index(size.width), hostile.rng.index(size.height));
            if let Some(hit) = best.hit(x, y)
                && !(0.0..=1.0).contains(&hit.depth)
            {
                return fail(format!("a depth of {}", hit.depth));
            }
        }
        // No pixel that f64 lights is dark in f32.
        if settings.arithmetic == Arithmetic::F32 {
            let settings = Settings { arithmetic: Arithmetic::F64, ..settings };
            let mut in_f64 = |scene: &Scene| {
                best.render(&plan_frame(&Shot::new(scene, &view, &settings, size))).clone()
            };
            let exact = in_f64(&scene);
            let differ = first.pixels().iter().zip(exact.pixels());
            tally.count("pixels", size.area() as u64);
            tally.count(
                "pixels more than a step off",
                differ.filter(|(a, b)| far(**a, **b)).count() as u64,
            );
            let mut lost = lost(&first, &exact);
            if !lost.is_empty() && !has_measure(&scene) {
                tally.count("scenes too bright to be judged", 1);
                lost.clear();
            }
            // On a border of light, a perturbation below the precision of f32 makes the pixel dark
            // in f64 too.
            tally.count("pixels on a border of light", lost.len() as u64);
            let rng = &mut hostile.rng;
            for _ in 0..NUDGES {
                if lost.is_empty() {
                    break;
                }
                let nudged = in_f64(&nudged(&scene, &view, rng));
                lost.retain(|at| !is_dark(&nudged.pixels()[*at]));
            }
            if let Some(at) = lost.first() {
                let at = (at % size.width, at / size.width);
                return fail(format!("{} pixels dark that should not be, as {at:?}", lost.len()));
            }
        }
        tally.count("scenes", 1);
        tally.count("pictures", 3);
    }
    Ok(tally)
}

/// The first pixel that differs between two pictures.
fn difference(a: &Picture, b: &Picture) -> Option<(usize, usize)> {
    let at = a.pixels().iter().zip(b.pixels()).position(|(a, b)| a != b)?;
    Some((at % a.size().width, at / a.size().width))
}

/// The pixels that are dark in f32 and bright in f64, which is the trace of a NaN.
fn lost(fast: &Picture, exact: &Picture) -> Vec<usize> {
    let bright = |pixel: &[u8; 4]| pixel[..3].iter().any(|byte| *byte > 32);
    let both = fast.pixels().iter().zip(exact.pixels()).enumerate();
    both.filter(|(_, (a, b))| is_dark(a) && bright(b)).map(|(at, _)| at).collect()
}

fn is_dark(pixel: &[u8; 4]) -> bool {
    pixel[..3] == [0; 3]
}

fn far(a: [u8; 4], b: [u8; 4]) -> bool {
    a.into_iter().zip(b).any(|(a, b)| a.abs_diff(b) > 1)
}

/// Whether a scene is dim enough that its rounding errors in f32 stay invisible.
fn has_measure(scene: &Scene) -> bool {
    const BRIGHT: f64 = 1e4;
    let within = |numbers: &[f64]| numbers.iter().all(|k| k.abs() < BRIGHT);
    scene.objects.iter().all(|(_, object)| {
        let mesh = &object.model.mesh;
        let colors = mesh.colors().iter().flatten().all(|k| f64::from(*k).abs() < BRIGHT);
        let MaterialChoice::Own(material) = &object.material else { return colors };
        let reflected = [material.ambient, material.diffuse, material.specular];
        colors && reflected.iter().all(|color| within(color))
    })
}

/// The number of perturbed scenes that test whether a pixel is on a border of light.
const NUDGES: usize = 32;

/// Moves lights by a millionth of their distance, and rotates and stretches objects by as much: a
/// few ulps of f32. For an almost flat placement this is the accuracy of its normals.
fn nudged(scene: &Scene, view: &View, rng: &mut Rng) -> Scene {
    const PART: f64 = 1.0 / (1 << 20) as f64;
    let eye = scene.observer_frame(view).w_axis.truncate();
    let nudge = |place: DVec3, rng: &mut Rng| {
        let distance = (place - eye).length() + eye.length() + place.length();
        place + rng.vector(1.0) * (PART * distance)
    };
    let mut scene = scene.clone();
    let objects: Vec<_> = scene.objects.iter().map(|(id, object)| (id, object.clone())).collect();
    for (id, mut object) in objects {
        let mut axis = |v: DVec4| v * (DVec3::ONE + rng.vector(1.0) * PART).extend(1.0);
        let m = object.placement.now();
        let m = DMat4::from_cols(axis(m.x_axis), axis(m.y_axis), axis(m.z_axis), m.w_axis);
        object.placement = Tracked::new(m);
        let _ = Command::Replace(Item::Object(id, Box::new(object))).apply(&mut scene);
    }
    let lights: Vec<_> = scene.lights.iter().map(|(id, light)| (id, light.clone())).collect();
    for (id, light) in lights {
        let kind = match &light.kind {
            LightKind::Bulb { position, orbit } => LightKind::Bulb {
                position: Tracked::new(nudge(orbit.at(*position.now(), view.time), rng)),
                orbit: Orbit { on: false, ..*orbit },
            },
            LightKind::Spot { owner, half_aperture, exponent } => {
                let Some(aim) = scene.aim(view, owner) else { continue };
                let direction = aim.direction + rng.vector(1.0) * PART;
                let aim = Aim { position: nudge(aim.position, rng), direction };
                LightKind::Spot {
                    owner: SpotOwner::Fixed(Tracked::new(aim)),
                    half_aperture: *half_aperture,
                    exponent: *exponent,
                }
            }
            LightKind::Sun { direction } => LightKind::Sun {
                direction: Tracked::new(*direction.now() + rng.vector(1.0) * PART),
            },
            LightKind::Ambient | LightKind::Sky { .. } => continue,
        };
        let item = Item::Light(id, Box::new(Light { kind, ..light }));
        // A rejected change leaves the light unchanged.
        let _ = Command::Replace(item).apply(&mut scene);
    }
    scene
}

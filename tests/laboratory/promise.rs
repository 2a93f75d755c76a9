//! The presets keep their promises, on the first scene, the examples and ten random scenes.
//!
//! Draft draws a quarter of the pixels, light of Default is as exact as in f64, Exact is the
//! reference with as many samples, and Ideal has no error. How long they take is measured by
//! `benches` and by `tools/evidence`, not here.
//!
//! Catches: a preset with too coarse a choice, f32 light with larger errors than promised, a
//! reference that differs from the presets, a draft that draws every pixel.

use marraztu_core::accuracy::Shot;
use marraztu_core::accuracy::{AccuracyPreset, Arithmetic, Samples, Settings};
use marraztu_core::base::image::{Picture, Size};
use marraztu_core::scene::{Command, Item, MaterialChoice, Scene, View};
use marraztu_io as io;
use marraztu_lab::error::Error;
use marraztu_lab::picture_source::{PictureSource as _, Studio};
use marraztu_lab::suite::SUITE;
use marraztu_render::plan_frame;
use marraztu_render::screen::coverage::PixelBox;
use marraztu_render::{PathPixels, Renderer};

use crate::random_scenes::random_scene;

/// The most colourful of the first 140 scenes of the plan's proof. Scenes with a light in the plane
/// of a lit surface, or with a cone without falloff (scene 6), are excluded: there, rounding
/// decides whether a pixel is lit or dark.
const SEEDS: [u64; 10] = [13, 28, 43, 48, 78, 88, 104, 107, 113, 134];

const SIZE: Size = Size::new(256, 192);

fn preset(word: &str) -> Settings {
    AccuracyPreset::named(word).unwrap().of(&Settings::default())
}

/// The default with exact light.
fn exact_light() -> Settings {
    Settings { arithmetic: Arithmetic::F64, ..Settings::default() }
}

fn studios() -> Vec<(String, Studio)> {
    let (scene, view) = io::default_scene();
    let first = Studio::new(Shot::new(&scene, &view, &Settings::default(), SIZE));
    let random = SEEDS.map(|seed| {
        let it = random_scene(seed);
        (format!("scene {seed}"), Studio::new(Shot::new(&it.scene, &it.view, &it.settings, SIZE)))
    });
    let example = |example: &io::Example| {
        let opened = io::open(example.path.as_ref(), &io::Progress::new()).unwrap();
        let shot = Shot::new(&opened.scene, &opened.view, &Settings::default(), SIZE);
        (example.title.to_owned(), Studio::new(shot))
    };
    let first = std::iter::once(("the first scene".to_owned(), first));
    first.chain(io::EXAMPLES.iter().map(example)).chain(random).collect()
}

/// Compares pictures with two settings: the error per scene, and the share of bytes that differ.
fn apart(ours: &Settings, exact: &Settings) -> (Vec<(String, Error)>, f64) {
    let (mut errors, mut differing, mut bytes) = (Vec::new(), 0.0, 0.0);
    for (name, mut studio) in studios() {
        let exact = studio.rendering(exact);
        let error = studio.rendering(ours).error(&exact);
        let alike = 3.0 * (studio.shot().size.area() - error.coverage) as f64;
        differing += error.inside.differing * alike;
        bytes += alike;
        errors.push((name, error));
    }
    (errors, differing / bytes)
}

#[test]
fn exact_is_the_reference_with_as_many_samples_on_every_pixel() {
    for samples in [Samples::One, Samples::Four] {
        let exact = preset("exact").refined_to(samples);
        let reference = Settings { samples, ..Settings::default() }.reference();
        let (errors, _) = apart(&exact, &reference);
        for (name, error) in &errors {
            assert_eq!(error.whole.largest, 0, "{name}: {error:?}");
        }
    }
}

#[test]
fn light_of_the_default_is_a_byte_step_off_at_most_and_hardly_ever_that() {
    let (errors, differing) = apart(&preset("default"), &exact_light());
    for (name, error) in &errors {
        assert!(error.inside.largest <= 1 && error.coverage == 0, "{name}: {error:?}");
    }
    assert!(differing <= 0.0005, "{differing}");
}

#[test]
fn the_draft_colours_a_quarter_of_the_pixels() {
    for (name, studio) in studios() {
        let pixels = |settings: &Settings| {
            let mut renderer = Renderer::default();
            let picture = renderer.render(&plan_frame(&studio.shot().with(*settings))).size();
            assert_eq!(picture, SIZE);
            let PathPixels { fill, faces, one, slots, each } = renderer.path_pixels().unwrap();
            fill + faces + one + slots + each
        };
        let (draft, default) = (pixels(&preset("draft")), pixels(&preset("default")));
        // Lines are as wide in drawn pixels, so they have half of their pixels. Small pictures have
        // few blocks, and some paths count whole ones.
        assert!(draft * 3 <= default + 512, "{name}: {draft} of {default}");
    }
}

#[test]
fn the_ideal_of_a_window_is_that_of_the_whole_picture_and_nothing_is_more_exact() {
    let (scene, view) = io::default_scene();
    let size = Size::new(150, 90);
    let shot = Shot::new(&scene, &view, &Settings::default(), size);
    let plan = plan_frame(&shot.with(preset("ideal")));
    let mut renderer = Renderer::default();
    let whole = renderer.render(&plan).clone();
    let window = PixelBox { left: 20, top: 30, right: 75, bottom: 64 };
    let part = Renderer::default().render_window(&plan, window, &|| true).unwrap();
    for y in 30..64 {
        for x in 20..75 {
            assert_eq!(part.pixel(x - 20, y - 30), whole.pixel(x, y), "{x}, {y}");
        }
    }
    // More samples come closer to it.
    let mut studio = Studio::new(shot);
    let ideal = studio.rendering(&preset("ideal"));
    let error = |studio: &mut Studio, samples| {
        let settings = preset("exact").refined_to(samples);
        studio.rendering(&settings).error(&ideal).whole.rmse
    };
    let errors = [Samples::One, Samples::Four, Samples::Sixteen, Samples::SixtyFour]
        .map(|samples| error(&mut studio, samples));
    assert!(errors.windows(2).all(|two| two[1] < 0.7 * two[0]), "{errors:?}");
}

/// Slow pictures are compared with the ideal in such windows.
#[test]
fn a_window_shows_the_same_as_the_whole_picture() {
    const WINDOWS: [[i32; 4]; 3] = [[20, 30, 75, 64], [64, 7, 72, 15], [149, 89, 150, 90]];
    let exact = preset("exact");
    for suite in SUITE {
        let (scene, view) = suite.open(20);
        for settings in [preset("default"), preset("default").refined(), exact, exact.refined()] {
            let plan = plan_frame(&Shot::new(&scene, &view, &settings, Size::new(150, 90)));
            let mut renderer = Renderer::default();
            let whole = renderer.render(&plan).clone();
            for [left, top, right, bottom] in WINDOWS {
                let window = PixelBox { left, top, right, bottom };
                let part = renderer.render_window(&plan, window, &|| true).unwrap();
                let at = |x: i32| usize::try_from(x).unwrap();
                for (y, x) in (top..bottom).flat_map(|y| (left..right).map(move |x| (y, x))) {
                    let own = part.pixel(at(x - left), at(y - top));
                    let other = whole.pixel(at(x), at(y));
                    // Coordinates of a window are smaller, and rounded less.
                    let same = (0..3).all(|i| own[i].abs_diff(other[i]) <= 1);
                    let (name, how) = (suite.word, settings.in_words());
                    assert!(same, "{name}, {how}: {own:?} for {other:?} at {x}, {y}");
                }
            }
        }
    }
}

/// The resolution of light before rounding, in parts of a byte step.
const PARTS: u32 = 64;

/// Measures the light at each byte before rounding, in byte steps, from a series of pictures that
/// grow brighter in 64 parts of a step, as hard case 42 does.
fn before_rounding(scene: &Scene, view: &View, settings: &Settings) -> Vec<f64> {
    let mut renderer = Renderer::default();
    let mut picture = |part: u32| -> Picture {
        let mut scene = scene.clone();
        for id in scene.objects.ids().collect::<Vec<_>>() {
            let mut object = scene.objects.get(id).unwrap().clone();
            let mut material = object.part_look(0).material;
            let more = f64::from(part) / f64::from(PARTS) / 255.0;
            material.ambient = material.ambient.map(|ka| ka + more);
            object.material = MaterialChoice::Own(material);
            Command::Replace(Item::Object(id, Box::new(object))).apply(&mut scene).unwrap();
        }
        let plan = plan_frame(&Shot::new(&scene, view, settings, Size::new(96, 96)));
        renderer.render(&plan).clone()
    };
    let first = picture(0);
    let mut turned: Vec<Option<u32>> = vec![None; 4 * first.pixels().len()];
    for part in 1..=PARTS {
        let now = picture(part);
        let pairs = first.pixels().as_flattened().iter().zip(now.pixels().as_flattened());
        for (turned, (before, now)) in turned.iter_mut().zip(pairs) {
            if now > before {
                turned.get_or_insert(part);
            }
        }
    }
    let light = |(byte, turned): (&u8, Option<u32>)| {
        // The change lies between the previous part and this one. A byte that never changes is
        // white or background.
        f64::from(*byte) + 0.5 - (f64::from(turned.unwrap_or(PARTS)) - 0.5) / f64::from(PARTS)
    };
    first.pixels().as_flattened().iter().zip(turned).map(light).collect()
}

#[test]
fn light_of_the_default_is_within_a_quarter_of_a_byte_step_before_it_is_rounded() {
    let (scene, view) = io::default_scene();
    let view = View { marks: false, ..view };
    let [ours, exact] =
        [preset("default"), exact_light()].map(|of| before_rounding(&scene, &view, &of));
    let turned = exact.iter().filter(|light| (0.1..254.0).contains(*light)).count();
    // Both values have an uncertainty of half a part.
    let off = ours.iter().zip(&exact).map(|(a, b)| (a - b).abs() - 1.0 / f64::from(PARTS));
    let worst = off.fold(0.0_f64, f64::max);
    assert!(turned > 1000 && worst <= 0.25, "{worst} {turned}");
}

/// Catches: settings of an example that cost more than the default and show less.
#[test]
fn the_own_settings_of_an_example_are_as_near_to_the_ideal_as_the_default() {
    for example in io::EXAMPLES {
        let opened = io::open(example.path.as_ref(), &io::Progress::new()).unwrap();
        let own = opened.settings;
        // A distant view needs filters, a close one sharp texels.
        for size in [Size::new(160, 100), Size::new(480, 300)] {
            let shot = Shot::new(&opened.scene, &opened.view, &own, size);
            let mut studio = Studio::new(shot);
            let ideal = studio.rendering(&own.ideal());
            for samples in [own.samples, Settings::REFINED] {
                let mut rmse = |settings: Settings| {
                    let settings = Settings { samples, ..settings };
                    studio.rendering(&settings).error(&ideal).whole.rmse
                };
                let [own, default] = [own, Settings::default().modelled_as(&own)].map(&mut rmse);
                let title = example.title;
                assert!(own <= 1.02 * default, "{title}, {size:?}, {samples:?}: {own} > {default}");
            }
        }
    }
}

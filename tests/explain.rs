//! The explanation of a pixel adds up to the byte on screen.

#![expect(clippy::unwrap_used, reason = "a test that cannot go on may panic")]
#![expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "small numbers")]

use marraztu_core::accuracy::{
    Arithmetic, LightAt, LightValues, Resolution, Samples, Settings, Shot, SpecularForm,
    Transparency,
};
use marraztu_core::base::color;
use marraztu_core::base::image::Size;
use marraztu_core::base::rng::Rng;
use marraztu_core::edit::items;
use marraztu_core::scene::{Fill, Projection, Scene, View};
use marraztu_io::{self as io, Progress};
use marraztu_lab::pixel;
use marraztu_render::{Part, Renderer, plan_frame};

const SIZE: Size = Size::new(320, 240);

/// Quantises a colour to bytes as pictures are quantised.
fn rounded(color: [f64; 3], arithmetic: Arithmetic) -> [u8; 3] {
    color.map(|x| match arithmetic {
        Arithmetic::F32 => ((x as f32).clamp(0.0, 1.0) * 255.0 + 0.5) as u8,
        Arithmetic::F64 => (x.clamp(0.0, 1.0) * 255.0 + 0.5) as u8,
    })
}

/// Checks the explanations of pixels, and returns the number of pixels that showed a surface.
fn adds_up(scene: &Scene, view: &View, settings: &Settings, pixels: &[[usize; 2]]) -> usize {
    let mut renderer = Renderer::default();
    let picture = renderer.render(&plan_frame(&Shot::new(scene, view, settings, SIZE))).clone();
    let mut surfaces = 0;
    for [x, y] in pixels.iter().copied() {
        // The explained bytes are the drawn ones. In linear light they are encoded, so their colour
        // is not compared here.
        let explained = renderer.explain(x, y).unwrap();
        let [r, g, b, _] = picture.pixel(x, y);
        let of = format!("{settings:?} {:?} pixel {x},{y}: {explained:?}", view.projection);
        assert_eq!(explained.bytes, [r, g, b], "{of}");
        if !explained.linear {
            assert_eq!(rounded(explained.color, settings.arithmetic), [r, g, b], "{of}");
        }
        // The terms and the rounding error add up to the colour.
        let mut sum = explained.rounding;
        for term in &explained.terms {
            for (sum, part) in sum.iter_mut().zip(term.value) {
                *sum += part;
            }
        }
        for ((sum, color), rounding) in sum.iter().zip(explained.color).zip(explained.rounding) {
            assert!((sum - color).abs() < 1e-14, "{of}");
            assert!(rounding.abs() < 1e-6, "{of}");
        }
        // The named surface is the one that is drawn there, with sound weights and directions.
        if let Some(point) = explained.surface {
            assert_eq!(renderer.hit(x, y).map(|hit| hit.item), Some(point.item), "{of}");
            surfaces += 1;
            assert!((point.weights.element_sum() - 1.0).abs() < 1e-5, "{of}");
            assert!((point.to_eye.length() - 1.0).abs() < 1e-4, "{of}");
        }
    }
    surfaces
}

/// Random pixels, concentrated near the middle, where the objects are.
fn random_pixels(seed: u64, count: usize) -> Vec<[usize; 2]> {
    let mut rng = Rng::new(seed);
    let mut near = |most: usize| (rng.index(most) + rng.index(most)) / 2;
    (0..count).map(|_| [near(SIZE.width), SIZE.height / 4 + near(SIZE.height / 2)]).collect()
}

#[test]
fn the_terms_of_random_pixels_add_up_to_the_bytes_of_the_picture() {
    let (scene, mut view) = io::default_scene();
    let mut seen = 0;
    for (i, light) in [LightAt::Pixel, LightAt::Face, LightAt::Vertex].into_iter().enumerate() {
        for arithmetic in [Arithmetic::F32, Arithmetic::F64] {
            for projection in [Projection::Perspective, Projection::Orthographic] {
                for specular in [SpecularForm::Reflection, SpecularForm::HalfVector] {
                    view.projection = projection;
                    let settings = Settings { light, arithmetic, specular, ..Settings::default() };
                    seen += adds_up(&scene, &view, &settings, &random_pixels(i as u64 + 1, 150));
                }
            }
        }
    }
    assert!(seen > 100, "only {seen} pixels showed a surface");
}

#[test]
fn edges_and_back_faces_and_the_background_are_explained_too() {
    let (scene, mut view) = io::default_scene();
    view.fill = Fill::Edges;
    adds_up(&scene, &view, &Settings::default(), &random_pixels(7, 300));
    (view.fill, view.back_faces) = (Fill::Filled, true);
    adds_up(&scene, &view, &Settings::default(), &random_pixels(8, 300));
}

#[test]
fn every_example_adds_up() {
    for example in io::EXAMPLES {
        let opened = io::open(example.path.as_ref(), &Progress::new()).unwrap();
        let settings = Settings { samples: Samples::One, ..opened.settings };
        adds_up(&opened.scene, &opened.view, &settings, &random_pixels(9, 100));
    }
}

#[test]
fn every_way_to_blend_and_to_enlarge_adds_up() {
    let opened = io::open("assets/effects/everything.marraztu".as_ref(), &Progress::new()).unwrap();
    // Of the first scene, glass shows the background as well.
    let (mut glass, view) = io::default_scene();
    items::change_all_objects(&glass, |it| it.opacity = 0.5).apply(&mut glass).unwrap();
    let scenes = [(opened.scene, opened.view), (glass, view)];
    let all = all_blends(&opened.settings);
    let all = scenes.iter().flat_map(|scene| all.iter().map(move |settings| (scene, settings)));
    let size = Size::new(40, 27);
    let (mut blended, mut enlarged) = (0, 0);
    for ((scene, view), settings) in all {
        let mut renderer = Renderer::default();
        let shot = Shot::new(scene, view, settings, size);
        let picture = renderer.render(&plan_frame(&shot)).clone();
        for [x, y] in (0..size.area()).map(|at| [at % size.width, at / size.width]) {
            let explained = renderer.explain(x, y).unwrap();
            let [r, g, b, _] = picture.pixel(x, y);
            let of = format!("{settings:?} pixel {x},{y}: {explained:?}");
            assert_eq!((explained.at, explained.bytes), ([x, y], [r, g, b]), "{of}");
            for (i, byte) in explained.bytes.into_iter().enumerate() {
                let sum = explained.terms.iter().map(|term| term.value[i]).sum::<f64>();
                let color = explained.color[i];
                assert!((sum + explained.rounding[i] - color).abs() < 1e-14, "{of}");
                // Where layers are blended, fixed-point numbers add to the error.
                let stored = if explained.linear { color::encoded(color) } else { color };
                let steps = stored.clamp(0.0, 1.0) * 255.0;
                assert!((steps - f64::from(byte)).abs() < 0.502, "{of}");
            }
            let has = |part| usize::from(explained.terms.iter().any(|term| term.part == part));
            blended += has(Part::Blending);
            enlarged += has(Part::Enlarged);
            let drawn = (settings.resolution == Resolution::Half).then_some([x / 2, y / 2]);
            assert_eq!(explained.drawn, drawn, "{of}");
            let lines = pixel::lines(scene, &explained);
            assert_eq!(lines[0], format!("pixel {x},{y}"));
            assert_eq!(lines[1].contains("half the size"), drawn.is_some(), "{}", lines[1]);
        }
    }
    assert!(blended > 20 && enlarged > 1000, "{blended} {enlarged}");
}

/// Returns settings with each way to blend, in both kinds of values and both resolutions.
fn all_blends(settings: &Settings) -> Vec<Settings> {
    let mut all = Vec::new();
    for transparency in [Transparency::Objects, Transparency::Exact] {
        for light_values in [LightValues::Stored, LightValues::Linear] {
            for resolution in [Resolution::Full, Resolution::Half] {
                let samples = Samples::One;
                let own = Settings { samples, transparency, light_values, ..*settings };
                all.push(Settings { resolution, ..own });
            }
        }
    }
    all
}

#[test]
fn a_sun_from_above_matches_the_formula() {
    let (scene, view) = io::default_scene();
    let settings = Settings { arithmetic: Arithmetic::F64, ..Settings::default() };
    let mut renderer = Renderer::default();
    renderer.render(&plan_frame(&Shot::new(&scene, &view, &settings, SIZE)));
    let mut checked = 0;
    for [x, y] in random_pixels(3, 600) {
        let explained = renderer.explain(x, y).unwrap();
        let Some(point) = explained.surface else { continue };
        for term in explained.terms.iter().filter(|term| term.part == Part::Diffuse) {
            let ray = term.ray.unwrap();
            assert!((point.normal.dot(ray.to_light) - ray.n_l).abs() < 1e-9);
            assert!((ray.reflected.dot(point.to_eye) - ray.highlight).abs() < 1e-9);
            if ray.n_l <= 0.0 {
                assert_eq!(term.value, [0.0; 3]);
            }
            checked += usize::from(ray.n_l > 0.0 && term.value[0] > 0.0);
        }
        let lines = pixel::lines(&scene, &explained);
        assert!(lines.iter().any(|line| line.contains("clamped and rounded")));
    }
    assert!(checked > 5, "{checked}");
}

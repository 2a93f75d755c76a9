//! Pictures with several samples a pixel, held to pictures with one that are drawn from each place.

#![expect(clippy::cast_possible_truncation, reason = "small numbers")]

mod common;

use common::{at, ball, draw, edit, model_of, scene, square};
use glam::DMat4;
use marraztu::base::color::Color;
use marraztu::base::image::{Picture, Size};
use marraztu::lab::prove::stage::{self, Flat};
use marraztu::render::geometry::coverage::Snapped;
use marraztu::render::{FramePlan, Renderer};
use marraztu::scene::{
    ItemId, MeshSource, NONE, ObjectId, Part, Samples, Scene, Settings, SourceCorner, Surface, View,
};

const SIDE: usize = 128;

/// The places of samples as Vulkan's specification has them, in pixels from the upper left corner.
const FOUR: [[f64; 2]; 4] = [[0.375, 0.125], [0.875, 0.375], [0.125, 0.625], [0.625, 0.875]];
const SIXTEEN: [[f64; 2]; 16] = [
    [0.5625, 0.5625],
    [0.4375, 0.3125],
    [0.3125, 0.625],
    [0.75, 0.4375],
    [0.1875, 0.375],
    [0.625, 0.8125],
    [0.8125, 0.6875],
    [0.6875, 0.1875],
    [0.375, 0.875],
    [0.5, 0.0625],
    [0.25, 0.125],
    [0.125, 0.75],
    [0.0, 0.5],
    [0.9375, 0.25],
    [0.875, 0.9375],
    [0.0625, 0.0],
];

fn places(samples: Samples) -> Vec<[f64; 2]> {
    match samples {
        Samples::One => vec![[0.5; 2]],
        Samples::Four => FOUR.to_vec(),
        Samples::Sixteen => SIXTEEN.to_vec(),
        Samples::SixtyFour => {
            (0..64).map(|i| [i % 8, i / 8].map(|i| (f64::from(i) + 0.5) / 8.0)).collect()
        }
    }
}

/// Numbers that look random.
fn numbers(mut state: u64) -> impl FnMut(i32) -> i32 {
    move |below| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        ((state >> 33) % u64::from(below.unsigned_abs())) as i32
    }
}

/// Triangles of all sizes, half of their coordinates on sixteenths of a pixel.
fn scattered(count: usize, seed: u64) -> Vec<Flat> {
    let mut random = numbers(seed);
    let far = SIDE as i32 * 256;
    let extents = [300, 700, 1500, 4000, 20_000, 2 * far];
    let mut triangles = Vec::new();
    for i in 0..count {
        let extent = extents[i % extents.len()];
        let (left, top) = (random(far + extent) - extent, random(far + extent) - extent);
        let mut corner = || {
            let [x, y] = [left, top].map(|from| {
                let place = from + random(extent);
                if random(2) == 0 { place } else { place / 16 * 16 }
            });
            Snapped { x, y }
        };
        let corners = [corner(), corner(), corner()];
        let distances = [0, 1, 2].map(|_| f64::from(random(1024)));
        triangles.push(Flat { corners, distances });
    }
    triangles
}

/// The triangles as they are seen from a place in a pixel.
fn seen_from(triangles: &[Flat], [x, y]: [f64; 2]) -> Vec<Flat> {
    let [x, y] = [x, y].map(|place| (place * 256.0) as i32 - 128);
    let moved = |corner: Snapped| Snapped { x: corner.x - x, y: corner.y - y };
    triangles.iter().map(|flat| Flat { corners: flat.corners.map(moved), ..*flat }).collect()
}

fn drawn(triangles: &[Flat], view: impl Fn(View) -> View, settings: &Settings) -> Picture {
    let (mut scene, own) = stage::scene(&[triangles.to_vec()], SIDE);
    scene.background = Color([9, 99, 199]);
    let plan = FramePlan::new(&scene, &view(own), settings, Size::new(SIDE, SIDE));
    Renderer::default().render(&plan).clone()
}

/// Sum by sum against one picture for each place, drawn with all corners moved the other way.
#[test]
fn a_pixel_is_the_mean_of_what_is_seen_from_its_places() {
    let with_edges = |view: View| View { edges_over_fill: true, ..view };
    let wide = |view: View| View { edges_over_fill: true, wide_lines: true, ..view };
    let filled = |view: View| view;
    let views: [fn(View) -> View; 3] = [filled, with_edges, wide];
    for samples in [Samples::Four, Samples::Sixteen, Samples::SixtyFour] {
        for (round, view) in views.into_iter().enumerate() {
            let triangles = scattered(150, 3 + round as u64);
            let places = places(samples);
            let mut sums = vec![[0_u32; 3]; SIDE * SIDE];
            for place in &places {
                let one = drawn(&seen_from(&triangles, *place), view, &Settings::default());
                for (sum, pixel) in sums.iter_mut().zip(one.pixels()) {
                    for (sum, byte) in sum.iter_mut().zip(pixel) {
                        *sum += u32::from(*byte);
                    }
                }
            }
            let settings = Settings { samples, ..Settings::default() };
            let picture = drawn(&triangles, view, &settings);
            let count = places.len() as u32;
            for (i, (sum, pixel)) in sums.iter().zip(picture.pixels()).enumerate() {
                for (sum, byte) in sum.iter().zip(pixel) {
                    // Half of a step to either side.
                    let off = (count * u32::from(*byte)).abs_diff(*sum);
                    assert!(2 * off <= count, "{samples:?} {i}: {byte} for {sum} / {count}");
                }
            }
        }
    }
}

/// All pixels around one of a picture.
fn around(i: usize, side: usize) -> impl Iterator<Item = usize> {
    let (x, y) = (i % side, i / side);
    let near = move |i: usize| i.saturating_sub(1)..(i + 2).min(side);
    near(y).flat_map(move |y| near(x).map(move |x| y * side + x))
}

#[test]
fn where_nothing_ends_a_picture_is_the_same_with_any_number_of_samples() {
    let leaning = at(70.0, 10.0, 5.0, 0.0) * DMat4::from_rotation_y(0.6);
    let (scene, view) = scene(&[(square(), leaning), (ball(4), at(60.0, -40.0, 20.0, 30.0))]);
    let view = View { marks: false, ..view };
    let mut renderer = Renderer::default();
    let plan = |samples| {
        let settings = Settings { samples, ..Settings::default() };
        FramePlan::new(&scene, &view, &settings, Size::new(200, 200))
    };
    let one = renderer.render(&plan(Samples::One)).clone();
    let shown = renderer.primitives();
    let inside: Vec<usize> = (0..shown.len())
        .filter(|i| around(*i, 200).all(|other| shown[other] == shown[*i]))
        .collect();
    assert!(inside.iter().filter(|i| shown[**i] != 0).count() > 3000);
    for samples in [Samples::Four, Samples::Sixteen, Samples::SixtyFour] {
        let many = renderer.render(&plan(samples));
        for i in &inside {
            assert_eq!(many.pixels()[*i], one.pixels()[*i], "{samples:?} {i}");
        }
    }
}

/// A fan of triangles thinner than a pixel, with colours from 80 to 160 at its corners.
fn fan() -> (Scene, View) {
    let mut source = MeshSource {
        parts: vec![Part { name: "fan".to_owned(), material: None }],
        ..MeshSource::default()
    };
    let colors = [80.0, 120.0, 160.0].map(|byte: f32| [byte / 255.0; 3]);
    for i in 0..400_u16 {
        let turn = f32::from(i) / 400.0 * std::f32::consts::TAU;
        let (sin, cos) = turn.sin_cos();
        let near = f32::from(i % 7) / 20.0;
        let corner =
            |along: f32, across: f32| [along * cos - across * sin, along * sin + across * cos, 0.0];
        for (place, color) in [corner(near, 0.0), corner(1.0, 0.002), corner(near + 0.3, 0.004)]
            .into_iter()
            .zip(colors)
        {
            let position = source.positions.len() as u32;
            source.corners.push(SourceCorner { position, uv: NONE, normal: NONE });
            source.positions.push(place);
            source.colors.push(color);
        }
        source.arities.push(3);
        source.polygon_parts.push(0);
    }
    let (mut scene, view) = scene(&[(model_of("fan", source), at(110.0, 0.0, 0.0, 0.0))]);
    edit(&mut scene, ObjectId(10), |object| {
        object.surface = Surface::Texture;
        object.two_sided = true;
    });
    scene.background = Color([120; 3]);
    (scene, View { marks: false, ..view })
}

#[test]
fn no_colour_leaves_the_range_of_its_corners() {
    let (scene, view) = fan();
    for samples in [Samples::Four, Samples::Sixteen, Samples::SixtyFour] {
        for arithmetic in [marraztu::scene::Arithmetic::F32, marraztu::scene::Arithmetic::F64] {
            let settings = Settings { samples, arithmetic, ..Settings::default() };
            let picture = draw(&scene, &view, &settings, 160);
            let differ = |pixel: &&[u8; 4]| pixel[0] != 120;
            assert!(picture.pixels().iter().filter(differ).count() > 2000);
            let outside = picture.pixels().iter().find(|pixel| !(80..=160).contains(&pixel[0]));
            assert_eq!(outside, None, "{samples:?} {arithmetic:?}");
        }
    }
}

#[test]
fn the_more_samples_the_nearer_to_the_reference() {
    let (scene, view) = marraztu::io::default_scene();
    let drawn = |samples| {
        let settings = Settings { samples, ..Settings::default() };
        draw(&scene, &view, &settings, 300)
    };
    let exact = drawn(Samples::SixtyFour);
    let error = |samples| {
        let picture = drawn(samples);
        let bytes = picture.pixels().as_flattened().iter().zip(exact.pixels().as_flattened());
        bytes.map(|(a, b)| f64::from(a.abs_diff(*b)).powi(2)).sum::<f64>().sqrt()
    };
    let [one, four, sixteen] = [Samples::One, Samples::Four, Samples::Sixteen].map(error);
    assert!(one > 1.8 * four && four > 1.8 * sixteen, "{one} {four} {sixteen}");
}

#[test]
fn what_is_picked_is_what_most_samples_show() {
    // The right border of the square stands a quarter, then three quarters into a pixel.
    for (part, seen) in [(0.25, false), (0.75, true)] {
        let border = Snapped { x: 64 * 256 + (part * 256.0) as i32, y: 0 };
        let below = Snapped { y: 128 * 256, ..border };
        let corners = [Snapped { x: 0, y: 0 }, Snapped { x: 0, y: 128 * 256 }];
        let halves = [[corners[0], border, below], [corners[0], below, corners[1]]];
        let (scene, view) = stage::scene(&[halves.map(Flat::new).to_vec()], SIDE);
        for samples in [Samples::Four, Samples::Sixteen, Samples::SixtyFour] {
            let settings = Settings { samples, ..Settings::default() };
            let mut renderer = Renderer::default();
            renderer.render(&FramePlan::new(&scene, &view, &settings, Size::new(SIDE, SIDE)));
            let hit = renderer.hit(64, 20).map(|hit| hit.item);
            assert_eq!(hit, seen.then_some(ItemId::Object(ObjectId(1))), "{samples:?} {part}");
            assert!(renderer.hit(63, 20).is_some() && renderer.hit(65, 20).is_none());
        }
    }
}

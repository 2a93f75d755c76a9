//! Pictures with several samples per pixel, compared with one-sample pictures at each sample
//! position and with pictures eight times as large.

#![expect(clippy::cast_possible_truncation, reason = "small numbers")]
#![allow(clippy::unwrap_used, reason = "a test fails where there is nothing")]

mod common;

use common::{at, ball, draw, edit, model_of, scene, square};
use glam::{DMat4, DVec3};
use marraztu_core::accuracy::Shot;
use marraztu_core::accuracy::{Arithmetic, Axis, LightAt, Samples, Settings};
use marraztu_core::base::Shared;
use marraztu_core::base::color::Color;
use marraztu_core::base::image::{Picture, Size};
use marraztu_core::base::rng::Rng;
use marraztu_core::scene::{
    Aim, ItemId, Light, LightId, LightKind, Material, MaterialChoice, MeshSource, NormalLength,
    ObjectId, Projection, Scene, Sides, SourceCorner, SpotOwner, Surface, Texture, Tracked, View,
};
use marraztu_lab::picture_source::{PictureSource as _, Studio};
use marraztu_lab::pictures::flat::{self, Flat};
use marraztu_render::Renderer;
use marraztu_render::plan_frame;
use marraztu_render::screen::coverage::Snapped;

const SIDE: usize = 128;

/// The sample positions of the Vulkan specification, in pixels from the upper left corner.
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
        Samples::TwoFiftySix => {
            (0..256).map(|i| [i % 16, i / 16].map(|i| (f64::from(i) + 0.5) / 16.0)).collect()
        }
    }
}

/// Triangles of all sizes, with half of the coordinates on sixteenths of a pixel.
fn scattered(count: usize, seed: u64) -> Vec<Flat> {
    let mut rng = Rng::new(seed);
    let mut random = |below: i32| rng.between(0, below - 1);
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

/// Moves triangles so that a sample position comes to the pixel centre.
fn seen_from(triangles: &[Flat], [x, y]: [f64; 2]) -> Vec<Flat> {
    let [x, y] = [x, y].map(|place| (place * 256.0) as i32 - 128);
    let moved = |corner: Snapped| Snapped { x: corner.x - x, y: corner.y - y };
    triangles.iter().map(|flat| Flat { corners: flat.corners.map(moved), ..*flat }).collect()
}

fn drawn(triangles: &[Flat], view: impl Fn(View) -> View, settings: &Settings) -> Picture {
    let (mut scene, own) = flat::scene(&[triangles.to_vec()], SIDE);
    scene.background = Color([9, 99, 199]);
    let plan = plan_frame(&Shot::new(&scene, &view(own), settings, Size::new(SIDE, SIDE)));
    Renderer::default().render(&plan).clone()
}

/// Checks that each byte of a picture is the rounded mean of some pixels; halves may round either
/// way.
#[track_caller]
fn wants_means(picture: &Picture, pixels: &[Vec<[u8; 4]>], what: &str) {
    wants_near_means(picture, pixels, 0.5, what);
}

/// Checks that each byte of a picture is at most `most` steps from the mean of some pixels: one if
/// these are rounded, as colours are summed before they are rounded.
#[track_caller]
fn wants_near_means(picture: &Picture, pixels: &[Vec<[u8; 4]>], most: f64, what: &str) {
    assert_eq!(picture.pixels().len(), pixels.len());
    for (i, (pixel, all)) in picture.pixels().iter().zip(pixels).enumerate() {
        let count = all.len() as u32;
        for (channel, byte) in pixel[..3].iter().enumerate() {
            let sum: u32 = all.iter().map(|pixel| u32::from(pixel[channel])).sum();
            let off = (count * u32::from(*byte)).abs_diff(sum);
            assert!(
                f64::from(off) <= most * f64::from(count),
                "{what} {i}: {byte} for {sum} / {count}"
            );
        }
    }
}

/// Compares sums with one picture per sample position, with all corners moved the other way.
#[test]
fn a_pixel_is_the_mean_of_its_samples() {
    let with_edges = |view: View| View { edges_over_fill: true, ..view };
    let wide = |view: View| View { edges_over_fill: true, wide_lines: true, ..view };
    let filled = |view: View| view;
    let views: [fn(View) -> View; 3] = [filled, with_edges, wide];
    for samples in [Samples::Four, Samples::Sixteen, Samples::SixtyFour] {
        for (round, view) in views.into_iter().enumerate() {
            let triangles = scattered(150, 3 + round as u64);
            let mut seen = vec![Vec::new(); SIDE * SIDE];
            for place in places(samples) {
                let one = drawn(&seen_from(&triangles, place), view, &Settings::default());
                seen.iter_mut().zip(one.pixels()).for_each(|(all, pixel)| all.push(*pixel));
            }
            let settings = Settings { samples, ..Settings::default() };
            let picture = drawn(&triangles, view, &settings);
            wants_means(&picture, &seen, &format!("{samples:?}"));
        }
    }
}

/// Triangles with a normal and a texture coordinate at each corner, lit by a sun alone: their light
/// depends only on the position within the triangle.
fn shiny(triangles: &[Flat], side: usize) -> (Scene, View) {
    let (mut scene, view) = flat::scene(&[triangles.to_vec()], side);
    let mut rng = Rng::new(5);
    let mut random = |below: i32| rng.between(0, below - 1);
    let mut source = MeshSource::of_polygons([], vec![3; triangles.len()]);
    source.uvs = vec![[0.0, 0.0], [2.0, 0.0], [0.0, 3.0]];
    // Random normals and repeated texture coordinates, so each position has its own light.
    for triangle in triangles {
        for (corner, distance) in triangle.corners.into_iter().zip(triangle.distances) {
            let i = source.positions.len() as u32;
            source.corners.push(SourceCorner { position: i, uv: i % 3, normal: i });
            source.positions.push(flat::place(corner, distance, side).as_vec3().to_array());
            let [x, y] = [random(200), random(200)].map(|x| x as f32 / 100.0 - 1.0);
            source.normals.push([x, y, 0.8]);
        }
    }
    let model = model_of("shiny", source);
    let texels = (0..36).map(|_| [random(255) as u8, 200, random(255) as u8, 255]);
    let picture = Picture::from_pixels(Size::new(6, 6), texels.collect()).unwrap();
    let texture = Texture::new("", picture);
    edit(&mut scene, ObjectId(1), |object| {
        object.model = model;
        object.texture = Some(Shared::new(texture));
        object.surface = Surface::TextureAndLight;
        object.file_normals = true;
        object.material = MaterialChoice::Own(Material {
            specular: [0.6; 3],
            exponent: 40.0,
            ..Material::matte([0.1; 3], [0.5; 3])
        });
    });
    let suns =
        Light::five().into_iter().filter(|light| matches!(light.kind, LightKind::Sun { .. }));
    scene.lights = (500..).map(LightId).zip(suns).collect();
    scene.background = Color([9, 99, 199]);
    (scene, view)
}

fn rendered((scene, view): &(Scene, View), settings: &Settings, side: usize) -> Picture {
    draw(scene, view, settings, side)
}

/// Groups the pixels of a picture eight times as large by the pixel of the small one.
fn in_boxes(large: &Picture, side: usize) -> Vec<Vec<[u8; 4]>> {
    let of = |i: usize| {
        let place = move |k: usize| (i % side * 8 + k % 8, i / side * 8 + k / 8);
        (0..64).map(place).map(|(x, y)| large.pixel(x, y)).collect()
    };
    (0..side * side).map(of).collect()
}

/// Compares sums as above, and the grid of 64 samples also with the pixels of a larger picture.
#[test]
fn each_sample_is_lit_at_its_own_position() {
    let with_edges = |view: View| View { edges_over_fill: true, ..view };
    let filled = |view: View| view;
    let views: [fn(View) -> View; 2] = [filled, with_edges];
    let pixels = Settings::default();
    let each = Settings { light: LightAt::Sample, ..pixels };
    for samples in [Samples::Four, Samples::Sixteen, Samples::SixtyFour] {
        for (round, view) in views.into_iter().enumerate() {
            let triangles = scattered(60, 38 + round as u64);
            let stage = |triangles: &[Flat], side| {
                let (scene, own) = shiny(triangles, side);
                (scene, view(own))
            };
            let mut seen = vec![Vec::new(); SIDE * SIDE];
            for place in places(samples) {
                let one = rendered(&stage(&seen_from(&triangles, place), SIDE), &pixels, SIDE);
                seen.iter_mut().zip(one.pixels()).for_each(|(all, pixel)| all.push(*pixel));
            }
            let small = stage(&triangles, SIDE);
            let picture = rendered(&small, &Settings { samples, ..each }, SIDE);
            wants_near_means(&picture, &seen, 1.0, &format!("{samples:?}"));
            let once = rendered(&small, &Settings { samples, ..pixels }, SIDE);
            let apart = picture.pixels().iter().zip(once.pixels()).filter(|(a, b)| a != b).count();
            assert!(apart > 500, "light is evaluated once a pixel: but for {apart}");
        }
    }
    // Without lines, which are one pixel wide at any size.
    let triangles = scattered(60, 11);
    let larger = |corner: Snapped| Snapped { x: 8 * corner.x, y: 8 * corner.y };
    let large: Vec<Flat> =
        triangles.iter().map(|it| Flat { corners: it.corners.map(larger), ..*it }).collect();
    let large = rendered(&shiny(&large, 8 * SIDE), &pixels, 8 * SIDE);
    let samples = Samples::SixtyFour;
    let small = rendered(&shiny(&triangles, SIDE), &Settings { samples, ..each }, SIDE);
    wants_near_means(&small, &in_boxes(&large, SIDE), 1.0, "eight times as large");
}

/// Half of 100.6 is 50.3. The mean of two bytes would be 51, half of 101.
#[test]
fn colours_are_averaged_before_they_are_rounded() {
    let [right, bottom] = [64 * 256 + 128, SIDE as i32 * 256];
    let corner = |x, y| Snapped { x, y };
    let [a, b, c, d] = [corner(0, 0), corner(right, 0), corner(right, bottom), corner(0, bottom)];
    let triangles = [[a, b, c], [a, c, d]].map(|corners| Flat { corners, distances: [9.0; 3] });
    let (mut scene, view) = flat::scene(&[triangles.to_vec()], SIDE);
    scene.background = Color::BLACK;
    edit(&mut scene, ObjectId(1), |object| {
        object.surface = Surface::Material;
        object.material = MaterialChoice::Own(Material {
            emission: [100.6 / 255.0; 3],
            ..Material::matte([0.0; 3], [0.0; 3])
        });
    });
    for light in [LightAt::Pixel, LightAt::Sample] {
        for samples in [Samples::Four, Samples::Sixteen, Samples::SixtyFour] {
            let picture =
                draw(&scene, &view, &Settings { samples, light, ..Settings::default() }, SIDE);
            let row = [63, 64, 65].map(|x| picture.pixel(x, 20)[0]);
            assert_eq!(row, [101, 50, 0], "{light:?} {samples:?}");
        }
    }
}

/// In perspective, the larger picture snaps corners eight times as finely, so samples next to an
/// edge may show its other side: up to 4 steps per pixel, and 0.05 steps RMS. Pixels that show one
/// triangle differ by at most one step.
#[test]
fn sixty_four_lit_samples_are_the_mean_of_a_picture_eight_times_as_large() {
    const SMALL: usize = 48;
    let leaning = at(60.0, 20.0, 8.0, 20.0) * DMat4::from_rotation_y(0.7);
    // Part of this square is behind the observer.
    let cut = at(40.0, -8.0, -20.0, 390.0) * DMat4::from_rotation_x(-1.2);
    let models = [(square(), leaning), (ball(5), at(50.0, -30.0, 10.0, 60.0)), (square(), cut)];
    let (scene, view) = scene(&models);
    let view = View { marks: false, ..view };
    let mut renderer = Renderer::default();
    for arithmetic in [Arithmetic::F32, Arithmetic::F64] {
        let settings = Settings { arithmetic, ..Settings::default() };
        let plan =
            plan_frame(&Shot::new(&scene, &view, &settings, Size::new(8 * SMALL, 8 * SMALL)));
        let large = in_boxes(renderer.render(&plan), SMALL);
        let shown = renderer.primitives();
        let samples = Samples::SixtyFour;
        let settings = Settings { samples, light: LightAt::Sample, ..settings };
        let plan = plan_frame(&Shot::new(&scene, &view, &settings, Size::new(SMALL, SMALL)));
        let small = renderer.render(&plan);
        let (mut squares, mut inside) = (0.0, 0);
        for (i, (pixel, all)) in small.pixels().iter().zip(&large).enumerate() {
            let primitive =
                |k: usize| shown[(i / SMALL * 8 + k / 8) * 8 * SMALL + i % SMALL * 8 + k % 8];
            let alone = (0..64).all(|k| primitive(k) == primitive(0));
            inside += usize::from(alone && primitive(0) != 0);
            for channel in 0..3 {
                let mean = all.iter().map(|it| f64::from(it[channel])).sum::<f64>() / 64.0;
                let off = (f64::from(pixel[channel]) - mean).abs();
                // Half a step is allowed for rounding.
                let most = if alone { 1.0 } else { 4.0 };
                assert!(off <= most + 0.5, "{arithmetic:?} {i}: {} for {mean}", pixel[channel]);
                squares += (off - 0.5).max(0.0).powi(2);
            }
        }
        let rms = (squares / (3 * SMALL * SMALL) as f64).sqrt();
        assert!(rms < 0.05 && inside > 300, "{rms} {inside}");
    }
}

/// A cone without falloff has a sharp border: a pixel on it is as bright as the share of its
/// samples inside. Rounding may put two of 64 on the other side.
#[test]
fn the_border_of_a_spot_is_as_soft_as_there_are_samples() {
    const SMALL: usize = 48;
    let (mut scene, view) =
        scene(&[(square(), at(90.0, 3.0, 2.0, 0.0) * DMat4::from_rotation_y(0.3))]);
    let view = View { marks: false, ..view };
    let aim = Aim { position: DVec3::new(5.0, 1.0, 120.0), direction: DVec3::NEG_Z };
    let owner = SpotOwner::Fixed(Tracked::new(aim));
    let kind = LightKind::Spot { owner, half_aperture: 25.0, exponent: 0.0 };
    scene.lights = [(LightId(900), Light::new("spot", 1, kind))].into_iter().collect();
    edit(&mut scene, ObjectId(10), |object| {
        object.material = MaterialChoice::Own(Material::matte([0.0; 3], [0.9; 3]));
    });
    for projection in [Projection::Perspective, Projection::Orthographic] {
        let view = View { projection, ..view.clone() };
        let large = in_boxes(&draw(&scene, &view, &Settings::default(), 8 * SMALL), SMALL);
        let settings =
            Settings { samples: Samples::SixtyFour, light: LightAt::Sample, ..Settings::default() };
        let small = draw(&scene, &view, &settings, SMALL);
        let mut border = 0;
        for (i, (pixel, all)) in small.pixels().iter().zip(&large).enumerate() {
            let lit = all.iter().filter(|it| it[0] > 0).count();
            // Only pixels with all samples on the square.
            if all.iter().any(|it| *it == scene.background.opaque()) {
                continue;
            }
            border += usize::from((8..56).contains(&lit));
            let mean = all.iter().map(|it| f64::from(it[0])).sum::<f64>() / 64.0;
            let off = (f64::from(pixel[0]) - mean).abs();
            assert!(off <= 2.0 * 255.0 / 64.0 + 1.0, "{projection:?} {i}: {} for {mean}", pixel[0]);
        }
        assert!(border >= 10, "{projection:?}: {border}");
    }
}

/// On the test stage these choices place every corner exactly, so lit samples are equal apart from
/// rounding.
#[test]
fn finer_and_coarser_corners_light_samples_alike_if_both_are_exact() {
    let (scene, view) = shiny(&scattered(40, 31), SIDE);
    let lit = Settings { samples: Samples::Four, light: LightAt::Sample, ..Settings::default() };
    let wanted = draw(&scene, &view, &lit, SIDE);
    for (key, word) in [("subpixels", "bits-12"), ("vertices", "f32")] {
        let choice = Axis::named(key).and_then(|axis| axis.choice(word)).unwrap();
        let got = draw(&scene, &view, &choice.of(&lit), SIDE);
        let pairs = got.pixels().as_flattened().iter().zip(wanted.pixels().as_flattened());
        let apart = pairs.map(|(a, b)| a.abs_diff(*b)).max();
        assert!(apart <= Some(1), "{key} {word}: {apart:?}");
    }
}

/// If colours depend on primitives only, lit and unlit samples show the same, with every choice
/// that places primitives on the screen, and with lines and clipped triangles.
#[test]
fn lit_samples_see_the_primitives_that_others_see() {
    let leaning = at(60.0, 20.0, 8.0, 20.0) * DMat4::from_rotation_y(0.7);
    let cut = at(40.0, -8.0, -20.0, 390.0) * DMat4::from_rotation_x(-1.2);
    let models = [(square(), leaning), (ball(5), at(50.0, -30.0, 10.0, 60.0)), (square(), cut)];
    let (mut scene, view) = scene(&models);
    for (id, tint) in (10..).zip([[255, 0, 0], [0, 255, 0], [200, 200, 0]]) {
        edit(&mut scene, ObjectId(id), |object| {
            (object.surface, object.tint) = (Surface::Texture, Color(tint));
            object.edge_color = Color([0, 0, 255]);
        });
    }
    let view = View {
        edges_over_fill: true,
        vertex_normals: true,
        normal_length: NormalLength::BySize,
        ..view
    };
    let mut looked_at = 0;
    for key in ["vertices", "subpixels", "coverage", "depth"] {
        for choice in Axis::named(key).unwrap().choices {
            let others = Settings { samples: Samples::Four, ..choice.of(&Settings::default()) };
            let lit = Settings { light: LightAt::Sample, ..others };
            let [others, lit] = [others, lit].map(|settings| draw(&scene, &view, &settings, 80));
            let pairs = others.pixels().as_flattened().iter().zip(lit.pixels().as_flattened());
            // A mean half-way between two bytes may round either way.
            let apart = pairs.filter(|(a, b)| a.abs_diff(**b) > 1).count();
            // f32 edge functions round differently if the triangle moves instead of the sample.
            let allowed = if choice.word == "f32-edges" { 40 } else { 0 };
            assert!(apart <= allowed, "{key} {}: {apart} bytes", choice.word);
            let mixed = |pixel: &&[u8; 4]| pixel[2] != 0 && pixel[2] != 255;
            looked_at += lit.pixels().iter().filter(mixed).count();
        }
    }
    assert!(looked_at > 5000, "{looked_at}");
}

#[test]
fn the_only_sample_of_a_pixel_is_its_middle() {
    let (scene, view) = marraztu_io::default_scene();
    let plan = |light| {
        let settings = Settings { light, ..Settings::default() };
        plan_frame(&Shot::new(&scene, &view, &settings, Size::new(50, 50)))
    };
    assert_eq!(plan(LightAt::Sample), plan(LightAt::Pixel));
}

#[test]
fn lit_samples_are_drawn_again_given_up_and_picked_as_others_are() {
    let (mut scene, view) = scene(&[(ball(6), at(60.0, -40.0, 20.0, 30.0))]);
    let size = Size::new(150, 100);
    let planned = |scene: &Scene, light| {
        let settings = Settings { samples: Samples::Four, light, ..Settings::default() };
        plan_frame(&Shot::new(scene, &view, &settings, size))
    };
    let picked = |renderer: &mut Renderer| -> Vec<Option<ItemId>> {
        let all = (0..size.area()).step_by(7);
        all.map(|i| renderer.hit(i % 150, i / 150).map(|hit| hit.item)).collect()
    };
    let mut renderer = Renderer::default();
    renderer.render(&planned(&scene, LightAt::Sample));
    let mut other = Renderer::default();
    other.render(&planned(&scene, LightAt::Pixel));
    let seen = picked(&mut other);
    assert_eq!(picked(&mut renderer), seen);
    assert_eq!(renderer.primitives(), other.primitives());
    // A new material, redrawn in the tiles that show the object.
    edit(&mut scene, ObjectId(10), |object| {
        object.material = MaterialChoice::Preset(marraztu_core::scene::PresetId::EMERALD);
    });
    let wanted = Renderer::default().render(&planned(&scene, LightAt::Sample)).clone();
    let changes = renderer.redraw(&planned(&scene, LightAt::Sample), &|| true).unwrap();
    assert!(changes.tiles() > 0 && changes.tiles() < changes.tiles_in_all());
    assert!(*renderer.picture() == wanted);
    // After any cancelled redraw, picking uses the last picture, and the next redraw is right.
    edit(&mut scene, ObjectId(10), |object| {
        object.placement = Tracked::new(at(50.0, 0.0, 0.0, 30.0));
    });
    let moved = planned(&scene, LightAt::Sample);
    for patience in [0, 1, 5, 20, 60] {
        let asked = std::sync::atomic::AtomicUsize::new(0);
        let wanted = || asked.fetch_add(1, std::sync::atomic::Ordering::Relaxed) < patience;
        if renderer.redraw(&moved, &wanted).is_err() {
            assert_eq!(picked(&mut renderer), seen, "{patience}");
        }
    }
    renderer.redraw(&moved, &|| true).unwrap();
    assert!(renderer.picture() == Renderer::default().render(&moved));
    assert!(picked(&mut renderer) != seen);
}

#[test]
fn lit_samples_are_the_same_on_all_instructions_and_by_any_number_of_threads() {
    let (scene, view) = fan();
    let settings =
        Settings { samples: Samples::Sixteen, light: LightAt::Sample, ..Settings::default() };
    let lit = shiny(&scattered(40, 23), SIDE);
    for (scene, view) in [(scene, view), lit] {
        let plan = plan_frame(&Shot::new(&scene, &view, &settings, Size::new(SIDE, SIDE)));
        let mut wanted = None;
        for level in marraztu_lab::instructions::levels() {
            for threads in [1, 3] {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                let picture = pool.install(|| Renderer::new(level).render(&plan).clone());
                let wanted = wanted.get_or_insert_with(|| picture.clone());
                assert!(*wanted == picture, "{level:?} {threads}");
            }
        }
    }
}

/// The indices of a pixel and its neighbours.
fn around(i: usize, side: usize) -> impl Iterator<Item = usize> {
    let (x, y) = (i % side, i / side);
    let near = move |i: usize| i.saturating_sub(1)..(i + 2).min(side);
    near(y).flat_map(move |y| near(x).map(move |x| y * side + x))
}

#[test]
fn away_from_edges_a_picture_is_the_same_with_any_number_of_samples() {
    let leaning = at(70.0, 10.0, 5.0, 0.0) * DMat4::from_rotation_y(0.6);
    let (scene, view) = scene(&[(square(), leaning), (ball(4), at(60.0, -40.0, 20.0, 30.0))]);
    let view = View { marks: false, ..view };
    let mut renderer = Renderer::default();
    let plan = |samples| {
        let settings = Settings { samples, ..Settings::default() };
        plan_frame(&Shot::new(&scene, &view, &settings, Size::new(200, 200)))
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

/// A fan of triangles thinner than a pixel, with corner colours from 80 to 160.
fn fan() -> (Scene, View) {
    let mut source = MeshSource::of_polygons([], vec![3; 400]);
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
            source.corners.push(SourceCorner::bare(position));
            source.positions.push(place);
            source.colors.push(color);
        }
    }
    let (mut scene, view) = scene(&[(model_of("fan", source), at(110.0, 0.0, 0.0, 0.0))]);
    edit(&mut scene, ObjectId(10), |object| {
        object.surface = Surface::Texture;
        object.sides = Sides::Two;
    });
    scene.background = Color([120; 3]);
    (scene, View { marks: false, ..view })
}

#[test]
fn no_colour_leaves_the_range_of_its_corners() {
    let (scene, view) = fan();
    for samples in [Samples::Four, Samples::Sixteen, Samples::SixtyFour] {
        let lights = [LightAt::Pixel, LightAt::Sample];
        let all = [Arithmetic::F32, Arithmetic::F64].into_iter();
        for (arithmetic, light) in all.flat_map(|it| lights.map(|light| (it, light))) {
            let settings = Settings { samples, arithmetic, light, ..Settings::default() };
            let picture = draw(&scene, &view, &settings, 160);
            let differ = |pixel: &&[u8; 4]| pixel[0] != 120;
            assert!(picture.pixels().iter().filter(differ).count() > 2000);
            let outside = picture.pixels().iter().find(|pixel| !(80..=160).contains(&pixel[0]));
            assert_eq!(outside, None, "{samples:?} {arithmetic:?} {light:?}");
        }
    }
}

#[test]
fn the_more_samples_the_nearer_to_the_reference() {
    let (scene, view) = marraztu_io::default_scene();
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

/// Compares sums with one picture for each of the 256 positions, with all corners moved the other
/// way by whole subpixels, which keeps the mean exact.
#[test]
fn the_reference_of_samples_is_the_mean_of_256_positions() {
    let triangles = scattered(60, 256);
    let (mut scene, view) = flat::scene(std::slice::from_ref(&triangles), SIDE);
    scene.background = Color([9, 99, 199]);
    let shot = Shot::new(&scene, &view, &Settings::default(), Size::new(SIDE, SIDE));
    let light = LightAt::Sample;
    let settings = Settings { samples: Samples::TwoFiftySix, light, ..Settings::default() };
    let picture = Studio::new(shot).rendering(&settings);
    let mut pixels = vec![Vec::new(); SIDE * SIDE];
    for i in 0..256 {
        let place = [i % 16, i / 16].map(|i| (f64::from(i) + 0.5) / 16.0);
        let one = drawn(&seen_from(&triangles, place), |view| view, &Settings::default());
        pixels.iter_mut().zip(one.pixels()).for_each(|(all, pixel)| all.push(*pixel));
    }
    let mixed = pixels.iter().filter(|all| all.iter().any(|pixel| *pixel != all[0])).count();
    assert!(mixed > 1000, "{mixed}");
    wants_means(picture.picture(), &pixels, "256 samples");
}

#[test]
fn picking_takes_the_polygon_that_most_samples_show() {
    // The right border of the square is 1/4, then 3/4 of a pixel into its pixel.
    for (part, seen) in [(0.25, false), (0.75, true)] {
        let border = Snapped { x: 64 * 256 + (part * 256.0) as i32, y: 0 };
        let below = Snapped { y: 128 * 256, ..border };
        let corners = [Snapped { x: 0, y: 0 }, Snapped { x: 0, y: 128 * 256 }];
        let halves = [[corners[0], border, below], [corners[0], below, corners[1]]];
        let (scene, view) = flat::scene(&[halves.map(Flat::new).to_vec()], SIDE);
        for samples in [Samples::Four, Samples::Sixteen, Samples::SixtyFour] {
            let settings = Settings { samples, ..Settings::default() };
            let mut renderer = Renderer::default();
            renderer.render(&plan_frame(&Shot::new(
                &scene,
                &view,
                &settings,
                Size::new(SIDE, SIDE),
            )));
            let hit = renderer.hit(64, 20).map(|hit| hit.item);
            assert_eq!(hit, seen.then_some(ItemId::Object(ObjectId(1))), "{samples:?} {part}");
            assert!(renderer.hit(63, 20).is_some() && renderer.hit(65, 20).is_none());
        }
    }
}

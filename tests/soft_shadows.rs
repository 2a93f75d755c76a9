//! Lights with an extent, and the sky: borders as wide and as dark as geometry says, the same by
//! every way of drawing, and no work for lights without an extent.
//!
//! Catches: borders of another width, light that is lost or gained by sampling, a size that works
//! without shadows, other shadows in f32 than in f64, old shadows after a change, points that shade
//! themselves.

#![expect(clippy::unwrap_used, reason = "a helper of tests that fails is a test that fails")]

mod common;

use common::{at, ball, draw, edit, scene, square};
use glam::{DMat4, DVec3};
use marraztu_core::accuracy::{
    Arithmetic, LightAt, LightSamples, Samples, Settings, ShadowMethod, Shot,
};
use marraztu_core::base::color::Color;
use marraztu_core::base::image::{Picture, Size};
use marraztu_core::edit::lighting;
use marraztu_core::scene::{
    Attenuation, Light, LightId, LightKind, List, Material, MaterialChoice, ObjectId, Projection,
    Scene, Sides, Tracked, View,
};
use marraztu_io as io;
use marraztu_render::screen::coverage::PixelBox;
use marraztu_render::{Effect, Renderer, explain_frame, plan_frame};

/// Sets the only light of a scene.
fn light(scene: &mut Scene, kind: LightKind, size: f64) {
    let attenuation = Attenuation { constant: 1.0, linear: 0.0, quadratic: 0.0 };
    let light = Light { shadows: true, size, attenuation, ..Light::new("light", 0, kind) };
    scene.lights = List::from_iter([(LightId(500), light)]);
}

fn sun(towards: DVec3) -> LightKind {
    LightKind::Sun { direction: Tracked::new(-towards.normalize_or_zero()) }
}

fn bulb(place: DVec3) -> LightKind {
    LightKind::Bulb { position: Tracked::new(place), orbit: Default::default() }
}

fn with(samples: LightSamples) -> Settings {
    Settings { light_samples: samples, ..Settings::default() }
}

/// White paper in the plane z = 0 that fills the picture, under a screen at z = 200 that covers
/// x < 0.
fn screen() -> (Scene, View) {
    let over = DMat4::from_translation(DVec3::new(-3000.0, 0.0, 200.0))
        * DMat4::from_scale(DVec3::splat(3000.0));
    let (mut scene, view) = scene(&[(square(), at(3000.0, 0.0, 0.0, 0.0)), (square(), over)]);
    let paper = Material::matte([0.0; 3], [0.8; 3]);
    for id in [10, 11] {
        edit(&mut scene, ObjectId(id), |object| {
            object.material = MaterialChoice::Own(paper);
            object.sides = Sides::Two;
        });
    }
    (scene, View { projection: Projection::Orthographic, marks: false, ..view })
}

/// The mean of a column of a picture, as a factor of 255.
fn column(picture: &Picture, x: usize) -> f64 {
    let Size { height, .. } = picture.size();
    (0..height).map(|y| f64::from(picture.pixel(x, y)[0])).sum::<f64>() / 255.0 / height as f64
}

/// The place in the world of a column of pixels that shows the paper from above.
fn place_of(scene: &Scene, view: &View, side: usize, x: usize) -> f64 {
    let lens = scene.cameras.get(view.camera).unwrap().lens;
    // A picture is twice half_size wide in orthographic projection.
    ((x as f64 + 0.5) / side as f64 * 2.0 - 1.0) * lens.half_size
}

/// The part of a disk of radius 1 beyond a line at this distance from its centre.
fn segment(x: f64) -> f64 {
    let x = x.clamp(-1.0, 1.0);
    (x.acos() - x * (1.0 - x * x).sqrt()) / std::f64::consts::PI
}

#[test]
fn the_border_of_a_straight_edge_is_the_part_of_the_sun_that_is_seen() {
    const SIDE: usize = 200;
    let (mut scene, view) = screen();
    // The sun is straight above and 12 degrees wide: 21 units on either side at a height of 200.
    light(&mut scene, sun(DVec3::Z), 12.0);
    let radius = 200.0 * 6.0_f64.to_radians().tan();
    let picture = draw(&scene, &view, &with(LightSamples::TwoFiftySix), SIDE);
    let mut seen = 0;
    for x in 0..SIDE {
        let place = place_of(&scene, &view, SIDE, x);
        // The screen itself is seen on the left.
        if place < 0.5 {
            continue;
        }
        let expected = 0.8 * segment(-place / radius);
        let got = column(&picture, x);
        assert!((got - expected).abs() < 0.01, "{place}: {got}, not {expected}");
        seen += usize::from(place < radius);
    }
    assert!(seen > 2, "{seen} columns lie in the border");
}

#[test]
fn without_anything_in_between_a_small_ball_lights_like_a_point() {
    let (mut scene, view) = screen();
    edit(&mut scene, ObjectId(11), |object| object.visible = false);
    for kind in [sun(DVec3::new(0.3, 0.2, 1.0)), bulb(DVec3::new(10.0, 5.0, 90.0))] {
        light(&mut scene, kind.clone(), 0.0);
        let point = draw(&scene, &view, &Settings::default(), 64);
        light(&mut scene, kind, 2.0);
        let ball = draw(&scene, &view, &with(LightSamples::SixtyFour), 64);
        for (a, b) in point.pixels().iter().zip(ball.pixels()) {
            assert!(a[0] > 10 && a[0].abs_diff(b[0]) <= 1, "{a:?} {b:?}");
        }
    }
}

#[test]
fn more_samples_come_closer_and_the_mean_stays() {
    let (mut scene, view) = screen();
    light(&mut scene, sun(DVec3::Z), 30.0);
    let exact = draw(&scene, &view, &with(LightSamples::TwoFiftySix), 160);
    let mut last = f64::INFINITY;
    for samples in [LightSamples::Four, LightSamples::Sixteen, LightSamples::SixtyFour] {
        let picture = draw(&scene, &view, &with(samples), 160);
        let pairs = picture.pixels().iter().zip(exact.pixels());
        let off = pairs.map(|(a, b)| f64::from(a[0]) - f64::from(b[0]));
        let (sum, squares) =
            off.fold((0.0, 0.0), |(sum, squares), off| (sum + off, squares + off * off));
        let count = picture.pixels().len() as f64;
        // Where all of the sun is seen, the exact picture rounds 200.52 to 201 everywhere.
        assert!((sum / count).abs() < 0.6, "{samples:?}: {}", sum / count);
        let rms = (squares / count).sqrt();
        assert!(rms < last / 1.8, "{samples:?}: {rms} after {last}");
        last = rms;
    }
}

/// 256 samples of a light for each of 16 samples of a pixel would be 4096 rays.
#[test]
fn samples_of_a_pixel_that_are_lit_one_by_one_share_the_samples_of_a_light() {
    let (mut scene, view) = screen();
    light(&mut scene, sun(DVec3::new(1.0, 0.0, 2.0)), 90.0);
    let drawn = |samples, light_samples, at| {
        let settings = Settings { samples, light_samples, light: at, ..Settings::default() };
        draw(&scene, &view, &settings, 32)
    };
    let by_sample = |samples, of| drawn(samples, of, LightAt::Sample);
    for (samples, shared) in [
        (Samples::Sixteen, LightSamples::TwoFiftySix),
        (Samples::SixtyFour, LightSamples::SixtyFour),
    ] {
        let each = by_sample(samples, LightSamples::Sixteen);
        assert!(by_sample(samples, shared) == each, "{samples:?} {shared:?}");
    }
    // A fourth of 256 is more than 16, fewer than 16 stay as they are, and light at pixels has all
    // of its samples.
    let [few, some, many] = [LightSamples::Four, LightSamples::Sixteen, LightSamples::TwoFiftySix]
        .map(|of| by_sample(Samples::Four, of));
    assert!(few != some && some != many);
    let whole = |of| drawn(Samples::Sixteen, of, LightAt::Pixel);
    assert!(whole(LightSamples::TwoFiftySix) != whole(LightSamples::Sixteen));
}

#[test]
fn the_noise_of_neighbours_cancels_and_windows_have_that_of_the_whole() {
    let (mut scene, view) = screen();
    light(&mut scene, sun(DVec3::new(1.0, 0.0, 2.0)), 90.0);
    let side = 128;
    let [few, many] = [LightSamples::Four, LightSamples::TwoFiftySix]
        .map(|samples| draw(&scene, &view, &with(samples), side));
    // The mean square of the error of squares of pixels.
    let error = |of: usize| {
        let squares =
            (0..side).step_by(of).flat_map(|y| (0..side).step_by(of).map(move |x| (x, y)));
        let errors = squares.map(|(x, y)| {
            let pixels = (0..of * of).map(|i| [x + i % of, y + i / of]);
            let one =
                |[x, y]: [usize; 2]| f64::from(few.pixel(x, y)[1]) - f64::from(many.pixel(x, y)[1]);
            pixels.map(one).sum::<f64>() / (of * of) as f64
        });
        let errors: Vec<f64> = errors.collect();
        errors.iter().map(|error| error * error).sum::<f64>() / errors.len() as f64
    };
    // Independent errors of 16 pixels would leave a sixteenth.
    let (pixels, squares) = (error(1), error(4));
    assert!(pixels > 1.0 && squares < pixels / 40.0, "{pixels} {squares}");
    // A window that begins anywhere.
    for at in [LightAt::Pixel, LightAt::Sample] {
        let settings = Settings { light: at, samples: Samples::Four, ..with(LightSamples::Four) };
        let plan = plan_frame(&Shot::new(&scene, &view, &settings, Size::new(side, side)));
        let whole = Renderer::default().render(&plan).clone();
        let window = PixelBox { left: 37, top: 50, right: 101, bottom: 83 };
        let part = Renderer::default().render_window(&plan, window, &|| true).unwrap();
        for (i, pixel) in part.pixels().iter().enumerate() {
            assert_eq!(*pixel, whole.pixel(37 + i % 64, 50 + i / 64), "{at:?} {i}");
        }
    }
}

#[test]
fn pictures_count_the_rays_of_all_of_their_samples() {
    let (mut scene, view) = screen();
    light(&mut scene, sun(DVec3::new(1.0, 0.0, 2.0)), 2.0);
    let rays = |scene: &Scene, samples, light| {
        let settings = Settings { samples, light, ..Settings::default() };
        let mut renderer = Renderer::default();
        renderer.render(&plan_frame(&Shot::new(scene, &view, &settings, Size::new(32, 32))));
        renderer.rays().traced
    };
    let one = rays(&scene, Samples::One, LightAt::Pixel);
    assert!(one > 0);
    // Each sample has sixteen samples of the light, like a pixel of its own.
    let four = rays(&scene, Samples::Four, LightAt::Sample) as f64 / one as f64;
    assert!((3.0..5.0).contains(&four), "{four}");
    let ideal = rays(&scene, Samples::TwoFiftySix, LightAt::Sample) as f64 / one as f64;
    assert!((190.0..320.0).contains(&ideal), "{ideal}");
}

#[test]
fn points_hard_methods_and_lights_without_shadows_ignore_the_size() {
    let opened = io::lesson_scene("soft").unwrap();
    let mut hard = opened.scene.clone();
    let change = |scene: &mut Scene, to: fn(&mut Light)| {
        let lights = scene.lights.iter().map(|(id, light)| {
            let mut light = light.clone();
            to(&mut light);
            (id, light)
        });
        scene.lights = List::from_iter(lights.collect::<Vec<_>>());
    };
    change(&mut hard, |light| light.size = 0.0);
    let one = with(LightSamples::One);
    let map = Settings { shadow_method: ShadowMethod::Map2048, ..Settings::default() };
    for settings in [one, map] {
        let soft = draw(&opened.scene, &opened.view, &settings, 96);
        assert_eq!(soft, draw(&hard, &opened.view, &settings, 96), "{settings:?}");
    }
    let (mut off, mut off_hard) = (opened.scene.clone(), hard.clone());
    change(&mut off, |light| light.shadows = false);
    change(&mut off_hard, |light| light.shadows = false);
    let settings = Settings::default();
    let unshaded = draw(&off, &opened.view, &settings, 96);
    assert_eq!(unshaded, draw(&off_hard, &opened.view, &settings, 96));
    assert_ne!(
        draw(&opened.scene, &opened.view, &settings, 96),
        draw(&hard, &opened.view, &settings, 96)
    );
}

#[test]
fn both_arithmetics_and_all_ways_of_drawing_have_the_same_borders() {
    let opened = io::lesson_scene("soft").unwrap();
    let exact = Settings { arithmetic: Arithmetic::F64, ..Settings::default() };
    let single = draw(&opened.scene, &opened.view, &Settings::default(), 96);
    let double = draw(&opened.scene, &opened.view, &exact, 96);
    let beyond = single.pixels().iter().zip(double.pixels());
    let beyond = beyond.filter(|(a, b)| (0..3).any(|i| a[i].abs_diff(b[i]) > 1)).count();
    assert!(beyond < 10, "{beyond} pixels differ");
    for light in [LightAt::Face, LightAt::Vertex, LightAt::Sample] {
        let settings = Settings { light, samples: Samples::Four, ..Settings::default() };
        let size = Size::new(96, 96);
        let plan = plan_frame(&Shot::new(&opened.scene, &opened.view, &settings, size));
        let one = Renderer::default().render(&plan).clone();
        let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build().unwrap();
        assert_eq!(one, pool.install(|| Renderer::default().render(&plan).clone()), "{light:?}");
    }
}

#[test]
fn a_smooth_ball_does_not_shade_itself_in_specks() {
    let (mut scene, view) = scene(&[(ball(24), at(60.0, 0.0, 0.0, 0.0))]);
    let paint = MaterialChoice::Own(Material::matte([0.0; 3], [0.9; 3]));
    edit(&mut scene, ObjectId(10), |object| object.material = paint);
    // Light from behind the observer: the whole visible side is lit.
    light(&mut scene, bulb(DVec3::new(0.0, 0.0, 800.0)), 100.0);
    let view = View { marks: false, ..view };
    let soft = draw(&scene, &view, &Settings::default(), 128);
    light(&mut scene, bulb(DVec3::new(0.0, 0.0, 800.0)), 0.0);
    let hard = draw(&scene, &view, &Settings::default(), 128);
    // Near the outline, a part of the light is below the horizon.
    let centre = |i: usize| {
        let (x, y) = (i as f64 % 128.0 - 63.5, (i / 128) as f64 - 63.5);
        x.hypot(y) < 20.0
    };
    let off = soft.pixels().iter().zip(hard.pixels()).enumerate().filter(|(i, _)| centre(*i));
    let most = off.map(|(_, (a, b))| a[0].abs_diff(b[0])).max().unwrap();
    assert!(most <= 4, "{most}");
}

#[test]
fn after_a_change_the_picture_is_that_of_a_new_renderer() {
    let (mut scene, view) = screen();
    light(&mut scene, sun(DVec3::new(0.2, 0.1, 1.0)), 15.0);
    let plan = |scene: &Scene| {
        plan_frame(&Shot::new(scene, &view, &Settings::default(), Size::new(120, 120)))
    };
    let mut renderer = Renderer::default();
    renderer.render(&plan(&scene));
    type Edit = fn(&mut Scene);
    let edits: [Edit; 3] = [
        |scene| {
            edit(scene, ObjectId(11), |it| it.placement = Tracked::new(at(30.0, 9.0, 0.0, 25.0)));
        },
        |scene| light(scene, sun(DVec3::new(0.2, 0.1, 1.0)), 4.0),
        |scene| light(scene, sun(DVec3::new(0.2, 0.1, 1.0)), 0.0),
    ];
    for (i, change) in edits.into_iter().enumerate() {
        change(&mut scene);
        renderer.redraw(&plan(&scene), &|| true).unwrap();
        assert_eq!(renderer.picture(), Renderer::default().render(&plan(&scene)), "change {i}");
    }
}

#[test]
fn the_plan_tells_soft_shadows_from_hard_ones() {
    let opened = io::lesson_scene("soft").unwrap();
    let of = |settings: Settings| {
        let size = Size::new(64, 64);
        let (_, uses) = explain_frame(&Shot::new(&opened.scene, &opened.view, &settings, size));
        let shadows = |row: &&marraztu_render::EffectUse| matches!(row.effect, Effect::Shadows(_));
        uses.iter().filter(shadows).map(|row| row.state.why().to_owned()).collect::<Vec<_>>()
    };
    assert!(of(Settings::default()).iter().all(|why| why == "soft, 16 samples"));
    assert!(of(with(LightSamples::One)).iter().all(|why| why == "exact"));
}

/// Sets the only light of a scene to a sky.
fn sky(scene: &mut Scene, above: u8, below: u8, shadows: bool) {
    let kind = LightKind::Sky { ground: Color([below; 3]), panorama: None };
    let color = Color([above; 3]);
    let light = Light { shadows, color, ..Light::new("sky", 0, kind) };
    scene.lights = List::from_iter([(LightId(500), light)]);
}

#[test]
fn a_surface_that_nothing_hides_sees_the_parts_of_the_sky_by_its_tilt() {
    for degrees in [0.0_f64, 35.0, 90.0, 160.0] {
        // At 0 degrees the paper faces the observer and the horizon, at 90 the zenith.
        let turn = DMat4::from_rotation_x(-degrees.to_radians() * 0.8);
        let (mut scene, view) = scene(&[(square(), turn * at(300.0, 0.0, 0.0, 0.0))]);
        edit(&mut scene, ObjectId(10), |object| {
            object.material = MaterialChoice::Own(Material::matte([0.0; 3], [0.8; 3]));
            object.sides = Sides::Two;
        });
        let view = View { marks: false, ..view };
        for shadows in [false, true] {
            sky(&mut scene, 200, 40, shadows);
            let [grey, ..] = draw(&scene, &view, &Settings::default(), 64).pixel(32, 32);
            let normal = turn.transform_vector3(DVec3::Z);
            let up = if normal.z < 0.0 { -normal.y } else { normal.y };
            let expected = 0.8 * (40.0 + (200.0 - 40.0) * (1.0 + up) / 2.0);
            assert!((f64::from(grey) - expected).abs() <= 1.0, "{degrees}: {grey}, {expected}");
        }
    }
}

#[test]
fn a_long_wall_hides_the_part_of_the_sky_that_geometry_says() {
    const SIDE: usize = 200;
    const HEIGHT: f64 = 200.0;
    // A wall along Y that rises from the paper towards the observer, left of the middle.
    let wall = DMat4::from_translation(DVec3::new(0.0, 0.0, HEIGHT / 2.0))
        * DMat4::from_rotation_y(std::f64::consts::FRAC_PI_2)
        * DMat4::from_scale(DVec3::new(HEIGHT / 2.0, 30_000.0, 1.0));
    let (mut scene, view) = scene(&[(square(), at(3000.0, 0.0, 0.0, 0.0)), (square(), wall)]);
    for id in [10, 11] {
        edit(&mut scene, ObjectId(id), |object| {
            object.material = MaterialChoice::Own(Material::matte([0.0; 3], [0.8; 3]));
            object.sides = Sides::Two;
        });
    }
    let view = View { projection: Projection::Orthographic, marks: false, ..view };
    sky(&mut scene, 255, 255, true);
    let picture = draw(&scene, &view, &with(LightSamples::TwoFiftySix), SIDE);
    for x in (SIDE / 2 + 2..SIDE).step_by(7) {
        let place = place_of(&scene, &view, SIDE, x);
        let expected = 0.8 * (1.0 + place / place.hypot(HEIGHT)) / 2.0;
        let got = column(&picture, x);
        assert!((got - expected).abs() < 0.01, "{place}: {got}, not {expected}");
    }
}

#[test]
fn a_studio_replaces_the_lights_and_leaves_no_surface_white() {
    let (mut scene, view) = scene(&[(ball(16), at(60.0, 0.0, 0.0, 0.0))]);
    let paint = MaterialChoice::Own(Material::matte([0.2; 3], [1.0; 3]));
    edit(&mut scene, ObjectId(10), |object| object.material = paint);
    let before = scene.clone();
    let command = lighting::studio(&scene, &view).unwrap();
    let undo = command.apply(&mut scene).unwrap();
    assert_eq!(scene.lights.len(), 2);
    assert!(scene.lights.iter().all(|(_, light)| light.is_soft()));
    let view = View { marks: false, ..view };
    let picture = draw(&scene, &view, &Settings::default(), 96);
    let most = picture.pixels().iter().flat_map(|pixel| &pixel[..3]).max().unwrap();
    assert!((200..=250).contains(most), "{most}");
    undo.apply(&mut scene).unwrap();
    assert_eq!(scene.lights, before.lights);
}

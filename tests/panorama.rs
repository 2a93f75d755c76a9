//! Panoramas: the background, the light on surfaces, what mirrors show, and files.
//!
//! Catches: a picture that is mirrored, turned the wrong way or upside down, light of another
//! strength than the integral over the picture, a background that depends on samples or the way of
//! drawing, an old background after a change, a lost file.

#![allow(clippy::cast_possible_truncation, reason = "light is kept in f32")]
#![expect(clippy::unwrap_used, reason = "a helper of tests that fails is a test that fails")]

mod common;

use common::{at, ball, draw, edit, scene, square};
use glam::{DMat4, DVec3};
use marraztu_core::accuracy::{
    Arithmetic, LightAt, LightSamples, LightValues, Samples, Settings, Shot,
};
use marraztu_core::base::color::{Color, byte, encoded, linear, linear_factors};
use marraztu_core::base::image::{Picture, Size};
use marraztu_core::edit::lighting;
use marraztu_core::scene::{
    Camera, Command, Item, Light, LightId, LightKind, List, Material, MaterialChoice, ObjectId,
    Optics, Panorama, Projection, Reflection, Scene, Sides, SkyPanorama, Transmission, View,
};
use marraztu_io as io;
use marraztu_render::{Renderer, plan_frame, without_ground};

const ROWS: usize = 64;

/// The light from a direction.
type SkyLight<'a> = &'a dyn Fn(DVec3) -> [f64; 3];

/// The direction of a texel: the middle of the picture is -Z, its right half +X, its upper edge +Y.
fn direction(column: usize, row: usize) -> DVec3 {
    let turn = std::f64::consts::PI * ((column as f64 + 0.5) / ROWS as f64 - 1.0);
    let fall = std::f64::consts::PI * (row as f64 + 0.5) / ROWS as f64;
    DVec3::new(fall.sin() * turn.sin(), fall.cos(), -fall.sin() * turn.cos())
}

/// Paints a panorama by a function of the direction.
fn painted(light: impl Fn(DVec3) -> [f64; 3]) -> Panorama {
    let texels = (0..2 * ROWS * ROWS).map(|place| {
        light(direction(place % (2 * ROWS), place / (2 * ROWS))).map(|channel| channel as f32)
    });
    Panorama::new("evening.hdr", Size::new(2 * ROWS, ROWS), texels.collect(), true).unwrap()
}

/// A smooth sky without symmetry: red to the right, green above, blue in front.
fn smooth(d: DVec3) -> [f64; 3] {
    [0.3 + 0.25 * d.x + 0.1 * d.y * d.x, 0.3 + 0.2 * d.y, 0.4 - 0.3 * d.z]
}

/// Makes a panorama the only light of a scene.
fn shine(scene: &mut Scene, panorama: Panorama, turn: f64, shadows: bool) {
    let panorama = Some(SkyPanorama { panorama: panorama.into(), turn, is_shown: true });
    let kind = LightKind::Sky { ground: Color::BLACK, panorama };
    let light = Light { shadows, ..Light::new("sky", 0, kind) };
    scene.lights = List::from_iter([(LightId(500), light)]);
}

fn in_linear() -> Settings {
    Settings { light_values: LightValues::Linear, ..Settings::default() }
}

/// The colour of light in a picture of linear light.
fn bytes(light: [f64; 3]) -> [u8; 3] {
    light.map(|channel| byte(encoded(channel)))
}

fn is_near(got: [u8; 4], want: [u8; 3]) -> bool {
    got.iter().zip(want).all(|(got, want)| got.abs_diff(want) <= 1)
}

/// Turns the camera about Y, anticlockwise seen from above, and tilts it up.
fn look(scene: &mut Scene, view: &View, [turn, up]: [f64; 2]) {
    let mut camera: Camera = scene.cameras.get(view.camera).unwrap().clone();
    let mut pose = *camera.pose.now();
    pose.axes = glam::DMat3::from_rotation_y(turn.to_radians())
        * glam::DMat3::from_rotation_x(up.to_radians());
    camera.pose = marraztu_core::scene::Tracked::new(pose);
    let item = Item::Camera(view.camera, Box::new(camera));
    Command::Replace(item).apply(scene).unwrap();
}

#[test]
fn the_background_is_what_lies_in_the_direction_of_a_pixel() {
    let (mut scene, view) = scene(&[]);
    let view = View { marks: false, ..view };
    shine(&mut scene, painted(smooth), 0.0, false);
    const SIDE: usize = 64;
    for turned in [[0.0, 0.0], [70.0, -20.0], [200.0, 50.0]] {
        look(&mut scene, &view, turned);
        let camera = scene.cameras.get(view.camera).unwrap();
        let (axes, tangent) = (camera.pose.now().axes, (camera.lens.half_angle.to_radians()).tan());
        let picture = draw(&scene, &view, &in_linear(), SIDE);
        for (x, y) in [(0, 0), (63, 0), (20, 40), (32, 32), (5, 60)] {
            let at = |i: usize| ((i as f64 + 0.5) / SIDE as f64 * 2.0 - 1.0) * tangent;
            let towards = axes * DVec3::new(at(x), -at(y), -1.0);
            let want = bytes(smooth(towards.normalize_or_zero()));
            assert!(is_near(picture.pixel(x, y), want), "{turned:?} {x} {y}: {want:?}");
        }
        // Without perspective, all pixels look the same way.
        let flat = View { projection: Projection::Orthographic, ..view.clone() };
        let flat = draw(&scene, &flat, &in_linear(), SIDE);
        let want = bytes(smooth(axes * DVec3::NEG_Z));
        assert!(is_near(flat.pixel(3, 50), want) && is_near(flat.pixel(60, 1), want));
    }
    // Stored values are shown as they are.
    look(&mut scene, &view, [0.0, 0.0]);
    let texels = vec![[0.2, 0.4, 0.6]; 8];
    let plain = Panorama::new("plain.png", Size::new(4, 2), texels, false).unwrap();
    shine(&mut scene, plain, 0.0, false);
    let picture = draw(&scene, &view, &Settings::default(), SIDE);
    assert!(picture.pixels().iter().all(|pixel| *pixel == [51, 102, 153, 255]));
}

#[test]
fn a_turned_panorama_is_seen_by_a_camera_turned_with_it() {
    let (mut scene, view) = scene(&[]);
    let view = View { marks: false, ..view };
    shine(&mut scene, painted(smooth), 0.0, false);
    look(&mut scene, &view, [0.0, 10.0]);
    let before = draw(&scene, &view, &in_linear(), 48);
    shine(&mut scene, painted(smooth), 130.0, false);
    look(&mut scene, &view, [130.0, 10.0]);
    let after = draw(&scene, &view, &in_linear(), 48);
    let differ = |(a, b): (&[u8; 4], &[u8; 4])| a.iter().zip(b).any(|(a, b)| a.abs_diff(*b) > 1);
    assert!(!before.pixels().iter().zip(after.pixels()).any(differ));
}

/// The light that a surface of Kd 1 with this normal reflects: the mean over all directions in
/// front of it, by the cosine, summed texel by texel.
fn reflected(panorama: impl Fn(DVec3) -> [f64; 3], normal: DVec3) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for row in 0..ROWS {
        let edge = |row: usize| (std::f64::consts::PI * row as f64 / ROWS as f64).cos();
        let angle = (edge(row) - edge(row + 1)) * std::f64::consts::PI / ROWS as f64;
        for column in 0..2 * ROWS {
            let d = direction(column, row);
            for (sum, light) in sum.iter_mut().zip(panorama(d)) {
                *sum += light * d.dot(normal).max(0.0) * angle / std::f64::consts::PI;
            }
        }
    }
    sum
}

#[test]
fn a_surface_reflects_the_light_of_the_half_that_it_faces() {
    let bright = |d: DVec3| if d.x > 0.97 { [20.0, 15.0, 10.0] } else { smooth(d) };
    // The error of three bands is 3/32 of a lamp that stands in the plane of the surface.
    let lamp = reflected(|d| if d.x > 0.97 { [20.0; 3] } else { [0.0; 3] }, DVec3::X)[0];
    let skies: [(SkyLight<'_>, f64); 2] = [(&smooth, 0.003), (&bright, 0.1 * lamp)];
    for (degrees, turn) in [(0.0_f64, 0.0_f64), (35.0, 0.0), (60.0, 90.0), (-50.0, 200.0)] {
        let tilt = DMat4::from_rotation_x(-degrees.to_radians());
        let (mut scene, view) = scene(&[(square(), tilt * at(300.0, 0.0, 0.0, 0.0))]);
        edit(&mut scene, ObjectId(10), |object| {
            object.material = MaterialChoice::Own(Material::matte([0.0; 3], [0.9; 3]));
        });
        let view = View { marks: false, ..view };
        let normal = tilt.transform_vector3(DVec3::Z);
        for (sky, tolerance) in skies {
            // Turning the picture is turning the normal back.
            let back = glam::DMat3::from_rotation_y(-turn.to_radians()) * normal;
            // In linear light, coefficients are decoded, too.
            let want = reflected(sky, back).map(|light| linear(0.9) * light);
            for shadows in [false, true] {
                shine(&mut scene, painted(sky), turn, shadows);
                let got = draw(&scene, &view, &in_linear(), 64).pixel(32, 32);
                for (got, want) in got.iter().zip(want).take(3) {
                    let got = linear_factors()[usize::from(*got)];
                    let far = (got - want.min(1.0)).abs();
                    assert!(far < tolerance + 0.004, "{degrees} {turn}: {got}, {want}");
                }
            }
        }
    }
}

/// A mirror, or a plain surface, that fills the picture.
fn facing(optics: Optics) -> (Scene, View) {
    let (mut scene, view) = scene(&[(square(), at(300.0, 0.0, 0.0, 0.0))]);
    edit(&mut scene, ObjectId(10), |object| {
        let plain = Material::matte([0.0; 3], [0.0; 3]);
        object.material = MaterialChoice::Own(Material { specular: [1.0; 3], optics, ..plain });
        object.sides = Sides::Two;
    });
    (scene, View { marks: false, ..view })
}

#[test]
fn a_mirror_shows_what_lies_behind_the_observer() {
    let mirror = Optics { reflection: Reflection::Constant, ..Optics::NONE };
    let (mut scene, view) = facing(mirror);
    // Shown or not, the mirror sees it.
    for is_shown in [true, false] {
        shine(&mut scene, painted(smooth), 0.0, false);
        if !is_shown {
            scene.hide_panoramas();
        }
        let picture = draw(&scene, &view, &in_linear(), 64);
        let tangent = scene.cameras.get(view.camera).unwrap().lens.half_angle.to_radians().tan();
        let edge = 63.0 / 64.0 * tangent;
        for (x, side) in [(0, -edge), (63, edge)] {
            let want = bytes(smooth(DVec3::new(side, -tangent / 64.0, 1.0).normalize_or_zero()));
            assert!(is_near(picture.pixel(x, 32), want), "{x}: {want:?}");
        }
    }
}

#[test]
fn glass_that_does_not_bend_shows_the_background() {
    let clear = Optics { transmission: Transmission::Filter([1.0; 3]), ..Optics::NONE };
    let (mut scene, view) = facing(clear);
    shine(&mut scene, painted(smooth), 0.0, false);
    let through = draw(&scene, &view, &in_linear(), 64);
    scene.objects = List::default();
    let without = draw(&scene, &view, &in_linear(), 64);
    let far = |(a, b): (&[u8; 4], &[u8; 4])| a.iter().zip(b).any(|(a, b)| a.abs_diff(*b) > 1);
    assert!(!through.pixels().iter().zip(without.pixels()).any(far));
}

#[test]
fn a_roof_hides_a_lamp_above_it_and_not_one_beside_it() {
    let lamp = |axis: DVec3| move |d: DVec3| if d.dot(axis) > 0.98 { [40.0; 3] } else { [0.02; 3] };
    // Paper that faces +Y below a roof, seen from the front and a little above.
    let flat = DMat4::from_rotation_x(-std::f64::consts::FRAC_PI_2);
    let floor =
        DMat4::from_translation(DVec3::new(0.0, -40.0, 0.0)) * flat * at(300.0, 0.0, 0.0, 0.0);
    let roof = DMat4::from_translation(DVec3::new(0.0, 60.0, 0.0)) * flat * at(80.0, 0.0, 0.0, 0.0);
    let (mut scene, view) = scene(&[(square(), floor), (square(), roof)]);
    for id in [10, 11] {
        edit(&mut scene, ObjectId(id), |object| {
            object.material = MaterialChoice::Own(Material::matte([0.0; 3], [0.8; 3]));
            object.sides = Sides::Two;
        });
    }
    let view = View { marks: false, ..view };
    let settings = Settings { light_samples: LightSamples::SixtyFour, ..in_linear() };
    // The floor below the middle of the roof.
    let shade = |scene: &Scene| {
        let picture = draw(scene, &view, &settings, 65);
        (28..37).map(|x| f64::from(picture.pixel(x, 39)[0])).sum::<f64>() / 9.0
    };
    for (axis, hidden) in [(DVec3::Y, true), (DVec3::new(1.0, 0.8, 0.0).normalize_or_zero(), false)]
    {
        shine(&mut scene, painted(lamp(axis)), 0.0, false);
        let open = shade(&scene);
        shine(&mut scene, painted(lamp(axis)), 0.0, true);
        let under = shade(&scene);
        assert!(if hidden { under < 0.3 * open } else { under > 0.85 * open }, "{under} {open}");
    }
}

#[test]
fn every_way_of_drawing_shows_the_same_background() {
    let (mut scene, view) = scene(&[(ball(12), at(60.0, 0.0, 0.0, 0.0))]);
    let view = View { marks: false, ..view };
    shine(&mut scene, painted(smooth), 15.0, false);
    let size = Size::new(150, 130);
    let whole = |settings: Settings| {
        let plan = plan_frame(&Shot::new(&scene, &view, &settings, size));
        Renderer::default().render(&plan).clone()
    };
    let corners =
        |picture: &Picture| [(0, 0), (149, 0), (70, 3), (0, 129)].map(|(x, y)| picture.pixel(x, y));
    let one = whole(Settings::default());
    for samples in [Samples::Four, Samples::Sixteen, Samples::SixtyFour] {
        for light in [LightAt::Vertex, LightAt::Pixel, LightAt::Sample] {
            let many = whole(Settings { samples, light, ..Settings::default() });
            for (a, b) in corners(&one).into_iter().zip(corners(&many)) {
                assert!(a.iter().zip(b).all(|(a, b)| a.abs_diff(b) <= 1), "{samples:?} {light:?}");
            }
        }
    }
    let f64 = whole(Settings { arithmetic: Arithmetic::F64, ..Settings::default() });
    assert_eq!(corners(&f64), corners(&one));
    // Flat faces are looked up, except in front of a panorama.
    let flat = whole(Settings { light: LightAt::Face, ..Settings::default() });
    assert_eq!(corners(&flat), corners(&one));
    // A transparent picture leaves it out.
    let mut renderer = Renderer::default();
    let cut = without_ground(&mut renderer, &Shot::new(&scene, &view, &Settings::default(), size));
    assert_eq!(cut.pixel(0, 0), [0; 4]);
    assert_eq!(cut.pixel(75, 65)[3], 255);
}

#[test]
fn changes_of_a_panorama_are_redrawn() {
    let (mut scene, view) = scene(&[(ball(12), at(60.0, 0.0, 0.0, 0.0))]);
    let view = View { marks: false, ..view };
    let mut renderer = Renderer::default();
    let other = |d: DVec3| smooth(-d);
    let changes: [&dyn Fn(&mut Scene); 6] = [
        &|scene| shine(scene, painted(smooth), 0.0, false),
        &|scene| shine(scene, painted(smooth), 40.0, true),
        &|scene| shine(scene, painted(other), 40.0, true),
        &|scene| scene.hide_panoramas(),
        &|scene| shine(scene, painted(smooth), 0.0, false),
        &|scene| scene.lights = List::default(),
    ];
    for samples in [Samples::One, Samples::Sixteen] {
        for (i, change) in changes.iter().enumerate() {
            change(&mut scene);
            let settings = Settings { samples, ..Settings::default() };
            let plan = plan_frame(&Shot::new(&scene, &view, &settings, Size::new(90, 70)));
            renderer.redraw(&plan, &|| true).unwrap();
            assert_eq!(renderer.picture(), Renderer::default().render(&plan), "change {i}");
        }
    }
}

#[test]
fn a_panorama_takes_the_place_of_all_lights_and_keeps_its_turn() {
    let (mut scene, view) = scene(&[]);
    let before = scene.lights.clone();
    let undo = lighting::panorama(&scene, &view, painted(smooth).into()).unwrap();
    let undo = undo.apply(&mut scene).unwrap();
    let [(id, light)] = scene.lights.iter().collect::<Vec<_>>()[..] else { panic!("one light") };
    assert!(light.shadows && light.kind.panorama().unwrap().is_shown);
    let turned = Light {
        kind: LightKind::Sky {
            ground: Color::BLACK,
            panorama: light.kind.panorama().cloned().map(|sky| SkyPanorama { turn: 25.0, ..sky }),
        },
        ..light.clone()
    };
    Command::Replace(Item::Light(id, Box::new(turned))).apply(&mut scene).unwrap();
    let other = Panorama::placeholder("other.hdr".into());
    let command = lighting::panorama(&scene, &view, other.into()).unwrap();
    command.apply(&mut scene).unwrap();
    let sky = scene.lights.get(id).unwrap().kind.panorama().unwrap().clone();
    assert_eq!((sky.turn, scene.lights.len()), (25.0, 1));
    assert_eq!(sky.panorama.source.to_str(), Some("other.hdr"));
    undo.apply(&mut scene).unwrap();
    assert_eq!(scene.lights, before);
}

#[test]
fn a_sky_that_is_off_or_black_shows_nothing_and_several_add_up() {
    let (mut scene, view) = scene(&[]);
    let view = View { marks: false, ..view };
    let pixel = |scene: &Scene| draw(scene, &view, &in_linear(), 16).pixel(8, 8);
    let sky = |light: f64| {
        let panorama = Some(SkyPanorama {
            panorama: painted(move |_| [light; 3]).into(),
            turn: 0.0,
            is_shown: true,
        });
        let kind = LightKind::Sky { ground: Color::BLACK, panorama };
        Light::new("sky", 0, kind)
    };
    let [r, g, b] = scene.background.0;
    for wrong in [Light { on: false, ..sky(0.5) }, Light { color: Color::BLACK, ..sky(0.5) }] {
        scene.lights = List::from_iter([(LightId(500), wrong)]);
        assert_eq!(pixel(&scene), [r, g, b, 255]);
    }
    scene.lights = List::from_iter([(LightId(500), sky(0.2)), (LightId(501), sky(0.3))]);
    assert!(is_near(pixel(&scene), bytes([0.5; 3])));
    // A panorama for a sky that is off switches it on; one that is lit comes first.
    let lights = [Light { on: false, ..sky(0.1) }, sky(0.3)];
    scene.lights = List::from_iter((500..).map(LightId).zip(lights).collect::<Vec<_>>());
    for (count, want) in [(2, 0.7), (1, 0.9)] {
        let panorama = painted(move |_| [want; 3]).into();
        lighting::panorama(&scene, &view, panorama).unwrap().apply(&mut scene).unwrap();
        assert!(is_near(pixel(&scene), bytes([want; 3])), "{want}");
        assert_eq!(scene.lights.iter().filter(|(_, light)| light.on).count(), 1);
        let kept = scene.lights.iter().take(count - 1).map(|(id, light)| (id, light.clone()));
        scene.lights = List::from_iter(kept.collect::<Vec<_>>());
    }
    // Locked lights stay.
    let mut locked = common::scene(&[]).0;
    let id = locked.lights.ids().next().unwrap();
    locked.locked.insert(marraztu_core::scene::ItemId::Light(id));
    assert!(lighting::panorama(&locked, &view, painted(smooth).into()).is_err());
}

#[test]
fn a_sharp_background_is_the_same_for_any_samples() {
    let (mut scene, view) = scene(&[(ball(8), at(40.0, 30.0, 10.0, 0.0))]);
    let view = View { marks: false, ..view };
    let board = |d: DVec3| [f64::from(u8::from((d.x * 40.0).sin() * (d.y * 40.0).sin() > 0.0)); 3];
    shine(&mut scene, painted(board), 0.0, false);
    let draw = |samples: Samples, light: LightAt| {
        draw(&scene, &view, &Settings { samples, light, ..Settings::default() }, 100)
    };
    let one = draw(Samples::One, LightAt::Pixel);
    for (samples, light) in [(Samples::Four, LightAt::Sample), (Samples::Sixteen, LightAt::Pixel)] {
        let many = draw(samples, light);
        for y in (0..100).filter(|y| !(25..75).contains(y)) {
            for x in 0..100 {
                let (a, b) = (one.pixel(x, y), many.pixel(x, y));
                let far = a.iter().zip(b).any(|(a, b)| a.abs_diff(b) > 1);
                assert!(!far, "{samples:?} {x} {y}: {a:?} {b:?}");
            }
        }
    }
}

#[test]
fn a_scene_file_keeps_its_panorama_even_if_the_picture_is_missing() {
    let folder = tempfile::tempdir().unwrap();
    let [picture, file] = ["sky.png", "a.marraztu"].map(|name| folder.path().join(name));
    image::RgbImage::from_pixel(8, 4, image::Rgb([10, 200, 30])).save(&picture).unwrap();
    let (mut scene, view) = scene(&[]);
    let view = View { light: Some(LightId(500)), ..view };
    shine(&mut scene, io::load_panorama(&picture).unwrap(), 33.0, true);
    scene.hide_panoramas();
    io::save(&file, &scene, &view, &Settings::default()).unwrap();
    let text = std::fs::read_to_string(&file).unwrap();
    assert!(text.contains("path: \"sky.png\"") && !text.contains("Some(("), "{text}");
    let opened = io::open(&file, &io::Progress::new()).unwrap();
    assert_eq!(opened.scene.lights, scene.lights);
    assert!(opened.findings.is_empty(), "{:?}", opened.findings);
    // The input is not overwritten by an output.
    assert!(io::Sources::of(&scene).spare(&picture).is_err());
    std::fs::remove_file(&picture).unwrap();
    let lost = io::open(&file, &io::Progress::new()).unwrap();
    assert_eq!(lost.findings.len(), 1, "{:?}", lost.findings);
    assert_eq!(lost.scene.missing_files().into_iter().collect::<Vec<_>>(), [&*picture]);
    io::save(&file, &lost.scene, &view, &Settings::default()).unwrap();
    let again = std::fs::read_to_string(&file).unwrap();
    assert!(again.contains("path: \"sky.png\"") && again.contains("turn: 33.0"), "{again}");
}

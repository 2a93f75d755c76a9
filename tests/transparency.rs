//! Transparent surfaces: alpha blending per pixel, independent of the order of objects and
//! triangles.

#![allow(clippy::unwrap_used, reason = "a test fails where there is nothing")]

mod common;

use common::{at, cube, draw, edit, scene, square};
use glam::{DMat4, DVec3};
use marraztu_core::accuracy::{LightAt, LightValues, Samples, Settings, Shot, Transparency};
use marraztu_core::base::image::{Picture, Size};
use marraztu_core::scene::{
    ItemId, Light, LightId, LightKind, List, Material, MaterialChoice, ObjectId, Scene, View,
};
use marraztu_render::{Bands, Renderer, Unseen, plan_frame, unseen, without_ground};

const SIDE: usize = 64;

/// A material with ambient light only, so other lights do not change its colour.
fn plain(color: [f64; 3]) -> MaterialChoice {
    let material = Material::matte(color, [0.0; 3]);
    MaterialChoice::Own(material)
}

/// Squares that face the eye, oldest first: z, colour and opacity.
fn sheets(all: &[(f64, [f64; 3], f64)]) -> (Scene, View) {
    let models: Vec<_> = all.iter().map(|(z, ..)| (square(), at(900.0, 0.0, 0.0, *z))).collect();
    let (mut scene, view) = scene(&models);
    scene.lights = List::from_iter([(LightId(1), Light::new("ambient", 0, LightKind::Ambient))]);
    for (id, (_, color, opacity)) in (10..).zip(all) {
        edit(&mut scene, ObjectId(id), |object| {
            object.material = plain(*color);
            object.opacity = *opacity;
        });
    }
    (scene, view)
}

/// Blends layers of colour and opacity over a background, farthest first, into bytes.
fn over(background: [u8; 3], layers: &[([f64; 3], f64)]) -> [u8; 4] {
    let channel = |i: usize| {
        let under = f64::from(background[i]);
        let sum = layers.iter().fold(under, |under, (color, opacity)| {
            opacity * color[i].clamp(0.0, 1.0) * 255.0 + (1.0 - opacity) * under
        });
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 255")]
        let byte = (sum + 0.5).floor() as u8;
        byte
    };
    [channel(0), channel(1), channel(2), 255]
}

fn middle(picture: &Picture) -> [u8; 4] {
    picture.pixel(SIDE / 2, SIDE / 2)
}

fn with(transparency: Transparency) -> Settings {
    Settings { transparency, ..Settings::default() }
}

const RED: [f64; 3] = [0.91, 0.1, 0.2];
const GREEN: [f64; 3] = [0.1, 0.8, 0.3];
const BLUE: [f64; 3] = [0.2, 0.3, 0.7];

#[test]
fn colour_is_laid_over_colour_the_farthest_first_whatever_their_order() {
    let all = [(-200.0, RED, 0.5), (-100.0, GREEN, 0.25), (0.0, BLUE, 0.75), (-300.0, GREEN, 1.0)];
    for turn in 0..all.len() {
        let mut turned = all;
        turned.rotate_left(turn);
        let (scene, view) = sheets(&turned);
        let picture = draw(&scene, &view, &Settings::default(), SIDE);
        let want =
            over(scene.background.0, &[(GREEN, 1.0), (RED, 0.5), (GREEN, 0.25), (BLUE, 0.75)]);
        assert!(picture.pixels().iter().all(|pixel| *pixel == want), "{turn}: {want:?}");
    }
}

#[test]
fn surfaces_behind_an_opaque_one_are_hidden() {
    let (scene, view) = sheets(&[(-200.0, RED, 0.5), (-100.0, GREEN, 1.0), (0.0, BLUE, 0.5)]);
    let want = over(scene.background.0, &[(GREEN, 1.0), (BLUE, 0.5)]);
    assert_eq!(middle(&draw(&scene, &view, &Settings::default(), SIDE)), want);
}

#[test]
fn a_threshold_draws_the_more_opaque_half_and_nothing_of_the_others() {
    let (scene, view) = sheets(&[(-100.0, RED, 0.5), (0.0, GREEN, 0.49)]);
    let settings = with(Transparency::Threshold);
    let want = over(scene.background.0, &[(RED, 1.0)]);
    assert_eq!(middle(&draw(&scene, &view, &settings, SIDE)), want);
}

#[test]
fn an_object_below_the_threshold_is_unseen_because_it_is_transparent() {
    let (scene, view) = sheets(&[(-100.0, RED, 0.49)]);
    let settings = with(Transparency::Threshold);
    let shot = Shot::new(&scene, &view, &settings, Size::new(SIDE, SIDE));
    let mut renderer = Renderer::default();
    renderer.render(&plan_frame(&shot));
    assert_eq!(unseen(&mut renderer, &shot), [(ObjectId(10), Unseen::Transparent)]);
}

#[test]
fn without_ground_a_pane_has_its_own_colour_and_opacity_in_any_values_of_light() {
    let (scene, view) = sheets(&[(0.0, [1.0, 0.0, 0.0], 0.5)]);
    for light_values in [LightValues::Stored, LightValues::Linear] {
        let settings = Settings { light_values, ..Settings::default() };
        let shot = Shot::new(&scene, &view, &settings, Size::new(SIDE, SIDE));
        let whole = without_ground(&mut Renderer::default(), &shot);
        let [r, g, b, alpha] = middle(&whole);
        assert_eq!([r, g, b], [255, 0, 0], "{light_values:?}");
        assert!((127..=128).contains(&alpha), "{light_values:?}: {alpha}");
        let band = Bands::new(&shot, true).draw_next(&|| true, &|_, _| {}).unwrap();
        assert!(band.unwrap() == whole, "{light_values:?}");
    }
}

#[test]
fn both_sides_of_a_transparent_body_are_seen() {
    let (mut scene, view) = scene(&[(cube(), at(60.0, 0.0, 0.0, 0.0))]);
    scene.lights = List::from_iter([(LightId(1), Light::new("ambient", 0, LightKind::Ambient))]);
    edit(&mut scene, ObjectId(10), |object| {
        object.material = plain(RED);
        object.opacity = 0.5;
    });
    let picture = draw(&scene, &view, &Settings::default(), SIDE);
    assert_eq!(middle(&picture), over(scene.background.0, &[(RED, 0.5), (RED, 0.5)]));
}

#[test]
fn sheets_that_cut_through_each_other_change_places_at_the_line_where_they_meet() {
    let turned =
        |angle: f64| DMat4::from_rotation_y(angle) * DMat4::from_scale(DVec3::splat(300.0));
    let (mut scene, view) = scene(&[(square(), turned(0.5)), (square(), turned(-0.5))]);
    scene.lights = List::from_iter([(LightId(1), Light::new("ambient", 0, LightKind::Ambient))]);
    for (id, color) in [(10, RED), (11, BLUE)] {
        edit(&mut scene, ObjectId(id), |object| {
            object.material = plain(color);
            object.opacity = 0.5;
        });
    }
    let picture = draw(&scene, &view, &Settings::default(), SIDE);
    // The right side of the first sheet leans away from the eye.
    let background = scene.background.0;
    let (left, right) = (
        over(background, &[(BLUE, 0.5), (RED, 0.5)]),
        over(background, &[(RED, 0.5), (BLUE, 0.5)]),
    );
    for y in 0..SIDE {
        for x in 0..SIDE {
            let want = if x < SIDE / 2 { left } else { right };
            assert_eq!(picture.pixel(x, y), want, "{x}, {y}");
        }
    }
}

#[test]
fn opacity_0_draws_nothing_and_1_is_opaque() {
    let nearly = 1.0 - 2.0_f64.powi(-24);
    for samples in Samples::ALL {
        let settings = Settings { samples, ..Settings::default() };
        let drawn = |opacity: f64| {
            let (scene, view) = sheets(&[(-100.0, GREEN, 1.0), (0.0, RED, opacity)]);
            draw(&scene, &view, &settings, SIDE)
        };
        let (scene, view) = sheets(&[(-100.0, GREEN, 1.0)]);
        assert!(drawn(0.0) == draw(&scene, &view, &settings, SIDE));
        let (scene, view) = sheets(&[(0.0, RED, 1.0)]);
        let opaque = draw(&scene, &view, &settings, SIDE);
        assert!(drawn(1.0) == opaque);
        assert!(drawn(nearly) == opaque);
    }
}

#[test]
fn a_thousand_layers_are_as_right_as_one() {
    let colors = [RED, GREEN, BLUE];
    let layers: Vec<_> = (0..1000)
        .map(|i| {
            (f64::from(i) * 0.3 - 300.0, colors[i as usize % 3], 0.003 + f64::from(i % 7) * 0.001)
        })
        .collect();
    let (scene, view) = sheets(&layers);
    let sorted: Vec<_> = layers.iter().map(|(_, color, opacity)| (*color, *opacity)).collect();
    let want = over(scene.background.0, &sorted);
    let got = draw(&scene, &view, &Settings::default(), 16).pixel(8, 8);
    assert!(got.iter().zip(want).all(|(got, want)| got.abs_diff(want) <= 1), "{got:?} {want:?}");
}

#[test]
fn the_older_of_two_sheets_in_one_plane_is_in_front() {
    let (scene, view) = sheets(&[(0.0, RED, 0.5), (0.0, BLUE, 0.5)]);
    let want = over(scene.background.0, &[(BLUE, 0.5), (RED, 0.5)]);
    assert_eq!(middle(&draw(&scene, &view, &Settings::default(), SIDE)), want);
}

#[test]
fn samples_light_and_objects_by_themselves_give_the_same_flat_sheets() {
    let (scene, view) = sheets(&[(-100.0, RED, 0.5), (0.0, BLUE, 0.25)]);
    let want = over(scene.background.0, &[(RED, 0.5), (BLUE, 0.25)]);
    for samples in Samples::ALL {
        for light in [LightAt::Face, LightAt::Vertex, LightAt::Pixel, LightAt::Sample] {
            for transparency in [Transparency::Exact, Transparency::Objects] {
                let settings = Settings { samples, light, transparency, ..Settings::default() };
                let got = middle(&draw(&scene, &view, &settings, SIDE));
                assert_eq!(got, want, "{samples:?} {light:?} {transparency:?}");
            }
        }
    }
}

#[test]
fn a_click_finds_the_nearest_surface_though_it_is_transparent() {
    let (scene, view) = sheets(&[(-100.0, RED, 1.0), (0.0, BLUE, 0.01), (50.0, GREEN, 0.0)]);
    let shot = Shot::new(&scene, &view, &Settings::default(), Size::new(SIDE, SIDE));
    let mut renderer = Renderer::default();
    renderer.render(&plan_frame(&shot));
    assert_eq!(renderer.hit(9, 9).unwrap().item, ItemId::Object(ObjectId(11)));
    for (id, seen) in [(10, true), (11, true), (12, false)] {
        let pixels = renderer.pixels_of(ItemId::Object(ObjectId(id)));
        assert!(pixels.iter().all(|own| *own == seen), "{id}");
    }
}

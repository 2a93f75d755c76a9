//! Shadows of glass: light that passes is multiplied by the filter of each surface, for lights at
//! points, balls and the sky.
//!
//! Catches: black shadows of glass, a filter that counts once for both sides of a body, twice for a
//! pane, or for surfaces beyond the light, other shadows in f32 than in f64, and old ones after a
//! change.

#![expect(clippy::unwrap_used, reason = "a helper of tests that fails is a test that fails")]

mod common;

use common::{at, ball, draw, edit, scene, square};
use glam::{DMat4, DVec3};
use marraztu_core::accuracy::{Arithmetic, Bounces, Samples, Settings, ShadowMethod, Shot};
use marraztu_core::base::Shared;
use marraztu_core::base::color::Color;
use marraztu_core::base::image::Size;
use marraztu_core::scene::{
    Attenuation, Command, Item, Light, LightId, LightKind, List, LoadOptions, Material,
    MaterialChoice, Model, ObjectId, Optics, Projection, Scene, Sides, Tracked, Transmission, View,
};
use marraztu_io as io;
use marraztu_render::{Renderer, plan_frame};

const SIDE: usize = 48;

/// Paper in the plane z = 0, under glass at z = 120 above x < 0, which the observer does not see.
fn under(glass: &[(Shared<Model>, DMat4)], transmission: Transmission) -> (Scene, View) {
    let mut models = vec![(square(), at(3000.0, 0.0, 0.0, 0.0))];
    models.extend(glass.iter().cloned());
    let (mut scene, view) = scene(&models);
    edit(&mut scene, ObjectId(10), |object| {
        object.material = MaterialChoice::Own(Material::matte([0.0; 3], [0.8; 3]));
        object.sides = Sides::Two;
    });
    for id in (11..).take(glass.len()) {
        edit(&mut scene, ObjectId(id), |object| {
            let optics = Optics { transmission, ..Optics::NONE };
            let clear = Material::matte([0.0; 3], [0.0; 3]);
            object.material = MaterialChoice::Own(Material { optics, ..clear });
            object.sides = Sides::Two;
        });
    }
    (scene, View { projection: Projection::Orthographic, marks: false, ..view })
}

/// A pane above x < 0 at this height.
fn pane(height: f64) -> (Shared<Model>, DMat4) {
    let place = DMat4::from_translation(DVec3::new(-3000.0, 0.0, height))
        * DMat4::from_scale(DVec3::splat(3000.0));
    (square(), place)
}

fn shine(scene: &mut Scene, kind: LightKind, size: f64) {
    let attenuation = Attenuation { constant: 1.0, linear: 0.0, quadratic: 0.0 };
    let light = Light { shadows: true, size, attenuation, ..Light::new("light", 0, kind) };
    scene.lights = List::from_iter([(LightId(500), light)]);
}

fn sun() -> LightKind {
    LightKind::Sun { direction: Tracked::new(DVec3::NEG_Z) }
}

/// Moves the observer below the glass.
fn from_below(scene: &Scene, view: &View) -> Scene {
    let mut scene = scene.clone();
    let mut camera = scene.cameras.get(view.camera).unwrap().clone();
    let mut pose = *camera.pose.now();
    pose.eye = DVec3::new(0.0, 0.0, 60.0);
    camera.pose = Tracked::new(pose);
    let camera = Item::Camera(view.camera, Box::new(camera));
    Command::Replace(camera).apply(&mut scene).unwrap();
    scene
}

/// The light on the paper below the glass, relative to that beside it. Glass between paper and
/// observer would dim it once more, so the observer is below the glass.
fn shares(scene: &Scene, view: &View, settings: &Settings) -> [f64; 3] {
    let seen = from_below(scene, view);
    let picture = draw(&seen, view, settings, SIDE);
    let [dim, open] = [SIDE / 8, SIDE - 1 - SIDE / 8].map(|x| picture.pixel(x, SIDE / 2));
    std::array::from_fn(|i| f64::from(dim[i]) / f64::from(open[i]))
}

fn are_near(got: [f64; 3], want: [f64; 3], tolerance: f64) -> bool {
    got.iter().zip(want).all(|(got, want)| (got - want).abs() < tolerance)
}

const GREEN: [f64; 3] = [0.5, 1.0, 0.25];

#[test]
fn each_pane_multiplies_the_light_by_its_filter() {
    let green = Transmission::Filter(GREEN);
    let squared = GREEN.map(|x| x * x);
    for (panes, want) in [(vec![pane(120.0)], GREEN), (vec![pane(120.0), pane(150.0)], squared)] {
        let (mut scene, view) = under(&panes, green);
        for arithmetic in [Arithmetic::F32, Arithmetic::F64] {
            let settings = Settings { arithmetic, ..Settings::default() };
            for (kind, size) in [(sun(), 0.0), (sun(), 2.0)] {
                shine(&mut scene, kind, size);
                let got = shares(&scene, &view, &settings);
                assert!(are_near(got, want, 0.01), "{arithmetic:?} {size}: {got:?}, {want:?}");
            }
        }
        // Without bounces, such a material is opaque. Maps let light pass undimmed.
        shine(&mut scene, sun(), 0.0);
        let opaque = Settings { bounces: Bounces::None, ..Settings::default() };
        assert_eq!(shares(&scene, &view, &opaque), [0.0; 3]);
        let maps = Settings { shadow_method: ShadowMethod::Map512, ..Settings::default() };
        assert_eq!(shares(&scene, &view, &maps), [1.0; 3]);
    }
}

#[test]
fn a_body_dims_light_on_both_sides_and_only_up_to_the_light() {
    let globe = (
        ball(24),
        DMat4::from_translation(DVec3::new(-375.0, 0.0, 160.0))
            * DMat4::from_scale(DVec3::splat(80.0)),
    );
    let (mut scene, view) = under(&[globe], Transmission::Filter(GREEN));
    shine(&mut scene, sun(), 0.0);
    let twice = GREEN.map(|x| x * x);
    let got = shares(&scene, &view, &Settings::default());
    assert!(are_near(got, twice, 0.01), "{got:?}");
    // A bulb between the paper and a pane is not dimmed by it.
    let bulb = LightKind::Bulb {
        position: Tracked::new(DVec3::new(0.0, 0.0, 100.0)),
        orbit: Default::default(),
    };
    let (mut scene, view) = under(&[pane(120.0)], Transmission::Filter(GREEN));
    shine(&mut scene, bulb, 0.0);
    let got = shares(&scene, &view, &Settings::default());
    assert!(are_near(got, [1.0; 3], 0.03), "{got:?}");
}

#[test]
fn a_pane_across_the_sky_filters_it() {
    let wide = DMat4::from_translation(DVec3::new(0.0, 0.0, 120.0))
        * DMat4::from_scale(DVec3::splat(200_000.0));
    let (mut scene, view) = under(&[(square(), wide)], Transmission::Filter(GREEN));
    let sky = LightKind::Sky { ground: Color::WHITE, panorama: None };
    shine(&mut scene, sky, 0.0);
    let picture = draw(&scene, &view, &Settings::default(), SIDE);
    let [r, g, b, _] = picture.pixel(SIDE / 2, SIDE / 2).map(f64::from);
    // The observer sees the paper through the pane, too.
    let want = [0.25, 1.0, 0.0625].map(|share| 0.8 * 255.0 * share);
    assert!(are_near([r, g, b], want, 3.0), "{r} {g} {b}, {want:?}");
}

#[test]
fn the_edge_between_two_triangles_of_a_pane_counts_once() {
    let whole = (
        square(),
        DMat4::from_translation(DVec3::new(0.0, 0.0, 120.0))
            * DMat4::from_scale(DVec3::splat(600.0)),
    );
    let (mut scene, view) = under(&[whole], Transmission::Filter(GREEN));
    shine(&mut scene, sun(), 0.0);
    let scene = from_below(&scene, &view);
    let picture = draw(&scene, &view, &Settings::default(), 65);
    // Both diagonals: one is an edge.
    for i in 1..64 {
        for x in [i, 64 - i] {
            let [r, g, b, _] = picture.pixel(x, i).map(f64::from);
            let want = GREEN.map(|share| 204.0 * share);
            assert!(are_near([r, g, b], want, 1.01), "{x} {i}: {r} {g} {b}");
        }
    }
}

#[test]
fn a_picture_on_glass_leaves_its_filter() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("pane.obj");
    let corners = "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";
    std::fs::write(&path, format!("{corners}f 1/1 2/2 3/3 4/4\n")).unwrap();
    let loaded = io::load(&path, &LoadOptions::default(), &io::Progress::new()).unwrap();
    let (mut scene, view) = under(&[(loaded.model.into(), pane(120.0).1)], Transmission::Opacity);
    let texels = vec![[255; 4], [255, 255, 255, 250], [9, 9, 9, 255], [9, 9, 9, 255]];
    let picture = marraztu_core::base::image::Picture::from_pixels(Size::new(2, 2), texels);
    let texture = marraztu_core::scene::Texture::new("t.png", picture.unwrap());
    edit(&mut scene, ObjectId(11), |object| {
        object.opacity = 0.3;
        object.texture = Some(texture.into());
    });
    shine(&mut scene, sun(), 0.0);
    // Its alpha cuts no holes, although the opacity is below one half.
    let got = shares(&scene, &view, &Settings::default());
    assert!(are_near(got, [0.7; 3], 0.01), "{got:?}");
}

#[test]
fn without_a_filter_the_opacity_dims() {
    let (mut scene, view) = under(&[pane(120.0)], Transmission::Opacity);
    edit(&mut scene, ObjectId(11), |object| object.opacity = 0.25);
    shine(&mut scene, sun(), 0.0);
    let got = shares(&scene, &view, &Settings::default());
    assert!(are_near(got, [0.75; 3], 0.01), "{got:?}");
}

#[test]
fn a_change_of_the_glass_is_redrawn() {
    let (mut scene, view) = under(&[pane(120.0)], Transmission::Filter(GREEN));
    shine(&mut scene, sun(), 0.0);
    let mut renderer = Renderer::default();
    let filters = [[1.0, 0.0, 0.0], [0.0; 3], [0.2, 0.4, 0.6], GREEN];
    for samples in [Samples::One, Samples::Four] {
        for filter in filters {
            edit(&mut scene, ObjectId(11), |object| {
                let MaterialChoice::Own(own) = &mut object.material else { unreachable!() };
                own.optics.transmission = Transmission::Filter(filter);
            });
            let settings = Settings { samples, ..Settings::default() };
            let plan = plan_frame(&Shot::new(&scene, &view, &settings, Size::new(200, 150)));
            renderer.redraw(&plan, &|| true).unwrap();
            assert_eq!(renderer.picture(), Renderer::default().render(&plan), "{filter:?}");
        }
    }
}

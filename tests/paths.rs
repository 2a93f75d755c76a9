//! Each way of colouring pixels is reached by the scenes that it is meant for, and by no others.
//!
//! All paths give the same bytes, so no picture shows which path drew it. A condition that is never
//! true would pass every other test.

#![expect(clippy::unwrap_used, reason = "a test that cannot go on may panic")]

mod common;

use common::{at, ball, edit, scene, square};
use marraztu_core::accuracy::{Arithmetic, LightAt, LightValues, Rounding, Settings, Shot};
use marraztu_core::base::Shared;
use marraztu_core::base::color::Color;
use marraztu_core::base::image::Size;
use marraztu_core::scene::{Command, Item, LightId, Model, ObjectId, Scene, Sides, View};
use marraztu_render::{PathPixels, Renderer, explain_frame, plan_frame};
use rayon::ThreadPoolBuilder;

const FIRST: ObjectId = ObjectId(10);

/// A path: its name, and its counter.
type Path = (&'static str, fn(&PathPixels) -> u64);

const FILL: Path = ("fill", |pixels| pixels.fill);
const FACES: Path = ("faces", |pixels| pixels.faces);
const ONE: Path = ("one", |pixels| pixels.one);
const SLOTS: Path = ("slots", |pixels| pixels.slots);
const EACH: Path = ("each", |pixels| pixels.each);
const ALL: [Path; 5] = [FILL, FACES, ONE, SLOTS, EACH];

/// Counts the pixels of a scene without marks, by path.
///
/// On one thread: of several, one may find faces that another is just lighting, and shades their
/// pixels from lists instead.
fn paths(scene: &Scene, view: &View, settings: Settings) -> PathPixels {
    let view = View { marks: false, ..view.clone() };
    let plan = plan_frame(&Shot::new(scene, &view, &settings, Size::new(400, 400)));
    let mut renderer = Renderer::default();
    let one = ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    one.install(|| renderer.render(&plan));
    renderer.path_pixels().unwrap()
}

fn of(model: Shared<Model>) -> (Scene, View) {
    scene(&[(model, at(90.0, 0.0, 0.0, 0.0))])
}

/// A square that covers many blocks fully.
fn large() -> (Scene, View) {
    of(square())
}

/// A ball of triangles that each show in a few pixels.
fn fine() -> (Scene, View) {
    of(ball(24))
}

/// A ball of triangles that are smaller than pixels.
fn finest() -> (Scene, View) {
    scene(&[(ball(200), at(40.0, 0.0, 0.0, 0.0))])
}

fn with_light(light: LightAt) -> Settings {
    Settings { light, ..Settings::default() }
}

/// The same with shadows of all lights that can cast them.
fn with_shadows((mut scene, view): (Scene, View)) -> (Scene, View) {
    let lights: Vec<LightId> = scene.lights.ids().collect();
    for id in lights {
        let mut light = scene.lights.get(id).unwrap().clone();
        light.shadows = light.can_cast_shadows();
        let item = Item::Light(id, Box::new(light));
        Command::Replace(item).apply(&mut scene).unwrap();
    }
    (scene, view)
}

/// Expects that a scene reaches some paths, and no paths but these and `others`.
#[track_caller]
fn expect(
    name: &str,
    (scene, view): (Scene, View),
    settings: Settings,
    (reached, others): (&[Path], &[Path]),
) {
    let pixels = paths(&scene, &view, settings);
    for (path, count) in ALL {
        let is = |paths: &[Path]| paths.iter().any(|(other, _)| *other == path);
        let used = count(&pixels) > 0;
        assert!(used || !is(reached), "{name} does not reach {path}: {pixels:?}");
        assert!(!used || is(reached) || is(others), "{name} reaches {path}: {pixels:?}");
    }
}

#[test]
fn each_path_colours_the_surfaces_that_it_is_meant_for() {
    let [face, vertex, pixel] = [LightAt::Face, LightAt::Vertex, LightAt::Pixel].map(with_light);
    // Blocks at borders and of many triangles have lists.
    let lists: &[Path] = &[SLOTS];
    expect("flat shading of large triangles", large(), face, (&[FILL, FACES], &[]));
    expect("flat shading of small triangles", fine(), face, (&[FACES], &[FILL]));
    expect("Gouraud shading of large triangles", large(), vertex, (&[ONE], lists));
    expect("Gouraud shading of small triangles", fine(), vertex, (&[SLOTS], &[ONE]));
    expect("Gouraud shading of tiny triangles", finest(), vertex, (&[EACH], lists));
    expect("Phong shading of large triangles", large(), pixel, (&[ONE], lists));
    expect("Phong shading of small triangles", fine(), pixel, (&[SLOTS], &[ONE]));
    expect("Phong shading of tiny triangles", finest(), pixel, (&[EACH], lists));
}

#[test]
fn whatever_fast_paths_cannot_do_is_left_to_slots() {
    let usual = Settings::default();
    expect("shadows", with_shadows(fine()), usual, (&[SLOTS], &[]));
    expect("shadows on large triangles", with_shadows(large()), usual, (&[SLOTS], &[]));
    let f64 = Settings { arithmetic: Arithmetic::F64, ..usual };
    for own in [large(), fine(), finest()] {
        expect("f64", own, f64, (&[SLOTS], &[]));
    }
    let (mut scene, view) = large();
    edit(&mut scene, FIRST, |object| object.sides = Sides::One);
    let red = View { back_faces: true, ..view };
    expect("red back faces", (scene, red), usual, (&[SLOTS], &[]));
    let dithered = Settings { rounding: Rounding::Dithered, ..with_light(LightAt::Face) };
    expect("dithered flat shading", large(), dithered, (&[SLOTS], &[]));
    let linear = Settings { light_values: LightValues::Linear, ..with_light(LightAt::Vertex) };
    for own in [large(), fine(), finest()] {
        expect("linear Gouraud shading", own, linear, (&[SLOTS], &[]));
    }
}

/// With one sample per pixel, and no colours of faces that are looked up in blocks with background.
#[test]
fn the_pixels_of_all_paths_are_those_that_show_a_surface() {
    for (mut scene, view) in [large(), fine(), finest()] {
        scene.background = Color([255, 0, 255]);
        let view = View { marks: false, ..view };
        let plan = plan_frame(&Shot::new(&scene, &view, &Settings::default(), Size::new(400, 400)));
        let mut renderer = Renderer::default();
        let pixels = renderer.render(&plan).pixels().to_vec();
        let shown = pixels.iter().filter(|pixel| **pixel != [255, 0, 255, 255]).count();
        let paths = renderer.path_pixels().unwrap();
        let sum: u64 = paths.rows().iter().map(|(.., pixels)| pixels).sum();
        assert_eq!(sum, shown as u64, "{paths:?}");
    }
}

#[test]
fn the_plan_names_the_path_of_each_object() {
    let (scene, view) = fine();
    let words = |settings: Settings| {
        let shot = Shot::new(&scene, &view, &settings, Size::new(400, 400));
        let (_, uses) = explain_frame(&shot);
        let surfaces = uses.iter().find(|one| one.effect == marraztu_render::Effect::Surfaces);
        surfaces.unwrap().state.why().to_owned()
    };
    let pixel = words(Settings::default());
    assert_eq!(pixel, "by block");
    let f64 = words(Settings { arithmetic: Arithmetic::F64, ..Settings::default() });
    assert_eq!(f64, "by pixel: 64-bit numbers");
}

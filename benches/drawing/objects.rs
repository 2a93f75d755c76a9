//! Benchmarks of scenes with many objects.
//!
//! - `objects/N` draws a frame.
//! - `objects/100 in view of N` draws a frame with all but 100 objects out of view.
//! - `objects/N knots` draws N knots of a million triangles that share their mesh.
//! - `objects/insert/N` inserts the objects into a scene.
//! - `objects/move/N` applies one command to one object, with the editor's work after it.

use criterion::{BenchmarkId, Criterion};
use glam::{DMat4, DVec3};
use marraztu_core::base::Shared;
use marraztu_core::base::image::Size;
use marraztu_core::base::math::Axis;
use marraztu_core::edit::transform::{self, Sign};
use marraztu_core::edit::{GesturePhase, items, selection};
use marraztu_core::scene::{Command, ItemId, MaterialChoice, Model, Object, PresetId, Tracked};

use super::shapes;
use super::stage::{FULL, Stage};

/// The numbers of objects.
const COUNTS: [u32; 4] = [1_000, 2_000, 4_000, 10_000];

pub(crate) fn measure(criterion: &mut Criterion) {
    let quad = shapes::sheet(2);
    let mut group = criterion.benchmark_group("objects");
    for count in COUNTS {
        // Every insertion starts from a copy of the empty scene.
        let empty = Stage::new(&quad, FULL);
        let objects = objects(&quad, count);
        group.bench_function(BenchmarkId::new("insert", count), |b| {
            b.iter(|| {
                let (mut scene, mut view) = (empty.scene.clone(), empty.view.clone());
                let command = items::insert_objects(&scene, objects.clone());
                command.apply(&mut scene).expect("they fit");
                selection::follow(&empty.scene, &scene, &mut view);
                view.object
            });
        });
        let mut stage = Stage::new(&quad, FULL);
        let command = items::insert_objects(&stage.scene, objects);
        command.apply(&mut stage.scene).expect("they fit");
        selection::follow(&empty.scene, &stage.scene, &mut stage.view);
        group.bench_function(BenchmarkId::new("move", count), |b| {
            b.iter(|| {
                let (mut scene, mut view) = (stage.scene.clone(), stage.view.clone());
                let moved =
                    transform::step(&scene, &view, Axis::X, Sign::Positive, GesturePhase::First);
                moved.expect("it can be moved").apply(&mut scene).expect("it fits");
                selection::follow(&stage.scene, &scene, &mut view);
                scene == stage.scene
            });
        });
        group.bench_function(BenchmarkId::from_parameter(count), |b| stage.measure(b));
    }
    // The same visible objects, with and without many others out of view.
    for count in [SEEN, 10_000] {
        let stage = mostly_outside(&quad, count);
        let name = format!("{SEEN} in view of {count}");
        group.bench_function(BenchmarkId::from_parameter(name), |b| stage.measure(b));
    }
    // Copies share one mesh, so only the drawing time grows.
    let knot = shapes::knot(1_000_000);
    for count in [1, 20] {
        let stage = knots(&knot, count);
        let name = if count == 1 { "1 knot".to_owned() } else { format!("{count} knots") };
        group.bench_function(BenchmarkId::from_parameter(name), |b| stage.measure(b));
    }
}

/// Builds copies of a knot, five in a row, at 1280 x 720.
fn knots(knot: &Shared<Model>, count: u32) -> Stage {
    let mut stage = Stage::new(knot, Size::new(1280, 720));
    let only = stage.view.object.expect("the stage has one object");
    Command::Remove(ItemId::Object(only)).apply(&mut stage.scene).expect("it is there");
    let copy = |i: u32| {
        let mut object = Object::new(knot.clone(), MaterialChoice::Preset(PresetId::RUBY));
        let place = DVec3::new(f64::from(i % 5) - 2.0, f64::from(i / 5) - 1.5, 0.0) * 9.0;
        let placement = DMat4::from_translation(place) * DMat4::from_scale(DVec3::splat(5.0));
        object.placement = Tracked::new(placement);
        object
    };
    let command = items::insert_objects(&stage.scene, (0..count).map(copy).collect());
    command.apply(&mut stage.scene).expect("they fit");
    stage
}

/// The number of objects in view when most are outside.
const SEEN: u32 = 100;

/// Builds a scene of `count` objects: [`SEEN`] are in view, all others are behind the camera.
fn mostly_outside(quad: &Shared<Model>, count: u32) -> Stage {
    let mut stage = Stage::new(quad, FULL);
    let mut objects = objects(quad, count);
    for object in objects.iter_mut().skip(SEEN as usize) {
        let behind = DMat4::from_translation(DVec3::Z * 100.0);
        object.placement = Tracked::new(behind * *object.placement.now());
    }
    let command = items::insert_objects(&stage.scene, objects);
    command.apply(&mut stage.scene).expect("they fit");
    stage
}

/// Builds squares side by side, each with a different material.
fn objects(model: &Shared<Model>, count: u32) -> Vec<Object> {
    let object = |i: u32| {
        let mut material = PresetId::RUBY.get().material;
        material.exponent = 1.0 + f64::from(i) / 100.0;
        let mut object = Object::new(model.clone(), MaterialChoice::Own(material));
        let place = DVec3::new(f64::from(i % 100) - 50.0, f64::from(i / 100) - 50.0, 0.0) * 0.3;
        let placement = DMat4::from_translation(place) * DMat4::from_scale(DVec3::splat(0.1));
        object.placement = Tracked::new(placement);
        object
    };
    (0..count).map(object).collect()
}

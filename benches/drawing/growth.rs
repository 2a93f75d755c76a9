//! Measures how frame time grows: `triangles/N`, `pixels/WxH`, `lights/N`, `threads/N`.

use criterion::{BenchmarkId, Criterion};
use marraztu_core::base::color::Color;
use marraztu_core::base::image::Size;
use marraztu_core::scene::{Command, Item, Light, LightId};
use rayon::ThreadPoolBuilder;

use super::shapes;
use super::stage::{FULL, Stage};

pub(crate) fn measure(criterion: &mut Criterion) {
    triangles(criterion);
    pixels(criterion);
    lights(criterion);
    threads(criterion);
}

/// Draws the same picture with more and more triangles.
fn triangles(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("triangles");
    for count in [1, 10, 100, 1_000, 10_000, 100_000, 1_000_000] {
        let stage = Stage::new(&shapes::sheet(count), FULL);
        group.bench_function(BenchmarkId::from_parameter(count), |b| stage.measure(b));
    }
}

fn pixels(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("pixels");
    let knot = shapes::knot(70_000);
    for (width, height) in
        [(64, 36), (240, 135), (480, 270), (960, 540), (1920, 1080), (3840, 2160)]
    {
        let stage = Stage::new(&knot, Size { width, height });
        let name = BenchmarkId::from_parameter(format!("{width}x{height}"));
        group.bench_function(name, |b| stage.measure(b));
    }
}

/// Repeats the five lights, dimming them by their number so that the picture does not clip to
/// white.
fn lights(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("lights");
    let knot = shapes::knot(70_000);
    for count in [1, 2, 5, 10, 20, 50, 100] {
        let mut stage = Stage::new(&knot, FULL);
        let all: Vec<LightId> = stage.scene.lights.ids().collect();
        for id in all {
            let gone = Command::Remove(marraztu_core::scene::ItemId::Light(id));
            gone.apply(&mut stage.scene).expect("it is there");
        }
        // The ambient light is skipped: it costs nothing per pixel.
        let kinds = Light::five().into_iter().skip(1).cycle();
        for (light, i) in kinds.zip(0..count) {
            let color = Color::from_factors(
                light.color.factors().map(|c| c * 4.0 / f64::from(count.max(4))),
            );
            let light = Light { slot: i, on: true, color, ..light };
            let item = Item::Light(LightId(100 + i), Box::new(light));
            Command::Insert { at: usize::MAX, item }.apply(&mut stage.scene).expect("it fits");
        }
        group.bench_function(BenchmarkId::from_parameter(count), |b| stage.measure(b));
    }
}

fn threads(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("threads");
    let stage = Stage::new(&shapes::knot(1_000_000), FULL);
    let most = std::thread::available_parallelism().map_or(1, usize::from);
    let mut count = 1;
    while count <= most {
        let pool = ThreadPoolBuilder::new().num_threads(count).build().expect("threads begin");
        group.bench_function(BenchmarkId::from_parameter(count), |b| {
            pool.install(|| stage.measure(b));
        });
        count *= 2;
    }
}

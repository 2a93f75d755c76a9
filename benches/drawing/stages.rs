//! Benchmarks of each stage of a frame for each shape: `stages/SHAPE/STAGE`.

use std::time::Duration;

use criterion::Criterion;
use marraztu_core::accuracy::{LightAt, Settings};
use marraztu_lab::timing::time;
use marraztu_render::Timings;

use super::shapes;
use super::stage::{FULL, Stage};

type Row = (&'static str, fn(&Timings) -> Duration);

const STAGES: [Row; 4] = [
    ("vertices", |stages| stages.vertices),
    ("set-up", |stages| stages.set_up),
    ("tiles", |stages| stages.tiles),
    ("tiles-lit-at-vertices", |stages| stages.tiles),
];

pub(crate) fn measure(criterion: &mut Criterion) {
    for shape in shapes::all() {
        let mut group = criterion.benchmark_group(format!("stages/{}", shape.name));
        let mut stage = Stage::new(&shape.model, FULL);
        group.bench_function("plan", |bencher| {
            bencher.iter_custom(|frames| {
                time(|| {
                    for i in 0..frames {
                        std::hint::black_box(stage.plan(i));
                    }
                })
            });
        });
        // Each stage is timed by the renderer itself, within whole frames.
        for (name, part) in STAGES {
            let at_vertices = name == "tiles-lit-at-vertices";
            let light = if at_vertices { LightAt::Vertex } else { LightAt::Pixel };
            stage.settings = Settings { light, ..Settings::default() };
            group.bench_function(name, |bencher| {
                bencher.iter_custom(|frames| stage.drawn(frames, |r| part(&r.timings())));
            });
        }
        // Lines need another fill mode, so they come last.
        stage.view.fill = marraztu_core::scene::Fill::Edges;
        group.bench_function("lines", |bencher| {
            bencher.iter_custom(|frames| stage.drawn(frames, |r| r.timings().lines));
        });
    }
}

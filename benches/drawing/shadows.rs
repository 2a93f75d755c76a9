//! Benchmarks of shadows: `shadows/SHAPE/none` and `shadows/SHAPE/METHOD`, with shadows from every
//! light of the stage that can cast them, at 800 x 800. Each shape first prints its number of rays.
//!
//! Only the camera moves, so the BVHs and shadow maps are built once and reused.

use std::io::Write as _;

use criterion::{BenchmarkId, Criterion};
use marraztu_core::accuracy::ShadowMethod;
use marraztu_core::base::image::Size;
use marraztu_core::scene::{Command, Item, Light};
use marraztu_render::{RayCount, Renderer};

use super::shapes;
use super::stage::Stage;

const METHODS: [(&str, ShadowMethod); 3] = [
    ("exact", ShadowMethod::Exact),
    ("map 2048", ShadowMethod::Map2048),
    ("map 2048 PCF", ShadowMethod::Map2048Pcf),
];

pub(crate) fn measure(criterion: &mut Criterion) {
    for (name, model) in [
        ("layers-8", shapes::layers(8)),
        ("knot-70k", shapes::knot(70_000)),
        ("knot-1m", shapes::knot(1_000_000)),
    ] {
        let mut group = criterion.benchmark_group(format!("shadows/{name}"));
        let mut stage = Stage::new(&model, Size::new(800, 800));
        // The baseline: the same stage before its lights cast shadows.
        group.bench_function("none", |b| stage.measure(b));
        let lights: Vec<_> =
            stage.scene.lights.iter().map(|(id, light)| (id, light.clone())).collect();
        for (id, light) in lights {
            let light = Light { shadows: light.can_cast_shadows(), ..light };
            let item = Item::Light(id, Box::new(light));
            Command::Replace(item).apply(&mut stage.scene).expect("it fits");
        }
        // One frame outside the measurement counts the rays.
        let mut renderer = Renderer::default();
        renderer.render(&stage.plan(0));
        let RayCount { traced, occluded, .. } = renderer.rays();
        let told = format!("shadows/{name}: {traced} rays, {occluded} of them occluded");
        let _ = writeln!(std::io::stdout().lock(), "{told}");
        for (method, shadow_method) in METHODS {
            stage.settings.shadow_method = shadow_method;
            group.bench_function(BenchmarkId::from_parameter(method), |b| stage.measure(b));
        }
    }
}

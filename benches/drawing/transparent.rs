//! Benchmarks of transparency: `transparent/SHAPE/opaque` and `transparent/SHAPE/CHOICE`, with 1, 8
//! and 64 layers over the whole picture, and with a knot whose tube shows both sides.

use criterion::{BenchmarkId, Criterion};
use marraztu_core::accuracy::Transparency;
use marraztu_core::scene::{Command, Item, ObjectId, Sides};

use super::shapes;
use super::stage::{FULL, Stage};

const CHOICES: [(&str, Transparency); 2] =
    [("by pixel", Transparency::Exact), ("by object", Transparency::Objects)];

pub(crate) fn measure(criterion: &mut Criterion) {
    let all = [
        ("one", shapes::sheet(1)),
        ("layers-8", shapes::layers(8)),
        ("layers-64", shapes::layers(64)),
        ("knot-70k", shapes::knot(70_000)),
    ];
    for (name, model) in all {
        let mut group = criterion.benchmark_group(format!("transparent/{name}"));
        let mut stage = Stage::new(&model, FULL);
        group.bench_function("opaque", |b| stage.measure(b));
        let id = ObjectId(0);
        let mut object = stage.scene.objects.get(id).expect("there is one").clone();
        // Two-sided, so closed shapes have at least two layers per pixel.
        (object.opacity, object.sides) = (0.5, Sides::Two);
        let item = Item::Object(id, Box::new(object));
        Command::Replace(item).apply(&mut stage.scene).expect("it fits");
        for (choice, transparency) in CHOICES {
            stage.settings.transparency = transparency;
            group.bench_function(BenchmarkId::from_parameter(choice), |b| stage.measure(b));
        }
    }
}

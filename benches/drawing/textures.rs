//! Benchmarks of textures.
//!
//! `textures/TRIANGLES/FILTER` draws a sheet that fills the view, with and without holes;
//! `textures/TRIANGLES/none` is its baseline. `textures/floor/FILTER` draws a plane that the near
//! plane clips, with a hundred thousand texels to its horizon.

use criterion::{BenchmarkId, Criterion};
use glam::{DMat4, DVec3};
use marraztu_core::accuracy::Filter;
use marraztu_core::base::Shared;
use marraztu_core::base::image::{Picture, Size};
use marraztu_core::base::rng::Rng;
use marraztu_core::scene::{Command, Item, Object, ObjectId, Surface, Texture, Tracked, Wrap};

use super::shapes;
use super::stage::{FULL, Stage};

const FILTERS: [(&str, Filter); 3] = [
    ("nearest", Filter::Nearest),
    ("bilinear", Filter::Bilinear),
    ("trilinear", Filter::Trilinear),
];

pub(crate) fn measure(criterion: &mut Criterion) {
    for count in [1, 2_000, 100_000] {
        let mut group = criterion.benchmark_group(format!("textures/{count}"));
        let sheet = shapes::textured(count);
        let mut stage = Stage::new(&sheet, FULL);
        edit(&mut stage, |object| object.surface = Surface::Material);
        group.bench_function("none", |b| stage.measure(b));
        for (name, holes) in [("", false), (" with holes", true)] {
            let texture = Shared::new(noise(holes));
            edit(&mut stage, |object| {
                object.surface = Surface::TextureAndLight;
                object.texture = Some(texture);
            });
            for (filter_name, filter) in FILTERS {
                stage.settings.filter = filter;
                let name = BenchmarkId::from_parameter(format!("{filter_name}{name}"));
                group.bench_function(name, |b| stage.measure(b));
            }
        }
    }
    floor(criterion);
}

fn floor(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("textures/floor");
    let mut stage = Stage::new(&shapes::textured(2), FULL);
    let texture = Shared::new(Texture { scale: [200.0; 2], ..noise(false) });
    edit(&mut stage, |object| {
        object.texture = Some(texture);
        let flat = DMat4::from_rotation_x(-std::f64::consts::FRAC_PI_2);
        let place = DMat4::from_translation(DVec3::NEG_Y * 5.0);
        object.placement = Tracked::new(place * flat * DMat4::from_scale(DVec3::splat(800.0)));
    });
    for (name, filter) in FILTERS {
        stage.settings.filter = filter;
        group.bench_function(name, |b| stage.measure(b));
    }
}

/// Changes the object of a stage.
fn edit(stage: &mut Stage, change: impl FnOnce(&mut Object)) {
    let id = ObjectId(0);
    let mut object = stage.scene.objects.get(id).expect("there is one").clone();
    change(&mut object);
    Command::Replace(Item::Object(id, Box::new(object))).apply(&mut stage.scene).expect("it fits");
}

/// Makes random texels. With `holes`, every second field of 16 x 16 texels is a hole.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "bytes")]
fn noise(holes: bool) -> Texture {
    const SIDE: usize = 512;
    let mut rng = Rng::new(1);
    let mut byte = || rng.real(0.0, 256.0) as u8;
    let texel = |i: usize| {
        let open = holes && (i % SIDE / 16 + i / SIDE / 16) % 2 == 1;
        [byte(), byte(), byte(), if open { 0 } else { 255 }]
    };
    let texels = (0..SIDE * SIDE).map(texel).collect();
    Texture {
        source: "noise".into(),
        picture: Picture::from_pixels(Size::new(SIDE, SIDE), texels).expect("all of them").into(),
        wrap: Wrap::Repeat,
        offset: [0.0; 2],
        scale: [1.0; 2],
    }
}

//! The cost of each effect of the plan's table: `effects/NAME/with` and `effects/NAME/without`, in
//! a scene that uses all of them.

use criterion::Criterion;
use marraztu_core::accuracy::Shot;
use marraztu_core::base::Shared;
use marraztu_core::base::image::{Picture, Size};
use marraztu_core::scene::{Command, Item, ObjectId, Scene, Texture, View, Wrap};
use marraztu_render::explain_frame;
use marraztu_render::{Effect, Renderer};

use super::shapes;
use super::stage::{FULL, Stage};

pub(crate) fn measure(criterion: &mut Criterion) {
    let stage = everything();
    let Stage { scene, view, settings, size } = &stage;
    let (_, uses) = explain_frame(&Shot::new(scene, view, settings, *size));
    let mut effects: Vec<Effect> =
        uses.iter().filter(|one| one.state.is_on()).map(|one| one.effect).collect();
    effects.dedup();
    // An effect that the plan does not use cannot be left out.
    for effect in effects {
        if stage.plan(0).without(effect).is_none() {
            continue;
        }
        // Both run one after the other: the speed of a machine drifts within minutes.
        let mut group = criterion.benchmark_group(format!("effects/{}", name(effect, scene)));
        group.bench_function("with", |bencher| stage.measure(bencher));
        group.bench_function("without", |bencher| {
            let (mut renderer, mut i) = (Renderer::default(), 0);
            bencher.iter(|| {
                i += 1;
                let plan = stage.plan(i).without(effect).expect("it has it in every frame");
                renderer.render(&plan).pixels()[0]
            });
        });
    }
}

fn name(effect: Effect, scene: &Scene) -> String {
    match effect {
        Effect::Light(id) => {
            let light = scene.lights.get(id).expect("it is on");
            format!("light {} {}", light.slot, light.name)
        }
        other => other.label().to_lowercase(),
    }
}

/// Builds a painted sheet with holes. Parts of it face away, and it shows edges, normals and the
/// marks of cameras and bulbs.
fn everything() -> Stage {
    let mut stage = Stage::new(&shapes::painted(2_000), FULL);
    let id = ObjectId(0);
    let mut object = stage.scene.objects.get(id).expect("there is one").clone();
    object.texture = Some(Shared::new(holed()));
    let turn = glam::DMat4::from_rotation_y(0.6) * glam::DMat4::from_rotation_x(1.0);
    object.placement = marraztu_core::scene::Tracked::new(*object.placement.now() * turn);
    Command::Replace(Item::Object(id, Box::new(object))).apply(&mut stage.scene).expect("it fits");
    stage.view = View {
        marks: true,
        edges_over_fill: true,
        back_faces: true,
        face_normals: true,
        vertex_normals: true,
        ..stage.view
    };
    stage
}

/// Makes a chequered texture with every eighth field as a hole.
fn holed() -> Texture {
    let size = Size::new(256, 256);
    let texel = |i: usize| {
        let (x, y) = (i % size.width / 16, i / size.width / 16);
        let alpha = if (x + 3 * y).is_multiple_of(8) { 0 } else { 255 };
        if (x + y).is_multiple_of(2) { [230, 200, 160, alpha] } else { [90, 120, 180, alpha] }
    };
    let texels = (0..size.area()).map(texel).collect();
    Texture {
        source: "holed".into(),
        picture: Picture::from_pixels(size, texels).expect("as many as it has").into(),
        wrap: Wrap::Repeat,
        offset: [0.0; 2],
        scale: [1.0; 2],
    }
}

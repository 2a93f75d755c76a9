//! Benchmarks of redrawing under shadows.
//!
//! `redraw/CHANGE` draws the laboratory's suite scene of shadows at 1280 x 720 after a change and
//! after its opposite, in turn. `redraw/everything` draws two such pictures from scratch. Each
//! prints the number of rays that it traced.

use std::io::Write as _;

use criterion::Criterion;
use glam::{DMat4, DVec3};
use marraztu_core::accuracy::{Settings, Shot};
use marraztu_core::base::color::Color;
use marraztu_core::base::image::Size;
use marraztu_core::scene::{
    Command, Item, Light, LightKind, MaterialChoice, Object, ObjectId, PresetId, Scene, SpotOwner,
    Tracked,
};
use marraztu_lab::suite::SuiteScene;
use marraztu_render::{Renderer, plan_frame};

/// A change of a scene.
type Change = fn(&mut Scene);

const CHANGES: [(&str, Change); 7] = [
    ("object moves", |scene| {
        change_object(scene, |object| {
            let placement = DMat4::from_translation(DVec3::X * 4.0) * *object.placement.now();
            object.placement = Tracked::new(placement);
        });
    }),
    ("sun moves", |scene| {
        change_light(scene, |light| match &mut light.kind {
            LightKind::Sun { direction } => {
                *direction =
                    Tracked::new((*direction.now() + DVec3::X * 0.1).normalize_or(DVec3::X));
                true
            }
            _ => false,
        });
    }),
    ("bulb moves", |scene| {
        change_light(scene, |light| match &mut light.kind {
            LightKind::Bulb { position, .. } => {
                *position = Tracked::new(*position.now() + DVec3::X * 5.0);
                true
            }
            _ => false,
        });
    }),
    ("spot moves", |scene| {
        change_light(scene, |light| match &mut light.kind {
            LightKind::Spot { owner: SpotOwner::Fixed(aim), .. } => {
                let mut moved = *aim.now();
                moved.position.x += 5.0;
                *aim = Tracked::new(moved);
                true
            }
            _ => false,
        });
    }),
    ("bulb recoloured", |scene| {
        change_light(scene, |light| {
            light.color = Color([255, 200, 120]);
            matches!(light.kind, LightKind::Bulb { .. })
        });
    }),
    ("floor's material", |scene| {
        let floor = scene.objects.ids().min().expect("there is a floor");
        change(scene, floor, |object| {
            object.material = MaterialChoice::Preset(PresetId::RUBY);
        });
    }),
    ("ball's material", |scene| {
        change_object(scene, |object| {
            object.material = MaterialChoice::Preset(PresetId::RUBY);
        });
    }),
];

fn change(scene: &mut Scene, id: ObjectId, change: impl FnOnce(&mut Object)) {
    let mut object = scene.objects.get(id).expect("it is there").clone();
    change(&mut object);
    Command::Replace(Item::Object(id, Box::new(object))).apply(scene).expect("it fits");
}

/// Changes the last object, which is a ball.
fn change_object(scene: &mut Scene, how: impl FnOnce(&mut Object)) {
    let id = scene.objects.ids().max().expect("there is a ball");
    change(scene, id, how);
}

/// Changes the first light that `change` accepts.
fn change_light(scene: &mut Scene, change: impl Fn(&mut Light) -> bool) {
    let all: Vec<_> = scene.lights.iter().map(|(id, light)| (id, light.clone())).collect();
    for (id, mut light) in all {
        if change(&mut light) {
            let item = Item::Light(id, Box::new(light));
            Command::Replace(item).apply(scene).expect("it fits");
            return;
        }
    }
}

/// Redraws only the pixels that each change affects.
pub(crate) fn measure(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("redraw");
    let (scene, view) = SuiteScene::named("shadows").expect("it is in the suite").open(1000);
    let shot = |scene: &Scene| {
        plan_frame(&Shot::new(scene, &view, &Settings::default(), Size::new(1280, 720)))
    };
    for (name, change) in CHANGES {
        let mut changed = scene.clone();
        change(&mut changed);
        assert!(changed != scene, "{name}");
        let plans = [shot(&scene), shot(&changed)];
        let mut renderer = Renderer::default();
        let mut turn = 0;
        // The two plans alternate, so each frame sees the opposite of the last change.
        if name == CHANGES[0].0 {
            group.bench_function("everything", |b| {
                b.iter(|| {
                    turn ^= 1;
                    renderer.render(&plans[turn]);
                });
            });
        }
        renderer.render(&plans[turn]);
        let all = renderer.rays().traced;
        group.bench_function(name, |b| {
            b.iter(|| {
                turn ^= 1;
                renderer.redraw(&plans[turn], &|| true).expect("it is wanted")
            });
        });
        let again = renderer.rays().traced;
        let _ = writeln!(std::io::stdout().lock(), "redraw/{name}: {again} of {all} rays");
    }
}

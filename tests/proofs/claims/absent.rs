//! Invisible items change nothing: lights that are off, hidden objects and unused materials change
//! no byte, at any position in their list.

use marraztu_core::base::Shared;
use marraztu_core::base::rng::Rng;
use marraztu_core::scene::{
    Command, Corner, FileMaterial, Item, Light, LightId, LightKind, MaterialChoice, Mesh,
    MeshSource, Model, NONE, Object, ObjectId, Part, SourceCorner, SpotOwner, Tracked,
};
use marraztu_render::Renderer;

use super::plan::{SCENES, same, seeds};
use super::random_scenes::{RandomScene, random_scene, shapes};
use super::{Proof, Tally};

pub(super) const PROOF: Proof = Proof {
    name: "absent",
    claim: "lights that are off, hidden objects and unused materials change no byte, wherever they \
            are put in",
    unit: "scenes",
    batch: SCENES,
    quick: 2000,
    whole: 100_000,
    shows: &[],
    regressions: &[],
    check,
};

/// Draws the scenes of a batch with and without invisible items, and expects the same bytes and
/// pipelines.
fn check(batch: u64) -> Result<Tally, String> {
    let mut tally = Tally::default();
    for it in seeds(batch).map(random_scene) {
        let more = with_absent(&it, &mut Rng::new(it.seed ^ 0x5eed));
        let (before, after) = (it.plan(), more.plan());
        if before.keys() != after.keys() {
            return Err(format!("scene {}: it is drawn by other pipelines", it.seed));
        }
        same(it.seed, Renderer::default().render(&after), Renderer::default().render(&before))?;
        let dark = with_lights_off(&it, 100, &mut Rng::new(it.seed));
        if before != dark.plan() {
            return Err(format!(
                "scene {}: a hundred lights that are off change the plan",
                it.seed
            ));
        }
        tally.count("scenes", 1);
    }
    Ok(tally)
}

/// Inserts `count` lights that are off among the others.
pub(super) fn with_lights_off(it: &RandomScene, count: u32, rng: &mut Rng) -> RandomScene {
    let mut more = it.clone();
    for i in 0..count {
        let kind = rng.one_of(&[
            LightKind::Ambient,
            LightKind::Sun { direction: Tracked::new(glam::DVec3::NEG_Y) },
            LightKind::Bulb {
                position: Tracked::new(glam::DVec3::ZERO),
                orbit: Default::default(),
            },
            LightKind::Spot {
                owner: SpotOwner::SelectedObject,
                half_aperture: 45.0,
                exponent: 1.0,
            },
        ]);
        let light = Light::new("off", 500 + i, kind);
        let light = Light { on: false, shadows: light.can_cast_shadows(), ..light };
        let at = rng.index(more.scene.lights.len() + 1);
        insert(&mut more, at, Item::Light(LightId(500 + i), Box::new(light)));
    }
    more
}

/// Adds a light, an object and a material that are invisible.
fn with_absent(it: &RandomScene, rng: &mut Rng) -> RandomScene {
    let mut more = with_lights_off(it, 1, rng);
    // Older or younger than all others.
    let id = ObjectId(rng.one_of(&[20, 700]));
    let material = MaterialChoice::Own(shapes::material(rng));
    let mut hidden = Object::new(rng.one_of(shapes::shapes()), material);
    hidden.visible = false;
    hidden.placement = Tracked::new(glam::DMat4::from_scale(glam::DVec3::splat(20.0)));
    let at = rng.index(more.scene.objects.len() + 1);
    insert(&mut more, at, Item::Object(id, Box::new(hidden)));
    let objects: Vec<_> = more.scene.objects.iter().map(|(id, o)| (id, o.clone())).collect();
    for (id, mut object) in objects {
        object.model = with_unused_material(&object.model, rng);
        let item = Item::Object(id, Box::new(object));
        Command::Replace(item).apply(&mut more.scene).expect("it was there already");
    }
    more
}

fn insert(more: &mut RandomScene, at: usize, item: Item) {
    Command::Insert { at, item }.apply(&mut more.scene).expect("its id is free");
}

/// Adds a material that no part of the model uses.
fn with_unused_material(model: &Shared<Model>, rng: &mut Rng) -> Shared<Model> {
    let mesh = &model.mesh;
    let at = rng.index(model.materials.len() + 1);
    let mut materials = model.materials.clone();
    let material = shapes::material(rng);
    let texture = Some(shapes::texture(rng));
    let maps = shapes::maps(rng);
    let unused =
        FileMaterial { opacity: 0.7, texture, maps, ..FileMaterial::new("unused", material) };
    materials.insert(at, unused);
    let moved = |material: u32| if material as usize >= at { material + 1 } else { material };
    let part = |part: &Part| Part { name: part.name.clone(), material: part.material.map(moved) };
    let corner =
        |corner: &Corner| SourceCorner { position: corner.position, uv: corner.uv, normal: NONE };
    let count = |polygon: u32| mesh.corners_of(polygon).len();
    let polygons = 0..u32::try_from(mesh.polygon_count()).expect("polygons have 32-bit numbers");
    let source = MeshSource {
        positions: mesh.positions().to_vec(),
        colors: mesh.colors().to_vec(),
        uvs: mesh.uvs().to_vec(),
        normals: Vec::new(),
        corners: mesh.corners().iter().map(corner).collect(),
        arities: polygons.map(|p| u32::try_from(count(p)).expect("few")).collect(),
        polygon_parts: mesh.polygon_parts().to_vec(),
        parts: mesh.parts().iter().map(part).collect(),
        smoothing: mesh.smoothing().clone(),
        ..MeshSource::default()
    };
    let mesh = Mesh::new(source).expect("it was a mesh before");
    let (options, edge_color) = (model.options, model.edge_color);
    Shared::new(Model { options, materials, edge_color, ..Model::of_mesh(&model.name, mesh) })
}

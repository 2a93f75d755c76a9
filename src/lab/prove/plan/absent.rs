//! What is not seen is not there: a light that is off, a hidden object, a material that nothing has,
//! put in anywhere, change no byte.

use super::samples::{Sample, sample};
use super::{seeds, shapes};
use crate::base::Shared;
use crate::lab::prove::Tally;
use crate::lab::prove::dice::Dice;
use crate::render::{FramePlan, Renderer};
use crate::scene::{
    Command, FileMaterial, Item, Light, LightId, LightKind, Mesh, MeshSource, Model, Object,
    ObjectId, Part, Placed, SourceCorner, SpotOwner,
};

/// Draws the scenes of a lot as they are and with what is not seen, and wants the same bytes and the
/// same ways of drawing.
pub(super) fn is_not_seen(lot: u64) -> Result<Tally, String> {
    let mut tally = Tally::default();
    for it in seeds(lot).map(sample) {
        let more = with_absent(&it, &mut Dice::new(it.seed ^ 0x5eed));
        let plan = |it: &Sample| FramePlan::new(&it.scene, &it.view, &it.settings, it.size);
        let (before, after) = (plan(&it), plan(&more));
        if before.keys() != after.keys() {
            return Err(format!("scene {}: it is drawn in other ways", it.seed));
        }
        super::same(
            it.seed,
            Renderer::default().render(&after),
            Renderer::default().render(&before),
        )?;
        tally.count("scenes", 1);
    }
    Ok(tally)
}

/// The scene with `count` lights that are off among the others.
#[must_use]
pub fn with_lights_off(it: &Sample, count: u32, dice: &mut Dice) -> Sample {
    let mut more = it.clone();
    for i in 0..count {
        let kind = dice.pick(&[
            LightKind::Ambient,
            LightKind::Sun { direction: Placed::new(glam::DVec3::NEG_Y) },
            LightKind::Bulb { position: Placed::new(glam::DVec3::ZERO), orbit: Default::default() },
            LightKind::Spot {
                owner: SpotOwner::SelectedObject,
                half_aperture: 45.0,
                exponent: 1.0,
            },
        ]);
        let light = Light { on: false, ..Light::new("off", 500 + i, kind) };
        let at = dice.index(more.scene.lights.len() + 1);
        insert(&mut more, at, Item::Light(LightId(500 + i), Box::new(light)));
    }
    more
}

/// The scene with a light, an object and a material that are not seen.
fn with_absent(it: &Sample, dice: &mut Dice) -> Sample {
    let mut more = with_lights_off(it, 1, dice);
    // Older than all, or younger.
    let id = ObjectId(dice.pick(&[20, 700]));
    let material = crate::scene::MaterialChoice::Own(shapes::material(dice));
    let mut hidden = Object::new(dice.pick(shapes::shapes()), material);
    hidden.visible = false;
    hidden.placement = Placed::new(glam::DMat4::from_scale(glam::DVec3::splat(20.0)));
    let at = dice.index(more.scene.objects.len() + 1);
    insert(&mut more, at, Item::Object(id, Box::new(hidden)));
    let objects: Vec<_> = more.scene.objects.iter().map(|(id, o)| (id, o.clone())).collect();
    for (id, mut object) in objects {
        object.model = with_unused_material(&object.model, dice);
        let item = Item::Object(id, Box::new(object));
        Command::Replace(item).apply(&mut more.scene).expect("it was there already");
    }
    more
}

fn insert(more: &mut Sample, at: usize, item: Item) {
    Command::Insert { at, item }.apply(&mut more.scene).expect("its id is free");
}

/// The same model, with a material among its others that none of its parts has.
fn with_unused_material(model: &Shared<Model>, dice: &mut Dice) -> Shared<Model> {
    let mesh = &model.mesh;
    let at = dice.index(model.materials.len() + 1);
    let mut materials = model.materials.clone();
    let material = shapes::material(dice);
    let texture = Some(shapes::texture(dice));
    materials
        .insert(at, FileMaterial { name: "unused".to_owned(), material, opacity: 0.7, texture });
    let moved = |material: u32| if material as usize >= at { material + 1 } else { material };
    let part = |part: &Part| Part { name: part.name.clone(), material: part.material.map(moved) };
    let corner = |corner: &crate::scene::Corner| SourceCorner {
        position: corner.position,
        uv: corner.uv,
        normal: crate::scene::NONE,
    };
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
    };
    Shared::new(Model {
        name: model.name.clone(),
        source: None,
        options: model.options,
        mesh: Mesh::new(source).expect("it was a mesh before"),
        materials,
        edge_color: model.edge_color,
    })
}

//! A variant of the first scene with shapes simple enough to check by hand.

use glam::{DMat4, DVec3};
use marraztu_core::base::Shared;
use marraztu_core::scene::{
    Camera, Command, Item, ItemId, Light, LightId, MaterialChoice, Mesh, MeshSource, Model, NONE,
    Object, ObjectId, Part, PresetId, Scene, SourceCorner, Tracked, View,
};

/// Two triangles, each its own part. The mean of the vertices is (1, 2, 3), and every vertex is 5
/// from the centre of the bounding box.
pub(crate) fn model() -> Shared<Model> {
    let corner = |position| SourceCorner { position, uv: NONE, normal: NONE };
    let part = |name: &str| Part { name: name.to_owned(), material: None };
    let source = MeshSource {
        positions: vec![[-2.0, -2.0, 3.0], [4.0, -2.0, 3.0], [4.0, 6.0, 3.0], [-2.0, 6.0, 3.0]],
        corners: [0, 1, 2, 0, 2, 3].map(corner).to_vec(),
        arities: vec![3, 3],
        polygon_parts: vec![0, 1],
        parts: vec![part("lower"), part("upper")],
        ..MeshSource::default()
    };
    Shared::new(Model::of_mesh("plate", Mesh::new(source).unwrap()))
}

/// A camera at (0, 0, 400); objects 3, 2 and 1 in this order, at (-100, 0, 0), (100, 0, 0) and
/// (0, 0, -400), with 3 selected; the five lights as 4 to 8, with the sun selected.
pub(crate) fn three_objects() -> (Scene, View) {
    let obsidian = MaterialChoice::Preset(PresetId::OBSIDIAN);
    let camera = Camera::new("camera 1", model(), obsidian, DVec3::Z * 400.0);
    let mut scene = Scene::with_camera(camera);
    let places = [DVec3::Z * -400.0, DVec3::X * 100.0, DVec3::X * -100.0];
    for (id, place) in (1..).zip(places) {
        let mut object = Object::new(model(), MaterialChoice::Preset(PresetId::RUBY));
        object.name = format!("object {id}");
        object.placement = Tracked::new(DMat4::from_translation(place));
        insert(&mut scene, 0, Item::Object(ObjectId(id), Box::new(object)));
    }
    for (id, light) in (4..).zip(Light::five()) {
        insert(&mut scene, usize::MAX, Item::Light(LightId(id), Box::new(light)));
    }
    Command::NextId(9).apply(&mut scene).unwrap();
    let view = scene.first_view();
    assert!(scene.contains(ItemId::Object(ObjectId(3))) && view.light == Some(LightId(5)));
    (scene, view)
}

fn insert(scene: &mut Scene, at: usize, item: Item) {
    Command::Insert { at, item }.apply(scene).unwrap();
}

//! Small scenes for tests, built without files.

#![allow(dead_code, reason = "each test uses its own part of it")]
#![allow(clippy::cast_possible_truncation, reason = "small numbers")]

use glam::{DMat4, DVec3};
use marraztu_core::accuracy::Settings;
use marraztu_core::accuracy::Shot;
use marraztu_core::base::Shared;
use marraztu_core::base::image::{Picture, Size};
use marraztu_core::scene::{
    Camera, CameraId, Command, Item, Light, LightId, MaterialChoice, Mesh, MeshSource, Model,
    Object, ObjectId, Part, PresetId, Scene, SourceCorner, Tracked, View,
};
use marraztu_render::Renderer;
use marraztu_render::plan_frame;

/// Builds a model from polygons of vertex indices.
pub(crate) fn model(name: &str, positions: &[[f32; 3]], polygons: &[&[u32]]) -> Shared<Model> {
    let corners = polygons.iter().copied().flatten().copied().map(SourceCorner::bare);
    let arities = polygons.iter().map(|polygon| polygon.len() as u32).collect();
    let parts = vec![Part { name: name.to_owned(), material: None }];
    let positions = positions.to_vec();
    model_of(name, MeshSource { positions, parts, ..MeshSource::of_polygons(corners, arities) })
}

/// Builds a model from a mesh source.
pub(crate) fn model_of(name: &str, source: MeshSource) -> Shared<Model> {
    Shared::new(Model::of_mesh(name, Mesh::new(source).expect("tests make good meshes")))
}

/// A cube from -1 to 1, with outward faces.
pub(crate) fn cube() -> Shared<Model> {
    let positions: Vec<[f32; 3]> =
        (0..8).map(|i| [1, 2, 4].map(|bit| if i & bit == 0 { -1.0 } else { 1.0 })).collect();
    let polygons: [&[u32]; 6] =
        [&[0, 2, 3, 1], &[4, 5, 7, 6], &[0, 1, 5, 4], &[2, 6, 7, 3], &[0, 4, 6, 2], &[1, 3, 7, 5]];
    model("cube", &positions, &polygons)
}

/// A square from -1 to 1 in the plane z = 0, facing +Z.
pub(crate) fn square() -> Shared<Model> {
    let positions = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]];
    model("square", &positions, &[&[0, 1, 2, 3]])
}

/// A UV sphere of radius 1: quads, and triangles at the poles.
pub(crate) fn ball(rings: u32) -> Shared<Model> {
    let segments = 2 * rings;
    let mut positions = vec![[0.0, 1.0, 0.0], [0.0, -1.0, 0.0]];
    for ring in 1..rings {
        let polar = std::f64::consts::PI * f64::from(ring) / f64::from(rings);
        for segment in 0..segments {
            let angle = std::f64::consts::TAU * f64::from(segment) / f64::from(segments);
            let (s, c) = (polar.sin(), polar.cos());
            positions.push([s * angle.sin(), c, s * angle.cos()].map(|x| x as f32));
        }
    }
    let at = |ring: u32, segment: u32| 2 + (ring - 1) * segments + segment % segments;
    let mut polygons: Vec<Vec<u32>> = Vec::new();
    for segment in 0..segments {
        polygons.push(vec![0, at(1, segment), at(1, segment + 1)]);
        polygons.push(vec![1, at(rings - 1, segment + 1), at(rings - 1, segment)]);
        for ring in 1..rings - 1 {
            let (a, b) = (at(ring, segment), at(ring + 1, segment));
            let (c, d) = (at(ring + 1, segment + 1), at(ring, segment + 1));
            polygons.push(vec![a, b, c, d]);
        }
    }
    let polygons: Vec<&[u32]> = polygons.iter().map(Vec::as_slice).collect();
    model("ball", &positions, &polygons)
}

/// A camera at (0, 0, 400), looking along -Z.
pub(crate) fn camera() -> Camera {
    let obsidian = MaterialChoice::Preset(PresetId::OBSIDIAN);
    Camera::new("camera 1", cube(), obsidian, DVec3::new(0.0, 0.0, 400.0))
}

/// Builds a scene with the five lights and these models at their placements, oldest first.
pub(crate) fn scene(models: &[(Shared<Model>, DMat4)]) -> (Scene, View) {
    let mut scene = Scene::with_camera(camera());
    let insert = |scene: &mut Scene, item| {
        Command::Insert { at: usize::MAX, item }.apply(scene).expect("fits");
    };
    for (i, light) in Light::five().into_iter().enumerate() {
        insert(&mut scene, Item::Light(LightId(i as u32 + 1), Box::new(light)));
    }
    for (i, (model, placement)) in models.iter().enumerate() {
        let ruby = MaterialChoice::Preset(PresetId::RUBY);
        let mut object = Object::new(model.clone(), ruby);
        object.placement = Tracked::new(*placement);
        insert(&mut scene, Item::Object(ObjectId(i as u32 + 10), Box::new(object)));
    }
    scene.next_id = 100;
    let view = View { camera: CameraId(0), ..scene.first_view() };
    (scene, view)
}

/// Edits an object of a scene.
pub(crate) fn edit(scene: &mut Scene, id: ObjectId, change: impl FnOnce(&mut Object)) {
    let mut object = scene.objects.get(id).expect("there").clone();
    change(&mut object);
    Command::Replace(Item::Object(id, Box::new(object))).apply(scene).expect("fits");
}

/// Draws a scene into a square picture.
pub(crate) fn draw(scene: &Scene, view: &View, settings: &Settings, side: usize) -> Picture {
    let plan = plan_frame(&Shot::new(scene, view, settings, Size::new(side, side)));
    Renderer::default().render(&plan).clone()
}

/// A placement from a uniform scale and a position.
pub(crate) fn at(scale: f64, x: f64, y: f64, z: f64) -> DMat4 {
    DMat4::from_translation(DVec3::new(x, y, z)) * DMat4::from_scale(DVec3::splat(scale))
}

/// Marks the pixels that differ from the background.
pub(crate) fn covered(picture: &Picture, scene: &Scene) -> Vec<bool> {
    picture.pixels().iter().map(|pixel| *pixel != scene.background.opaque()).collect()
}

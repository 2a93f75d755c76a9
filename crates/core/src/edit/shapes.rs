//! Adds built-in shapes, in a size that fits the scene.

use glam::{DMat4, DVec3};

use super::items::insert_object;
use super::steps::{extent, rounded};
use crate::scene::{
    Bounds, Command, MaterialChoice, Object, PresetId, Scene, Shape, Sides, Tracked, View,
};

/// The size of a shape in a scene without objects, since its camera is made for ships of this size.
const ALONE: f64 = 100.0;

/// Adds a shape at the centre of the world, about a fifth as large as the scene. A plane is twice
/// as large as the scene and a ground twenty times; both touch the lowest point of the scene.
#[must_use]
pub fn insert(scene: &Scene, view: &View, shape: Shape) -> Command {
    let of_scene = match shape {
        Shape::Ground => 20.0,
        Shape::Plane => 2.0,
        Shape::Cube | Shape::Sphere | Shape::Cylinder | Shape::Torus => 0.2,
    };
    let extent = Some(extent(scene)).filter(|extent| *extent > 0.0).unwrap_or(ALONE / 0.2);
    let size = rounded(extent * of_scene).unwrap_or(ALONE);
    let place = if shape.is_ground() { ground(scene, view.time) } else { DVec3::ZERO };
    // The ground fades out by its own material.
    let material = match shape {
        Shape::Ground => MaterialChoice::File,
        Shape::Plane | Shape::Cube | Shape::Sphere | Shape::Cylinder | Shape::Torus => {
            MaterialChoice::Preset(PresetId::SILVER)
        }
    };
    let mut object = Object::new(shape.model(), material);
    object.sides = Sides::Auto;
    object.placement =
        Tracked::new(DMat4::from_translation(place) * DMat4::from_scale(DVec3::splat(size)));
    insert_object(scene, object)
}

/// Returns the centre of the bottom of the box around all objects.
fn ground(scene: &Scene, time: f64) -> DVec3 {
    let vertices = scene.objects.iter().flat_map(|(_, object)| object.placed_vertices(time));
    Bounds::of(vertices).map_or(DVec3::ZERO, |bounds| {
        let middle = bounds.centre();
        DVec3::new(middle.x, bounds.min.y, middle.z)
    })
}

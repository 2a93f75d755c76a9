//! Adds built-in shapes, in a size and at a place that fit the view.

use glam::{DMat4, DVec3};

use super::free_place::Site;
use super::items::insert_object;
use super::steps::{extent_without_grounds, rounded};
use crate::base::Shared;
use crate::scene::{
    Bounds, Command, MaterialChoice, Model, Object, PresetId, Scale, Scene, Shape, Sides, Tracked,
    View,
};

/// Adds a shape. A solid is about a fifth as large as the view, and rests on the ground next to the
/// other objects in view. A plane is twice as large as the scene and a ground twenty times; both
/// touch the lowest point of the scene.
#[must_use]
pub fn insert(scene: &Scene, view: &View, shape: Shape) -> Command {
    let site = Site::new(scene, view);
    let (size, place) = match shape {
        Shape::Ground => (site_extent(scene, &site) * 20.0, ground(scene, view.time, &site)),
        Shape::Plane => (site_extent(scene, &site) * 2.0, ground(scene, view.time, &site)),
        Shape::Cube | Shape::Sphere | Shape::Cylinder | Shape::Torus => {
            let height = shape.model().mesh.bounds().map_or(0.0, |bounds| bounds.extent().y);
            (site.size, site.place(site.size * height))
        }
    };
    let size = rounded(size).and_then(Scale::new).unwrap_or_default();
    // The ground fades out by its own material.
    let material = match shape {
        Shape::Ground => MaterialChoice::File,
        Shape::Plane | Shape::Cube | Shape::Sphere | Shape::Cylinder | Shape::Torus => {
            MaterialChoice::Preset(PresetId::SILVER)
        }
    };
    let mut object = Object::new(model(scene, shape, size), material);
    object.sides = Sides::Auto;
    object.placement = Tracked::new(DMat4::from_translation(place));
    insert_object(scene, object)
}

/// Returns the model of this shape and size. Objects of the scene share it.
fn model(scene: &Scene, shape: Shape, size: Scale) -> Shared<Model> {
    let mut models = scene.objects.iter().map(|(_, object)| &object.model);
    let is_it = |it: &&Shared<Model>| Shape::of(it) == Some(shape) && it.options.scale == size;
    models.find(is_it).cloned().unwrap_or_else(|| shape.sized(size))
}

/// Returns the extent of the objects, or the height of the view if there are none.
fn site_extent(scene: &Scene, site: &Site) -> f64 {
    extent_without_grounds(scene).filter(|extent| *extent > 0.0).unwrap_or(site.height)
}

/// Returns the centre of the bottom of the box around all objects.
fn ground(scene: &Scene, time: f64, site: &Site) -> DVec3 {
    let vertices = scene.objects.iter().flat_map(|(_, object)| object.placed_vertices(time));
    Bounds::of(vertices).map_or_else(
        || site.floor_at_focus(),
        |bounds| {
            let middle = bounds.centre();
            DVec3::new(middle.x, bounds.min.y, middle.z)
        },
    )
}

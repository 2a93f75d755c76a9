//! Copies items: next to the originals, or from text copied in this or another window.

use std::collections::BTreeMap;

use glam::{DMat4, DVec3};

use super::arrange::world_box;
use super::items::{insert_objects, put_camera, put_light};
use super::{Change, Refusal, items, selection, several};
use crate::scene::{
    Aim, AnchorMut, Camera, CameraId, CameraMode, Command, ItemId, Light, LightId, Object,
    ObjectId, Orbit, Pose, Scene, SpotOwner, Tracked, View,
};

/// The largest number of places that are tried for copies.
const MOST_IN_A_ROW: u16 = 1000;

/// Items with ids, through which they refer to each other.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Copies {
    /// The objects, in the order of the list.
    pub objects: Vec<(ObjectId, Object)>,
    /// The cameras.
    pub cameras: Vec<(CameraId, Camera)>,
    /// The lights.
    pub lights: Vec<(LightId, Light)>,
}

impl Copies {
    /// Returns whether all three lists are empty.
    pub const fn is_empty(&self) -> bool {
        self.objects.is_empty() && self.cameras.is_empty() && self.lights.is_empty()
    }
}

/// Adds copies of the selected items. Copies of objects are moved by the width of the originals, as
/// often as needed to reach a free place.
///
/// # Errors
/// If nothing is selected.
pub fn duplicate(scene: &Scene, view: &View, others: &[ItemId]) -> Change {
    let all = selection::selected(view).into_iter().chain(others.iter().copied());
    let object = |item| match item {
        ItemId::Object(id) => scene.objects.get(id),
        ItemId::Camera(_) | ItemId::Light(_) => None,
    };
    let objects: Vec<&Object> = all.filter_map(object).collect();
    let by = free_place(scene, view, &objects);
    several::each(scene, view, others, |scene, view| {
        items::duplicate(scene, selection::selected(view).ok_or(Refusal::Gone)?, by)
    })
}

/// Adds items under new ids and free names. If another object shows the same part of the same file
/// at the place of an object, all items are moved next to it. Spots and cameras stay attached to
/// copied objects.
///
/// # Errors
/// If an item is invalid in the scene.
pub fn insert(scene: &Scene, view: &View, copies: Copies) -> Change {
    let Copies { objects, cameras, lights } = copies;
    let by = free_place(scene, view, &objects.iter().map(|(_, it)| it).collect::<Vec<_>>());
    let mut after = scene.clone();
    let mut commands = Vec::new();
    let mut add = |after: &mut Scene, command: Command| -> Result<(), Refusal> {
        command.clone().apply(after)?;
        commands.push(command);
        Ok(())
    };
    // Each object is inserted at the front, so the last is inserted first.
    let mut new_objects = BTreeMap::new();
    let mut placed = Vec::new();
    for ((old, mut object), new) in objects.into_iter().rev().zip(scene.next_id..) {
        let now = *object.placement.now();
        object.placement = Tracked::new(DMat4::from_translation(by) * now);
        new_objects.insert(old, ObjectId(new));
        placed.push(object);
    }
    if !placed.is_empty() {
        let command = insert_objects(&after, placed);
        add(&mut after, command)?;
    }
    // A camera keeps orbiting an object that is copied with it. Without its target it flies.
    let mut new_cameras = BTreeMap::new();
    for (old, mut camera) in cameras {
        let pose = *camera.pose.now();
        let mode = match pose.mode {
            CameraMode::Analysis { target } => new_objects
                .get(&target)
                .map_or(CameraMode::Fly, |target| CameraMode::Analysis { target: *target }),
            CameraMode::Fly => CameraMode::Fly,
        };
        camera.pose = Tracked::new(Pose { mode, eye: pose.eye + by, ..pose });
        new_cameras.insert(old, CameraId(after.next_id));
        let command = put_camera(&after, camera);
        add(&mut after, command)?;
    }
    for (_, mut light) in lights {
        // The orbit turns a bulb's position before it is shown, so `by` is turned back.
        let orbit = light.kind.orbit().copied().unwrap_or_default();
        let turned_back = Orbit { speed: -orbit.speed, ..orbit }.at(by, view.time);
        match light.kind.anchor_mut() {
            AnchorMut::Position(position) => {
                *position = Tracked::new(*position.now() + turned_back);
            }
            AnchorMut::Owner(SpotOwner::Fixed(aim)) => {
                let now = *aim.now();
                *aim = Tracked::new(Aim { position: now.position + by, ..now });
            }
            AnchorMut::Owner(owner) => {
                *owner = attached(scene, owner, &new_objects, &new_cameras);
            }
            AnchorMut::Everywhere | AnchorMut::Direction(_) => {}
        }
        let command = put_light(&after, light)?;
        add(&mut after, command)?;
    }
    Ok(Command::Batch(commands))
}

/// Returns the owner of a copied spot: the copy of the owner, the owner itself if it exists here,
/// or else the selected item of the same kind.
fn attached(
    scene: &Scene,
    owner: &SpotOwner,
    objects: &BTreeMap<ObjectId, ObjectId>,
    cameras: &BTreeMap<CameraId, CameraId>,
) -> SpotOwner {
    match owner {
        SpotOwner::Object(id) => match objects.get(id) {
            Some(new) => SpotOwner::Object(*new),
            None if scene.objects.get(*id).is_some() => owner.clone(),
            None => SpotOwner::SelectedObject,
        },
        SpotOwner::Camera(id) => match cameras.get(id) {
            Some(new) => SpotOwner::Camera(*new),
            None if scene.cameras.get(*id).is_some() => owner.clone(),
            None => SpotOwner::SelectedCamera,
        },
        SpotOwner::SelectedObject | SpotOwner::SelectedCamera | SpotOwner::Fixed(_) => {
            owner.clone()
        }
    }
}

/// Returns the translation that takes copies of these objects to a free place: a multiple of their
/// width.
fn free_place(scene: &Scene, view: &View, objects: &[&Object]) -> DVec3 {
    let step = width(scene, view, objects);
    let is_taken = |by: DVec3| {
        objects.iter().any(|object| {
            let place = DMat4::from_translation(by) * *object.placement.now();
            let parts: Vec<u32> = object.shown_parts().collect();
            scene.objects.iter().any(|(_, other)| {
                other.placement.now().abs_diff_eq(place, 1e-9 * step.length())
                    && other.model.shares_file_with(&object.model)
                    && parts.iter().any(|part| other.shows_part(*part))
            })
        })
    };
    let places = (0..MOST_IN_A_ROW).map(|count| step * f64::from(count));
    places.into_iter().find(|by| !is_taken(*by)).unwrap_or(step)
}

/// Returns the total width of objects, along the horizontal world axis that points most to the
/// right in the picture.
fn width(scene: &Scene, view: &View, objects: &[&Object]) -> DVec3 {
    let right = scene.observer_frame(view).x_axis.truncate();
    let axis = if right.x.abs() >= right.z.abs() {
        DVec3::X * right.x.signum()
    } else {
        DVec3::Z * right.z.signum()
    };
    let boxes = objects.iter().filter_map(|object| world_box(object, view.time));
    let joined = boxes.reduce(|all, other| all.around(&other));
    let width = joined.map_or(DVec3::ZERO, |bounds| bounds.extent());
    let by = axis * width.dot(axis.abs());
    if by.is_finite() { by } else { DVec3::ZERO }
}

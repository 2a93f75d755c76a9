//! The places of items: all that moving, turning and scaling them changes.
//!
//! An amount that is dragged or typed counts from the places at its beginning. Other changes that
//! are made meanwhile, such as a reloaded model, stay.

use glam::{DMat4, DVec3};

use crate::scene::{Aim, AnchorMut, Command, Item, ItemId, Light, Pose, Scene, SpotOwner, Tracked};

/// The places of some items.
#[derive(Clone, Debug, PartialEq)]
pub struct ItemPlaces(Vec<(ItemId, Place)>);

#[derive(Clone, Debug, PartialEq)]
enum Place {
    Object(Tracked<DMat4>),
    Camera(Tracked<Pose>),
    /// The direction of a sun, or the position of a bulb.
    Light(Tracked<DVec3>),
    Spot(Tracked<Aim>),
}

impl ItemPlaces {
    /// Returns the places of these items, as far as they have any.
    pub fn of(scene: &Scene, ids: &[ItemId]) -> Self {
        let place = |id: &ItemId| Some((*id, Place::of(&item(scene, *id)?)?));
        Self(ids.iter().filter_map(place).collect())
    }

    /// Returns a scene with the items at these places.
    #[must_use]
    pub fn given_to(&self, scene: &Scene) -> Scene {
        let mut placed = scene.clone();
        for (id, place) in &self.0 {
            if let Some(mut item) = item(scene, *id) {
                place.give_to(&mut item);
                // An item of the scene can be replaced.
                let _ = Command::Replace(item).apply(&mut placed);
            }
        }
        placed
    }
}

impl Place {
    fn of(item: &Item) -> Option<Self> {
        match item {
            Item::Object(_, object) => Some(Self::Object(object.placement.clone())),
            Item::Camera(_, camera) => Some(Self::Camera(camera.pose.clone())),
            Item::Light(_, light) => match light.clone().kind.anchor_mut() {
                AnchorMut::Direction(v) | AnchorMut::Position(v) => Some(Self::Light(v.clone())),
                AnchorMut::Owner(SpotOwner::Fixed(aim)) => Some(Self::Spot(aim.clone())),
                AnchorMut::Everywhere | AnchorMut::Owner(_) => None,
            },
        }
    }

    /// Sets the place of an item. An item that got another kind of place meanwhile keeps it.
    fn give_to(&self, item: &mut Item) {
        match (self, item) {
            (Self::Object(place), Item::Object(_, object)) => object.placement = place.clone(),
            (Self::Camera(place), Item::Camera(_, camera)) => camera.pose = place.clone(),
            (place, Item::Light(_, light)) => place.give_to_light(light),
            _ => {}
        }
    }

    fn give_to_light(&self, light: &mut Light) {
        match (self, light.kind.anchor_mut()) {
            (Self::Light(place), AnchorMut::Direction(own) | AnchorMut::Position(own)) => {
                *own = place.clone();
            }
            (Self::Spot(place), AnchorMut::Owner(SpotOwner::Fixed(own))) => *own = place.clone(),
            _ => {}
        }
    }
}

fn item(scene: &Scene, id: ItemId) -> Option<Item> {
    Some(match id {
        ItemId::Object(id) => Item::Object(id, Box::new(scene.objects.get(id)?.clone())),
        ItemId::Camera(id) => Item::Camera(id, Box::new(scene.cameras.get(id)?.clone())),
        ItemId::Light(id) => Item::Light(id, Box::new(scene.lights.get(id)?.clone())),
    })
}

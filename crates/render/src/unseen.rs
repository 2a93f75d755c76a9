//! Finds out why an object is not visible in a picture.
//!
//! The reason is found by elimination: the object is drawn alone, then alone from both sides, then
//! alone and opaque. The first picture that shows it identifies the reason. Only invisible objects
//! are drawn again; the picture itself costs nothing extra.

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

use super::frame::draw::Draw;
use super::plan::{Effect, EffectState, explain_frame, plan_frame};
use super::renderer::Renderer;
use marraztu_core::accuracy::{LightAt, Settings, Shot};
use marraztu_core::base::image::Size;
use marraztu_core::scene::{
    Fill, ItemId, List, MaterialChoice, Object, ObjectId, Scene, Sides, Surface, View,
};

/// The reason why an object is not visible.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Unseen {
    /// The plan leaves it out, for this reason.
    LeftOut(Cow<'static, str>),
    /// Its faces are turned away, and back-face culling is on.
    TurnedAway {
        /// The number of faces.
        faces: usize,
    },
    /// Another item is in front of it.
    Covered {
        /// The item that covers most of it.
        by: ItemId,
    },
    /// It is fully transparent, or fails the alpha test, at every pixel that could show it; or it
    /// is less than half opaque, and transparency is a threshold.
    Transparent,
    /// It covers no pixel centre: it is too small, or seen edge-on.
    BetweenPixels,
    /// It is in the view, but its reason was not examined because too many objects are invisible.
    Unexamined,
}

/// The number of objects that are examined, with up to three pictures each.
const EXAMINED: usize = 16;

impl fmt::Display for Unseen {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::LeftOut(reason) => f.write_str(reason),
            Self::TurnedAway { faces: 1 } => f.write_str("its only face is turned away"),
            Self::TurnedAway { .. } => f.write_str("all of its faces are turned away"),
            Self::Covered { .. } => f.write_str("it is behind other objects"),
            Self::Transparent => f.write_str("it is wholly transparent"),
            Self::BetweenPixels => f.write_str("it is smaller than a pixel, or seen edge-on"),
            Self::Unexamined => f.write_str("it is too small, turned away or behind others"),
        }
    }
}

/// Lists the objects that should be visible in the renderer's last picture, but are not. `shot`
/// must belong to that picture.
///
/// Objects that the user hid, completely or part by part, are not listed.
#[must_use]
pub fn unseen(renderer: &mut Renderer, shot: &Shot) -> Vec<(ObjectId, Unseen)> {
    let Shot { scene, view, size, settings } = shot;
    // Visibility does not depend on light, and light at faces is the fastest.
    let settings = Settings {
        light: LightAt::Face,
        transparency: settings.transparency,
        ..Settings::default()
    };
    let wanted = scene.objects.iter().filter(|(id, object)| is_wanted(view, *id, object));
    let wanted: BTreeSet<ItemId> = wanted.map(|(id, _)| ItemId::Object(id)).collect();
    // If the picture shows all of them, nothing has to be examined.
    let Some(whole) = renderer.items_unless_all_seen(wanted.clone()) else { return Vec::new() };
    let seen: BTreeSet<ItemId> = whole.iter().flatten().copied().collect();
    let left_out = left_out(shot);
    let (size, renderer) = (*size, Renderer::default());
    let mut alone = Alone { scene, view, settings, size, whole, renderer };
    let objects = wanted.difference(&seen).filter_map(|item| match item {
        ItemId::Object(id) => Some(*id),
        ItemId::Camera(_) | ItemId::Light(_) => None,
    });
    let reason = |(i, id)| {
        let planned = left_out.get(&ItemId::Object(id)).cloned();
        let reason = match planned {
            planned if i < EXAMINED => alone.reason(id, planned),
            Some(reason) => Unseen::LeftOut(reason),
            None => Unseen::Unexamined,
        };
        (id, reason)
    };
    objects.enumerate().map(reason).collect()
}

/// Returns the plan's reasons for the items it does not draw.
fn left_out(shot: &Shot) -> BTreeMap<ItemId, Cow<'static, str>> {
    let (plan, uses) = explain_frame(shot);
    let is_drawn = |draw: &&Draw| draw.part_pipelines.iter().any(Option::is_some);
    let drawn: BTreeSet<ItemId> =
        plan.draws.iter().filter(is_drawn).map(|draw| draw.item).collect();
    uses.into_iter()
        .filter_map(|one| match (one.effect, one.on, one.state) {
            (Effect::Surfaces, Some(thing), EffectState::LeftOut(reason)) => {
                Some((thing.item, reason))
            }
            _ => None,
        })
        // An item that is drawn in part is not left out.
        .filter(|(item, _)| !drawn.contains(item))
        .collect()
}

/// Returns whether the user expects to see an object.
fn is_wanted(view: &View, id: ObjectId, object: &Object) -> bool {
    let parts = object.model.mesh.parts().len();
    view.shows(id, object)
        && view.polygons.is_none()
        && (parts == 0 || object.model.is_placeholder() || object.hidden_parts.len() < parts)
}

/// Draws one object of a scene at a time.
struct Alone<'a> {
    scene: &'a Scene,
    view: &'a View,
    settings: Settings,
    size: Size,
    /// The item at each pixel of the whole picture.
    whole: Vec<Option<ItemId>>,
    renderer: Renderer,
}

impl Alone<'_> {
    /// Finds the reason why an object is not visible. `left_out` is the plan's reason if it leaves
    /// the object out.
    fn reason(&mut self, id: ObjectId, left_out: Option<Cow<'static, str>>) -> Unseen {
        let Some(object) = self.scene.objects.get(id) else {
            return Unseen::LeftOut("it is not in the scene".into());
        };
        let faces = object.model.mesh.polygon_count();
        // Alone: if it shows now, another item covered it.
        if left_out.is_none() {
            let seen = self.draw(id, |_| {});
            if let Some(by) = self.most_seen(&seen) {
                return Unseen::Covered { by };
            }
        }
        // From both sides: if it shows now, its faces are turned away. If not, try it opaque.
        if object.is_two_sided() || faces == 0 || self.is_empty(id, |o| o.sides = Sides::Two) {
            // A plain material of full opacity, without textures.
            let opaque = |object: &mut Object| {
                object.sides = Sides::Two;
                object.opacity = 1.0;
                object.surface = Surface::Material;
                object.material = MaterialChoice::Own(object.part_look(0).material);
            };
            return match left_out {
                _ if faces > 0 && !self.is_empty(id, opaque) => Unseen::Transparent,
                Some(reason) => Unseen::LeftOut(reason),
                None => Unseen::BetweenPixels,
            };
        }
        Unseen::TurnedAway { faces }
    }

    /// Returns the item that the whole picture shows at most of these pixels, if it shows any.
    fn most_seen(&self, pixels: &[bool]) -> Option<ItemId> {
        let mut counts: BTreeMap<ItemId, usize> = BTreeMap::new();
        let chosen = self.whole.iter().zip(pixels).filter(|(_, chosen)| **chosen);
        for item in chosen.filter_map(|(item, _)| *item) {
            *counts.entry(item).or_default() += 1;
        }
        counts.into_iter().max_by_key(|(_, count)| *count).map(|(item, _)| item)
    }

    fn is_empty(&mut self, id: ObjectId, change: impl FnOnce(&mut Object)) -> bool {
        !self.draw(id, change).contains(&true)
    }

    /// Returns the pixels that show a changed object drawn alone, as a flag for each pixel.
    fn draw(&mut self, id: ObjectId, change: impl FnOnce(&mut Object)) -> Vec<bool> {
        let mut own = self.scene.objects.get(id).expect("it is in the scene").clone();
        change(&mut own);
        // The observer may be another object, which stays in the scene but invisible.
        let selected = self.view.object.filter(|other| *other != id);
        let selected = selected.and_then(|other| Some((other, self.scene.objects.get(other)?)));
        let hidden = selected.map(|(id, object)| (id, Object { visible: false, ..object.clone() }));
        let scene = Scene {
            objects: hidden.into_iter().chain([(id, own)]).collect(),
            cameras: self.scene.cameras.clone(),
            lights: List::default(),
            background: self.scene.background,
            next_id: self.scene.next_id,
            locked: self.scene.locked.clone(),
        };
        let view = View { marks: false, fill: Fill::Filled, ..self.view.clone() };
        let plan = plan_frame(&Shot::new(&scene, &view, &self.settings, self.size));
        self.renderer.render(&plan);
        self.renderer.pixels_of(ItemId::Object(id))
    }
}

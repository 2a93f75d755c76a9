//! The properties of several selected items: lists the differences, and applies a change to all.

use egui::{RichText, Ui};

use super::camera::camera_turn;
use super::object::object_turn;
use crate::app::state::State;
use crate::app::widgets::mixed::set_mixed;
use marraztu_core::edit::angles::nearest;
use marraztu_core::edit::placement;
use marraztu_core::scene::{Anchor, Attenuation, ItemId, Light, Scene, SpotOwner};

/// Reports the number of items that a change sets, and the properties in which they differ. Returns
/// the other items of the same kind.
pub(super) fn note_ui(ui: &mut Ui, state: &State, item: ItemId) -> Vec<ItemId> {
    let same_kind = |other: &ItemId| std::mem::discriminant(other) == std::mem::discriminant(&item);
    let others: Vec<ItemId> = state.others().into_iter().filter(same_kind).collect();
    if others.is_empty() {
        return others;
    }
    let kind = match item {
        ItemId::Object(_) => "objects",
        ItemId::Camera(_) => "cameras",
        ItemId::Light(_) => "lights",
    };
    ui.label(RichText::new(format!("{} {kind}: changes apply to all", others.len() + 1)).strong());
    let differ = mixed(&state.scene, item, &others);
    if differ.is_empty() {
        ui.weak("All have the same values.");
    } else {
        ui.weak(format!("Mixed: {}", differ.join(", ").to_lowercase()));
    }
    let numbers = others.iter().flat_map(|other| numbers(&state.scene, item, *other));
    set_mixed(ui.ctx(), numbers.chain(differ.into_iter().map(str::to_owned)).collect());
    others
}

/// Returns the label of a change to an item and to others.
pub(super) fn label(verb: &str, name: &str, others: &[ItemId]) -> String {
    match others.len() {
        0 => format!("{verb} {name}"),
        more => format!("{verb} {name} and {more} more"),
    }
}

/// Names the number fields that differ between two items of a kind.
fn numbers(scene: &Scene, first: ItemId, other: ItemId) -> Vec<String> {
    let (Some(a), Some(b)) = (fields(scene, first, first), fields(scene, other, first)) else {
        return Vec::new();
    };
    let differs = |(name, a): &(String, f64)| {
        let b = b.iter().find(|(other, _)| other == name);
        b.is_some_and(|(_, b)| (a - b).abs() > 1e-9 * a.abs().max(1.0))
    };
    a.into_iter().filter(differs).map(|(name, _)| name).collect()
}

/// Lists the number fields of an item, by their names in the panel. Angles are not unique: they are
/// the ones nearest to those of the item `like`.
fn fields(scene: &Scene, id: ItemId, like: ItemId) -> Option<Vec<(String, f64)>> {
    let mut all = Fields(Vec::new());
    match id {
        ItemId::Object(id) => {
            let object = scene.objects.get(id)?;
            let m = object.placement.now();
            all.vector("Position", placement::translation(m));
            let own = placement::turn_degrees(m);
            let ItemId::Object(like) = like else { return None };
            let last = placement::turn_degrees(scene.objects.get(like)?.placement.now());
            all.vector("Rotation", nearest(own, last, object_turn));
            all.vector("Scale", placement::scale(m));
            all.number("Opacity", object.opacity);
            all.number("Spin speed", object.spin.speed);
            all.number("Crease angle", object.model.options.crease.get());
        }
        ItemId::Camera(id) => {
            let camera = scene.cameras.get(id)?;
            let (pose, lens) = (camera.pose.now(), camera.lens);
            all.vector("Position", pose.eye);
            let ItemId::Camera(like) = like else { return None };
            let last = placement::camera_degrees(scene.cameras.get(like)?.pose.now());
            let own = nearest(placement::camera_degrees(pose), last, camera_turn);
            let [yaw, pitch, roll] = own.to_array();
            for (name, value) in [
                ("Yaw", yaw),
                ("Pitch", pitch),
                ("Roll", roll),
                ("Field of view", 2.0 * lens.half_angle),
                ("Near", lens.near),
                ("Far", lens.far),
                ("Half-size", lens.half_size),
                ("Orthographic near", lens.parallel_near),
                ("Orthographic far", lens.parallel_far),
            ] {
                all.number(name, value);
            }
        }
        ItemId::Light(id) => all.light(scene.lights.get(id)?),
    }
    Some(all.0)
}

struct Fields(Vec<(String, f64)>);

impl Fields {
    fn number(&mut self, name: &str, value: f64) {
        self.0.push((name.to_owned(), value));
    }

    fn vector(&mut self, name: &str, v: glam::DVec3) {
        for (letter, value) in ["X", "Y", "Z"].into_iter().zip(v.to_array()) {
            self.0.push((format!("{name} {letter}"), value));
        }
    }

    fn light(&mut self, light: &Light) {
        for (name, value) in ["Red", "Green", "Blue"].into_iter().zip(light.color.0) {
            self.number(&format!("{name} as a number"), f64::from(value));
        }
        let Attenuation { constant, linear, quadratic } = light.attenuation;
        for (name, value) in [("Constant", constant), ("Linear", linear), ("Quadratic", quadratic)]
        {
            self.number(name, value);
        }
        for (row, now) in light.kind.numbers() {
            self.number(row.name, now);
        }
        match light.kind.anchor() {
            Anchor::Everywhere => {}
            Anchor::Direction(direction) => self.vector("Direction", *direction.now()),
            Anchor::Position(position) => self.vector("Position", *position.now()),
            Anchor::Owner(owner) => {
                if let Some(aim) = owner.fixed() {
                    self.vector("Position", aim.now().position);
                    self.vector("Direction", aim.now().direction);
                }
            }
        }
        if let Some(orbit) = light.kind.orbit() {
            self.number("Circling speed", orbit.speed);
        }
    }
}

/// Names the properties that differ between the first item and others, as in the panel.
fn mixed(scene: &Scene, first: ItemId, others: &[ItemId]) -> Vec<&'static str> {
    let mut names: Vec<&'static str> = Vec::new();
    for other in others {
        for name in differing(scene, first, *other) {
            if !names.contains(&name) {
                names.push(name);
            }
        }
    }
    names
}

/// Names the properties that differ between two items of a kind. Choices have the names of their
/// controls.
fn differing(scene: &Scene, first: ItemId, other: ItemId) -> Vec<&'static str> {
    let rows: Vec<(bool, &'static str)> = match (first, other) {
        (ItemId::Object(a), ItemId::Object(b)) => {
            let (Some(a), Some(b)) = (scene.objects.get(a), scene.objects.get(b)) else {
                return Vec::new();
            };
            let (m, n) = (a.placement.now(), b.placement.now());
            // Rounding errors of decomposed matrices do not count as differences.
            let near = |a: glam::DVec3, b: glam::DVec3| a.distance(b) <= 1e-9 * a.length().max(1.0);
            let turns = (placement::turn_degrees(m), placement::turn_degrees(n));
            vec![
                (placement::translation(m) != placement::translation(n), "Position"),
                (!near(turns.0, turns.1), "Rotation"),
                (!near(placement::scale(m), placement::scale(n)), "Scale"),
                (a.material != b.material, "Material"),
                (a.surface != b.surface, "Surface"),
                (a.texture != b.texture, "Texture"),
                (a.tint != b.tint, "Tint"),
                (a.opacity != b.opacity, "Opacity"),
                (a.spin != b.spin, "Spin"),
                (a.sides != b.sides, "Sides"),
                (a.file_normals != b.file_normals, "Normals"),
                (a.edge_color != b.edge_color, "Edges"),
                (a.model.options.crease != b.model.options.crease, "Crease"),
                (a.model.options.up != b.model.options.up, "Up axis"),
            ]
        }
        (ItemId::Camera(a), ItemId::Camera(b)) => {
            let (Some(a), Some(b)) = (scene.cameras.get(a), scene.cameras.get(b)) else {
                return Vec::new();
            };
            vec![
                (a.pose.now().eye != b.pose.now().eye, "Position"),
                (a.pose.now().axes != b.pose.now().axes, "Rotation"),
                (a.lens != b.lens, "Lens"),
                (a.material != b.material, "Material"),
            ]
        }
        (ItemId::Light(a), ItemId::Light(b)) => {
            let (Some(a), Some(b)) = (scene.lights.get(a), scene.lights.get(b)) else {
                return Vec::new();
            };
            let cone = |light: &Light| -> Vec<f64> {
                light.kind.numbers().map(|(_, number)| number).collect()
            };
            let (sky, others) = (a.kind.panorama(), b.kind.panorama());
            vec![
                (a.on != b.on, "On"),
                (a.shadows != b.shadows, "Shadows"),
                (a.color != b.color, "Colour"),
                (a.attenuation != b.attenuation, "Attenuation"),
                (cone(a) != cone(b), "Cone"),
                (!same_owner(a.kind.owner(), b.kind.owner()), "Owner"),
                (sky.map(|it| &it.panorama) != others.map(|it| &it.panorama), "Panorama"),
                (sky.map(|it| it.turn) != others.map(|it| it.turn), "Turn"),
                (sky.map(|it| it.is_shown) != others.map(|it| it.is_shown), "Background"),
                (a.kind != b.kind, "Place"),
            ]
        }
        _ => Vec::new(),
    };
    rows.into_iter().filter_map(|(differ, name)| differ.then_some(name)).collect()
}

/// Returns whether two spots shine from the same item, or both from a place of their own.
fn same_owner(a: Option<&SpotOwner>, b: Option<&SpotOwner>) -> bool {
    matches!((a, b), (Some(SpotOwner::Fixed(_)), Some(SpotOwner::Fixed(_)))) || a == b
}

//! The properties of several selected items: what differs among them is said, and a change sets all
//! of them.

use egui::{RichText, Ui};

use crate::app::actions::Request;
use crate::app::state::State;
use crate::app::widgets::number::set_mixed;
use crate::edit::{placement, several as together};
use crate::scene::{ItemId, Light, Scene};

/// Says how many items a change sets, and in which properties they differ. Gives those of the
/// selected one's kind.
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
    ui.label(RichText::new(format!("{} {kind}: a change sets all", others.len() + 1)).strong());
    let differ = mixed(&state.scene, item, &others);
    if differ.is_empty() {
        ui.weak("All have the same values.");
    } else {
        ui.weak(format!("Mixed: {}", differ.join(", ")));
    }
    let numbers = others.iter().flat_map(|other| numbers(&state.scene, item, *other));
    set_mixed(ui.ctx(), numbers.collect());
    others
}

/// Lets every change that the panel asks for set all of them.
pub(super) fn spread(ui: &Ui, state: &State, others: &[ItemId], requests: &mut [Request]) {
    if others.is_empty() {
        return;
    }
    set_mixed(ui.ctx(), Vec::new());
    for request in requests {
        if let Request::Change { command, label, .. } = request {
            let one = command.clone();
            *command = together::spread(&state.scene, one, others);
            *label = format!("{label} and {} more", others.len());
        }
    }
}

/// The names of the fields whose numbers differ between two items of a kind.
fn numbers(scene: &Scene, first: ItemId, other: ItemId) -> Vec<String> {
    let mut names = Vec::new();
    let mut vector = |name: &str, a: glam::DVec3, b: glam::DVec3| {
        for (i, letter) in ["X", "Y", "Z"].into_iter().enumerate() {
            if (a[i] - b[i]).abs() > 1e-9 * a[i].abs().max(1.0) {
                names.push(format!("{name} {letter}"));
            }
        }
    };
    match (first, other) {
        (ItemId::Object(a), ItemId::Object(b)) => {
            let at = |id| scene.objects.get(id).map(|object| *object.placement.now());
            if let (Some(a), Some(b)) = (at(a), at(b)) {
                vector("Position", placement::translation(&a), placement::translation(&b));
                vector("Rotation", placement::turn_degrees(&a), placement::turn_degrees(&b));
                vector("Scale", placement::scale(&a), placement::scale(&b));
            }
        }
        (ItemId::Camera(a), ItemId::Camera(b)) => {
            let at = |id| scene.cameras.get(id).map(|camera| camera.pose.now().eye);
            if let (Some(a), Some(b)) = (at(a), at(b)) {
                vector("Position", a, b);
            }
        }
        (ItemId::Light(a), ItemId::Light(b)) => {
            let (Some(a), Some(b)) = (scene.lights.get(a), scene.lights.get(b)) else {
                return names;
            };
            for (i, name) in ["Red", "Green", "Blue"].into_iter().enumerate() {
                if a.color.0[i] != b.color.0[i] {
                    names.push(format!("{name} as a number"));
                }
            }
        }
        _ => {}
    }
    names
}

/// The properties in which items differ from the first, by their names in the panel.
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

/// The properties in which two items of a kind differ.
fn differing(scene: &Scene, first: ItemId, other: ItemId) -> Vec<&'static str> {
    let rows: Vec<(bool, &'static str)> = match (first, other) {
        (ItemId::Object(a), ItemId::Object(b)) => {
            let (Some(a), Some(b)) = (scene.objects.get(a), scene.objects.get(b)) else {
                return Vec::new();
            };
            let (m, n) = (a.placement.now(), b.placement.now());
            let near = |a: glam::DVec3, b: glam::DVec3| a.distance(b) <= 1e-9 * a.length().max(1.0);
            let turns = (placement::turn_degrees(m), placement::turn_degrees(n));
            vec![
                (placement::translation(m) != placement::translation(n), "position"),
                (!near(turns.0, turns.1), "rotation"),
                (!near(placement::scale(m), placement::scale(n)), "scale"),
                (a.material != b.material, "material"),
                (a.surface != b.surface, "surface"),
                (a.texture != b.texture, "texture"),
                (a.tint != b.tint, "tint"),
                (a.spin != b.spin, "spin"),
                (a.sides != b.sides, "sides"),
                (a.file_normals != b.file_normals, "normals"),
                (a.edge_color != b.edge_color, "edges"),
                (a.model.options.crease != b.model.options.crease, "crease"),
            ]
        }
        (ItemId::Camera(a), ItemId::Camera(b)) => {
            let (Some(a), Some(b)) = (scene.cameras.get(a), scene.cameras.get(b)) else {
                return Vec::new();
            };
            vec![
                (a.pose.now().eye != b.pose.now().eye, "position"),
                (a.pose.now().axes != b.pose.now().axes, "rotation"),
                (a.lens != b.lens, "lens"),
                (a.material != b.material, "material"),
            ]
        }
        (ItemId::Light(a), ItemId::Light(b)) => {
            let (Some(a), Some(b)) = (scene.lights.get(a), scene.lights.get(b)) else {
                return Vec::new();
            };
            let cone = |light: &Light| -> Vec<f64> {
                light.kind.numbers().map(|(_, number)| number).collect()
            };
            vec![
                (a.on != b.on, "on"),
                (a.color != b.color, "colour"),
                (a.attenuation != b.attenuation, "fading"),
                (cone(a) != cone(b), "cone"),
                (a.kind != b.kind, "place"),
            ]
        }
        _ => Vec::new(),
    };
    rows.into_iter().filter_map(|(differ, name)| differ.then_some(name)).collect()
}

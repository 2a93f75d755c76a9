//! The surface of an object: material, texture, tint, opacity.

use egui::Ui;

use super::number_row;
use crate::app::actions::{Request, change};
use crate::app::state::State;
use crate::app::widgets::color_picker::swatch;
use crate::app::widgets::controls::{Choice, choices, row};
use crate::app::widgets::number::Number;
use crate::app::widgets::text::file_name;
use marraztu_core::edit::{Gesture, items};
use marraztu_core::scene::{FileMaterial, MapKind, Object, ObjectId, Surface};

pub(crate) fn show(
    ui: &mut Ui,
    state: &State,
    requests: &mut Vec<Request>,
    id: ObjectId,
    object: &Object,
) {
    let all = [
        ("Material", Surface::Material, "The material, lit."),
        ("Texture", Surface::Texture, "The texture, not lit."),
        ("Both", Surface::TextureAndLight, "The texture, lit; without a texture, the material."),
    ];
    let choice = |(label, surface, hint): &(&'static str, Surface, &'static str)| {
        Choice::new("Surface", label, object.surface == *surface, hint)
    };
    let all_choices: Vec<Choice<'_>> = all.iter().map(choice).collect();
    if let Some(clicked) = choices(ui, &all_choices) {
        let to = all[clicked].1;
        let command = items::change_object(&state.scene, id, |object| object.surface = to);
        change(requests, format!("Change the surface of {}", object.name), Gesture::Whole, command);
    }
    texture_ui(ui, state, requests, id, object);
    maps_ui(ui, object);
    row(ui, "Tint", |ui| {
        let hint = "Multiplied with the texture";
        if let Some((tint, gesture)) = swatch(ui, "Tint", hint, object.tint) {
            let command = items::change_object(&state.scene, id, |object| object.tint = tint);
            change(requests, format!("Tint {}", object.name), gesture, command);
        }
    });
    let hint = "Opacity of the object: 0 is invisible, 1 is opaque";
    let number = Number::new("Opacity", hint).speed(0.005).range(0.0..=1.0);
    if let Some((opacity, gesture)) = number_row(ui, "Opacity", number, object.opacity) {
        let command = items::change_object(&state.scene, id, |object| object.opacity = opacity);
        change(requests, format!("Change the opacity of {}", object.name), gesture, command);
    }
}

fn texture_ui(
    ui: &mut Ui,
    state: &State,
    requests: &mut Vec<Request>,
    id: ObjectId,
    object: &Object,
) {
    let by_hand = object.texture.as_ref().map(|texture| file_name(&texture.source));
    let of_file = object.model.materials.iter().any(|material| material.texture.is_some());
    let mapped = !object.model.mesh.uvs().is_empty();
    let text = by_hand.clone().unwrap_or_else(|| match (of_file, mapped) {
        (true, _) => "the file's own".to_owned(),
        (false, true) => "none".to_owned(),
        (false, false) => "none (no UV coordinates)".to_owned(),
    });
    row(ui, "Texture", |ui| {
        ui.add(egui::Label::new(&text).truncate()).on_hover_text(&text);
    });
    row(ui, "", |ui| {
        let choose = ui.button("Choose...");
        if choose.on_hover_text("Chooses a picture as the texture of the object").clicked() {
            requests.push(Request::ChooseTexture(id));
        }
        let remove = ui.add_enabled(by_hand.is_some(), egui::Button::new("Remove"));
        let hint = "Removes the chosen texture";
        if remove.on_hover_text(hint).on_disabled_hover_text(hint).clicked() {
            let command = items::change_object(&state.scene, id, |object| object.texture = None);
            let label = format!("Remove the texture of {}", object.name);
            change(requests, label, Gesture::Whole, command);
        }
    });
}

/// Lists the other maps of the object's materials, each with its file and size.
fn maps_ui(ui: &mut Ui, object: &Object) {
    for kind in MapKind::ALL {
        let of = |material: &FileMaterial| material.maps.get(&kind).map(|map| map.texture.clone());
        let mut textures: Vec<_> = object.model.materials.iter().filter_map(of).collect();
        textures.dedup_by(|a, b| a.source == b.source);
        let names: Vec<String> = textures
            .iter()
            .map(|texture| {
                let name = file_name(&texture.source);
                // Scene files mark the program's own pictures with this prefix.
                let name = name.strip_prefix("own:").unwrap_or(&name);
                let size = texture.picture.size();
                format!("{name} ({} x {})", size.width, size.height)
            })
            .collect();
        if let Some(first) = names.first() {
            let more = names.len() - 1;
            let text = if more > 0 { format!("{first}, {more} more") } else { first.clone() };
            row(ui, kind.label(), |ui| {
                let hint = format!("{} of the file: {}", kind.statement(), names.join(", "));
                ui.add(egui::Label::new(&text).truncate()).on_hover_text(hint);
            });
        }
    }
}

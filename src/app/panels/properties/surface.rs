//! The surface of an object: material, texture, tint, opacity.

use egui::Ui;

use super::number_row;
use super::object::Shown;
use crate::app::actions::{Request, Requests};
use crate::app::widgets::color_picker::swatch;
use crate::app::widgets::controls::{choose, fact, row};
use crate::app::widgets::mixed::is_mixed;
use crate::app::widgets::number::Number;
use crate::app::widgets::text::file_name;
use marraztu_core::edit::Gesture;
use marraztu_core::scene::{FileMaterial, MapKind, Object, Surface};

impl Shown<'_> {
    pub(super) fn surface_ui(&self, ui: &mut Ui, requests: &mut Requests) {
        let object = self.object;
        let all = [
            ("Material", Surface::Material, "The material, lit."),
            ("Texture", Surface::Texture, "The texture, not lit."),
            (
                "Both",
                Surface::TextureAndLight,
                "The texture, lit; without a texture, the material.",
            ),
        ];
        if let Some(to) = choose(ui, "Surface", object.surface, &all) {
            let set = |object: &mut Object| object.surface = to;
            self.set(requests, "Change the surface of", Gesture::Whole, set);
        }
        self.texture_ui(ui, requests);
        maps_ui(ui, object);
        row(ui, "Tint", |ui| {
            let hint = "Multiplied with the texture";
            if let Some((tint, gesture)) = swatch(ui, "Tint", hint, object.tint) {
                self.set(requests, "Tint", gesture, |object| object.tint = tint);
            }
        });
        let hint = "Opacity of the object: 0 is invisible, 1 is opaque";
        let number = Number::new("Opacity", hint).speed(0.005).range(0.0..=1.0);
        if let Some((opacity, gesture)) = number_row(ui, "Opacity", number, object.opacity) {
            let set = |object: &mut Object| object.opacity = opacity;
            self.set(requests, "Change the opacity of", gesture, set);
        }
    }

    fn texture_ui(&self, ui: &mut Ui, requests: &mut Requests) {
        let object = self.object;
        let by_hand = object.texture.as_ref().map(|texture| file_name(&texture.source));
        let of_file = object.model.materials.iter().any(|material| material.texture.is_some());
        let mapped = !object.model.mesh.uvs().is_empty();
        let text = by_hand.clone().unwrap_or_else(|| match (of_file, mapped) {
            (true, _) => "the file's own".to_owned(),
            (false, true) => "none".to_owned(),
            (false, false) => "none (no UV coordinates)".to_owned(),
        });
        let mixed = is_mixed(ui.ctx(), "Texture");
        fact(ui, "Texture", if mixed { "mixed" } else { &text });
        row(ui, "", |ui| {
            let choose = ui.button("Choose...");
            if choose.on_hover_text("Chooses a picture as the texture of the object").clicked() {
                requests.push(Request::ChooseTexture(self.ids()));
            }
            let remove = ui.add_enabled(mixed || by_hand.is_some(), egui::Button::new("Remove"));
            let hint = "Removes the chosen texture";
            if remove.on_hover_text(hint).on_disabled_hover_text(hint).clicked() {
                let remove = |object: &mut Object| object.texture = None;
                self.set(requests, "Remove the texture of", Gesture::Whole, remove);
            }
        });
    }
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

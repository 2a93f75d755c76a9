//! The dialog that asks for the material of a new item and for the reading of its file.

use std::path::{Path, PathBuf};

use egui::Ui;

use super::answer::End;
use crate::app::widgets::color_picker::swatch;
use crate::app::widgets::controls::{Switch, heading, take_focus};
use crate::app::widgets::spheres::{self, Sphere};
use crate::app::widgets::text::{counted, file_name};
use marraztu_core::base::color::Color;
use marraztu_core::edit::items;
use marraztu_core::scene::{
    BumpMaps, Crease, LoadOptions, Material, MaterialChoice, PresetId, Scale, UpAxis, Winding,
};
use marraztu_io::{Finding, Loaded};

#[derive(Debug)]
pub(crate) struct MaterialDialog {
    /// The model and its file; `None` if the material is for a camera.
    pub(crate) loaded: Option<(PathBuf, Loaded)>,
    choices: MaterialChoices,
    own: Material,
    scale: f64,
    crease: f64,
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct MaterialChoices {
    pub(crate) material: MaterialChoice,
    pub(crate) options: LoadOptions,
    pub(crate) texture: Option<PathBuf>,
}

impl MaterialDialog {
    /// Creates the dialog for the model of a new camera.
    pub(crate) fn of_camera() -> Self {
        Self::new(None, MaterialChoice::Preset(PresetId::OBSIDIAN), LoadOptions::default())
    }

    /// Creates the dialog for a model. The file's material is preselected if it has one.
    pub(crate) fn of_model(path: PathBuf, loaded: Loaded) -> Self {
        let material = own_or_silver(&loaded);
        let options = loaded.model.options;
        Self::new(Some((path, loaded)), material, options)
    }

    fn new(
        loaded: Option<(PathBuf, Loaded)>,
        material: MaterialChoice,
        options: LoadOptions,
    ) -> Self {
        let (scale, crease) = (options.scale.get(), options.crease.get());
        let choices = MaterialChoices { material, options, texture: None };
        Self { loaded, choices, own: Material::default(), scale, crease }
    }

    pub(crate) fn set_texture(&mut self, path: PathBuf) {
        self.choices.texture = Some(path);
    }

    /// Shows the dialog. Returns the result when it has ended.
    pub(crate) fn ui(&mut self, ui: &mut Ui) -> Option<End> {
        ui.set_width(ui.available_width().clamp(240.0, 460.0));
        match &self.loaded {
            Some((path, loaded)) => {
                heading(ui, format!("Material of {}", file_name(path)));
                ui.label(summary(loaded));
            }
            None => {
                heading(ui, "Material of the new camera");
            }
        }
        self.materials_ui(ui);
        let mut end = None;
        if self.loaded.is_some() {
            ui.add_space(4.0);
            end = self.options_ui(ui);
        }
        ui.add_space(6.0);
        ui.horizontal(|ui| {
            let take = ui.button(if self.loaded.is_some() { "Load" } else { "Add" });
            take_focus(ui, &take);
            if take.clicked() {
                end = Some(End::Material(self.choices.clone()));
            }
            if ui.button("Cancel").clicked() {
                end = Some(End::Cancelled);
            }
        });
        end
    }

    fn materials_ui(&mut self, ui: &mut Ui) {
        let now = &mut self.choices.material;
        if let Some((_, loaded)) = &self.loaded {
            let count = loaded.model.materials.len();
            let text = match count {
                0 => "From the file (it has none)".to_owned(),
                1 => "From the file".to_owned(),
                _ => format!("From the file ({count} materials)"),
            };
            let chosen = *now == MaterialChoice::File;
            if ui.add_enabled(count > 0, egui::Button::selectable(chosen, text)).clicked() {
                *now = MaterialChoice::File;
            }
        }
        egui::Grid::new("presets").num_columns(3).spacing([6.0, 2.0]).show(ui, |ui| {
            for (at, id) in PresetId::all().enumerate() {
                let choice = MaterialChoice::Preset(id);
                ui.horizontal(|ui| {
                    let (_, rect) = ui.allocate_space(egui::vec2(22.0, 22.0));
                    spheres::paint(ui, rect, Sphere::Preset(id));
                    if ui.selectable_label(*now == choice, id.get().name).clicked() {
                        *now = choice;
                    }
                });
                if at % 3 == 2 {
                    ui.end_row();
                }
            }
        });
        // The user's material survives a change to a preset and back.
        let mut own = matches!(now, MaterialChoice::Own(_));
        if ui.toggle_value(&mut own, "Custom").clicked() {
            *now = MaterialChoice::Own(self.own);
        }
        if let MaterialChoice::Own(material) = now {
            own_ui(ui, material);
            self.own = *material;
        }
    }

    fn options_ui(&mut self, ui: &mut Ui) -> Option<End> {
        // The crease angle has no effect on some models, such as those with normals in their files.
        let idle = self.loaded.as_ref().and_then(|(_, loaded)| {
            let why = items::why_no_crease(&loaded.model, true)?;
            Some(format!("Off: {why}"))
        });
        let options = &mut self.choices.options;
        let mut end = None;
        egui::CollapsingHeader::new("Import options").show(ui, |ui| {
            ui.horizontal(|ui| {
                ui.label("Up axis");
                for up in UpAxis::ALL {
                    ui.selectable_value(&mut options.up, up, up.word().to_uppercase());
                }
            });
            ui.horizontal(|ui| {
                let label = ui.label("Scale");
                let value = egui::DragValue::new(&mut self.scale).speed(0.01).range(1e-9..=1e9);
                ui.add(value).labelled_by(label.id);
                options.scale = Scale::new(self.scale).unwrap_or_default();
            });
            let mut turned = options.winding == Winding::Turned;
            turned ^= Switch::new("Flip faces (inside out)", turned).ui(ui).clicked();
            options.winding = if turned { Winding::Turned } else { Winding::Kept };
            ui.horizontal(|ui| {
                let label = ui.label("Crease angle");
                let value = egui::DragValue::new(&mut self.crease).speed(0.5).range(0.0..=180.0);
                let field = ui.add_enabled(idle.is_none(), value.suffix(" deg"));
                let hint = "Edges are sharp if their faces differ by this angle or more";
                field
                    .labelled_by(label.id)
                    .on_hover_text(hint)
                    .on_disabled_hover_text(idle.as_deref().unwrap_or(hint));
                options.crease = Crease::new(self.crease).unwrap_or_default();
            });
            ui.horizontal(|ui| {
                ui.label("Bump maps");
                for (bumps, label) in [
                    (BumpMaps::Auto, "Automatic"),
                    (BumpMaps::Heights, "Heights"),
                    (BumpMaps::Normals, "Normals"),
                ] {
                    ui.selectable_value(&mut options.bumps, bumps, label);
                }
            });
            ui.horizontal(|ui| {
                let texture = self.choices.texture.as_deref().map(file_name);
                ui.label(format!("Texture: {}", texture.as_deref().unwrap_or("the file's own")));
                if ui.button("Choose...").clicked() {
                    end = Some(End::Asked);
                }
                if texture.is_some() && ui.button("Remove").clicked() {
                    self.choices.texture = None;
                }
            });
        });
        end
    }
}

/// Returns the file's material if it has one, else silver.
pub(crate) fn own_or_silver(loaded: &Loaded) -> MaterialChoice {
    if loaded.model.materials.is_empty() {
        MaterialChoice::Preset(PresetId::SILVER)
    } else {
        MaterialChoice::File
    }
}

/// Summarises a model: "6,320 faces, 3,644 vertices", with its lines and points if it has any. If
/// the file had losses, the first one follows with its file, and the number of further findings.
pub(crate) fn summary(loaded: &Loaded) -> String {
    let mesh = &loaded.model.mesh;
    let [lines, points] = mesh.stroke_counts();
    let counts = [
        (mesh.polygon_count(), "face", "faces"),
        (lines, "line", "lines"),
        (points, "point", "points"),
        (mesh.positions().len(), "vertex", "vertices"),
    ];
    let there = |(count, one, _): &(usize, &str, &str)| {
        *count > 0 || (*one == "face" && mesh.strokes().is_empty()) || *one == "vertex"
    };
    let counts = counts.into_iter().filter(there);
    let counts = counts.map(|(count, one, many)| counted(count, one, many));
    let counts = counts.collect::<Vec<_>>().join(", ");
    let more = loaded.findings.len().saturating_sub(1);
    match (loaded.findings.iter().find(|it| it.kind.is_loss()), more) {
        (None, _) => counts,
        (Some(lost), 0) => format!("{counts}; {}", short(lost)),
        (Some(lost), 1) => format!("{counts}; {}; 1 more finding", short(lost)),
        (Some(lost), more) => format!("{counts}; {}; {more} more findings", short(lost)),
    }
}

/// Returns the notice about a model: "Opened ...", or its first loss.
pub(crate) fn opened(loaded: &Loaded) -> String {
    let (name, summary) = (&loaded.model.name, summary(loaded));
    match loaded.findings.iter().any(|finding| finding.kind.is_loss()) {
        true => format!("{name}: {summary}"),
        false => format!("Opened {name}: {summary}"),
    }
}

/// Lists all findings, one per line, losses first.
pub(crate) fn details(findings: &[Finding]) -> Vec<String> {
    let (lost, mended): (Vec<&Finding>, Vec<&Finding>) =
        findings.iter().partition(|finding| finding.kind.is_loss());
    lost.into_iter().chain(mended).map(ToString::to_string).collect()
}

/// Formats a finding with the name of its file, without folders.
pub(crate) fn short(finding: &Finding) -> String {
    format!("{}: {}", file_name(Path::new(&finding.file)), finding.text)
}

/// Shows Ka, Kd, Ks and Ns of the user's material.
fn own_ui(ui: &mut Ui, material: &mut Material) {
    ui.horizontal(|ui| {
        let parts = [
            ("Ambient", &mut material.ambient),
            ("Diffuse", &mut material.diffuse),
            ("Specular", &mut material.specular),
        ];
        for (name, factors) in parts {
            ui.label(name);
            if let Some((color, _)) = swatch(ui, name, name, Color::from_factors(*factors)) {
                *factors = color.factors();
            }
        }
        let label = ui.label("Exponent");
        let value = egui::DragValue::new(&mut material.exponent).range(0.0..=1000.0).speed(0.5);
        ui.add(value).labelled_by(label.id);
    });
}

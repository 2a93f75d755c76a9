//! The options for saving a picture or a turntable.

use std::path::PathBuf;

use egui::{DragValue, Key, Ui};
use serde::{Deserialize, Serialize};

use super::answer::{Answer, End};
use crate::app::widgets::controls::{Switch, choose, heading, take_focus};
use marraztu_core::accuracy::Samples;
use marraztu_core::base::image::Size;
use marraztu_core::edit::turntable::Turn;

/// The longest side that a picture may have.
const LONGEST_SIDE: usize = 16_384;

/// The kind of file to save.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Purpose {
    Picture,
    Turntable,
}

impl Purpose {
    /// Returns the default name without its extension, and the extension.
    pub(crate) const fn file(self) -> (&'static str, &'static str) {
        match self {
            Self::Picture => ("picture", "png"),
            Self::Turntable => ("turntable", "gif"),
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct PictureChoices {
    pub(crate) purpose: Purpose,
    /// The size before multiplication by `times`.
    pub(crate) size: Size,
    /// The factor for both sides.
    pub(crate) times: usize,
    pub(crate) samples: Samples,
    pub(crate) transparent: bool,
    /// Whether the overlays of the window are saved too. The picture then equals the window's.
    pub(crate) overlays: bool,
    pub(crate) frames: u32,
    pub(crate) seconds: f64,
    pub(crate) turn: Turn,
    /// Whether a turntable becomes a folder of numbered pictures.
    pub(crate) numbered: bool,
}

impl PictureChoices {
    /// Returns the default options for a window with this size and number of samples.
    pub(crate) const fn new(purpose: Purpose, size: Size, samples: Samples) -> Self {
        Self {
            purpose,
            size,
            times: 1,
            samples,
            transparent: false,
            overlays: false,
            frames: 60,
            seconds: 4.0,
            turn: Turn::Objects,
            numbered: false,
        }
    }

    /// Returns the file to write for a chosen path; for numbered pictures, the folder, which has no
    /// extension.
    pub(crate) fn target(&self, path: PathBuf) -> PathBuf {
        if self.numbered { path.with_extension("") } else { path }
    }

    /// Returns the size of the picture.
    pub(crate) fn whole(&self) -> Size {
        let side = |side: usize| (side * self.times).clamp(1, LONGEST_SIDE);
        Size::new(side(self.size.width), side(self.size.height))
    }
}

#[derive(Debug)]
pub(crate) struct PictureDialog {
    choices: PictureChoices,
    /// The size of the window's picture, which a picture with overlays has.
    window: Size,
    /// The folder of the last file.
    folder: PathBuf,
    /// The text of the file field.
    file: String,
}

impl PictureDialog {
    /// Creates the dialog and proposes a new file in `folder`.
    pub(crate) fn new(choices: PictureChoices, folder: PathBuf) -> Self {
        let (stem, ending) = choices.purpose.file();
        let named = |n: u32| match n {
            1 => format!("{stem}.{ending}"),
            n => format!("{stem} {n}.{ending}"),
        };
        let file = (1..).map(named).find(|name| !folder.join(name).exists()).unwrap_or_default();
        Self { choices, window: choices.size, folder, file }
    }

    /// Shows the dialog. Returns the result when it has ended.
    pub(crate) fn ui(&mut self, ui: &mut Ui) -> Option<End> {
        ui.set_width(ui.available_width().clamp(240.0, 380.0));
        let is_picture = self.choices.purpose == Purpose::Picture;
        heading(ui, if is_picture { "Save picture" } else { "Save turntable" });
        let mut entered = false;
        egui::Grid::new("picture options").num_columns(2).spacing([12.0, 6.0]).show(ui, |ui| {
            // A picture with overlays has the size and the samples of the window.
            ui.add_enabled_ui(!self.choices.overlays, |ui| ui.label("Size"));
            ui.add_enabled_ui(!self.choices.overlays, |ui| self.size_ui(ui));
            ui.end_row();
            ui.label("Samples per pixel");
            ui.add_enabled_ui(!self.choices.overlays, |ui| self.samples_ui(ui));
            ui.end_row();
            if is_picture {
                ui.label("");
                let overlays = Switch::new("Overlays", self.choices.overlays).ui(ui);
                let hint =
                    "Includes the selection outline, the axes and light markers, as in the window";
                self.choices.overlays ^= overlays.on_hover_text(hint).clicked();
                ui.end_row();
            } else {
                self.turn_ui(ui);
            }
            ui.label("");
            let choices = &mut self.choices;
            ui.add_enabled_ui(!choices.overlays, |ui| {
                // The window is opaque.
                let is_on = choices.transparent && !choices.overlays;
                let ground = Switch {
                    enabled: !choices.overlays,
                    ..Switch::new("Transparent background", is_on)
                };
                let hint = "Omits the background; needs an alpha channel: PNG, APNG or WebP";
                choices.transparent ^= ground.ui(ui).on_hover_text(hint).clicked();
            });
            ui.end_row();
            let label = ui.label("File");
            let file = egui::TextEdit::singleline(&mut self.file)
                .align(egui::Align2::LEFT_CENTER)
                .desired_width(f32::INFINITY);
            let folder = self.folder.display().to_string();
            let file = ui.add(file).labelled_by(label.id).on_hover_text(format!("In {folder}"));
            entered = file.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
            ui.end_row();
        });
        let said = egui::RichText::new(self.summary()).weak();
        ui.add(egui::Label::new(said).truncate());
        ui.add_space(6.0);
        let mut end = None;
        ui.horizontal(|ui| {
            // The button announces that it would replace a file.
            let path = self.path();
            let replaces = path.is_file();
            let save = ui.button(if replaces { "Replace..." } else { "Save" });
            take_focus(ui, &save);
            if save.clicked() || entered {
                end = Some(End::Answer(Answer::Picture(self.choices, Some(path))));
            }
            if ui.button("Browse...").on_hover_text("Chooses another folder or name").clicked() {
                end = Some(End::Answer(Answer::Picture(self.choices, None)));
            }
            if ui.button("Cancel").clicked() {
                end = Some(End::Cancelled);
            }
        });
        end
    }

    /// Describes the result: "300 x 200 pixels, in /home/me".
    fn summary(&self) -> String {
        let PictureChoices { purpose, overlays, frames, numbered, .. } = self.choices;
        let Size { width, height } = if overlays { self.window } else { self.choices.whole() };
        let pixels = format!("{width} x {height} pixels");
        match purpose {
            Purpose::Picture => format!("{pixels}, in {}", self.folder.display()),
            Purpose::Turntable => {
                let path = self.path();
                let folder = if numbered { &path } else { &self.folder };
                format!("{frames} pictures of {pixels}, in {}", folder.display())
            }
        }
    }

    /// Returns the path from the file field, with an extension unless it is a folder.
    fn path(&self) -> PathBuf {
        let (stem, ending) = self.choices.purpose.file();
        let name = if self.file.trim().is_empty() { stem } else { self.file.trim() };
        let path = self.folder.join(name);
        let has_ending = path.extension().is_some();
        self.choices.target(if has_ending { path } else { path.with_extension(ending) })
    }

    fn size_ui(&mut self, ui: &mut Ui) {
        let choices = &mut self.choices;
        ui.horizontal(|ui| {
            let side = |value| DragValue::new(value).range(1..=LONGEST_SIDE).speed(4.0);
            ui.add(side(&mut choices.size.width)).accessible_name("Width");
            ui.label("x");
            ui.add(side(&mut choices.size.height)).accessible_name("Height");
            ui.label("times");
            let times = DragValue::new(&mut choices.times).range(1..=8).speed(0.05);
            ui.add(times).accessible_name("Times");
        });
    }

    fn samples_ui(&mut self, ui: &mut Ui) {
        let hint = "Smooths edges; more samples take longer.";
        let all = Samples::ALL.map(|samples| (samples.count().to_string(), samples, hint));
        let now = &mut self.choices.samples;
        *now = choose(ui, "Samples per pixel", *now, &all).unwrap_or(*now);
    }

    fn turn_ui(&mut self, ui: &mut Ui) {
        let choices = &mut self.choices;
        ui.label("Pictures");
        ui.horizontal(|ui| {
            let frames = DragValue::new(&mut choices.frames).range(2..=3600);
            ui.add(frames).accessible_name("Pictures");
            let numbered = Switch::new("Numbered files", choices.numbered).ui(ui);
            let hint = "Saves a folder of PNG files instead of an animation";
            choices.numbered ^= numbered.on_hover_text(hint).clicked();
        });
        ui.end_row();
        ui.label("Seconds per turn");
        let seconds = DragValue::new(&mut choices.seconds).range(0.1..=600.0).speed(0.1);
        ui.add(seconds).accessible_name("Seconds per turn");
        ui.end_row();
        ui.label("Turn");
        let turns = [
            (
                "Objects",
                Turn::Objects,
                "Turns the objects in front of the camera, under the same lights.",
            ),
            ("Camera", Turn::Camera, "Moves the camera around the objects."),
        ];
        choices.turn = choose(ui, "Turn", choices.turn, &turns).unwrap_or(choices.turn);
        ui.end_row();
    }
}

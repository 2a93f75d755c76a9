//! The window painted with OpenGL, by eframe.

use eframe::NativeOptions;
use egui::{Ui, ViewportBuilder, Visuals};

use super::{Make, StartError, display_error};
use crate::app::editor::App;

pub(super) fn run(viewport: ViewportBuilder, make: Make) -> Result<(), StartError> {
    // Without dithering, which makes the colours equal to those of the other shell.
    let options = NativeOptions { viewport, dithering: false, ..NativeOptions::default() };
    let make: eframe::AppCreator<'static> =
        Box::new(|creation| Ok(Box::new(Guest { editor: make(&creation.egui_ctx), left: false })));
    eframe::run_native("Marraztu", options, make).map_err(|error| explained(&error))
}

/// The editor as an app of eframe.
struct Guest {
    editor: App,
    /// Whether the window was asked to close and the editor did not object.
    left: bool,
}

impl eframe::App for Guest {
    fn ui(&mut self, ui: &mut Ui, frame: &mut eframe::Frame) {
        let asked = ui.input(|input| input.viewport().close_requested());
        self.editor.frame_within(ui, frame);
        self.left = asked;
    }

    fn clear_color(&self, visuals: &Visuals) -> [f32; 4] {
        visuals.panel_fill.to_normalized_gamma_f32()
    }

    fn on_exit(&mut self, _gl: Option<&eframe::glow::Context>) {
        // eframe also calls this if the window is lost, without a frame that asks about closing. If
        // the editor objects to closing, another frame follows before the end.
        if self.left {
            self.editor.end();
        }
    }
}

fn explained(error: &eframe::Error) -> StartError {
    match error {
        eframe::Error::WinitEventLoop(error) => display_error(error),
        eframe::Error::Glutin(_)
        | eframe::Error::NoGlutinConfigs(..)
        | eframe::Error::OpenGL(_) => StartError::NoGl,
        _ => StartError::Other(error.to_string()),
    }
}

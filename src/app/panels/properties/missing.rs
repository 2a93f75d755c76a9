//! The missing files of an item, each with a button to find it.

use std::path::Path;

use egui::Ui;

use crate::app::actions::{MissingRequest, Request};
use crate::app::widgets::text::file_name;

pub(super) fn show<'a>(
    ui: &mut Ui,
    requests: &mut Vec<Request>,
    files: impl Iterator<Item = &'a Path>,
) {
    for file in files {
        ui.horizontal_wrapped(|ui| {
            let text = format!("{} is missing", file_name(file));
            let color = ui.visuals().warn_fg_color;
            ui.colored_label(color, text).on_hover_text(file.display().to_string());
            if ui.button("Find...").on_hover_text("Locates the missing file").clicked() {
                requests.push(Request::Missing(MissingRequest::Find(Some(file.to_owned()))));
            }
        });
    }
}

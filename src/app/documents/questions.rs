//! Questions: unsaved changes, replacing a file, missing files, discarded work.
//!
//! Each function returns the answer when there is one. Cancel is `Some(End::Cancelled)`.

use std::path::{Path, PathBuf};

use egui::{ScrollArea, Ui};

use super::answer::{Answer, End};
use super::wanted::{After, ChangedFile};
use crate::app::widgets::controls::{heading, take_focus};
use crate::app::widgets::text::file_name;

const WIDTH: f32 = 440.0;

/// The narrowest margin beside the contents of a dialog.
const MARGIN: f32 = 28.0;

pub(super) fn unsaved_ui(ui: &mut Ui, after: &After) -> Option<End> {
    limit_width(ui, WIDTH);
    heading(ui, "Save the scene?");
    ui.label(match after {
        After::Quit => "Unsaved changes are lost unless you save them.",
        After::New | After::NewAncestor => {
            "A new scene will replace this one, which has unsaved changes."
        }
        After::Recover(_) | After::RecoverDiscarded(_) => {
            "Recovered work will replace this scene, which has unsaved changes."
        }
        After::Open(_) => "Another scene will replace this one, which has unsaved changes.",
    });
    ui.add_space(4.0);
    let buttons = ui.horizontal(|ui| {
        let save = ui.button("Save");
        take_focus(ui, &save);
        let discard = ui.button("Discard").clicked();
        let cancel = ui.button("Cancel").clicked();
        match (save.clicked(), discard, cancel) {
            (true, ..) => Some(End::Answer(Answer::Save(after.clone()))),
            (_, true, _) => Some(End::Answer(Answer::Discard(after.clone()))),
            (.., true) => Some(End::Cancelled),
            _ => None,
        }
    });
    buttons.inner
}

/// Asks what to do with a scene after another program has changed its file.
pub(super) fn changed_ui(ui: &mut Ui, path: &Path, after: Option<&After>) -> Option<End> {
    limit_width(ui, WIDTH);
    heading(ui, format!("{} has changed", file_name(path)));
    ui.label(
        "Another program or window has changed this file since it was opened here. Saving \
            overwrites those changes.",
    );
    ui.add_space(4.0);
    let answer =
        |choice| Some(End::Answer(Answer::Changed(choice, path.to_owned(), after.cloned())));
    let buttons = ui.horizontal_wrapped(|ui| {
        let elsewhere = ui.button("Save as...").on_hover_text("Saves under another name");
        take_focus(ui, &elsewhere);
        let hint = "Opens the changed file; changes made here are lost";
        let reload = ui.button("Reload the file").on_hover_text(hint).clicked();
        let overwrite =
            ui.button("Overwrite").on_hover_text("Overwrites the changed file").clicked();
        let cancel = ui.button("Cancel").clicked();
        match (elsewhere.clicked(), reload, overwrite, cancel) {
            (true, ..) => answer(ChangedFile::SaveElsewhere),
            (_, true, ..) => answer(ChangedFile::Reload),
            (_, _, true, _) => answer(ChangedFile::Overwrite),
            (.., true) => Some(End::Cancelled),
            _ => None,
        }
    });
    buttons.inner
}

/// Asks whether to replace a file. If so, returns the `answer` given for that file.
pub(super) fn replace_ui(
    ui: &mut Ui,
    path: &Path,
    answer: &mut Option<Box<Answer>>,
) -> Option<End> {
    limit_width(ui, WIDTH);
    heading(ui, format!("Replace {}?", file_name(path)));
    let folder = path.parent().unwrap_or(path).display();
    ui.label(format!("A file with this name already exists in {folder}."));
    ui.add_space(4.0);
    let buttons = ui.horizontal(|ui| {
        // Cancel has the focus, so pressing Enter twice replaces nothing.
        let cancel = ui.button("Keep it");
        take_focus(ui, &cancel);
        let replace = ui.button("Replace").clicked();
        match (replace, cancel.clicked()) {
            (true, _) => Some(answer.take().map_or(End::Cancelled, |answer| End::Answer(*answer))),
            (_, true) => Some(End::Cancelled),
            _ => None,
        }
    });
    buttons.inner
}

/// Lists the missing files of the scene.
pub(super) fn missing_ui(ui: &mut Ui, files: &[PathBuf]) -> Option<End> {
    limit_width(ui, 560.0);
    heading(ui, "Missing files");
    ui.label("After you find one, others in the same folder are suggested.");
    ui.add_space(4.0);
    let mut answer = None;
    ScrollArea::vertical().max_height(300.0).show(ui, |ui| {
        for file in files {
            ui.horizontal(|ui| {
                let label = format!("Find {}...", file_name(file));
                if ui.button(label).clicked() {
                    answer = Some(End::Answer(Answer::Find(file.clone())));
                }
                let folder = file.parent().unwrap_or(file).display().to_string();
                ui.add(egui::Label::new(egui::RichText::new(folder).weak()).truncate());
            });
        }
    });
    ui.add_space(4.0);
    close_ui(ui).or(answer)
}

/// Lists the discarded work.
pub(super) fn discarded_ui(ui: &mut Ui, all: &[String]) -> Option<End> {
    limit_width(ui, WIDTH);
    heading(ui, "Discarded work");
    ui.label(
        "Discarded work is kept for 30 days. Click an entry to open it in place of this \
        scene.",
    );
    ui.add_space(4.0);
    let mut answer = None;
    ScrollArea::vertical().max_height(300.0).show(ui, |ui| {
        for (at, text) in all.iter().enumerate() {
            if ui.button(text).clicked() {
                answer = Some(End::Answer(Answer::RecoverDiscarded(at)));
            }
        }
    });
    ui.add_space(4.0);
    close_ui(ui).or(answer)
}

/// Limits the width of a dialog, which has margins in a narrow window.
pub(super) fn limit_width(ui: &mut Ui, most: f32) {
    let room = ui.ctx().content_rect().width() - 2.0 * MARGIN;
    ui.set_max_width(most.min(room.max(120.0)));
}

/// Shows the button that closes a dialog without a question.
pub(super) fn close_ui(ui: &mut Ui) -> Option<End> {
    let button = ui.button("Close");
    take_focus(ui, &button);
    button.clicked().then_some(End::Cancelled)
}

//! About: version, commit, instructions in use, and the licences of the program and of its
//! packages. `tools/licences.py` creates the list of packages.

use egui::{Rect, RichText, Role, ScrollArea, Sense, TextStyle, Ui, WidgetInfo, vec2};
use fearless_simd::Level;

use super::arrange::window;
use crate::app::actions::Requests;
use crate::app::panels::Panel;
use crate::app::state::State;
use crate::app::theme;
use crate::app::widgets::controls::{heading, put_text, text};
use marraztu_lab::instructions;

/// One package per line: name, version and licence.
const PACKAGES: &str = include_str!("../../../assets/licences.txt");

/// The page that lists, among others, the things that do not work in a browser.
const INSTALLATION: &str = include_str!("../../../docs/install.md");

const SIZE: egui::Vec2 = vec2(460.0, 460.0);

pub(crate) fn show(ui: &mut Ui, _state: &State, requests: &mut Requests) {
    window(ui, Panel::About, SIZE, requests, |ui, _| contents(ui));
}

/// Returns the facts that identify the program in a bug report.
fn facts() -> [String; 3] {
    [
        format!("Version: {}", env!("CARGO_PKG_VERSION")),
        format!("Commit: {}", option_env!("MARRAZTU_COMMIT").unwrap_or("not recorded")),
        format!("Instructions: {}", instructions::name_of(Level::new()).to_uppercase()),
    ]
}

/// Returns the things that do not work in a browser, one sentence or two each.
fn limits() -> Vec<String> {
    let rest = INSTALLATION.split("What does not work there:\n").nth(1).unwrap_or_default();
    let list = rest.trim_start().split("\n\n").next().unwrap_or_default();
    let items = list.split("- ").skip(1);
    items.map(|item| item.split_whitespace().collect::<Vec<_>>().join(" ")).collect()
}

fn contents(ui: &mut Ui) {
    heading(ui, "Marraztu");
    ui.label(concat!(env!("CARGO_PKG_DESCRIPTION"), "."));
    ui.add_space(theme::GAP);
    for line in facts() {
        ui.label(line);
    }
    ui.label("Licence: MIT or Apache 2.0, at your choice");
    ui.add_space(theme::GAP);
    if ui.button("Copy").on_hover_text("Copies version, commit and instructions").clicked() {
        ui.ctx().copy_text(format!("Marraztu\n{}\n", facts().join("\n")));
    }
    ui.add_space(2.0 * theme::GAP);
    if cfg!(target_family = "wasm") {
        ui.label(RichText::new("What does not work in a browser").strong());
        for limit in limits() {
            ui.label(limit);
        }
        ui.add_space(2.0 * theme::GAP);
    }
    let packages: Vec<&str> = PACKAGES.lines().collect();
    let count = packages.len();
    ui.label(
        RichText::new(format!("Built from {count} packages, not all on every system")).strong(),
    );
    let row = ui.spacing().interact_size.y.max(theme::ROW);
    let list = ScrollArea::vertical().auto_shrink(false).content_margin(theme::SCROLL_MARGIN);
    // Only the visible rows are laid out.
    list.show_rows(ui, row, count, |ui, range| {
        for package in &packages[range] {
            let (line, response) =
                ui.allocate_exact_size(vec2(ui.available_width(), row), Sense::hover());
            response.widget_info(|| WidgetInfo::labeled(Role::Label, true, *package));
            let name = package.match_indices(' ').nth(1).map_or(package.len(), |(at, _)| at);
            let (name, licence) = package.split_at(name);
            let licence_at = line.with_min_x(line.left() + 0.45 * line.width());
            let name_at = line.with_max_x(licence_at.left() - theme::GAP);
            let visuals = ui.visuals();
            let fitted = |words: &str, at: Rect| text(ui, words, TextStyle::Body, at.width());
            put_text(ui, name_at, fitted(name, name_at), visuals.text_color());
            let galley = fitted(licence.trim(), licence_at);
            put_text(ui, licence_at, galley, visuals.weak_text_color());
            response.on_hover_text(*package);
        }
    });
}

#[cfg(test)]
mod tests {
    use super::limits;

    #[test]
    fn the_limits_of_browsers_are_those_of_the_page_about_installation() {
        let limits = limits();
        assert!(limits.len() >= 4);
        for limit in limits {
            assert!(limit.ends_with('.') && !limit.contains(['\n', '`', '#']), "{limit}");
        }
    }
}

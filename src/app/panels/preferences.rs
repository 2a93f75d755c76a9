//! Preferences: everything that the program remembers, with a reset for each row and for all.
//!
//! A row changes a copy of [`Preferences`]. The app applies the changed copy in the same way as the
//! file at the start, so one request serves all rows.

use egui::{Align, DragValue, Layout, ScrollArea, Sense, TextStyle, ThemePreference, Ui, vec2};

use super::arrange::window;
use crate::app::actions::{Action, Request, Requests};
use crate::app::input::keyboard::Keyboard;
use crate::app::panels::{OpenPanels, Panel};
use crate::app::state::State;
use crate::app::theme;
use crate::app::widgets::controls::{self, Switch, choose, icon_button};
use crate::app::widgets::icons::Icon;
use marraztu_core::accuracy::Samples;
use marraztu_core::scene::UpAxis;
use marraztu_io::{Preferences, Theme};

const SIZE: egui::Vec2 = vec2(480.0, 470.0);

const LABEL: f32 = 150.0;

/// A remembered value.
struct Row {
    label: &'static str,
    hint: &'static str,
    /// Shows the value and lets the user change it.
    ui: fn(&mut Ui, &mut Preferences, &mut Requests),
    /// Copies the value from the first preferences to the second.
    copy: fn(&Preferences, &mut Preferences),
}

const ROWS: &[Row] = &[
    Row {
        label: "Theme",
        hint: "Whether the window is light or dark.",
        ui: |ui, it, _| {
            let all = [("System", Theme::System), ("Light", Theme::Light), ("Dark", Theme::Dark)];
            let all = all.map(|(label, to)| (label, to, "Light, dark, or like the system"));
            it.theme = choose(ui, "Theme", it.theme, &all).unwrap_or(it.theme);
        },
        copy: |from, to| to.theme = from.theme,
    },
    Row {
        label: "Interface size",
        hint: "The size of text and panels.",
        ui: |ui, it, asks| {
            for (label, action) in [("-", Action::SmallerText), ("+", Action::LargerText)] {
                let button = ui.add(egui::Button::new(label).min_size(vec2(theme::ROW, 0.0)));
                if button.accessible_name(action.info().label).clicked() {
                    asks.push(action.into());
                }
            }
            ui.label(format!("{:.0} %", it.scale * 100.0));
        },
        copy: |from, to| to.scale = from.scale,
    },
    Row {
        label: "Window",
        hint: "The size of the window when it opens.",
        ui: |ui, it, _| {
            let [width, height] = it.window.unwrap_or(Preferences::WINDOW);
            let whole = if it.maximized { ", maximized" } else { "" };
            ui.label(format!("{width} x {height} points{whole}"));
        },
        copy: |from, to| (to.window, to.maximized) = (from.window, from.maximized),
    },
    Row {
        label: "Open panels",
        hint: "Which panels are open.",
        ui: |ui, it, _| {
            let open = OpenPanels::of_kept(&it.panels);
            let open = Panel::ALL.iter().filter(|panel| open.has(**panel));
            let names: Vec<&str> = open.map(|panel| panel.info().label).collect();
            ui.add(egui::Label::new(names.join(", ")).truncate());
        },
        copy: |from, to| to.panels = from.panels.clone(),
    },
    Row {
        label: "Sizes of panels",
        hint: "The panel borders that you have dragged.",
        ui: |ui, it, _| {
            ui.label(match it.shares.len() {
                0 => "default".to_owned(),
                1 => "1 border dragged".to_owned(),
                count => format!("{count} borders dragged"),
            });
        },
        copy: |from, to| to.shares = from.shares.clone(),
    },
    Row {
        label: "Keys",
        hint: "Your custom keys.",
        ui: |ui, it, asks| {
            if ui.button("Change...").accessible_name("Change keys").clicked() {
                asks.push(Action::Panel(Panel::CheatSheet).into());
            }
            ui.label(match it.keys.len() {
                0 => "default keys".to_owned(),
                1 => "1 action has custom keys".to_owned(),
                count => format!("{count} actions have custom keys"),
            });
        },
        copy: |from, to| to.keys = from.keys.clone(),
    },
    Row {
        label: "Recent files",
        hint: "The files opened or saved last. They also give the folders of file dialogs.",
        ui: |ui, it, _| {
            ui.label(match it.recent.len() {
                0 => "none".to_owned(),
                1 => "1 file".to_owned(),
                count => format!("{count} files"),
            });
        },
        copy: |from, to| to.recent = from.recent.clone(),
    },
    Row {
        label: "Up axis of models",
        hint: "The up axis of models that do not state one.",
        ui: |ui, it, _| {
            let hint = "The axis of the file that points up";
            let all = UpAxis::ALL.map(|up| (up.word().to_uppercase(), up, hint));
            it.up = choose(ui, "Up axis", it.up, &all).unwrap_or(it.up);
        },
        copy: |from, to| to.up = from.up,
    },
    Row {
        label: "Reload models",
        hint: "Reloads models when another program saves them.",
        ui: |ui, it, _| switch(ui, "When their files change", &mut it.watches),
        copy: |from, to| to.watches = from.watches,
    },
    Row {
        label: "Overlays",
        hint: "The selection outline, the axes and light markers.",
        ui: |ui, it, _| switch(ui, "Shown over the picture", &mut it.overlays),
        copy: |from, to| to.overlays = from.overlays,
    },
    Row {
        label: "Accuracy dial",
        hint: "What accuracy costs in this view, measured while nothing moves.",
        ui: |ui, it, _| switch(ui, "Shown over the picture", &mut it.dial),
        copy: |from, to| to.dial = from.dial,
    },
    Row {
        label: "Gizmo",
        hint: "Handles that move, rotate and scale the selection.",
        ui: |ui, it, _| switch(ui, "Shown over the selection", &mut it.gizmo),
        copy: |from, to| to.gizmo = from.gizmo,
    },
    Row {
        label: "Ground grid",
        hint: "A grid at height 0.",
        ui: |ui, it, _| switch(ui, "Shown behind everything", &mut it.helpers.grid),
        copy: |from, to| to.helpers.grid = from.helpers.grid,
    },
    Row {
        label: "Dimensions",
        hint: "The bounding boxes of the selected objects, with their sizes.",
        ui: |ui, it, _| switch(ui, "Shown around the selection", &mut it.helpers.dimensions),
        copy: |from, to| to.helpers.dimensions = from.helpers.dimensions,
    },
    Row {
        label: "Light directions",
        hint: "The direction of every sun and spot.",
        ui: |ui, it, _| switch(ui, "Shown for all lights", &mut it.helpers.directions),
        copy: |from, to| to.helpers.directions = from.helpers.directions,
    },
    Row {
        label: "Refining",
        hint: "More samples per pixel while nothing moves.",
        ui: |ui, it, _| switch(ui, "When nothing moves", &mut it.refines),
        copy: |from, to| to.refines = from.refines,
    },
    Row {
        label: "Samples when refined",
        hint: "The samples per pixel that the picture is refined to.",
        ui: |ui, it, _| {
            let hint = "More samples smooth edges, and take longer";
            let all = Samples::ALL.map(|samples| (samples.count().to_string(), samples, hint));
            it.refined = choose(ui, "Samples when refined", it.refined, &all).unwrap_or(it.refined);
        },
        copy: |from, to| to.refined = from.refined,
    },
    Row {
        label: "Time while moving",
        hint: "The time limit for a picture while something moves; slower pictures get reduced \
            quality.",
        ui: |ui, it, _| {
            let field = DragValue::new(&mut it.budget_ms).range(1..=1000).suffix(" ms");
            ui.add(field).accessible_name("Time while moving");
        },
        copy: |from, to| to.budget_ms = from.budget_ms,
    },
];

fn switch(ui: &mut Ui, label: &str, on: &mut bool) {
    *on ^= Switch::new(label, *on).ui(ui).clicked();
}

/// Returns the current preferences, with the last known size of the window.
pub(crate) fn now(ctx: &egui::Context, state: &State, before: Option<[f32; 2]>) -> Preferences {
    let scale = state.presenting.map_or_else(|| ctx.zoom_factor(), |before| before.zoom);
    let (rect, maximized, minimized) = ctx.input(|input| {
        let viewport = input.viewport();
        (viewport.inner_rect, viewport.maximized, viewport.minimized)
    });
    let maximized = maximized.unwrap_or(false);
    let size = rect.map(|rect| (rect.size() * scale).round());
    // A maximized or minimized window, or one on the full screen, says nothing about the usual
    // size.
    let is_usual = !maximized && minimized != Some(true) && state.presenting.is_none();
    let size = size.filter(|_| is_usual);
    let whole = |size: egui::Vec2| [size.x, size.y];
    Preferences {
        theme: match state.theme {
            ThemePreference::System => Theme::System,
            ThemePreference::Light => Theme::Light,
            ThemePreference::Dark => Theme::Dark,
        },
        panels: state.lasting_panels().kept(),
        gizmo: state.gizmo,
        scale,
        window: size.map(whole).or(before),
        maximized,
        shares: state.layout.shares(),
        overlays: state.overlays,
        dial: state.dial.shown,
        helpers: state.helpers,
        watches: state.watches,
        up: state.up,
        keys: Keyboard::keymap(ctx).names(),
        refines: state.drawing.refines,
        refined: state.drawing.refined,
        budget_ms: state.drawing.budget_ms,
        recent: state.recent.clone(),
    }
}

pub(crate) fn show(ui: &mut Ui, state: &State, requests: &mut Requests) {
    let add = |ui: &mut Ui, requests: &mut Requests| contents(ui, state, requests);
    window(ui, Panel::Preferences, SIZE, requests, add);
}

fn contents(ui: &mut Ui, state: &State, requests: &mut Requests) {
    let mut now = now(ui.ctx(), state, None);
    // The default size does not count as a choice of the user.
    now.window =
        now.window.filter(|size| size.map(f32::to_bits) != Preferences::WINDOW.map(f32::to_bits));
    let before = now.clone();
    // `Preferences::default` does not name panels, so the ones of the first start are added.
    let panels = OpenPanels::DEFAULT.kept();
    let first = Preferences { panels, ..Preferences::default() };
    let list = ui.available_height() - 2.0 * theme::ROW;
    let area = ScrollArea::vertical().max_height(list).auto_shrink(false);
    area.content_margin(theme::SCROLL_MARGIN).show(ui, |ui| {
        for row in ROWS {
            row.show(ui, &mut now, &first, requests);
        }
    });
    ui.add_space(theme::GAP);
    let all = egui::Button::new("Reset everything");
    if ui.add_enabled(now != first, all).clicked() {
        now = first;
    }
    if now != before {
        requests.push(Request::Preferences(Box::new(now)));
    }
}

impl Row {
    fn show(&self, ui: &mut Ui, now: &mut Preferences, first: &Preferences, asks: &mut Requests) {
        let mut reset = now.clone();
        (self.copy)(first, &mut reset);
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = theme::GAP;
            let (rect, label) = ui.allocate_exact_size(vec2(LABEL, theme::ROW), Sense::hover());
            let text = controls::text(ui, self.label, TextStyle::Body, LABEL);
            controls::put_text(ui, rect, text, ui.visuals().weak_text_color());
            label.on_hover_text(self.hint);
            let width = ui.available_width() - theme::ROW - theme::GAP;
            let (size, left) = (vec2(width, theme::ROW), Layout::left_to_right(Align::Center));
            ui.allocate_ui_with_layout(size, left, |ui| {
                ui.set_width(width);
                (self.ui)(ui, now, asks);
            });
            let name = format!("Reset: {}", self.label);
            let is_changed = reset != *now;
            let button = icon_button(ui, Icon::UNDO, &name, is_changed).on_hover_text(&name);
            if is_changed && button.clicked() {
                *now = reset;
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::*;
    use marraztu_io::Helpers;

    #[test]
    fn everything_that_is_remembered_has_a_row() {
        let helpers = Helpers { grid: true, dimensions: true, directions: true };
        let mut changed = Preferences {
            theme: Theme::Dark,
            panels: OpenPanels::DEFAULT.toggled(Panel::Plan).kept(),
            gizmo: false,
            scale: 1.5,
            window: Some([900.0, 700.0]),
            maximized: true,
            shares: [("left".to_owned(), 200.0)].into(),
            overlays: false,
            dial: false,
            helpers,
            watches: true,
            up: UpAxis::Z,
            keys: [("Undo".to_owned(), vec!["k".to_owned()])].into(),
            refines: false,
            refined: Samples::Four,
            budget_ms: 50,
            recent: vec![PathBuf::from("/a.obj")],
        };
        let default = Preferences::default();
        for row in ROWS {
            let before = changed.clone();
            (row.copy)(&default, &mut changed);
            assert_ne!(changed, before, "{} resets nothing", row.label);
        }
        assert_eq!(changed, default);
    }
}

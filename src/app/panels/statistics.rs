//! How much there is, how much of it is drawn, and how long that takes: over the picture.

use egui::{Area, Color32, Frame, Grid, Id, Order, Rect, RichText, Ui, vec2};

use super::properties::counted;
use crate::app::state::State;

/// Shows it in the upper left corner of `picture`.
pub(super) fn show(ui: &Ui, state: &State, picture: Rect) {
    Area::new(Id::unique("statistics"))
        .order(Order::Middle)
        .fixed_pos(picture.min + vec2(8.0, 8.0))
        .interactable(false)
        .show(ui.ctx(), |ui| {
            // The same on every picture, whatever the theme.
            let ground = Color32::from_black_alpha(200);
            Frame::new().fill(ground).corner_radius(4.0).inner_margin(8.0).show(ui, |ui| {
                Grid::new("statistics").spacing(vec2(12.0, 2.0)).show(ui, |ui| {
                    for (name, value) in rows(state) {
                        ui.label(RichText::new(name).color(Color32::from_gray(0xb4)));
                        ui.label(RichText::new(value).color(Color32::WHITE));
                        ui.end_row();
                    }
                });
            });
        });
}

fn rows(state: &State) -> [(&'static str, String); 7] {
    let objects = || state.scene.objects.iter().map(|(_, object)| object);
    let meshes = || objects().map(|object| &object.model.mesh);
    let shown = objects().filter(|object| object.visible).count();
    let statistics = &state.statistics;
    [
        ("Objects", format!("{} ({shown} shown)", counted(objects().count()))),
        ("Vertices", counted(meshes().map(|mesh| mesh.positions().len()).sum())),
        ("Polygons", counted(meshes().map(|mesh| mesh.polygon_count()).sum())),
        ("Triangles", counted(meshes().map(|mesh| mesh.triangles().len()).sum())),
        ("Drawn", counted(statistics.triangles)),
        ("Picture", format!("{} x {}", statistics.size.width, statistics.size.height)),
        ("Time", format!("{:.1} ms", statistics.time.as_secs_f64() * 1000.0)),
    ]
}

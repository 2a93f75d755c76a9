//! What stands over the picture: words, numbers, the outline of what the pointer is over.

use egui::{Align2, Color32, Mesh, Rect, TextStyle, Ui, vec2};

use super::material_dialog::grouped;
use super::state::State;
use super::worker::Border;

/// Words on a dark plate in a corner of the picture, so that they are read on any background.
pub(super) fn plate_ui(ui: &Ui, rect: Rect, corner: Align2, text: String) {
    let font = TextStyle::Body.resolve(ui.style());
    let painter = ui.painter();
    let galley = painter.layout_no_wrap(text, font, Color32::WHITE);
    let inner = rect.shrink2(vec2(8.0, 6.0));
    let plate = corner.align_size_within_rect(galley.size(), inner);
    painter.rect_filled(plate.expand2(vec2(5.0, 2.0)), 3.0, Color32::from_black_alpha(150));
    painter.galley(plate.min, galley, Color32::WHITE);
}

/// How much is drawn, and how long it takes.
pub(super) fn statistics_ui(ui: &Ui, state: &State, rect: Rect) {
    let statistics = &state.statistics;
    let shown = || state.scene.objects.iter().filter(|(_, object)| object.visible);
    let sum = |count: fn(&crate::scene::Mesh) -> usize| {
        grouped(shown().map(|(_, object)| count(&object.model.mesh)).sum())
    };
    let text = format!(
        "{} pictures in the last second, {:.1} ms each\n{} x {} pixels\n\
        {} objects, {} vertices, {} faces\n{} of {} triangles drawn",
        statistics.rate,
        statistics.time.as_secs_f64() * 1e3,
        statistics.size.width,
        statistics.size.height,
        shown().count(),
        sum(|mesh| mesh.positions().len()),
        sum(crate::scene::Mesh::polygon_count),
        grouped(statistics.triangles),
        sum(|mesh| mesh.triangles().len()),
    );
    plate_ui(ui, rect, Align2::LEFT_TOP, text);
}

/// The outline of an item, light with a dark border, so that it is seen on any background.
#[expect(clippy::cast_precision_loss, reason = "pictures have fewer than 2^24 pixels a side")]
pub(super) fn border_ui(ui: &Ui, rect: Rect, border: &Border) {
    let scale = ui.ctx().pixels_per_point();
    let mut mesh = Mesh::default();
    let colors = [Color32::from_black_alpha(160), Color32::WHITE];
    for (runs, color) in [&border.outer, &border.inner].into_iter().zip(colors) {
        for run in runs {
            let min = rect.min + vec2(run.x as f32, run.y as f32) / scale;
            let size = vec2(run.length as f32, 1.0) / scale;
            mesh.add_colored_rect(Rect::from_min_size(min, size), color);
        }
    }
    ui.painter().with_clip_rect(rect).add(mesh);
}

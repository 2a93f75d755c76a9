//! Draws the border of an item over the picture.

use egui::{Color32, Mesh, Rect, Ui, vec2};

use crate::app::drawing::border::Border;

/// Draws the border of an item with a dark outer line, visible on any background.
#[expect(clippy::cast_precision_loss, reason = "pictures have fewer than 2^24 pixels a side")]
pub(crate) fn border_ui(ui: &Ui, rect: Rect, border: &Border, color: Color32) {
    let pixel = rect.size() / vec2(border.size.width as f32, border.size.height as f32);
    let mut mesh = Mesh::default();
    let colors = [Color32::from_black_alpha(160), color];
    for (runs, color) in [&border.outer, &border.inner].into_iter().zip(colors) {
        for run in runs {
            let min = rect.min + vec2(run.x as f32, run.y as f32) * pixel;
            let size = vec2(run.length as f32, 1.0) * pixel;
            mesh.add_colored_rect(Rect::from_min_size(min, size), color);
        }
    }
    ui.painter().with_clip_rect(rect).add(mesh);
}

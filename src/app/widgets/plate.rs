//! Text on a dark plate over the picture.

use egui::{Align2, Color32, Rect, TextStyle, Ui, vec2};

/// Shows text on a dark plate in a corner of the picture, readable on any background.
pub(crate) fn plate_ui(ui: &Ui, rect: Rect, corner: Align2, text: String) {
    let font = TextStyle::Body.resolve(ui.style());
    let painter = ui.painter();
    let galley = painter.layout_no_wrap(text, font, Color32::WHITE);
    let inner = rect.shrink2(vec2(8.0, 6.0));
    let plate = corner.align_size_within_rect(galley.size(), inner);
    painter.rect_filled(plate.expand2(vec2(5.0, 2.0)), 3.0, Color32::from_black_alpha(150));
    painter.galley(plate.min, galley, Color32::WHITE);
}

//! Draws the gizmo over everything, its axes coloured and labelled.

use egui::{Align2, Color32, CursorIcon, Painter, Pos2, Rect, Shape as Paint, Stroke, TextStyle};
use egui::{Ui, Vec2, vec2};

use super::{Gizmo, Handle, LETTER, MIDDLE, Part, Shape};
use crate::app::theme;
use marraztu_core::base::math::Axis;
use marraztu_core::scene::Transformation;

/// The outline of lines, which makes them visible on any background.
const SHADE: Color32 = Color32::from_black_alpha(150);

impl Gizmo {
    /// Draws the gizmo. `held` is the handle being dragged, `hovered` the one under the pointer.
    pub(crate) fn show(&self, ui: &Ui, rect: Rect, held: Option<Handle>, hovered: Option<Handle>) {
        let painter = ui.painter().with_clip_rect(rect);
        let chosen = held.or(hovered);
        for part in &self.parts {
            // The other handles are hidden during a drag, where they would be in the way.
            if held.is_none_or(|held| held == part.handle || part.handle == Handle::Middle) {
                self.part_ui(ui, &painter, part, chosen == Some(part.handle));
            }
        }
        if hovered.is_some() && held.is_none() {
            ui.ctx().set_cursor_icon(CursorIcon::Grab);
        }
    }

    fn part_ui(&self, ui: &Ui, painter: &Painter, part: &Part, bright: bool) {
        // Each axis has its colour; a handle under the pointer is white.
        let own = match part.handle {
            Handle::Axis(axis) | Handle::Plane(axis) | Handle::Ring(axis) => {
                theme::axis_on_dark(axis)
            }
            Handle::Outer | Handle::Middle => Color32::from_gray(225),
        };
        let color = if bright { Color32::WHITE } else { own };
        let width = if bright { 4.0 } else { 2.5 };
        let stroke = Stroke::new(width, color);
        let font = TextStyle::Small.resolve(ui.style());
        let letter = |axis: Axis| {
            let Some(at) = part.shape.letter() else { return };
            painter.circle(at, LETTER, color, Stroke::new(1.5, SHADE));
            let letter = ["X", "Y", "Z"][axis.index()];
            painter.text(at, Align2::CENTER_CENTER, letter, font.clone(), Color32::BLACK);
        };
        match (&part.shape, part.handle) {
            (Shape::Line([from, to]), Handle::Axis(axis)) => {
                // The line starts outside of the disk in the middle.
                let way = (*to - *from).normalized();
                line(painter, &[*from + way * MIDDLE, *to], stroke);
                self.end_ui(painter, *to, way, color);
                letter(axis);
            }
            (Shape::Square(corners), _) => {
                let fill = own.gamma_multiply(if bright { 0.8 } else { 0.35 });
                let edge = Stroke::new(if bright { 2.5 } else { 1.5 }, color);
                painter.add(Paint::convex_polygon(corners.to_vec(), fill, edge));
            }
            (Shape::Ring { near, far }, Handle::Ring(axis)) => {
                // The far half of a ring is thin, to tell it from the near half.
                if far.len() > 1 {
                    painter
                        .add(Paint::line(far.clone(), Stroke::new(1.0, own.gamma_multiply(0.5))));
                }
                line(painter, near, stroke);
                letter(axis);
            }
            (Shape::Circle(middle, radius), _) => {
                painter.circle_stroke(*middle, *radius, Stroke::new(width + 1.5, SHADE));
                painter.circle_stroke(*middle, *radius, Stroke::new(width - 1.0, color));
            }
            (Shape::Disk(middle), _) => {
                let ring = Stroke::new(if bright { 3.0 } else { 2.0 }, color);
                painter.circle(*middle, MIDDLE - 2.0, SHADE, ring);
            }
            (Shape::Line(ends), _) => line(painter, ends, stroke),
            (Shape::Ring { near, .. }, _) => line(painter, near, stroke),
        }
    }

    /// Draws the end of an axis: an arrow to move, a square to scale.
    fn end_ui(&self, painter: &Painter, at: Pos2, way: Vec2, color: Color32) {
        let edge = Stroke::new(1.0, SHADE);
        match self.pivot.kind {
            Transformation::Scaling => {
                let side = Rect::from_center_size(at, vec2(11.0, 11.0));
                painter.rect(side, 1.0, color, edge, egui::StrokeKind::Outside);
            }
            Transformation::Translation | Transformation::Rotation => {
                let base = at - way * 6.0;
                let points =
                    vec![at + way * 6.0, base + way.rot90() * 5.0, base - way.rot90() * 5.0];
                painter.add(Paint::convex_polygon(points, color, edge));
            }
        }
    }
}

fn line(painter: &Painter, points: &[Pos2], stroke: Stroke) {
    painter.add(Paint::line(points.to_vec(), Stroke::new(stroke.width + 2.0, SHADE)));
    painter.add(Paint::line(points.to_vec(), stroke));
}

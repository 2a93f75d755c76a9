//! The world's axes on a disc in a corner of the picture: a click on an end looks along that axis,
//! and a drag of the disc orbits.

use egui::{Align2, Color32, CursorIcon, Pos2, Rect, Stroke, TextStyle, Ui, vec2};
use glam::DMat3;

use crate::app::actions::Action;
use crate::app::state::State;
use crate::app::theme;
use marraztu_core::base::math::Axis;

/// The distance from the middle to an end, in points.
const LENGTH: f32 = 30.0;

/// The radius of an end.
const END: f32 = 8.0;

/// The radius of the disc.
const DISC: f32 = LENGTH + END + 3.0;

/// Pictures with a smaller side than this do not show the axes.
const LEAST: f32 = 180.0;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct End {
    axis: Axis,
    positive: bool,
    at: Pos2,
    /// The component towards the observer.
    nearness: f32,
    /// The action of a click on it.
    pub(super) action: Action,
}

/// Returns the six ends, the farthest first; none in a small picture.
#[expect(clippy::cast_possible_truncation, reason = "places on the screen are for the eye")]
pub(super) fn ends(state: &State, rect: Rect) -> Vec<End> {
    if !state.shows_overlays() || rect.width().min(rect.height()) < LEAST {
        return Vec::new();
    }
    let middle = middle(rect);
    let view_from_world = DMat3::from_mat4(state.scene.observer_frame(&state.view)).transpose();
    let mut ends = Vec::new();
    for (axis, actions) in [
        (Axis::X, [Action::LookRight, Action::LookLeft]),
        (Axis::Y, [Action::LookTop, Action::LookBottom]),
        (Axis::Z, [Action::LookFront, Action::LookBack]),
    ] {
        for (positive, action) in [true, false].into_iter().zip(actions) {
            let sign = if positive { 1.0 } else { -1.0 };
            let to = view_from_world * axis.unit() * sign;
            let at = middle + vec2(to.x as f32, -to.y as f32) * LENGTH;
            ends.push(End { axis, positive, at, nearness: to.z as f32, action });
        }
    }
    ends.sort_by(|a, b| a.nearness.total_cmp(&b.nearness));
    ends
}

/// Returns the middle of the disc.
fn middle(rect: Rect) -> Pos2 {
    rect.right_top() + vec2(-(LENGTH + END + 8.0), LENGTH + END + 8.0)
}

/// Returns whether the disc is shown and contains a place of the window.
pub(super) fn has(ends: &[End], rect: Rect, at: Pos2) -> bool {
    !ends.is_empty() && middle(rect).distance(at) <= DISC
}

/// Finds the end at a place of the window. If ends overlap, the nearest to the observer is found.
pub(super) fn end_at(ends: &[End], at: Pos2) -> Option<End> {
    ends.iter().rev().find(|end| end.at.distance(at) <= END + 1.0).copied()
}

/// Draws the axes. The positive ends have letters; the negative ends are rings. The disc under the
/// pointer is darker, and the end under it is white.
pub(super) fn show(ui: &Ui, rect: Rect, ends: &[End], pointer: Option<Pos2>) {
    if ends.is_empty() {
        return;
    }
    let middle = middle(rect);
    let painter = ui.painter().with_clip_rect(rect);
    let is_over = pointer.is_some_and(|at| has(ends, rect, at));
    let hovered = pointer.and_then(|at| end_at(ends, at));
    painter.circle_filled(middle, DISC, Color32::from_black_alpha(if is_over { 150 } else { 90 }));
    if is_over {
        let icon = if hovered.is_some() { CursorIcon::PointingHand } else { CursorIcon::Grab };
        ui.ctx().set_cursor_icon(icon);
    }
    for end in ends {
        // The light colours are readable on the dark disk in both themes.
        let color = theme::axis_on_dark(end.axis);
        let is_hovered = hovered == Some(*end);
        let color = if is_hovered { Color32::WHITE } else { color };
        if end.positive {
            painter.line_segment([middle, end.at], Stroke::new(2.0, color));
            painter.circle_filled(end.at, END, color);
            let font = TextStyle::Small.resolve(ui.style());
            let letter = ["X", "Y", "Z"][end.axis.index()];
            painter.text(end.at, Align2::CENTER_CENTER, letter, font, Color32::BLACK);
        } else {
            let fill = color.gamma_multiply(if is_hovered { 0.8 } else { 0.35 });
            painter.circle(end.at, END - 2.0, fill, Stroke::new(1.5, color));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_end_towards_the_observer_is_the_one_that_is_clicked() {
        let (scene, view) = marraztu_io::default_scene();
        let mut state = State::new(scene, view);
        let rect = Rect::from_min_size(Pos2::ZERO, vec2(800.0, 600.0));
        let all = ends(&state, rect);
        assert_eq!(all.len(), 6);
        // The camera looks along -Z, so +Z and -Z overlap in the middle.
        let middle = all.last().unwrap().at;
        assert_eq!(end_at(&all, middle).unwrap().action, Action::LookFront);
        let right = middle + vec2(LENGTH, 0.0);
        assert_eq!(end_at(&all, right).unwrap().action, Action::LookRight);
        let low = middle + vec2(0.0, LENGTH);
        assert_eq!(end_at(&all, low).unwrap().action, Action::LookBottom);
        assert_eq!(end_at(&all, middle + vec2(0.0, 3.0 * LENGTH)), None);
        state.overlays = false;
        assert!(ends(&state, rect).is_empty());
        state.overlays = true;
        assert!(ends(&state, Rect::from_min_size(Pos2::ZERO, vec2(120.0, 600.0))).is_empty());
    }
}

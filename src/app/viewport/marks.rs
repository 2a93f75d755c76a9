//! The marks of lights over the picture, and the cone of the selected light.
//!
//! A sun, a bulb and a spot each have a small disk with an icon at their position; a click on it
//! selects the light. The window draws the marks over the finished picture, so they are not part of
//! saved pictures.

use egui::{Color32, Painter, Pos2, Rect, Stroke, Ui, vec2};
use glam::{DMat4, DVec3, DVec4};

use crate::app::state::State;
use crate::app::theme;
use crate::app::widgets::icons::Icon;
use marraztu_core::base::image::Size;
use marraztu_core::base::math;
use marraztu_core::edit::aiming;
use marraztu_core::scene::{Aim, HALF_APERTURE, ItemId, LightId};

/// The radius of a mark in points.
const RADIUS: f32 = 9.0;

/// The number of sides of the circle at the end of a cone.
const SIDES: u32 = 32;

/// The projection from the world to the window.
pub(super) struct Projection {
    clip_from_world: DMat4,
    rect: Rect,
}

impl Projection {
    pub(super) fn new(state: &State, rect: Rect, size: Size) -> Self {
        let (scene, view) = (&state.scene, &state.view);
        let lens = scene.selected_camera(view).lens;
        let view_from_world = scene.observer_frame(view).inverse();
        let clip_from_world = lens.clip_from_view(view.projection, size) * view_from_world;
        Self { clip_from_world, rect }
    }

    fn clip(&self, at: DVec3) -> DVec4 {
        self.clip_from_world * at.extend(1.0)
    }

    /// Projects a point between the near and far planes to the window.
    pub(super) fn place(&self, at: DVec3) -> Option<Pos2> {
        let clip = self.clip(at);
        (clip.w > 0.0 && clip.z <= clip.w).then(|| self.screen(clip))
    }

    #[expect(clippy::cast_possible_truncation, reason = "places on the screen are for the eye")]
    fn screen(&self, clip: DVec4) -> Pos2 {
        let part = vec2(
            (clip.x / clip.w * 0.5 + 0.5).clamp(-1e4, 1e4) as f32,
            (0.5 - clip.y / clip.w * 0.5).clamp(-1e4, 1e4) as f32,
        );
        self.rect.min + part * self.rect.size()
    }

    pub(super) fn rect(&self) -> Rect {
        self.rect
    }

    /// Draws a line of the world, cut at the near plane.
    pub(super) fn line(&self, painter: &Painter, ends: [DVec3; 2], stroke: Stroke) {
        if let Some(line) = self.segment(ends) {
            painter.line_segment(line, Stroke::new(stroke.width + 2.0, SHADE));
            painter.line_segment(line, stroke);
        }
    }

    /// Projects the part of a line that lies in front of the observer.
    pub(super) fn segment(&self, ends: [DVec3; 2]) -> Option<[Pos2; 2]> {
        let [a, b] = ends.map(|end| self.clip(end));
        // In front of the near plane, w - z is negative. It is linear along the line.
        let [da, db] = [a, b].map(|clip| clip.w - clip.z);
        let [a, b] = match (da >= 0.0, db >= 0.0) {
            (true, true) => [a, b],
            (false, false) => return None,
            (true, false) => [a, a.lerp(b, da / (da - db))],
            (false, true) => [b.lerp(a, db / (db - da)), b],
        };
        (a.w > 0.0 && b.w > 0.0).then(|| [self.screen(a), self.screen(b)])
    }

    /// Returns the point of the world that a pixel of this depth shows.
    pub(super) fn world(&self, at: Pos2, depth: f32) -> Option<DVec3> {
        let part = (at - self.rect.min) / self.rect.size();
        let (x, y) = (f64::from(part.x) * 2.0 - 1.0, 1.0 - f64::from(part.y) * 2.0);
        let world = self.clip_from_world.inverse() * DVec4::new(x, y, f64::from(depth), 1.0);
        let point = world.truncate() / world.w;
        point.is_finite().then_some(point)
    }
}

/// The outline of lines, which makes them visible on any background.
const SHADE: Color32 = Color32::from_black_alpha(110);

#[derive(Clone, Copy, Debug)]
pub(super) struct Mark {
    pub(super) id: LightId,
    pub(super) at: Pos2,
    /// The distance from the observer.
    distance: f64,
    /// Whether the light is attached to an object or a camera, which a click selects first.
    follows: bool,
    /// Whether the light is locked: clicks ignore it.
    locked: bool,
}

/// Returns the marks of all lights within the picture, the nearest first.
pub(super) fn marks(state: &State, projection: &Projection) -> Vec<Mark> {
    let (scene, view) = (&state.scene, &state.view);
    let eye = scene.observer_frame(view).w_axis.truncate();
    let mark = |id: LightId| {
        let light = scene.lights.get(id)?;
        let follows = light.kind.owner().is_some_and(|owner| owner.fixed().is_none());
        let locked = scene.locked.contains(&ItemId::Light(id));
        let position = aiming::stands(scene, view, id)?.position;
        let (at, distance) = (projection.place(position)?, position.distance(eye));
        projection.rect.shrink(2.0).contains(at).then_some(Mark {
            id,
            at,
            distance,
            follows,
            locked,
        })
    };
    if !state.shows_overlays() {
        return Vec::new();
    }
    let mut marks: Vec<Mark> = scene.lights.ids().filter_map(mark).collect();
    marks.sort_by(|a, b| a.distance.total_cmp(&b.distance));
    marks
}

/// Finds the lights with marks at a place of the window: the free lights, and the attached ones.
/// Locked lights are skipped.
pub(super) fn lights_at(marks: &[Mark], at: Pos2) -> [Vec<ItemId>; 2] {
    [false, true].map(|follows| {
        let here = |mark: &&Mark| mark.follows == follows && mark.at.distance(at) <= RADIUS + 1.0;
        marks
            .iter()
            .filter(|mark| !mark.locked)
            .filter(here)
            .map(|mark| ItemId::Light(mark.id))
            .collect()
    })
}

/// Draws the marks, and the direction or cone of the selected light.
pub(super) fn show(ui: &Ui, state: &State, projection: &Projection, marks: &[Mark]) {
    let painter = ui.painter().with_clip_rect(projection.rect);
    let accent = theme::accent_on_dark();
    // Cones lie below all marks.
    if state.helpers.directions && state.shows_overlays() {
        for id in state.scene.lights.ids().filter(|id| !state.is_selected(ItemId::Light(*id))) {
            let light = state.scene.lights.get(id).filter(|light| light.on);
            if let Some([r, g, b, _]) = light.map(|light| light.color.opaque()) {
                let stroke = Stroke::new(1.0, Color32::from_rgb(r, g, b).gamma_multiply(0.8));
                cone_ui(&painter, state, projection, id, stroke);
            }
        }
    }
    if let Some(ItemId::Light(id)) = state.selected().filter(|_| state.shows_overlays()) {
        cone_ui(&painter, state, projection, id, Stroke::new(1.5, accent));
    }
    // Marks are sorted by distance: the nearest is drawn last.
    for mark in marks.iter().rev() {
        let Some(light) = state.scene.lights.get(mark.id) else { continue };
        let selected = state.is_selected(ItemId::Light(mark.id));
        if mark.follows && !selected {
            // A full mark would cover the owner, so an attached light has only a small dot.
            painter.circle(mark.at, 3.0, SHADE, Stroke::new(1.0, Color32::WHITE));
            continue;
        }
        let [r, g, b, _] = light.color.opaque();
        let color = Color32::from_rgb(r, g, b);
        let ink = if light.on { color } else { Color32::GRAY };
        let ring = if selected { Stroke::new(2.5, accent) } else { Stroke::new(1.0, ink) };
        if light.kind.has_diamond() && light.on && state.view.marks {
            // The diamond of the light is part of the picture and has to stay visible.
            painter.circle_stroke(mark.at, RADIUS + 1.0, Stroke::new(ring.width + 2.0, SHADE));
            painter.circle_stroke(mark.at, RADIUS + 1.0, ring);
            continue;
        }
        painter.circle(mark.at, RADIUS, Color32::from_black_alpha(170), ring);
        let rect = Rect::from_center_size(mark.at, vec2(2.0 * RADIUS, 2.0 * RADIUS));
        Icon::of_light(light).paint(&painter, rect, 11.0, ink);
        if !light.on {
            // A stroke shows that the light is off, not the colour alone.
            let end = vec2(RADIUS, -RADIUS) * 0.7;
            painter.line_segment([mark.at - end, mark.at + end], Stroke::new(1.5, ink));
        }
    }
}

/// Draws the direction of a sun or the cone of a spot.
fn cone_ui(painter: &Painter, state: &State, to: &Projection, id: LightId, stroke: Stroke) {
    let (scene, view) = (&state.scene, &state.view);
    let Some(Aim { position, direction }) = aiming::stands(scene, view, id) else { return };
    let Some(light) = scene.lights.get(id) else { return };
    let eye = scene.observer_frame(view).w_axis.truncate();
    // A quarter of the distance to the eye, so the cone is visible from near and far.
    let length = (position.distance(eye) * 0.25).max(1e-6);
    let end = position + direction * length;
    if light.kind.has_direction() {
        arrow_ui(painter, to, position, end, eye, stroke);
    }
    let Some(half_aperture) = (HALF_APERTURE.get)(&light.kind) else { return };
    // The angle is limited, since the base of an almost flat cone would be infinitely large.
    let angle = half_aperture.min(80.0).to_radians();
    let side = direction.any_orthonormal_vector();
    let other = direction.cross(side);
    let (across, along) = (libm::sin(angle) * length, libm::cos(angle) * length);
    let point = |i: u32| {
        let turn = std::f64::consts::TAU * f64::from(i) / f64::from(SIDES);
        let aside = side * libm::cos(turn) + other * libm::sin(turn);
        position + direction * along + aside * across
    };
    for i in 0..SIDES {
        to.line(painter, [point(i), point(i + 1)], stroke);
        if i % (SIDES / 4) == 0 {
            to.line(painter, [position, point(i)], stroke);
        }
    }
}

fn arrow_ui(
    painter: &Painter,
    to: &Projection,
    from: DVec3,
    end: DVec3,
    eye: DVec3,
    stroke: Stroke,
) {
    to.line(painter, [from, end], stroke);
    let along = end - from;
    if let Some(side) = math::unit(along.cross(end - eye)) {
        let back = end - along * 0.12;
        for aside in [side, -side] {
            to.line(painter, [end, back + aside * along.length() * 0.06], stroke);
        }
    }
}

#[cfg(test)]
mod tests {
    use egui::pos2;

    use super::*;

    #[test]
    fn a_place_on_the_screen_leads_back_to_its_point_of_the_world() {
        let (scene, view) = marraztu_io::default_scene();
        let mut state = State::new(scene, view);
        let rect = Rect::from_min_size(pos2(200.0, 30.0), vec2(800.0, 600.0));
        for projection in [
            marraztu_core::scene::Projection::Perspective,
            marraztu_core::scene::Projection::Orthographic,
        ] {
            state.view.projection = projection;
            let onto = Projection::new(&state, rect, Size::new(800, 600));
            for point in [DVec3::ZERO, DVec3::new(-100.0, 20.0, 30.0), DVec3::new(40.0, 9.0, -90.0)]
            {
                let place = onto.place(point).unwrap();
                let clip = onto.clip(point);
                #[expect(clippy::cast_possible_truncation, reason = "as the picture keeps it")]
                let back = onto.world(place, (clip.z / clip.w) as f32).unwrap();
                assert!(back.distance(point) < 0.1, "{back} for {point}");
            }
        }
    }

    #[test]
    fn points_behind_the_observer_have_no_screen_position() {
        let (scene, view) = marraztu_io::default_scene();
        let state = State::new(scene, view);
        let rect = Rect::from_min_size(pos2(0.0, 0.0), vec2(800.0, 600.0));
        let onto = Projection::new(&state, rect, Size::new(800, 600));
        assert_eq!(onto.place(DVec3::Z * 500.0), None);
        let middle = onto.place(DVec3::ZERO).unwrap();
        assert!(middle.distance(rect.center()) < 1e-3);
    }
}

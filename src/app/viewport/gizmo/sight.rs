//! The projection from points of the world to the window, in f64 relative to the observer.
//!
//! Far from the world's origin, world coordinates leave few digits for small distances. Coordinates
//! relative to the eye keep full precision near it.

use egui::{Pos2, Rect, vec2};
use glam::{DMat3, DVec2, DVec3};

use crate::app::state::State;
use marraztu_core::base::image::Size;
use marraztu_core::scene::Projection;

/// The observer, and the place of the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Sight {
    eye: DVec3,
    axes: DMat3,
    parallel: bool,
    /// The points of the window per unit across, at distance 1 in perspective.
    points: DVec2,
    /// The place of the view axis in the window.
    axis: Pos2,
}

/// A ray through a place of the window, in view space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Ray {
    pub(crate) from: DVec3,
    pub(crate) along: DVec3,
}

impl Sight {
    pub(crate) fn new(state: &State, rect: Rect, size: Size) -> Self {
        let (scene, view) = (&state.scene, &state.view);
        let frame = scene.observer_frame(view);
        let lens = scene.selected_camera(view).lens;
        let clip = lens.clip_from_view(view.projection, size);
        let sides = DVec2::new(f64::from(rect.width()), f64::from(rect.height()));
        let half = sides / 2.0;
        #[expect(clippy::cast_precision_loss, reason = "pictures have fewer than 2^53 pixels")]
        let pixels = DVec2::new(size.width as f64, size.height as f64);
        let by = (lens.principal_point(size) / pixels - 0.5) * sides;
        #[expect(clippy::cast_possible_truncation, reason = "places on the screen are for the eye")]
        let axis = rect.center() + vec2(by.x as f32, by.y as f32);
        Self {
            eye: frame.w_axis.truncate(),
            axes: DMat3::from_mat4(frame),
            parallel: view.projection == Projection::Orthographic,
            points: DVec2::new(clip.x_axis.x * half.x, clip.y_axis.y * half.y),
            axis,
        }
    }

    /// Converts a point from world space to view space.
    pub(crate) fn in_view(&self, at: DVec3) -> DVec3 {
        self.turned(at - self.eye)
    }

    /// Rotates a vector from world space to view space.
    pub(crate) fn turned(&self, v: DVec3) -> DVec3 {
        self.axes.transpose() * v
    }

    /// Rotates a vector from view space to world space.
    pub(crate) fn in_world(&self, v: DVec3) -> DVec3 {
        self.axes * v
    }

    /// Returns the direction from a point in view space to the observer.
    pub(crate) fn towards_eye(&self, at: DVec3) -> DVec3 {
        if self.parallel { DVec3::Z } else { -at.normalize_or(DVec3::NEG_Z) }
    }

    /// Returns the divisor of the projection: the distance in front of the observer in perspective,
    /// else 1.
    fn divisor(&self, at: DVec3) -> f64 {
        if self.parallel { 1.0 } else { -at.z }
    }

    /// Projects a point in view space to the window, if it is in front of the observer.
    #[expect(clippy::cast_possible_truncation, reason = "places on the screen are for the eye")]
    pub(crate) fn place(&self, at: DVec3) -> Option<Pos2> {
        let divisor = self.divisor(at);
        let x = at.x / divisor * self.points.x;
        let y = -at.y / divisor * self.points.y;
        let seen = at.z < 0.0 && x.is_finite() && y.is_finite();
        let far = |x: f64| x.clamp(-1e5, 1e5) as f32;
        seen.then(|| self.axis + vec2(far(x), far(y)))
    }

    /// Returns the length, in view space, of one point of the window at this depth.
    pub(crate) fn unit_at(&self, at: DVec3) -> f64 {
        self.divisor(at) / self.points.min_element()
    }

    /// Returns the ray through a place of the window.
    pub(crate) fn ray(&self, at: Pos2) -> Ray {
        let by = at - self.axis;
        let across =
            DVec3::new(f64::from(by.x) / self.points.x, -f64::from(by.y) / self.points.y, 0.0);
        if self.parallel {
            Ray { from: across, along: DVec3::NEG_Z }
        } else {
            Ray { from: DVec3::ZERO, along: across + DVec3::NEG_Z }
        }
    }
}

impl Ray {
    /// Intersects the ray with the plane through `at` perpendicular to `normal`.
    pub(crate) fn on_plane(&self, at: DVec3, normal: DVec3) -> Option<DVec3> {
        let slope = self.along.dot(normal);
        let way = (at - self.from).dot(normal) / slope;
        let hit = self.from + self.along * way;
        (slope.abs() > 1e-9 * self.along.length() && way > 0.0 && hit.is_finite()).then_some(hit)
    }

    /// Returns the position along the line through `at` in direction `axis` (of length 1) that the
    /// ray points at: where it meets the plane of the line that faces the observer most.
    pub(crate) fn on_line(&self, at: DVec3, axis: DVec3, towards_eye: DVec3) -> Option<f64> {
        let normal = towards_eye - axis * axis.dot(towards_eye);
        let hit = self.on_plane(at, normal.try_normalize()?)?;
        Some((hit - at).dot(axis))
    }
}

#[cfg(test)]
mod tests {
    use egui::pos2;
    use marraztu_core::scene::{Command, Item, Lens};

    use super::*;
    use crate::app::viewport::marks;

    #[test]
    fn handles_and_marks_agree_on_the_place_of_a_point_for_any_lens() {
        let (scene, view) = marraztu_io::default_scene();
        let mut state = State::new(scene, view);
        let rect = Rect::from_min_size(pos2(200.0, 30.0), vec2(800.0, 600.0));
        for (shift, pixel_aspect) in [([0.0; 2], 1.0), ([0.2, -0.3], 1.4)] {
            let mut camera = state.scene.selected_camera(&state.view).clone();
            camera.lens = Lens { shift, pixel_aspect, ..camera.lens };
            let item = Item::Camera(state.view.camera, Box::new(camera));
            Command::Replace(item).apply(&mut state.scene).unwrap();
            let size = Size::new(800, 600);
            let onto = marks::Projection::new(&state, rect, size);
            let sight = Sight::new(&state, rect, size);
            for point in [DVec3::ZERO, DVec3::new(-60.0, 20.0, 30.0)] {
                let [mark, handle] = [onto.place(point), sight.place(sight.in_view(point))];
                let [mark, handle] = [mark, handle].map(Option::unwrap);
                assert!(mark.distance(handle) < 0.01, "{mark} {handle}");
                let ray = sight.ray(mark);
                let off = sight.in_view(point).cross(ray.along).length();
                assert!(off < 0.1 * ray.along.length(), "{off}");
            }
        }
    }
}

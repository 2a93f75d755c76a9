//! How the observer sees points, in f64 relative to the observer.
//!
//! Far from the world's origin a point of the world has few digits left for what is near to it;
//! relative to the eye it has them all.

use egui::{Pos2, Rect, vec2};
use glam::{DMat3, DVec2, DVec3};

use crate::app::state::State;
use marraztu_core::base::image::Size;
use marraztu_core::scene::Projection;

/// The observer and the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Sight {
    eye: DVec3,
    axes: DMat3,
    parallel: bool,
    /// Points of the window for a unit across, at distance 1 in perspective.
    points: DVec2,
    rect: Rect,
}

/// A ray of sight, in view space.
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
        let half = DVec2::new(f64::from(rect.width()), f64::from(rect.height())) / 2.0;
        Self {
            eye: frame.w_axis.truncate(),
            axes: DMat3::from_mat4(frame),
            parallel: view.projection == Projection::Orthographic,
            points: DVec2::new(clip.x_axis.x * half.x, clip.y_axis.y * half.y),
            rect,
        }
    }

    /// A point of the world in view space.
    pub(crate) fn in_view(&self, at: DVec3) -> DVec3 {
        self.turned(at - self.eye)
    }

    /// A vector of the world in view space.
    pub(crate) fn turned(&self, v: DVec3) -> DVec3 {
        self.axes.transpose() * v
    }

    /// A vector of view space in the world.
    pub(crate) fn in_world(&self, v: DVec3) -> DVec3 {
        self.axes * v
    }

    /// The direction from a point of view space to the observer.
    pub(crate) fn towards_eye(&self, at: DVec3) -> DVec3 {
        if self.parallel { DVec3::Z } else { -at.normalize_or(DVec3::NEG_Z) }
    }

    /// How far before the observer it is, as perspective divides by it.
    fn divisor(&self, at: DVec3) -> f64 {
        if self.parallel { 1.0 } else { -at.z }
    }

    /// The place of a point of view space in the window, if it is before the observer.
    #[expect(clippy::cast_possible_truncation, reason = "places on the screen are for the eye")]
    pub(crate) fn place(&self, at: DVec3) -> Option<Pos2> {
        let divisor = self.divisor(at);
        let x = at.x / divisor * self.points.x;
        let y = -at.y / divisor * self.points.y;
        let seen = at.z < 0.0 && x.is_finite() && y.is_finite();
        let far = |x: f64| x.clamp(-1e5, 1e5) as f32;
        seen.then(|| self.rect.center() + vec2(far(x), far(y)))
    }

    /// The length of a point of the window at this point of view space.
    pub(crate) fn unit_at(&self, at: DVec3) -> f64 {
        self.divisor(at) / self.points.min_element()
    }

    /// The ray through a place of the window.
    pub(crate) fn ray(&self, at: Pos2) -> Ray {
        let by = at - self.rect.center();
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
    /// The point in which it meets the plane through `at`, across `normal`.
    pub(crate) fn on_plane(&self, at: DVec3, normal: DVec3) -> Option<DVec3> {
        let slope = self.along.dot(normal);
        let way = (at - self.from).dot(normal) / slope;
        let hit = self.from + self.along * way;
        (slope.abs() > 1e-9 * self.along.length() && way > 0.0 && hit.is_finite()).then_some(hit)
    }

    /// How far along the line through `at` in direction `axis` (of length 1) it comes nearest to
    /// the line: in the plane of the line that faces the observer most.
    pub(crate) fn on_line(&self, at: DVec3, axis: DVec3, towards_eye: DVec3) -> Option<f64> {
        let normal = towards_eye - axis * axis.dot(towards_eye);
        let hit = self.on_plane(at, normal.try_normalize()?)?;
        Some((hit - at).dot(axis))
    }
}

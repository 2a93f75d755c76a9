//! The gizmo: handles over the picture that move, rotate or scale the selected item.
//!
//! The gizmo keeps its size on the screen at every distance and is drawn over everything. Its parts
//! are lines, squares and rings of the window; the part under the pointer is found by its distance.
//! A press on a part without a drag counts as a click into the picture.

mod drag;
mod show;
mod sight;
mod typed;

use egui::{Pos2, Rect, Vec2};
use glam::DVec3;

use crate::app::state::State;
pub(crate) use drag::{Grab, Pull};
use marraztu_core::base::image::Size;
use marraztu_core::base::math::Axis;
use marraztu_core::edit::gizmo::{Pivot, pivot};
use marraztu_core::scene::Transformation;
use sight::Sight;

/// The distance from the middle to the end of an axis, in points.
const LENGTH: f32 = 84.0;

/// The maximum length of an axis, as a part of the smaller side of the picture.
const MOST: f32 = 0.28;

/// The distance within which the pointer hits a line, in points.
const REACH: f32 = 6.0;

/// The position of a plane's square along both axes, and half of its side, in parts of an axis.
const PLANE: [f64; 2] = [0.32, 0.09];

/// The radius of the handle in the middle, in points.
const MIDDLE: f32 = 8.0;

/// The radius of the ring around the line of sight, in parts of an axis.
const OUTER: f32 = 1.18;

/// The radius of the disc with the letter of an axis, in points.
const LETTER: f32 = 8.0;

/// The distance from the end of an axis to the middle of its letter, in points.
const TO_LETTER: f32 = LETTER + 7.0;

/// The number of sides of a ring.
const SIDES: u32 = 64;

/// The cosine above which an axis points at the observer too directly to be dragged along.
const HEAD_ON: f64 = 0.985;

/// The cosine below which a plane is seen too much edge-on to be dragged on.
const EDGE_ON: f64 = 0.15;

/// The distance outside of the picture, in points, from which a gizmo is hidden.
const OUTSIDE: f32 = 2.0;

/// A part of the gizmo that can be dragged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Handle {
    /// Moves or scales along an axis.
    Axis(Axis),
    /// Moves or scales in the plane perpendicular to an axis.
    Plane(Axis),
    /// Rotates about an axis.
    Ring(Axis),
    /// Rotates about the line of sight.
    Outer,
    /// Moves in the plane of the picture, or scales in all directions alike.
    Middle,
}

/// The shape of a handle on the screen.
#[derive(Clone, Debug, PartialEq)]
enum Shape {
    /// A line from the middle to an end.
    Line([Pos2; 2]),
    /// A square in its plane.
    Square([Pos2; 4]),
    /// A ring as two halves, the near one in front of the middle.
    Ring { near: Vec<Pos2>, far: Vec<Pos2> },
    /// A whole circle.
    Circle(Pos2, f32),
    /// A small disk.
    Disk(Pos2),
}

/// A handle on the screen.
#[derive(Clone, Debug, PartialEq)]
struct Part {
    handle: Handle,
    shape: Shape,
}

/// The handles of the selected item.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Gizmo {
    pivot: Pivot,
    sight: Sight,
    /// The handles in drawing order, the uppermost last.
    parts: Vec<Part>,
}

impl Gizmo {
    /// Creates the gizmo of the selected item, if it is visible.
    pub(super) fn new(state: &State, rect: Rect, size: Size) -> Option<Self> {
        if !state.gizmo || !state.shows_overlays() || state.aiming || state.explaining {
            return None;
        }
        let gizmo = Self::of(state, rect, size)?;
        (!gizmo.parts.is_empty()).then_some(gizmo)
    }

    /// Creates the gizmo of the selected item, visible or not.
    fn of(state: &State, rect: Rect, size: Size) -> Option<Self> {
        let pivot = pivot(&state.scene, &state.view).ok()?;
        let sight = Sight::new(state, rect, size);
        let middle = sight.in_view(pivot.origin);
        let mut gizmo = Self { pivot, sight, parts: Vec::new() };
        let place = sight.place(middle).filter(|at| rect.expand(OUTSIDE).contains(*at));
        // A middle outside of the picture leaves the gizmo without handles; typed numbers still
        // work.
        if let Some(place) = place {
            gizmo.build(middle, place, LENGTH.min(rect.size().min_elem() * MOST));
        }
        Some(gizmo)
    }

    fn build(&mut self, middle: DVec3, place: Pos2, length: f32) {
        let outer = length * OUTER;
        // Limited so no end comes to lie behind the observer.
        let length = f64::from(length) * self.sight.unit_at(middle);
        let length = if length.is_finite() { length.min(middle.length() * 0.5) } else { return };
        let add = |parts: &mut Vec<Part>, handle, shape: Option<Shape>| {
            parts.extend(shape.map(|shape| Part { handle, shape }));
        };
        let mut parts = Vec::new();
        // Later parts lie over earlier ones: axes over planes, the middle over all.
        match self.pivot.kind {
            Transformation::Rotation => {
                add(&mut parts, Handle::Outer, Some(Shape::Circle(place, outer)));
                for axis in Axis::ALL {
                    add(&mut parts, Handle::Ring(axis), self.ring(middle, axis, length));
                }
            }
            Transformation::Translation | Transformation::Scaling => {
                for axis in Axis::ALL {
                    add(&mut parts, Handle::Plane(axis), self.square(middle, axis, length));
                }
                for axis in Axis::ALL {
                    add(&mut parts, Handle::Axis(axis), self.line(middle, axis, length));
                }
                add(&mut parts, Handle::Middle, Some(Shape::Disk(place)));
            }
        }
        self.parts = parts;
    }

    /// Returns the direction of an axis in view space.
    fn axis(&self, axis: Axis) -> Option<DVec3> {
        self.pivot.direction(axis).map(|v| self.sight.turned(v))
    }

    fn line(&self, middle: DVec3, axis: Axis, length: f64) -> Option<Shape> {
        let along = self.axis(axis)?;
        let head_on = along.dot(self.sight.towards_eye(middle)).abs() > HEAD_ON;
        let ends = [self.sight.place(middle)?, self.sight.place(middle + along * length)?];
        (!head_on).then_some(Shape::Line(ends))
    }

    fn square(&self, middle: DVec3, across: Axis, length: f64) -> Option<Shape> {
        let [a, b] = others(across);
        let (a, b) = (self.axis(a)?, self.axis(b)?);
        let facing = a.cross(b).try_normalize()?.dot(self.sight.towards_eye(middle));
        let [at, half] = PLANE.map(|part| part * length);
        let corner =
            |i: f64, j: f64| self.sight.place(middle + a * (at + i * half) + b * (at + j * half));
        let square =
            [corner(-1.0, -1.0)?, corner(1.0, -1.0)?, corner(1.0, 1.0)?, corner(-1.0, 1.0)?];
        (facing.abs() > EDGE_ON).then_some(Shape::Square(square))
    }

    fn ring(&self, middle: DVec3, about: Axis, length: f64) -> Option<Shape> {
        let axis = self.axis(about)?;
        let eye = self.sight.towards_eye(middle);
        // The direction in the ring's plane that points to the observer; the near half is centred
        // on it.
        let near = (eye - axis * eye.dot(axis)).try_normalize();
        let near = near.unwrap_or_else(|| axis.any_orthonormal_vector());
        let side = axis.cross(near);
        let point = |i: u32| {
            let turn = std::f64::consts::TAU * (f64::from(i) / f64::from(SIDES) - 0.25);
            let aside = near * libm::cos(turn) + side * libm::sin(turn);
            self.sight.place(middle + aside * length)
        };
        // A ring seen almost from above has no far half.
        let flat = eye.dot(axis).abs() > 0.98;
        let half = if flat { SIDES } else { SIDES / 2 };
        let points = |range: std::ops::RangeInclusive<u32>| range.map(point).collect();
        let near: Option<Vec<Pos2>> = points(0..=half);
        let far: Option<Vec<Pos2>> = points(half..=SIDES);
        Some(Shape::Ring { near: near?, far: far? })
    }

    /// Finds the handle at a place of the window: the nearest one, and the upper one among equals.
    pub(crate) fn handle_at(&self, at: Pos2) -> Option<Handle> {
        let reached = |part: &&Part| part.shape.distance(at).is_some_and(|far| far <= REACH);
        let over = self.parts.iter().rev().filter(reached);
        // Disks and squares are hit anywhere inside, so they win over lines near to them.
        let rank = |part: &&Part| match part.shape {
            Shape::Disk(_) | Shape::Square(_) => 0.0,
            Shape::Line(_) | Shape::Ring { .. } | Shape::Circle(..) => {
                part.shape.distance(at).unwrap_or(REACH)
            }
        };
        over.min_by(|a, b| rank(a).total_cmp(&rank(b))).map(|part| part.handle)
    }
}

impl Shape {
    /// Returns the place of the letter of an axis, if the shape has one.
    fn letter(&self) -> Option<Pos2> {
        match self {
            Self::Line([from, to]) => Some(*to + (*to - *from).normalized() * TO_LETTER),
            Self::Ring { near, .. } => near.get(near.len() / 2).copied(),
            Self::Square(_) | Self::Circle(..) | Self::Disk(_) => None,
        }
    }

    /// Returns the distance of a place from the shape and its letter, at least 0; `None` if an area
    /// does not contain it.
    fn distance(&self, at: Pos2) -> Option<f32> {
        if self.letter().is_some_and(|letter| letter.distance(at) <= LETTER) {
            return Some(0.0);
        }
        match self {
            // All axes meet in the middle, so their inner ends are left to the disk.
            Self::Line([from, to]) => {
                let from = *from + (*to - *from) * 0.15;
                Some(segment_distance(at, [from, *to]))
            }
            Self::Square(corners) => inside(at, corners).then_some(0.0),
            Self::Ring { near, .. } => near
                .windows(2)
                .map(|ends| segment_distance(at, [ends[0], ends[1]]))
                .min_by(f32::total_cmp),
            Self::Circle(middle, radius) => Some((at.distance(*middle) - radius).abs()),
            Self::Disk(middle) => (at.distance(*middle) <= MIDDLE).then_some(0.0),
        }
    }
}

/// Returns the distance of a place from a line segment.
fn segment_distance(at: Pos2, [a, b]: [Pos2; 2]) -> f32 {
    let (way, to) = (b - a, at - a);
    let part =
        if way == Vec2::ZERO { 0.0 } else { (to.dot(way) / way.length_sq()).clamp(0.0, 1.0) };
    at.distance(a + way * part)
}

/// Returns whether a place is inside a convex quadrilateral.
fn inside(at: Pos2, corners: &[Pos2; 4]) -> bool {
    let side = |i: usize| {
        let (a, b) = (corners[i], corners[(i + 1) % 4]);
        let (way, to) = (b - a, at - a);
        way.x * to.y - way.y * to.x
    };
    let sides = [side(0), side(1), side(2), side(3)];
    sides.iter().all(|side| *side >= 0.0) || sides.iter().all(|side| *side <= 0.0)
}

/// Returns the two axes perpendicular to an axis.
const fn others(axis: Axis) -> [Axis; 2] {
    match axis {
        Axis::X => [Axis::Y, Axis::Z],
        Axis::Y => [Axis::Z, Axis::X],
        Axis::Z => [Axis::X, Axis::Y],
    }
}

#[cfg(test)]
mod tests {
    use egui::pos2;

    use super::*;

    #[test]
    fn a_place_is_as_far_from_a_line_as_from_its_nearest_point() {
        let ends = [pos2(0.0, 0.0), pos2(10.0, 0.0)];
        for (at, far) in [((5.0, 3.0), 3.0), ((-4.0, 3.0), 5.0), ((14.0, -3.0), 5.0)] {
            let got = segment_distance(pos2(at.0, at.1), ends);
            assert!((got - far).abs() < 1e-5, "{at:?}: {got}");
        }
        assert!((segment_distance(pos2(3.0, 4.0), [ends[0]; 2]) - 5.0).abs() < 1e-5);
    }

    #[test]
    fn a_quadrilateral_contains_the_same_points_in_either_winding() {
        let mut corners = [pos2(0.0, 0.0), pos2(4.0, 1.0), pos2(5.0, 4.0), pos2(1.0, 3.0)];
        for _ in 0..2 {
            assert!(inside(pos2(2.5, 2.0), &corners));
            assert!(!inside(pos2(4.8, 1.5), &corners));
            assert!(!inside(pos2(0.2, 2.0), &corners));
            corners.reverse();
        }
    }
}

//! Drags of a handle: converts positions of the pointer, or typed numbers, into amounts.
//!
//! Every amount is relative to the places of the items at the start of the drag and to the place of
//! the press. Nothing is accumulated from frame to frame, so nothing drifts, and moving back
//! restores the start.

use egui::{Pos2, Rect, Vec2};
use glam::DVec3;

use super::typed::Typed;
use super::{Gizmo, Handle, others};
use crate::app::actions::{Request, Requests};
use crate::app::chord::command_key;
use crate::app::state::State;
use crate::app::widgets::{expression, number::short};
use marraztu_core::base::image::Size;
use marraztu_core::base::math::{self, Axis};
use marraztu_core::edit::gizmo::{self, Amount};
use marraztu_core::edit::places::ItemPlaces;
use marraztu_core::edit::{Gesture, GesturePhase, several};
use marraztu_core::scene::{ItemId, Scene, Transformation, View};

/// The distance over which a scale doubles, in points of the window.
const DOUBLE: f64 = 100.0;

/// The cosine below which a ring is seen edge-on: it then turns by the distance along its edge.
const RING_EDGE_ON: f64 = 0.3;

/// A handle that is being dragged.
#[derive(Debug)]
pub(crate) struct Grab {
    gizmo: Gizmo,
    handle: Handle,
    from: Pos2,
    /// The view at the start.
    view: View,
    /// The selected items; the keys act on the first.
    items: Vec<ItemId>,
    /// The places of the items at the start.
    start: ItemPlaces,
    /// The places of the items after the last change that was made, and after the last request.
    known: [ItemPlaces; 2],
    name: String,
    /// The last angle, and the sum of all changes over several turns.
    angle: f64,
    turned: f64,
    typed: Typed,
    /// The last amount requested.
    asked: Option<Amount>,
    /// The current effect, in words.
    pub(crate) said: String,
}

/// The input of one frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pull<'a> {
    pub(crate) to: Pos2,
    pub(crate) snap: bool,
    pub(crate) typed: &'a str,
}

impl Grab {
    /// Grabs a handle at a place of the window.
    pub(crate) fn new(state: &State, gizmo: &Gizmo, handle: Handle, from: Pos2) -> Self {
        let items: Vec<ItemId> = state.selected().into_iter().chain(state.others()).collect();
        let start = ItemPlaces::of(&state.scene, &items);
        let mut grab = Self {
            gizmo: gizmo.clone(),
            handle,
            from,
            view: state.view.clone(),
            items,
            known: [start.clone(), start.clone()],
            start,
            name: state.acted_on_name(),
            angle: 0.0,
            turned: 0.0,
            typed: Typed::default(),
            asked: None,
            said: String::new(),
        };
        grab.angle = grab.angle_at(from).unwrap_or(0.0);
        grab
    }

    /// Begins to take typed numbers without the mouse, along or about X.
    pub(crate) fn typing(state: &State, rect: Rect, size: Size) -> Option<Self> {
        let gizmo = Gizmo::of(state, rect, size)?;
        let handle = match gizmo.pivot.kind {
            Transformation::Translation => Handle::Axis(Axis::X),
            Transformation::Rotation => Handle::Ring(Axis::X),
            Transformation::Scaling => Handle::Middle,
        };
        let mut grab = Self::new(state, &gizmo, handle, rect.center());
        grab.say(None);
        Some(grab)
    }

    /// Returns the handle, along the axis that was typed.
    pub(crate) fn handle(&self) -> Handle {
        match (self.handle, self.typed.axis()) {
            (Handle::Axis(_), Some(axis)) => Handle::Axis(axis),
            (Handle::Ring(_), Some(axis)) => Handle::Ring(axis),
            (handle, _) => handle,
        }
    }

    /// Returns whether a number was typed, which counts as a drag even if the pointer has hardly
    /// moved.
    pub(crate) fn is_typed(&self) -> bool {
        self.typed != Typed::default()
    }

    /// Follows the pointer and the keyboard. Adds the change and returns whether Enter ended the
    /// drag, or another change of the places did: the amount no longer counts from the start then.
    pub(crate) fn follow(
        &mut self,
        scene: &Scene,
        pull: Pull<'_>,
        gesture: Gesture,
        requests: &mut Requests,
    ) -> bool {
        if self.is_moved_by_others(scene) {
            return true;
        }
        // Everything but the places is as it is now, such as a model that was reloaded.
        let scene = &self.start.given_to(scene);
        let ended = self.typed.take(pull.typed);
        let amount = if self.is_typed() {
            let number = expression::value(&self.typed.text);
            number.and_then(|number| self.of_number(number))
        } else {
            let amount = self.of_pointer(pull.to);
            let snap = |amount| gizmo::snapped(scene, &self.view, amount);
            if pull.snap { amount.map(snap) } else { amount }
        };
        self.say(amount);
        if let Some(amount) = amount.filter(|amount| self.asked != Some(*amount)) {
            self.asked = Some(amount);
            let others = self.items.get(1..).unwrap_or_default();
            let command = several::each(scene, &self.view, others, |scene, view| {
                gizmo::transform(scene, view, amount, GesturePhase::First)
            });
            let mut after = scene.clone();
            if command.clone().is_ok_and(|command| command.apply(&mut after).is_ok()) {
                self.known[1] = ItemPlaces::of(&after, &self.items);
            }
            requests.push(Request::change(self.label(amount), gesture, command));
        }
        ended
    }

    /// Follows the keyboard without the mouse: nothing happens before a number is typed.
    pub(crate) fn follow_typed(
        &mut self,
        scene: &Scene,
        pull: Pull<'_>,
        gesture: Gesture,
        requests: &mut Requests,
    ) -> bool {
        if pull.typed == "\n" && !self.is_typed() {
            return true;
        }
        if self.is_moved_by_others(scene) {
            return true;
        }
        let empty = pull.typed.is_empty() && !self.is_typed();
        !empty && self.follow(scene, pull, gesture, requests)
    }

    /// Returns whether the items are at other places than those of this drag. A frame may ask for
    /// several changes before the first one is made.
    fn is_moved_by_others(&mut self, scene: &Scene) -> bool {
        let places = ItemPlaces::of(scene, &self.items);
        let [made, asked] = &mut self.known;
        if places == *asked {
            *made = places;
            return false;
        }
        places != *made
    }

    /// Describes the amount for the history: "Move teapot 12 along x".
    fn label(&self, amount: Amount) -> String {
        let name = &self.name;
        let list = |v: DVec3| v.to_array().map(short).join(", ");
        match amount {
            Amount::Move(by) => match only(by, 0.0) {
                Some((axis, by)) => format!("Move {name} {} along {}", short(by), letter(axis)),
                None => format!("Move {name} by {}", list(by)),
            },
            Amount::Turn(about, radians) => {
                let degrees = short(radians.to_degrees());
                match only(about, 0.0) {
                    Some((axis, _)) => {
                        format!("Rotate {name} {degrees} deg about {}", letter(axis))
                    }
                    None => format!("Rotate {name} {degrees} deg about the line of sight"),
                }
            }
            Amount::Scale(by) if by == DVec3::splat(by.x) => {
                format!("Scale {name} by {}", short(by.x))
            }
            Amount::Scale(by) => match only(by, 1.0) {
                Some((axis, by)) => format!("Scale {name} by {} along {}", short(by), letter(axis)),
                None => format!("Scale {name} by {}", list(by)),
            },
        }
    }

    /// Updates the description of the current effect.
    fn say(&mut self, amount: Option<Amount>) {
        let mut said = match amount {
            Some(amount) => self.label(amount),
            None => match self.gizmo.pivot.kind {
                Transformation::Translation => format!("Move {}", self.name),
                Transformation::Rotation => format!("Rotate {}", self.name),
                Transformation::Scaling => format!("Scale {}", self.name),
            },
        };
        if self.is_typed() {
            let axis =
                self.typed.axis().map_or_else(String::new, |axis| format!("{} ", letter(axis)));
            said += &format!("   [{axis}{}]  Enter takes it", self.typed.text);
        } else {
            let snap = command_key!();
            said += &format!("   type x, y, z and a number; {snap} snaps; Esc cancels");
        }
        self.said = said;
    }

    /// Converts a typed number into an amount of this handle, or along the axis typed before it.
    fn of_number(&self, number: f64) -> Option<Amount> {
        let axis = self.typed.axis().or(match self.handle {
            Handle::Axis(axis) | Handle::Ring(axis) => Some(axis),
            Handle::Plane(_) | Handle::Outer | Handle::Middle => None,
        });
        // A plane applies the number to both of its axes, a handle without an axis to all three.
        let all = match self.handle {
            Handle::Plane(across) => DVec3::ONE - across.unit(),
            Handle::Axis(_) | Handle::Ring(_) | Handle::Outer | Handle::Middle => DVec3::ONE,
        };
        Some(match (self.gizmo.pivot.kind, axis) {
            (Transformation::Translation, Some(axis)) => Amount::Move(axis.unit() * number),
            (Transformation::Translation, None) if self.handle == Handle::Middle => {
                Amount::Move(DVec3::X * number)
            }
            (Transformation::Translation, None) => Amount::Move(all * number),
            (Transformation::Rotation, Some(axis)) => {
                Amount::Turn(axis.unit(), number.to_radians())
            }
            (Transformation::Rotation, None) => {
                Amount::Turn(self.line_of_sight()?, number.to_radians())
            }
            (Transformation::Scaling, Some(axis)) => {
                Amount::Scale(DVec3::ONE + axis.unit() * (number - 1.0))
            }
            (Transformation::Scaling, None) => Amount::Scale(DVec3::ONE + all * (number - 1.0)),
        })
    }

    /// Converts the position of the pointer into an amount; `None` if the position has no solution.
    fn of_pointer(&mut self, to: Pos2) -> Option<Amount> {
        let Gizmo { pivot, sight, .. } = &self.gizmo;
        let middle = sight.in_view(pivot.origin);
        // Handles without a direction scale by the distance dragged to the upper right.
        let by = to - self.from;
        let growth = libm::exp2(f64::from(by.x - by.y) / DOUBLE);
        match (self.handle, pivot.kind) {
            (Handle::Axis(axis), kind) => {
                // Positions along the axis: their ratio scales, their difference moves.
                let (from, to) = (self.along(axis, self.from)?, self.along(axis, to)?);
                Some(match kind {
                    Transformation::Scaling => {
                        Amount::Scale(DVec3::ONE + axis.unit() * (to / from - 1.0))
                    }
                    Transformation::Translation | Transformation::Rotation => {
                        Amount::Move(axis.unit() * (to - from))
                    }
                })
            }
            (Handle::Plane(across), Transformation::Scaling) => {
                Some(Amount::Scale(DVec3::ONE + (DVec3::ONE - across.unit()) * (growth - 1.0)))
            }
            (Handle::Middle, Transformation::Scaling) => Some(Amount::Scale(DVec3::splat(growth))),
            (Handle::Plane(across), _) => {
                // A plane handle moves on the plane through the middle; only its two axes count.
                let [a, b] = others(across);
                let normal = self.gizmo.axis(a)?.cross(self.gizmo.axis(b)?).try_normalize()?;
                let moved = self.moved_on(middle, normal, to)?;
                Some(Amount::Move(moved * (DVec3::ONE - across.unit())))
            }
            (Handle::Middle, _) => Some(Amount::Move(self.moved_on(middle, DVec3::Z, to)?)),
            (Handle::Ring(axis), _) => Some(Amount::Turn(axis.unit(), self.turned_to(to)?)),
            (Handle::Outer, _) => {
                let axis = self.line_of_sight()?;
                Some(Amount::Turn(axis, self.turned_to(to)?))
            }
        }
    }

    /// Returns the position of a place along an axis, in units of the world.
    fn along(&self, axis: Axis, at: Pos2) -> Option<f64> {
        let Gizmo { pivot, sight, .. } = &self.gizmo;
        let middle = sight.in_view(pivot.origin);
        let ray = sight.ray(at);
        ray.on_line(middle, self.gizmo.axis(axis)?, sight.towards_eye(middle))
    }

    /// Returns the movement of the pointer on a plane, in the frame.
    fn moved_on(&self, middle: DVec3, normal: DVec3, to: Pos2) -> Option<DVec3> {
        let Gizmo { pivot, sight, .. } = &self.gizmo;
        let hit = |at| sight.ray(at).on_plane(middle, normal);
        pivot.in_frame(sight.in_world(hit(to)? - hit(self.from)?))
    }

    /// Returns the direction to the observer, in the frame.
    fn line_of_sight(&self) -> Option<DVec3> {
        let Gizmo { pivot, sight, .. } = &self.gizmo;
        let eye = sight.towards_eye(sight.in_view(pivot.origin));
        math::unit(pivot.in_frame(sight.in_world(eye))?)
    }

    /// Returns the rotation of a ring so far, which may exceed a full turn.
    fn turned_to(&mut self, to: Pos2) -> Option<f64> {
        use std::f64::consts::{PI, TAU};
        let angle = self.angle_at(to)?;
        let by = angle - self.angle;
        self.turned += by - TAU * ((by + PI) / TAU).floor();
        self.angle = angle;
        Some(self.turned * self.gizmo.pivot.hand())
    }

    /// Returns the angle of a place about the ring's axis, in the world.
    fn angle_at(&self, at: Pos2) -> Option<f64> {
        let Gizmo { pivot, sight, .. } = &self.gizmo;
        let middle = sight.in_view(pivot.origin);
        let eye = sight.towards_eye(middle);
        let about = match self.handle {
            // An edge-on ring has no usable intersection with the line of sight.
            Handle::Ring(axis) => self.gizmo.axis(axis)?,
            Handle::Outer => eye,
            Handle::Axis(_) | Handle::Plane(_) | Handle::Middle => return None,
        };
        if self.handle != Handle::Outer && eye.dot(about).abs() < RING_EDGE_ON {
            // The drag counts along the tangent at the point nearest to the observer: one radius is
            // one radian.
            let near = (eye - about * eye.dot(about)).try_normalize()?;
            let ahead = sight.place(middle + about.cross(near) * sight.unit_at(middle))?;
            let way: Vec2 = (ahead - sight.place(middle)?).normalized();
            return Some(f64::from((at - self.from).dot(way) / super::LENGTH));
        }
        let hit = sight.ray(at).on_plane(middle, about)? - middle;
        // Any direction in the ring's plane serves as zero, since only differences count.
        let side = about.any_orthonormal_vector();
        Some(libm::atan2(hit.dot(about.cross(side)), hit.dot(side)))
    }
}

/// Returns the only component of a vector that differs from `rest`, with its axis.
fn only(v: DVec3, rest: f64) -> Option<(Axis, f64)> {
    let mut own = Axis::ALL.into_iter().filter(|axis| v[axis.index()] != rest);
    let axis = own.next()?;
    own.next().is_none().then_some((axis, v[axis.index()]))
}

const fn letter(axis: Axis) -> &'static str {
    ["x", "y", "z"][axis.index()]
}

#[cfg(test)]
mod tests;

//! What gives a light its position and its direction.

use glam::{DMat3, DVec3};
use serde::{Deserialize, Serialize};

use super::tracked::Tracked;
use super::{CameraId, ObjectId};
use crate::base::math;

/// What gives a light its position and direction; this is what can be moved, turned and aimed.
#[derive(Clone, Copy, Debug)]
pub enum Anchor<'a> {
    /// Nothing: it has neither.
    Everywhere,
    /// A direction of its own; it is infinitely far away.
    Direction(&'a Tracked<DVec3>),
    /// A position of its own; it shines in all directions.
    Position(&'a Tracked<DVec3>),
    /// An item, or a position and a direction of its own.
    Owner(&'a SpotOwner),
}

/// An [`Anchor`] to change.
#[derive(Debug)]
pub enum AnchorMut<'a> {
    /// Nothing.
    Everywhere,
    /// A direction.
    Direction(&'a mut Tracked<DVec3>),
    /// A position.
    Position(&'a mut Tracked<DVec3>),
    /// An item, or both.
    Owner(&'a mut SpotOwner),
}

/// What a spot is attached to. It shines from there along -Z.
#[derive(Clone, Debug, PartialEq)]
pub enum SpotOwner {
    /// The selected object, whichever it is.
    SelectedObject,
    /// The selected camera, whichever it is.
    SelectedCamera,
    /// This object.
    Object(ObjectId),
    /// This camera.
    Camera(CameraId),
    /// Nothing: it has a position and a direction of its own.
    Fixed(Tracked<Aim>),
}

impl SpotOwner {
    /// The position and direction of a spot that has its own.
    #[must_use]
    pub const fn fixed(&self) -> Option<&Tracked<Aim>> {
        match self {
            Self::Fixed(aim) => Some(aim),
            Self::SelectedObject | Self::SelectedCamera | Self::Object(_) | Self::Camera(_) => None,
        }
    }
}

/// The position and the direction that a light has now.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightOrigin {
    /// The position; `None` if the light is infinitely far away or everywhere.
    pub position: Option<DVec3>,
    /// The direction, of length 1; `None` if the light shines in all directions.
    pub direction: Option<DVec3>,
}

/// A position and a direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aim {
    /// The position.
    pub position: DVec3,
    /// The direction, of length 1.
    pub direction: DVec3,
}

/// Circling the world's Y axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Orbit {
    /// Whether it circles.
    pub on: bool,
    /// Degrees per second.
    pub speed: f64,
    /// When it began, in seconds of the scene's clock.
    pub since: f64,
}

impl Default for Orbit {
    fn default() -> Self {
        Self { on: false, speed: 30.0, since: 0.0 }
    }
}

impl Orbit {
    /// The position of a bulb at `time` (seconds of the scene's clock) if it is placed at
    /// `position`.
    #[must_use]
    pub fn at(&self, position: DVec3, time: f64) -> DVec3 {
        if !self.on {
            return position;
        }
        let degrees = (self.speed * (time - self.since)) % 360.0;
        let turn: DMat3 = math::rotation(DVec3::Y, degrees.to_radians());
        turn * position
    }
}

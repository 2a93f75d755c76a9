//! The anchor of a light: the source of its position and direction.

use glam::{DMat3, DVec3};
use serde::{Deserialize, Serialize};

use super::tracked::Tracked;
use super::{CameraId, ObjectId};
use crate::base::math;

/// The source of a light's position and direction, which can be moved, turned and aimed.
#[derive(Clone, Copy, Debug)]
pub enum Anchor<'a> {
    /// Neither position nor direction: ambient light.
    Everywhere,
    /// A direction; the light is infinitely far away.
    Direction(&'a Tracked<DVec3>),
    /// A position; the light shines in all directions.
    Position(&'a Tracked<DVec3>),
    /// An item, or a fixed position and direction.
    Owner(&'a SpotOwner),
}

/// A mutable [`Anchor`].
#[derive(Debug)]
pub enum AnchorMut<'a> {
    /// Neither position nor direction.
    Everywhere,
    /// A direction.
    Direction(&'a mut Tracked<DVec3>),
    /// A position.
    Position(&'a mut Tracked<DVec3>),
    /// An item, or a fixed position and direction.
    Owner(&'a mut SpotOwner),
}

/// The owner of a spot. The spot shines from there along -Z.
#[derive(Clone, Debug, PartialEq)]
pub enum SpotOwner {
    /// The object that is currently selected.
    SelectedObject,
    /// The camera that is currently selected.
    SelectedCamera,
    /// This object.
    Object(ObjectId),
    /// This camera.
    Camera(CameraId),
    /// A fixed position and direction, without an owner.
    Fixed(Tracked<Aim>),
}

impl SpotOwner {
    /// Returns the position and direction of a fixed spot; `None` if an item owns the spot.
    pub const fn fixed(&self) -> Option<&Tracked<Aim>> {
        match self {
            Self::Fixed(aim) => Some(aim),
            Self::SelectedObject | Self::SelectedCamera | Self::Object(_) | Self::Camera(_) => None,
        }
    }
}

/// The current position and direction of a light.
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

/// A circular motion about the world's Y axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Orbit {
    /// Whether the light circles.
    pub on: bool,
    /// The speed in degrees per second.
    pub speed: f64,
    /// The start time, in seconds of the scene's clock.
    pub since: f64,
}

impl Default for Orbit {
    fn default() -> Self {
        Self { on: false, speed: 30.0, since: 0.0 }
    }
}

impl Orbit {
    /// Returns the position of a bulb at `time` (seconds of the scene's clock) if it is placed at
    /// `position`.
    pub fn at(&self, position: DVec3, time: f64) -> DVec3 {
        if !self.on {
            return position;
        }
        let degrees = (self.speed * (time - self.since)) % 360.0;
        let turn: DMat3 = math::rotation(DVec3::Y, degrees.to_radians());
        turn * position
    }
}

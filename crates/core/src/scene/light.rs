//! The lights of a scene.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::{LightKind, Orbit, SpotOwner, Tracked};
use crate::base::color::Color;

/// A light.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// The name in the outline.
    pub name: String,
    /// The slot: the number of the light's key; 0 to 9 have a key. Each light has a different slot.
    pub slot: u32,
    /// Whether the light is on.
    pub on: bool,
    /// The colour.
    pub color: Color,
    /// The attenuation with distance; suns and ambient light ignore it.
    pub attenuation: Attenuation,
    /// Whether objects cast shadows in this light; ambient light casts no shadows.
    pub shadows: bool,
    /// The extent of a light that casts shadows, which makes their borders soft: the radius of a
    /// bulb or spot in units of the world, or the angular diameter of a sun in degrees. At least 0;
    /// 0 is a point.
    pub size: f64,
    /// The kind of light, with its parameters.
    pub kind: LightKind,
}

/// The attenuation at distance d: 1 / (constant + linear d + quadratic d^2).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Attenuation {
    /// The constant term; more than 0 if the others are 0.
    pub constant: f64,
    /// The linear term, per unit of distance.
    pub linear: f64,
    /// The quadratic term, per square unit.
    pub quadratic: f64,
}

impl Default for Attenuation {
    fn default() -> Self {
        Self { constant: 1.0, linear: 5e-6, quadratic: 5e-6 }
    }
}

impl Attenuation {
    /// Returns whether the light at every distance is finite and not negative.
    pub fn is_valid(&self) -> bool {
        let all = [self.constant, self.linear, self.quadratic];
        all.iter().all(|x| x.is_finite() && *x >= 0.0) && all.iter().any(|x| *x > 0.0)
    }
}

impl Light {
    /// Returns whether the light can cast shadows. Ambient light cannot; the shadows of the sky are
    /// its occlusion.
    pub const fn can_cast_shadows(&self) -> bool {
        !matches!(self.kind, LightKind::Ambient)
    }

    /// Returns the largest valid size.
    pub const fn largest_size(&self) -> f64 {
        match self.kind {
            LightKind::Ambient | LightKind::Sky { .. } => 0.0,
            LightKind::Sun { .. } => 90.0,
            LightKind::Bulb { .. } | LightKind::Spot { .. } => f64::MAX,
        }
    }

    /// Returns whether the light casts soft shadows.
    pub fn is_soft(&self) -> bool {
        let is_large = self.size > 0.0 || matches!(self.kind, LightKind::Sky { .. });
        self.shadows && self.can_cast_shadows() && is_large
    }

    /// Creates a white light that is on.
    pub fn new(name: &str, slot: u32, kind: LightKind) -> Self {
        Self {
            name: name.to_owned(),
            slot,
            on: true,
            color: Color::WHITE,
            attenuation: Attenuation::default(),
            shadows: false,
            size: 0.0,
            kind,
        }
    }

    /// Returns the five lights of the first scene: ambient, sun, bulb, and the spots of the
    /// selected object and of the selected camera.
    pub fn five() -> [Self; 5] {
        let spot = |owner| LightKind::Spot { owner, half_aperture: 22.5, exponent: 5.0 };
        let sun = LightKind::Sun { direction: Tracked::new(DVec3::NEG_Y) };
        let position = Tracked::new(DVec3::new(0.0, 0.0, -200.0));
        [
            Self::new("ambient", 0, LightKind::Ambient),
            Self::new("sun", 1, sun),
            Self::new("bulb", 2, LightKind::Bulb { position, orbit: Orbit::default() }),
            Self::new("object spot", 3, spot(SpotOwner::SelectedObject)),
            Self::new("camera spot", 4, spot(SpotOwner::SelectedCamera)),
        ]
    }
}

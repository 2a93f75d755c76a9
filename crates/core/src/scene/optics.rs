//! Mirrors and refraction: what a surface shows of its surroundings.

use serde::{Deserialize, Serialize};

/// What a surface shows of its surroundings, by rays: `illum` 3 to 9, `Ni` and `Tf` of an MTL file.
///
/// The colour of a point is its own colour, plus R times the colour seen along the mirrored ray,
/// plus (1 - R) times the [`transmission`](Self::transmission) times the colour seen along the
/// refracted ray.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Optics {
    /// The reflectance R.
    pub reflection: Reflection,
    /// The light that passes through the surface.
    pub transmission: Transmission,
    /// The index of refraction, from 0.1 to 10: Ni. Light passes unbent if it is 1, and through
    /// surfaces that are not closed.
    pub index: f64,
}

/// How much light a surface mirrors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Reflection {
    /// None: R is 0.
    #[default]
    None,
    /// The same in all directions: R is Ks.
    Constant,
    /// More at grazing angles: R = F + (1 - F) (1 - c)^5, with the cosine c of the angle of
    /// incidence. F is Ks, or ((Ni - 1) / (Ni + 1))^2 where that is more.
    ///
    /// Schlick, "An Inexpensive BRDF Model for Physically-Based Rendering", 1994.
    Fresnel,
}

/// The fraction of light that passes through a surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub enum Transmission {
    /// None.
    #[default]
    None,
    /// What the opacity leaves: 1 - d. The surface's own colour is multiplied by d.
    Opacity,
    /// These fractions of red, green and blue, from 0 to 1: Tf.
    Filter([f64; 3]),
}

impl Reflection {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::None, Self::Constant, Self::Fresnel];
}

impl Optics {
    /// A surface that mirrors nothing and lets no light through.
    pub const NONE: Self =
        Self { reflection: Reflection::None, transmission: Transmission::None, index: 1.0 };
    /// The range of indices of refraction.
    pub const INDICES: std::ops::RangeInclusive<f64> = 0.1..=10.0;

    /// Returns whether light may pass through the surface.
    pub fn transmits(&self) -> bool {
        !matches!(self.transmission, Transmission::None | Transmission::Filter([0.0, 0.0, 0.0]))
    }

    /// Returns whether no ray is needed.
    pub fn is_none(&self) -> bool {
        self.reflection == Reflection::None && !self.transmits()
    }

    /// Returns the `illum` of an MTL file that means the same.
    pub fn illumination(&self) -> f64 {
        match (self.reflection, self.transmits()) {
            (Reflection::None, false) => 2.0,
            (Reflection::Constant, false) => 3.0,
            (Reflection::Fresnel, false) => 5.0,
            (Reflection::None | Reflection::Constant, true) => 6.0,
            (Reflection::Fresnel, true) => 7.0,
        }
    }
}

impl Default for Optics {
    fn default() -> Self {
        Self::NONE
    }
}

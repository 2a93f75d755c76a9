//! The rules for smooth edges of a mesh.

use serde::{Deserialize, Serialize};

/// The angle between the normals of two faces below which the edge between them is smooth: 0 to 180
/// degrees.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd, Serialize, Deserialize)]
#[serde(into = "f64", try_from = "f64")]
pub struct Crease(f64);

impl Crease {
    /// All faces around a vertex are smooth with each other, even without a common edge.
    pub const SMOOTH: Self = Self(180.0);

    /// All edges are sharp.
    pub const FLAT: Self = Self(0.0);

    /// Returns `degrees` as a crease angle if they are from 0 to 180.
    pub fn new(degrees: f64) -> Option<Self> {
        (0.0..=180.0).contains(&degrees).then_some(Self(degrees))
    }

    /// Returns the angle in degrees.
    pub const fn get(self) -> f64 {
        self.0
    }
}

impl Default for Crease {
    fn default() -> Self {
        Self(60.0)
    }
}

impl From<Crease> for f64 {
    fn from(crease: Crease) -> Self {
        crease.0
    }
}

impl TryFrom<f64> for Crease {
    type Error = &'static str;

    fn try_from(degrees: f64) -> Result<Self, Self::Error> {
        Self::new(degrees).ok_or("a crease angle must be from 0 to 180 degrees")
    }
}

/// The rule for sharing computed normals between polygons.
#[derive(Clone, Debug, PartialEq)]
pub enum Smoothing {
    /// Polygons share normals if edges below this angle connect them.
    Crease(Crease),
    /// Polygons share normals if they share a smoothing group. Lists the group of each polygon, 0
    /// for none.
    Groups(Vec<u32>),
}

impl Default for Smoothing {
    fn default() -> Self {
        Self::Crease(Crease::SMOOTH)
    }
}

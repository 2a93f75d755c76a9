//! The normals of small meshes.

use glam::DVec3;

/// The normals that a small mesh is lit with, in view space, of length 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Turning(pub(crate) Vec<DVec3>);

impl Turning {
    /// Returns whether a predicate holds for all normals.
    pub(crate) fn all(&self, is: impl Fn(DVec3) -> bool) -> bool {
        self.0.iter().all(|normal| is(*normal))
    }
}

//! Which way the faces of a small mesh are turned.

use glam::DVec3;

/// The normals by which a small mesh is lit, in view space, of length 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Turning(pub(crate) Vec<DVec3>);

impl Turning {
    /// Whether a statement holds for all normals.
    pub(crate) fn all(&self, is: impl Fn(DVec3) -> bool) -> bool {
        self.0.iter().all(|normal| is(*normal))
    }
}

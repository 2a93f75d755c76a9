//! The shared properties of an object's surfaces.

use super::uses;
use crate::lights::region::Region;
use crate::lights::turning::Turning;
use marraztu_core::scene::{ItemId, Object};

/// The shared properties of an object's surfaces.
#[derive(Debug)]
pub(super) struct Ground<'a> {
    pub(super) item: ItemId,
    pub(super) object: &'a Object,
    /// The region of the lit points, if it is known.
    pub(super) region: Option<Region>,
    /// The normals of the surfaces, if they are known.
    pub(super) turning: Option<Turning>,
    /// Whether lights may be culled tile by tile, because no part of the object is clipped.
    pub(super) tiled: bool,
    /// Whether the colours of the surfaces are visible.
    pub(super) seen: bool,
}

impl Ground<'_> {
    pub(super) fn thing(&self) -> Option<uses::Thing> {
        Some(uses::Thing { item: self.item, name: self.object.name.clone() })
    }
}

/// The largest coefficient and exponent: far beyond any real light, and within f32.
pub(super) const LARGEST: f64 = 1e30;

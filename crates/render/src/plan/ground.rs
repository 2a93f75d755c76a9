//! What the surfaces of an object have in common.

use super::uses;
use crate::lights::region::Region;
use crate::lights::turning::Turning;
use marraztu_core::scene::{ItemId, Object};

/// What the surfaces of an object have in common.
#[derive(Debug)]
pub(super) struct Ground<'a> {
    pub(super) item: ItemId,
    pub(super) object: &'a Object,
    /// The region in which they are lit, if it is known.
    pub(super) region: Option<Region>,
    /// Their normals, if they are known.
    pub(super) turning: Option<Turning>,
    /// Whether lights may be culled tile by tile, since nothing of it is clipped.
    pub(super) tiled: bool,
    /// Whether their colours are visible at all.
    pub(super) seen: bool,
}

impl Ground<'_> {
    pub(super) fn thing(&self) -> Option<uses::Thing> {
        Some(uses::Thing { item: self.item, name: self.object.name.clone() })
    }
}

/// The largest coefficient and exponent: far beyond any other light, and it fits f32.
pub(super) const LARGEST: f64 = 1e30;

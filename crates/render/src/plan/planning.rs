//! The state of planning: the plan so far, and the inputs.

use std::collections::HashMap;

use glam::DVec3;

use super::observer::ObserverSpace;
use super::uses::{Notes, Thing};
use crate::frame::FramePlan;
use crate::frame::draw::Pipeline;
use crate::lights::{LightRow, Region};
use marraztu_core::accuracy::Shot;
use marraztu_core::scene::{ItemId, LightId, Object};

/// The plan so far, with the notes that explain it.
#[derive(Debug)]
pub(super) struct Planning {
    pub(super) plan: FramePlan,
    pub(super) notes: Notes,
    /// The indices of the plan's pipelines, by fingerprint.
    places: HashMap<u64, Vec<u32>>,
}

impl Planning {
    pub(super) fn new(plan: FramePlan, notes: Notes) -> Self {
        Self { plan, notes, places: HashMap::new() }
    }

    /// Returns the index of a pipeline in the frame, and adds it if it is new.
    pub(super) fn pipeline(&mut self, pipeline: Pipeline) -> u32 {
        let pipelines = &mut self.plan.pipelines;
        // Hashes may collide, so pipelines with the same hash are compared.
        let alike = self.places.entry(pipeline.fingerprint()).or_default();
        let same = alike.iter().find(|at| pipelines[**at as usize] == pipeline);
        same.copied().unwrap_or_else(|| {
            let at = u32::try_from(pipelines.len()).expect("fewer than 2^32 pipelines");
            pipelines.push(pipeline);
            alike.push(at);
            at
        })
    }
}

/// The inputs of planning.
pub(super) struct Planner<'a> {
    pub(super) shot: &'a Shot,
    pub(super) observer: ObserverSpace,
    pub(super) shining: Vec<Shining>,
    /// Whether this plans what rays can meet, and not what the observer sees.
    pub(super) is_around: bool,
}

/// A light that is evaluated in this frame.
#[derive(Clone, Debug)]
pub(super) struct Shining {
    pub(super) id: LightId,
    pub(super) name: String,
    pub(super) effect: &'static LightRow,
    /// The index of the light in the plan.
    pub(super) light: u32,
    /// Whether the light is on and has a position.
    pub(super) shines: bool,
}

/// The shared properties of an object's surfaces.
#[derive(Debug)]
pub(super) struct Ground<'a> {
    pub(super) item: ItemId,
    pub(super) object: &'a Object,
    /// The region of the lit points, if it is known.
    pub(super) region: Option<Region>,
    /// The normals of the surfaces, of length 1, if they are known.
    pub(super) turning: Option<Vec<DVec3>>,
    /// Whether lights may be culled tile by tile, because no part of the object is clipped.
    pub(super) tiled: bool,
    /// Whether the colours of the surfaces are visible.
    pub(super) seen: bool,
    /// The closed body of glass that each part belongs to, as the number of its first part. Empty
    /// without glass.
    pub(super) bodies: Vec<Option<u32>>,
}

impl Ground<'_> {
    pub(super) fn thing(&self) -> Option<Thing> {
        Some(Thing { item: self.item, name: self.object.name.clone() })
    }
}

/// The largest coefficient and exponent: far beyond any real light, and within f32.
pub(super) const LARGEST: f64 = 1e30;

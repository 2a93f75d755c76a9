//! A plan while it is made, and what planning reads.

use std::collections::HashMap;

use super::observer::ObserverSpace;
use super::uses::Notes;
use crate::accuracy::Shot;
use crate::render::frame::FramePlan;
use crate::render::frame::draw::Pipeline;
use crate::render::lights::LightRow;
use crate::scene::LightId;

/// A plan while it is made.
#[derive(Debug)]
pub(super) struct Planning {
    pub(super) plan: FramePlan,
    pub(super) notes: Notes,
    /// The places of the plan's pipelines by their fingerprints.
    places: HashMap<u64, Vec<u32>>,
}

impl Planning {
    pub(super) fn new(plan: FramePlan, notes: Notes) -> Self {
        Self { plan, notes, places: HashMap::new() }
    }

    /// The place of a pipeline among those of the frame.
    pub(super) fn pipeline(&mut self, pipeline: Pipeline) -> u32 {
        let pipelines = &mut self.plan.pipelines;
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

/// What planning reads.
pub(super) struct Planner<'a> {
    pub(super) shot: &'a Shot,
    pub(super) observer: ObserverSpace,
    pub(super) shining: Vec<Shining>,
}

/// A light that is evaluated in this frame.
#[derive(Clone, Debug)]
pub(super) struct Shining {
    pub(super) id: LightId,
    pub(super) name: String,
    pub(super) effect: &'static LightRow,
    /// The place of its light among the lamps of the plan.
    pub(super) lamp: u32,
    /// Whether it is on, and somewhere.
    pub(super) shines: bool,
}

//! Light that passes through casters: glass casts shadows in the colour of its filter.
//!
//! Rays that nothing blocks run to the light once more, and each surface between that lets light
//! pass multiplies it by its filter: front and back of a closed body do so twice. Light is not bent,
//! and what a surface mirrors is not taken from it.

use std::cell::Cell;

use fearless_simd::Level;
use glam::DVec3;

use super::Tracer;
use crate::rays::Hit;
use crate::shadow::ball_light::LightSample;
use crate::shadow::rays::RayScratch;
use crate::shadow::shaft::POINTS;
use crate::simd::{Bits, dispatch};

/// The fraction of light that reaches each point.
pub(crate) type Shares = [[f64; 3]; POINTS];

impl Tracer<'_> {
    /// Returns whether light passes through any caster.
    pub(crate) const fn has_filters(&self) -> bool {
        self.filters
    }

    /// Returns the fraction of light that passes on the way to each sample of a light that nothing
    /// blocks: the product of the filters of all surfaces between. `None` if nothing filters light.
    pub(crate) fn filtered(
        &self,
        level: Level,
        scratch: &mut RayScratch,
        samples: &[Option<LightSample>; POINTS],
        mask: u64,
    ) -> Option<Shares> {
        if !self.filters || mask == 0 {
            return None;
        }
        let RayScratch { origins, single, .. } = scratch;
        let passing = Cell::new([1.0; 3]);
        // Every surface is asked about, and none stops the ray.
        let notes = |hit: &Hit| {
            let placed = &self.casters[hit.thing as usize];
            if let Some(part) = placed.caster.part_of(hit.triangle)
                && let Some(filter) = part.filter
                && self.is_there(placed, (hit.triangle, part), hit.weights)
            {
                let before = passing.get();
                passing.set(std::array::from_fn(|i| before[i] * filter[i]));
            }
            false
        };
        let mut shares = [[1.0; 3]; POINTS];
        dispatch!(level, simd => for i in Bits(mask) {
            let Some(LightSample { towards, distance, .. }) = samples[i] else { continue };
            passing.set([1.0; 3]);
            self.things.stop(simd, (&origins.ray(i, towards), distance), &notes, single);
            shares[i] = passing.get();
        });
        Some(shares)
    }

    /// Returns the same as [`Self::filtered`] for a light at a point.
    pub(crate) fn filtered_from(
        &self,
        level: Level,
        scratch: &mut RayScratch,
        light: DVec3,
        mask: u64,
    ) -> Option<Shares> {
        if !self.filters || mask == 0 {
            return None;
        }
        let mut samples = [None; POINTS];
        for i in Bits(mask) {
            let way = light - scratch.origins.point(i);
            let distance = way.length();
            let towards = way / distance;
            samples[i] = Some(LightSample { towards, distance, shift: DVec3::ZERO });
        }
        self.filtered(level, scratch, &samples, mask)
    }
}

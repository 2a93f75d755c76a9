//! Light that passes through casters: glass casts shadows in the colour of its filter.
//!
//! Rays that nothing blocks run to the light once more, through the casters of glass alone. Each
//! surface between that lets light pass multiplies it by its filter: front and back of a closed
//! body do so twice. Light is not bent, and what a surface mirrors is not taken from it.

use std::cell::RefCell;

use fearless_simd::Level;
use glam::DVec3;

use super::Tracer;
use crate::rays::{Hit, OwnTriangles, Ray, Thing, Things};
use crate::shadow::ball_light::LightSample;
use crate::shadow::rays::RayScratch;
use crate::shadow::shaft::POINTS;
use crate::simd::{Bits, dispatch};

/// The fraction of light that reaches each point.
pub(crate) type Shares = [[f64; 3]; POINTS];

/// The casters that let light pass.
#[derive(Debug)]
pub(super) struct Glass<'a> {
    things: Things<'a>,
    /// The caster of each thing, in increasing order.
    casters: Vec<u32>,
}

/// What a ray passes through.
#[derive(Debug)]
struct Passed {
    /// The thing, its side and the distance of each surface.
    surfaces: Vec<(u32, bool, f64)>,
    share: [f64; 3],
}

/// Two surfaces of one side of a body at the same distance, within this part of it, are one: they
/// share the edge that a ray meets.
const SAME: f64 = 1e-9;

impl<'a> Tracer<'a> {
    /// Prepares the casters that let light pass.
    pub(super) fn with_glass(mut self) -> Self {
        let numbered = (0_u32..).zip(&self.casters).filter(|(_, placed)| placed.caster.filters());
        let things = numbered.filter_map(|(index, placed)| {
            let caster = placed.caster;
            Some((Thing::new(&caster.model.mesh, caster.world_from_object)?, index))
        });
        let (things, casters): (Vec<_>, Vec<_>) = things.unzip();
        self.glass = (!things.is_empty()).then(|| Glass { things: Things::new(things), casters });
        self
    }

    /// Returns whether light passes through any caster.
    pub(crate) const fn has_glass(&self) -> bool {
        self.glass.is_some()
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
        let Glass { things, casters } = self.glass.as_ref().filter(|_| mask != 0)?;
        let RayScratch { origins, single, .. } = scratch;
        let passed = RefCell::new(Passed { surfaces: Vec::new(), share: [1.0; 3] });
        // Every surface is asked about, and none stops the ray.
        let notes = |hit: &Hit| {
            let placed = &self.casters[casters[hit.thing as usize] as usize];
            if let Some(part) = placed.caster.part_of(hit.triangle)
                && let Some(filter) = part.filter
                && self.is_there(placed, (hit.triangle, part), hit.weights)
            {
                passed.borrow_mut().add(hit, filter);
            }
            false
        };
        let mut shares = [[1.0; 3]; POINTS];
        dispatch!(level, simd => for i in Bits(mask) {
            let Some(LightSample { towards, distance, .. }) = samples[i] else { continue };
            let Ray { from, towards, own } = origins.ray(i, towards);
            // Things of glass have numbers of their own.
            let own = own.and_then(|own| {
                let thing = u32::try_from(casters.binary_search(&own.thing).ok()?).ok()?;
                Some(OwnTriangles { thing, ..own })
            });
            things.stop(simd, (&Ray { from, towards, own }, distance), &notes, single);
            shares[i] = passed.borrow_mut().take();
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

impl Passed {
    /// Adds a surface, unless it is the neighbour of one that counts already.
    fn add(&mut self, hit: &Hit, filter: [f64; 3]) {
        let is_same = |(thing, is_front, distance): &(u32, bool, f64)| {
            (*thing, *is_front) == (hit.thing, hit.is_front)
                && (distance - hit.distance).abs() <= SAME * distance.abs()
        };
        if !self.surfaces.iter().any(is_same) {
            self.surfaces.push((hit.thing, hit.is_front, hit.distance));
            self.share = std::array::from_fn(|i| self.share[i] * filter[i]);
        }
    }

    /// Returns the light that passes, and begins another ray.
    fn take(&mut self) -> [f64; 3] {
        self.surfaces.clear();
        std::mem::replace(&mut self.share, [1.0; 3])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn surfaces_that_share_an_edge_count_once_and_both_sides_of_a_body_twice() {
        let hit = |thing, triangle, is_front, distance| Hit {
            thing,
            triangle,
            weights: DVec3::new(0.5, 0.5, 0.0),
            distance,
            is_front,
        };
        let mut passed = Passed { surfaces: Vec::new(), share: [1.0; 3] };
        let hits = [
            hit(0, 3, true, 2.0),
            hit(0, 4, true, 2.0 + 1e-12),
            hit(0, 9, false, 2.0),
            hit(1, 3, true, 2.0),
            hit(0, 3, true, 2.1),
        ];
        hits.iter().for_each(|hit| passed.add(hit, [0.5, 1.0, 0.0]));
        assert_eq!(passed.take(), [0.0625, 1.0, 0.0]);
        assert_eq!(passed.take(), [1.0; 3], "the next ray begins anew");
    }
}

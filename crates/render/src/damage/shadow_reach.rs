//! The tiles in which shadows change if something that casts them does.
//!
//! With light at pixels, a point's shadow depends on a caster only if it lies in the caster's
//! shadow volume: what the light sees behind its box, as far as anything is drawn. The volume is
//! convex, so its corners bound its pixels. Lights that change need nothing of their own, since
//! every surface that they are on is drawn again anyway.
//!
//! Crow, "Shadow Algorithms for Computer Graphics", SIGGRAPH 1977.

use std::collections::BTreeMap;

use glam::{DMat4, DVec3, DVec4};

use super::{Tiles, around};
use crate::frame::FramePlan;
use crate::frame::shadows::{Caster, ShadowSource};
use crate::shadow::tracer::Tracer;
use marraztu_core::accuracy::{LightAt, Samples, Terminator};
use marraztu_core::scene::ItemId;

/// Whether rays begin at the pixels themselves: only what a pixel shows decides where its rays
/// begin.
pub(super) fn is_by_pixel(plan: &FramePlan) -> bool {
    plan.light_at == LightAt::Pixel
        && plan.samples == Samples::One
        && !plan.lit_by_sample
        && plan.shift == [0; 2]
        && plan.variants.shadow_method.map().is_none()
        && plan.variants.terminator == Terminator::Triangles
}

/// Whether the tiles of changed shadows can be told: rays begin at the pixels themselves, and
/// nothing else depends on all casters together.
pub(super) fn is_known(before: &FramePlan, after: &FramePlan) -> bool {
    is_by_pixel(after)
        && before.shadows.are_cast() == after.shadows.are_cast()
        && Tracer::sun_distance(&before.shadows).to_bits()
            == Tracer::sun_distance(&after.shadows).to_bits()
}

/// Adds the tiles of the shadows of all casters that differ. Returns whether they are known.
pub(super) fn add(before: &FramePlan, after: &FramePlan, tiles: &mut Tiles) -> bool {
    let changed = Changed::between(before, after);
    changed.all().all(|(seen, caster)| {
        seen.plan.shadows.sources.iter().flatten().all(|source| seen.add(caster, source, tiles))
    })
}

/// The casters that differ between two plans.
pub(super) struct Changed<'a> {
    before: Drawn<'a>,
    after: Drawn<'a>,
    /// As they were, and as they are.
    old: Vec<&'a Caster>,
    new: Vec<&'a Caster>,
}

impl<'a> Changed<'a> {
    pub(super) fn between(before: &'a FramePlan, after: &'a FramePlan) -> Self {
        let mut left: BTreeMap<ItemId, &Caster> =
            before.shadows.casters.iter().map(|caster| (caster.item, caster)).collect();
        let (mut old, mut new) = (Vec::new(), Vec::new());
        for caster in &after.shadows.casters {
            let earlier = left.remove(&caster.item);
            if earlier.is_none_or(|earlier| !earlier.is_same(caster)) {
                old.extend(earlier);
                new.push(caster);
            }
        }
        old.extend(left.into_values());
        let is_any = !(old.is_empty() && new.is_empty());
        let [before, after] = [before, after].map(|plan| Drawn::new(plan, is_any));
        Self { before, after, old, new }
    }

    /// Each with the plan that it belongs to.
    fn all(&self) -> impl Iterator<Item = (&Drawn<'a>, &'a Caster)> {
        let old = self.old.iter().map(|caster| (&self.before, *caster));
        old.chain(self.new.iter().map(|caster| (&self.after, *caster)))
    }

    /// The tiles of their shadows by a light that both plans have; `None` if they are not known.
    pub(super) fn tiles(&self, source: &ShadowSource) -> Option<Tiles> {
        let mut tiles = Tiles::none(self.after.plan.size);
        let mut all = self.all();
        all.all(|(seen, caster)| seen.add(caster, source, &mut tiles)).then_some(tiles)
    }
}

/// A plan, and what is drawn of it.
struct Drawn<'a> {
    plan: &'a FramePlan,
    /// The corners of the boxes of all that is drawn, in world space.
    drawn: Vec<DVec3>,
    clip_from_world: DMat4,
}

impl<'a> Drawn<'a> {
    /// `is_asked`: whether anything will be added.
    fn new(plan: &'a FramePlan, is_asked: bool) -> Self {
        let world_from_view = plan.view_from_world.inverse();
        let draws = if is_asked { &plan.draws[..] } else { &[] };
        let drawn = draws.iter().filter_map(|draw| {
            let world_from_object = world_from_view * draw.view_from_object;
            let corners = draw.model.mesh.bounds()?.corners();
            Some(corners.map(|corner| world_from_object.transform_point3(corner)))
        });
        let clip_from_world = plan.clip_from_view * plan.view_from_world;
        Self { plan, drawn: drawn.flatten().collect(), clip_from_world }
    }

    /// Adds the tiles of a caster's shadow volume. Returns whether it is bounded.
    fn add(&self, caster: &Caster, source: &ShadowSource, tiles: &mut Tiles) -> bool {
        let Some(bounds) = caster.model.mesh.bounds() else { return true };
        let corners =
            bounds.corners().map(|corner| caster.world_from_object.transform_point3(corner));
        let Some(ends) = ends_of(source, &corners, &self.drawn) else { return false };
        let points = corners.into_iter().chain(ends);
        let clip: Vec<DVec4> = points.map(|p| self.clip_from_world * p.extend(1.0)).collect();
        let seen = before_the_near_plane(&clip);
        if seen.is_empty() {
            return true;
        }
        // Points are lit up to a pixel away from where they are seen.
        let Some(pixels) = around(self.plan, &seen, 2.0) else { return false };
        tiles.add(pixels);
        true
    }
}

/// Points in clip space whose convex hull is that of the given ones, as far as it is before the
/// near plane: those that are, and where the way from one to one that is not meets the plane.
fn before_the_near_plane(points: &[DVec4]) -> Vec<DVec4> {
    // A little before it, so that rounding leaves no point behind it.
    let distance = |p: &DVec4| p.w * (1.0 - 1e-6) - p.z;
    let mut seen = Vec::new();
    for p in points {
        let own = distance(p);
        if own < 0.0 {
            continue;
        }
        seen.push(*p);
        for other in points {
            let beyond = distance(other);
            if beyond < 0.0 {
                seen.push(*p + (*other - *p) * (own / (own - beyond)));
            }
        }
    }
    seen
}

/// The far corners of a box's shadow volume, behind everything that is drawn; `None` if the light
/// is in the box.
fn ends_of(source: &ShadowSource, corners: &[DVec3; 8], drawn: &[DVec3]) -> Option<[DVec3; 8]> {
    // A little more, for all rounding.
    const MORE: f64 = 1.0 + 1e-6;
    match source {
        ShadowSource::Direction(towards) => {
            let depth = |p: &DVec3| -p.dot(*towards);
            let nearest = corners.iter().map(depth).fold(f64::INFINITY, f64::min);
            let farthest = drawn.iter().map(depth).fold(f64::NEG_INFINITY, f64::max);
            let far = (farthest - nearest).max(0.0) * MORE;
            far.is_finite().then(|| corners.map(|corner| corner - *towards * far))
        }
        ShadowSource::Point(at) | ShadowSource::Cone { at, .. } => {
            let low = corners.iter().copied().fold(DVec3::INFINITY, DVec3::min);
            let high = corners.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
            let nearest = at.distance(at.clamp(low, high));
            let farthest = drawn.iter().map(|p| p.distance(*at)).fold(0.0, f64::max);
            // Nothing is drawn behind this many times the box, seen from the light.
            let times = (farthest / nearest).max(1.0) * MORE;
            (times < 1e9).then(|| corners.map(|corner| *at + (corner - *at) * times))
        }
    }
}

//! Finds the tiles with changed shadows after a caster changed.
//!
//! If light is computed per pixel, a point's shadow depends on a caster only if the point lies in
//! the caster's shadow volume: the volume behind the caster's box as seen from the light, up to the
//! farthest drawn point. The volume is convex, so its corners bound its pixels. Changed lights need
//! no treatment here, because every surface they light is drawn again anyway.
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

/// Returns whether rays start at the pixels themselves. Only the surface shown by a pixel then
/// decides where its rays start.
pub(super) fn is_by_pixel(plan: &FramePlan) -> bool {
    plan.light_at == LightAt::Pixel
        && plan.samples == Samples::One
        && !plan.lit_by_sample
        && plan.shift == [0; 2]
        && plan.variants.shadow_method.map().is_none()
        && plan.variants.terminator == Terminator::Triangles
        && !plan.shadows.are_soft()
}

/// Returns whether the tiles of changed shadows can be determined: rays start at the pixels
/// themselves, and no other quantity depends on all casters together.
pub(super) fn is_known(before: &FramePlan, after: &FramePlan) -> bool {
    is_by_pixel(after)
        && !before.shadows.are_soft()
        && before.shadows.are_cast() == after.shadows.are_cast()
        && Tracer::sun_distance(&before.shadows).to_bits()
            == Tracer::sun_distance(&after.shadows).to_bits()
}

/// Adds the tiles of all changed casters' shadows. Returns whether these tiles are bounded.
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
    /// The changed casters before and after.
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
        // The remaining casters have disappeared.
        old.extend(left.into_values());
        // Without a changed caster, the extents are never read and stay empty.
        let is_any = !(old.is_empty() && new.is_empty());
        let [before, after] = [before, after].map(|plan| Drawn::new(plan, is_any));
        Self { before, after, old, new }
    }

    /// Iterates over the changed casters, each with the plan it belongs to.
    fn all(&self) -> impl Iterator<Item = (&Drawn<'a>, &'a Caster)> {
        let old = self.old.iter().map(|caster| (&self.before, *caster));
        old.chain(self.new.iter().map(|caster| (&self.after, *caster)))
    }

    /// Returns the tiles of the changed shadows of a light in both plans. `None` if they are not
    /// bounded.
    pub(super) fn tiles(&self, source: &ShadowSource) -> Option<Tiles> {
        let mut tiles = Tiles::none(self.after.plan.size);
        let mut all = self.all();
        all.all(|(seen, caster)| seen.add(caster, source, &mut tiles)).then_some(tiles)
    }
}

/// A plan and the extent of its drawn objects.
struct Drawn<'a> {
    plan: &'a FramePlan,
    /// The corners of the bounding boxes of all drawn objects, in world space.
    drawn: Vec<DVec3>,
    clip_from_world: DMat4,
}

impl<'a> Drawn<'a> {
    /// Creates the extent of a plan; if `is_asked` is false, no caster will be added and it stays
    /// empty.
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

    /// Adds the tiles of a caster's shadow volume. Returns whether the volume is bounded.
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
        // The margin of two pixels: points are lit up to a pixel away from where they are seen.
        let Some(pixels) = around(self.plan, &seen, 2.0) else { return false };
        tiles.add(pixels);
        true
    }
}

/// Clips the convex hull of points in clip space to the near plane: returns the points in front of
/// it, and the points where a segment from one of them to a point behind crosses the plane.
fn before_the_near_plane(points: &[DVec4]) -> Vec<DVec4> {
    // Slightly in front of the plane, because rounding must not leave a point behind it.
    let distance = |p: &DVec4| p.w * (1.0 - 1e-6) - p.z;
    let mut seen = Vec::new();
    for p in points {
        let own = distance(p);
        if own < 0.0 {
            continue;
        }
        seen.push(*p);
        // Many of these segments lie inside the hull, but inner points do not change its bounds.
        for other in points {
            let beyond = distance(other);
            if beyond < 0.0 {
                seen.push(*p + (*other - *p) * (own / (own - beyond)));
            }
        }
    }
    seen
}

/// Computes the far corners of a box's shadow volume, behind everything that is drawn. `None` if
/// the light is inside the box.
fn ends_of(source: &ShadowSource, corners: &[DVec3; 8], drawn: &[DVec3]) -> Option<[DVec3; 8]> {
    // A margin for all rounding.
    const MORE: f64 = 1.0 + 1e-6;
    match source {
        ShadowSource::Everywhere => None,
        ShadowSource::Direction(towards) => {
            // Distances along the rays of light: larger is farther from the light.
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
            // Scaled from the light by this factor, the box is behind every drawn object.
            let times = (farthest / nearest).max(1.0) * MORE;
            // A light in the box, or almost touching it, gives no useful bounds.
            (times < 1e9).then(|| corners.map(|corner| *at + (corner - *at) * times))
        }
    }
}

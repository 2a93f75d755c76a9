//! The tiles in which shadows change if something that casts them does.
//!
//! With light at pixels, a point's shadow depends on a caster only if it lies in the caster's
//! shadow volume: what the light sees behind its box, as far as anything is drawn. The volume is
//! convex, so its corners bound its pixels. Lights that change need nothing of their own, since
//! every surface that they are on is drawn again anyway.
//!
//! Crow, "Shadow Algorithms for Computer Graphics", SIGGRAPH 1977.

use std::collections::BTreeMap;

use glam::{DVec3, DVec4};

use super::{Tiles, around};
use crate::accuracy::{LightAt, Samples, Terminator};
use crate::render::frame::FramePlan;
use crate::render::frame::shadows::{Caster, ShadowSource};
use crate::render::shadow::tracer::Tracer;
use crate::scene::ItemId;

/// Whether the tiles of changed shadows can be told: rays begin at the pixels themselves, and
/// nothing else depends on all casters together.
pub(super) fn is_known(before: &FramePlan, after: &FramePlan) -> bool {
    after.light_at == LightAt::Pixel
        && after.samples == Samples::One
        && after.variants.shadow_method.map().is_none()
        && after.variants.terminator == Terminator::Triangles
        && before.shadows.are_cast() == after.shadows.are_cast()
        && Tracer::sun_distance(&before.shadows).to_bits()
            == Tracer::sun_distance(&after.shadows).to_bits()
}

/// Adds the tiles of the shadows of all casters that differ. Returns whether they are known.
pub(super) fn add(before: &FramePlan, after: &FramePlan, tiles: &mut Tiles) -> bool {
    if after.shadows.is_same(&before.shadows) {
        return true;
    }
    let mut old: BTreeMap<ItemId, &Caster> =
        before.shadows.casters.iter().map(|caster| (caster.item, caster)).collect();
    for caster in &after.shadows.casters {
        let earlier = old.remove(&caster.item);
        if earlier.is_some_and(|earlier| earlier.is_same(caster)) {
            continue;
        }
        let is_known = earlier.is_none_or(|earlier| add_volumes(before, earlier, tiles));
        if !is_known || !add_volumes(after, caster, tiles) {
            return false;
        }
    }
    old.into_values().all(|caster| add_volumes(before, caster, tiles))
}

/// Adds the tiles of a caster's shadow volumes. Returns whether they are bounded.
fn add_volumes(plan: &FramePlan, caster: &Caster, tiles: &mut Tiles) -> bool {
    let Some(bounds) = caster.model.mesh.bounds() else { return true };
    let corners = bounds.corners().map(|corner| caster.world_from_object.transform_point3(corner));
    let world_from_view = plan.view_from_world.inverse();
    let drawn: Vec<DVec3> = plan
        .draws
        .iter()
        .filter_map(|draw| {
            let world_from_object = world_from_view * draw.view_from_object;
            let corners = draw.model.mesh.bounds()?.corners();
            Some(corners.map(|corner| world_from_object.transform_point3(corner)))
        })
        .flatten()
        .collect();
    let clip_from_world = plan.clip_from_view * plan.view_from_world;
    for source in plan.shadows.sources.iter().flatten() {
        let Some(ends) = ends_of(source, &corners, &drawn) else { return false };
        let points = corners.into_iter().chain(ends);
        let clip: Vec<DVec4> = points.map(|p| clip_from_world * p.extend(1.0)).collect();
        let seen = before_the_near_plane(&clip);
        if seen.is_empty() {
            continue;
        }
        // Points are lit up to a pixel away from where they are seen.
        let Some(pixels) = around(plan, &seen, 2.0) else { return false };
        tiles.add(pixels);
    }
    true
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

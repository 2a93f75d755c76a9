//! Traces packets of shadow rays through all casters of a frame.

pub(crate) mod filters;

use std::collections::BTreeMap;

use crate::accel::Accelerated as _;
use fearless_simd::{Level, Simd};
use glam::{DMat3, DMat4, DVec3};

use self::filters::Glass;
use super::ball_light::{BallLight, LightSample};
use super::boxes::world_pad;
use super::extents::{Sky, SkyAbove, SoftLight};
use super::known::{KnownLight, KnownShadows};
use super::map_face::LightMap;
use super::maps::ShadowMaps;
use super::patches::Patch;
use super::prepared_block::PreparedBlock;
use super::rays::{Origins, RayCount, RayScratch};
use super::shaft::{Around, POINTS, Shaft};
use super::triangle::{Prepared, is_between, reaches_behind};
use crate::accel::{BVH_BLOCK, Bvh, BvhBlock, BvhChild, BvhNode};
use crate::frame::FramePlan;
use crate::frame::shadows::{Caster, CasterPart, Holes, ShadowSource, Shadows};
use crate::rays::{Corners, Ends, FLAT, Hit, Thing, Things};
use crate::simd::{Bits, dispatch};
use crate::texture::sample::{opacity_of, sample};
use crate::texture::uv::uv;
use marraztu_core::accuracy::{Filter, ShadowMethod};
use marraztu_core::base::math::{each, unit};
use marraztu_core::scene::{Bounds, dvec3};

/// The distance of a sun, relative to the largest coordinate of the scene.
const SUN: f64 = (1_u64 << 60) as f64;

/// Up to this number of casters, rays are transformed for each caster near them.
const FEW: usize = 8;

/// The casters of a frame, ready for ray tracing.
#[derive(Debug)]
pub(crate) struct Tracer<'a> {
    casters: Vec<InPlace<'a>>,
    /// The caster of each draw.
    of_draws: Vec<Option<u32>>,
    /// The largest coordinate of their boxes.
    reach: f64,
    /// The end point of the rays to each light, if it casts shadows.
    lights: Vec<Option<DVec3>>,
    /// The shadow map of each light, if the settings ask for maps.
    maps: Vec<Option<&'a LightMap>>,
    /// The cached shadows, if shadows are cached.
    known: Option<&'a KnownShadows>,
    filter: Filter,
    /// The casters for single rays, if any light has an extent.
    things: Things<'a>,
    /// Each light, if it has an extent.
    soft: Vec<Option<SoftLight>>,
    /// Each light, if it is a sky.
    skies: Vec<Option<Sky<'a>>>,
    /// The casters that let light pass, if there are any.
    glass: Option<Glass<'a>>,
    view_from_world: DMat3,
}

/// A caster with its transforms and bounds.
#[derive(Debug)]
struct InPlace<'a> {
    caster: &'a Caster,
    /// `None` with shadow maps.
    tree: Option<&'a Bvh>,
    object_from_world: DMat4,
    /// The bounds in object space.
    own: Bounds,
    /// The bounding box in world space.
    low: DVec3,
    high: DVec3,
    /// `low` and `high`, rounded outwards.
    rounded: [[f32; 3]; 2],
    /// The distance in world space within which its triangles lie in one plane.
    flat: f64,
    is_solid: bool,
}

/// Transforms the corners of a triangle to world space. Every part of the renderer that needs exact
/// corners uses this function.
#[inline(always)]
fn placed(world_from_object: &DMat4, corners: [[f32; 3]; 3]) -> Corners {
    each(corners, |corner| world_from_object.transform_point3(dvec3(corner)))
}

impl<'a> Tracer<'a> {
    /// Prepares the casters of a plan. `None` if no light casts shadows.
    pub(crate) fn new(plan: &'a FramePlan, maps: &'a ShadowMaps) -> Option<Self> {
        if !plan.shadows.are_cast() {
            return None;
        }
        let mut tracer = Self::of(&plan.shadows, plan.filter, plan.variants.shadow_method);
        let map = |source: &Option<ShadowSource>| source.as_ref().and_then(|own| maps.of(own));
        tracer.maps = plan.shadows.sources.iter().map(map).collect();
        let numbered = (0_u32..).zip(&tracer.casters);
        let of_items: BTreeMap<_, _> =
            numbered.map(|(index, placed)| (placed.caster.item, index)).collect();
        let of_draws = plan.draws.iter().map(|draw| of_items.get(&draw.item).copied()).collect();
        let tracer = Self { of_draws, ..tracer };
        let tracer = if plan.shadows.are_soft() { tracer.with_extents(plan) } else { tracer };
        // Maps know no colours: light passes through glass undimmed.
        let knows_colors = plan.variants.shadow_method.map().is_none();
        Some(if knows_colors { tracer.with_glass() } else { tracer })
    }

    /// Returns the distance of the suns of a frame.
    pub(crate) fn sun_distance(shadows: &Shadows) -> f64 {
        // Naming a map method avoids building BVHs: only bounds are needed here.
        let in_place = |caster| InPlace::new(caster, ShadowMethod::Map512);
        sun_distance(&shadows.casters.iter().filter_map(in_place).collect::<Vec<_>>())
    }

    /// Prepares casters.
    fn of(shadows: &'a Shadows, filter: Filter, method: ShadowMethod) -> Self {
        let in_place = |caster| InPlace::new(caster, method);
        let casters: Vec<InPlace<'a>> = shadows.casters.iter().filter_map(in_place).collect();
        let far = sun_distance(&casters);
        let reach = casters.iter().map(InPlace::reach).fold(0.0, f64::max);
        let end = |source: &ShadowSource| match source {
            ShadowSource::Everywhere => None,
            ShadowSource::Direction(towards) => Some(*towards * far),
            // A light farther away than a sun is treated as one.
            ShadowSource::Point(at) | ShadowSource::Cone { at, .. } => {
                Some(*at * (far / at.abs().max_element()).min(1.0))
            }
        };
        let lights = shadows.sources.iter().map(|source| source.as_ref().and_then(end)).collect();
        Self {
            casters,
            reach,
            of_draws: Vec::new(),
            lights,
            maps: Vec::new(),
            known: None,
            filter,
            things: Things::default(),
            soft: Vec::new(),
            skies: Vec::new(),
            glass: None,
            view_from_world: DMat3::IDENTITY,
        }
    }

    /// Prepares the lights with an extent.
    fn with_extents(mut self, plan: &'a FramePlan) -> Self {
        let things = self.casters.iter().map(|placed| {
            let caster = placed.caster;
            let mut thing = Thing::new(&caster.model.mesh, caster.world_from_object)?;
            thing.is_solid = placed.is_solid;
            Some(thing)
        });
        // Without a tree for each caster, lights are points.
        let Some(things) = things.collect::<Option<Vec<_>>>() else { return self };
        self.things = Things::new(things);
        self.view_from_world = DMat3::from_mat4(plan.view_from_world);
        let samples = plan.shadows.samples;
        let sky = |(light, source): (u32, &Option<ShadowSource>)| {
            let own = &plan.lights[light as usize];
            let is_sky =
                *source == Some(ShadowSource::Everywhere) && plan.shadows.radius(light) > 0.0;
            let panorama = plan.panorama_of(light);
            is_sky.then_some(Sky { colors: [own.color, own.ground], panorama, light, samples })
        };
        self.skies = (0_u32..).zip(&plan.shadows.sources).map(sky).collect();
        let numbered = (0_u32..).zip(&self.lights);
        self.soft = numbered
            .map(|(light, centre)| {
                let radius = plan.shadows.radius(light);
                let centre = centre.filter(|_| radius > 0.0)?;
                Some(SoftLight { ball: BallLight { centre, radius }, light, samples })
            })
            .collect();
        self
    }

    /// Returns a light, if it has an extent.
    #[inline(always)]
    pub(crate) fn soft(&self, light: u32) -> Option<SoftLight> {
        self.soft.get(light as usize).copied().flatten()
    }

    /// Returns a light, if it is a sky that surfaces hide.
    #[inline(always)]
    pub(crate) fn sky(&self, light: u32) -> Option<Sky<'a>> {
        self.skies.get(light as usize).copied().flatten()
    }

    /// Returns the sky above a point with a normal in view space and a place in the sequence of
    /// samples; `None` without a normal.
    pub(crate) fn sky_above(&self, sky: &Sky<'_>, place: u32, normal: DVec3) -> Option<SkyAbove> {
        // The view transform turns and scales evenly.
        let normal = unit(self.view_from_world.transpose() * normal)?;
        Some(sky.above(place, normal))
    }

    /// Transforms a vector to view space.
    pub(crate) fn to_view(&self, vector: DVec3) -> DVec3 {
        self.view_from_world * vector
    }

    /// Finds what may lie between the first `count` points and a light. Returns whether anything
    /// does: otherwise, no ray to the light is blocked.
    pub(crate) fn look_between(
        &self,
        level: Level,
        light: &SoftLight,
        scratch: &mut RayScratch,
        count: usize,
    ) -> bool {
        let RayScratch { origins, frontier, .. } = scratch;
        let BallLight { centre, radius } = light.ball;
        let starts = origins.at.each_ref().map(|row| &row[..count.min(POINTS)]);
        let ends = Ends { starts, centre, radius };
        dispatch!(level, simd => frontier.find(simd, &self.things, &ends));
        !frontier.is_empty()
    }

    /// Traces rays of a mask to their samples of a light. Returns a bit mask of the blocked ones.
    /// `are_between` says that the last call of [`Self::look_between`] holds for them.
    pub(crate) fn blocked(
        &self,
        level: Level,
        scratch: &mut RayScratch,
        (samples, are_between): (&[Option<LightSample>; POINTS], bool),
        mask: u64,
    ) -> u64 {
        let RayScratch { origins, single, frontier, .. } = scratch;
        let stops = |hit: &Hit| {
            let placed = &self.casters[hit.thing as usize];
            self.is_solid_at(placed, hit.triangle, hit.weights)
        };
        let mut blocked = 0;
        dispatch!(level, simd => for i in Bits(mask) {
            let Some(LightSample { towards, distance, .. }) = samples[i] else { continue };
            let ray = origins.ray(i, towards);
            let is_blocked = if are_between {
                self.things.stop_within(simd, (&ray, distance, frontier), &stops, single)
            } else {
                self.things.stop(simd, (&ray, distance), &stops, single)
            };
            blocked |= u64::from(is_blocked) << i;
        });
        let [traced, occluded] = [mask, blocked].map(|rays| u64::from(rays.count_ones()));
        scratch.count += RayCount { traced, occluded, bounced: 0 };
        blocked
    }

    /// Returns the end point of the rays to a light, if it casts shadows.
    #[inline(always)]
    pub(crate) fn light(&self, light: u32) -> Option<DVec3> {
        self.lights[light as usize]
    }

    /// Returns the caster of a draw.
    pub(crate) fn caster_of(&self, draw: u32) -> Option<u32> {
        self.of_draws[draw as usize]
    }

    /// Returns `world_from_object` of a caster.
    pub(crate) fn placement(&self, caster: u32) -> DMat4 {
        self.casters[caster as usize].caster.world_from_object
    }

    /// Attaches a cache of shadows, which is read and added to.
    pub(crate) fn with_known(self, known: Option<&'a KnownShadows>) -> Self {
        Self { known, ..self }
    }

    /// Returns the map of a light, if the settings ask for maps.
    pub(crate) fn map(&self, light: u32) -> Option<&'a LightMap> {
        self.maps.get(light as usize).copied().flatten()
    }

    /// Returns the cached shadows of a light, if they are cached.
    #[inline(always)]
    pub(crate) fn known(&self, light: u32) -> Option<&'a KnownLight> {
        self.known?.of(light)
    }

    /// Traces the rays of a mask to the light. Returns a bit mask of the blocked ones.
    pub(crate) fn shaded(
        &self,
        level: Level,
        light: DVec3,
        scratch: &mut RayScratch,
        mask: u64,
    ) -> u64 {
        if mask == 0 {
            return 0;
        }
        let shaded = dispatch!(level, simd => self.trace(simd, light, scratch, mask));
        let [traced, occluded] = [mask, shaded].map(|rays| u64::from(rays.count_ones()));
        scratch.count += RayCount { traced, occluded, bounced: 0 };
        shaded
    }

    #[inline(always)]
    fn trace<S: Simd>(&self, simd: S, light: DVec3, scratch: &mut RayScratch, mask: u64) -> u64 {
        if scratch.origins.patches.is_empty() {
            scratch.origins.find_patches(|origins, i| self.normal_at(origins, i));
        }
        // Most of many casters are far from the rays, and are skipped before rays are transformed.
        scratch.around_patches.clear();
        if self.casters.len() > FEW {
            for patch in &scratch.origins.patches {
                let far = self.reach + patch.around.farthest();
                let mut shaft = Shaft::default();
                shaft.set(&DMat4::IDENTITY, (&patch.around, light), (far, world_pad(far)));
                scratch.around_patches.push(shaft);
            }
        }
        // A blocked ray leaves the packet, so later casters see fewer rays.
        let mut alive = mask;
        for (index, placed) in (0_u32..).zip(&self.casters) {
            alive &= !self.behind(simd, (index, placed), light, scratch, alive);
            if alive == 0 {
                break;
            }
        }
        mask & !alive
    }

    /// Returns the normal of a point's triangle, if the point lies in one.
    fn normal_at(&self, origins: &Origins, i: usize) -> Option<DVec3> {
        let caster = origins.caster.filter(|_| origins.in_triangle)?;
        let [a, b, c] = self.corners_of(caster, origins.first[i]);
        Some((b - a).cross(c - a))
    }

    /// Returns the rays of a mask that a caster blocks.
    #[inline(always)]
    fn behind<S: Simd>(
        &self,
        simd: S,
        (index, placed): (u32, &InPlace<'_>),
        light: DVec3,
        scratch: &mut RayScratch,
        mask: u64,
    ) -> u64 {
        let Some(tree) = placed.tree else { return 0 };
        let mut behind = 0;
        let mut is_set = false;
        for i in 0..scratch.origins.patches.len() {
            let Patch { points, around } = scratch.origins.patches[i];
            let extent = around.extent();
            // The caster is skipped if the bounds of all rays miss its box.
            let (from, to) = (around.centre - extent, around.centre + extent);
            let (low, high) = (from.min(light), to.max(light));
            let is_beside = placed.low.cmpgt(high).any() || placed.high.cmplt(low).any();
            if is_beside || points & mask == 0 {
                continue;
            }
            let [low, high] = &placed.rounded;
            if scratch.around_patches.get(i).is_some_and(|shaft| shaft.misses(simd, low, high)) {
                continue;
            }
            let RayScratch { origins, local, shaft, stack, .. } = &mut *scratch;
            // Rays are transformed once per caster, and only if a patch needs them.
            if !is_set {
                let all = origins.patches.iter().map(|patch| patch.around.farthest());
                let reach = all.fold(placed.reach(), f64::max);
                local.set(&placed.object_from_world, (&origins.at, light), (placed.own, reach));
                is_set = true;
            }
            shaft.set(&placed.object_from_world, (&around, light), (local.far, local.pad));
            let own = origins.caster.map(|own| self.casters[own as usize].flat);
            let flat = placed.flat.max(own.unwrap_or(0.0));
            let packet = Packet { light, around, flat, is_own: origins.caster == Some(index) };
            stack.clear();
            stack.push((tree.root, points & mask));
            behind |= self.behind_tree(simd, (placed, tree), &packet, scratch, points & mask);
        }
        behind
    }

    /// Returns the rays of a mask that a BVH blocks, starting from the nodes on the stack.
    #[inline(always)]
    fn behind_tree<S: Simd>(
        &self,
        simd: S,
        (placed, tree): (&InPlace<'_>, &Bvh),
        packet: &Packet,
        scratch: &mut RayScratch,
        mask: u64,
    ) -> u64 {
        let mut alive = mask;
        while let Some((child, reached)) = scratch.stack.pop() {
            let reached = reached & alive;
            if reached == 0 {
                continue;
            }
            // An inner node pushes its children; only leaves test triangles.
            if child.count == 0 {
                let Some(node) = tree.nodes.get(child.first as usize) else { continue };
                scratch.visit(simd, node, reached);
                continue;
            }
            alive &= !self.behind_leaf(simd, (placed, tree, child), packet, scratch, reached);
            if alive == 0 {
                break;
            }
        }
        mask & !alive
    }

    /// Returns the rays of a mask that a triangle of a leaf blocks.
    #[inline(always)]
    fn behind_leaf<S: Simd>(
        &self,
        simd: S,
        (placed, tree, leaf): (&InPlace<'_>, &Bvh, BvhChild),
        packet: &Packet,
        scratch: &mut RayScratch,
        reached: u64,
    ) -> u64 {
        let RayScratch { origins, prepared, .. } = scratch;
        let mut behind = 0;
        let mut left = leaf.count as usize;
        for block in &tree.blocks[leaf.blocks()] {
            let own = (block, &placed.caster.world_from_object);
            let error = (origins.reach, packet.flat);
            let possible = prepared.set(simd, own, (&packet.around, packet.light), error);
            // The last block of a leaf repeats its last triangle; the repetitions are masked out.
            let possible = possible & ((1 << left.min(BVH_BLOCK)) - 1);
            if possible != 0 {
                let block = (placed, block, &*prepared);
                let rays = reached & !behind;
                behind |= self.behind_block(simd, block, possible, (packet, origins), rays);
            }
            left = left.saturating_sub(BVH_BLOCK);
        }
        behind
    }

    /// Returns the rays of a mask that some triangles of a block stop. All triangles are tested at
    /// once, ray by ray, because few rays reach a leaf.
    #[inline(always)]
    fn behind_block<S: Simd>(
        &self,
        simd: S,
        (placed, block, prepared): (&InPlace<'_>, &BvhBlock, &PreparedBlock),
        possible: u64,
        (packet, origins): (&Packet, &Origins),
        rays: u64,
    ) -> u64 {
        let mut behind = 0;
        for ray in Bits(rays) {
            // A point's own triangles never shade it.
            let others = if packet.is_own {
                possible & !block.among(simd, [origins.first[ray], origins.end[ray]])
            } else {
                possible
            };
            let decided = prepared.decide(simd, origins.point(ray), others);
            let is_own = |i: usize| decided.between >> i & 1 == 1;
            let mut met = Bits(decided.between | decided.open);
            if met.any(|i| {
                let triangle = (placed, block.numbers[i], &prepared.triangle(i));
                self.stands_between(triangle, (packet, origins), (ray, is_own(i)))
            }) {
                behind |= 1 << ray;
            }
        }
        behind
    }

    /// Returns whether a triangle blocks the ray from a point to the light. Uses exact arithmetic
    /// if f64 was not `sure`, and lets rays through holes.
    #[inline(never)]
    fn stands_between(
        &self,
        (placed, number, triangle): (&InPlace<'_>, u32, &Prepared),
        (packet, origins): (&Packet, &Origins),
        (ray, sure): (usize, bool),
    ) -> bool {
        let corners = &triangle.corners;
        // A point is on the light's side of a plane if its own triangle is, however it was rounded.
        let is_between = sure
            || (self.own_reaches_behind((packet, origins), ray, corners)
                && is_between(corners, packet.light, origins.point(ray)));
        if placed.is_solid || !is_between {
            return is_between;
        }
        self.is_solid_at(placed, number, triangle.parts(origins.point(ray)))
    }

    /// Returns whether a point's own triangle reaches behind the plane of another. A point without
    /// a triangle is exact, so the answer is yes.
    fn own_reaches_behind(
        &self,
        (packet, origins): (&Packet, &Origins),
        i: usize,
        triangle: &Corners,
    ) -> bool {
        let is_exact = !origins.in_triangle || origins.lifted >> i & 1 == 1;
        let Some(caster) = origins.caster.filter(|_| !is_exact) else { return true };
        let own = self.corners_of(caster, origins.first[i]);
        reaches_behind(&own, triangle, packet.light, packet.flat)
    }

    /// Returns the corners of a caster's triangle, in world space.
    pub(crate) fn corners_of(&self, caster: u32, triangle: u32) -> Corners {
        let InPlace { caster, .. } = &self.casters[caster as usize];
        let order = caster.model.mesh.draw_order();
        // Adding 0 turns -0 into 0, as in the BVH, so both have the same bits.
        let corners = each(order.vertices_of(triangle), |vertex| {
            let i = vertex as usize;
            [order.x[i] + 0.0, order.y[i] + 0.0, order.z[i] + 0.0]
        });
        placed(&caster.world_from_object, corners)
    }

    /// Returns whether a triangle of a caster blocks light at these barycentric coordinates.
    fn is_solid_at(&self, placed: &InPlace<'_>, triangle: u32, parts: DVec3) -> bool {
        let Some(part) = placed.caster.part_of(triangle) else { return false };
        part.filter.is_none() && self.is_there(placed, (triangle, part), parts)
    }

    /// Returns whether a triangle of a part has no hole at these barycentric coordinates.
    fn is_there(
        &self,
        placed: &InPlace<'_>,
        (triangle, part): (u32, &CasterPart),
        parts: DVec3,
    ) -> bool {
        let Some(Holes { texture, map, opacity }) = &part.holes else { return true };
        let Some(uvs) = placed.caster.model.mesh.triangle_uvs(triangle) else { return true };
        let uvs = each(uvs, |[u, v]| [f64::from(u), f64::from(v)]);
        let at = uv(uvs, parts);
        let texture = texture.as_ref().map_or(1.0, |it| sample::<f64>(it, at, self.filter)[3]);
        let map = map.as_ref().map_or(1.0, |it| opacity_of(it, at, self.filter));
        texture * map * opacity >= 0.5
    }
}

impl RayScratch {
    /// Pushes the children of a node that rays meet. Leaves are tested ray by ray, inner nodes only
    /// by the shaft.
    #[inline(always)]
    fn visit<S: Simd>(&mut self, simd: S, node: &BvhNode, reached: u64) {
        for (child, [low, high]) in node.children() {
            if self.shaft.misses(simd, &low, &high) {
                continue;
            }
            let met = match child.count {
                0 => reached,
                _ => self.local.meeting(simd, &low, &high, reached),
            };
            if met != 0 {
                self.stack.push((child, met));
            }
        }
    }
}

/// A packet of rays to be traced.
struct Packet {
    light: DVec3,
    /// The box around their origins.
    around: Around,
    /// The distance within which a triangle of the caster and one of the points lie in one plane.
    flat: f64,
    /// Whether the rays begin on the caster being traced.
    is_own: bool,
}

impl<'a> InPlace<'a> {
    fn new(caster: &'a Caster, method: ShadowMethod) -> Option<Self> {
        let mesh = &caster.model.mesh;
        let own = mesh.bounds()?;
        let m = caster.world_from_object;
        let corners = own.corners().map(|corner| m.transform_point3(corner));
        let low = corners.iter().fold(DVec3::INFINITY, |low, corner| low.min(*corner));
        let high = corners.iter().fold(DVec3::NEG_INFINITY, |high, corner| high.max(*corner));
        // The transformed corners are rounded, so the box is enlarged.
        let error = low.abs().max(high.abs()).max_element() * 1e-14;
        let object_from_world = m.inverse();
        let scale = each([m.x_axis, m.y_axis, m.z_axis], |axis| axis.length());
        let coordinate = own.corners().iter().fold(0.0, |most, p| p.abs().max_element().max(most));
        let flat = FLAT * coordinate * scale.into_iter().fold(0.0, f64::max);
        let (low, high) = (low - error, high + error);
        // An infinite box or a singular placement cannot be traced and casts no shadow.
        let is_finite = low.is_finite() && high.is_finite() && object_from_world.is_finite();
        is_finite.then(|| Self {
            caster,
            tree: method.map().is_none().then(|| mesh.bvh()),
            object_from_world,
            own,
            low,
            high,
            rounded: [
                low.as_vec3().to_array().map(f32::next_down),
                high.as_vec3().to_array().map(f32::next_up),
            ],
            flat,
            is_solid: caster.is_solid(),
        })
    }

    /// Returns the largest coordinate of the box.
    fn reach(&self) -> f64 {
        self.low.abs().max(self.high.abs()).max_element()
    }
}

/// Computes the distance of suns for these casters.
fn sun_distance(casters: &[InPlace<'_>]) -> f64 {
    let reach = casters.iter().map(InPlace::reach).fold(f64::MIN_POSITIVE, f64::max);
    // A power of two changes rarely as casters move; a change would invalidate cached shadows.
    power_of_two_above(reach) * SUN
}

/// Returns the smallest power of two above a number.
fn power_of_two_above(x: f64) -> f64 {
    libm::ldexp(1.0, libm::frexp(x).1)
}

#[cfg(test)]
mod tests;

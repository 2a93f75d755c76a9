//! Traces packets of rays through all casters of a frame.

use fearless_simd::{Level, Simd, dispatch};
use glam::{DMat4, DVec3};

use super::rays::{Origins, RayScratch};
use super::triangle::{Corners, Prepared, is_between, reaches_behind};
use crate::accuracy::Filter;
use crate::base::math::each;
use crate::render::frame::FramePlan;
use crate::render::frame::shadows::{Caster, CasterPart, ShadowSource, Shadows};
use crate::render::simd::BATCH;
use crate::render::texture::sample::sample;
use crate::render::texture::uv::uv;
use crate::scene::{Bounds, RayTree, TreeTriangle, dvec3};

/// How much farther a sun is than the largest coordinate of the scene.
const SUN: f64 = (1_u64 << 60) as f64;

/// What casts shadows in a frame, ready to be met by rays.
#[derive(Debug)]
pub(crate) struct Tracer<'a> {
    casters: Vec<InPlace<'a>>,
    /// For each draw, the caster that it draws.
    of_draws: Vec<Option<u32>>,
    /// For each light, the end of the rays to it, if it casts shadows.
    lights: Vec<Option<DVec3>>,
    filter: Filter,
}

/// A caster in its place.
#[derive(Debug)]
struct InPlace<'a> {
    caster: &'a Caster,
    tree: &'a RayTree,
    object_from_world: DMat4,
    /// Its bounds in object space.
    own: Bounds,
    /// Its box in world space.
    low: DVec3,
    high: DVec3,
    is_solid: bool,
}

/// The corners of a triangle in world space. Every part of the renderer that needs them exactly
/// uses this function.
#[inline(always)]
fn placed(world_from_object: &DMat4, corners: [[f32; 3]; 3]) -> Corners {
    each(corners, |corner| world_from_object.transform_point3(dvec3(corner)))
}

impl<'a> Tracer<'a> {
    /// Makes the casters of a plan ready; `None` if no light casts shadows.
    pub(crate) fn new(plan: &'a FramePlan) -> Option<Self> {
        if !plan.shadows.are_cast() {
            return None;
        }
        let tracer = Self::of(&plan.shadows, plan.filter);
        let of_draw = |item| tracer.casters.iter().position(|placed| placed.caster.item == item);
        let index = |at: usize| u32::try_from(at).expect("fewer than 2^32 objects");
        let of_draws = plan.draws.iter().map(|draw| of_draw(draw.item).map(index)).collect();
        Some(Self { of_draws, ..tracer })
    }

    /// Makes casters ready.
    fn of(shadows: &'a Shadows, filter: Filter) -> Self {
        let casters: Vec<InPlace<'a>> = shadows.casters.iter().filter_map(InPlace::new).collect();
        let reach = casters.iter().map(InPlace::reach).fold(f64::MIN_POSITIVE, f64::max);
        let far = power_of_two_above(reach) * SUN;
        let end = |source: &ShadowSource| match source {
            ShadowSource::Direction(towards) => *towards * far,
            // A light that is farther than a sun is one.
            ShadowSource::Point(at) => *at * (far / at.abs().max_element()).min(1.0),
        };
        let lights = shadows.sources.iter().map(|source| source.as_ref().map(end)).collect();
        Self { casters, of_draws: Vec::new(), lights, filter }
    }

    /// The end of the rays to a light, if it casts shadows.
    #[inline(always)]
    pub(crate) fn light(&self, light: u32) -> Option<DVec3> {
        self.lights[light as usize]
    }

    /// The caster that a draw draws.
    pub(crate) fn caster_of(&self, draw: u32) -> Option<u32> {
        self.of_draws[draw as usize]
    }

    /// `world_from_object` of a caster.
    pub(crate) fn placement(&self, caster: u32) -> DMat4 {
        self.casters[caster as usize].caster.world_from_object
    }

    /// The rays of a mask that something stands between and the light, a bit for each.
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
        dispatch!(level, simd => self.trace(simd, light, scratch, mask))
    }

    #[inline(always)]
    fn trace<S: Simd>(&self, simd: S, light: DVec3, scratch: &mut RayScratch, mask: u64) -> u64 {
        let RayScratch { origins, local, stack } = scratch;
        fill_up(origins, &mut local.at, mask);
        let around = bounds_of(&local.at);
        let (low, high) = (around[0].min(light), around[1].max(light));
        let mut alive = mask;
        for (index, placed) in (0_u32..).zip(&self.casters) {
            if placed.low.cmpgt(high).any() || placed.high.cmplt(low).any() {
                continue;
            }
            let reach = placed.reach().max(around[0].abs().max(around[1].abs()).max_element());
            local.set(&placed.object_from_world, light, (placed.own, reach));
            let packet = Packet { light, around, is_own: origins.caster == Some(index) };
            stack.clear();
            stack.push((placed.tree.root, alive));
            while let Some((child, reached)) = stack.pop() {
                let reached = reached & alive;
                if reached == 0 {
                    continue;
                }
                if child.count == 0 {
                    let Some(node) = placed.tree.nodes.get(child.first as usize) else { continue };
                    for i in 0..2 {
                        let met = local.meeting(simd, &node.low[i], &node.high[i], reached);
                        if met != 0 {
                            stack.push((node.children[i], met));
                        }
                    }
                    continue;
                }
                for triangle in &placed.tree.triangles[child.triangles()] {
                    let rays = reached & alive;
                    alive &=
                        !self.behind(simd, (placed, triangle), (&packet, origins, &local.at), rays);
                }
                if alive == 0 {
                    return mask;
                }
            }
        }
        mask & !alive
    }

    /// The rays of a mask that a triangle stands between and the light.
    #[inline(always)]
    fn behind<S: Simd>(
        &self,
        simd: S,
        (placed, triangle): (&InPlace<'_>, &TreeTriangle),
        (packet, origins, at): (&Packet, &Origins, &[[f64; BATCH]; 3]),
        mut rays: u64,
    ) -> u64 {
        if packet.is_own {
            rays &= !origins.on(triangle.number, rays);
        }
        if rays == 0 {
            return 0;
        }
        let corners = self::placed(&placed.caster.world_from_object, triangle.corners);
        let Some(prepared) = Prepared::new(corners, packet.light, packet.around, origins.reach)
        else {
            return 0;
        };
        let decided = prepared.decide(simd, at, rays);
        if decided.between | decided.open == 0 {
            return 0;
        }
        self.settle((placed, triangle.number), (&prepared, &corners), (packet, origins), decided)
    }

    /// Decides what f64 cannot, and lets rays through holes.
    #[inline(never)]
    fn settle(
        &self,
        (placed, number): (&InPlace<'_>, u32),
        (prepared, corners): (&Prepared, &Corners),
        (packet, origins): (&Packet, &Origins),
        decided: super::triangle::Decided,
    ) -> u64 {
        let mut between = decided.between;
        for i in bits(decided.open) {
            let is = self.own_reaches_behind(origins, i, corners, packet.light)
                && is_between(corners, packet.light, origins.point(i));
            between |= u64::from(is) << i;
        }
        if placed.is_solid || between == 0 {
            return between;
        }
        let part = placed.caster.part_of(number);
        bits(between)
            .filter(|i| self.is_solid_at(placed, part, number, prepared.parts(origins.point(*i))))
            .fold(0, |solid, i| solid | 1 << i)
    }

    /// Whether a point's own triangle reaches behind the plane of another. A point that lies in no
    /// triangle is exact.
    fn own_reaches_behind(
        &self,
        origins: &Origins,
        i: usize,
        triangle: &Corners,
        light: DVec3,
    ) -> bool {
        let Some(caster) = origins.caster.filter(|_| origins.in_triangle) else { return true };
        let own = self.corners_of(caster, origins.first[i]);
        reaches_behind(&own, triangle, light)
    }

    /// The corners of a triangle of a caster, in world space.
    pub(crate) fn corners_of(&self, caster: u32, triangle: u32) -> Corners {
        let InPlace { caster, .. } = &self.casters[caster as usize];
        let order = caster.model.mesh.draw_order();
        let corners = each(order.vertices_of(triangle), |vertex| {
            let i = vertex as usize;
            [order.x[i] + 0.0, order.y[i] + 0.0, order.z[i] + 0.0]
        });
        placed(&caster.world_from_object, corners)
    }

    /// Whether a part of a caster stops light where these parts of a triangle's corners meet.
    fn is_solid_at(
        &self,
        placed: &InPlace<'_>,
        part: Option<&CasterPart>,
        triangle: u32,
        parts: DVec3,
    ) -> bool {
        let Some(part) = part else { return false };
        let Some((texture, opacity)) = &part.holes else { return true };
        let Some(uvs) = placed.caster.model.mesh.triangle_uvs(triangle) else { return true };
        let uvs = each(uvs, |[u, v]| [f64::from(u), f64::from(v)]);
        sample::<f64>(texture, uv(uvs, parts), self.filter)[3] * opacity >= 0.5
    }
}

/// The rays that are traced.
struct Packet {
    light: DVec3,
    /// The box of their origins.
    around: [DVec3; 2],
    /// Whether they begin on the caster that is traced.
    is_own: bool,
}

impl<'a> InPlace<'a> {
    fn new(caster: &'a Caster) -> Option<Self> {
        let mesh = &caster.model.mesh;
        let own = mesh.bounds()?;
        let m = caster.world_from_object;
        let corners = own.corners().map(|corner| m.transform_point3(corner));
        let low = corners.iter().fold(DVec3::INFINITY, |low, corner| low.min(*corner));
        let high = corners.iter().fold(DVec3::NEG_INFINITY, |high, corner| high.max(*corner));
        // Its corners are rounded.
        let error = low.abs().max(high.abs()).max_element() * 1e-14;
        let object_from_world = m.inverse();
        let (low, high) = (low - error, high + error);
        let is_finite = low.is_finite() && high.is_finite() && object_from_world.is_finite();
        is_finite.then(|| Self {
            caster,
            tree: mesh.ray_tree(),
            object_from_world,
            own,
            low,
            high,
            is_solid: caster.is_solid(),
        })
    }

    /// The largest coordinate of its box.
    fn reach(&self) -> f64 {
        self.low.abs().max(self.high.abs()).max_element()
    }
}

/// Copies the points of a mask. In place of the others stands one of them, so that they widen no
/// box.
#[inline(always)]
fn fill_up(origins: &Origins, at: &mut [[f64; BATCH]; 3], mask: u64) {
    let one = mask.trailing_zeros() as usize % BATCH;
    for (to, from) in at.iter_mut().zip(&origins.at) {
        for (i, (to, x)) in to.iter_mut().zip(from).enumerate() {
            *to = if mask >> i & 1 == 1 { *x } else { from[one] };
        }
    }
}

#[inline(always)]
fn bounds_of(at: &[[f64; BATCH]; 3]) -> [DVec3; 2] {
    let [mut low, mut high] = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    for axis in 0..3 {
        for x in &at[axis] {
            low[axis] = low[axis].min(*x);
            high[axis] = high[axis].max(*x);
        }
    }
    [DVec3::from_array(low), DVec3::from_array(high)]
}

/// The numbers of the bits of a mask.
fn bits(mut mask: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        (mask != 0).then(|| {
            let i = mask.trailing_zeros() as usize;
            mask &= mask - 1;
            i
        })
    })
}

/// The least power of two above a number.
fn power_of_two_above(x: f64) -> f64 {
    libm::ldexp(1.0, libm::frexp(x).1)
}

#[cfg(test)]
mod tests;

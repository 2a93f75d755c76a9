//! Searches the trees of things for the surfaces that a ray meets.
//!
//! Many rays that run to one light share a [`Frontier`]: the parts of the trees that any of them
//! may meet. Each ray searches these alone.

use fearless_simd::{Simd, SimdBase as _, SimdMask as _, f32x8, f64x8};
use glam::DVec3;

use super::frontier::Frontier;
use super::{Corners, Hit, OwnTriangles, Ray, Thing, Things};
use crate::accel::{BVH_BLOCK, BvhBlock, BvhChild, BvhNode, EightBoxes};
use crate::simd::{Bits, Vec3};
use marraztu_core::base::math::each;

/// Decides whether a point of a surface stops a ray.
type Stops<'a> = &'a dyn Fn(&Hit) -> bool;

/// The nodes and leaves of a tree that are still to be visited, with the distances of their boxes.
#[derive(Debug, Default)]
pub(crate) struct RayStack(Vec<(BvhChild, f32)>);

/// The error of a position and of a parameter in f32, relative to the largest coordinate: four
/// roundings, twice.
pub(super) const SINGLE: f64 = 1.0 / (1 << 21) as f64;

/// The error of a position transformed in f64, relative to the sum of the added terms.
pub(super) const DOUBLE: f64 = 1.0 / (1_u64 << 47) as f64;

/// The smallest component of a direction, relative to its largest.
pub(super) const LEAST: f64 = 1e-30;

/// A ray in the space of an object, or in its own, for boxes in f32 and triangles in f64.
#[derive(Clone, Copy, Debug)]
struct LocalRay {
    from: DVec3,
    /// The direction; its largest component is 1.
    way: DVec3,
    /// The length of `way` in units of the ray.
    step: f64,
    /// The largest coordinate of the origin and of the boxes along each axis.
    origin: [f32; 3],
    inverse: [f32; 3],
    /// The padding of boxes, which covers all f32 errors.
    pad: [f32; 3],
}

#[expect(clippy::cast_possible_truncation, reason = "the nearest f32 is meant; pads hold it")]
impl LocalRay {
    /// Creates a ray in a space with boxes up to the coordinates `far`. `exact` is the error of
    /// its origin.
    #[inline(always)]
    fn new((from, along): (DVec3, DVec3), far: DVec3, exact: DVec3) -> Self {
        let length = along.abs().max_element();
        let way = along / length;
        let inverse = each(way.to_array(), |part| {
            let part = if part.abs() < LEAST { LEAST.copysign(part) } else { part };
            (1.0 / part) as f32
        });
        let pad = (far + from.abs()) * SINGLE + exact;
        Self {
            from,
            way,
            step: 1.0 / length,
            origin: from.as_vec3().to_array(),
            inverse,
            pad: each(pad.to_array(), |pad| (pad as f32).next_up()),
        }
    }

    /// Transforms a ray to the space of a thing. `reach` is the largest coordinate in the space of
    /// rays.
    #[inline(always)]
    fn of(ray: &Ray, thing: &Thing<'_>, reach: f64) -> Self {
        let m = &thing.object_from_rays;
        let columns =
            m.x_axis.truncate().abs() + m.y_axis.truncate().abs() + m.z_axis.truncate().abs();
        let reach = reach.max(ray.from.abs().max_element());
        let exact = (columns * reach + m.w_axis.truncate().abs()) * DOUBLE;
        let local = (m.transform_point3(ray.from), m.transform_vector3(ray.towards));
        Self::new(local, thing.bounds.min.abs().max(thing.bounds.max.abs()), exact)
    }

    /// Returns a bit for each of eight boxes that the ray meets up to a distance, and where it
    /// enters them.
    #[inline(always)]
    fn meeting<S: Simd>(&self, simd: S, boxes: &EightBoxes, before: f64) -> (u64, f32x8<S>) {
        let end = (before / self.step * (1.0 + SINGLE)) as f32;
        let mut near = f32x8::splat(simd, 0.0);
        let mut far = f32x8::splat(simd, end.next_up());
        for axis in 0..3 {
            let (origin, inverse, pad) = (self.origin[axis], self.inverse[axis], self.pad[axis]);
            // The ray enters through the side that its direction points away from.
            let runs_back = usize::from(inverse < 0.0);
            let pad = if inverse < 0.0 { -pad } else { pad };
            let enter = f32x8::from_slice(simd, &boxes.rows[runs_back][axis]);
            let leave = f32x8::from_slice(simd, &boxes.rows[1 - runs_back][axis]);
            near = near.max((enter - (origin + pad)) * inverse);
            far = far.min((leave - (origin - pad)) * inverse);
        }
        (far.simd_ge(near).to_bitmask(), near)
    }
}

impl Things<'_> {
    /// Returns the nearest point at which a ray meets a surface. Of several at the same distance,
    /// the earlier triangle counts, as in the depth test.
    #[inline(always)]
    pub(crate) fn nearest<S: Simd>(
        &self,
        simd: S,
        ray: &Ray,
        stops: Stops<'_>,
        stack: &mut RayStack,
    ) -> Option<Hit> {
        let mut best = None;
        self.search::<S, false>(simd, (ray, stops), stack, (f64::INFINITY, &mut best));
        best
    }

    /// Returns whether a surface stops a ray before it has gone a distance.
    #[inline(always)]
    pub(crate) fn stop<S: Simd>(
        &self,
        simd: S,
        (ray, distance): (&Ray, f64),
        stops: Stops<'_>,
        stack: &mut RayStack,
    ) -> bool {
        let mut best = None;
        self.search::<S, true>(simd, (ray, stops), stack, (distance, &mut best));
        best.is_some()
    }

    /// Returns the same as [`Self::stop`] for a ray of a frontier.
    #[inline(always)]
    pub(crate) fn stop_within<S: Simd>(
        &self,
        simd: S,
        (ray, distance, frontier): (&Ray, f64, &Frontier),
        stops: Stops<'_>,
        stack: &mut RayStack,
    ) -> bool {
        let (own, mut best) = (Own { things: self, ray }, None);
        for (index, nodes) in frontier.things() {
            let thing = &self.all[index as usize];
            let local = LocalRay::of(ray, thing, self.reach);
            let of = Search { index, thing, local: &local, own: &own, stops, most: distance };
            stack.0.clear();
            for node in nodes {
                of.list::<S, true>(simd, node, distance, &mut stack.0);
            }
            of.run::<S, true>(simd, stack, &mut best);
            if best.is_some() {
                return true;
            }
        }
        false
    }

    /// Searches for the nearest point up to a distance, or for `ANY`.
    #[inline(always)]
    fn search<S: Simd, const ANY: bool>(
        &self,
        simd: S,
        (ray, stops): (&Ray, Stops<'_>),
        stack: &mut RayStack,
        (most, best): (f64, &mut Option<Hit>),
    ) {
        let own = Own { things: self, ray };
        let around = LocalRay::new((ray.from, ray.towards), DVec3::splat(self.reach), DVec3::ZERO);
        for (group, boxes) in self.boxes.iter().enumerate() {
            let (met, _) = around.meeting(simd, boxes, distance_of(best.as_ref(), most));
            for i in Bits(met) {
                let index = group * EightBoxes::COUNT + i;
                let thing = &self.all[index];
                let local = LocalRay::of(ray, thing, self.reach);
                let index = u32::try_from(index).unwrap_or(u32::MAX);
                let of = Search { index, thing, local: &local, own: &own, stops, most };
                stack.0.clear();
                stack.0.push((thing.tree.root, 0.0));
                of.run::<S, ANY>(simd, stack, best);
                if ANY && best.is_some() {
                    return;
                }
            }
        }
    }
}

/// The search of a thing.
struct Search<'a> {
    index: u32,
    thing: &'a Thing<'a>,
    local: &'a LocalRay,
    own: &'a Own<'a>,
    stops: Stops<'a>,
    /// The length of the ray.
    most: f64,
}

impl Search<'_> {
    /// Searches the listed parts of the tree for a nearer point.
    #[inline(always)]
    fn run<S: Simd, const ANY: bool>(
        &self,
        simd: S,
        RayStack(stack): &mut RayStack,
        best: &mut Option<Hit>,
    ) {
        let Self { thing, local, most, .. } = *self;
        while let Some((child, enters)) = stack.pop() {
            // A nearer point may have been found since the box was listed.
            let nearest = distance_of(best.as_ref(), most);
            if f64::from(enters) * local.step * (1.0 - SINGLE) > nearest {
                continue;
            }
            if child.count > 0 {
                self.search_leaf::<S, ANY>(simd, child, best);
                if ANY && best.is_some() {
                    return;
                }
                continue;
            }
            let Some(node) = thing.tree.nodes.get(child.first as usize) else { continue };
            self.list::<S, ANY>(simd, node, nearest, stack);
        }
    }

    /// Lists the children of a node that the ray meets up to a distance.
    #[inline(always)]
    fn list<S: Simd, const ANY: bool>(
        &self,
        simd: S,
        node: &BvhNode,
        nearest: f64,
        stack: &mut Vec<(BvhChild, f32)>,
    ) {
        let (met, near) = self.local.meeting(simd, &node.boxes, nearest);
        let near: [f32; EightBoxes::COUNT] = near.into();
        let first = stack.len();
        for i in Bits(met) {
            let mut at = stack.len();
            stack.push((node.children[i], near[i]));
            // The nearest child is visited first: insertion sort, the farthest at the bottom.
            while !ANY && at > first && stack[at - 1].1 < stack[at].1 {
                stack.swap(at - 1, at);
                at -= 1;
            }
        }
    }

    /// Searches the triangles of a leaf for a nearer point.
    #[inline(always)]
    fn search_leaf<S: Simd, const ANY: bool>(
        &self,
        simd: S,
        leaf: BvhChild,
        best: &mut Option<Hit>,
    ) {
        let Self { index, thing, local, own, stops, most } = *self;
        let mut left = leaf.count as usize;
        for block in &thing.tree.blocks[leaf.blocks()] {
            let crossed = Crossed::of(simd, block, local);
            // The last block repeats its last triangle.
            let used = (1 << left.min(BVH_BLOCK)) - 1;
            left = left.saturating_sub(BVH_BLOCK);
            let within = crossed.up_to(simd, distance_of(best.as_ref(), most) / local.step);
            for i in Bits(crossed.inside & within & used) {
                let hit = crossed.hit(i, (index, block.numbers[i]), local.step);
                let is_nearer = best.is_none_or(|best| hit.is_before(&best));
                if is_nearer && own.may_meet(&hit, thing) && (thing.is_solid || stops(&hit)) {
                    *best = Some(hit);
                    if ANY {
                        return;
                    }
                }
            }
        }
    }
}

/// Returns the distance of a point, or the length of the ray.
#[inline(always)]
fn distance_of(hit: Option<&Hit>, most: f64) -> f64 {
    hit.map_or(most, |hit| hit.distance)
}

impl Hit {
    /// Returns whether the point is nearer than another, or as near and earlier in the frame.
    fn is_before(&self, other: &Self) -> bool {
        let key = |hit: &Self| (hit.thing, hit.triangle);
        self.distance < other.distance
            || (self.distance == other.distance && key(self) < key(other))
    }
}

/// The triangles that a ray starts on.
struct Own<'a> {
    things: &'a Things<'a>,
    ray: &'a Ray,
}

/// The rounding of a start, relative to the largest coordinate.
const ROUNDED: f64 = 1.0 / (1_u64 << 40) as f64;

impl Own<'_> {
    /// Returns whether the ray can meet a triangle: it is another one, and the first triangle
    /// reaches to the side of its plane that the ray comes from.
    fn may_meet(&self, hit: &Hit, thing: &Thing<'_>) -> bool {
        let Self { things, ray } = *self;
        let is_own = |own: OwnTriangles| {
            own.thing == hit.thing && (own.first..own.end).contains(&hit.triangle)
        };
        if ray.own.is_some_and(is_own) {
            return false;
        }
        // Far away, rounding decides nothing.
        let Some(own) = ray.own.filter(|own| own.is_rounded) else {
            return hit.distance > things.reach.max(ray.from.abs().max_element()) * ROUNDED;
        };
        let of = &things.all[own.thing as usize];
        let corners: Corners = of.corners(own.first);
        let [p, q, r] = corners;
        if hit.distance > 2.0 * (q - p).abs().max((r - p).abs()).max_element() {
            return true;
        }
        let [a, b, c] = thing.corners(hit.triangle);
        let normal = (b - a).cross(c - a);
        let side = if normal.dot(ray.towards) > 0.0 { -1.0 } else { 1.0 };
        let least = of.flat.max(thing.flat) * normal.length();
        corners.iter().any(|corner| side * normal.dot(*corner - a) > least)
    }
}

/// The points at which a ray crosses the planes of eight triangles.
struct Crossed<S: Simd> {
    /// A bit for each triangle that it crosses inside, in front of its start.
    inside: u64,
    /// The edge functions, which are proportional to the weights of the corners, and their sum.
    parts: [f64x8<S>; 3],
    sum: f64x8<S>,
    /// The ray parameters.
    at: f64x8<S>,
}

impl<S: Simd> Crossed<S> {
    /// With the corners A, B and C relative to the start of the ray, and its direction D, the
    /// weight of A is proportional to D . (B x C). The triangle on the other side of an edge has
    /// the same number with the opposite sign.
    #[inline(always)]
    fn of(simd: S, block: &BvhBlock, ray: &LocalRay) -> Self {
        let zero = f64x8::splat(simd, 0.0);
        let [x, y, z] = ray.way.to_array();
        let way = Vec3([f64x8::splat(simd, x), f64x8::splat(simd, y), f64x8::splat(simd, z)]);
        let [a, b, c] = [
            relative(simd, &block.corners[0], ray.from),
            relative(simd, &block.corners[1], ray.from),
            relative(simd, &block.corners[2], ray.from),
        ];
        let parts = [way.dot(b.cross(c)), way.dot(c.cross(a)), way.dot(a.cross(b))];
        let sum = parts[0] + parts[1] + parts[2];
        let front = parts[0].simd_ge(zero) & parts[1].simd_ge(zero) & parts[2].simd_ge(zero);
        let back = parts[0].simd_le(zero) & parts[1].simd_le(zero) & parts[2].simd_le(zero);
        // The point is the weighted mean of the corners.
        let along = parts[0] * a.dot(way) + parts[1] * b.dot(way) + parts[2] * c.dot(way);
        let at = along / (sum * way.dot(way));
        let some = (front | back).to_bitmask() & !sum.simd_eq(zero).to_bitmask();
        Self { inside: some & at.simd_gt(zero).to_bitmask(), parts, sum, at }
    }

    /// Returns a bit for each triangle that is crossed at this parameter or before.
    #[inline(always)]
    fn up_to(&self, simd: S, most: f64) -> u64 {
        self.at.simd_le(f64x8::splat(simd, most)).to_bitmask()
    }

    /// Returns the point on one of the triangles.
    fn hit(&self, i: usize, (thing, triangle): (u32, u32), step: f64) -> Hit {
        let pick = |row: f64x8<S>| <[f64; BVH_BLOCK]>::from(row)[i];
        let [a, b, c] = self.parts;
        let sum = pick(self.sum);
        Hit {
            thing,
            triangle,
            weights: DVec3::new(pick(a), pick(b), pick(c)) / sum,
            distance: pick(self.at) * step,
            // The sum is the product of the direction and the normal, in object space: a mirrored
            // placement does not turn a body inside out.
            is_front: sum < 0.0,
        }
    }
}

/// Returns a corner of eight triangles relative to a point.
#[inline(always)]
fn relative<S: Simd>(simd: S, rows: &[[f32; BVH_BLOCK]; 3], to: DVec3) -> Vec3<f64x8<S>> {
    let mut wide = [[0.0; BVH_BLOCK]; 3];
    for (axis, row) in rows.iter().enumerate() {
        for (wide, x) in wide[axis].iter_mut().zip(row) {
            *wide = f64::from(*x) - to[axis];
        }
    }
    Vec3([
        f64x8::from_slice(simd, &wide[0]),
        f64x8::from_slice(simd, &wide[1]),
        f64x8::from_slice(simd, &wide[2]),
    ])
}

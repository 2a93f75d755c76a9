//! The parts of trees that rays between two boxes may meet.
//!
//! The rays from the points of one box to the points of another fill the convex hull of both, and
//! the hull is the union of the boxes in between: at the parameter t, a box whose sides are mixed
//! from theirs. A box of a tree is met if one of these overlaps it along all axes. That is the slab
//! test of a ray, with a line for each side of the moving box.
//!
//! Kay and Kajiya, "Ray Tracing Complex Scenes", SIGGRAPH 1986.

use std::ops::Range;

use fearless_simd::{Simd, SimdBase as _, SimdMask as _, f32x8};
use glam::{DMat4, DVec3};

use super::search::{DOUBLE, LEAST, SINGLE};
use super::{Thing, Things};
use crate::accel::{BvhChild, BvhNode, EightBoxes};
use crate::simd::Bits;

/// The parts of the trees of all things that some rays may meet.
#[derive(Debug, Default)]
pub(crate) struct Frontier {
    /// The children of these nodes are the parts.
    nodes: Vec<BvhNode>,
    /// The things with parts, and the nodes of each.
    of_things: Vec<(u32, Range<usize>)>,
    /// Nodes to be opened, and parts, of the thing that is searched.
    open: Vec<BvhChild>,
    parts: Vec<(BvhChild, [[f32; 3]; 2])>,
}

/// A tree is opened until it has more parts. Each costs every ray an eighth of a test.
const MOST: usize = 48;

/// The ends of rays: the points they start at, and the box around the points they run to.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ends<'a> {
    /// The coordinates of the starts along each axis.
    pub(crate) starts: [&'a [f64]; 3],
    /// The ball in which the rays end.
    pub(crate) centre: DVec3,
    pub(crate) radius: f64,
}

impl Frontier {
    /// Returns each thing with parts, and nodes whose children are these.
    pub(super) fn things(&self) -> impl Iterator<Item = (u32, &[BvhNode])> {
        self.of_things.iter().map(|(index, nodes)| (*index, &self.nodes[nodes.clone()]))
    }

    /// Returns whether no ray meets anything.
    pub(crate) fn is_empty(&self) -> bool {
        self.of_things.is_empty()
    }

    /// Finds the parts that rays between these ends may meet.
    #[inline(always)]
    pub(crate) fn find<S: Simd>(&mut self, simd: S, things: &Things<'_>, ends: &Ends<'_>) {
        self.nodes.clear();
        self.of_things.clear();
        let around = Beam::new(&DMat4::IDENTITY, ends, (DVec3::splat(things.reach), things.reach));
        for (group, boxes) in things.boxes.iter().enumerate() {
            for i in Bits(around.meeting(simd, boxes)) {
                let index = group * EightBoxes::COUNT + i;
                self.add(simd, (index, &things.all[index]), ends, things.reach);
            }
        }
    }

    /// Adds the parts of a thing.
    #[inline(always)]
    fn add<S: Simd>(
        &mut self,
        simd: S,
        (index, thing): (usize, &Thing<'_>),
        ends: &Ends<'_>,
        reach: f64,
    ) {
        let far = thing.bounds.min.abs().max(thing.bounds.max.abs());
        let beam = Beam::new(&thing.object_from_rays, ends, (far, reach));
        self.open.clear();
        self.parts.clear();
        if thing.tree.root.count > 0 {
            // The only leaf is met without a test.
            self.parts.push((thing.tree.root, [[f32::MIN; 3], [f32::MAX; 3]]));
        } else {
            self.open.push(thing.tree.root);
        }
        // Level by level, so that large nodes are opened first.
        let mut next = 0;
        while let Some(child) = self.open.get(next) {
            next += 1;
            let Some(node) = thing.tree.nodes.get(child.first as usize) else { continue };
            for i in Bits(beam.meeting(simd, &node.boxes)) {
                let child = node.children[i];
                let is_full = self.parts.len() + self.open.len() - next >= MOST;
                if child.count > 0 || is_full {
                    self.parts.push((child, node.boxes.get(i)));
                } else {
                    self.open.push(child);
                }
            }
        }
        let first = self.nodes.len();
        for parts in self.parts.chunks(EightBoxes::COUNT) {
            let mut node = BvhNode::default();
            for (i, (child, around)) in parts.iter().enumerate() {
                node.children[i] = *child;
                node.boxes.set(i, *around);
            }
            self.nodes.push(node);
        }
        if self.nodes.len() > first {
            let index = u32::try_from(index).unwrap_or(u32::MAX);
            self.of_things.push((index, first..self.nodes.len()));
        }
    }
}

/// The hull of two boxes in the space of an object, padded for all f32 errors.
#[derive(Clone, Copy, Debug)]
struct Beam {
    /// The sides of the box that the rays start in.
    low: [f32; 3],
    high: [f32; 3],
    /// For each side, the parameter that it takes for a unit of length.
    per_low: [f32; 3],
    per_high: [f32; 3],
    /// The parameter of the box that the rays end in.
    end: f32,
}

#[expect(clippy::cast_possible_truncation, reason = "the nearest f32 is meant; pads hold it")]
impl Beam {
    /// Transforms the ends of rays. `far` is the largest coordinate of the boxes of the object
    /// along each axis, and `reach` that of the rays' space.
    #[inline(always)]
    fn new(m: &DMat4, ends: &Ends<'_>, (far, reach): (DVec3, f64)) -> Self {
        let Ends { starts: [xs, ys, zs], centre, radius } = *ends;
        let (mut low, mut high, mut most) = (DVec3::INFINITY, DVec3::NEG_INFINITY, reach);
        for ((x, y), z) in xs.iter().zip(ys).zip(zs) {
            let start = DVec3::new(*x, *y, *z);
            let at = m.transform_point3(start);
            (low, high) = (low.min(at), high.max(at));
            most = most.max(start.abs().max_element());
        }
        let [a, b, c] = [m.x_axis, m.y_axis, m.z_axis].map(glam::DVec4::truncate);
        let end = m.transform_point3(centre);
        let extent = (a * a + b * b + c * c).to_array().map(f64::sqrt);
        let extent = DVec3::from_array(extent) * radius;
        let (to_low, to_high) = (end - extent - low, end + extent - high);
        let length = to_low.abs().max(to_high.abs()).max_element().max(f64::MIN_POSITIVE);
        let columns = a.abs() + b.abs() + c.abs();
        let exact = (columns * most + m.w_axis.truncate().abs()) * DOUBLE;
        // Twice that of a ray: two sides move.
        let pad = ((far + low.abs().max(high.abs())) * SINGLE + exact) * 2.0;
        let per = |way: DVec3| {
            (way / length).to_array().map(|part| {
                let part = if part.abs() < LEAST { LEAST.copysign(part) } else { part };
                (1.0 / part) as f32
            })
        };
        Self {
            low: (low - pad).as_vec3().to_array().map(f32::next_down),
            high: (high + pad).as_vec3().to_array().map(f32::next_up),
            per_low: per(to_low),
            per_high: per(to_high),
            end: ((length * (1.0 + SINGLE)) as f32).next_up(),
        }
    }

    /// Returns a bit for each of eight boxes that the hull may meet.
    #[inline(always)]
    fn meeting<S: Simd>(&self, simd: S, boxes: &EightBoxes) -> u64 {
        let mut near = f32x8::splat(simd, 0.0);
        let mut far = f32x8::splat(simd, self.end);
        for axis in 0..3 {
            let [low, high] = [&boxes.rows[0][axis], &boxes.rows[1][axis]];
            // The lower side has to lie below the box's upper side, and the other way round.
            let (per_low, per_high) = (self.per_low[axis], self.per_high[axis]);
            let below = (f32x8::from_slice(simd, high) - self.low[axis]) * per_low;
            let above = (f32x8::from_slice(simd, low) - self.high[axis]) * per_high;
            (near, far) =
                if per_low > 0.0 { (near, far.min(below)) } else { (near.max(below), far) };
            (near, far) =
                if per_high > 0.0 { (near.max(above), far) } else { (near, far.min(above)) };
        }
        far.simd_ge(near).to_bitmask()
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Ray, RayStack};
    use super::*;
    use crate::simd::dispatch;
    use fearless_simd::Level;
    use marraztu_core::base::rng::Rng;
    use marraztu_core::scene::{Mesh, MeshSource, SourceCorner};

    /// Returns a mesh of random triangles, which spreads along x.
    fn soup(rng: &mut Rng) -> Mesh {
        let count = 1 + rng.index(600);
        let size = rng.one_of(&[0.1, 1.0, 6.0]);
        let mut positions = Vec::new();
        for _ in 0..count {
            let at = rng.vector(3.0) * DVec3::new(4.0, 1.0, 1.0);
            positions.extend((0..3).map(|_| (at + rng.vector(size)).as_vec3().to_array()));
        }
        let corners = (0..3 * u32::try_from(count).unwrap()).map(SourceCorner::bare);
        let source = MeshSource::of_polygons(corners, vec![3; count]);
        Mesh::new(MeshSource { positions, ..source }).unwrap()
    }

    #[test]
    fn a_ray_meets_within_its_frontier_what_it_meets_in_all_trees() {
        rayon::scope(|_| {
            let mut rng = Rng::new(7);
            let (mut stopped, mut empty) = ([0_usize; 2], 0);
            for round in 0..300 {
                let meshes: Vec<Mesh> = (0..1 + rng.index(12)).map(|_| soup(&mut rng)).collect();
                let place = |rng: &mut Rng| {
                    let axis = (rng.vector(1.0) + DVec3::splat(1e-3)).normalize_or(DVec3::X);
                    let turn = DMat4::from_axis_angle(axis, rng.real(0.0, 6.0));
                    let scale = DMat4::from_scale(rng.vector(1.0) + DVec3::splat(1.5));
                    DMat4::from_translation(rng.vector(20.0)) * turn * scale
                };
                let things = meshes.iter().map(|mesh| Thing::new(mesh, place(&mut rng)).unwrap());
                let things = Things::new(things.collect());
                // Lights near and far, small and large, also around the points.
                let (away, radius) =
                    rng.one_of(&[(10.0, 0.1), (10.0, 8.0), (1e18, 1e17), (30.0, 60.0)]);
                let (middle, centre) = (rng.vector(15.0), rng.vector(away));
                let patch = rng.one_of(&[0.0, 0.1, 4.0]);
                let points: Vec<DVec3> = (0..16).map(|_| middle + rng.vector(patch)).collect();
                let rows = [0, 1, 2].map(|axis| points.iter().map(|p| p[axis]).collect());
                let rows: [Vec<f64>; 3] = rows;
                let starts = rows.each_ref().map(Vec::as_slice);
                let (mut frontier, mut stack) = (Frontier::default(), RayStack::default());
                let stops = |_: &_| true;
                dispatch!(Level::new(), simd => {
                    frontier.find(simd, &things, &Ends { starts, centre, radius });
                    empty += usize::from(frontier.is_empty());
                    for from in &points {
                        let way = centre + rng.vector(radius / 1.8) - *from;
                        let (towards, distance) = (way.normalize_or_zero(), way.length());
                        let ray = Ray { from: *from, towards, own: None };
                        let all = things.stop(simd, (&ray, distance), &stops, &mut stack);
                        let within = (&ray, distance, &frontier);
                        let some = things.stop_within(simd, within, &stops, &mut stack);
                        assert_eq!(all, some, "round {round}: {from} to {centre}, {radius}");
                        stopped[usize::from(all)] += 1;
                    }
                });
            }
            assert!(stopped.iter().all(|count| *count > 500) && empty > 10, "{stopped:?} {empty}");
        });
    }
}

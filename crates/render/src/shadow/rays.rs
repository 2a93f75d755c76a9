//! The origins of a packet of rays, and the triangles they lie on.

use glam::DVec3;

use super::patches::{Patch, find_patches};
use super::prepared_block::PreparedBlock;
use super::shaft::{POINTS, Shaft};
use crate::accel::BvhChild;
use crate::rays::{Frontier, OwnTriangles, Ray, RayStack};

/// The origins of up to [`POINTS`] rays, in world space, all on one object.
#[derive(Debug)]
pub(crate) struct Origins {
    pub(crate) at: [[f64; POINTS]; 3],
    /// The places of the points in the sequences of samples of lights.
    pub(crate) places: [u32; POINTS],
    /// The caster that the points lie on, if it casts shadows itself.
    pub(crate) caster: Option<u32>,
    /// The range of the caster's triangles that each point lies on: from `first` up to but
    /// excluding `end`.
    pub(crate) first: [u32; POINTS],
    pub(crate) end: [u32; POINTS],
    /// Whether each point lies in the single triangle `first`. If not, the point is exact.
    pub(crate) in_triangle: bool,
    /// The largest coordinate of the points' triangles.
    pub(crate) reach: f64,
    /// The points that were lifted off their triangles, a bit for each. Lifted points are exact.
    pub(super) lifted: u64,
    len: usize,
    /// The points grouped by position; empty before they are grouped.
    pub(super) patches: Vec<Patch>,
}

impl Default for Origins {
    fn default() -> Self {
        Self {
            at: [[0.0; POINTS]; 3],
            places: [0; POINTS],
            caster: None,
            first: [0; POINTS],
            end: [0; POINTS],
            in_triangle: false,
            reach: 0.0,
            lifted: 0,
            len: 0,
            patches: Vec::new(),
        }
    }
}

impl Origins {
    /// Returns the ray from a point in a direction.
    pub(crate) fn ray(&self, i: usize, towards: DVec3) -> Ray {
        let own = self.caster.map(|thing| OwnTriangles {
            thing,
            first: self.first[i],
            end: self.end[i],
            is_rounded: self.in_triangle && self.lifted >> i & 1 == 0,
        });
        Ray { from: self.point(i), towards, own }
    }

    /// Begins a list of points on a caster.
    pub(crate) fn begin(&mut self, caster: Option<u32>, in_triangle: bool) {
        (self.caster, self.in_triangle, self.reach) = (caster, in_triangle, 0.0);
        (self.lifted, self.len) = (0, 0);
        // Patches are only computed if a ray is traced.
        self.patches.clear();
    }

    /// Sets a point, its range of triangles, and its place in the sequences of samples. Points are
    /// set in order.
    #[inline(always)]
    pub(crate) fn set(&mut self, i: usize, at: DVec3, triangles: [u32; 2], place: u32) {
        self.places[i] = place;
        for (row, x) in self.at.iter_mut().zip(at.to_array()) {
            row[i] = x;
        }
        [self.first[i], self.end[i]] = triangles;
        self.len = i + 1;
    }

    /// Moves a point off its triangle, which still does not shade it.
    pub(crate) fn lift(&mut self, i: usize, at: DVec3) {
        let triangles = [self.first[i], self.end[i]];
        self.set(i, at, triangles, self.places[i]);
        self.lifted |= 1 << i;
    }

    /// Returns one of the points.
    #[inline(always)]
    pub(crate) fn point(&self, i: usize) -> DVec3 {
        DVec3::new(self.at[0][i], self.at[1][i], self.at[2][i])
    }

    /// Divides the points into patches. `normal` returns the normal of a point's triangle, if the
    /// point lies in one.
    #[inline(always)]
    pub(super) fn find_patches(&mut self, normal: impl Fn(&Self, usize) -> Option<DVec3>) {
        let len = self.len.clamp(1, POINTS);
        // The unused end of the lists repeats the first point, so lanes need no mask.
        for row in &mut self.at {
            let first = row[0];
            row[len..].fill(first);
        }
        // Taken out of `self`, so `normal` can borrow the points.
        let mut patches = std::mem::take(&mut self.patches);
        find_patches(&self.at, len, |i| normal(self, i), &mut patches);
        self.patches = patches;
    }
}

/// The number of rays in a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RayCount {
    /// The shadow rays that were traced.
    pub traced: u64,
    /// The shadow rays that were blocked.
    pub occluded: u64,
    /// The rays that were mirrored or refracted.
    pub bounced: u64,
}

impl std::ops::AddAssign for RayCount {
    fn add_assign(&mut self, other: Self) {
        self.traced += other.traced;
        self.occluded += other.occluded;
        self.bounced += other.bounced;
    }
}

/// A thread's memory, reused from packet to packet.
#[derive(Debug, Default)]
pub(crate) struct RayScratch {
    /// The rays since the frame began.
    pub(crate) count: RayCount,
    /// Whether the layers of a block are painted: each pixel then shows several surfaces.
    pub(crate) paints_layers: bool,
    pub(crate) origins: Origins,
    pub(super) local: LocalRays,
    pub(super) shaft: Shaft,
    /// The shaft of each patch in world space, if there are many casters.
    pub(super) around_patches: Vec<Shaft>,
    pub(super) prepared: PreparedBlock,
    /// Nodes and leaves that are still to be visited, with the rays that reach them.
    pub(super) stack: Vec<(BvhChild, u64)>,
    /// The same for single rays.
    pub(super) single: RayStack,
    /// The parts of the casters' trees between the points and a light.
    pub(super) frontier: Frontier,
}

/// The rays of a packet in the space of one caster, for ray-box intersection.
#[derive(Debug)]
pub(super) struct LocalRays {
    /// The origins in the space of the caster.
    pub(super) origin: [[f32; POINTS]; 3],
    /// The inverse direction, scaled so its largest component is 1.
    pub(super) inverse: [[f32; POINTS]; 3],
    /// The ray parameter of the light.
    pub(super) end: [f32; POINTS],
    /// The padding of boxes, which covers all f32 errors.
    pub(super) pad: [f32; 3],
    /// The largest coordinate of the origins and of the caster's bounds.
    pub(super) far: f64,
}

impl Default for LocalRays {
    fn default() -> Self {
        let rows = [[0.0; POINTS]; 3];
        Self { origin: rows, inverse: rows, end: [0.0; POINTS], pad: [0.0; 3], far: 0.0 }
    }
}

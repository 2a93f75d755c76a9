//! The points of a packet of rays, and the triangles that they lie on.

use glam::DVec3;

use crate::render::simd::BATCH;
use crate::scene::TreeChild;

/// The origins of up to 64 rays, in world space, all on one object.
#[derive(Debug)]
pub(crate) struct Origins {
    pub(crate) at: [[f64; BATCH]; 3],
    /// The caster that they lie on, if it casts shadows itself.
    pub(crate) caster: Option<u32>,
    /// The triangles of that caster that each lies on: from the first to the one before `end`.
    pub(crate) first: [u32; BATCH],
    pub(crate) end: [u32; BATCH],
    /// Whether each point lies in the one triangle that `first` names. Otherwise it is exact.
    pub(crate) in_triangle: bool,
    /// The largest coordinate of the triangles that they lie in.
    pub(crate) reach: f64,
}

impl Default for Origins {
    fn default() -> Self {
        Self {
            at: [[0.0; BATCH]; 3],
            caster: None,
            first: [0; BATCH],
            end: [0; BATCH],
            in_triangle: false,
            reach: 0.0,
        }
    }
}

impl Origins {
    /// Begins a list of points on a caster.
    pub(crate) const fn begin(&mut self, caster: Option<u32>, in_triangle: bool) {
        (self.caster, self.in_triangle, self.reach) = (caster, in_triangle, 0.0);
    }

    /// Sets a point and the triangles that it lies on.
    #[inline(always)]
    pub(crate) fn set(&mut self, i: usize, at: DVec3, triangles: [u32; 2]) {
        for (row, x) in self.at.iter_mut().zip(at.to_array()) {
            row[i] = x;
        }
        [self.first[i], self.end[i]] = triangles;
    }

    /// One of the points.
    #[inline(always)]
    pub(crate) fn point(&self, i: usize) -> DVec3 {
        DVec3::new(self.at[0][i], self.at[1][i], self.at[2][i])
    }

    /// The points that lie on a triangle of their own caster, a bit for each.
    #[inline(always)]
    pub(crate) fn on(&self, triangle: u32, of: u64) -> u64 {
        let mut on = 0;
        for (i, (first, end)) in self.first.iter().zip(&self.end).enumerate() {
            on |= u64::from((*first <= triangle) & (triangle < *end)) << i;
        }
        on & of
    }
}

/// What a thread keeps from packet to packet.
#[derive(Debug, Default)]
pub(crate) struct RayScratch {
    pub(crate) origins: Origins,
    pub(crate) local: LocalRays,
    /// Nodes and leaves that are still to be visited, with the rays that reach them.
    pub(crate) stack: Vec<(TreeChild, u64)>,
}

/// The rays of a packet in the space of one caster, for its boxes.
#[derive(Debug)]
pub(crate) struct LocalRays {
    /// The origins in world space; those of rays that are not traced repeat one that is.
    pub(crate) at: [[f64; BATCH]; 3],
    /// The same in the space of the caster.
    pub(crate) origin: [[f32; BATCH]; 3],
    /// 1 / direction, which is scaled so that its largest component is 1.
    pub(crate) inverse: [[f32; BATCH]; 3],
    /// The parameter of the light.
    pub(crate) end: [f32; BATCH],
    /// How far boxes are padded, for all errors of f32.
    pub(crate) pad: [f32; 3],
}

impl Default for LocalRays {
    fn default() -> Self {
        let rows = [[0.0; BATCH]; 3];
        let at = [[0.0; BATCH]; 3];
        Self { at, origin: rows, inverse: rows, end: [0.0; BATCH], pad: [0.0; 3] }
    }
}

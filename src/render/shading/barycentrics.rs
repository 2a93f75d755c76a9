//! Barycentric coordinates of pixels in the triangles that they show.
//!
//! First linear on the screen, from integer edge functions; then perspective-correct.
//!
//! Perspective: Heckbert and Moreton, "Interpolation for Polygon Texture Mapping and Shading",
//! 1991.

use glam::DVec3;

use super::fragments::Fragments;
use super::triangle_attributes::{TriangleAttributes, picked};
use crate::render::simd::{BATCH, Kernel, Lanes, Number, Vec3};

/// The barycentric coordinates of a list of fragments.
#[derive(Debug)]
pub(crate) struct Barycentrics<T> {
    /// The second and third barycentric coordinate, linear on the screen.
    pub(crate) linear: [[T; BATCH]; 2],
    /// The same, perspective-correct.
    pub(crate) weights: [[T; BATCH]; 2],
    /// The distance along the observer's axis.
    pub(crate) w: [T; BATCH],
    /// The positions at which they are lit, in pixels; only set if they [share](Fragments::shared)
    /// their pixels.
    pub(crate) positions: [[T; BATCH]; 2],
}

impl<T: Number> Default for Barycentrics<T> {
    fn default() -> Self {
        let row = [T::default(); BATCH];
        Self { linear: [row; 2], weights: [row; 2], w: row, positions: [row; 2] }
    }
}

impl<T: Number> Barycentrics<T> {
    /// The weights of the three corners in fragment `i`.
    pub(crate) fn weights(&self, i: usize) -> DVec3 {
        let (b, c): (f64, f64) = (self.weights[0][i].into(), self.weights[1][i].into());
        DVec3::new(1.0 - b - c, b, c)
    }
}

/// Makes linear coordinates perspective-correct.
pub(super) struct Perspective<'a, T, const PAGES: usize> {
    pub(super) fragments: &'a Fragments,
    pub(super) attributes: &'a TriangleAttributes<T>,
    pub(super) to: &'a mut Barycentrics<T>,
}

impl<T: Number, const PAGES: usize> Kernel<T> for Perspective<'_, T, PAGES> {
    #[inline(always)]
    fn run<M: Lanes<Number = T>>(self, lanes: M) {
        let Self { fragments, attributes, to } = self;
        for at in (0..fragments.len).step_by(M::LANES) {
            let slots = lanes.slots(&fragments.slots, at);
            let linear = [lanes.load(&to.linear[0], at), lanes.load(&to.linear[1], at)];
            let by_w = picked::<M, PAGES>(lanes, &attributes.by_w, slots);
            to.put(lanes, at, linear, by_w);
        }
    }
}

impl<T: Number> Barycentrics<T> {
    /// Makes linear coordinates perspective-correct.
    #[inline(always)]
    pub(super) fn put<M: Lanes<Number = T>>(
        &mut self,
        lanes: M,
        at: usize,
        linear: [M::R; 2],
        by_w: Vec3<M::R>,
    ) {
        let (weights, w) = with_perspective(lanes, linear, by_w);
        lanes.store(w, &mut self.w, at);
        lanes.store(weights[0], &mut self.weights[0], at);
        lanes.store(weights[1], &mut self.weights[1], at);
    }
}

/// m1 = l1 / w1 / (l0 / w0 + l1 / w1 + l2 / w2), and m2 alike; and 1 / the sum, which is the
/// pixel's own w.
#[inline(always)]
pub(crate) fn with_perspective<M: Lanes>(
    lanes: M,
    [second, third]: [M::R; 2],
    Vec3([w0, w1, w2]): Vec3<M::R>,
) -> ([M::R; 2], M::R) {
    let w = lanes.lift(1.0) / (w0 + second * (w1 - w0) + third * (w2 - w0));
    ([second * w1 * w, third * w2 * w], w)
}

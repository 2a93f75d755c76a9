//! Barycentric coordinates of pixels in the triangles that they show.
//!
//! They are first linear on the screen, from integer edge functions; then perspective-correct.

use glam::DVec3;

use super::fragments::Fragments;
use super::triangle_attributes::{TriangleAttributes, picked};
use crate::screen::perspective::weighed;
use crate::simd::{BATCH, Kernel, Lanes, Number, Real, Vec3};
use marraztu_core::accuracy::Interpolation;

/// The barycentric coordinates of a list of fragments.
#[derive(Debug)]
#[repr(align(64))]
pub(crate) struct Barycentrics<T> {
    /// The second and third barycentric coordinate, linear on the screen.
    pub(crate) linear: [[T; BATCH]; 2],
    /// The second and third barycentric coordinate, perspective-correct.
    pub(crate) weights: [[T; BATCH]; 2],
    /// The distance along the observer's axis.
    pub(crate) w: [T; BATCH],
    /// The positions at which fragments are lit, in pixels; only set if fragments
    /// [share](Fragments::shared) their pixels.
    pub(crate) positions: [[T; BATCH]; 2],
}

impl<T: Number> Default for Barycentrics<T> {
    fn default() -> Self {
        let row = [T::default(); BATCH];
        Self { linear: [row; 2], weights: [row; 2], w: row, positions: [row; 2] }
    }
}

impl<T: Number> Barycentrics<T> {
    /// Returns the weights of the three corners in fragment `i`.
    pub(crate) fn weights(&self, i: usize) -> DVec3 {
        let (b, c): (f64, f64) = (self.weights[0][i].into(), self.weights[1][i].into());
        DVec3::new(1.0 - b - c, b, c)
    }

    /// Loads the weights of the second and third corner in some fragments.
    #[inline(always)]
    pub(crate) fn weights_at<M: Lanes<Number = T>>(&self, lanes: M, at: usize) -> [M::R; 2] {
        [lanes.load(&self.weights[0], at), lanes.load(&self.weights[1], at)]
    }
}

/// Converts linear coordinates to perspective-correct weights of corners.
pub(super) struct Weigh<'a, T> {
    pub(super) interpolation: Interpolation,
    /// Whether pixels may have centres outside of their triangles: negative coordinates then become
    /// 0, and the sum stays 1.
    pub(super) clamps: bool,
    pub(super) fragments: &'a Fragments,
    pub(super) attributes: &'a TriangleAttributes<T>,
    pub(super) to: &'a mut Barycentrics<T>,
}

impl<T: Number> Kernel<T> for Weigh<'_, T> {
    #[inline(always)]
    fn run<M: Lanes<Number = T>>(self, lanes: M) {
        let Self { interpolation, clamps, fragments, attributes, to } = self;
        let (zero, one) = (lanes.lift(0.0), lanes.lift(1.0));
        for at in (0..fragments.len).step_by(M::LANES) {
            let slots = lanes.slots((&fragments.slots, attributes.count), at);
            let mut linear = [lanes.load(&to.linear[0], at), lanes.load(&to.linear[1], at)];
            // Coordinates outside of 0 to 1 would extrapolate the attributes.
            if clamps {
                let [second, third] = linear;
                let first = Real::max(one - second - third, zero);
                let (second, third) = (Real::max(second, zero), Real::max(third, zero));
                let per = one / (first + second + third);
                linear = [second * per, third * per];
                lanes.store(linear[0], &mut to.linear[0], at);
                lanes.store(linear[1], &mut to.linear[1], at);
            }
            let by_w = picked(lanes, &attributes.by_w, slots);
            to.put(interpolation, lanes, at, linear, by_w);
        }
    }
}

impl<T: Number> Barycentrics<T> {
    /// Computes and stores the weights for linear coordinates.
    #[inline(always)]
    pub(super) fn put<M: Lanes<Number = T>>(
        &mut self,
        interpolation: Interpolation,
        lanes: M,
        at: usize,
        linear: [M::R; 2],
        by_w: Vec3<M::R>,
    ) {
        let (weights, w) = weighed(interpolation, lanes, linear, by_w);
        lanes.store(w, &mut self.w, at);
        lanes.store(weights[0], &mut self.weights[0], at);
        lanes.store(weights[1], &mut self.weights[1], at);
    }
}

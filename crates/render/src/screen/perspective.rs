//! Turns barycentric coordinates that are linear on the screen into perspective-correct weights,
//! and interpolates attributes with them.
//!
//! Perspective: Heckbert and Moreton, "Interpolation for Polygon Texture Mapping and Shading",
//! 1991.

use crate::simd::{Lanes, Real, Vec3};
use marraztu_core::accuracy::Interpolation;

/// Computes the weights of the second and third corner, and w, from coordinates l that are linear
/// on the screen. With perspective:
///
///   m1 = l1 / w1 / (l0 / w0 + l1 / w1 + l2 / w2), and m2 alike; 1 / the sum is the pixel's w.
///
/// Affine weights are the coordinates themselves. Even then w is exact, because light is computed
/// at the true position.
#[inline(always)]
pub(crate) fn weighed<M: Lanes>(
    interpolation: Interpolation,
    lanes: M,
    [second, third]: [M::R; 2],
    Vec3([w0, w1, w2]): Vec3<M::R>,
) -> ([M::R; 2], M::R) {
    // w0, w1 and w2 are 1 / w of the corners: 1 / w is linear on the screen.
    let w = lanes.lift(1.0) / (w0 + second * (w1 - w0) + third * (w2 - w0));
    match interpolation {
        Interpolation::Affine => ([second, third], w),
        Interpolation::Perspective => ([second * w1 * w, third * w2 * w], w),
    }
}

/// Interpolates an attribute: the first corner's value plus weighted differences to the others.
#[inline(always)]
pub(crate) fn between<R: Real>([a, b, c]: [Vec3<R>; 3], [second, third]: [R; 2]) -> Vec3<R> {
    a.plus(b.times(second)).plus(c.times(third))
}

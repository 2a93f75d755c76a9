//! From barycentric coordinates that are linear on the screen to the weights of corners, and to
//! what they mix.
//!
//! Perspective: Heckbert and Moreton, "Interpolation for Polygon Texture Mapping and Shading",
//! 1991.

use crate::simd::{Lanes, Real, Vec3};
use marraztu_core::accuracy::Interpolation;

/// The weights of the second and the third corner, and w, from coordinates that are linear on the
/// screen. With perspective:
///
///   m1 = l1 / w1 / (l0 / w0 + l1 / w1 + l2 / w2), and m2 alike; and 1 / the sum, which is the
///   pixel's own w.
///
/// Affine weights are the coordinates themselves. The distance is exact nevertheless: what is lit,
/// is lit where it is. Spans of sixteen pixels begin with perspective.
#[inline(always)]
pub(crate) fn weighed<M: Lanes>(
    interpolation: Interpolation,
    lanes: M,
    [second, third]: [M::R; 2],
    Vec3([w0, w1, w2]): Vec3<M::R>,
) -> ([M::R; 2], M::R) {
    let w = lanes.lift(1.0) / (w0 + second * (w1 - w0) + third * (w2 - w0));
    match interpolation {
        Interpolation::Affine => ([second, third], w),
        Interpolation::Perspective | Interpolation::EverySixteen => {
            ([second * w1 * w, third * w2 * w], w)
        }
    }
}

/// The attribute of the first corner, plus the weighted differences of the others from it.
#[inline(always)]
pub(crate) fn between<R: Real>([a, b, c]: [Vec3<R>; 3], [second, third]: [R; 2]) -> Vec3<R> {
    a.plus(b.times(second)).plus(c.times(third))
}

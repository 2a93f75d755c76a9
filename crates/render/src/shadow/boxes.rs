//! Intersects rays with boxes (slab test), in f32.
//!
//! Boxes are padded for all rounding errors: of positions, of the parameters where a ray enters and
//! leaves, and of the transform to object space. No ray misses a box by rounding.
//!
//! Kay and Kajiya, "Ray Tracing Complex Scenes", 1986; Ize, "Robust BVH Ray Traversal", 2013.

use fearless_simd::{Simd, SimdBase as _, SimdMask as _, f32x16};
use glam::{DMat4, DVec3};

use super::rays::LocalRays;
use super::shaft::POINTS;
use marraztu_core::scene::Bounds;

/// The error of a position and of a parameter in f32, relative to the largest coordinate: four
/// roundings, twice.
const SINGLE: f64 = 1.0 / (1 << 21) as f64;

/// The error of a position transformed in f64, relative to the sum of the added terms.
const DOUBLE: f64 = 1.0 / (1_u64 << 47) as f64;

/// The smallest component of a direction, relative to its largest. Over the length of a scene, the
/// contribution of a smaller one is below every pad.
const LEAST: f64 = 1e-30;

/// Returns the pad of boxes in world space, for coordinates up to `far`.
#[expect(clippy::cast_possible_truncation, reason = "rounded up")]
pub(super) fn world_pad(far: f64) -> [f32; 3] {
    [((far * (SINGLE + 2.0 * DOUBLE)) as f32).next_up(); 3]
}

impl LocalRays {
    /// Transforms rays to the space of an object with these bounds. `reach` is the largest
    /// coordinate of both in world space.
    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, reason = "the nearest f32 is meant; pads hold it")]
    pub(super) fn set(
        &mut self,
        object_from_world: &DMat4,
        (at, light): (&[[f64; POINTS]; 3], DVec3),
        (bounds, reach): (Bounds, f64),
    ) {
        let m = object_from_world;
        let end = m.transform_point3(light);
        let (mut ways, mut length, mut largest) = ([[0.0; POINTS]; 3], [0.0; POINTS], DVec3::ZERO);
        // Directions and lengths, axis by axis. The eight maxima are independent, so the loop
        // vectorises.
        for axis in 0..3 {
            let [a, b, c, d] = [m.x_axis[axis], m.y_axis[axis], m.z_axis[axis], m.w_axis[axis]];
            let mut most = [0.0; 8];
            for first in (0..POINTS).step_by(8) {
                for i in first..first + 8 {
                    let from = at[0][i] * a + at[1][i] * b + at[2][i] * c + d;
                    let way = end[axis] - from;
                    self.origin[axis][i] = from as f32;
                    ways[axis][i] = way;
                    length[i] = larger(length[i], way.abs());
                    most[i - first] = larger(most[i - first], from.abs());
                }
            }
            largest[axis] = most.into_iter().fold(0.0, larger);
        }
        // The ray parameter counts along the largest component, so the light is at that component's
        // length.
        for (end, length) in self.end.iter_mut().zip(&length) {
            *end = above((length * (1.0 + SINGLE)) as f32);
        }
        // A zero component is replaced by [`LEAST`]: its inverse stays finite and no NaN can occur.
        for (row, ways) in self.inverse.iter_mut().zip(&ways) {
            for ((inverse, way), length) in row.iter_mut().zip(ways).zip(&length) {
                let part = way / length;
                let part = if part.abs() < LEAST { LEAST.copysign(part) } else { part };
                *inverse = (1.0 / part) as f32;
            }
        }
        // The pad covers the error of the transform and the rounding to f32.
        let columns =
            m.x_axis.truncate().abs() + m.y_axis.abs().truncate() + m.z_axis.abs().truncate();
        let exact = (columns * reach + m.w_axis.truncate().abs()) * DOUBLE;
        let far = bounds.min.abs().max(bounds.max.abs()) + largest;
        let pad = far * SINGLE + exact;
        self.pad = pad.to_array().map(|pad| (pad as f32).next_up());
        self.far = far.max_element();
    }

    /// Returns the rays of a mask that meet a box.
    #[inline(always)]
    pub(super) fn meeting<S: Simd>(
        &self,
        simd: S,
        low: &[f32; 3],
        high: &[f32; 3],
        mask: u64,
    ) -> u64 {
        let mut met = 0;
        for at in (0..POINTS).step_by(16) {
            if mask >> at & 0xffff == 0 {
                continue;
            }
            // Slab test: the ray is inside along all axes between the last entry and the first
            // exit.
            let mut near = f32x16::splat(simd, 0.0);
            let mut far = f32x16::from_slice(simd, &self.end[at..at + 16]);
            for axis in 0..3 {
                let origin = f32x16::from_slice(simd, &self.origin[axis][at..at + 16]);
                let inverse = f32x16::from_slice(simd, &self.inverse[axis][at..at + 16]);
                let low = f32x16::splat(simd, low[axis] - self.pad[axis]);
                let high = f32x16::splat(simd, high[axis] + self.pad[axis]);
                let (a, b) = ((low - origin) * inverse, (high - origin) * inverse);
                near = near.max(a.min(b));
                far = far.min(a.max(b));
            }
            met |= far.simd_ge(near).to_bitmask() << at;
        }
        met & mask
    }
}

/// Returns the larger of two numbers, neither NaN. A comparison and a selection compile to SIMD
/// code.
#[inline(always)]
fn larger(a: f64, b: f64) -> f64 {
    if b > a { b } else { a }
}

/// Returns a number above a positive one, by two f32 steps or slightly more.
#[inline(always)]
fn above(x: f32) -> f32 {
    x * (1.0 + 4.0 * f32::EPSILON) + f32::MIN_POSITIVE
}

//! Prepares eight triangles at a time for the rays to one light, and finds the ones that may block
//! a point of a packet.
//!
//! Each function of [`super::triangle`] is linear in the point. Over the box of all points, with
//! centre C and half edges H, it is at most n . (C - A) + sum |n . H|. A triangle is left out if
//! that bound is negative by more than its error.

use fearless_simd::{Select as _, Simd, SimdBase as _, SimdMask as _, f64x8};
use glam::{DMat4, DVec3};

use super::shaft::Around;
use super::triangle::{Decided, ERROR, OFF_PLANE, Prepared, side};
use crate::accel::{BVH_BLOCK, BvhBlock};
use crate::rays::Corners;
use crate::simd::Vec3;
use marraztu_core::base::math::each;

/// Eight prepared triangles. Each row is one cache line.
#[derive(Debug, Default)]
#[repr(align(64))]
pub(crate) struct PreparedBlock {
    /// For each corner and axis the coordinates in world space.
    corners: [[[f64; BVH_BLOCK]; 3]; 3],
    /// The normals of the planes through the light and each edge, and of the triangle's plane: see
    /// [`Prepared`].
    normals: [[[f64; BVH_BLOCK]; 3]; 4],
    /// The errors of the edge functions, and of the plane's with that of the points.
    errors: [[f64; BVH_BLOCK]; 4],
}

/// One vector of each of eight triangles.
type Eight<S> = Vec3<f64x8<S>>;

#[inline(always)]
fn largest<S: Simd>(Vec3(v): Eight<S>) -> f64x8<S> {
    v[0].abs().max(v[1].abs()).max(v[2].abs())
}

/// Returns the largest component of vectors enlarged by an extent.
#[inline(always)]
fn farthest<S: Simd>(Vec3([x, y, z]): Eight<S>, extent: DVec3) -> f64x8<S> {
    (x.abs() + extent.x).max(y.abs() + extent.y).max(z.abs() + extent.z)
}

/// Repeats one vector for all lanes.
#[inline(always)]
fn all<S: Simd>(simd: S, v: DVec3) -> Eight<S> {
    Vec3([f64x8::splat(simd, v.x), f64x8::splat(simd, v.y), f64x8::splat(simd, v.z)])
}

/// Transforms corners to world space with the arithmetic of [`DMat4::transform_point3`]: all parts
/// of the renderer must see the same bits.
#[inline(always)]
fn placed<S: Simd>(simd: S, world_from_object: &DMat4, corner: &[[f32; BVH_BLOCK]; 3]) -> Eight<S> {
    let m = world_from_object;
    let mut wide = [[0.0; BVH_BLOCK]; 3];
    for (wide, row) in wide.iter_mut().zip(corner) {
        for (wide, x) in wide.iter_mut().zip(row) {
            *wide = f64::from(*x);
        }
    }
    let [x, y, z] = [
        f64x8::from_slice(simd, &wide[0]),
        f64x8::from_slice(simd, &wide[1]),
        f64x8::from_slice(simd, &wide[2]),
    ];
    Vec3(each(
        [0, 1, 2],
        #[inline(always)]
        |axis: usize| {
            let [a, b, c] = [m.x_axis[axis], m.y_axis[axis], m.z_axis[axis]];
            // The order of the sums is glam's.
            z * c + (y * b + x * a) + m.w_axis[axis]
        },
    ))
}

impl PreparedBlock {
    /// Prepares the triangles of a block for the points in a box. `reach` is the largest coordinate
    /// of the points' own triangles; within `flat` of a plane, exact arithmetic decides. Returns a
    /// bit mask of the triangles that may block a point.
    #[inline(always)]
    pub(super) fn set<S: Simd>(
        &mut self,
        simd: S,
        (block, world_from_object): (&BvhBlock, &DMat4),
        (around, light): (&Around, DVec3),
        (reach, flat): (f64, f64),
    ) -> u64 {
        let [a, b, c] = [
            placed(simd, world_from_object, &block.corners[0]),
            placed(simd, world_from_object, &block.corners[1]),
            placed(simd, world_from_object, &block.corners[2]),
        ];
        store(&mut self.corners, [a, b, c]);
        let to = all(simd, light);
        // Edge vectors and the plane's normal. `size` scales the error bounds.
        let (ab, bc, ca) = (b.minus(a), c.minus(b), a.minus(c));
        let plane = ab.cross(c.minus(a));
        let size = largest(ab) * largest(ca);
        let to_light = to.minus(a);
        let (sign, sided) = self.sign(simd, plane.dot(to_light), size * largest(to_light), light);
        // The planes through the light and each edge, with the sign that is positive between.
        let (from_a, from_b, from_c) = (a.minus(to), b.minus(to), c.minus(to));
        let normals = [
            from_a.cross(ab).times(sign),
            from_b.cross(bc).times(sign),
            from_c.cross(ca).times(sign),
            plane.times(sign),
        ];
        store(&mut self.normals, normals);
        // The error of each function grows with the distance of the points from the corner.
        let (centre, extent) = (all(simd, around.centre), around.extent());
        let middle = [centre.minus(a), centre.minus(b), centre.minus(c)];
        let far =
            [farthest(middle[0], extent), farthest(middle[1], extent), farthest(middle[2], extent)];
        let errors = [
            largest(from_a) * largest(ab) * ERROR * far[0],
            largest(from_b) * largest(bc) * ERROR * far[1],
            largest(from_c) * largest(ca) * ERROR * far[2],
            // The length of the plane's normal is at most three times `size`.
            size * (far[0] * ERROR + (6.0 * OFF_PLANE * reach + 3.0 * flat)),
        ];
        // The largest value of each function over the box; see the module for the formula.
        let halves =
            [all(simd, around.halves[0]), all(simd, around.halves[1]), all(simd, around.halves[2])];
        let mut possible = sided;
        for i in 0..4 {
            errors[i].store_slice(&mut self.errors[i]);
            let spread = normals[i].dot(halves[0]).abs()
                + normals[i].dot(halves[1]).abs()
                + normals[i].dot(halves[2]).abs();
            let most = normals[i].dot(middle[i % 3]) + spread;
            // A comparison with NaN or infinity is false, so such triangles are kept.
            possible &= !most.simd_lt(errors[i] * -4.0).to_bitmask();
        }
        possible
    }

    /// Returns the sign of each triangle's functions, and the triangles that have a sign: the light
    /// is not in their plane.
    #[inline(always)]
    fn sign<S: Simd>(
        &self,
        simd: S,
        of_light: f64x8<S>,
        size: f64x8<S>,
        light: DVec3,
    ) -> (f64x8<S>, u64) {
        let (one, zero) = (f64x8::splat(simd, 1.0), f64x8::splat(simd, 0.0));
        // The sign makes the plane function positive on the side away from the light.
        let sign = of_light.simd_gt(zero).select(-one, one);
        let sure = of_light.abs().simd_gt(size * ERROR).to_bitmask();
        if sure == (1 << BVH_BLOCK) - 1 {
            return (sign, sure);
        }
        // The light almost lies in some of the planes: exact arithmetic finds its sides.
        let mut signs = [0.0; BVH_BLOCK];
        sign.store_slice(&mut signs);
        let sided = sure | self.settle(light, sure, &mut signs);
        (f64x8::from_slice(simd, &signs), sided)
    }

    /// Decides by exact arithmetic on which side of each plane the light is, for the triangles
    /// outside the mask `sure`. Returns the triangles that do not contain the light in their plane.
    #[inline(never)]
    fn settle(&self, light: DVec3, sure: u64, signs: &mut [f64; BVH_BLOCK]) -> u64 {
        let mut sided = 0;
        for i in (0..BVH_BLOCK).filter(|i| sure >> i & 1 == 0) {
            let of_light = side(&self.corners_of(i), light);
            signs[i] = if of_light > 0.0 { -1.0 } else { 1.0 };
            sided |= u64::from(of_light != 0.0) << i;
        }
        sided
    }

    /// Returns the corners of a triangle in world space.
    fn corners_of(&self, i: usize) -> Corners {
        self.corners.map(|rows| DVec3::from_array(rows.map(|row| row[i])))
    }

    /// Decides which triangles of a mask block the ray from a point to the light.
    #[inline(always)]
    pub(super) fn decide<S: Simd>(&self, simd: S, p: DVec3, of: u64) -> Decided {
        let p = all(simd, p);
        let (mut between, mut possible) = (of, of);
        // The plane first: most points are on the light's side and need no other test.
        for i in [3, 0, 1, 2] {
            if possible == 0 {
                break;
            }
            let (corner, normal) = (&self.corners[i % 3], &self.normals[i]);
            let from = p.minus(rows(simd, corner));
            let error = f64x8::from_slice(simd, &self.errors[i]);
            let value = from.dot(rows(simd, normal));
            between &= value.simd_gt(error).to_bitmask();
            possible &= value.simd_ge(-error).to_bitmask();
        }
        // After an early exit, `between` still holds triangles with untested functions.
        between &= possible;
        Decided { between, open: possible & !between }
    }

    /// Returns one of the triangles.
    pub(super) fn triangle(&self, i: usize) -> Prepared {
        let vector = |rows: &[[f64; BVH_BLOCK]; 3]| DVec3::new(rows[0][i], rows[1][i], rows[2][i]);
        let [a, b, c] = &self.corners;
        let [d, e, f, _] = &self.normals;
        Prepared { corners: each([a, b, c], vector), normals: each([d, e, f], vector) }
    }
}

#[inline(always)]
fn rows<S: Simd>(simd: S, [x, y, z]: &[[f64; BVH_BLOCK]; 3]) -> Eight<S> {
    Vec3([f64x8::from_slice(simd, x), f64x8::from_slice(simd, y), f64x8::from_slice(simd, z)])
}

#[inline(always)]
fn store<S: Simd, const N: usize>(to: &mut [[[f64; BVH_BLOCK]; 3]; N], vectors: [Eight<S>; N]) {
    // By index: moving vectors through iterators takes them through memory.
    for i in 0..N {
        let Vec3([x, y, z]) = vectors[i];
        x.store_slice(&mut to[i][0]);
        y.store_slice(&mut to[i][1]);
        z.store_slice(&mut to[i][2]);
    }
}

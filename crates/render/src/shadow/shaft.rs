//! Bounds a packet of rays as a whole, because it misses most boxes of a BVH.
//!
//! The points of a packet lie in a box along their surface ([`Around`]). Its rays fill the convex
//! hull of that box and of the smaller box that remains at the light. A [`Shaft`] is that hull,
//! bounded by sixteen planes: eight along the rays, two across, and the six sides of its bounds. A
//! box beyond one of the planes meets no ray; sixteen lanes test all planes at once.
//!
//! Planes are rounded to f32 before their offsets are computed, and boxes are f32 numbers. Only the
//! sum of three products is therefore rounded, and the offsets include its error.
//!
//! Reshetov, Soupikov and Hurley, "Multi-Level Ray Tracing Algorithm", 2005; Haines and Wallace,
//! "Shaft Culling for Efficient Ray-Traced Radiosity", 1991.

use fearless_simd::{Simd, SimdBase as _, SimdMask as _, f32x16};
use glam::{DMat4, DVec3, Vec3};

use marraztu_core::base::math::{each, unit};

/// The largest number of rays in a packet: each has a bit in a mask of 64.
pub(crate) const POINTS: usize = 64;

/// An oriented box around the points of a packet.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Around {
    pub(super) centre: DVec3,
    /// Half of each edge.
    pub(super) halves: [DVec3; 3],
}

/// The margin of a box, relative to its size and to the largest coordinate.
const WIDER: f64 = 1.0 / (1 << 30) as f64;
const ROUNDED: f64 = 1.0 / (1_u64 << 44) as f64;

impl Around {
    /// Computes a box around points, aligned with the plane of a normal and a direction in it.
    #[inline(always)]
    pub(super) fn new(at: &[[f64; POINTS]; 3], normal: DVec3, along: DVec3) -> Self {
        let normal = unit(normal).unwrap_or(DVec3::Z);
        let across = unit(normal.cross(along)).unwrap_or_else(|| normal.any_orthonormal_vector());
        let axes = [across.cross(normal), across, normal];
        // Coordinates are taken relative to the first point, which keeps their digits.
        let first = DVec3::new(at[0][0], at[1][0], at[2][0]);
        let (mut centre, mut lengths) = (first, [0.0; 3]);
        for (axis, length) in axes.iter().zip(&mut lengths) {
            // Eight independent minima and maxima, so the loop vectorises.
            let (mut low, mut high) = ([0.0; 8], [0.0; 8]);
            for i in (0..POINTS).step_by(8) {
                for j in 0..8 {
                    let x = (at[0][i + j] - first.x) * axis.x
                        + (at[1][i + j] - first.y) * axis.y
                        + (at[2][i + j] - first.z) * axis.z;
                    low[j] = if x < low[j] { x } else { low[j] };
                    high[j] = if x > high[j] { x } else { high[j] };
                }
            }
            let low = low.into_iter().fold(0.0, f64::min);
            let high = high.into_iter().fold(0.0, f64::max);
            centre += axis * low.midpoint(high);
            *length = (high - low) * 0.5;
        }
        let longest = lengths.iter().copied().fold(0.0, f64::max);
        // The margin covers the rounding of the axes and of the coordinates.
        let more = longest * WIDER + (first.abs().max_element() + longest) * ROUNDED;
        let halves = each([0, 1, 2], |i: usize| axes[i] * (lengths[i] + more));
        Self { centre, halves }
    }

    /// Returns the half extent along each axis of the world.
    #[inline(always)]
    pub(super) fn extent(&self) -> DVec3 {
        self.halves.iter().fold(DVec3::ZERO, |sum, half| sum + half.abs())
    }

    /// Returns the largest coordinate.
    pub(super) fn farthest(&self) -> f64 {
        (self.centre.abs() + self.extent()).max_element()
    }
}

/// The number of planes of a shaft.
const PLANES: usize = 16;

/// Planes with all rays of a packet behind them, in the space of a caster.
#[derive(Debug, Default)]
pub(crate) struct Shaft {
    normals: [[f32; PLANES]; 3],
    offsets: [f32; PLANES],
}

/// The largest coordinate and the largest opening at which f32 sums of products do not overflow.
const FARTHEST: f64 = 1e30;
const WIDEST: f64 = 1e3;

/// The cosine of 45 degrees.
const DIAGONAL: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// The eight directions across the rays that bound a shaft.
const ACROSS: [[f64; 2]; 8] = [
    [1.0, 0.0],
    [DIAGONAL, DIAGONAL],
    [0.0, 1.0],
    [-DIAGONAL, DIAGONAL],
    [-1.0, 0.0],
    [-DIAGONAL, -DIAGONAL],
    [0.0, -1.0],
    [DIAGONAL, -DIAGONAL],
];

impl Shaft {
    /// Sets the shaft from a box around points to a light. `far` is the largest coordinate of the
    /// caster's bounds and of the points, and `pad` the error of both along each axis of the
    /// caster's space.
    ///
    /// Let C be the centre of the box, H its half edges, W the vector to the light, and s the share
    /// of W that is inside the bounds. Along a normal n, the rays reach at most
    ///
    /// ```text
    /// max(n . C + sum |n . H|,   n . (C + s W) + (1 - s) sum |n . H|)
    /// ```
    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, reason = "the nearest f32 is meant; pads hold it")]
    pub(super) fn set(
        &mut self,
        object_from_world: &DMat4,
        (around, light): (&Around, DVec3),
        (far, pad): (f64, [f32; 3]),
    ) {
        let m = object_from_world;
        let centre = m.transform_point3(around.centre);
        let [a, b, c] = each(around.halves, |half| m.transform_vector3(half));
        let way = m.transform_point3(light) - centre;
        let length = way.length();
        // Beyond 8 times the largest coordinate, rays meet no box of the caster.
        let share = (8.0 * far / length).min(1.0);
        let along = way / length;
        // Planes turn with the box: `right` follows one of its edges.
        let flat = a - along * along.dot(a);
        let right = unit(flat).unwrap_or_else(|| along.any_orthonormal_vector());
        let up = along.cross(right);
        let spread = |n: DVec3| n.dot(a).abs() + n.dot(b).abs() + n.dot(c).abs();
        // Planes along the rays are tilted by the opening of the shaft, so they touch box and
        // light.
        let plane = |i: usize| match i {
            // A normal of zero excludes no box.
            _ if far > FARTHEST => DVec3::ZERO,
            0..8 => {
                let across = right * ACROSS[i][0] + up * ACROSS[i][1];
                let opening = spread(across) / length;
                if opening < WIDEST { across + along * opening } else { DVec3::ZERO }
            }
            8 => along,
            9 => -along,
            _ => DVec3::AXES[(i - 10) % 3] * if i < 13 { 1.0 } else { -1.0 },
        };
        // Offsets are computed from the rounded normals, in f64, and rounded up.
        for i in 0..PLANES {
            let normal = plane(i).as_vec3();
            let n = normal.as_dvec3();
            let (spread, at) = (spread(n), n.dot(centre));
            let most = (at + spread).max(at + share * n.dot(way) + (1.0 - share) * spread);
            let error = normal.abs().dot(Vec3::from_array(pad));
            self.offsets[i] = (most as f32).next_up() + error * 2.0;
            for (row, x) in self.normals.iter_mut().zip(normal.to_array()) {
                row[i] = x;
            }
        }
    }

    /// Returns whether no ray of the packet meets a box.
    #[inline(always)]
    pub(super) fn misses<S: Simd>(&self, simd: S, low: &[f32; 3], high: &[f32; 3]) -> bool {
        // The corner of the box that is farthest behind each plane decides.
        let mut least = f32x16::splat(simd, 0.0);
        for axis in 0..3 {
            let normal = f32x16::from_slice(simd, &self.normals[axis]);
            least += (normal * low[axis]).min(normal * high[axis]);
        }
        least.simd_gt(f32x16::from_slice(simd, &self.offsets)).any_true()
    }
}

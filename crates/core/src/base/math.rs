//! Vectors, matrices and projections, and their conventions.
//!
//! * Right-handed, Y up; vectors are columns and matrices multiply from the left: `p' = M p`.
//! * Spaces, in the order of the pipeline: object, world, view (the observer looks along -Z), clip
//!   (homogeneous), screen (pixels, x to the right, y down, pixel centres at one half). A matrix is
//!   named `to_from`: `clip_from_view * view_from_world`.
//! * Depth after division is reversed: 1 at the near plane, 0 at the far plane. Inside the view
//!   volume, `0 <= z <= w`, `-w <= x <= w`, `-w <= y <= w`.
//! * The front of a polygon is the side from which its corners run counter-clockwise.
//! * Angles are radians here, degrees in the interface and in files.
//!
//! Sines and cosines, including glam's, come from the `libm` crate, so every machine computes the
//! same bits.

use glam::{DMat3, DMat4, DVec2, DVec3, DVec4};
use serde::{Deserialize, Serialize};

use super::image::Size;

/// One of the three axes of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Axis {
    /// To the right.
    X,
    /// Up.
    Y,
    /// Towards the observer.
    Z,
}

impl Axis {
    /// All three, in order.
    pub const ALL: [Self; 3] = [Self::X, Self::Y, Self::Z];

    /// Returns the unit vector of the axis.
    pub const fn unit(self) -> DVec3 {
        match self {
            Self::X => DVec3::X,
            Self::Y => DVec3::Y,
            Self::Z => DVec3::Z,
        }
    }

    /// Returns the index of the axis: 0, 1 or 2.
    pub const fn index(self) -> usize {
        self as usize
    }
}

/// Applies `f` to each of three values.
///
/// In SIMD code, the array's own `map` is not always inlined, and every operation becomes a call.
#[inline(always)]
pub fn each<A, B>([a, b, c]: [A; 3], mut f: impl FnMut(A) -> B) -> [B; 3] {
    [f(a), f(b), f(c)]
}

/// Normalises a vector of any length; `None` if it is zero or not finite.
///
/// The largest component is scaled to 1 first, so squares neither overflow nor vanish.
pub fn unit(v: DVec3) -> Option<DVec3> {
    let largest = v.abs().max_element();
    if !(largest > 0.0 && v.is_finite()) {
        return None;
    }
    // Two divisions, since a subnormal component has no finite reciprocal.
    let v = v / largest;
    Some(v / v.length())
}

/// Returns the rotation about `axis` (of length 1) by the right-hand rule.
///
/// Rodrigues' formula: `R = cos a I + sin a [k]x + (1 - cos a) k k'`.
pub fn rotation(axis: DVec3, radians: f64) -> DMat3 {
    DMat3::from_axis_angle(axis, radians)
}

/// Builds a right-handed frame with Z along `z` and Y as near to `y` as possible (Gram-Schmidt, Z
/// first, X = Y x Z). If both are parallel or one of them vanishes, the undetermined axes come from
/// `fallback`, which must be orthonormal.
pub fn frame(z: DVec3, y: DVec3, fallback: DMat3) -> DMat3 {
    let z = unit(z).unwrap_or(fallback.z_axis);
    // If the part of y across z is shorter than its rounding error, its direction is arbitrary.
    let across = |v: DVec3| {
        let v = unit(v)?;
        let rest = v - z * v.dot(z);
        if rest.length() > 1e-12 { unit(rest - z * rest.dot(z)) } else { None }
    };
    let y = across(y).unwrap_or_else(|| {
        // X = Y x Z, so Y = Z x X.
        across(z.cross(fallback.x_axis))
            .or_else(|| across(fallback.y_axis))
            .unwrap_or_else(|| z.any_orthonormal_vector())
    });
    DMat3::from_cols(y.cross(z), y, z)
}

/// Returns the frame of an observer at `eye` that looks at `target`, upright with respect to `up`.
///
/// If the observer looks straight up or down, the right vector of `last` is kept; if eye and target
/// are equal, all of `last` is. The frame never contains NaN and never jumps.
pub fn look_at(eye: DVec3, target: DVec3, up: DVec3, last: DMat3) -> DMat3 {
    let Some(z) = unit(eye - target) else { return last };
    let x = unit(up.cross(z)).filter(|_| unit(up).is_some_and(|up| up.cross(z).length() > 1e-6));
    match x {
        Some(x) => frame(z, z.cross(x), last),
        None => frame(z, z.cross(last.x_axis), last),
    }
}

/// Returns the matrix that transforms normals if `m` transforms surfaces: sign(det m) times its
/// cofactors.
///
/// This is the inverse transpose up to a positive factor, and is defined for a singular `m` as
/// well. The sign keeps the normals of a mirrored object on its outer side. `m` is scaled by
/// [`at_power_of_two`] first, so the squares of normals neither overflow nor vanish, even in f32.
pub fn normal_matrix(m: DMat3) -> DMat3 {
    let m = at_power_of_two(m);
    let cofactors = DMat3::from_cols(
        m.y_axis.cross(m.z_axis),
        m.z_axis.cross(m.x_axis),
        m.x_axis.cross(m.y_axis),
    );
    if m.determinant() < 0.0 { cofactors * -1.0 } else { cofactors }
}

/// Scales `m` by a power of two that brings its largest entry between 1/2 and 1.
pub fn at_power_of_two(m: DMat3) -> DMat3 {
    m * power_of_two_near(1.0 / largest_entry(m))
}

/// Returns the largest power of two that is at most `x`, for a normal `x` above 0; otherwise 1.
/// Multiplying a number by it keeps all digits.
pub fn power_of_two_near(x: f64) -> f64 {
    if x.is_normal() && x > 0.0 { libm::ldexp(1.0, libm::ilogb(x)) } else { 1.0 }
}

fn largest_entry(m: DMat3) -> f64 {
    m.x_axis.abs().max(m.y_axis.abs()).max(m.z_axis.abs()).max_element()
}

/// Returns whether `m` has rank 3, relative to its own size.
pub fn has_full_rank(m: DMat3) -> bool {
    let size = largest_entry(m);
    m.is_finite() && size > 0.0 && ((m * (1.0 / size)).determinant().abs() > 1e-15)
}

/// Returns the perspective projection. `half_angle` (radians) is visible to each side of the view
/// axis across the shorter side of the picture; the longer side shows more. Depth is 1 at `near`, 0
/// at `far`.
pub fn perspective(half_angle: f64, near: f64, far: f64, size: Size) -> DMat4 {
    let focal = 1.0 / libm::tan(half_angle);
    let DVec2 { x, y } = shorter_side(size) * focal;
    let range = far - near;
    DMat4::from_cols(
        DVec4::new(x, 0.0, 0.0, 0.0),
        DVec4::new(0.0, y, 0.0, 0.0),
        DVec4::new(0.0, 0.0, near / range, -1.0),
        DVec4::new(0.0, 0.0, near * far / range, 0.0),
    )
}

/// Returns the orthographic projection. `half_size` is visible to each side of the view axis across
/// the shorter side of the picture. Depth is 1 at `near`, 0 at `far`.
pub fn orthographic(half_size: f64, near: f64, far: f64, size: Size) -> DMat4 {
    let DVec2 { x, y } = shorter_side(size) / half_size;
    let range = far - near;
    DMat4::from_cols(
        DVec4::new(x, 0.0, 0.0, 0.0),
        DVec4::new(0.0, y, 0.0, 0.0),
        DVec4::new(0.0, 0.0, 1.0 / range, 0.0),
        DVec4::new(0.0, 0.0, far / range, 1.0),
    )
}

/// Returns the factors of x and y with which the shorter side of the picture spans -1 to 1.
#[expect(clippy::cast_precision_loss, reason = "pictures have fewer than 2^53 pixels a side")]
pub(crate) fn shorter_side(size: Size) -> DVec2 {
    let (width, height) = (size.width as f64, size.height as f64);
    let shorter = width.min(height);
    DVec2::new(shorter / width, shorter / height)
}

/// Returns the matrix of a frame at a position.
pub fn placed(axes: DMat3, origin: DVec3) -> DMat4 {
    DMat4::from_mat3_translation(axes, origin)
}

/// Returns whether all numbers of two matrices have the same bits.
pub fn same_bits(a: &DMat4, b: &DMat4) -> bool {
    a.to_cols_array().map(f64::to_bits) == b.to_cols_array().map(f64::to_bits)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_vector_of_any_length_is_normalised() {
        for length in [1e-310, 1e-200, 1e-23, 1.0, 1e20, 1e300] {
            let v = unit(DVec3::new(3.0, 0.0, -4.0) * length).unwrap();
            assert!((v - DVec3::new(0.6, 0.0, -0.8)).length() < 1e-12, "{length}: {v}");
        }
        assert_eq!(unit(DVec3::ZERO), None);
        assert_eq!(unit(DVec3::new(f64::NAN, 0.0, 1.0)), None);
    }

    #[test]
    fn a_quarter_turn_about_y_takes_z_to_x() {
        let turned = rotation(DVec3::Y, std::f64::consts::FRAC_PI_2) * DVec3::Z;
        assert!((turned - DVec3::X).length() < 1e-15);
    }

    #[test]
    fn depth_is_one_at_the_near_plane_and_zero_at_the_far_one() {
        let size = Size::new(800, 600);
        for clip_from_view in
            [perspective(0.4, 1.0, 2000.0, size), orthographic(5.0, 1.0, 2000.0, size)]
        {
            let depth = |distance: f64| {
                let p = clip_from_view * DVec4::new(0.0, 0.0, -distance, 1.0);
                p.z / p.w
            };
            assert!((depth(1.0) - 1.0).abs() < 1e-12);
            assert!(depth(2000.0).abs() < 1e-12);
        }
    }

    #[test]
    fn the_half_angle_spans_the_shorter_side() {
        let clip_from_view = perspective(22.5_f64.to_radians(), 1.0, 2000.0, Size::new(1600, 800));
        let edge = DVec4::new(0.0, 100.0 * libm::tan(22.5_f64.to_radians()), -100.0, 1.0);
        let p = clip_from_view * edge;
        assert!((p.y / p.w - 1.0).abs() < 1e-12);
        let p = clip_from_view * DVec4::new(edge.y, 0.0, -100.0, 1.0);
        assert!((p.x / p.w - 0.5).abs() < 1e-12, "the longer side sees more");
    }

    #[test]
    fn looking_straight_down_keeps_the_last_right_vector() {
        let last = rotation(DVec3::Y, 0.3);
        let axes = look_at(DVec3::Y * 9.0, DVec3::ZERO, DVec3::Y, last);
        assert!((axes.x_axis - last.x_axis).length() < 1e-12);
        assert!((axes.z_axis - DVec3::Y).length() < 1e-12);
        assert_eq!(look_at(DVec3::ONE, DVec3::ONE, DVec3::Y, last), last);
    }

    #[test]
    fn a_power_of_two_near_a_number_is_at_most_that_number() {
        for (x, near) in
            [(1.0, 1.0), (1.99, 1.0), (2000.0, 1024.0), (0.3, 0.25), (1e300, 2.0_f64.powi(996))]
        {
            assert_eq!(power_of_two_near(x), near);
        }
        for x in [0.0, -4.0, f64::NAN, f64::INFINITY] {
            assert_eq!(power_of_two_near(x), 1.0);
        }
    }

    #[test]
    fn normals_of_objects_of_any_size_are_neither_huge_nor_zero() {
        for size in [1e-200, 1e-30, 1e-12, 1.0, 1e12, 1e30, 1e150] {
            let n =
                normal_matrix(DMat3::from_diagonal(DVec3::new(1.0, 1.5, 0.7) * size)) * DVec3::Y;
            assert!((0.05..4.0).contains(&n.length()), "{size}: {n}");
        }
    }

    #[test]
    fn normals_of_a_mirrored_and_stretched_surface_stay_perpendicular_and_outside() {
        let m = DMat3::from_diagonal(DVec3::new(-2.0, 1.0, 10.0));
        let (along, across) = (DVec3::new(1.0, -1.0, 0.0), DVec3::new(1.0, 1.0, 0.0));
        let n = normal_matrix(m) * across;
        assert!((m * along).dot(n).abs() < 1e-12);
        assert!(n.dot(m * across) > 0.0);
    }
}

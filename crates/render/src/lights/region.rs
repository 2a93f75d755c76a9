//! Regions: bounds of positions in view space, for light culling.
//!
//! A region is the convex hull of eight points, plus the largest distance of a computed position
//! outside. Every statement about a region holds for every position as computed, in f32 or in f64,
//! because all bounds are rounded outwards.

use glam::{DMat4, DVec3};

/// The relative error of a computed position, including the subtraction of a light's position:
/// about 10 times the rounding of f32.
const ROUNDING: f64 = 2e-6;

/// The error of a computed cosine: about 10 times the largest measured error.
const COSINE_ROUNDING: f64 = 4e-6;

/// The smallest distance of a region's centre from a cone's axis, relative to its distance from the
/// apex. Closer to the axis, the direction away from it is only a rounding error.
const LEAST_ASIDE: f64 = 1e-6;

/// The cosine up to which light along a face may count as coming from either side.
pub(crate) const EDGE_ON: f64 = 1e-4;

/// The convex hull of eight positions in view space, and the error of others around it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Region {
    corners: [DVec3; 8],
    error: f64,
    /// The largest distance of a corner from the origin.
    reach: f64,
}

impl Region {
    /// Creates the hull of these points, with positions up to `error` outside.
    pub(crate) fn new(corners: [DVec3; 8], error: f64) -> Self {
        let reach = corners.iter().map(|corner| corner.length()).fold(0.0, f64::max);
        Self { corners, error, reach }
    }

    /// Creates the hull of points in object space.
    pub(crate) fn placed(view_from_object: DMat4, corners: [DVec3; 8], error: f64) -> Self {
        Self::new(corners.map(|corner| view_from_object.transform_point3(corner)), error)
    }

    /// Returns the largest distance of a corner from the origin.
    pub(crate) const fn reach(&self) -> f64 {
        self.reach
    }

    /// Returns the error of the vector from a light to a position.
    fn error_from(&self, light: DVec3) -> f64 {
        self.error + ROUNDING * (self.reach + light.length())
    }

    /// Returns whether a face with this normal (of length 1) is turned away from a light, anywhere
    /// in the region.
    pub(crate) fn faces_away(&self, normal: DVec3, light: DVec3) -> bool {
        let error = self.error_from(light);
        self.corners.iter().all(|corner| {
            let offset = light - *corner;
            // The margin covers the error of positions and light that grazes the face.
            normal.dot(offset) < -(error + EDGE_ON * offset.length())
        })
    }

    /// Returns a lower bound of the distance from a point to every position; 0 if no bound is
    /// known.
    pub(crate) fn least_distance(&self, from: DVec3) -> f64 {
        let low = self.corners.iter().fold(DVec3::INFINITY, |low, corner| low.min(*corner));
        let high = self.corners.iter().fold(DVec3::NEG_INFINITY, |high, corner| high.max(*corner));
        // The axis-aligned box contains the hull, so its distance is a lower bound.
        let to_box = (from.clamp(low, high) - from).length();
        let least = to_box - self.error_from(from);
        // NaN gives the bound 0.
        if least > 0.0 { least } else { 0.0 }
    }

    /// Returns an upper bound of the cosine between `axis` (of length 1) and the direction from
    /// `apex` to any position; 1 if no bound is known.
    ///
    /// The bound uses a ball around the corners, with radius r at the distance d: the angle to its
    /// centre, minus asin(r / d).
    pub(crate) fn most_cosine(&self, apex: DVec3, axis: DVec3) -> f64 {
        let middle = self.corners.iter().sum::<DVec3>() / 8.0;
        let radius = self.corners.iter().map(|corner| corner.distance(middle)).fold(0.0, f64::max);
        let (radius, offset) = (radius + self.error_from(apex), middle - apex);
        let distance = offset.length();
        if distance > radius {
            let angle = libm::acos((axis.dot(offset) / distance).clamp(-1.0, 1.0));
            let least = (angle - libm::asin(radius / distance)).max(0.0);
            (libm::cos(least) + COSINE_ROUNDING).min(1.0)
        } else {
            // The apex is inside the ball, or NaN.
            1.0
        }
    }

    /// Returns whether no position lies in the cone around `axis` (of length 1) from `apex` with
    /// the half-angle acos `border`. The border counts as outside.
    ///
    /// The proof is either the bound of the cosine, or a plane through the apex that touches the
    /// cone with all corners on its other side.
    pub(crate) fn misses_cone(&self, apex: DVec3, axis: DVec3, border: f64) -> bool {
        if self.most_cosine(apex, axis) <= border {
            return true;
        }
        // Computed cosines may be slightly too large, so the cone is widened.
        let wider = border - COSINE_ROUNDING;
        if wider <= 0.0 {
            // A cone this wide is not convex: no plane touches it.
            return false;
        }
        let sine = (1.0 - wider * wider).max(0.0).sqrt();
        let error = self.error_from(apex);
        // The hull lies beyond a plane if all of its corners do.
        let beyond = |normal: DVec3| {
            let apart = |corner: &DVec3| normal.dot(*corner - apex);
            self.corners.iter().all(|corner| apart(corner) > error)
        };
        let middle = self.corners.iter().sum::<DVec3>() / 8.0 - apex;
        let aside = middle - axis * axis.dot(middle);
        let off_axis = aside.length() / middle.length();
        // First the plane across the axis, then the tangent plane that faces the region.
        beyond(-axis)
            || off_axis > LEAST_ASIDE && beyond(aside.normalize_or_zero() * wider - axis * sine)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns a cube around `middle`, `half` to each side.
    fn cube(middle: DVec3, half: f64) -> Region {
        let corner = |i: u32| {
            let side = |bit: u32| if i & bit == 0 { -half } else { half };
            middle + DVec3::new(side(1), side(2), side(4))
        };
        Region::new([0, 1, 2, 3, 4, 5, 6, 7].map(corner), 0.0)
    }

    #[test]
    fn a_cone_that_touches_a_cube_does_not_miss_it_and_one_a_little_narrower_does() {
        // Seen from the origin along +X the nearest edge of the cube is at (9, 4): 23.96 degrees.
        let region = cube(DVec3::new(10.0, 5.0, 0.0), 1.0);
        let border = libm::cos(libm::atan2(4.0, 11.0));
        assert!(!region.misses_cone(DVec3::ZERO, DVec3::X, border));
        assert!(!region.misses_cone(DVec3::ZERO, DVec3::X, border - 1e-3));
        assert!(region.misses_cone(DVec3::ZERO, DVec3::X, border + 1e-3));
        assert!(region.misses_cone(DVec3::ZERO, -DVec3::X, 0.1), "it shines the other way");
    }

    #[test]
    fn cones_with_an_axis_through_the_centre_never_miss() {
        for i in 0..1000 {
            let angle = |step: f64| (f64::from(i) * step).rem_euclid(6.0);
            let axis =
                DVec3::new(libm::cos(angle(0.7)), libm::sin(angle(0.7)), libm::sin(angle(1.3)));
            let (axis, far) = (axis.normalize_or_zero(), 300.0);
            let region = cube(axis * far, 0.5);
            assert!(!region.misses_cone(DVec3::ZERO, axis, 0.9999), "{axis}");
            // Up to rounding errors off the axis, and more.
            for off in [1e-13, 1e-10, 1e-7, 1e-3] {
                let turned = (axis + DVec3::new(off, -off, off)).normalize_or_zero();
                assert!(!region.misses_cone(DVec3::ZERO, turned, 0.9999), "{axis} {off}");
            }
        }
    }

    #[test]
    fn a_region_around_a_lamp_is_at_distance_zero_and_in_every_cone() {
        let region = cube(DVec3::ZERO, 1.0);
        for apex in [DVec3::ZERO, DVec3::X, DVec3::new(0.3, -1.0, 0.2)] {
            for axis in [DVec3::X, DVec3::Y, DVec3::NEG_Z] {
                assert_eq!(region.most_cosine(apex, axis), 1.0);
            }
            assert_eq!(region.least_distance(apex), 0.0);
        }
        assert!((region.least_distance(DVec3::X * 3.0) - 2.0).abs() < 1e-4);
    }

    #[test]
    fn a_region_of_nans_is_never_culled() {
        let region = cube(DVec3::NAN, 1.0);
        assert_eq!(region.most_cosine(DVec3::ZERO, DVec3::X), 1.0);
        assert_eq!(region.least_distance(DVec3::ZERO), 0.0);
        assert!(!region.misses_cone(DVec3::ZERO, DVec3::X, 0.9));
    }
}

//! Finds equivalent angles of a rotation, and chooses which to show.
//!
//! A rotation about three axes, A(a) B(b) C(c), equals A(a + 180) B(180 - b) C(c + 180), and full
//! turns may be added to each angle. If b is 90 or -90 degrees (gimbal lock), A and C turn about
//! one axis, and only the sum or the difference of a and c matters.

use glam::{DMat3, DVec3};

/// A and C turn about one axis if b is this near to 90 degrees.
const UPRIGHT: f64 = 1e-6;

/// Returns the equivalent angles with the smallest a and c: 120 degrees about B are 0, 120, 0 and
/// not 180, 60, 180.
pub(super) fn plainest(degrees: DVec3) -> DVec3 {
    let aside = |angles: DVec3| angles.x.abs() + angles.z.abs();
    let other = other(degrees).map(within_half_a_turn);
    // Rounding must not decide between equally plain angles.
    if aside(other) < aside(degrees) - 1e-9 { other } else { degrees }
}

/// Returns the equivalent angles nearest to `last`. `turn` computes the rotation of angles.
pub fn nearest(degrees: DVec3, last: DVec3, turn: impl Fn(DVec3) -> DMat3) -> DVec3 {
    let mut all = vec![degrees, other(degrees)];
    if (degrees.y.abs() - 90.0).abs() < UPRIGHT {
        // Keep the last c and let a take up the change; the sign depends on the axes.
        let with =
            |sign: f64| DVec3::new(degrees.x + sign * (last.z - degrees.z), degrees.y, last.z);
        all.extend(
            [-1.0, 1.0].map(with).into_iter().filter(|it| same_turn(turn(*it), turn(degrees))),
        );
    }
    // Full turns may be added to each angle.
    let near = |angles: DVec3| {
        let turns = ((last - angles) / 360.0).round();
        angles + turns * 360.0
    };
    let distance = |angles: &DVec3| angles.distance_squared(last);
    let first = near(degrees);
    all.into_iter()
        .map(near)
        .fold(first, |best, angles| if distance(&angles) < distance(&best) { angles } else { best })
}

/// Returns whether two rotations are equal up to rounding.
pub fn same_turn(a: DMat3, b: DMat3) -> bool {
    let difference = a - b;
    let columns = [difference.x_axis, difference.y_axis, difference.z_axis];
    columns.iter().all(|column| column.abs().max_element() < 1e-9)
}

/// Returns the other angles within a full turn that give the same rotation.
fn other(degrees: DVec3) -> DVec3 {
    DVec3::new(degrees.x + 180.0, 180.0 - degrees.y, degrees.z + 180.0)
}

/// Returns the same angle, above -180 and up to 180 degrees.
fn within_half_a_turn(degrees: f64) -> f64 {
    degrees - 360.0 * ((degrees - 180.0) / 360.0).ceil()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::base::math::{self, Axis};

    fn turn(degrees: DVec3) -> DMat3 {
        Axis::ALL.iter().fold(DMat3::IDENTITY, |turn, axis| {
            turn * math::rotation(axis.unit(), degrees[axis.index()].to_radians())
        })
    }

    fn close(a: DVec3, b: DVec3) {
        assert!(a.distance(b) < 1e-9, "{a} instead of {b}");
    }

    #[test]
    fn the_plainest_angles_turn_about_one_axis_if_one_is_enough() {
        close(plainest(DVec3::new(-180.0, 60.0, -180.0)), DVec3::new(0.0, 120.0, 0.0));
        close(plainest(DVec3::new(180.0, -60.0, 180.0)), DVec3::new(0.0, -120.0, 0.0));
        close(plainest(DVec3::new(30.0, 20.0, 10.0)), DVec3::new(30.0, 20.0, 10.0));
    }

    #[test]
    fn steps_about_each_axis_go_on_over_half_a_turn() {
        for axis in Axis::ALL {
            let mut shown = DVec3::ZERO;
            for step in 1..=80 {
                let exact = axis.unit() * 10.0 * f64::from(step);
                // As computed from a matrix: the middle angle is within a quarter turn.
                let wrapped = exact.map(within_half_a_turn);
                let canonical = if wrapped.y.abs() > 90.0 {
                    other(wrapped).map(within_half_a_turn)
                } else {
                    wrapped
                };
                shown = nearest(canonical, shown, turn);
                close(shown, exact);
            }
        }
    }

    #[test]
    fn straight_up_the_last_angle_stays() {
        let last = DVec3::new(20.0, 89.0, 15.0);
        let shown = nearest(DVec3::new(35.0, 90.0, 0.0), last, turn);
        close(shown, DVec3::new(20.0, 90.0, 15.0));
    }

    proptest! {
        #[test]
        fn the_angles_that_are_shown_say_the_same_turn(
            x in -180.0..180.0_f64,
            y in -90.0..90.0_f64,
            z in -180.0..180.0_f64,
            last in -720.0..720.0_f64,
        ) {
            let degrees = DVec3::new(x, y, z);
            let shown = nearest(degrees, DVec3::new(last, -last, last / 2.0), turn);
            prop_assert!(same_turn(turn(shown), turn(degrees)));
            prop_assert!(same_turn(turn(plainest(degrees)), turn(degrees)));
        }
    }
}

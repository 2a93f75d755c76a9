//! Lights with an extent: balls that shine evenly, as bulbs, as spots, and far away as suns.
//!
//! Light arrives at a point from the cone of directions in which the ball is seen. Directions are
//! sampled uniformly in solid angle, and each is lit like light from a point at the distance of the
//! ball's centre: the light of a ball is that of a point, spread over its cone.
//!
//! Shirley, Wang and Zimmerman, "Monte Carlo Techniques for Direct Lighting Calculations", 1996.

use glam::DVec3;

/// A ball that shines, in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct BallLight {
    pub(crate) centre: DVec3,
    pub(crate) radius: f64,
}

/// A direction in which a ball is seen.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LightSample {
    /// The direction, of length 1.
    pub(crate) towards: DVec3,
    /// The distance to the surface of the ball.
    pub(crate) distance: f64,
    /// The way from the ball's centre to the point in this direction at the centre's distance.
    pub(crate) shift: DVec3,
}

/// A ball as it is seen from a point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SeenBall {
    radius: f64,
    distance: f64,
    /// The direction to the centre, and two directions across.
    axis: DVec3,
    right: DVec3,
    up: DVec3,
    /// 1 - cos of half the aperture of its cone.
    depth: f64,
    is_inside: bool,
}

impl BallLight {
    /// Returns the ball as it is seen from a point. `None` from the centre, from which no direction
    /// is special.
    pub(crate) fn seen_from(&self, from: DVec3) -> Option<SeenBall> {
        let way = self.centre - from;
        let distance = way.length();
        if !(distance > 0.0 && distance.is_finite()) {
            return None;
        }
        let axis = way / distance;
        let sine = (self.radius / distance).min(1.0);
        // Without cancellation. Inside of the ball, light comes from everywhere.
        let is_inside = self.radius >= distance;
        let depth = match is_inside {
            true => 2.0,
            false => sine * sine / (1.0 + (1.0 - sine * sine).sqrt()),
        };
        let (right, up) = axis.any_orthonormal_pair();
        Some(SeenBall { radius: self.radius, distance, axis, right, up, depth, is_inside })
    }
}

impl SeenBall {
    /// Returns the direction that two numbers from 0 to 1 choose.
    pub(super) fn sample(&self, [u, v]: [f64; 2]) -> LightSample {
        let Self { radius, distance, axis, right, up, depth, is_inside } = *self;
        let below = u * depth;
        let cosine = 1.0 - below;
        let across = (below * (2.0 - below)).max(0.0).sqrt();
        let (sin, cos) = libm::sincos(v * std::f64::consts::TAU);
        let towards = axis * cosine + (right * cos + up * sin) * across;
        // The ray meets the ball where the distance from the centre is the radius.
        let beside = distance * across;
        let chord = (radius * radius - beside * beside).max(0.0).sqrt();
        let reach = match is_inside {
            true => distance * cosine + chord,
            false => distance * cosine - chord,
        };
        let shift = (axis * -below + (right * cos + up * sin) * across) * distance;
        LightSample { towards, distance: reach, shift }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shadow::sequence::sample;

    #[test]
    fn directions_fill_the_cone_of_a_ball_evenly_and_end_on_it() {
        let ball = BallLight { centre: DVec3::new(3.0, 4.0, 0.0), radius: 2.0 };
        let from = DVec3::new(3.0, 0.0, 3.0);
        let widest = (1.0_f64 - 4.0 / 25.0).sqrt();
        let axis = (ball.centre - from) / 5.0;
        let (mut mean, mut halves) = (0.0, 0);
        for i in 0..4096 {
            let it = ball.seen_from(from).unwrap().sample(sample(i, 7));
            assert!((it.towards.length() - 1.0).abs() < 1e-12);
            let end = from + it.towards * it.distance;
            assert!((end.distance(ball.centre) - 2.0).abs() < 1e-9);
            let at = from + it.towards * 5.0;
            assert!(at.abs_diff_eq(ball.centre + it.shift, 1e-12));
            let cosine = it.towards.dot(axis);
            assert!(cosine > widest - 1e-12);
            mean += cosine / 4096.0;
            halves += u32::from(cosine > f64::midpoint(1.0, widest));
        }
        // Uniform in solid angle is uniform in the cosine.
        assert!((mean - f64::midpoint(1.0, widest)).abs() < 1e-4, "{mean}");
        assert_eq!(halves, 2048);
    }

    #[test]
    fn inside_of_a_ball_light_comes_from_everywhere() {
        let ball = BallLight { centre: DVec3::X, radius: 3.0 };
        let mut sum = DVec3::ZERO;
        for i in 0..1024 {
            let it = ball.seen_from(DVec3::ZERO).unwrap().sample(sample(i, 3));
            sum += it.towards / 1024.0;
            let end = it.towards * it.distance;
            assert!((end.distance(ball.centre) - 3.0).abs() < 1e-9);
        }
        assert!(sum.length() < 0.01, "{sum}");
        assert!(ball.seen_from(DVec3::X).is_none());
    }
}

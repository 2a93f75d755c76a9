//! Lights that many points of shine on a surface: balls and the sky, and their samples at a point.

use glam::DVec3;

use super::ball_light::{BallLight, LightSample, SeenBall};
use super::sequence::{sample as sequence_sample, seed_of};

/// A sky that surfaces hide from each other.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sky {
    /// The colours above the horizon and below it.
    pub(super) colors: [[f64; 3]; 2],
    /// The number of the light.
    pub(super) light: u32,
    /// The number of samples at each point.
    pub(crate) samples: u32,
}

impl Sky {
    /// Returns the colour in a direction.
    pub(crate) fn color(&self, towards: DVec3) -> [f64; 3] {
        self.colors[usize::from(towards.y < 0.0)]
    }

    /// Returns the sky above a point with a normal.
    pub(super) fn above(&self, point: DVec3, normal: DVec3) -> SkyAbove {
        let (right, up) = normal.any_orthonormal_pair();
        SkyAbove { normal, right, up, seed: seed_of(point, self.light) }
    }
}

/// The sky above a point, whose directions are sampled.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SkyAbove {
    normal: DVec3,
    right: DVec3,
    up: DVec3,
    seed: u32,
}

impl SkyAbove {
    /// Returns a direction: the more frequent, the closer it is to the normal, in proportion to the
    /// cosine.
    pub(crate) fn sample(&self, number: u32) -> LightSample {
        let Self { normal, right, up, seed } = *self;
        let [u, v] = sequence_sample(number, seed);
        let (sin, cos) = libm::sincos(v * std::f64::consts::TAU);
        let across = u.sqrt();
        let towards = normal * (1.0 - u).sqrt() + right * (across * cos) + up * (across * sin);
        LightSample { towards, distance: f64::INFINITY, shift: DVec3::ZERO }
    }
}

/// A light with an extent.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SoftLight {
    pub(super) ball: BallLight,
    /// The number of the light.
    pub(super) light: u32,
    /// The number of samples at each point.
    pub(crate) samples: u32,
}

impl SoftLight {
    /// Returns the light as it is seen from a point, with the seed of its samples there.
    pub(crate) fn seen_from(&self, point: DVec3) -> Option<(SeenBall, u32)> {
        Some((self.ball.seen_from(point)?, seed_of(point, self.light)))
    }

    /// Returns a sample of the light.
    pub(crate) fn sample(&(ball, seed): &(SeenBall, u32), number: u32) -> LightSample {
        ball.sample(sequence_sample(number, seed))
    }
}

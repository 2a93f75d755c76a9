//! Lights that many points of shine on a surface: balls and the sky, and their samples at a point.

use glam::DVec3;

use super::ball_light::{BallLight, LightSample, SeenBall};
use super::sequence::{sample as sequence_sample, seed_of};
use crate::frame::panorama::PlacedPanorama;

/// A sky that surfaces hide from each other.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sky<'a> {
    /// The colours above the horizon and below it.
    pub(super) colors: [[f64; 3]; 2],
    /// The panorama, in place of the colours.
    pub(crate) panorama: Option<&'a PlacedPanorama>,
    /// The number of the light.
    pub(super) light: u32,
    /// The number of samples at each point.
    pub(crate) samples: u32,
}

impl Sky<'_> {
    /// Returns a direction above a point, and the light from there with its weight.
    ///
    /// Directions are the more frequent, the closer they are to the normal, in proportion to the
    /// cosine. If a panorama has lamps, every second direction goes to one of them, and light is
    /// weighted by the density of both (Veach and Guibas, "Optimally Combining Sampling
    /// Techniques for Monte Carlo Rendering", SIGGRAPH 1995).
    pub(crate) fn sample(&self, above: &SkyAbove, number: u32) -> (LightSample, [f64; 3]) {
        let number = above.first.wrapping_add(number);
        let seed = seed_of(self.light);
        let Some(panorama) = self.panorama else {
            let towards = above.around_normal(sequence_sample(number, seed));
            return (sample_of(towards), self.colors[usize::from(towards.y < 0.0)]);
        };
        if !panorama.has_lamps() {
            let towards = above.around_normal(sequence_sample(number, seed));
            return (sample_of(towards), panorama.spread(towards, self.samples));
        }
        let towards = match number % 2 {
            0 => above.around_normal(sequence_sample(number / 2, seed)),
            _ => panorama.towards_lamp(sequence_sample(number / 2, seed ^ LAMPS)),
        };
        let cosine = above.normal.dot(towards).max(0.0) / std::f64::consts::PI;
        let (light, density) = panorama.around(towards);
        let weight = if cosine > 0.0 { cosine / (cosine + density) } else { 0.0 };
        (sample_of(towards), light.map(|it| it * weight))
    }

    /// Returns the sky above a point with a normal and a place in the sequence of samples.
    pub(super) fn above(&self, place: u32, normal: DVec3) -> SkyAbove {
        let (right, up) = normal.any_orthonormal_pair();
        SkyAbove { normal, right, up, first: place.wrapping_mul(self.samples) }
    }
}

/// Tells the seeds of directions to lamps from those of directions by cosine.
const LAMPS: u32 = 0x5bd1_e995;

/// Returns the sample of a direction.
const fn sample_of(towards: DVec3) -> LightSample {
    LightSample { towards, distance: f64::INFINITY, shift: DVec3::ZERO }
}

/// The sky above a point, whose directions are sampled.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SkyAbove {
    normal: DVec3,
    right: DVec3,
    up: DVec3,
    /// The number of its first sample.
    first: u32,
}

impl SkyAbove {
    /// Returns a direction for two numbers from 0 to 1.
    fn around_normal(&self, [u, v]: [f64; 2]) -> DVec3 {
        let Self { normal, right, up, .. } = *self;
        let (sin, cos) = libm::sincos(v * std::f64::consts::TAU);
        let across = u.sqrt();
        normal * (1.0 - u).sqrt() + right * (across * cos) + up * (across * sin)
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
    /// Returns the light as it is seen from a point.
    pub(crate) fn seen_from(&self, point: DVec3) -> Option<SeenBall> {
        self.ball.seen_from(point)
    }

    /// Returns a sample of the light at a place in the sequence.
    pub(crate) fn sample(&self, ball: &SeenBall, place: u32, number: u32) -> LightSample {
        let number = place.wrapping_mul(self.samples).wrapping_add(number);
        ball.sample(sequence_sample(number, seed_of(self.light)))
    }
}

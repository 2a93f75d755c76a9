//! Light from balls, with soft shadows.
//!
//! Each sample of a light is a direction to it, other ones at each point that is lit. A light
//! shader knows one position for all points. What counts is the difference of both: the points are
//! moved instead of the light, so all kinds of light are evaluated by their shaders. Rays run to
//! the samples that add light.

use fearless_simd::Level;

use super::interpolated::ShadingNumber;
use super::shadows::{Firsts, first, lit};
use crate::lights::{Batch, LightTerm, add_light};
use crate::shadow::ball_light::{LightSample, SeenBall};
use crate::shadow::extents::SoftLight;
use crate::shadow::rays::RayScratch;
use crate::shadow::shaft::POINTS;
use crate::shadow::tracer::Tracer;
use crate::simd::Bits;

/// Adds the light of a ball at every position of a batch that it reaches.
pub(super) fn add_soft_light<T: ShadingNumber>(
    (tracer, light): (&Tracer<'_>, SoftLight),
    scratch: &mut RayScratch,
    term: &LightTerm<T>,
    level: Level,
    batch: &mut Batch<T>,
) {
    let dark: Firsts<T> = [[T::default(); POINTS]; 3];
    let (before, own) = ((first(&batch.diffuse), first(&batch.specular)), first(&batch.position));
    let (mut diffuse, mut specular) = (dark, dark);
    let count = batch.len.min(POINTS);
    let mut balls: [Option<SeenBall>; POINTS] = [None; POINTS];
    for (i, ball) in balls[..count].iter_mut().enumerate() {
        *ball = light.seen_from(scratch.origins.point(i));
    }
    // Rays search only what lies in between.
    let is_hidden = tracer.look_between(level, &light, scratch, count);
    let mut samples: [Option<LightSample>; POINTS] = [None; POINTS];
    for number in 0..light.samples {
        for i in 0..count {
            let place = scratch.origins.places[i];
            samples[i] = balls[i].as_ref().map(|ball| light.sample(ball, place, number));
            let shift = samples[i].map_or(glam::DVec3::ZERO, |it| tracer.to_view(it.shift));
            for (axis, shift) in shift.to_array().into_iter().enumerate() {
                let at: f64 = own[axis][i].into();
                batch.position[axis][i] = T::from_f64(at - shift);
            }
        }
        for row in batch.diffuse.iter_mut().chain(&mut batch.specular) {
            row[..POINTS].fill(T::default());
        }
        add_light(level, batch, term);
        let reached = lit(level, batch, &(dark, dark));
        let blocked = match is_hidden {
            true => tracer.blocked(level, scratch, (&samples, true), reached),
            false => 0,
        };
        let open = reached & !blocked;
        if let Some(shares) = tracer.filtered(level, scratch, &samples, open) {
            for i in Bits(open) {
                for (axis, share) in shares[i].into_iter().enumerate() {
                    let share = T::from_f64(share);
                    batch.diffuse[axis][i] = batch.diffuse[axis][i] * share;
                    batch.specular[axis][i] = batch.specular[axis][i] * share;
                }
            }
        }
        for i in Bits(open) {
            for axis in 0..3 {
                diffuse[axis][i] = diffuse[axis][i] + batch.diffuse[axis][i];
                specular[axis][i] = specular[axis][i] + batch.specular[axis][i];
            }
        }
    }
    let share = T::from_f64(1.0 / f64::from(light.samples));
    let mean = |before: T, sum: T| before + sum * share;
    for axis in 0..3 {
        batch.position[axis][..POINTS].copy_from_slice(&own[axis]);
        for i in 0..POINTS {
            batch.diffuse[axis][i] = mean(before.0[axis][i], diffuse[axis][i]);
            batch.specular[axis][i] = mean(before.1[axis][i], specular[axis][i]);
        }
    }
}

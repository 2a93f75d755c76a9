//! Occlusion of the sky: the part of it that each point sees.
//!
//! Directions are sampled around the normal, and rays look for surfaces in them. The light of the
//! whole sky is known exactly, so it is multiplied by the fraction of the samples' light that
//! arrives. With one colour this is ambient occlusion.
//!
//! Zhukov, Iones and Kronin, "An Ambient Light Illumination Model", 1998; Landis,
//! "Production-Ready Global Illumination", SIGGRAPH course notes, 2002.

use fearless_simd::Level;
use glam::DVec3;

use super::interpolated::ShadingNumber;
use super::shadows::{first, lit};
use crate::lights::{Batch, LightTerm, add_light};
use crate::shadow::ball_light::LightSample;
use crate::shadow::extents::{Sky, SkyAbove};
use crate::shadow::rays::RayScratch;
use crate::shadow::shaft::POINTS;
use crate::shadow::tracer::Tracer;
use crate::simd::Bits;

/// Adds the light of the sky at every position of a batch.
pub(super) fn add_sky<T: ShadingNumber>(
    (tracer, sky): (&Tracer<'_>, Sky<'_>),
    scratch: &mut RayScratch,
    term: &LightTerm<T>,
    level: Level,
    batch: &mut Batch<T>,
) {
    let before = first(&batch.diffuse);
    let specular = first(&batch.specular);
    add_light(level, batch, term);
    let reached = lit(level, batch, &(before, specular));
    let mut skies: [Option<SkyAbove>; POINTS] = [None; POINTS];
    for i in Bits(reached) {
        let normal = DVec3::from(batch.normal.each_ref().map(|row| row[i].into()));
        skies[i] = tracer.sky_above(&sky, scratch.origins.places[i], normal);
    }
    let mut samples: [Option<LightSample>; POINTS] = [None; POINTS];
    let mut colors = [[0.0; 3]; POINTS];
    let (mut all, mut seen) = ([[0.0; 3]; POINTS], [[0.0; 3]; POINTS]);
    for number in 0..sky.samples {
        for i in Bits(reached) {
            let sample = skies[i].map(|above| sky.sample(&above, number));
            colors[i] = sample.map_or([0.0; 3], |(_, color)| color);
            // Nothing is looked for where no light comes from.
            samples[i] = sample.map(|(sample, _)| sample).filter(|_| colors[i] != [0.0; 3]);
        }
        let blocked = tracer.blocked(level, scratch, (&samples, false), reached);
        let shares = tracer.filtered(level, scratch, &samples, reached & !blocked);
        for i in Bits(reached) {
            let color = colors[i];
            let share = match blocked >> i & 1 {
                0 => shares.as_ref().map_or([1.0; 3], |shares| shares[i]),
                _ => [0.0; 3],
            };
            for channel in 0..3 {
                all[i][channel] += color[channel];
                seen[i][channel] += color[channel] * share[channel];
            }
        }
    }
    // Where no sample finds the light of a panorama, what its polynomial leaves is an error.
    let unseen = if sky.panorama.is_some() { 0.0 } else { 1.0 };
    for i in Bits(reached) {
        for channel in 0..3 {
            let (all, seen) = (all[i][channel], seen[i][channel]);
            let share = if all > 0.0 { seen / all } else { unseen };
            let own = batch.diffuse[channel][i] - before[channel][i];
            batch.diffuse[channel][i] = before[channel][i] + own * T::from_f64(share);
        }
    }
}

//! Triangles of every size with corners up to a million pixels away, pixel by pixel.

use super::fans::compare;
use super::{Proof, Tally};
use marraztu_core::base::rng::Rng;
use marraztu_lab::pictures::flat::Flat;
use marraztu_render::screen::coverage::{SUBPIXELS, Snapped};

pub(crate) const PROOF: Proof = Proof {
    name: "samples",
    claim: "triangles of every size, with corners up to a million pixels off, cover exactly the \
            pixels that integer crossings say",
    unit: "samples",
    batch: (SIDE * SIDE) as u64,
    quick: 10_000_000,
    whole: 100_000_000,
    shows: &[],
    regressions: &[],
    check,
};

const SIDE: usize = 256;

/// The distance of corners in pixels, and the step of their coordinates in subpixels. A mesh has 24
/// bits, and the renderer's guard band is 2^20 pixels wide.
const REACH: [(i32, i32); 5] = [(300, 1), (300, 1), (2000, 1), (30_000, 1), (1_000_000, 16)];

fn check(batch: u64) -> Result<Tally, String> {
    let mut rng = Rng::new(batch ^ 0xfa12);
    let mut triangles = Vec::new();
    for _ in 0..rng.between(1, 60) {
        let (reach, step) = rng.one_of(&REACH);
        let mut corner = || {
            let mut coordinate = || {
                let at = rng.between(-reach, reach) * SUBPIXELS + rng.between(0, 255);
                let at = at.clamp(-reach * SUBPIXELS, reach * SUBPIXELS) / step * step;
                // Half of the coordinates are on centres and borders of pixels.
                if rng.one_in(2) { at.div_euclid(128) * 128 } else { at }
            };
            Snapped { x: coordinate(), y: coordinate() }
        };
        triangles.push(Flat::new([corner(), corner(), corner()]));
    }
    compare(&triangles, SIDE)?;
    let mut tally = Tally::default();
    tally.count("samples", (SIDE * SIDE) as u64);
    tally.count("triangles", triangles.len() as u64);
    Ok(tally)
}

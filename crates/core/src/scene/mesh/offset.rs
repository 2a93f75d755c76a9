//! Splits positions into an offset and small differences.
//!
//! A map file counts metres from a distant origin: (500000, 5400000, 300). An f32 resolves such a
//! number to half a metre, so positions are stored relative to a nearby offset in f64. Models near
//! their origin have the offset 0, and their positions are the numbers of the file.

use glam::DVec3;
use rayon::prelude::*;

use crate::scene::Bounds;

/// A model gets an offset if its distance from the origin exceeds this multiple of its size. An f32
/// has 24 bits, so without an offset at least 20 bits of the size are kept.
const FAR: f64 = 16.0;

/// Returns the offset of positions, and the positions relative to it. `used` lists the vertices
/// that faces and strokes use.
///
/// The offset is a multiple of a power of ten, so differences of numbers with few decimals have few
/// decimals, too.
pub fn split_positions(positions: &[[f64; 3]], used: &[u32]) -> (DVec3, Vec<[f32; 3]>) {
    let offset = offset(bounds(positions, used));
    #[expect(clippy::cast_possible_truncation, reason = "the rounding that is meant")]
    let relative = |p: &[f64; 3]| (DVec3::from_array(*p) - offset).to_array().map(|x| x as f32);
    (offset, positions.par_iter().map(relative).collect())
}

/// Bounds the used positions, or all positions if none is used.
fn bounds(positions: &[[f64; 3]], used: &[u32]) -> Option<Bounds> {
    let at = |p: &[f64; 3]| Some(Bounds::at(DVec3::from_array(*p)));
    let used = used.par_iter().filter_map(|vertex| positions.get(*vertex as usize));
    let join = |a: Option<Bounds>, b: Option<Bounds>| match (a, b) {
        (Some(a), Some(b)) => Some(a.around(&b)),
        (a, b) => a.or(b),
    };
    let used = used.map(at).reduce(|| None, join);
    used.or_else(|| positions.par_iter().map(at).reduce(|| None, join))
}

fn offset(bounds: Option<Bounds>) -> DVec3 {
    let Some(bounds) = bounds else { return DVec3::ZERO };
    let (centre, size) = (bounds.centre(), bounds.extent().max_element());
    if size <= 0.0 || centre.abs().max_element() <= FAR * size {
        return DVec3::ZERO;
    }
    // A multiple of a power of ten keeps the decimals of the file short.
    let step = 10_f64.powf(size.log10().floor());
    let offset = (centre / step).round() * step;
    if offset.is_finite() { offset } else { DVec3::ZERO }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_model_far_away_keeps_the_digits_of_one_at_the_origin() {
        let local = [[-1.25, 3.5, 0.1], [40.0, 60.75, 2.0], [12.5, 0.0, 7.3], [0.0; 3]];
        let far = DVec3::new(500_000.0, 5_400_000.0, 300.0);
        let moved = local.map(|p| (DVec3::from_array(p) + far).to_array());
        // The last position is not used, so its distance does not count.
        let mut moved = moved.to_vec();
        moved[3] = [0.0; 3];
        let (offset, positions) = split_positions(&moved, &[0, 1, 2]);
        assert_eq!(offset, DVec3::new(500_020.0, 5_400_030.0, 300.0));
        for (position, local) in positions.iter().zip(local).take(3) {
            let back = DVec3::from_array(position.map(f64::from)) + offset - far;
            let error = (back - DVec3::from_array(local)).abs().max_element();
            assert!(error < 1e-5, "{position:?} is {error} off");
        }
    }

    #[test]
    fn a_model_near_its_origin_keeps_its_numbers() {
        let positions = [[0.1, 0.2, 0.3], [16.0, -2.0, 1e-30]];
        let (offset, relative) = split_positions(&positions, &[0, 1]);
        assert_eq!(
            (offset, &relative[..]),
            (DVec3::ZERO, &[[0.1, 0.2, 0.3], [16.0, -2.0, 1e-30]][..])
        );
        assert_eq!(split_positions(&[[7.0; 3]], &[0]).0, DVec3::ZERO, "one point has no size");
        assert_eq!(split_positions(&[], &[]).1.len(), 0);
    }
}
